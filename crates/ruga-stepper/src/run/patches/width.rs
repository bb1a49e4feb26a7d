//! How wide patches are, and what they are for.

/// Width of the patches of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Width {
    /// Some four wavelengths: enough to go on from a pattern that is there.
    Narrow,
    /// Some ten wavelengths: enough to find a pattern, and to go on where narrow ones slide together. Only
    /// for layers that would be too large as a whole.
    Wide,
}

/// Patches, at least, of a layer that is large enough for some.
const FEWEST: usize = 3;

/// Vertices of a wide patch's core, over those up to which a layer is solved as a whole.
const WIDER: usize = 2;

/// Share of what one sweep of narrow patches gains above which the next one gains so little less that wide
/// ones, or the whole, go on instead: patches then slide together, and each holds the averages that it shares
/// with others.
const SLOWLY: f64 = 0.75;

/// Share that some more sweeps with extrapolations leave of what one has gained that was slower than [`SLOWLY`]. More
/// to go is not waited for; less is, because wide patches would begin with all of the layer again.
const LEFT_BY_MORE: f64 = 0.2;

/// Sweeps of narrow patches, after which wide ones or the whole go on.
const MOST_NARROW_SWEEPS: usize = 12;

/// Sweeps of wide patches, after which nothing else is tried.
const MOST_SWEEPS: usize = 30;

impl Width {
    /// Whether a layer of so many free vertices is large enough for such patches, where one of
    /// `most_in_whole` is solved as a whole.
    pub(crate) fn suits(self, vertices: usize, most_in_whole: usize) -> bool {
        vertices > FEWEST.saturating_mul(self.core(most_in_whole))
    }

    /// Vertices, at most, of a patch without its overlap.
    pub(crate) fn core(self, most_in_whole: usize) -> usize {
        match self {
            Self::Narrow => (most_in_whole / FEWEST).max(1),
            Self::Wide => most_in_whole.saturating_mul(WIDER),
        }
    }

    /// Overlap in wavelengths across the wrinkles. Narrow: at 12 points, in patches of 2500 vertices, a smile ends
    /// .8 % from the whole's amplitude with half a wavelength, and .3 % with a whole one, in 1.3 times the
    /// time.
    pub(super) fn overlap(self) -> f64 {
        match self {
            Self::Narrow => 0.5,
            Self::Wide => 1.0,
        }
    }

    /// Whether sweeps end without a result after so many: the last one gained this `share` of the gain before it, and a
    /// gain of `little` times its own would have been the last.
    pub(super) fn ends(self, sweeps: usize, share: f64, little: f64) -> bool {
        match self {
            Self::Narrow => sweeps >= MOST_NARROW_SWEEPS || share > SLOWLY && LEFT_BY_MORE > little,
            Self::Wide => sweeps >= MOST_SWEEPS,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_go_on_while_they_gain_or_are_nearly_done() {
        let ends = |share, little| Width::Narrow.ends(2, share, little);
        assert!(!ends(0.7, 0.01), "fast enough");
        assert!(ends(0.8, 0.15), "some more would not do");
        assert!(!ends(0.8, 0.25), "some more will do");
        assert!(
            Width::Narrow.ends(12, f64::NAN, f64::INFINITY),
            "nothing moves, and something has not converged"
        );
        assert!(
            !Width::Wide.ends(2, 1.0, 0.0),
            "nothing else is left to try"
        );
    }
}
