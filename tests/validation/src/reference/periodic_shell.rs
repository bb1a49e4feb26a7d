//! The energy of the simulator's shell on a flat base that repeats.
//!
//! Copies of the border's triangles, without stiffness of their own, carry the hinges across it: a
//! hinge takes the mean stiffness of its two triangles, so that each of the two that stand for one
//! has half of it.

use nalgebra::Vector3;
use ruga_material::{LayerMaterial, Wrinkling};
use ruga_mesh::TriMesh;
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{LowerPattern, Objective};

use super::periodic_mesh::PeriodicMesh;

/// Stiffness of a copied triangle over that of the film: none, but above zero.
const NOTHING: f64 = 1e-9;

/// A film by the coordinates of its vertices inside the rectangle.
pub(super) struct PeriodicShell {
    pub(super) mesh: PeriodicMesh,
    film: Wrinkling,
    thickness: f64,
    originals: Vec<usize>,
    energy: LayerEnergy,
    pattern: LowerPattern,
    slots: Vec<Slot>,
    damping: Vec<f64>,
    /// Mean compressive strains along x and y.
    strain: [f64; 2],
}

/// Where an entry of the Hessian of all vertices goes, and how often.
#[derive(Clone, Copy)]
struct Slot {
    position: usize,
    count: f64,
}

impl PeriodicShell {
    pub(super) fn new(mesh: PeriodicMesh, material: &LayerMaterial, film: Wrinkling) -> Self {
        let parameters = parameters(&mesh, material, &film);
        let pinned = vec![false; mesh.points.len()];
        let topology = TriMesh::new(mesh.points.len(), mesh.faces.clone()).expect("a mesh");
        let energy =
            LayerEnergy::new(&topology, &mesh.points, parameters, &pinned).expect("a layer");
        let (pattern, slots) = folded(&energy, &mesh);
        let vertex_area = mesh.edge * mesh.edge * 0.75_f64.sqrt();
        Self {
            film,
            thickness: material.thickness,
            originals: mesh.originals(),
            damping: vec![1e-6 * film.normal_stiffness * vertex_area; 3 * mesh.count()],
            mesh,
            energy,
            pattern,
            slots,
            strain: [0.0; 2],
        }
    }

    /// Shrinks the base by compressive strains along x and y.
    pub(super) fn set_strain(&mut self, strain: [f64; 2]) {
        self.strain = strain;
        let points = self.all(&self.base());
        let normals = vec![Vector3::z(); points.len()];
        self.energy
            .set_base(&points, &normals, &vec![0.0; points.len()])
            .expect("a valid base");
    }

    /// Coordinates of the rectangle's vertices on the base, m.
    pub(super) fn base(&self) -> Vec<f64> {
        let place = |&vertex: &usize| {
            let p = self.mesh.points[vertex];
            [
                p.x * (1.0 - self.strain[0]),
                p.y * (1.0 - self.strain[1]),
                0.0,
            ]
        };
        self.originals.iter().flat_map(place).collect()
    }

    /// Rest area, m^2.
    pub(super) fn area(&self) -> f64 {
        let [length, width] = self.mesh.extent();
        length * width
    }

    /// Positions of all vertices, copies included.
    fn all(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let extent = self.mesh.extent();
        let place = |&(origin, cell): &(usize, [i32; 2])| {
            let period =
                |axis: usize| f64::from(cell[axis]) * extent[axis] * (1.0 - self.strain[axis]);
            Vector3::new(
                x[3 * origin] + period(0),
                x[3 * origin + 1] + period(1),
                x[3 * origin + 2],
            )
        };
        self.mesh.origins.iter().map(place).collect()
    }
}

impl Objective for PeriodicShell {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.energy.value(&self.all(x))
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.all(x);
        let mut forces = vec![0.0; self.energy.dof_count()];
        self.energy.gradient(&positions, &mut forces);
        gradient.fill(0.0);
        for (force, (origin, _)) in forces.chunks_exact(3).zip(&self.mesh.origins) {
            for axis in 0..3 {
                gradient[3 * origin + axis] += force[axis];
            }
        }
        self.energy.value(&positions)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let mut unfolded = [0, 1].map(|_| vec![0.0; self.slots.len()]);
        let [all, loose] = &mut unfolded;
        self.energy.hessian(&self.all(x), all, Some(loose));
        for (target, values) in [exact, relaxed].into_iter().zip(&unfolded) {
            target.fill(0.0);
            for (slot, value) in self.slots.iter().zip(values) {
                target[slot.position] += slot.count * value;
            }
        }
    }

    fn damping(&self) -> &[f64] {
        &self.damping
    }

    fn energy_scale(&self) -> f64 {
        0.5 * self.film.membrane_stiffness * self.film.critical_strain.powi(2) * self.area()
    }

    fn force_scale(&self) -> f64 {
        let share = self.area() / self.mesh.count() as f64;
        self.film.normal_stiffness * self.thickness * share
    }

    fn length_scale(&self) -> f64 {
        self.thickness
    }
}

