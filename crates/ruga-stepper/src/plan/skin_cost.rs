//! What a planned layer will cost, from runs of the shipped scenes on one core.

use crate::PoseSpec;
use crate::plan::pose_plan::LoadPath;

/// Bytes for every texel of a map while it is baked and written.
const PER_TEXEL: f64 = 30.0;

/// Vertices made for every one planned: triangles at borders and between sizes are smaller.
pub(crate) const GRADING: f64 = 1.08;

/// Measures of the work that the lowest layer will be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    /// Fraction of the last key at which the layer begins to wrinkle, in (0, 1].
    pub(crate) onset: f64,
    /// Critical wavelength over the radius to which the base bends where it bends most.
    pub(crate) bend: f64,
    /// Longest critical wavelength over the shortest, at least 1.
    pub(crate) spread: f64,
}

/// Seconds and bytes of a pose, from runs at 1 to 150 thousand vertices.
///
/// A numeric factorisation, with all that goes with it, grows with the 3/2 power of the vertices
/// (nested dissection of a surface), its memory with `n log n`; the mesh that results are handed
/// out on has eight kilobytes for every one of its vertices, `output_vertices`; maps are `map_size`
/// texels wide.
pub(crate) fn cost(
    vertices: usize,
    output_vertices: f64,
    map_size: u32,
    factorisations: f64,
) -> (f64, f64) {
    let n = vertices as f64;
    let factorisation = 1.2e-7 * n.powf(1.5) + 7e-6 * n;
    let texels = f64::from(map_size).powi(2);
    // The logarithm of no vertex is infinite, and none times that is not a number.
    let memory =
        n * (900.0 + 260.0 * n.max(2.0).log2()) + 8e3 * output_vertices + PER_TEXEL * texels;
    (factorisations * factorisation, memory)
}

/// Factorisations of a layer in one pose.
///
/// The lowest layer takes about thirty to find its onset and as many again for every doubling of
/// the load beyond it, in at least four for each load step; up to twice as many on a base that
/// bends within a wavelength, where even a smooth layer is not at rest in one iteration, and more by
/// six tenths where the wavelength doubles from place to place, as waves end in between. One on
/// another layer takes two hundred to wrinkle on what that has become at the first key, and goes on
/// from there in thirty.
pub(crate) fn factorisations(lowest: Option<Load>, pose: &PoseSpec, path: LoadPath) -> f64 {
    let keys = pose.keys.len() as f64;
    let Some(lowest) = lowest else {
        return 170.0 + 30.0 * keys;
    };
    let doublings = lowest.onset.recip().log2();
    let uneven = (1.0 + lowest.bend.min(1.0).powi(2)) * (1.0 + 0.6 * lowest.spread.log2());
    let once = (28.0 + 36.0 * doublings) * uneven;
    let steps = f64::from(pose.steps);
    match path {
        LoadPath::Weight => {
            let last = pose.keys.iter().copied().fold(0.0, f64::max);
            once.max(4.0 * steps * last)
        }
        LoadPath::Strain => keys * once.max(4.0 * steps),
    }
}

#[cfg(test)]
mod tests {
    use ruga_blend::Weights;

    use super::*;

    #[test]
    fn work_grows_with_load_bends_waves_and_steps() {
        let pose = |keys: Vec<f64>, steps| PoseSpec {
            name: "pose".into(),
            weights: Weights::default(),
            keys,
            steps,
            motions: Vec::new(),
        };
        let of = |onset, bend, spread, pose: &PoseSpec, path| {
            factorisations(
                Some(Load {
                    onset,
                    bend,
                    spread,
                }),
                pose,
                path,
            )
        };
        let plain = pose(vec![1.0], 6);
        let (weight, strain) = (LoadPath::Weight, LoadPath::Strain);
        assert_eq!(of(1.0, 0.0, 1.0, &plain, weight), 28.0);
        assert_eq!(of(0.5, 0.0, 1.0, &plain, weight), 64.0);
        assert_eq!(of(0.5, 5.0, 1.0, &plain, weight), 128.0);
        assert_eq!(of(0.5, 0.0, 2.0, &plain, weight), 1.6 * 64.0);
        // Half of the steps lie beyond the only key.
        assert_eq!(of(1.0, 0.0, 1.0, &pose(vec![0.5], 200), weight), 400.0);
        assert_eq!(of(0.5, 0.0, 1.0, &pose(vec![0.5, 1.0], 6), strain), 128.0);
        assert_eq!(factorisations(None, &plain, weight), 200.0);
    }
}
