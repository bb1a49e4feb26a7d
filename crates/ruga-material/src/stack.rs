//! Layers that carry layers: what a stack does together, and what stands for it.

use std::f64::consts::TAU;

use crate::error::require_representable;
use crate::material::plane_strain_factor;
use crate::two_shells::{Minimum, Shell, TwoShells};
use crate::wrinkling::ShellStiffness;
use crate::{LayerMaterial, MaterialError, Substrate, WavelengthModel, Wrinkling, wrinkling};

/// Factor by which the joint onset must undercut the lower layer's own before modelling each layer
/// by itself is called misleading.
const DISAGREEMENT: f64 = 1.5;

/// Share of the lower layer's wavelength above which a wave of the pair counts as its large one.
const LARGE: f64 = 0.6;

/// A layer of a stack with its own critical wave on what lies directly below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackLayer {
    /// The layer.
    pub material: LayerMaterial,
    /// Its wave alone: on the substrate for the lowest layer, else on the layer below as if that lay
    /// on a rigid base ([`LayerMaterial::as_substrate`]); or what a painted map makes of it there.
    pub wrinkling: Wrinkling,
}

impl StackLayer {
    /// The layer on what carries it, [`LayerMaterial::as_substrate`] of the layer below or the
    /// substrate.
    ///
    /// # Errors
    /// Those of [`wrinkling`].
    pub fn new(
        material: LayerMaterial,
        below: &Substrate,
        model: WavelengthModel,
    ) -> Result<Self, MaterialError> {
        Ok(Self {
            material,
            wrinkling: wrinkling(&material, below, model)?,
        })
    }

    /// Accepts what [`StackLayer::new`] makes; the fields may have been set by hand.
    fn validate(&self) -> Result<(), MaterialError> {
        self.material.validate()?;
        self.wrinkling.representable().map(|_| ())
    }
}

/// A wave in which two layers move together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMode {
    /// Wave number `k_j` (1/m).
    pub wave_number: f64,
    /// Wavelength (m).
    pub wavelength: f64,
    /// Plane compressive strain of both layers at which it appears, `e_j`.
    pub critical_strain: f64,
}

impl From<Minimum> for JointMode {
    fn from(found: Minimum) -> Self {
        Self {
            wave_number: found.wave_number,
            wavelength: TAU / found.wave_number,
            critical_strain: found.strain,
        }
    }
}

/// Scale of the wrinkles that a growing compression shows first when two layers move together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstScale {
    /// The upper layer's fine ones, the large ones later.
    Fine,
    /// One large mode of both; fine wrinkles may never come, because it relieves the upper layer.
    Large,
}

/// A layer and the one it carries: linear analysis of both together (two shells, the upper on
/// springs above the lower).
///
/// Real skin pairs share their wrinkles: an upper layer that wrinkles at a few per cent carries more
/// membrane force than the lower one unless it is some 40 times finer. Simulating layers one after
/// the other, as Li 2014 does, shows two scales where both together show one; this type says which.
///
/// # Validity
/// Flat layers, plane waves, small amplitudes. Against the exact elastic stack `e_j` is off by up to
/// 2 % and the wavelength by up to 4 %, for membrane ratios from 0.1 to 14. The lower layer's springs
/// are a fit at its own wave: where the pair's is twice as long they are too stiff, and the joint wave
/// comes out 16 % short. For an upper layer with a
/// longer wave than the lower one's the words *fine* and *large* lose their meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackPair {
    /// The lower layer.
    pub lower: StackLayer,
    /// The upper layer.
    pub upper: StackLayer,
    /// `S2/S1`: what the upper layer carries of the force, over what the lower one does. Above 0.1
    /// the pair's wavelength leaves the lower layer's (+5 %), above 0.3 its onset too (-7 %), above 1
    /// the upper layer decides.
    pub membrane_ratio: f64,
    /// `r_N`: the upper layer's critical force over the lower one's, each alone.
    pub force_ratio: f64,
    /// `β = S1/(S1 + S2)`: share of the lower layer's bending strain that an upper layer feels that is
    /// solved after it by its own wavelength (`nominal`). A stiff film pulls the neutral surface to
    /// itself; with all of the strain the crests, stretched by it, lose their fine wrinkles. On a
    /// composite lower layer the share is 1.
    pub bending_transfer: f64,
    /// The large wave that both layers share: the minimum of the strain with the longest wave, longer
    /// than 0.6 times the lower layer's own. `None` where the upper layer wrinkles so early that no
    /// such minimum is left: a lower layer that alone would not wrinkle below some 25 %.
    pub joint: Option<JointMode>,
    /// The fine wave, where the strain has a minimum at less than 0.6 times the lower layer's.
    pub fine: Option<JointMode>,
    shells: TwoShells,
}

