//! Burning, step by step.

use ruga_mesh::{PerFace, PerVertex};

use crate::correction::CorrectionTable;
use crate::error::{check_field, check_positive};
use crate::heat_matrix::{HeatMatrix, SolveWork};
use crate::source::{Heating, relaxed_share};
use crate::{
    BurnError, BurnLaw, BurnSettings, BurnState, FieldMesh, Front, FrontCorrection, Source,
    StepReport,
};

/// Most substeps of one step.
const MOST_SUBSTEPS: u32 = 100_000;

/// Steps the fields of one sheet.
///
/// A substep `dt` burns `b = min(dt mu (T - T_i), Y)` at the old temperatures, relaxes towards sources and,
/// by radiation, towards the surroundings, exactly and vertex by vertex, and conducts implicitly:
/// ```text
/// (M (1 + dt/tau) + dt K) T' = M (T + dT_ad b + sources - radiation + dt/tau T_a)
/// ```
/// with `M` the lumped areas and `K` the cotangent stiffness times the diffusivity, both of the rest shape:
/// that char shortens the way of the heat is not counted. The matrix is symmetric, has no positive entry
/// off its diagonal and is factorised once, so that a substep costs a back-substitution; no step is
/// unstable or makes a new extreme of temperature by conduction.
///
/// Burning makes one: a single front leaves the sheet at `T_a + dT_ad`, but fuel that is hot before it burns gets
/// hotter by `dT_ad` than it was, and where two fronts meet, what both have preheated adds up, to two times
/// `T_i - T_a` above that at a heat ratio of 3.4.
pub struct BurnSolver {
    mesh: FieldMesh,
    law: BurnLaw,
    settings: BurnSettings,
    /// Speed factor of every vertex.
    factors: Vec<f64>,
    /// Shares of the flipped triangles that conduct.
    shares: Vec<f64>,
    largest_substep: f64,
    prepared: Option<Prepared>,
}

/// All that depends on the length of the substep.
struct Prepared {
    substep: f64,
    /// Diffusivity (m²/s) and rate (1/(K s)) of every vertex.
    diffusivities: Vec<f64>,
    rates: Vec<f64>,
    matrix: HeatMatrix,
}

impl BurnSolver {
    /// A solver for a sheet that burns everywhere by the same law.
    ///
    /// # Errors
    /// Those of [`BurnLaw::check`], and [`BurnError::OutOfRange`] for the settings.
    pub fn new(mesh: FieldMesh, law: BurnLaw, settings: BurnSettings) -> Result<Self, BurnError> {
        let factors = PerVertex::filled(mesh.vertex_count(), 1.0);
        Self::with_speed_factors(mesh, law, factors, settings)
    }

    /// A solver for a sheet on which the speed of the front is painted, as factors above 0 on that of `law`.
    ///
    /// Diffusivity and rate both follow the factor, so that the width of the front stays the same; an edge
    /// conducts with the mean of its ends. The loss time does not follow: with loss, a front that is
    /// painted slow loses more than one that is painted fast, and dies first.
    ///
    /// # Errors
    /// Those of [`BurnSolver::new`], [`BurnError::FieldSize`] and [`BurnError::FieldOutOfRange`].
    pub fn with_speed_factors(
        mesh: FieldMesh,
        law: BurnLaw,
        factors: PerVertex<f64>,
        settings: BurnSettings,
    ) -> Result<Self, BurnError> {
        law.check()?;
        let (count, accepted) = (mesh.vertex_count(), "above 0, finite");
        check_field("speed factor", factors.as_slice(), count, accepted, |f| {
            f.is_finite() && f > 0.0
        })?;
        let factors = factors.into_vec();
        let fastest = factors.iter().copied().fold(0.0, f64::max);
        let largest_substep = match settings.advance {
            None => f64::INFINITY,
            Some(advance) => {
                check_positive("advance per substep", advance, "above 0 edges")?;
                // Loss only slows a front.
                let lossless = BurnLaw {
                    loss_time: None,
                    ..law.faster(fastest)
                };
                advance * mesh.mean_edge() / Front::of(&lossless)?.speed
            }
        };
        Ok(Self {
            shares: vec![1.0; mesh.face_count()],
            mesh,
            law,
            settings,
            factors,
            largest_substep,
            prepared: None,
        })
    }

