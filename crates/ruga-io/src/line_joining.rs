//! Polylines from the line elements of a mesh.

use std::collections::{HashMap, HashSet};

use nalgebra::Vector3;

use crate::LineCurve;

/// Lines as a file groups them.
pub(crate) enum LineElement {
    /// An edge, to be joined to those that share its ends.
    Pair([Vector3<f64>; 2]),
    /// A polyline; closed if it ends where it begins.
    Strip(Vec<Vector3<f64>>),
    /// A closed polyline.
    Loop(Vec<Vector3<f64>>),
}

/// Joins pairs that share a point into polylines, and keeps strips and loops.
///
/// Lines without length are left out. Polylines come in the order of their first edge.
pub(crate) fn join(elements: &[LineElement]) -> Vec<LineCurve> {
    let mut pairs = Pairs::default();
    let mut curves = Vec::new();
    for (place, element) in elements.iter().enumerate() {
        match element {
            LineElement::Pair(ends) => pairs.add(place, ends),
            LineElement::Strip(points) => curves.push((place, curve(points.clone(), false))),
            LineElement::Loop(points) => curves.push((place, curve(points.clone(), true))),
        }
    }
    curves.extend(pairs.chains());
    curves.sort_by_key(|(place, _)| *place);
    let curves = curves.into_iter().map(|(_, curve)| curve);
    curves.filter(|curve| curve.points.len() >= 2).collect()
}

/// The polyline without repeated points. Two points make no closed line: its edges would coincide.
fn curve(mut points: Vec<Vector3<f64>>, is_loop: bool) -> LineCurve {
    points.dedup();
    let returns = points.len() > 1 && points.first() == points.last();
    if returns {
        points.pop();
    }
    LineCurve {
        is_closed: (is_loop || returns) && points.len() >= 3,
        points,
    }
}

/// Edges between points that are told apart by their coordinates: exporters give each edge vertices
/// of its own. Equal indices have equal coordinates.
#[derive(Default)]
struct Pairs {
    points: Vec<Vector3<f64>>,
    number_of: HashMap<[u64; 3], usize>,
    /// Ends of each edge, in file order.
    edges: Vec<[usize; 2]>,
    /// Place of each edge among the elements.
    places: Vec<usize>,
    known: HashSet<[usize; 2]>,
    edges_at: Vec<Vec<usize>>,
}

impl Pairs {
    /// Adds an edge that has a length and is not there yet.
    fn add(&mut self, place: usize, ends: &[Vector3<f64>; 2]) {
        let [a, b] = ends.each_ref().map(|point| self.number(point));
        if a == b || !self.known.insert([a.min(b), a.max(b)]) {
            return;
        }
        for end in [a, b] {
            self.edges_at[end].push(self.edges.len());
        }
        self.edges.push([a, b]);
        self.places.push(place);
    }

    fn number(&mut self, point: &Vector3<f64>) -> usize {
        // Adding zero makes -0 the same as 0.
        let key: [u64; 3] = (*point).map(|c| (c + 0.0).to_bits()).into();
        *self.number_of.entry(key).or_insert_with(|| {
            self.points.push(*point);
            self.edges_at.push(Vec::new());
            self.points.len() - 1
        })
    }

    /// Polylines, each with the place of its first edge, whose direction it has.
    fn chains(&self) -> Vec<(usize, LineCurve)> {
        let mut is_taken = vec![false; self.edges.len()];
        let mut chains = Vec::new();
        for (first, [from, to]) in self.edges.iter().enumerate() {
            if std::mem::replace(&mut is_taken[first], true) {
                continue;
            }
            let ahead = self.walk(*to, &mut is_taken);
            let behind = self.walk(*from, &mut is_taken);
            let numbers = behind.iter().rev().chain(&ahead);
            let points = numbers.map(|number| self.points[*number]).collect();
            chains.push((self.places[first], curve(points, false)));
        }
        chains
    }

    /// Points from `start` along edges that are not taken, to an end or a branching.
    fn walk(&self, start: usize, is_taken: &mut [bool]) -> Vec<usize> {
        let mut numbers = vec![start];
        let mut at = start;
        while let [a, b] = self.edges_at[at][..] {
            let Some(next) = [a, b].into_iter().find(|edge| !is_taken[*edge]) else {
                break;
            };
            is_taken[next] = true;
            let [from, to] = self.edges[next];
            at = if from == at { to } else { from };
            numbers.push(at);
        }
        numbers
    }
}
