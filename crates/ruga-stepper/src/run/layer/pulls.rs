//! What the anchors of creases pull with, and what averaging constraints have to know of it.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Vector2, Vector3};
use ruga_material::{CreaseLoad, Wrinkling, anchor_pull};
use ruga_mesh::{FaceId, Id, VertexId, triangle_frame};
use ruga_shell::{LineAnchor, line_spring_pulls};

use super::Layer;

/// Pulls that are off by less than what stretches the springs of an anchor by this share of its depth are not worth
/// another solve. The line itself is off by less: it answers a wrong pull by a fifth of it (soft anchors) to seven
/// tenths.
const SETTLED: f64 = 0.03;

/// Share of the layer's thickness that counts as the depth of a shallower anchor.
const SHALLOW: f64 = 0.1;

/// Share of the first change that is taken over, since the line will take up the rest.
const FIRST_SHARE: f64 = 0.8;

/// Shares of later changes that are taken over.
const LEAST_SHARE: f64 = 0.3;
const MOST_SHARE: f64 = 1.0;

/// How far what anchors pull with draws skin down in the mean, by vertices (m).
pub(super) type DrawnDown = Vec<(usize, f64)>;

/// What averaging constraints are told of the pulls of anchors.
#[derive(Clone, Debug, Default)]
pub(super) struct ToldPulls {
    told: DrawnDown,
    /// How far creases sink as they fold, and lift the skin beside them, which theory alone says.
    furrows: DrawnDown,
    /// How far what is told is beyond what theory expects, by vertices: what one equilibrium has shown the next begins
    /// with.
    beyond: BTreeMap<usize, f64>,
    /// What the solve before has found to be off, and the share of it that was taken over.
    change: Option<(Vec<f64>, f64)>,
}

/// An edge on a crease with an anchor.
struct AnchoredEdge {
    /// Its number among the edges on creases.
    rank: usize,
    /// The number of its line.
    line: usize,
    anchor: LineAnchor,
    /// The vertices at its ends.
    ends: [usize; 2],
    /// Length at rest, m.
    length: f64,
}

impl ToldPulls {
    /// The share of what pulls are `off` by now that is taken over: that which would have left least of what they were
    /// off by before.
    fn next_share(&self, off: &[f64]) -> f64 {
        let Some((off_before, share)) = &self.change else {
            return FIRST_SHARE;
        };
        let (mut along, mut square) = (0.0, 0.0);
        for (before, off) in off_before.iter().zip(off) {
            let change = before - off;
            along += before * change;
            square += change * change;
        }
        if square > 0.0 {
            (share * along / square).clamp(LEAST_SHARE, MOST_SHARE)
        } else {
            *share
        }
    }

    /// Takes over a share of what pulls were found to be `off` by.
    fn take(&mut self, off: Vec<f64>) {
        let share = self.next_share(&off);
        for ((v, told), off) in self.told.iter_mut().zip(&off) {
            *told += share * off;
            *self.beyond.entry(*v).or_default() += share * off;
        }
        self.change = Some((off, share));
    }
}

impl Layer {
    /// What anchors pull with, and folds draw with, moves every vertex by where averages are taken of it (m); `None`
    /// where nothing does.
    pub(super) fn drawn_down(&self) -> Option<Vec<Vector3<f64>>> {
        let (told, furrows) = (&self.pulls.told, &self.pulls.furrows);
        if told.is_empty() && furrows.is_empty() {
            return None;
        }
        let mut ways = vec![Vector3::zeros(); self.base.len()];
        for (v, way) in told.iter().chain(furrows) {
            ways[*v] -= *way * self.support.posed.normals[*v];
        }
        Some(ways)
    }

    /// Tells averaging constraints before a solve what theory expects anchors to pull with, and what the last
    /// equilibrium had beyond that, and how lines lie that fold.
    pub(crate) fn expect_pulls(&mut self) {
        // Where rows act alone nothing else carries what an anchor pulls with.
        let has_both = self.rows.count() > 0 && self.spec.coupling.has_foundation();
        let (mut told, furrows) = match has_both {
            true => (self.predicted_pulls(), self.furrows()),
            false => (DrawnDown::new(), DrawnDown::new()),
        };
        for (v, way) in &mut told {
            *way += self.pulls.beyond.get(v).unwrap_or(&0.0);
        }
        (self.pulls.told, self.pulls.furrows) = (told, furrows);
        self.pulls.change = None;
    }

