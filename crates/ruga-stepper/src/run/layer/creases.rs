//! The creases of a layer: how they are drawn, and how they have folded.

use std::f64::consts::PI;

use ruga_blend::Weights;
use ruga_material::Wrinkling;
use ruga_mesh::{EdgeId, FaceId, Id};
use ruga_shell::{Crease, LineAnchor};

use super::absorption::AbsorbedFold;
use super::{Layer, layer_parameters};
use crate::skin::fading::{distances_from, faded};
use crate::skin::quiet::VertexDemand;
use crate::{CreaseReport, FoldSample, StepperError};

/// Distance from a crease (wavelengths) within which skin that it draws shows relief. What it raises beside it
/// dies out within three quarters of a wavelength, and relief fades over the half before the end.
const REACH: f64 = 1.25;

/// Strength from which on an anchor holds with all of its stiffness.
const HELD: f64 = 0.2;

/// Share of its stiffness with which an anchor holds a line that is drawn with a strength.
fn held(strength: f64) -> f64 {
    faded(strength, HELD)
}

/// What the creases of a layer are drawn to.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CreaseStrengths {
    /// Strength of every line.
    lines: Vec<f64>,
    /// Share of what they keep of earlier folds.
    kept: f64,
    /// Share of what they take up of the compression, once the surface below is in its place.
    taken_up: f64,
    /// What they take up now, by edges on creases; empty for none.
    folds: Vec<AbsorbedFold>,
}

impl CreaseStrengths {
    /// Strengths a `share` of the way to others.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |from: f64, to: f64| from + (to - from) * share;
        let lines = self.lines.iter().zip(&other.lines);
        let fold = |rank| self.fold(rank).towards(other.fold(rank), share);
        Self {
            lines: lines.map(|(from, to)| between(*from, *to)).collect(),
            kept: between(self.kept, other.kept),
            taken_up: between(self.taken_up, other.taken_up),
            folds: (0..self.folds.len().max(other.folds.len()))
                .map(fold)
                .collect(),
        }
    }

    fn fold(&self, rank: usize) -> AbsorbedFold {
        self.folds.get(rank).copied().unwrap_or_default()
    }
}

impl Layer {
    /// Draws the creases as a pose of these weights in full does at a `load` of it.
    ///
    /// Of what creases take up of the compression it draws the share `taken_up`.
    pub(crate) fn draw_creases(
        &mut self,
        weights: &Weights,
        (load, taken_up): (f64, f64),
    ) -> Result<(), StepperError> {
        let creases = self.spec.creases.iter();
        self.set_crease_strengths(CreaseStrengths {
            lines: creases
                .map(|crease| crease.strength(weights, load))
                .collect(),
            // What is kept of earlier folds is there in every pose.
            kept: 1.0,
            taken_up,
            folds: self.taken_up_folds(taken_up),
        })
    }

    /// Strengths of creases that are not drawn, and keep nothing.
    pub(super) fn undrawn(&self) -> CreaseStrengths {
        CreaseStrengths {
            lines: vec![0.0; self.spec.creases.len()],
            ..CreaseStrengths::default()
        }
    }

    /// What the creases are drawn to.
    pub(crate) fn crease_strengths(&self) -> &CreaseStrengths {
        &self.crease_strengths
    }

    /// Draws every crease a `share` of the way from what it was drawn to `before` to what it is drawn to now.
    pub(crate) fn draw_part_of_creases(
        &mut self,
        before: &CreaseStrengths,
        share: f64,
    ) -> Result<(), StepperError> {
        if share == 1.0 {
            return Ok(());
        }
        self.set_crease_strengths(before.towards(&self.crease_strengths, share))
    }

    pub(super) fn set_crease_strengths(
        &mut self,
        strengths: CreaseStrengths,
    ) -> Result<(), StepperError> {
        if self.skin.creases.is_empty() || self.crease_strengths == strengths {
            return Ok(());
        }
        self.crease_strengths = strengths;
        self.fold_creases()
    }

    /// A share of what the creases take up of the present strains, by edges on them.
    fn taken_up_folds(&self, share: f64) -> Vec<AbsorbedFold> {
        let edges = 0..self.absorption.edges();
        edges
            .map(|rank| self.absorption.fold(rank).part(share))
            .collect()
    }

