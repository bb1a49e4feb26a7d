//! What a crease keeps of how far it was folded.

/// How skin keeps folds: beyond a limit a fold stays, and the line becomes softer.
///
/// On a line this is the plasticity of Narain, Pfaff and O'Brien 2013, without its history: what is kept depends
/// on the largest fold alone, and so not on the order of poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YieldLaw {
    /// Angle (rad) beyond its rest angle that a fold springs back by, > 0.
    pub limit: f64,
    /// Share by which the softness of a line grows when it was folded by twice the limit, ≥ 0.
    pub weakening: f64,
}

/// What a place of a crease keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kept {
    /// Fold angle in which it has no moment (rad), positive in a valley.
    pub angle: f64,
    /// Compliance times the layer's bending modulus that it has gained, m.
    pub softness: f64,
}

/// What a crease keeps in every pose, along its line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CreaseMemory {
    /// Share of the line's length, ascending, and what it keeps there.
    samples: Vec<(f64, Kept)>,
}

impl YieldLaw {
    /// Angle that stays (rad) of a fold that was turned by `elastic` (rad) beyond where it has no moment, to the side
    /// of its sign. A fold held short of there is not turned beyond it: that is no negative `elastic`.
    pub fn stays(&self, elastic: f64) -> f64 {
        (elastic.abs() - self.limit).max(0.0).copysign(elastic)
    }

    /// What a place keeps that was turned by `elastic` (rad) as in [`Self::stays`]; `softness` (m) is the line's own,
    /// which grows.
    pub fn kept(&self, elastic: f64, softness: f64) -> Kept {
        let damage = (elastic.abs() / self.limit - 1.0).max(0.0);
        Kept {
            angle: self.stays(elastic),
            softness: self.weakening * damage * softness,
        }
    }
}

impl CreaseMemory {
    /// A memory by samples along the line, each with its share of the line's length; they are put in order.
    pub fn new(mut samples: Vec<(f64, Kept)>) -> Self {
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { samples }
    }

    /// A memory by samples along a closed line, on which the last one is followed by the first.
    pub fn around(samples: Vec<(f64, Kept)>) -> Self {
        let mut memory = Self::new(samples);
        if let (Some(&first), Some(&last)) = (memory.samples.first(), memory.samples.last()) {
            memory.samples.insert(0, (last.0 - 1.0, last.1));
            memory.samples.push((first.0 + 1.0, first.1));
        }
        memory
    }

    /// The samples in order: share of the line's length and what it keeps there.
    pub fn samples(&self) -> &[(f64, Kept)] {
        &self.samples
    }

    /// What the line keeps at a share of its length: between samples linear, beyond the outer ones as there.
    pub fn at(&self, share: f64) -> Kept {
        let after = self.samples.partition_point(|sample| sample.0 <= share);
        let before = after.checked_sub(1).and_then(|i| self.samples.get(i));
        match (before, self.samples.get(after)) {
            (Some(&(_, kept)), None) | (None, Some(&(_, kept))) => kept,
            (None, None) => Kept::default(),
            (Some(&(from, a)), Some(&(to, b))) => {
                let t = (share - from) / (to - from);
                Kept {
                    angle: a.angle + t * (b.angle - a.angle),
                    softness: a.softness + t * (b.softness - a.softness),
                }
            }
        }
    }

    /// Whether the line is folded somewhere without anything that folds it.
    pub fn is_folded(&self) -> bool {
        self.samples.iter().any(|(_, kept)| kept.angle != 0.0)
    }

    /// Largest angle that it keeps (rad), with its sign.
    pub fn largest_angle(&self) -> f64 {
        let angles = self.samples.iter().map(|(_, kept)| kept.angle);
        angles.fold(0.0, |a, b| if b.abs() > a.abs() { b } else { a })
    }

    /// Largest softness that it has gained, m.
    pub fn largest_softness(&self) -> f64 {
        let gained = self.samples.iter().map(|(_, kept)| kept.softness);
        gained.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: YieldLaw = YieldLaw {
        limit: 0.3,
        weakening: 0.5,
    };

    #[test]
    fn what_is_beyond_the_limit_stays() {
        assert_eq!(LAW.kept(0.2, 1.0), Kept::default());
        let kept = LAW.kept(-0.9, 2e-3);
        assert!((kept.angle + 0.6).abs() < 1e-15);
        assert!((kept.softness - 0.5 * 2.0 * 2e-3).abs() < 1e-15);
        // What stays has no moment: turned as far again, nothing more stays.
        assert_eq!(LAW.stays(-0.9 - kept.angle).abs(), 0.0);
    }

    #[test]
    fn a_memory_is_linear_between_its_samples() {
        let kept = |angle| Kept {
            angle,
            softness: 2.0 * angle,
        };
        let memory = CreaseMemory::new(vec![(0.75, kept(1.0)), (0.25, kept(0.0))]);
        assert_eq!(memory.at(0.0), kept(0.0));
        assert_eq!(memory.at(0.5), kept(0.5));
        assert_eq!(memory.at(1.0), kept(1.0));
        assert_eq!(CreaseMemory::default().at(0.5), Kept::default());
        assert_eq!(memory.largest_angle(), 1.0);
        let ring = CreaseMemory::around(vec![(0.25, kept(0.0)), (0.75, kept(1.0))]);
        assert_eq!([ring.at(0.0), ring.at(1.0)], [kept(0.5); 2]);
    }
}
