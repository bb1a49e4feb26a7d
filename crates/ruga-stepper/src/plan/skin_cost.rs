//! What a planned layer will cost, from runs of the shipped scenes on one core.

use crate::PoseSpec;
use crate::plan::pose_plan::LoadPath;
use crate::run::patches::Width;

/// Bytes for every texel of a map while it is baked and written.
pub const BYTES_PER_TEXEL: f64 = 30.0;
/// Bytes for every vertex planned of the lowest layer's output mesh, one that is fine in all directions; halving leaves
/// more vertices than planned. From a smile of 69 thousand and hands of 35 to 350.
const PER_OUTPUT_VERTEX: f64 = 2.6e3;
/// The same for layers on others, whose meshes are fine across the waves alone and fitted to coarser ones, and which
/// have given back what solved them before.
const PER_OUTPUT_VERTEX_ABOVE: f64 = 1e3;
/// Factorisations in which the first wrinkles are found, on the whole of a layer or in wide patches.
const FIRST: f64 = 17.0;
/// Vertices of a wide patch with its overlap, over those without.
const OVERLAPPED: f64 = 1.5;
/// Bytes for every vertex of a layer in patches, which overlap and are kept from solve to solve until a key is
/// reached.
const IN_PATCHES: f64 = 1e4;
/// Bytes for every vertex of a layer so large that its patches are set up when it is their turn: from the upper one of
/// two layers under raised brows, which has 906 thousand and takes 3.9 GB on two threads.
const IN_WIDE_PATCHES: f64 = 4.3e3;
/// Bytes of the program with its scene: of the forearm 80 million, of a face with 55 shapes 140.
const BASE: f64 = 1.1e8;

/// Seconds of preparation for every vertex of the layer's mesh.
const PREPARATION: f64 = 2.3e-4;
/// Seconds of preparation for every vertex of the output mesh.
const OUTPUT_PREPARATION: f64 = 1.8e-5;
/// Seconds of a numeric factorisation, with all that goes with it, for a vertex count to the power 3/2 and 1.
const FACTOR: [f64; 2] = [1.15e-7, 2.1e-6];

/// Vertices made for every one counted: triangles between sizes are smaller. With it 53 shapes of a face at 12 points,
/// and 199 poses with two presets at 6, have .92 to 1.16 of the vertices that are planned.
pub(crate) const GRADING: f64 = 1.15;

/// Vertices of a layer of which the factorisations are counted; larger ones have more places that take steps of their
/// own.
const COUNTED: f64 = 5e3;
/// Factorisations at least.
const FEWEST: f64 = 8.0;
/// Share of a layer that is compressed beyond 15 % from which on it takes more factorisations: a jaw with .30 takes no
/// more than others.
const MUCH_CAPPED: f64 = 0.3;
/// Factorisations added where all of a layer is compressed beyond 15 %, in those without: poses of a hand with shares
/// of .48, .57 and .87 take 1.4, 1.9 and 1.8 times as many, for which 1.4, 1.6 and 2.2 are told.
const MORE_CAPPED: f64 = 1.5;

/// Measures of the work that the lowest layer will be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    /// Fraction of the last key at which the layer begins to wrinkle, in (0, 1].
    pub(crate) onset: f64,
    /// Vertices of its mesh.
    pub(crate) vertices: f64,
    /// Share of its area that is compressed beyond 15 %.
    pub(crate) capped: f64,
}

/// Seconds and bytes of a pose, as 55 shapes of a face, at 550 to 18 thousand vertices, and four poses of a hand at 14
/// to 82 thousand take on one thread of a machine that does nothing else: all within 1.5 times. Meshes of 20 points and
/// more take less, because the pattern is found on a coarse one.
///
/// A numeric factorisation, with all that goes with it, grows with the 3/2 power of the vertices
/// (nested dissection of a surface), its memory with `n log n`; beyond `most_in_whole` vertices the layer
/// is solved in patches after its first wrinkles, and beyond some times as many from the beginning, and both
/// grow with its size. The output mesh has `output_vertices`; maps are `map_size` texels wide, and the time that it
/// takes to bake them is not counted. Of the lowest layer all memory is added up, though what it is solved with is given
/// back before its surfaces are made, and output meshes that are fine across the waves alone have fewer vertices: 590 MB
/// for a smile that takes 490. Layers on others take what solves them or what shows them: raised brows of 906 thousand
/// vertices 3.9 GB, for which 5.1 are told.
pub(crate) fn cost(
    (vertices, is_lowest): (usize, bool),
    most_in_whole: usize,
    output_vertices: f64,
    map_size: u32,
    factorisations: f64,
) -> (f64, f64) {
    let n = vertices as f64;
    let factorisation = |in_one: usize| n * (FACTOR[0] * (in_one as f64).sqrt() + FACTOR[1]);
    let first = FIRST.min(factorisations);
    let of_first = match Width::Wide.suits(vertices, most_in_whole) {
        true => {
            let core = Width::Wide.core(most_in_whole) as f64;
            OVERLAPPED * factorisation((OVERLAPPED * core) as usize)
        }
        false => factorisation(vertices),
    };
    let work =
        first * of_first + (factorisations - first) * factorisation(vertices.min(most_in_whole));
    let preparation = PREPARATION * n + OUTPUT_PREPARATION * output_vertices;
    let texels = f64::from(map_size).powi(2);
    // The logarithm of no vertex is infinite, and none times that is not a number.
    let factor = |n: f64| n * (900.0 + 260.0 * n.max(2.0).log2());
    let of_layer = if Width::Wide.suits(vertices, most_in_whole) {
        let patch = OVERLAPPED * Width::Wide.core(most_in_whole) as f64;
        IN_WIDE_PATCHES * n + IN_PATCHES * patch + factor(patch)
    } else if vertices > most_in_whole {
        IN_PATCHES * n
    } else {
        factor(n)
    };
    let of_layer = match is_lowest {
        true => of_layer + PER_OUTPUT_VERTEX * output_vertices,
        false => of_layer.max(PER_OUTPUT_VERTEX_ABOVE * output_vertices),
    };
    let memory = BASE + of_layer + BYTES_PER_TEXEL * texels;
    (preparation + work, memory)
}