    /// Lets the creases take up what they can of the present strains.
    pub(super) fn absorb(&mut self) -> Result<(), StepperError> {
        let absorption = self
            .bands
            .absorption(&self.strains, self.skin.creases.len());
        if absorption != self.absorption {
            let held = self.spec.coupling.has_foundation();
            let mut faces = layer_parameters(&self.properties, held).faces;
            for (number, face) in faces.iter_mut().enumerate() {
                let left = absorption.carried(number);
                face.normal_stiffness *= left;
                face.gradient_stiffness *= left;
            }
            let outcome = self.energy.set_face_parameters(&faces);
            outcome.map_err(|source| self.shell_error(source))?;
            self.absorption = absorption;
        }
        self.set_crease_strengths(CreaseStrengths {
            folds: self.taken_up_folds(self.crease_strengths.taken_up),
            ..self.crease_strengths.clone()
        })
    }

    /// The crease on an edge on one, by its rank among these, drawn as now.
    pub(super) fn drawn_crease(&self, rank: usize) -> Crease {
        let (on_edge, strengths) = (&self.skin.creases[rank], &self.crease_strengths);
        let spec = &self.spec.creases[on_edge.line];
        let wave = |face| &self.properties.on_face(face).wrinkling;
        let modulus = self.beside(on_edge.edge, |face| wave(face).bending_stiffness);
        let drawn = (strengths.lines[on_edge.line], strengths.kept);
        let crease = spec.on_edge(on_edge.at, drawn, modulus);
        let taper = spec.mean_taper(on_edge.at);
        let least = taper * strengths.fold(rank).angle;
        Crease {
            rest_angle: spec.at_least(crease.rest_angle, least),
            ..crease
        }
    }

    /// Gives the edges on creases the angles and depths of the present strengths.
    fn fold_creases(&mut self) -> Result<(), StepperError> {
        let ranks = 0..self.skin.creases.len();
        let creases: Vec<_> = ranks
            .clone()
            .map(|rank| (self.skin.creases[rank].edge, self.drawn_crease(rank)))
            .collect();
        let anchors: Vec<_> = ranks.filter_map(|rank| self.drawn_anchor(rank)).collect();
        let outcome = self.energy.set_creases(&creases);
        let outcome = outcome.and_then(|()| match &mut self.solid {
            None => self.energy.set_line_anchors(&anchors),
            // They hold to places inside the body, which move with it.
            Some(solid) => {
                solid.set_line_anchors(&anchors);
                Ok(())
            }
        });
        outcome.map_err(|source| self.shell_error(source))
    }

    /// What holds an edge on a crease down, by its rank among these, drawn as now; `None` without an anchor.
    pub(super) fn drawn_anchor(&self, rank: usize) -> Option<LineAnchor> {
        let on_edge = &self.skin.creases[rank];
        let spec = &self.spec.creases[on_edge.line];
        let anchor = spec.anchor?;
        let strength = self.crease_strengths.lines[on_edge.line];
        let fold = self.crease_strengths.fold(rank);
        let unit = |face| {
            let wave: &Wrinkling = &self.properties.on_face(face).wrinkling;
            wave.normal_stiffness / wave.wave_number
        };
        let depth = |taper: f64| {
            let drawn = spec.anchor_depth(anchor, taper * strength);
            spec.at_least(drawn, taper * fold.depth)
        };
        Some(LineAnchor {
            edge: on_edge.edge,
            // It fades with the crease, or it would hold the skin down beyond its tips; and a line
            // that is not drawn is free, or wrinkles of other poses could not cross it.
            stiffness: spec.mean_taper(on_edge.at)
                * held(strength.max(fold.share_of_largest()))
                * anchor.stiffness
                * self.beside(on_edge.edge, unit),
            depths: on_edge.at.map(|at| depth(spec.taper(at))),
        })
    }

    /// Mean over the faces beside an edge.
    pub(super) fn beside(&self, edge: EdgeId, value: impl Fn(FaceId) -> f64) -> f64 {
        let faces = self.skin.mesh.edges()[edge].faces;
        let values = faces.into_iter().flatten().map(value);
        let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
        sum / f64::from(count)
    }