    /// How far what anchors pull with in the present state, an equilibrium, is off from what averaging constraints were
    /// told of it; `None` where another solve is not worth it.
    pub(crate) fn pulls_off(&self) -> Option<Vec<f64>> {
        let told = &self.pulls.told;
        if told.is_empty() {
            return None;
        }
        let found = self.present_pulls();
        let takes_up = self.on_lines_that_take_up();
        let off = |((v, told), (_, found)): (&(usize, f64), &(usize, f64))| {
            // Beside lines that take up compression little carries the skin, a way is long for a small pull, and what
            // theory expects is as good.
            let is_left = takes_up.contains(v) || !self.is_carried_in_full(*v);
            if is_left { 0.0 } else { found - told }
        };
        let off: Vec<f64> = told.iter().zip(&found).map(off).collect();
        (!self.has_settled(&off)).then_some(off)
    }

    /// Tells averaging constraints for another solve of what [`Self::pulls_off`] has found.
    pub(crate) fn tell_pulls(&mut self, off: Vec<f64>) {
        self.pulls.take(off);
    }

    /// Whether pulls that are off by so much (as ways of the skin, m) leave lines where they are.
    fn has_settled(&self, off: &[f64]) -> bool {
        let mut deepest: BTreeMap<usize, f64> = BTreeMap::new();
        for edge in self.anchored_edges() {
            let shallow = SHALLOW * self.spec.material.thickness;
            let of_line = deepest.entry(edge.line).or_insert(shallow);
            for depth in edge.anchor.depths {
                *of_line = of_line.max(depth.abs());
            }
        }
        let mut springs: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
        for edge in self.anchored_edges() {
            for v in edge.ends {
                let (stiffness, depth) = springs.entry(v).or_default();
                *stiffness += 0.5 * edge.length * edge.anchor.stiffness;
                *depth = depth.max(deepest[&edge.line]);
            }
        }
        let mut ways = self.pulls.told.iter().zip(off);
        ways.all(|((v, _), off)| {
            let (stiffness, depth) = springs[v];
            (off * self.carrying(*v)).abs() <= SETTLED * depth * stiffness
        })
    }

    /// How far the anchors of creases draw the layer down where averages are taken of it, with what theory expects
    /// them to pull with.
    ///
    /// What an anchor pulls with, the foundation carries: in the mean the skin beside it lies lower. Averages that were
    /// held where they are without anchors would take that back, of a soft one a fifth of its depth. How hard it pulls
    /// is what the linear theory of one straight line says at the present compression across it.
    fn predicted_pulls(&self) -> DrawnDown {
        self.drawn_by(|edge| {
            let pull =
                |depth| 0.5 * edge.length * self.pull(edge.rank, (edge.anchor.stiffness, depth));
            edge.anchor.depths.map(pull)
        })
    }

    /// The same with what they pull with in the present state: at a line that folds by itself large deflections limit
    /// the depth, of which the linear theory knows nothing.
    fn present_pulls(&self) -> DrawnDown {
        if let Some(solid) = &self.solid {
            let mut pulls: BTreeMap<usize, f64> = BTreeMap::new();
            for (v, slope) in solid.anchor_pulls(&self.positions) {
                let v = v as usize;
                *pulls.entry(v).or_default() += slope.dot(&self.support.posed.normals[v]);
            }
            return self.ways(pulls);
        }
        let heights = self.heights();
        self.drawn_by(|edge| {
            let excess = [0, 1].map(|end| heights[edge.ends[end]] + edge.anchor.depths[end]);
            line_spring_pulls(edge.anchor.stiffness * edge.length, excess)
        })
    }

    /// How far pulls (N) at the ends of edges draw the layer down, by vertices.
    fn drawn_by(&self, pulls: impl Fn(&AnchoredEdge) -> [f64; 2]) -> DrawnDown {
        let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
        for edge in self.anchored_edges() {
            for (v, pull) in edge.ends.into_iter().zip(pulls(&edge)) {
                *sums.entry(v).or_default() += pull;
            }
        }
        self.ways(sums)
    }

    /// How far pulls (N) draw the layer down in the mean, by vertices.
    fn ways(&self, pulls: BTreeMap<usize, f64>) -> DrawnDown {
        let way = |(v, pull): (usize, f64)| (v, pull / self.carrying(v));
        pulls.into_iter().map(way).collect()
    }