impl StackPair {
    /// Analyses `upper` on `lower`.
    ///
    /// # Errors
    /// Those of [`LayerMaterial::validate`] for either layer; [`MaterialError::Overflow`] when a part of
    /// a layer's [`Wrinkling`] is no finite number above 0, or the joint wave leaves the range of
    /// floating-point numbers.
    pub fn new(lower: &StackLayer, upper: &StackLayer) -> Result<Self, MaterialError> {
        lower.validate()?;
        upper.validate()?;
        let upper_shell = Shell::new(&upper.wrinkling);
        // Shells are mid-surfaces, so half of either thickness lies between them.
        let offset = 0.5 * (lower.material.thickness + upper.material.thickness);
        Self::with_upper_shell(lower, upper, upper_shell, offset)
    }

    /// Analyses a pair whose upper shell may be a composite, its neutral surface `offset` above the
    /// lower layer's middle.
    fn with_upper_shell(
        lower: &StackLayer,
        upper: &StackLayer,
        upper_shell: Shell,
        offset: f64,
    ) -> Result<Self, MaterialError> {
        let shells = TwoShells {
            lower: Shell::new(&lower.wrinkling),
            upper: upper_shell,
            tangential: shear_stiffness(&lower.material),
            offset,
        };
        let waves = [lower.wrinkling.wave_number, upper.wrinkling.wave_number];
        // The search for minima walks over logarithms between these two.
        for wave_number in waves {
            require_representable("the wave number (1/m)", wave_number)?;
        }
        let minima = shells.minima(waves);
        for minimum in &minima {
            require_representable("the critical strain of the stack", minimum.strain)?;
        }
        let large = |minimum: &&Minimum| LARGE * minimum.wave_number < waves[0];
        // Minima come longest wave first: the large wave is the first of its kind, the fine one the
        // last.
        let joint = minima.iter().find(large);
        let fine = minima.iter().rev().find(|minimum| !large(minimum));
        let (below, above) = (shells.lower.membrane, shells.upper.membrane);
        Ok(Self {
            lower: *lower,
            upper: *upper,
            membrane_ratio: above / below,
            force_ratio: upper.wrinkling.critical_force / lower.wrinkling.critical_force,
            bending_transfer: below / (below + above),
            joint: joint.copied().map(JointMode::from),
            fine: fine.copied().map(JointMode::from),
            shells,
        })
    }

    /// Strain at which both layers would show a wave of number `wave_number` (1/m) together.
    pub fn strain(&self, wave_number: f64) -> f64 {
        self.shells.strain(wave_number)
    }

    /// Scale that comes first: the fine one if the upper layer alone wrinkles below the joint
    /// strain.
    pub fn first_scale(&self) -> FirstScale {
        let fine = self.upper.wrinkling.critical_strain;
        match self.joint {
            Some(joint) if joint.critical_strain <= fine => FirstScale::Large,
            _ => FirstScale::Fine,
        }
    }

    /// Whether solving each layer by its own wavelength misleads about this pair: jointly it would
    /// show its large wave at less than two thirds of the lower layer's own critical strain.
    pub fn nominal_disagrees(&self) -> bool {
        let alone = self.lower.wrinkling.critical_strain;
        self.joint
            .is_some_and(|joint| joint.critical_strain < alone / DISAGREEMENT)
    }

