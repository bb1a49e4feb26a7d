//! What every layer of a stack is by itself, and how it lies on the one below.

use std::f64::consts::TAU;

use ruga_material::{StackLayer, StackPair, Wrinkling, composite_layers, wrinkling};

use crate::error::{Checked, refuse};
use crate::skin::upper_shell::UpperShell;
use crate::support::support_surface::{Attachment, TangentialSprings};
use crate::{Coupling, Grows, GrowthSpec, LayerSpec, Stack, StepperError};

/// The layers as they are simulated, bottom first.
#[derive(Clone, Debug)]
pub(crate) struct Stacking {
    pub(crate) specs: Vec<LayerSpec>,
    /// Critical mode of every layer by itself, which plan and report name.
    pub(crate) wrinkling: Vec<Wrinkling>,
    /// Critical mode that every layer is simulated for: of layers that are solved at once the finest
    /// wave and the first onset.
    pub(crate) simulated: Vec<Wrinkling>,
    pub(crate) attachments: Vec<Attachment>,
    /// Every layer with the one above it.
    pub(crate) pairs: Vec<StackPair>,
    /// The layer that moves together with the lowest one.
    pub(crate) joint: Option<UpperShell>,
}

/// Refuses creases but in the lowest of layers that do not move together.
fn check_creases(layers: &[LayerSpec], stack: Stack) -> Checked {
    let creased = |layer: &&LayerSpec| !layer.creases.is_empty();
    let (refused, accepted) = match stack {
        Stack::Joint => (layers.iter().find(creased), "none in a joint pair"),
        Stack::Nominal | Stack::Composite => (
            layers.iter().skip(1).find(creased),
            "none but in the lowest layer",
        ),
    };
    match refused {
        None => Ok(()),
        Some(layer) => {
            let of = format!("layer '{}'", layer.name);
            refuse(of, "creases", layer.creases.len(), accepted)
        }
    }
}

/// Refuses growths in a joint pair, whose sheets share one rest metric.
fn check_growths(layers: &[LayerSpec], stack: Stack) -> Checked {
    let grows = |layer: &&LayerSpec| !layer.growths.is_empty();
    match layers.iter().find(grows).filter(|_| stack == Stack::Joint) {
        None => Ok(()),
        Some(layer) => {
            let of = format!("layer '{}'", layer.name);
            refuse(of, "growths", layer.growths.len(), "none in a joint pair")
        }
    }
}