    /// Whether the present strengths draw the crease number `line`.
    fn is_drawn(&self, line: usize) -> bool {
        let strengths = &self.crease_strengths;
        let mut folds = self.skin.creases.iter().zip(&strengths.folds);
        folds.any(|(crease, fold)| crease.line == line && fold.angle > 0.0)
            || strengths
                .lines
                .get(line)
                .is_some_and(|&strength| self.spec.creases[line].is_drawn(strength))
    }

    /// Raises the demand of the vertices that a drawn crease or a slit reaches to at least `least`: relief shows
    /// there, however little the skin is compressed.
    pub(super) fn raise_near_creases(&self, ratios: &mut [f64], least: f64) {
        let shows = |line| self.is_drawn(line) || self.spec.creases[line].slit.is_some();
        for v in self.near_creases(shows) {
            ratios[v] = ratios[v].max(least);
        }
    }

    /// Lets the surface below turn as sharply as it will near slits: it does so because the skin folds into them, not
    /// because it is a rim on which skin cannot wrinkle.
    pub(super) fn let_turn_near_slits(&self, demands: &mut [VertexDemand]) {
        for v in self.near_creases(|line| self.spec.creases[line].slit.is_some()) {
            demands[v].turn = PI;
        }
    }

    /// The vertices within [`REACH`] of creases for whose numbers `is_meant` holds.
    fn near_creases(&self, is_meant: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut is_on = vec![false; self.vertex_count()];
        for crease in &self.skin.creases {
            if is_meant(crease.line) {
                for v in self.skin.mesh.edges()[crease.edge].vertices {
                    is_on[v.index()] = true;
                }
            }
        }
        if !is_on.contains(&true) {
            return Vec::new();
        }
        let waves = self.properties.at_vertices();
        let waves = waves.map(|local| local.wrinkling.wavelength);
        let longest = waves.clone().fold(0.0, f64::max);
        let places = &self.skin.rest.positions;
        let distances = distances_from(&self.skin.mesh, places, &is_on, REACH * longest);
        let near = distances.into_iter().zip(waves).enumerate();
        let near = near.filter(|(_, (distance, wavelength))| *distance <= REACH * wavelength);
        near.map(|(v, _)| v).collect()
    }

    /// How every crease has folded, in the order of the layer's specification; none for those that have no
    /// edge on this mesh.
    pub(crate) fn crease_reports(&self) -> Vec<CreaseReport> {
        let states = self.energy.crease_states(&self.positions);
        let heights = self.heights();
        let mut reports: Vec<CreaseReport> = Vec::new();
        for (line, spec) in self.spec.creases.iter().enumerate() {
            let own = self.skin.creases.iter().zip(&states).enumerate();
            let own = own.filter(|(_, (crease, _))| crease.line == line);
            let mut report = CreaseReport::of(spec);
            for (rank, (crease, state)) in own {
                let ends = self.skin.mesh.edges()[crease.edge].vertices.map(Id::index);
                let [a, b] = ends.map(|v| self.skin.rest.positions[v]);
                let depth = ends.map(|v| -heights[v]);
                report.add(
                    (b - a).norm(),
                    (state.angle, 0.5 * (depth[0] + depth[1])),
                    state.energy,
                );
                let middle = 0.5 * (crease.at[0] + crease.at[1]);
                let taper = spec.taper(middle);
                report.along.push(FoldSample {
                    share: spec.share(middle),
                    fold: state.angle,
                    rest: self.drawn_crease(rank).rest_angle,
                    softness: spec.law.softness(taper),
                });
            }
            report.along.sort_by(|a, b| a.share.total_cmp(&b.share));
            if report.length > 0.0 {
                reports.push(report.finished());
            }
        }
        reports
    }

    /// Sets the reaction of the base to what the layer exerts where it lies on it, but for what folds it.
    pub(super) fn set_reaction(&mut self) {
        match self.skin.creases.is_empty() {
            true => self.energy.gradient(&self.base, &mut self.reaction),
            false => {
                let plain = self.energy.without_creases();
                plain.gradient(&self.base, &mut self.reaction);
            }
        }
    }
}