    /// The edges on creases with an anchor, drawn as now.
    fn anchored_edges(&self) -> impl Iterator<Item = AnchoredEdge> + '_ {
        (0..self.skin.creases.len()).filter_map(|rank| {
            let anchor = self.drawn_anchor(rank)?;
            let ends = self.skin.mesh.edges()[anchor.edge].vertices.map(Id::index);
            let [from, to] = ends.map(|v| self.skin.rest.positions[v]);
            Some(AnchoredEdge {
                rank,
                line: self.skin.creases[rank].line,
                anchor,
                ends,
                length: (to - from).norm(),
            })
        })
    }

    /// Force per length (N/m) with which springs of a `stiffness` (Pa) draw the crease on an edge to a `depth` (m).
    fn pull(&self, rank: usize, anchor: (f64, f64)) -> f64 {
        self.beside(self.skin.creases[rank].edge, |face| {
            let (load, wave) = (self.crease_load(rank, face, anchor), self.wrinkling(face));
            anchor_pull(&load) * self.foundation(face) / (wave.wave_number * wave.wave_number)
        })
    }

    /// What loads the crease on an edge, with springs of a stiffness (Pa) that draw it to a depth (m), for the skin of
    /// a face beside it.
    pub(super) fn crease_load(
        &self,
        rank: usize,
        face: FaceId,
        (stiffness, depth): (f64, f64),
    ) -> CreaseLoad {
        let edge = self.skin.creases[rank].edge;
        let crease = self.drawn_crease(rank);
        let (mesh, rest) = (&self.skin.mesh, &self.skin.rest.positions);
        let [from, to] = mesh.edges()[edge].vertices.map(|v| rest[v.index()]);
        let wave = self.wrinkling(face);
        let frame = triangle_frame(&mesh.faces()[face].map(|v| rest[v.index()]));
        let along = frame.map(|axis| axis.dot(&(to - from)));
        let across = Vector2::new(-along[1], along[0]).normalize();
        CreaseLoad {
            load: wave.reduced_load(self.strain_ratios().across(face, &across)),
            stiffness: wave.crease_stiffness(crease.compliance * wave.bending_stiffness),
            rest_angle: crease.rest_angle,
            anchor: stiffness * wave.wave_number / self.foundation(face),
            anchor_depth: depth * wave.wave_number,
        }
    }

    pub(super) fn wrinkling(&self, face: FaceId) -> &Wrinkling {
        &self.properties.on_face(face).wrinkling
    }

    /// What is left of the foundation below a face, Pa/m. Lengths are those of skin that is held in full, also where
    /// less is left.
    fn foundation(&self, face: FaceId) -> f64 {
        self.wrinkling(face).normal_stiffness * self.absorption.carried(face.index())
    }

    /// The vertices on lines that take up compression.
    fn on_lines_that_take_up(&self) -> BTreeSet<usize> {
        let edges = self.anchored_edges();
        let edges = edges.filter(|edge| self.spec.creases[edge.line].absorbs);
        edges.flat_map(|edge| edge.ends).collect()
    }

    /// Whether all of the foundation holds the faces around a vertex.
    fn is_carried_in_full(&self, vertex: usize) -> bool {
        let faces = self.skin.mesh.vertex_faces(VertexId::from_index(vertex));
        let mut carried = faces
            .iter()
            .map(|face| self.absorption.carried(face.index()));
        carried.all(|share| share == 1.0)
    }

    /// Stiffness of the foundation below a vertex, N/m.
    pub(super) fn carrying(&self, vertex: usize) -> f64 {
        let (mesh, rest) = (&self.skin.mesh, &self.skin.rest.positions);
        let faces = mesh.vertex_faces(VertexId::from_index(vertex)).iter();
        let of_face = |&face: &FaceId| {
            let [a, b, c] = mesh.faces()[face].map(|v| rest[v.index()]);
            (b - a).cross(&(c - a)).norm() / 6.0 * self.foundation(face)
        };
        faces.map(of_face).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a wrong pull the line takes up seven tenths, against it.
    #[test]
    fn the_second_change_leaves_nothing_where_lines_answer_alike() {
        let answer = 0.7;
        let first = [1.0, -2.0];
        let mut pulls = ToldPulls {
            told: vec![(0, 0.0), (1, 0.0)],
            ..ToldPulls::default()
        };
        pulls.take(first.to_vec());
        let left = 1.0 - FIRST_SHARE * (1.0 + answer);
        let off = first.map(|off| left * off);
        let share = pulls.next_share(&off);
        assert!((share * (1.0 + answer) - 1.0).abs() < 1e-12, "{share}");
        // Nothing has changed: nothing is learnt.
        assert_eq!(pulls.next_share(&first), FIRST_SHARE);
        pulls.take(off.to_vec());
        for (v, first) in first.into_iter().enumerate() {
            let whole = first / (1.0 + answer);
            assert!((pulls.told[v].1 - whole).abs() < 1e-12);
            assert!((pulls.beyond[&v] - whole).abs() < 1e-12);
        }
    }
}
