//! Crease lines of a layer.

use ruga_blend::Weights;
use ruga_crease::{CreaseMemory, Drive, LARGEST_ANGLE, LineLaw, TracedLine};
use ruga_material::Wrinkling;
use ruga_shell::{Crease, FoldSense};

/// A line along which a layer folds more easily than elsewhere, and is drawn into a fold.
#[derive(Clone, Debug)]
pub struct CreaseSpec {
    /// Name in reports and messages.
    pub name: String,
    /// The line, over the triangles of the driver ([`ruga_blend::Driver::topology`]) at rest.
    pub line: TracedLine,
    /// Width, stiffness, fold angle, and how they fade towards its ends.
    pub law: LineLaw,
    /// Whether it is drawn into a ridge, and not into a furrow.
    pub is_ridge: bool,
    /// The sides to which it may fold: that of the above, or both.
    pub sense: FoldSense,
    /// What its fold angle and its anchor's depth follow; softness is there in every pose.
    pub drive: Drive,
    /// Springs that hold the line, while it is drawn, at a depth below the skin around it; none on a free sheet.
    pub anchor: Option<CreaseAnchor>,
    /// Depth inwards along the mean of the normals around (m) to which the flesh of a soft body is cut below the line, in every pose, at
    /// least a cell of its lattice; the layer goes across the cut. Only on a soft body.
    pub slit: Option<f64>,
    /// What it keeps of earlier folds, in every pose.
    pub memory: CreaseMemory,
    /// Whether it takes up, as a fold, what the skin within a wavelength is compressed by beyond what wrinkles can
    /// take ([`ruga_material::capped_strain`]). Only on a driver.
    pub absorbs: bool,
}

/// Springs that draw a crease towards a depth.
///
/// On a driver they count the depth from the posed surface, which stands still. On a soft body their lower ends lie in
/// the flesh, at rest straight below the line in that depth, and move with it: line and flesh draw each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreaseAnchor {
    /// Depth at full strength (m), ≥ 0; of a mountain fold the height.
    pub depth: f64,
    /// Stiffness in units of `K0 l`, with the bending length `l = 1/k_c`: the force per area of the
    /// substrate, over a strip as wide as `l`. 0 to [`Self::MOST_STIFFNESS`]; with 20 a line at rest sinks to 0.91 of
    /// the depth.
    pub stiffness: f64,
}

impl CreaseAnchor {
    /// Largest stiffness: with it a line at rest sinks to 0.98 of the depth. Stiffer springs add nothing, and throw
    /// skin out of the way when they are deep.
    pub const MOST_STIFFNESS: f64 = 100.0;
}

impl CreaseSpec {
    /// Strength in a pose of these weights in full, at a `load` of it: 0 to 1.
    pub(crate) fn strength(&self, weights: &Weights, load: f64) -> f64 {
        let Drive::Weights(_) = &self.drive else {
            return self.drive.strength(load, &[]);
        };
        let mut by_shape: Vec<f64> = Vec::new();
        for (shape, weight) in weights.iter() {
            if by_shape.len() <= shape {
                by_shape.resize(shape + 1, 0.0);
            }
            by_shape[shape] += load * weight;
        }
        self.drive.strength(load, &by_shape)
    }

    /// Whether the line is folded at a strength by what draws it or by what it keeps, and does not only give way.
    pub(crate) fn is_drawn(&self, strength: f64) -> bool {
        let depth = self.anchor.map_or(0.0, |anchor| anchor.depth);
        let is_drawn = strength > 0.0 && (self.law.angle > 0.0 || depth > 0.0);
        is_drawn || self.memory.is_folded()
    }

    /// Share of its length at an arc length (m), of a closed line around and around.
    pub(crate) fn share(&self, at: f64) -> f64 {
        let share = at / self.line.length();
        match self.line.is_closed() {
            true => share.rem_euclid(1.0),
            false => share,
        }
    }

    /// Strength that the ends of the line leave at an arc length (m): 1 but near an end.
    pub(crate) fn taper(&self, at: f64) -> f64 {
        let (length, is_closed) = (self.line.length(), self.line.is_closed());
        self.law.taper(at, length, is_closed)
    }

    /// Strength that the ends of the line leave between two arc lengths (m).
    pub(crate) fn mean_taper(&self, ends: [f64; 2]) -> f64 {
        let [from, to] = ends.map(|at| self.taper(at));
        0.5 * (from + to)
    }

    /// Compressive strain at which a layer that wrinkles like this folds along the line, in critical
    /// strains.
    pub(crate) fn onset_ratio(&self, wrinkling: &Wrinkling) -> f64 {
        let kappa = wrinkling.crease_stiffness(self.softness());
        wrinkling.crease_strain(kappa) / wrinkling.critical_strain
    }

    /// Compliance times bending modulus where it is softest, m.
    pub fn softness(&self) -> f64 {
        self.law.softness(1.0) + self.memory.largest_softness()
    }

    /// The crease between two arc lengths (m), in a layer of bending modulus `D` (N m), drawn with a `strength`
    /// and with a share `remembered` of what it keeps.
    pub(crate) fn on_edge(
        &self,
        ends: [f64; 2],
        (strength, remembered): (f64, f64),
        modulus: f64,
    ) -> Crease {
        let mean = |[from, to]: [f64; 2]| 0.5 * (from + to);
        let taper = self.mean_taper(ends);
        let kept = ends.map(|at| self.memory.at(self.share(at)));
        let kept_angle = mean(kept.map(|kept| kept.angle));
        let kept_softness = mean(kept.map(|kept| kept.softness));
        let angle = self.law.rest_angle(taper * strength);
        let drawn = if self.is_ridge { -angle } else { angle };
        Crease {
            compliance: (self.law.softness(taper) + taper * kept_softness) / modulus,
            rest_angle: (drawn + taper * remembered * kept_angle)
                .clamp(-LARGEST_ANGLE, LARGEST_ANGLE),
            sense: self.sense,
        }
    }

    /// Raises an angle (rad) or an anchor's depth (m) to `least`, to the side that the crease is drawn to.
    pub(crate) fn at_least(&self, drawn: f64, least: f64) -> f64 {
        if self.is_ridge {
            drawn.min(-least)
        } else {
            drawn.max(least)
        }
    }

    /// Depth below the skin around it that an anchor draws the line to, at a strength (m); negative for a height.
    pub(crate) fn anchor_depth(&self, anchor: CreaseAnchor, strength: f64) -> f64 {
        if self.is_ridge {
            -strength * anchor.depth
        } else {
            strength * anchor.depth
        }
    }
}
