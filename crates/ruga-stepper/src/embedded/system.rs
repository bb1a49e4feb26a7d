//! The energies of a body and its layer that stay the same from load to load.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_lattice::{Embedding, Lattice, LatticeEnergy};
use ruga_mesh::{Id, PerVertex, VertexId, vertex_areas};
use ruga_shell::{BendingModel, LayerEnergy};
use ruga_solver::ConstraintRows;

use super::foundation::Foundation;
use super::inertia::{BodyMass, Diagonal};
use super::layout::Layout;
use super::plan::Interior;
use crate::layer::layer_parameters;
use crate::local_skin::{LocalSkin, SkinProperties};
use crate::low_pass_rows::{low_pass_rows, row_centres};
use crate::skin_mesh::SkinMesh;
use crate::{Body, LayerSpec, Plan, StepperError};

/// Levenberg floors: of a vertex in units of `K0 V_i`, as in a layer on a given surface, and of a
/// node in units of the lattice's mean stiffness. They give the motions of a free body a sign.
const FLOOR: [f64; 2] = [1e-6, 1e-9];

/// What a body and its layer are made of, discretised.
#[derive(Clone, Debug)]
pub(crate) struct BodySystem {
    /// The layer by itself, without springs to what lies below.
    pub(crate) shell: LayerEnergy,
    /// `None` where rows alone hold the layer.
    pub(crate) foundation: Option<Foundation>,
    /// Of the layer's vertices.
    pub(crate) embedding: Embedding,
    /// Over the free nodes, and over all.
    pub(crate) lattice: LatticeEnergy,
    pub(crate) all_nodes: LatticeEnergy,
    /// Number of every node among the free ones.
    pub(crate) free_of: Vec<Option<u32>>,
    pub(crate) mass: BodyMass,
    /// Weight on every node, N.
    pub(crate) weight: Vec<Vector3<f64>>,
    pub(crate) follow: Option<Follow>,
    pub(crate) layout: Layout,
    /// Rest areas of the layer's vertices, m².
    pub(crate) areas: Vec<f64>,
    pub(crate) floor: Vec<f64>,
    pub(crate) rows: ConstraintRows,
    /// What held nodes add to each row: node, axis and weight.
    held_terms: Vec<Vec<(u32, usize, f64)>>,
    /// What the user should know about the rows.
    pub(crate) row_warning: Option<String>,
}

/// Springs from the artist's vertices to where blend shapes put them.
#[derive(Clone, Debug)]
pub(crate) struct Follow {
    pub(crate) embedding: Embedding,
    /// N/m.
    pub(crate) stiffness: Vec<f64>,
    /// In the lattice's pattern, N/m.
    hessian: Vec<f64>,
}

impl BodySystem {
    pub(crate) fn new(
        (plan, interior): (&Plan, &Interior),
        skin: &SkinMesh,
        (properties, bending): (&SkinProperties, BendingModel),
    ) -> Result<Self, StepperError> {
        let driver = &plan.driver;
        let (spec, body) = (&plan.stacking.specs[0], &interior.body);
        let shell_error = |source| StepperError::Shell {
            layer: spec.name.clone(),
            source,
        };
        let shell = bare_shell(skin, properties, bending).map_err(shell_error)?;
        let areas = shell.vertex_areas().to_vec();
        let foundation = Foundation::new(spec, skin, properties, &areas).map_err(shell_error)?;
        let embedding = interior.carrier.embed(skin)?;
        let lattice = &interior.carrier.lattice;
        let energy = |pinned: &[bool]| -> Result<LatticeEnergy, StepperError> {
            let mut energy = LatticeEnergy::new(lattice, &body.material, pinned)?;
            if let Some(foundation) = &foundation {
                energy.couple_surface(&embedding, &foundation.pattern())?;
            }
            Ok(energy)
        };
        let pinned = interior.held.pinned();
        let [free, all_nodes] = [energy(&pinned)?, energy(&vec![false; pinned.len()])?];
        let free_of = numbers(&free, lattice);
        let of_layer = properties.vertices.iter().zip(&areas);
        let mass_of = |(local, area): (&LocalSkin, &f64)| local.mass_per_area() * area;
        let masses: Vec<f64> = of_layer.map(mass_of).collect();
        let mass = BodyMass::new(
            lattice,
            [&all_nodes, &free],
            body.density,
            (&embedding, &masses),
        )?;
        let weight = weight(lattice, body, &embedding, &masses)?;
        let follow = Follow::new(driver, interior, &free)?;
        let cross = cross_nodes(foundation.as_ref(), &embedding, &free_of, areas.len());
        let solver_error = |source| StepperError::Solver {
            layer: spec.name.clone(),
            source,
        };
        let layout = Layout::new(shell.pattern(), cross, free.pattern()).map_err(solver_error)?;
        let every: Vec<VertexId> = (0..areas.len()).map(VertexId::from_index).collect();
        let centres = row_centres(spec, properties, skin, &every)?;
        let on = (skin, plan.stacking.simulated[0].wavelength);
        let nothing = PerVertex::filled(every.len(), false);
        let low_pass = low_pass_rows(spec, &centres, on, &nothing, &every)?;
        let row_warning = low_pass.warning(driver, skin);
        let (rows, held_terms) = rows(spec, &low_pass.rows, &embedding, &free_of)?;
        Ok(Self {
            floor: floor(properties, &areas, &free, lattice),
            shell,
            foundation,
            embedding,
            lattice: free,
            all_nodes,
            free_of,
            mass,
            weight,
            follow,
            layout,
            areas,
            rows,
            held_terms,
            row_warning,
        })
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.areas.len()
    }

