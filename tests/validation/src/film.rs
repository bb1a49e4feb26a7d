//! A strip of film, compressed by the base it lies on.
//!
//! Ends are pinned, which suits whole half-waves; a tube has none. The sides slide (y fixed), which
//! makes plane strain. One wave is `wavelength` of the half-space theory.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_constraint::Sampling;
use ruga_material::Wrinkling;
use ruga_mesh::triangle_frame;
use ruga_shell::LayerEnergy;
use ruga_solver::{
    AtSaddle, Iteration, Kkt, LoadSettings, LoadStepper, LowerPattern, NewtonSettings, Outcome,
    SolveReport, StopRule, Verdict, inertia_at,
};

use crate::baselines::{LinearSolver, LinearWork, Problem, minimise_with};
use crate::film_objective::{FilmObjective, gather, scatter};
use crate::film_rows::{averages, side_rollers, to_constraint_rows};
use crate::{Base, BaseReaction, FilmSpec, Strip};

/// One kept load step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Compression over the critical strain.
    pub load: f64,
    /// How the solve went.
    pub solve: SolveReport,
    /// Work of MINRES in it.
    pub work: LinearWork,
    /// `sqrt(2)` RMS height about its mean, m.
    pub amplitude: f64,
    /// The amplitude over `(2/k) sqrt(eps - eps_c)`; NaN below the critical strain.
    pub relative_amplitude: f64,
    /// Mean height over the amplitude.
    pub relative_offset: f64,
    /// Wavelength over the critical one, from the number of half-waves in material coordinates.
    pub relative_wavelength: f64,
    /// Elastic energy below that of the film lying on the base, over theory's
    /// `C/2 (eps - eps_c)^2` per area.
    pub relative_gap: f64,
}

/// Random heights in film thicknesses, without which a perfect film has no reason to wrinkle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Of the film at rest.
    pub first: f64,
    /// Before every load step: for a solver that cannot tell a saddle, and would stay there.
    pub every: f64,
}

/// The film and the base below it.
pub struct Film {
    /// What linear theory says.
    pub wrinkling: Wrinkling,
    /// Solver of the linear systems.
    pub linear: LinearSolver,
    /// Work of MINRES in the last solve.
    work: LinearWork,
    pub(crate) spec: FilmSpec,
    pub(crate) strip: Strip,
    pub(crate) rest: Vec<Vector3<f64>>,
    pub(crate) energy: LayerEnergy,
    pub(crate) free: Vec<u32>,
    pub(crate) kkt: Kkt,
    floor: Vec<f64>,
    pub(crate) positions: Vec<Vector3<f64>>,
    /// Base of the present load.
    pub(crate) points: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    /// Dead load on the coordinates that move, N.
    reaction: Vec<f64>,
    averages: usize,
}

impl Film {
    /// Lays the film on its base, unstrained.
    pub fn new(spec: &FilmSpec, strip: Strip) -> Self {
        Self::sampled(spec, strip, Sampling::Quadrature)
    }

    /// The same with averages sampled in another way.
    pub fn sampled(spec: &FilmSpec, strip: Strip, sampling: Sampling) -> Self {
        let theory = spec.theory();
        let rest = spec.base.points(&strip, 0.0);
        let pinned = strip.ends();
        let parameters = spec.parameters(&strip);
        let energy =
            LayerEnergy::with_bending(&strip.topology(), &rest, parameters, &pinned, spec.bending)
                .expect("a valid layer");
        let free = energy.free_vertices().to_vec();
        let (starts, entries) = energy.pattern();
        let pattern =
            LowerPattern::new(starts.to_vec(), entries.to_vec()).expect("a valid pattern");
        let mut rows = averages(
            &strip,
            &rest,
            &pinned,
            &free,
            &theory,
            (spec.coupling, sampling),
        );
        let averages = rows.len();
        rows.extend(side_rollers(&strip, &free));
        let rows = to_constraint_rows(&rows, 3 * free.len());
        let areas = energy.vertex_areas();
        let floor = free
            .iter()
            .flat_map(|&v| [1e-6 * theory.normal_stiffness * areas[v as usize]; 3])
            .collect();
        Self {
            wrinkling: theory,
            linear: LinearSolver::Ldlt,
            work: LinearWork::default(),
            spec: *spec,
            kkt: Kkt::new(&pattern, &rows, 3).expect("a valid system"),
            positions: rest.clone(),
            points: rest.clone(),
            normals: spec.base.normals(&strip, 0.0),
            reaction: vec![0.0; 3 * free.len()],
            rest,
            strip,
            energy,
            free,
            floor,
            averages,
        }
    }

