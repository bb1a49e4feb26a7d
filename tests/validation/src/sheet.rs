//! A sheet of film under odd loads, solved by the papers' methods as well as by the product's solver.
//!
//! What the product can express is asked of the product. A sheet is for the rest: loads that fall again,
//! bases of any shape, rows that no product would make, and a solve by itself.

mod film_spec;
mod links;
mod objective;
mod rows;
mod strip;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_material::Wrinkling;
use ruga_mesh::{EdgeId, TriMesh};
use ruga_shell::{
    BendingModel, Crease, CreaseState, EnergyParts, LayerEnergy, LayerParameters, LineAnchor,
};
use ruga_solver::{
    FactorCost, Inertia, Kkt, Minimise, NewtonSettings, SolveReport, inertia_at, minimise,
};

use crate::baselines::by_residual;

pub use film_spec::{FilmCoupling, FilmSpec};
pub use links::Link;
pub use strip::{Strip, equilateral, upright};

pub(crate) use objective::{gather, scatter};
pub(crate) use rows::{Row, to_constraint_rows};

use links::Links;
use objective::SheetObjective;
use rows::{averages, side_rollers};

/// What a sheet is made of and how it is held.
#[derive(Clone, Debug)]
pub struct SheetSpec {
    /// Linear theory, for scales.
    pub theory: Wrinkling,
    /// Thickness, m.
    pub thickness: f64,
    /// Where the vertices are at rest, m.
    pub rest: Vec<Vector3<f64>>,
    /// Triangles.
    pub faces: Vec<[u32; 3]>,
    /// Material and springs.
    pub parameters: LayerParameters,
    /// How bending is measured.
    pub bending: BendingModel,
    /// Which vertices do not move on their base.
    pub pinned: Vec<bool>,
    /// More averages that are held at those of the base: vertex and weight.
    pub averages: Vec<Vec<(u32, f64)>>,
    /// Combinations of vertices that are held at zero, whatever those of the base: what is sewn together.
    pub ties: Vec<Vec<(u32, f64)>>,
    /// Springs between vertices.
    pub links: Vec<Link>,
    /// Rows of the film's coupling, on unknowns.
    coupling: Vec<Row>,
    /// Rows of the sides that slide, on unknowns.
    rollers: Vec<Row>,
}

impl SheetSpec {
    /// A strip of film with pinned ends and sliding sides.
    pub fn film(spec: &FilmSpec, strip: &Strip) -> Self {
        let (rest, pinned, theory) = (strip.compressed(0.0), strip.ends(), spec.theory());
        let free: Vec<u32> = (0..).zip(&pinned).filter(|p| !p.1).map(|p| p.0).collect();
        Self {
            theory,
            thickness: spec.film.thickness,
            faces: strip.faces.clone(),
            parameters: spec.parameters(strip),
            averages: Vec::new(),
            ties: Vec::new(),
            links: Vec::new(),
            coupling: averages(strip, (&rest, &pinned, &free), &theory, spec.coupling),
            bending: spec.bending,
            rollers: side_rollers(strip, &free),
            rest,
            pinned,
        }
    }

    /// A sheet of any shape that lies on nothing but what its parameters say, with vertices pinned.
    pub fn bare(
        (theory, thickness): (Wrinkling, f64),
        (rest, faces): (Vec<Vector3<f64>>, Vec<[u32; 3]>),
        parameters: LayerParameters,
        pinned: Vec<bool>,
    ) -> Self {
        Self {
            theory,
            thickness,
            rest,
            faces,
            parameters,
            bending: BendingModel::VertexCurvature,
            pinned,
            averages: Vec::new(),
            ties: Vec::new(),
            links: Vec::new(),
            coupling: Vec::new(),
            rollers: Vec::new(),
        }
    }

    /// The same with sides that nothing holds.
    pub fn with_free_sides(self) -> Self {
        Self {
            rollers: Vec::new(),
            ..self
        }
    }

    /// One row per coordinate of each average, over the vertices that move, the rollers, and ties.
    fn rows(&self, free: &[u32]) -> Vec<Row> {
        let moving = |average: &Vec<(u32, f64)>| -> Row {
            let terms = average.iter();
            terms
                .filter_map(|&(v, weight)| Some((free.binary_search(&v).ok()?, weight)))
                .collect()
        };
        let axes = |row: Row| {
            [0, 1, 2].map(|axis| row.iter().map(|(u, w)| (3 * u + axis, *w)).collect::<Row>())
        };
        let averages = self.averages.iter().map(moving);
        let averages = averages.filter(|row| !row.is_empty()).flat_map(axes);
        let ties = self.ties.iter().map(moving).flat_map(axes);
        let rollers = self.rollers.iter().cloned();
        self.coupling
            .iter()
            .cloned()
            .chain(averages)
            .chain(rollers)
            .chain(ties)
            .collect()
    }
}