impl Stacking {
    /// Applies the meaning of the stack to `layers`.
    pub(crate) fn new(layers: &[LayerSpec], stack: Stack) -> Result<Self, StepperError> {
        check_creases(layers, stack)?;
        check_growths(layers, stack)?;
        let alone = layers.iter().map(alone).collect::<Result<Vec<_>, _>>()?;
        let pairs = (1..layers.len())
            .map(|k| {
                let pair = StackPair::new(&alone[k - 1], &alone[k]);
                pair.map_err(|source| material(&layers[k], source))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut stacking = Self {
            specs: layers.to_vec(),
            wrinkling: alone.iter().map(|layer| layer.wrinkling).collect(),
            simulated: Vec::new(),
            attachments: vec![Attachment::default(); layers.len()],
            pairs,
            joint: None,
        };
        match stack {
            Stack::Nominal => {}
            Stack::Composite => stacking.replace_by_composites(&alone)?,
            Stack::Joint => stacking.require_pair()?,
        }
        stacking.attach(layers, stack);
        // This is before layers are joined: for a pair the mode that is reported and the one that
        // meshes are made for are not the same.
        stacking.simulated.clone_from(&stacking.wrinkling);
        if stack == Stack::Joint {
            stacking.join();
        }
        Ok(stacking)
    }

    /// A layer that lies on nothing and has no wave of its own.
    pub(crate) fn of_sheet(layer: &LayerSpec) -> Self {
        Self {
            specs: vec![layer.clone()],
            wrinkling: Vec::new(),
            simulated: Vec::new(),
            attachments: vec![Attachment::default()],
            pairs: Vec::new(),
            joint: None,
        }
    }

    /// Number of layers with a mesh of their own: one that moves together with the lowest has none.
    pub(crate) fn meshes(&self) -> usize {
        match self.joint {
            Some(_) => 1,
            None => self.specs.len(),
        }
    }

    /// Lets every layer stand for itself and all above it.
    fn replace_by_composites(&mut self, alone: &[StackLayer]) -> Result<(), StepperError> {
        self.require_uniform("composite")?;
        // A composite is computed once, from the layers' nominal numbers. Paint would ask for
        // another one at every place.
        let composites =
            composite_layers(alone).map_err(|source| material(&self.specs[0], source))?;
        for (k, composite) in composites.into_iter().enumerate() {
            self.specs[k].material = composite.material;
            self.wrinkling[k] = composite.wrinkling;
            self.specs[k].growths = composite_growths(&self.specs[k..], &alone[k..]);
        }
        Ok(())
    }

    fn require_uniform(&self, stack: &'static str) -> Result<(), StepperError> {
        let painted = self
            .specs
            .iter()
            .find(|spec| spec.map.is_some() || spec.variation.is_some());
        painted.map_or(Ok(()), |painted| {
            Err(StepperError::PaintedStack {
                layer: painted.name.clone(),
                what: match painted.map {
                    Some(_) => "property map",
                    None => "variation",
                },
                stack,
            })
        })
    }

    fn require_pair(&self) -> Result<(), StepperError> {
        let found = self.specs.len();
        if found != 2 {
            return Err(StepperError::NoPair { found });
        }
        self.require_uniform("joint")
    }

    /// Lets the lowest layer carry the other along: what it looks out for is the first wave of the
    /// pair, its mesh is as fine as the finer one needs.
    fn join(&mut self) {
        let pair = self.pairs[0];
        let modes = [pair.joint, pair.fine];
        let strains = modes.iter().flatten().map(|mode| mode.critical_strain);
        let own = self.wrinkling[0];
        if let Some(mode) = pair.joint {
            self.wrinkling[0].wavelength = mode.wavelength;
            self.wrinkling[0].wave_number = mode.wave_number;
            self.wrinkling[0].critical_strain = mode.critical_strain;
        }
        let wavelength = own.wavelength.min(pair.upper.wrinkling.wavelength);
        self.simulated[0] = Wrinkling {
            wavelength,
            wave_number: TAU / wavelength,
            critical_strain: strains.fold(own.critical_strain, f64::min),
            // Both carry what wrinkling relieves.
            membrane_stiffness: own.membrane_stiffness + pair.upper.wrinkling.membrane_stiffness,
            ..own
        };
        // Rows as close as the fine waves would hold down the large ones.
        self.specs[0].coupling = Coupling::Elastic;
        let offset = self.attachments[1].offset;
        self.joint = Some(UpperShell::new(&self.specs[1].name, 1, &pair, offset));
    }

    /// Puts the upper layers on those below; `layers` have their real thicknesses.
    fn attach(&mut self, layers: &[LayerSpec], stack: Stack) {
        for (k, pair) in self.pairs.iter().enumerate() {
            let upper = k + 1;
            // Both shells are mid-surfaces. Li 2014, eq. 4.1, adds all of the upper layer's
            // thickness.
            let step = 0.5 * (layers[k].material.thickness + layers[upper].material.thickness);
            // A layer with wrinkles of its own needs tangential springs at their scale: with the
            // shear stiffness of the layer below, 6 to 60 times softer, fine wrinkles run together
            // into few folds. A composite and a pair are meant to be physical: held by shear, and stretched by all
            // of the bending below. A composite is held by more where it slides by short lengths; a pair is not.
            let (stiffness, gradient, transfer) = match stack {
                Stack::Nominal => (
                    pair.nominal_tangential_stiffness(),
                    0.0,
                    pair.bending_transfer,
                ),
                Stack::Composite => (
                    pair.shear_tangential_stiffness(),
                    pair.drift_gradient_stiffness(self.wrinkling[upper].wave_number),
                    1.0,
                ),
                Stack::Joint => (pair.shear_tangential_stiffness(), 0.0, 1.0),
            };
            // Where nothing is painted, the layer's springs are taken from here.
            self.wrinkling[upper].tangential_stiffness = stiffness;
            self.attachments[upper] = Attachment {
                offset: self.attachments[k].offset + step,
                bending_transfer: layers[upper].bending_transfer.unwrap_or(transfer),
                tangential: Some(TangentialSprings {
                    stiffness,
                    gradient,
                }),
            };
            // Rows that hold a layer on a wrinkled one would leave their own pattern in it.
            if self.specs[upper].coupling == Coupling::Hybrid {
                self.specs[upper].coupling = Coupling::Elastic;
            }
        }
    }

    /// Warnings about the stack.
    pub(crate) fn warnings(&self, stack: Stack) -> Vec<String> {
        let pairs = self.pairs.iter().zip(self.specs.windows(2));
        let disagreeing =
            pairs.filter(|(pair, _)| stack == Stack::Nominal && pair.nominal_disagrees());
        disagreeing
            .filter_map(|(pair, names)| Some((pair.joint?, names)))
            .map(|(joint, names)| {
                format!(
                    "real skin made of layers '{}' and '{}' would wrinkle together every {:.2} mm from {:.1} % compression on. With `stack = \"nominal\"`, as here, each has the wrinkles of its own numbers instead: leave it if that is what you painted; for the wrinkles of both together set `stack = \"composite\"`",
                    names[0].name,
                    names[1].name,
                    1e3 * joint.wavelength,
                    100.0 * joint.critical_strain
                )
            })
            .collect()
    }
}

/// Growths of a layer that stands for itself and those above it: where one of them grows, all of them take the
/// share that its stiffness enforces.
fn composite_growths(layers: &[LayerSpec], alone: &[StackLayer]) -> Vec<GrowthSpec> {
    let stiffness = |layer: &StackLayer| layer.wrinkling.membrane_stiffness;
    let whole: f64 = alone.iter().map(stiffness).sum();
    let of_layers = layers.iter().zip(alone).flat_map(|(layer, alone)| {
        let share = stiffness(alone) / whole;
        let own = layer
            .growths
            .iter()
            .filter(|growth| growth.grows == Grows::Layer);
        own.map(move |growth| GrowthSpec {
            along: share * growth.along,
            across: share * growth.across,
            ..growth.clone()
        })
    });
    // What lies below all of them is the same for each.
    let below = layers[0]
        .growths
        .iter()
        .filter(|growth| growth.grows == Grows::Below);
    of_layers.chain(below.cloned()).collect()
}

fn alone(layer: &LayerSpec) -> Result<StackLayer, StepperError> {
    let numbers = wrinkling(&layer.material, &layer.substrate, layer.model);
    Ok(StackLayer {
        material: layer.material,
        wrinkling: numbers.map_err(|source| material(layer, source))?,
    })
}

fn material(layer: &LayerSpec, source: ruga_material::MaterialError) -> StepperError {
    StepperError::Material {
        layer: layer.name.clone(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use ruga_material::preset;

    use super::*;

    /// An upper layer of a composite is held against short sliding, at its own fine wave as by a half-space; also where
    /// it stands for others above it, whose wave is longer than its own.
    #[test]
    fn composites_are_held_against_short_sliding() {
        let layer = |name| LayerSpec {
            variation: None,
            ..LayerSpec::from_preset(preset(name).expect("a preset"), 0).expect("valid")
        };
        let mut top = layer("face2-epidermis");
        top.material.thickness = 0.005e-3;
        let layers = [layer("face2-dermis"), layer("face2-epidermis"), top];
        let stacked = |stack| Stacking::new(&layers, stack).expect("a stack");
        let nominal = stacked(Stack::Nominal);
        let composite = stacked(Stack::Composite);
        let springs = |of: &Stacking| -> Vec<_> {
            let attached = of.attachments.iter().filter_map(|to| to.tangential);
            attached.collect()
        };
        assert!(springs(&nominal).iter().all(|own| own.gradient == 0.0));
        for (k, own) in springs(&composite).into_iter().enumerate() {
            let wave_number = composite.wrinkling[k + 1].wave_number;
            let held = own.stiffness + own.gradient * wave_number * wave_number;
            let lower = layers[k].material;
            let half_space = 0.5 * lower.young / (1.0 - lower.poisson.powi(2)) * wave_number;
            assert!((held / half_space - 1.0).abs() < 1e-12, "{held}");
            assert!(own.stiffness < 0.5 * half_space, "{}", own.stiffness);
        }
        assert!(composite.wrinkling[1].wavelength > 1.01 * nominal.wrinkling[1].wavelength);
    }
}
