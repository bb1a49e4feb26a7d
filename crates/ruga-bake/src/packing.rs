//! Several poses in one map: which share it, the masks that tell them apart, and the way back.
//!
//! A pose's *region* is where its maps differ from neutral. Poses whose regions are apart may share a
//! map; those that overlap are neighbours in a graph whose colours are the maps (DSATUR, Brélaz 1979).

use petgraph::algo::dsatur_coloring;
use petgraph::graph::{NodeIndex, UnGraph};
use thiserror::Error;

/// Texels by which regions are grown: filtered at its border, a mask is whole where the map is not
/// neutral.
const MARGIN: usize = 2;

/// Poses in one mask image: red, green, blue, alpha.
pub const POSES_PER_MASK: usize = 4;

/// The texels that a pose needs in a packed map, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseRegion {
    /// Texels per side.
    size: usize,
    inside: Vec<bool>,
}

impl PoseRegion {
    /// A region without texels.
    pub fn new(size: u32) -> Self {
        let size = size as usize;
        Self {
            size,
            inside: vec![false; size * size],
        }
    }

    /// Adds the texels whose stored values, 0 to 1 and one per channel of `neutral`, are not neutral to so
    /// many `steps` of 8 bits: half a one, or one and a half where values were dithered to 8 bits, which takes
    /// them a step away from what they were.
    pub fn add(&mut self, values: &[f32], neutral: &[f32], steps: f32) {
        let least = steps / 255.0;
        let texels = values.chunks_exact(neutral.len());
        for (inside, texel) in self.inside.iter_mut().zip(texels) {
            let mut pairs = texel.iter().zip(neutral);
            *inside |= pairs.any(|(value, neutral)| (value - neutral).abs() > least);
        }
    }

    /// The region with a margin of two texels, in which its map is neutral.
    pub fn with_margin(&self) -> Self {
        let mut grown = self.clone();
        let size = self.size;
        for texel in (0..self.inside.len()).filter(|&texel| self.inside[texel]) {
            let around = |at: usize| at.saturating_sub(MARGIN)..(at + MARGIN + 1).min(size);
            for row in around(texel / size) {
                let row = row * size;
                let columns = around(texel % size);
                grown.inside[row + columns.start..row + columns.end].fill(true);
            }
        }
        grown
    }

    /// Whether the texel is one of the region.
    pub fn contains(&self, texel: usize) -> bool {
        self.inside[texel]
    }

    fn overlaps(&self, other: &Self) -> bool {
        let mut pairs = self.inside.iter().zip(&other.inside);
        pairs.any(|(a, b)| *a && *b)
    }
}

/// Poses that overlap need more maps than there are to be.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{} poses overlap more than {maps} maps can hold apart; {needed} maps can", poses.len())]
pub struct TooFewMaps {
    /// Number of maps that were allowed.
    pub maps: usize,
    /// Number of maps that are enough.
    pub needed: usize,
    /// Poses, by number, that all overlap one another where that alone is too many; else those that no
    /// map was left for.
    pub poses: Vec<usize>,
}

/// The map of every pose: poses whose regions overlap have different ones. A pose has a region for each UDIM
/// tile, or one; all of them are in one map.
///
/// # Errors
/// [`TooFewMaps`] when more than `maps` are needed.
pub fn share_maps(regions: &[Vec<PoseRegion>], maps: usize) -> Result<Vec<usize>, TooFewMaps> {
    if regions.is_empty() {
        return Ok(Vec::new());
    }
    let mut graph = UnGraph::<(), ()>::with_capacity(regions.len(), 0);
    let nodes: Vec<NodeIndex> = regions.iter().map(|_| graph.add_node(())).collect();
    for a in 0..regions.len() {
        for b in 0..a {
            let mut tiles = regions[a].iter().zip(&regions[b]);
            if tiles.any(|(a, b)| a.overlaps(b)) {
                graph.add_edge(nodes[a], nodes[b], ());
            }
        }
    }
    let (colours, needed) = dsatur_coloring(&graph);
    let map_of: Vec<usize> = nodes.iter().map(|node| colours[node]).collect();
    if needed <= maps {
        return Ok(map_of);
    }
    let clique = largest_clique(&graph, &nodes);
    let left_over = || (0..nodes.len()).filter(|&pose| map_of[pose] >= maps);
    Err(TooFewMaps {
        maps,
        needed,
        poses: match clique.len() > maps {
            true => clique,
            false => left_over().collect(),
        },
    })
}

