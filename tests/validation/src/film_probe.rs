//! What a film tells when it is asked: its softest mode, its normals.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{Id, LoopSurface, MaterialPoint, PerVertex, SurfaceLookup, TriMesh, VertexId};
use ruga_solver::{SolverError, inertia_at, softest_mode};

use crate::Film;
use crate::film_objective::gather;
use crate::remeshed_film::bending_factor;

/// Inverse iterations towards a mode; near its own onset it is softer than others by far.
const ITERATIONS: usize = 15;

/// The softest mode of a film that lies flat.
#[derive(Clone, Copy, Debug)]
pub struct FlatMode {
    /// Stiffness of the mode, N/m; negative past its onset.
    pub stiffness: f64,
    /// Its wavelength over the critical one, from the number of half-waves.
    pub relative_wavelength: f64,
}

impl Film {
    /// Makes up for triangles that bend more or less easily than the material, as the product does.
    pub fn calibrate_bending(&mut self) {
        let pinned = self.strip.ends();
        let factor = bending_factor(&self.spec, &self.rest, &self.strip.topology(), &pinned);
        self.energy
            .set_bending_factor(factor)
            .expect("a positive factor");
    }

    /// Vertices.
    pub fn vertex_count(&self) -> usize {
        self.rest.len()
    }

    /// Lays the film down flat at `load` critical strains and gives its softest mode.
    ///
    /// # Errors
    /// What the solver refuses.
    pub fn flat_mode(&mut self, load: f64, seed: u64) -> Result<FlatMode, SolverError> {
        self.lay_down(load, 0.0, 0);
        let x = gather(&self.free, &self.positions);
        let (objective, kkt) = self.objective(&x);
        let soft = softest_mode(&objective, &x, kkt, seed, ITERATIONS)?;
        let mut heights = vec![0.0; self.rest.len()];
        for (&v, moved) in self.free.iter().zip(soft.mode.chunks_exact(3)) {
            heights[v as usize] = moved[2];
        }
        Ok(FlatMode {
            stiffness: soft.rayleigh_quotient,
            relative_wavelength: self.wavelength(&heights) / self.wrinkling.wavelength,
        })
    }

    /// Whether the film is at a minimum rather than a saddle, whatever found the shape it has.
    ///
    /// # Errors
    /// What the solver refuses.
    pub fn is_minimum(&mut self) -> Result<bool, SolverError> {
        let x = gather(&self.free, &self.positions);
        let (objective, kkt) = self.objective(&x);
        Ok(inertia_at(&objective, &x, kkt)?.is_minimum())
    }

    /// Unit normals of the film's smooth surface near the given places of the rest plane (m), and
    /// where exactly they are: the Loop limit of control points that are corrected once, as results
    /// are handed out.
    ///
    /// # Panics
    /// When the film has no surface.
    pub fn smooth_normals(&self, places: &[Vector2<f64>]) -> Vec<(Vector2<f64>, Vector3<f64>)> {
        let mesh = TriMesh::new(self.rest.len(), self.strip.faces.clone()).expect("a valid mesh");
        let corners = self.corners();
        let lookup = SurfaceLookup::new(&mesh, &self.rest);
        let address = |p: &Vector2<f64>| lookup.closest(&p.push(0.0)).expect("a surface").point;
        let addresses: Vec<MaterialPoint> = places.iter().map(address).collect();
        let surface = LoopSurface::new(&mesh, &corners);
        let at_vertices = ruga_mesh::limit_rows(&mesh, &corners).position;
        let rows = surface.rows(&addresses);
        let jets = [&self.rest, &self.positions].map(|values| {
            let reached = at_vertices.apply(values);
            let corrected = values.iter().zip(&reached);
            let control: Vec<_> = corrected.map(|(value, at)| value * 2.0 - at).collect();
            rows.apply(&control)
        });
        let [rest, posed] = &jets;
        rest.iter()
            .zip(posed)
            .map(|(rest, posed)| {
                let normal = posed.normal().expect("a surface without folds");
                (rest.position.xy(), normal)
            })
            .collect()
    }

    /// Without its corners marked, the border would mix what is pinned with what slides.
    fn corners(&self) -> PerVertex<bool> {
        let tolerance = 1e-9 * self.strip.length;
        let is_at = |x: f64, end: f64| x < tolerance || x > end - tolerance;
        let (length, width) = (self.strip.length, self.strip.width);
        let mut corners = PerVertex::filled(self.rest.len(), false);
        for (i, p) in self.strip.points.iter().enumerate() {
            corners[VertexId::from_index(i)] = is_at(p.x, length) && is_at(p.y, width);
        }
        corners
    }
}