    /// Number of averages (one per coordinate of each cluster).
    pub fn average_count(&self) -> usize {
        self.averages
    }

    /// Compresses the film by `load` critical strains and carries it along with the base.
    pub(crate) fn set_load(&mut self, load: f64) {
        let strain = load * self.wrinkling.critical_strain;
        let points = self.spec.base.points(&self.strip, strain);
        for (x, (old, new)) in self
            .positions
            .iter_mut()
            .zip(self.points.iter().zip(&points))
        {
            *x += new - old;
        }
        self.points = points;
        self.normals = self.spec.base.normals(&self.strip, strain);
        let zeros = vec![0.0; self.points.len()];
        self.energy
            .set_base(&self.points, &self.normals, &zeros)
            .expect("a valid base");
        let [base, natural] = self.spec.base.stretches(strain);
        if self.spec.reaction == BaseReaction::UpToCritical {
            let counted = strain.min(self.wrinkling.critical_strain);
            self.set_natural_stretch(base / (1.0 - counted));
            self.balance();
        }
        self.set_natural_stretch(natural);
    }

    /// Sets the dead load along the base normal that holds the film, as it is now, on the base.
    ///
    /// At the base the foundation is silent, so the gradient is that of membrane and bending.
    fn balance(&mut self) {
        self.energy.gradient(&self.points, &mut self.reaction);
        for (&v, force) in self.free.iter().zip(self.reaction.chunks_exact_mut(3)) {
            let normal = self.normals[v as usize];
            let along = normal.dot(&Vector3::new(force[0], force[1], force[2]));
            force.copy_from_slice((normal * along).as_slice());
        }
    }

    /// Stretches the film's rest metric along the strip.
    fn set_natural_stretch(&mut self, stretch: f64) {
        let stretches: Vec<Matrix2<f64>> = (0..self.strip.faces.len())
            .map(|face| {
                let d = self.compressed_direction(face);
                Matrix2::identity() + d * d.transpose() * (stretch - 1.0)
            })
            .collect();
        self.energy
            .set_rest_metric(&stretches)
            .expect("a valid metric");
    }

    /// Unit vector of a face's local frame along which the base compresses it.
    fn compressed_direction(&self, face: usize) -> Vector2<f64> {
        let corners = self.strip.faces[face].map(|v| self.rest[v as usize]);
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let direction = self.spec.base.direction(&centre);
        let frame = triangle_frame(&corners);
        Vector2::new(frame[0].dot(&direction), frame[1].dot(&direction)).normalize()
    }

    /// Film lying on the base at `load` critical strains, moved by noise of `noise` thicknesses.
    pub fn lay_down(&mut self, load: f64, noise: f64, seed: u64) {
        self.set_load(load);
        self.positions.clone_from(&self.points);
        self.shake(noise, &mut Pcg64Mcg::seed_from_u64(seed));
    }

    /// Moves the film by noise of `noise` thicknesses.
    fn shake(&mut self, noise: f64, random: &mut Pcg64Mcg) {
        for &v in &self.free {
            let height = noise * self.spec.film.thickness * random.random_range(-1.0..1.0);
            self.positions[v as usize] += self.normals[v as usize] * height;
        }
    }