    /// What of the Hessian does not change as long as the surface's `normals` and the `inertia`
    /// (1/s²) don't, in the layout's order.
    pub(crate) fn constant_hessian(&self, normals: &[Vector3<f64>], inertia: f64) -> Vec<f64> {
        let layout = &self.layout;
        let mut values = vec![0.0; layout.pattern.entries()];
        if let Some(foundation) = &self.foundation {
            let own = foundation.hessian(normals);
            let pattern = foundation.pattern();
            layout.add_surface(&pattern, &own, &mut values);
            for vertex in 0..self.vertex_count() {
                for (node, block) in foundation.times(&self.embedding, normals, vertex) {
                    if let Some(free) = self.free_of[node as usize] {
                        layout.add_cross(vertex, free, &-block, &mut values);
                    }
                }
            }
            let body = layout.body(&mut values);
            self.lattice
                .add_pulled_back(&self.embedding, &pattern, &own, body);
        }
        let body = layout.body(&mut values);
        if let Some(follow) = &self.follow {
            add(body, &follow.hessian, 1.0);
        }
        if inertia > 0.0 {
            add(body, &self.mass.free, inertia);
        }
        values
    }

    /// What the rows ask for with the held nodes at `q`.
    pub(crate) fn row_targets(&self, q: &[Vector3<f64>]) -> Vec<f64> {
        let target = |terms: &Vec<(u32, usize, f64)>| {
            let of_node =
                |(node, axis, weight): &(u32, usize, f64)| weight * q[*node as usize][*axis];
            terms.iter().map(of_node).sum()
        };
        self.held_terms.iter().map(target).collect()
    }
}

impl Follow {
    fn new(
        driver: &Driver,
        interior: &Interior,
        lattice: &LatticeEnergy,
    ) -> Result<Option<Self>, StepperError> {
        let Some(stiffness) = interior.body.follow else {
            return Ok(None);
        };
        let embedding = interior.carrier.embed_control(driver)?;
        let areas = vertex_areas(driver.topology(), driver.rest());
        let stiffness: Vec<f64> = areas.iter().map(|area| stiffness * area).collect();
        let mut hessian = vec![0.0; lattice.pattern().1.len()];
        Diagonal::new(&stiffness).pull_back(lattice, &embedding, &mut hessian);
        Ok(Some(Self {
            embedding,
            stiffness,
            hessian,
        }))
    }
}

fn add(target: &mut [f64], values: &[f64], factor: f64) {
    for (target, value) in target.iter_mut().zip(values) {
        *target += factor * value;
    }
}

/// The layer without anything below it; nothing of it is pinned.
fn bare_shell(
    skin: &SkinMesh,
    properties: &SkinProperties,
    bending: BendingModel,
) -> Result<LayerEnergy, ruga_shell::ShellError> {
    let parameters = layer_parameters(properties, false);
    let faces = skin.corner_indices();
    let free = vec![false; skin.mesh.vertex_count()];
    LayerEnergy::with_bending(&skin.rest.positions, &faces, parameters, &free, bending)
}