/// A sheet of film on a base that may take any shape.
pub struct Sheet {
    spec: SheetSpec,
    energy: LayerEnergy,
    links: Links,
    free: Vec<u32>,
    kkt: Kkt,
    damping: Vec<f64>,
    positions: Vec<Vector3<f64>>,
    base: Vec<Vector3<f64>>,
    /// Dead load on the coordinates that move, N.
    load: Vec<f64>,
}

impl Sheet {
    /// Lays the sheet on its rest shape.
    ///
    /// # Panics
    /// When the specification is no valid layer.
    pub fn new(spec: SheetSpec) -> Self {
        let mesh = TriMesh::new(spec.rest.len(), spec.faces.clone()).expect("a valid mesh");
        let energy = LayerEnergy::with_bending(
            &mesh,
            &spec.rest,
            spec.parameters.clone(),
            &spec.pinned,
            spec.bending,
        )
        .expect("a valid layer");
        let free = energy.free_vertices().to_vec();
        let links = Links::new(&spec.links, &free, energy.pattern());
        let rows = to_constraint_rows(&spec.rows(&free), 3 * free.len());
        let areas = energy.vertex_areas();
        let damping = free
            .iter()
            .flat_map(|&v| [1e-6 * spec.theory.normal_stiffness * areas[v as usize]; 3])
            .collect();
        Self {
            kkt: Kkt::new(links.pattern(), &rows, 3).expect("a valid system"),
            positions: spec.rest.clone(),
            base: spec.rest.clone(),
            load: vec![0.0; 3 * free.len()],
            spec,
            energy,
            links,
            free,
            damping,
        }
    }

    /// Puts creases and anchors on edges, in place of earlier ones.
    ///
    /// # Panics
    /// When the layer refuses them.
    pub fn crease(&mut self, creases: &[(EdgeId, Crease)], anchors: &[LineAnchor]) {
        self.energy.set_creases(creases).expect("valid creases");
        let set = self.energy.set_line_anchors(anchors);
        set.expect("valid anchors");
    }

    /// How the creases are folded.
    pub fn crease_states(&self) -> Vec<CreaseState> {
        self.energy.crease_states(&self.positions)
    }

    /// Energy by origin, J.
    pub fn parts(&self) -> EnergyParts {
        self.energy.energy_parts(&self.positions)
    }

    /// Moves the base, with normals of its own, and carries the sheet along.
    ///
    /// # Panics
    /// When there is not one point and one unit normal per vertex.
    pub fn lay_on(&mut self, base: Vec<Vector3<f64>>, normals: &[Vector3<f64>]) {
        let zeros = vec![0.0; base.len()];
        let set = self.energy.set_base(&base, normals, &zeros);
        set.expect("a valid base");
        for (x, (old, new)) in self.positions.iter_mut().zip(self.base.iter().zip(&base)) {
            *x += new - old;
        }
        self.base = base;
    }

    /// Puts the sheet on its base, with heights up to `noise` thicknesses along `normal`.
    pub fn lie_down(&mut self, normal: Vector3<f64>, noise: f64, seed: u64) {
        self.positions.clone_from(&self.base);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        for &v in &self.free {
            let height = noise * self.spec.thickness * random.random_range(-1.0..1.0);
            self.positions[v as usize] += normal * height;
        }
    }

    /// Moves every vertex that may move.
    pub fn displace(&mut self, by: impl Fn(&Vector3<f64>) -> Vector3<f64>) {
        for &v in &self.free {
            let rest = &self.spec.rest[v as usize];
            self.positions[v as usize] += by(rest);
        }
    }

    /// Loads every vertex with a force per rest area, Pa.
    pub fn press(&mut self, pressure: Vector3<f64>) {
        let areas = self.energy.vertex_areas();
        for (&v, load) in self.free.iter().zip(self.load.chunks_exact_mut(3)) {
            load.copy_from_slice((pressure * areas[v as usize]).as_slice());
        }
    }

    /// Loads vertices with forces (N), those that move.
    pub fn load(&mut self, force: impl Fn(&Vector3<f64>) -> Vector3<f64>) {
        for (&v, load) in self.free.iter().zip(self.load.chunks_exact_mut(3)) {
            load.copy_from_slice(force(&self.spec.rest[v as usize]).as_slice());
        }
    }