    /// Tangential stiffness under an upper layer solved by its own wavelength, `K_t = Ē1 k_2/2`
    /// (Pa/m).
    ///
    /// As stiff as the lower layer against the fine wave. The shear of the whole thickness is some 6
    /// to 60 times softer and lets fine wrinkles run together into few folds.
    pub fn nominal_tangential_stiffness(&self) -> f64 {
        self.half_space_stiffness(self.upper.wrinkling.wave_number)
    }

    /// Tangential stiffness under an upper layer on a composite lower layer where it slides evenly, `K_t = μ1/h1`
    /// (Pa/m): the lower layer's shear across its thickness. The only multiple of it that fits the exact stack.
    pub fn shear_tangential_stiffness(&self) -> f64 {
        self.shells.tangential
    }

    /// Stiffness on the gradient of sliding under an upper layer on a composite lower layer (N/m), for fine waves of
    /// number `k` (1/m): `K_g = (Ē1 k/2 - μ1/h1)/k²`, 0 where that is negative.
    ///
    /// With it the lower layer holds sliding of wave number `q` by `μ1/h1 + K_g q²`: by the shear of its thickness
    /// where `q` is small, as a half-space at the fine wave. With the first alone a film over a valley that asks for
    /// more than some 15 % pulls its excess length from wavelengths around into few folds that overhang. At the
    /// joint wave of a face it adds 7 % to the first, of Li 2014's skin 22 %.
    pub fn drift_gradient_stiffness(&self, wave_number: f64) -> f64 {
        let excess = self.half_space_stiffness(wave_number) - self.shear_tangential_stiffness();
        excess.max(0.0) / (wave_number * wave_number)
    }

    /// Tangential stiffness of the lower layer under a wave so short that its thickness does not count (Pa/m).
    fn half_space_stiffness(&self, wave_number: f64) -> f64 {
        let lower = self.lower.material;
        0.5 * lower.young / plane_strain_factor(lower.poisson) * wave_number
    }

    /// The lower layer that stands for both, with the pair's wave, onset and amplitude.
    ///
    /// `D' = D1 + D2 + Kq t²/k_j²`, `S' = S1 + S2`, `N' = S' e_j`, `K0' = D' k_j⁴`,
    /// `K1' = N' - 2 D' k_j²`. For the lower layer only; the upper one keeps its own springs, takes all
    /// of the bending strain, [`StackPair::shear_tangential_stiffness`] and
    /// [`StackPair::drift_gradient_stiffness`].
    ///
    /// # Errors
    /// [`MaterialError::NoJointWave`] when the pair has no large wave;
    /// [`MaterialError::CompositeUnstable`] unless `|K1'| < 2 √(D' K0')`, where the springs could be
    /// pushed in by a wave; [`MaterialError::Overflow`] when a result leaves the range of
    /// floating-point numbers.
    pub fn composite(&self) -> Result<CompositeLayer, MaterialError> {
        let joint = self.joint.ok_or(MaterialError::NoJointWave {
            lower: self.lower.wrinkling.critical_strain,
            upper: self.upper.wrinkling.critical_strain,
        })?;
        let wave_number = joint.wave_number;
        let squared = wave_number * wave_number;
        let TwoShells {
            lower,
            upper,
            offset,
            ..
        } = self.shells;
        // Tangential springs across the mid-surface offset resist a wave as a bending stiffness
        // would, but one that depends on the wave: this is right at the joint wave, the one that is
        // seen.
        let sandwich = self.shells.shear(wave_number) * offset * offset / squared;
        let shell = ShellStiffness {
            bending: lower.bending + upper.bending + sandwich,
            membrane: lower.membrane + upper.membrane,
        };
        // Both layers are compressed alike, so their forces add up.
        let critical_force = shell.membrane * joint.critical_strain;
        let bound = 2.0 * shell.bending * squared;
        let gradient_stiffness = critical_force - bound;
        if gradient_stiffness.abs() >= bound {
            return Err(MaterialError::CompositeUnstable {
                gradient_stiffness,
                bound,
            });
        }
        let found = Wrinkling::on_springs(shell, wave_number, critical_force, gradient_stiffness);
        let mass = [self.lower.material, self.upper.material]
            .iter()
            .map(|layer| layer.density * layer.thickness)
            .sum();
        CompositeLayer::new(found.representable()?, self.lower.material.poisson, mass)
    }
}