    /// The mesh that the fields live on.
    pub fn mesh(&self) -> &FieldMesh {
        &self.mesh
    }

    /// The law of burning, at a speed factor of 1.
    pub fn law(&self) -> &BurnLaw {
        &self.law
    }

    /// Sets which share of each face is left and conducts, from 0, removed, to 1, whole.
    ///
    /// The factor of the matrix before is kept as a preconditioner, and made anew once that takes more than
    /// 8 iterations. Capacity and fuel of removed material stay: it burns on by itself, without
    /// neighbours.
    ///
    /// # Errors
    /// [`BurnError::FieldSize`] or [`BurnError::FieldOutOfRange`].
    pub fn set_conducting(&mut self, shares: &PerFace<f64>) -> Result<(), BurnError> {
        let (values, count) = (shares.as_slice(), self.mesh.face_count());
        check_field(
            "share of a face that is left",
            values,
            count,
            "0 to 1",
            |share| (0.0..=1.0).contains(&share),
        )?;
        self.shares = self.mesh.flipped_shares(values);
        if let Some(prepared) = &mut self.prepared {
            let (substep, diffusivities) = (prepared.substep, &prepared.diffusivities);
            let conductances = conductances(&self.mesh, &self.shares, diffusivities, substep);
            prepared.matrix.set_conductances(conductances);
        }
        Ok(())
    }

    /// Forgets the factors of earlier matrices, so that what follows is to the last bit what a new solver would
    /// do: to be called where a simulation may be resumed.
    pub fn forget(&mut self) {
        self.prepared = None;
    }

    /// Steps a state by `time_step` (s), divided into equal substeps as the settings say.
    ///
    /// # Errors
    /// [`BurnError::OutOfRange`] or [`BurnError::TooManySubsteps`] for the time step, those of
    /// [`Source::check`], [`BurnError::FieldSize`] for a state of another mesh, and
    /// [`BurnError::Unsolvable`]. After an error the state is that of the last substep that was done.
    pub fn step(
        &mut self,
        state: &mut BurnState,
        sources: &[Source],
        time_step: f64,
    ) -> Result<StepReport, BurnError> {
        let substeps = self.substeps(time_step)?;
        let substep = time_step / f64::from(substeps);
        let count = self.mesh.vertex_count();
        check_field("state", state.fuel.as_slice(), count, "", |_| true)?;
        sources.iter().try_for_each(|s| s.check(&self.mesh))?;
        let mut report = StepReport {
            substeps,
            substep,
            ..StepReport::default()
        };
        if self.prepared.as_ref().is_none_or(|p| p.substep != substep) {
            self.prepared = Some(self.prepare(substep)?);
            report.factorisations += 1;
        }
        let heating = Heating::new(sources, count, substep);
        for _ in 0..substeps {
            self.substep(state, &heating, &mut report)?;
        }
        Ok(report)
    }

    /// Number of equal substeps into which a time step (s) is divided.
    ///
    /// # Errors
    /// [`BurnError::OutOfRange`] when it is not positive, [`BurnError::TooManySubsteps`].
    pub fn substeps(&self, time_step: f64) -> Result<u32, BurnError> {
        check_positive("time step", time_step, "above 0 s")?;
        let substeps = (time_step / self.largest_substep).ceil().max(1.0);
        if substeps > f64::from(MOST_SUBSTEPS) {
            return Err(BurnError::TooManySubsteps {
                time_step,
                substeps,
                limit: MOST_SUBSTEPS,
            });
        }
        Ok(substeps as u32)
    }