/// Factorisations of a layer in one pose whose keys alone are wanted.
///
/// The lowest layer takes about twelve at every key, fourteen more for every doubling of the strain beyond the onset,
/// and nine more for every doubling of its size; and up to two and a half times as many where more than
/// [`MUCH_CAPPED`] of it is compressed beyond 15 %. One on another layer takes forty-five to wrinkle on what that has
/// become at the first key, and goes on from there in thirty.
pub(crate) fn factorisations(lowest: Option<Load>, pose: &PoseSpec, path: LoadPath) -> f64 {
    let keys = pose.keys.len() as f64;
    let Some(lowest) = lowest else {
        return 15.0 + 30.0 * keys;
    };
    let doublings = lowest.onset.recip().log2();
    let onsets = match path {
        LoadPath::Weight => 1.0,
        LoadPath::Strain => keys,
    };
    let larger = (lowest.vertices / COUNTED).log2();
    let capped = (lowest.capped - MUCH_CAPPED).max(0.0) / (1.0 - MUCH_CAPPED);
    (1.0 + MORE_CAPPED * capped)
        * (12.0 * keys + 14.0 * doublings * onsets + 9.0 * larger).max(FEWEST)
}

#[cfg(test)]
mod tests {
    use ruga_blend::Weights;

    use super::*;

    #[test]
    fn in_patches_time_grows_with_the_size() {
        // Of the work after the first wrinkles.
        let seconds = |vertices| {
            let all = |count| cost((vertices, true), 5000, 0.0, 1, count).0;
            all(100.0) - all(FIRST)
        };
        let [small, large] = [10_000, 40_000].map(seconds);
        assert!((large / small - 4.0).abs() < 1e-9, "{small} s, {large} s");
        assert!(seconds(4000) / seconds(1000) > 4.2);
        // Of all of it, where the first wrinkles are in patches, too.
        let of = |vertices| cost((vertices, true), 5000, 0.0, 1, 100.0);
        let [small, large] = [40_000, 160_000].map(of);
        assert!((large.0 / small.0 - 4.0).abs() < 1e-9);
    }

    #[test]
    fn work_grows_with_load_size_and_keys() {
        let pose = |keys: Vec<f64>| PoseSpec {
            name: "pose".into(),
            weights: Weights::default(),
            keys,
            steps: 6,
            motions: Vec::new(),
            growths: Vec::new(),
            half: false,
        };
        let least = Load {
            onset: 1.0,
            vertices: COUNTED,
            capped: 0.0,
        };
        let of = |onset, vertices, pose: &PoseSpec, path| {
            let load = Load {
                onset,
                vertices,
                ..least
            };
            factorisations(Some(load), pose, path)
        };
        let plain = pose(vec![1.0]);
        let (weight, strain) = (LoadPath::Weight, LoadPath::Strain);
        assert_eq!(of(1.0, COUNTED, &plain, weight), 12.0);
        assert_eq!(of(0.5, COUNTED, &plain, weight), 26.0);
        assert_eq!(of(0.5, 2.0 * COUNTED, &plain, weight), 35.0);
        // However small, and even without any vertex.
        assert_eq!(of(1.0, 10.0, &plain, weight), FEWEST);
        assert_eq!(of(1.0, 0.0, &plain, weight), FEWEST);
        let two_keys = pose(vec![0.5, 1.0]);
        assert_eq!(of(0.5, COUNTED, &two_keys, weight), 38.0);
        assert_eq!(of(0.5, COUNTED, &two_keys, strain), 52.0);
        assert_eq!(factorisations(None, &plain, weight), 45.0);
        let capped = |capped| factorisations(Some(Load { capped, ..least }), &plain, weight);
        assert_eq!([0.2, MUCH_CAPPED].map(capped), [12.0; 2]);
        assert!((capped(0.65) - 21.0).abs() < 1e-9);
    }
}