    /// Solves at `load` from the present shape, carried along with the base.
    pub fn solve(&mut self, load: f64, settings: &NewtonSettings) -> SolveReport {
        self.solve_watched(load, settings, &mut |_| true)
    }

    fn solve_watched(
        &mut self,
        load: f64,
        settings: &NewtonSettings,
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> SolveReport {
        self.set_load(load);
        let base = gather(&self.free, &self.points);
        let mut targets = vec![0.0; self.kkt.rows().count()];
        self.kkt
            .rows()
            .mul(&base, &mut targets)
            .expect("sizes match");
        let mut x = gather(&self.free, &self.positions);
        let linear = self.linear;
        let (objective, kkt) = self.objective(&base);
        let problem = Problem {
            objective: &objective,
            rhs: &targets,
            kkt,
        };
        let solved = minimise_with(linear, problem, &mut x, settings, keep_going);
        let (report, work) = solved.expect("valid input");
        scatter(&self.free, &x, &mut self.positions);
        self.work = work;
        report
    }

    pub(crate) fn objective<'a>(&'a mut self, base: &'a [f64]) -> (FilmObjective<'a>, &'a mut Kkt) {
        let objective = FilmObjective {
            energy: &self.energy,
            free: &self.free,
            positions: &self.positions,
            pattern: self.kkt.pattern().clone(),
            floor: &self.floor,
            reaction: &self.reaction,
            base,
            theory: &self.wrinkling,
            thickness: self.spec.film.thickness,
            area: self.strip.length * self.strip.width,
        };
        (objective, &mut self.kkt)
    }

    /// Whether the smooth state at `load` is unstable.
    ///
    /// On a curved base the film first settles, starting from the present shape.
    fn buckles(&mut self, load: f64) -> bool {
        if self.spec.base == Base::Flat {
            self.lay_down(load, 0.0, 0);
            let x = gather(&self.free, &self.positions);
            let (objective, kkt) = self.objective(&x);
            let inertia = inertia_at(&objective, &x, kkt).expect("factorisable");
            return !inertia.is_minimum();
        }
        let settings = NewtonSettings {
            at_saddle: AtSaddle::Stop,
            ..NewtonSettings::default()
        };
        self.solve(load, &settings).left_saddle
    }

    /// Load at which the film buckles, over the critical strain, to 0.2 %.
    ///
    /// # Panics
    /// When the onset does not lie between `low` and `high`.
    pub fn onset(&mut self, mut low: f64, mut high: f64) -> f64 {
        self.lay_down(low, 0.0, 0);
        assert!(!self.buckles(low), "buckled already at {low}");
        let (mut smooth, mut load) = (self.positions.clone(), high);
        while high - low > 0.002 * low {
            if self.buckles(load) {
                high = load;
                self.set_load(low);
                self.positions.clone_from(&smooth);
            } else {
                assert!(load < high, "not buckled yet at {high}");
                low = load;
                smooth.clone_from(&self.positions);
            }
            load = 0.5 * (low + high);
        }
        load
    }

    /// Loads up to the last of `loads`, through the onset; a step for each load kept.
    pub fn ramp(&mut self, loads: &[f64], seed: u64) -> Vec<Step> {
        let settings = NewtonSettings {
            seed,
            ..NewtonSettings::default()
        };
        let noise = Noise {
            first: 1e-3,
            every: 0.0,
        };
        self.ramp_with(loads, noise, &settings, &mut |_| true)
    }