    fn prepare(&self, substep: f64) -> Result<Prepared, BurnError> {
        let (mut diffusivities, mut rates) = (Vec::new(), Vec::new());
        let table = self.corrections(substep);
        for (&factor, &spacing) in self.factors.iter().zip(self.mesh.spacings().as_slice()) {
            let correction = table.as_ref().map(|table| table.at(factor, spacing));
            let [conduct, burn] = correction.map_or([1.0; 2], |c| [c.diffusivity, c.burn_rate]);
            diffusivities.push(factor * conduct * self.law.diffusivity);
            rates.push(factor * burn * self.law.burn_rate);
        }
        let growth = 1.0 + self.loss_share(substep);
        let diagonal = self.mesh.areas().as_slice().iter().map(|a| a * growth);
        let ends = self.mesh.edges().iter().map(|edge| edge.vertices);
        let conductances = conductances(&self.mesh, &self.shares, &diffusivities, substep);
        let matrix = HeatMatrix::new(diagonal.collect(), ends.collect(), conductances)
            .ok_or(BurnError::Unsolvable { substep })?;
        Ok(Prepared {
            substep,
            diffusivities,
            rates,
            matrix,
        })
    }

    fn corrections(&self, substep: f64) -> Option<CorrectionTable> {
        let least = self.factors.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.factors.iter().copied().fold(0.0, f64::max);
        (self.settings.correction == FrontCorrection::Corrected)
            .then(|| CorrectionTable::new(&self.law, substep, self.mesh.mean_edge(), [least, most]))
    }

    /// Substep in loss times.
    fn loss_share(&self, substep: f64) -> f64 {
        self.law.loss_time.map_or(0.0, |time| substep / time)
    }

    fn substep(
        &mut self,
        state: &mut BurnState,
        heating: &Heating,
        report: &mut StepReport,
    ) -> Result<(), BurnError> {
        let substep = report.substep;
        let loss_share = self.loss_share(substep);
        let law = self.law;
        let Some(prepared) = &mut self.prepared else {
            return Err(BurnError::Unsolvable { substep });
        };
        let areas = self.mesh.areas().as_slice();
        let temperatures = state.temperature.as_mut_slice();
        let mut right = Vec::with_capacity(areas.len());
        let mut left = Vec::with_capacity(areas.len());
        for (v, &fuel) in state.fuel.as_slice().iter().enumerate() {
            let (area, mut temperature) = (areas[v], temperatures[v]);
            let above = (temperature - law.ignition).max(0.0);
            let burnt = (substep * prepared.rates[v] * above).min(fuel);
            left.push(fuel - burnt);
            let fire = law.adiabatic_rise * burnt;
            let heated = heating.rise(v, temperature + fire);
            temperature += fire + heated;
            let radiated = radiated(&law, temperature, substep);
            report.burnt += area * burnt;
            report.heat.fire += area * fire;
            report.heat.sources += area * heated;
            report.heat.radiation += area * radiated;
            right.push(area * (temperature - radiated + loss_share * law.surroundings));
        }
        let work = prepared.matrix.solve(&right, temperatures);
        let SolveWork {
            iterations,
            factorisations,
        } = work.ok_or(BurnError::Unsolvable { substep })?;
        state.fuel = left.into();
        report.iterations += iterations;
        report.factorisations += factorisations;
        let excess = areas.iter().zip(&*temperatures);
        let excess: f64 = excess.map(|(a, t)| a * (t - law.surroundings)).sum();
        report.heat.loss += loss_share * excess;
        Ok(())
    }
}

/// Fall of temperature (K) by radiation in a substep, with the coefficient at its start; it never falls
/// below the surroundings.
fn radiated(law: &BurnLaw, temperature: f64, substep: f64) -> f64 {
    law.radiation.map_or(0.0, |radiation| {
        let coefficient = radiation.coefficient(temperature, law.surroundings);
        relaxed_share(coefficient, substep) * (temperature - law.surroundings)
    })
}

/// Conductance of every edge times the substep.
fn conductances(mesh: &FieldMesh, shares: &[f64], diffusivities: &[f64], substep: f64) -> Vec<f64> {
    let edges = mesh.edges().iter();
    edges
        .map(|edge| {
            let [a, b] = edge.vertices.map(|v| diffusivities[v as usize]);
            substep * 0.5 * (a + b) * edge.conductance(shares)
        })
        .collect()
}
