//! Lines through the texels of a skeleton, from end to end or branch to branch.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::thinning::{BLUNT, Bitmap};

/// A chain of texels between two nodes; a node is an end of a line or a place where several meet.
#[derive(Clone, Debug)]
pub(crate) struct Branch {
    /// Texel centres, nodes included (texels).
    pub(crate) points: Vec<Vector2<f64>>,
    /// The nodes at both ends; `None` for a ring.
    pub(crate) nodes: Option<[usize; 2]>,
}

impl Branch {
    /// Length in texels.
    pub(crate) fn length(&self) -> f64 {
        self.points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum()
    }
}

/// The branches of a skeleton. Texels that touch and have three neighbours or more are one node.
pub(crate) fn branches(skeleton: &Bitmap) -> Vec<Branch> {
    let set = (0..skeleton.is_set.len()).filter(|&at| skeleton.is_set[at]);
    let texels: BTreeMap<usize, Vec<usize>> = set.map(|at| (at, skeleton.set_beside(at))).collect();
    let centre =
        |at: usize| Vector2::new((at % skeleton.width) as f64, (at / skeleton.width) as f64);
    let (node_of, centres) = nodes(&texels, &centre);
    let mut used: BTreeMap<usize, bool> = texels.keys().map(|&at| (at, false)).collect();
    let mut found = Vec::new();
    for (&start, beside) in &texels {
        let Some(&node) = node_of.get(&start) else {
            continue;
        };
        for &next in beside {
            if node_of.get(&next) == Some(&node) || (!node_of.contains_key(&next) && used[&next]) {
                continue;
            }
            // Of two nodes side by side the lower one makes the branch.
            if node_of.get(&next).is_some_and(|&other| other < node) {
                continue;
            }
            let (chain, end) = follow(&texels, &node_of, (start, next), &mut used);
            let end_node = end.map_or(node, |end| node_of[&end]);
            let inner = chain.iter().map(|&at| centre(at));
            let points = std::iter::once(centres[node])
                .chain(inner)
                .chain([centres[end_node]]);
            found.push(Branch {
                points: points.collect(),
                nodes: Some([node, end_node]),
            });
        }
    }
    // What is left are rings.
    for &start in texels.keys() {
        if used[&start] || node_of.contains_key(&start) {
            continue;
        }
        used.insert(start, true);
        let Some(&next) = texels[&start].first() else {
            continue;
        };
        let (chain, _) = follow(&texels, &node_of, (start, next), &mut used);
        let points = std::iter::once(start).chain(chain).map(centre).collect();
        found.push(Branch {
            points,
            nodes: None,
        });
    }
    found
}

/// The node of every texel that is part of one, and the centres of the nodes.
fn nodes(
    texels: &BTreeMap<usize, Vec<usize>>,
    centre: &impl Fn(usize) -> Vector2<f64>,
) -> (BTreeMap<usize, usize>, Vec<Vector2<f64>>) {
    let mut node_of = BTreeMap::new();
    let mut centres = Vec::new();
    for (&at, beside) in texels {
        if beside.len() == 2 || node_of.contains_key(&at) {
            continue;
        }
        let is_junction = beside.len() > 2;
        let (mut members, mut next) = (vec![at], 0);
        node_of.insert(at, centres.len());
        while is_junction && next < members.len() {
            for &other in &texels[&members[next]] {
                if texels[&other].len() > 2 && !node_of.contains_key(&other) {
                    node_of.insert(other, centres.len());
                    members.push(other);
                }
            }
            next += 1;
        }
        let sum: Vector2<f64> = members.iter().map(|&at| centre(at)).sum();
        centres.push(sum / members.len() as f64);
    }
    (node_of, centres)
}

/// Follows a chain from a texel and its neighbour to the next node, or until no texel is left.
fn follow(
    texels: &BTreeMap<usize, Vec<usize>>,
    node_of: &BTreeMap<usize, usize>,
    (start, next): (usize, usize),
    used: &mut BTreeMap<usize, bool>,
) -> (Vec<usize>, Option<usize>) {
    let (mut chain, mut before, mut at) = (Vec::new(), start, next);
    loop {
        if node_of.contains_key(&at) {
            return (chain, Some(at));
        }
        if used.insert(at, true) == Some(true) {
            return (chain, None);
        }
        chain.push(at);
        let onward = texels[&at].iter().find(|&&other| other != before);
        let Some(&onward) = onward else {
            return (chain, None);
        };
        (before, at) = (at, onward);
    }
}

/// Removes twigs shorter than a length (texels) that end freely beside a junction, or that are the way into a blunt
/// corner of the shape, and joins what two branches leave of a node.
///
/// `radius` is that of the largest disc around a place inside the shape (texels).
pub(crate) fn pruned(
    mut branches: Vec<Branch>,
    least: f64,
    radius: impl Fn(&Vector2<f64>) -> f64,
) -> Vec<Branch> {
    // Radii are those of whole texels: one may be off by half of one.
    let is_blunt = |branch: &Branch| match &branch.points[..] {
        [first, .., last] => (radius(first) - radius(last)).abs() + 1.0 > BLUNT * branch.length(),
        _ => false,
    };
    loop {
        let degrees = degrees(&branches);
        let is_twig = |branch: &Branch| {
            // One end is free, the other is not.
            let hangs = |[a, b]: [usize; 2]| (degrees[&a] == 1) != (degrees[&b] == 1);
            branch.nodes.is_some_and(hangs) && (branch.length() < least || is_blunt(branch))
        };
        let before = branches.len();
        branches.retain(|branch| !is_twig(branch));
        let joined = join_one(&mut branches);
        if branches.len() == before && !joined {
            return branches;
        }
    }
}

pub(crate) fn degrees(branches: &[Branch]) -> BTreeMap<usize, usize> {
    let mut degrees = BTreeMap::new();
    for node in branches.iter().filter_map(|branch| branch.nodes).flatten() {
        *degrees.entry(node).or_insert(0) += 1;
    }
    degrees
}

/// Joins two branches at a node where no third one ends; says whether it did.
fn join_one(branches: &mut Vec<Branch>) -> bool {
    let degrees = degrees(branches);
    let Some((&node, _)) = degrees.iter().find(|(_, degree)| **degree == 2) else {
        return false;
    };
    let at = |branch: &Branch| branch.nodes.is_some_and(|nodes| nodes.contains(&node));
    let Some(first) = branches.iter().position(at) else {
        return false;
    };
    let mut branch = branches.swap_remove(first);
    let Some(second) = branches.iter().position(at) else {
        // Both ends are this node: a ring.
        branch.points.pop();
        branch.nodes = None;
        branches.push(branch);
        return true;
    };
    let mut other = branches.swap_remove(second);
    if let Some([from, to]) = branch.nodes
        && from == node
    {
        branch.points.reverse();
        branch.nodes = Some([to, from]);
    }
    if let Some([from, to]) = other.nodes
        && to == node
    {
        other.points.reverse();
        other.nodes = Some([to, from]);
    }
    if let (Some([start, _]), Some([_, end])) = (branch.nodes, other.nodes) {
        branch.points.extend(other.points.into_iter().skip(1));
        branch.nodes = Some([start, end]);
    }
    branches.push(branch);
    true
}