    /// Loads vertices with weights (N), those that move.
    pub fn weigh(&mut self, weights: &[Vector3<f64>]) {
        for (&v, load) in self.free.iter().zip(self.load.chunks_exact_mut(3)) {
            load.copy_from_slice(weights[v as usize].as_slice());
        }
    }

    /// Solves as the product does.
    ///
    /// # Panics
    /// When the solver refuses its input.
    pub fn solve(&mut self, settings: &NewtonSettings) -> SolveReport {
        self.solve_by(minimise, settings)
    }

    /// Solves as Rémillard and Kry 2013 do: Newton's method on the forces, with a line search on
    /// their norm.
    ///
    /// # Panics
    /// When the solver refuses its input.
    pub fn solve_by_residual(&mut self) -> SolveReport {
        self.solve_by(by_residual, &NewtonSettings::default())
    }

    /// Solves by a method.
    ///
    /// # Panics
    /// When it refuses its input.
    pub fn solve_by(&mut self, minimise: Minimise, settings: &NewtonSettings) -> SolveReport {
        let (mut x, targets) = (gather(&self.free, &self.positions), self.targets());
        let base = gather(&self.free, &self.base);
        let (objective, kkt) = self.objective(&base);
        let report = minimise(&objective, &targets, &mut x, kkt, settings, &mut |_| true);
        scatter(&self.free, &x, &mut self.positions);
        report.expect("valid input")
    }

    /// Signs of the exact Hessian's pivots, here.
    ///
    /// # Panics
    /// When it cannot be factorised.
    pub fn inertia(&mut self) -> Inertia {
        let x = gather(&self.free, &self.positions);
        let base = gather(&self.free, &self.base);
        let (objective, kkt) = self.objective(&base);
        inertia_at(&objective, &x, kkt).expect("factorisable")
    }

    /// Size and cost of a factorisation.
    pub fn factor_cost(&self) -> FactorCost {
        self.kkt.cost()
    }

    /// The energy as it is now.
    pub fn layer(&self) -> &LayerEnergy {
        &self.energy
    }

    /// Averages of the base, and zero for ties.
    fn targets(&self) -> Vec<f64> {
        let mut targets = vec![0.0; self.kkt.rows().count()];
        let base = gather(&self.free, &self.base);
        let rows = self.kkt.rows();
        rows.mul(&base, &mut targets).expect("sizes match");
        // The last rows, three for every tie.
        let ties = targets.len() - 3 * self.spec.ties.len();
        targets[ties..].fill(0.0);
        targets
    }

    fn objective<'a>(&'a mut self, base: &'a [f64]) -> (SheetObjective<'a>, &'a mut Kkt) {
        let objective = SheetObjective {
            energy: &self.energy,
            links: &self.links,
            free: &self.free,
            positions: &self.positions,
            pattern: self.kkt.pattern().clone(),
            damping: &self.damping,
            reaction: &self.load,
            base,
            theory: &self.spec.theory,
            thickness: self.spec.thickness,
            area: self.energy.vertex_areas().iter().sum(),
        };
        (objective, &mut self.kkt)
    }

    /// Elastic energy and that of the load, J.
    pub fn loaded_energy(&self) -> f64 {
        let moved = |&v: &u32| self.positions[v as usize] - self.base[v as usize];
        let loads = self.free.iter().zip(self.load.chunks_exact(3));
        let work = loads.map(|(v, load)| Vector3::from_column_slice(load).dot(&moved(v)));
        self.energy() + self.links.value(&self.positions) - work.sum::<f64>()
    }

    /// Elastic energy, J.
    pub fn energy(&self) -> f64 {
        self.energy.value(&self.positions)
    }

    /// Elastic energy below that of the sheet on its base, J.
    pub fn gap(&self) -> f64 {
        self.energy.value(&self.base) - self.energy()
    }

    /// Where the vertices are, m.
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// Where they would lie on the base, m.
    pub fn base(&self) -> &[Vector3<f64>] {
        &self.base
    }

    /// Rest area of every vertex, m².
    pub fn areas(&self) -> &[f64] {
        self.energy.vertex_areas()
    }

    /// `sqrt(2)` RMS of the distance from the base along `normal` where `wanted` says so of a rest
    /// position, m.
    pub fn amplitude(&self, normal: &Vector3<f64>, wanted: impl Fn(&Vector3<f64>) -> bool) -> f64 {
        let (mut area, mut sum) = (0.0, 0.0);
        for (v, rest) in self.spec.rest.iter().enumerate() {
            if wanted(rest) {
                let height = (self.positions[v] - self.base[v]).dot(normal);
                area += self.areas()[v];
                sum += self.areas()[v] * height * height;
            }
        }
        (2.0 * sum / area).sqrt()
    }
}