fn parameters(mesh: &PeriodicMesh, material: &LayerMaterial, film: &Wrinkling) -> LayerParameters {
    let face = |&is_copy: &bool| {
        let (share, spring) = if is_copy { (NOTHING, 0.0) } else { (1.0, 1.0) };
        FaceParameters {
            young: share * material.young,
            poisson: material.poisson,
            thickness: material.thickness,
            normal_stiffness: spring * film.normal_stiffness,
            gradient_stiffness: spring * film.gradient_stiffness,
        }
    };
    let tangential = |vertex: usize| {
        if mesh.is_original(vertex) {
            film.tangential_stiffness
        } else {
            0.0
        }
    };
    LayerParameters {
        faces: mesh.is_copy.iter().map(face).collect(),
        tangential_stiffness: (0..mesh.points.len()).map(tangential).collect(),
    }
}

/// Pattern of the Hessian by the rectangle's vertices, and where each entry of the one by all
/// vertices goes in it.
fn folded(energy: &LayerEnergy, mesh: &PeriodicMesh) -> (LowerPattern, Vec<Slot>) {
    let (starts, entries) = energy.pattern();
    let unknown = |dof: usize| 3 * mesh.origins[dof / 3].0 + dof % 3;
    let mut places = Vec::with_capacity(entries.len());
    for column in 0..starts.len() - 1 {
        for &row in &entries[starts[column]..starts[column + 1]] {
            let row = row as usize;
            let [a, b] = [unknown(column), unknown(row)];
            // Above and below the diagonal at once, where two copies meet in one unknown.
            let count = if a == b && row != column { 2.0 } else { 1.0 };
            places.push(([a.min(b), a.max(b)], count));
        }
    }
    let mut sorted: Vec<_> = places.iter().map(|place| place.0).collect();
    sorted.sort_unstable();
    sorted.dedup();
    let size = 3 * mesh.count();
    let mut columns = vec![0; size + 1];
    for [column, _] in &sorted {
        columns[column + 1] += 1;
    }
    for column in 0..size {
        columns[column + 1] += columns[column];
    }
    let rows: Vec<u32> = sorted.iter().map(|place| place[1] as u32).collect();
    let slot = |&(place, count): &([usize; 2], f64)| Slot {
        position: sorted.binary_search(&place).expect("one of the places"),
        count,
    };
    let slots = places.iter().map(slot).collect();
    let pattern = LowerPattern::new(columns, rows).expect("sorted columns");
    (pattern, slots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FlatFilm;

    const SIZE: [usize; 2] = [6, 4];

    /// A shell under strain, and a state of it that is bent and sheared everywhere.
    fn shaken(move_by: usize) -> (PeriodicShell, Vec<f64>) {
        let spec = FlatFilm::new(150.0);
        let film = spec.theory();
        let mesh = PeriodicMesh::new(SIZE[0], SIZE[1], film.wavelength / 8.0, 1);
        let mut shell = PeriodicShell::new(mesh, &spec.layer.material, film);
        shell.set_strain([0.04, 0.03]);
        let mut x = shell.base();
        for (index, x) in x.iter_mut().enumerate() {
            let (vertex, axis) = (index / 3, index % 3);
            let column = (vertex % SIZE[0] + move_by) % SIZE[0];
            let number = (vertex / SIZE[0] * SIZE[0] + column) * 3 + axis;
            let size = if axis == 2 { 0.3 } else { 0.05 };
            *x += size * spec.layer.material.thickness * (1.7 * (number * number) as f64).sin();
        }
        (shell, x)
    }

    #[test]
    fn the_seam_costs_nothing() {
        let [(shell, here), (_, there)] = [shaken(0), shaken(2)];
        let [a, b] = [here, there].map(|x| shell.value(&x));
        // The copies have a stiffness of 1e-9.
        assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}");
    }

    #[test]
    fn folded_derivatives_are_those_of_the_value() {
        let (shell, x) = shaken(0);
        let step = 1e-6 * shell.mesh.edge;
        let direction: Vec<f64> = (0..x.len()).map(|i| (0.9 * i as f64).cos()).collect();
        let at = |share: f64| -> Vec<f64> {
            let pairs = x.iter().zip(&direction);
            pairs.map(|(x, d)| x + share * step * d).collect()
        };
        let forces = |x: &[f64]| {
            let mut gradient = vec![0.0; x.len()];
            shell.gradient(x, &mut gradient);
            gradient
        };
        let slope = (shell.value(&at(1.0)) - shell.value(&at(-1.0))) / (2.0 * step);
        let exact: f64 = forces(&x).iter().zip(&direction).map(|(g, d)| g * d).sum();
        assert!((slope / exact - 1.0).abs() < 1e-6, "{slope} {exact}");

        let pattern = shell.pattern();
        let mut values = [0, 1].map(|_| vec![0.0; pattern.entries()]);
        let [hessian, relaxed] = &mut values;
        shell.hessian(&x, hessian, relaxed);
        let mut product = vec![0.0; x.len()];
        for column in 0..x.len() {
            let range = pattern.column_starts()[column]..pattern.column_starts()[column + 1];
            for (&row, value) in pattern.rows()[range.clone()].iter().zip(&hessian[range]) {
                let row = row as usize;
                product[row] += value * direction[column];
                if row != column {
                    product[column] += value * direction[row];
                }
            }
        }
        let [up, down] = [forces(&at(1.0)), forces(&at(-1.0))];
        let scale = product.iter().fold(0.0_f64, |a, p| a.max(p.abs()));
        for ((up, down), product) in up.iter().zip(&down).zip(&product) {
            let error = (up - down) / (2.0 * step) - product;
            assert!(error.abs() < 1e-6 * scale, "{error} of {scale}");
        }
    }
}