fn numbers(free: &LatticeEnergy, lattice: &Lattice) -> Vec<Option<u32>> {
    let mut free_of = vec![None; lattice.node_count()];
    for (number, &node) in free.free_nodes().iter().enumerate() {
        free_of[node as usize] = Some(number as u32);
    }
    free_of
}

fn weight(
    lattice: &Lattice,
    body: &Body,
    embedding: &Embedding,
    masses: &[f64],
) -> Result<Vec<Vector3<f64>>, StepperError> {
    let gravity = &body.gravity;
    let mut weight = lattice.gravity_load(body.density, gravity)?;
    let of_layer: Vec<_> = masses.iter().map(|mass| gravity * *mass).collect();
    for (sum, force) in weight.iter_mut().zip(embedding.pull_back(&of_layer)) {
        *sum += force;
    }
    Ok(weight)
}

/// The free nodes that the foundation couples each vertex with.
fn cross_nodes(
    foundation: Option<&Foundation>,
    embedding: &Embedding,
    free_of: &[Option<u32>],
    vertices: usize,
) -> Vec<Vec<u32>> {
    let of_vertex = |vertex: usize| {
        let neighbours = foundation.into_iter().flat_map(|f| f.neighbours(vertex));
        let mut nodes: Vec<u32> = neighbours
            .flat_map(|j| embedding.rows().row(j))
            .filter_map(|(node, _)| free_of[node as usize])
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    };
    (0..vertices).map(of_vertex).collect()
}

fn floor(
    properties: &SkinProperties,
    areas: &[f64],
    free: &LatticeEnergy,
    lattice: &Lattice,
) -> Vec<f64> {
    let vertices = properties.vertices.iter().zip(areas);
    let of_vertex =
        |(local, area): (&LocalSkin, &f64)| [FLOOR[0] * local.wrinkling.normal_stiffness * area; 3];
    let mut floor: Vec<f64> = vertices.flat_map(of_vertex).collect();
    let (starts, rows) = free.pattern();
    let mut hessian = vec![0.0; rows.len()];
    free.hessian(lattice.rest_positions(), &mut hessian, None);
    let nodes = free.dof_count();
    let mean = starts[..nodes].iter().map(|&k| hessian[k]).sum::<f64>() / nodes.max(1) as f64;
    floor.extend(std::iter::repeat_n(FLOOR[1] * mean, nodes));
    floor
}

type HeldTerms = Vec<Vec<(u32, usize, f64)>>;

/// `H (x - B q)`: the layer's rows with the same averages of the surface below taken away.
fn rows(
    spec: &LayerSpec,
    of_layer: &ConstraintRows,
    embedding: &Embedding,
    free_of: &[Option<u32>],
) -> Result<(ConstraintRows, HeldTerms), StepperError> {
    let vertices = embedding.rows().row_count();
    let unknowns = 3 * vertices + 3 * free_of.iter().flatten().count();
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    let mut held_terms = Vec::with_capacity(of_layer.count());
    let mut weights = vec![0.0; free_of.len()];
    for row in 0..of_layer.count() {
        let (own, own_weights) = of_layer.row(row);
        columns.extend_from_slice(own);
        values.extend_from_slice(own_weights);
        let axis = own.first().map_or(0, |column| column % 3);
        for (column, weight) in own.iter().zip(own_weights) {
            for (node, share) in embedding.rows().row(column / 3) {
                weights[node as usize] += weight * share;
            }
        }
        let mut held = Vec::new();
        for (node, weight) in weights.iter_mut().enumerate() {
            let weight = std::mem::take(weight);
            match free_of[node] {
                _ if weight == 0.0 => {}
                Some(free) => {
                    columns.push(3 * vertices + 3 * free as usize + axis);
                    values.push(-weight);
                }
                None => held.push((node as u32, axis, weight)),
            }
        }
        held_terms.push(held);
        starts.push(columns.len());
    }
    let rows = ConstraintRows::new(starts, columns, values, unknowns);
    let rows = rows.map_err(|source| StepperError::Solver {
        layer: spec.name.clone(),
        source,
    })?;
    Ok((rows, held_terms))
}
