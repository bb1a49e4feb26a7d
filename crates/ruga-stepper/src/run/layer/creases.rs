//! The creases of a layer: how they are drawn, and how they have folded.

use std::f64::consts::PI;

use ruga_blend::Weights;
use ruga_material::Wrinkling;
use ruga_mesh::{EdgeId, Id};
use ruga_shell::{Crease, LineAnchor};

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

impl Layer {
    /// Draws the creases as a pose of these weights in full does at a `load` of it.
    ///
    /// Of what creases take up of the compression it draws the share `absorbed`.
    pub(crate) fn draw_creases(
        &mut self,
        weights: &Weights,
        (load, absorbed): (f64, f64),
    ) -> Result<(), StepperError> {
        let creases = self.spec.creases.iter();
        let strengths = creases.map(|crease| crease.strength(weights, load));
        // What is kept of earlier folds is there in every pose.
        let strengths: Vec<f64> = strengths.chain([1.0, absorbed]).collect();
        self.set_crease_strengths(strengths)
    }

    /// Strengths of creases that are not drawn, and keep nothing.
    pub(super) fn undrawn(&self) -> Vec<f64> {
        vec![0.0; self.spec.creases.len() + 2]
    }

    /// Strength with which every crease is drawn, then the shares of what they keep and of what they take up.
    pub(crate) fn crease_strengths(&self) -> &[f64] {
        &self.crease_strengths
    }

    /// Draws every crease a `share` of the way from a strength it had `before` to its present one.
    pub(crate) fn draw_part_of_creases(
        &mut self,
        before: &[f64],
        share: f64,
    ) -> Result<(), StepperError> {
        if share == 1.0 {
            return Ok(());
        }
        let pairs = before.iter().zip(&self.crease_strengths);
        let between = pairs.map(|(from, to)| from + (to - from) * share);
        let strengths = between.collect();
        self.set_crease_strengths(strengths)
    }

    pub(super) fn set_crease_strengths(&mut self, strengths: Vec<f64>) -> Result<(), StepperError> {
        if self.skin.creases.is_empty() || self.crease_strengths == strengths {
            return Ok(());
        }
        self.crease_strengths = strengths;
        self.fold_creases()
    }

    /// Finds what creases take up of the present strains.
    pub(super) fn absorb(&mut self) -> Result<(), StepperError> {
        let absorption = self
            .bands
            .absorption(&self.strains, self.skin.creases.len());
        if absorption == self.absorption {
            return Ok(());
        }
        let mut faces =
            layer_parameters(&self.properties, self.spec.coupling.has_foundation()).faces;
        for (face, left) in faces.iter_mut().zip(&absorption.carried) {
            face.normal_stiffness *= left;
            face.gradient_stiffness *= left;
        }
        let outcome = self.energy.set_face_parameters(&faces);
        outcome.map_err(|source| self.shell_error(source))?;
        self.absorption = absorption;
        self.fold_creases()
    }

    /// Gives the edges on creases the angles and depths of the present strengths.
    fn fold_creases(&mut self) -> Result<(), StepperError> {
        let strengths = &self.crease_strengths;
        let [remembered, absorbed] = [0, 1].map(|i| strengths[self.spec.creases.len() + i]);
        let mut creases = Vec::new();
        let mut anchors = Vec::new();
        for (rank, on_edge) in self.skin.creases.iter().enumerate() {
            let fold = self.absorption.fold(rank);
            let (spec, strength) = (&self.spec.creases[on_edge.line], strengths[on_edge.line]);
            let tapers = on_edge.at.map(|at| spec.taper(at));
            let taper = 0.5 * (tapers[0] + tapers[1]);
            let modulus = self.beside(on_edge.edge, |wave| wave.bending_stiffness);
            let drawn = (strength, remembered);
            let drawn = spec.on_edge(on_edge.at, drawn, modulus);
            let crease = Crease {
                rest_angle: spec.at_least(drawn.rest_angle, absorbed * fold.angle),
                ..drawn
            };
            creases.push((on_edge.edge, crease));
            if let Some(anchor) = spec.anchor {
                let unit = |wave: &Wrinkling| wave.normal_stiffness / wave.wave_number;
                anchors.push(LineAnchor {
                    edge: on_edge.edge,
                    // It fades with the crease, or it would hold the skin down beyond its tips; and a line
                    // that is not drawn is free, or wrinkles of other poses could not cross it.
                    stiffness: taper
                        * held(strength)
                        * anchor.stiffness
                        * self.beside(on_edge.edge, unit),
                    depths: tapers.map(|taper| {
                        let drawn = spec.anchor_depth(anchor, taper * strength);
                        spec.at_least(drawn, absorbed * fold.depth)
                    }),
                });
            }
        }
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

    /// Mean of what the layer is like on the faces beside an edge.
    fn beside(&self, edge: EdgeId, value: impl Fn(&Wrinkling) -> f64) -> f64 {
        let faces = self.skin.mesh.edges()[edge].faces;
        let values = faces.into_iter().flatten();
        let values = values.map(|face| value(&self.properties.faces[face].wrinkling));
        let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
        sum / f64::from(count)
    }

    /// Whether the present strengths draw the crease number `line`.
    fn is_drawn(&self, line: usize) -> bool {
        let strength = self.crease_strengths.get(line);
        let takes_up = self.spec.creases[line].absorbs && !self.absorption.is_empty();
        takes_up || strength.is_some_and(|&strength| self.spec.creases[line].is_drawn(strength))
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
        let waves = self.properties.vertices.iter();
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
            let own = self.skin.creases.iter().zip(&states);
            let own = own.filter(|(crease, _)| crease.line == line);
            let mut report = CreaseReport::of(spec);
            for (crease, state) in own {
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
                let modulus = self.beside(crease.edge, |wave| wave.bending_stiffness);
                let drawn = (self.crease_strengths[line], 1.0);
                report.along.push(FoldSample {
                    share: spec.share(middle),
                    fold: state.angle,
                    rest: spec.on_edge(crease.at, drawn, modulus).rest_angle,
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