    /// The same by other settings, of which the seed is that of the initial noise too; `keep_going` ends the
    /// ramp by returning `false`.
    pub fn ramp_with(
        &mut self,
        loads: &[f64],
        noise: Noise,
        settings: &NewtonSettings,
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Vec<Step> {
        let full = *loads.last().expect("some load");
        let keys: Vec<f64> = loads.iter().map(|l| l / full).collect();
        let mut stepper =
            LoadStepper::new(&keys, LoadSettings::default()).expect("increasing loads");
        self.lay_down(0.0, noise.first, settings.seed);
        let mut random = Pcg64Mcg::seed_from_u64(settings.seed);
        let (mut kept, mut kept_load) = (self.positions.clone(), 0.0);
        let mut steps = Vec::new();
        while let Some(trial) = stepper.next_trial() {
            let load = trial.load * full;
            let settings = NewtonSettings {
                at_saddle: if trial.probe {
                    AtSaddle::Stop
                } else {
                    AtSaddle::Leave
                },
                ..settings.clone()
            };
            self.shake(noise.every, &mut random);
            let solve = self.solve_watched(load, &settings, keep_going);
            if solve.stop == StopRule::Interrupted {
                break;
            }
            if stepper.report(outcome(&solve)) == Verdict::Keep {
                kept.clone_from(&self.positions);
                kept_load = load;
                steps.push(self.measure(load, solve));
            } else {
                self.set_load(kept_load);
                self.positions.clone_from(&kept);
            }
        }
        steps
    }

    /// One solve at `load` from the film lying on the base, with noise of `1e-3` thicknesses.
    pub fn cold_start(&mut self, load: f64, seed: u64) -> Step {
        self.lay_down(load, 1e-3, seed);
        let settings = NewtonSettings {
            at_saddle: AtSaddle::Leave,
            seed,
            ..NewtonSettings::default()
        };
        let solve = self.solve(load, &settings);
        self.measure(load, solve)
    }

    /// Heights over the base, m.
    pub fn heights(&self) -> Vec<f64> {
        let lifted = self.positions.iter().zip(&self.points).map(|(x, p)| x - p);
        lifted.zip(&self.normals).map(|(u, n)| u.dot(n)).collect()
    }

    /// Amplitude, wavelength and energy of the present shape of a strip with ends.
    pub fn measure(&self, load: f64, solve: SolveReport) -> Step {
        let heights = self.heights();
        let wavelength = self.wavelength(&heights);
        let [mean, square] = self.moments(&heights, wavelength);
        let amplitude = (2.0 * (square - mean * mean)).sqrt();
        let theory = &self.wrinkling;
        let excess = (load - 1.0) * theory.critical_strain;
        let area = self.strip.length * self.strip.width;
        let gap = self.energy.value(&self.points) - self.energy.value(&self.positions);
        Step {
            load,
            solve,
            work: self.work,
            amplitude,
            relative_amplitude: amplitude * 0.5 * TAU / wavelength / excess.sqrt(),
            relative_offset: mean / amplitude,
            relative_wavelength: wavelength / theory.wavelength,
            relative_gap: gap / (0.5 * theory.membrane_stiffness * excess.powi(2) * area),
        }
    }

    /// Mean and mean square over as many whole waves as fit between one wave from either end,
    /// where a film that leaves a curved base is still held by the pinned vertices.
    fn moments(&self, heights: &[f64], wavelength: f64) -> [f64; 2] {
        let middle = 0.5 * self.strip.length;
        let reach = 0.5 * wavelength * (self.strip.length / wavelength - 2.0).floor().max(1.0);
        let (mut total, mut moments) = (0.0, [0.0; 2]);
        let points = self.strip.points.iter().zip(self.energy.vertex_areas());
        for (height, (_, area)) in heights
            .iter()
            .zip(points)
            .filter(|(_, (p, _))| (p.x - middle).abs() < reach)
        {
            total += area;
            moments[0] += height * area;
            moments[1] += height * height * area;
        }
        moments.map(|m| m / total)
    }

    /// Wavelength of `heights`, from the number of half-waves.
    pub(crate) fn wavelength(&self, heights: &[f64]) -> f64 {
        let areas = self.energy.vertex_areas();
        self.strip
            .wavelength(heights, areas, self.wrinkling.wavelength)
    }
}

fn outcome(solve: &SolveReport) -> Outcome {
    if solve.stop == StopRule::Saddle || (solve.left_saddle && solve.converged) {
        Outcome::Buckled
    } else if solve.converged {
        Outcome::Stable
    } else {
        Outcome::Failed
    }
}
