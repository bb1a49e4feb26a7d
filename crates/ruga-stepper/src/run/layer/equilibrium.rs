//! The equilibrium of a layer, and of a body that moves with it, and steps in time.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_solver::{Iteration, Kkt, Minimise, NewtonSettings, SolveReport, SolverError};

use super::{Layer, laid_on};
use crate::run::layer_objective::{LayerObjective, gather, scatter};
use crate::run::patches::{Patches, Scales, Whole, Width};
use crate::support::motion::{Inertia, velocities};
use crate::{Dynamics, StepperError};

/// Lag, in rad or as a change of rest lengths, from which on the energy is set up anew before a solve.
const AS_BEFORE: f64 = 1e-4;

/// A step in time: where everything that has mass begins, and the term that it adds to the energy.
pub(crate) struct TimeStep {
    pub(crate) inertia: Inertia,
    start: Vec<Vector3<f64>>,
    seconds: f64,
}

impl Layer {
    /// A step in time from where everything is now.
    pub(crate) fn time_step(&self, dynamics: Dynamics) -> TimeStep {
        let at_rest;
        let (start, velocities) = match &self.solid {
            // The layer has no inertia of its own: it is in equilibrium at every moment, and its mass
            // goes with the body below (RK 6.2).
            Some(solid) => (&solid.state.q, &solid.state.velocities),
            None if self.velocities.is_empty() => {
                at_rest = vec![Vector3::zeros(); self.positions.len()];
                (&self.positions, &at_rest)
            }
            None => (&self.positions, &self.velocities),
        };
        TimeStep {
            inertia: Inertia::new(dynamics, start, velocities),
            start: start.clone(),
            seconds: dynamics.time_step,
        }
    }

    /// Takes over the velocities of a step that ends here.
    pub(crate) fn end_step(&mut self, step: &TimeStep) {
        match &mut self.solid {
            Some(solid) => solid.take_velocities(&step.start, step.seconds),
            None => self.velocities = velocities(&step.start, &self.positions, step.seconds),
        }
    }