/// The largest set of poses, all overlapping one another, that is found by beginning with each pose and
/// taking in what fits.
fn largest_clique(graph: &UnGraph<(), ()>, nodes: &[NodeIndex]) -> Vec<usize> {
    let from = |first: usize| {
        let mut clique = vec![first];
        for other in (0..nodes.len()).filter(|&other| other != first) {
            let mut members = clique.iter();
            if members.all(|&m| graph.contains_edge(nodes[m], nodes[other])) {
                clique.push(other);
            }
        }
        clique.sort_unstable();
        clique
    };
    // Of equal ones the first, for the same message every time.
    let cliques = (0..nodes.len()).map(from);
    cliques.fold(Vec::new(), |best, next| match next.len() > best.len() {
        true => next,
        false => best,
    })
}

/// Lays a pose's stored values into a packed map that was neutral in its region.
pub fn pack(packed: &mut [f32], values: &[f32], channels: usize, region: &PoseRegion) {
    let texels = packed.chunks_exact_mut(channels);
    for (texel, (packed, own)) in texels.zip(values.chunks_exact(channels)).enumerate() {
        if region.contains(texel) {
            packed.copy_from_slice(own);
        }
    }
}

/// The mask image of up to four poses: 255 in the region of each, in its channel of red, green, blue and
/// alpha; 0 elsewhere.
pub fn mask_image(regions: &[&PoseRegion], size: u32) -> Vec<u8> {
    let texels = size as usize * size as usize;
    let mut rgba = vec![0; POSES_PER_MASK * texels];
    for (texel, channels) in rgba.chunks_exact_mut(POSES_PER_MASK).enumerate() {
        for (channel, region) in channels.iter_mut().zip(regions) {
            *channel = if region.contains(texel) { 255 } else { 0 };
        }
    }
    rgba
}

/// A pose's own map from a packed one, as a shader does it: from neutral to the packed value by the mask.
///
/// `mask` is the pose's channel of the mask image, a value per texel.
pub fn unpack(packed: &[f32], neutral: &[f32], mask: impl IntoIterator<Item = u8>) -> Vec<f32> {
    let texels = packed.chunks_exact(neutral.len()).zip(mask);
    texels
        .flat_map(|(texel, mask)| {
            let weight = f32::from(mask) / 255.0;
            let pairs = texel.iter().zip(neutral);
            pairs.map(move |(value, neutral)| neutral + (value - neutral) * weight)
        })
        .collect()
}

/// Strength at which the map of a whole pose is nearest to the map of one of its keys: least squares over
/// the deviations from neutral of all texels that were added.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KeyStrength {
    product: f64,
    square: f64,
}

impl KeyStrength {
    /// Adds the stored values of a map, or of one of its UDIM tiles; `neutral` has one per channel.
    pub fn add(&mut self, whole: &[f32], key: &[f32], neutral: &[f32]) {
        let neutral = neutral.iter().cycle().copied().map(f64::from);
        for ((whole, key), neutral) in whole.iter().zip(key).zip(neutral) {
            let (whole, key) = (f64::from(*whole) - neutral, f64::from(*key) - neutral);
            self.product += whole * key;
            self.square += whole * whole;
        }
    }

    /// The strength, at least 0; 0 where nothing deviates.
    pub fn value(self) -> f64 {
        if self.square > 0.0 {
            (self.product / self.square).max(0.0)
        } else {
            0.0
        }
    }
}