/// Shear stiffness of the lower layer across its thickness, `μ1/h1` (Pa/m).
fn shear_stiffness(lower: &LayerMaterial) -> f64 {
    lower.young / (2.0 * (1.0 + lower.poisson)) / lower.thickness
}

/// A single layer that wrinkles as a layer and all it carries do together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompositeLayer {
    /// A homogeneous layer with the stack's bending and membrane stiffness and its mass per area. Its
    /// thickness and modulus are means to that end: distances between surfaces stay those of the
    /// layers themselves.
    pub material: LayerMaterial,
    /// Wave, force, strain and springs of the stack; what a report shows of a composite layer is
    /// the stack's.
    pub wrinkling: Wrinkling,
}

impl CompositeLayer {
    /// `h' = √(12 D'/S')`, `E' = S' (1 - ν²)/h'`; `mass` per area (kg/m²).
    fn new(wrinkling: Wrinkling, poisson: f64, mass: f64) -> Result<Self, MaterialError> {
        let membrane = wrinkling.membrane_stiffness;
        let thickness = (12.0 * wrinkling.bending_stiffness / membrane).sqrt();
        let material = LayerMaterial {
            young: membrane * plane_strain_factor(poisson) / thickness,
            poisson,
            thickness,
            density: mass / thickness,
        };
        material.validate()?;
        Ok(Self {
            material,
            wrinkling,
        })
    }
}

/// Composite of each layer of a stack and all above it, bottom first; the top layer stands for
/// itself.
///
/// Worked from the top down, pair by pair: a layer carries the composite of what lies above, with that
/// composite's bending and membrane stiffness and its distance to the composite's neutral surface,
/// on the springs of the layer directly above, which are this layer's own compliance. For two
/// layers this is [`StackPair::composite`]. The notes' measurements are of two layers; with more it
/// is an extrapolation of the same idea.
///
/// # Errors
/// Those of [`StackPair::new`] and [`StackPair::composite`], for the first pair from the top that has
/// none.
pub fn composite_layers(layers: &[StackLayer]) -> Result<Vec<CompositeLayer>, MaterialError> {
    layers.iter().try_for_each(StackLayer::validate)?;
    let mut found: Vec<CompositeLayer> = Vec::with_capacity(layers.len());
    // Height of the neutral surface of all so far above their lowest face.
    let mut neutral = 0.0;
    let mut above: Option<(&StackLayer, CompositeLayer)> = None;
    for layer in layers.iter().rev() {
        let own = layer.wrinkling.membrane_stiffness;
        let thickness = layer.material.thickness;
        let composite = match &above {
            None => {
                neutral = 0.5 * thickness;
                CompositeLayer {
                    material: layer.material,
                    wrinkling: layer.wrinkling,
                }
            }
            Some((carried, stack)) => {
                let offset = 0.5 * thickness + neutral;
                let carried_force = stack.wrinkling.membrane_stiffness;
                // Weighted by membrane stiffness: about that height bending adds no force along the
                // stack.
                neutral = (0.5 * own * thickness + carried_force * (thickness + neutral))
                    / (own + carried_force);
                pair_with_stack(layer, carried, stack, offset)?.composite()?
            }
        };
        found.push(composite);
        above = Some((layer, composite));
    }
    found.reverse();
    Ok(found)
}

/// `lower` with the `stack` that begins with the layer `carried`.
fn pair_with_stack(
    lower: &StackLayer,
    carried: &StackLayer,
    stack: &CompositeLayer,
    offset: f64,
) -> Result<StackPair, MaterialError> {
    let shell = Shell {
        // Springs of the layer directly above: they are what the lower layer gives way across its
        // thickness, not a property of the stack that it carries.
        normal: carried.wrinkling.normal_stiffness,
        gradient: carried.wrinkling.gradient_stiffness,
        ..Shell::new(&stack.wrinkling)
    };
    let upper = StackLayer {
        material: stack.material,
        ..*carried
    };
    StackPair::with_upper_shell(lower, &upper, shell, offset)
}