    /// Finds the equilibrium near the present state, or the end of a step in time, and moves there.
    pub(crate) fn minimise(
        &mut self,
        inertia: Option<&Inertia>,
        (minimise, settings): (Minimise, &NewtonSettings),
        kkt: &mut Kkt,
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, StepperError> {
        // Setting the energy up anew disturbs a state that has converged. A surface that has hardly
        // turned is not worth that.
        if self.lag() > AS_BEFORE {
            self.hold()?;
        }
        let mut unknowns = self.unknowns();
        let base = gather(&self.free, &self.base);
        let solved = self.row_targets().and_then(|targets| {
            let objective = self.objective(&base, inertia);
            minimise(
                &objective,
                &targets,
                &mut unknowns,
                kkt,
                settings,
                keep_going,
            )
        });
        let report = solved.map_err(|source| self.solver_error(source))?;
        self.set_unknowns(&unknowns);
        Ok(report)
    }

    /// Divides the layer, which asks for so many `points` per wavelength, into patches; `None` where it is too small
    /// for that, with `most_in_whole` vertices solved as a whole, has two sheets or moves together with a body. There
    /// may be `others` of another width.
    pub(crate) fn patches(
        &self,
        (points, most_in_whole): (f64, usize),
        width: Width,
        others: Option<&Patches>,
    ) -> Option<Patches> {
        if self.solid.is_some() || !width.suits(self.free.len(), most_in_whole) {
            return None;
        }
        let mesh = (&self.skin.mesh, self.skin.rest.positions.as_slice());
        Patches::new(
            mesh,
            (&self.energy, &self.rows),
            (points, most_in_whole, width),
            others,
        )
    }

    /// Finds the equilibrium near the present state patch by patch, and moves there.
    pub(crate) fn minimise_patches(
        &mut self,
        patches: &mut Patches,
        how: (Minimise, &NewtonSettings),
        keep_going: &mut (dyn FnMut(&Iteration) -> bool + Send),
    ) -> Result<SolveReport, StepperError> {
        let mut unknowns = self.unknowns();
        let base = gather(&self.free, &self.base);
        let solved = self.row_targets().and_then(|targets| {
            let whole = Whole {
                energy: &self.energy,
                positions: &self.positions,
                load: [&self.reaction, &base],
                damping: &self.damping,
                rows: &self.rows,
                targets: &targets,
                scales: self.scales(),
            };
            patches.minimise(whole, &mut unknowns, how, keep_going)
        });
        let report = solved.map_err(|source| self.solver_error(source))?;
        self.set_unknowns(&unknowns);
        Ok(report)
    }

    fn solver_error(&self, source: SolverError) -> StepperError {
        StepperError::Solver {
            layer: self.spec.name.clone(),
            source,
        }
    }

    /// Right-hand sides of the layer's constraints: averages of the support surface, and of what anchors draw it down.
    fn row_targets(&self) -> Result<Vec<f64>, SolverError> {
        let mut targets = vec![0.0; self.rows.count()];
        if targets.is_empty() {
            return Ok(targets);
        }
        let drawn = self.drawn_down();
        match &self.solid {
            None => {
                let base = match drawn {
                    None => gather(&self.free, &self.base),
                    Some(drawn) => {
                        let base = self.base.iter().zip(&drawn);
                        let base: Vec<_> = base.map(|(base, way)| base + way).collect();
                        gather(&self.free, &base)
                    }
                };
                self.rows.mul(&base, &mut targets)?;
            }
            // On a body the rows hold differences from its surface, so that only held nodes are on
            // the right side.
            Some(solid) => {
                if let Some(drawn) = drawn {
                    let mut ways = gather(&self.free, &drawn);
                    ways.resize(self.rows.unknowns(), 0.0);
                    self.rows.mul(&ways, &mut targets)?;
                }
                for (target, held) in targets.iter_mut().zip(solid.row_targets()) {
                    *target += held;
                }
            }
        }
        Ok(targets)
    }

    /// Coordinates of everything that moves.
    pub(super) fn unknowns(&self) -> Vec<f64> {
        let mut unknowns = gather(&self.free, &self.positions);
        unknowns.extend(self.solid.iter().flat_map(|solid| solid.unknowns()));
        unknowns
    }

    pub(super) fn set_unknowns(&mut self, unknowns: &[f64]) {
        let (own, nodes) = unknowns.split_at(3 * self.free.len());
        scatter(&self.free, own, &mut self.positions);
        let Some(solid) = &mut self.solid else { return };
        solid.set_unknowns(nodes);
        // Layer and body have moved together. The energy keeps the normals and rest lengths that it
        // was set up with, so that it has one minimum during a solve. How far they are behind then
        // is the lag.
        let posed = solid.surface(&self.support.posed);
        self.support = Arc::new(self.support.on_body(posed));
        self.base = laid_on(&self.support.posed, self.upper.as_ref());
        self.measure_strains();
    }

    /// The energy that the next solve minimises; the free vertices would be at `base` (m) without
    /// wrinkles.
    pub(super) fn objective<'a>(
        &'a self,
        base: &'a [f64],
        inertia: Option<&'a Inertia>,
    ) -> LayerObjective<'a> {
        let solid = self.solid.as_ref();
        let scales = self.scales();
        LayerObjective {
            energy: &self.energy,
            free: &self.free,
            positions: &self.positions,
            pattern: self.pattern().clone(),
            damping: &self.damping,
            reaction: &self.reaction,
            base,
            // The mass matrix of a body holds the layer's masses, too, and they count once.
            inertia: match solid {
                None => inertia.map(|inertia| (inertia, self.masses.as_slice())),
                Some(_) => None,
            },
            solid: solid.map(|solid| {
                (
                    solid,
                    solid.freeze(&self.energy, &self.held_normals, inertia),
                )
            }),
            vertex_area: scales.vertex_area,
            energy_scale: scales.energy,
            wrinkling: scales.wrinkling,
            thickness: scales.thickness,
        }
    }

    fn scales(&self) -> Scales<'_> {
        Scales {
            energy: self.strain_ratios().energy_scale(),
            vertex_area: self.areas.iter().sum::<f64>() / self.areas.len().max(1) as f64,
            wrinkling: &self.wrinkling,
            thickness: self.spec.material.thickness,
        }
    }
}
