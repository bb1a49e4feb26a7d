//! How the mesh's triangles bend, and the correction for it.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use ruga_mesh::{Edge, Id, PerFace, PerVertex, TriMesh, VertexId, face_areas, triangle_frame};
use ruga_shell::{BendingModel, HINGE_EXPONENT, ResponseQuery, face_corners, response_modulus};

use super::Layer;
use crate::StepperError;
use crate::run::neighbourhood::Neighbourhood;
use crate::support::support_surface::SupportSurface;

/// Cosine of the angle to the main direction up to which a face wrinkles in that direction.
const ALONG_MAIN: f64 = 0.9;
/// Length of the main direction's part in a face from which on waves in that direction can run there.
const LEAST_PART: f64 = 0.3;
/// Lengths along the main direction, over the mean of those that wrinkle in it, that do not resolve its
/// waves: from two thirds of the points on a mesh is soft.
const TOO_LONG: f64 = 1.5;

/// Area on which a mesh is measured, in squares of the wavelength. More of the same triangles would tell
/// the same, at a cost that grows faster than the area: two thirds of the preparation of a whole hand.
const ENOUGH: f64 = 100.0;

/// Ratios of a mesh's bending modulus to the material's that can be the triangles' doing. A smaller
/// one counts as not measured.
const BENDING_RATIOS: [f64; 2] = [0.5, 2.0];

impl Layer {
    /// Measures how the mesh bends where, and in the direction that, `support` compresses the layer,
    /// and makes up for what is missing to the material, for hinges also for what is too much; the
    /// layer stays where it is.
    /// False when the layer is compressed enough to wrinkle and could not be measured.
    pub(crate) fn calibrate_bending(
        &mut self,
        support: SupportSurface,
    ) -> Result<bool, StepperError> {
        let state = self.state();
        self.set_support(support, 1.0)?;
        let [low, high] = BENDING_RATIOS;
        let measured = self.measured_bending_ratio();
        self.bending_ratio = measured
            .filter(|ratio| *ratio >= low)
            .map(|ratio| ratio.min(high));
        if let Some(ratio) = self.bending_ratio {
            let ratio = match self.bending {
                BendingModel::Hinge => ratio,
                // No layer is made softer: what is left above 1 is how well two meshes can be compared.
                BendingModel::VertexCurvature => ratio.min(1.0),
            };
            let outcome = self.energy.set_bending_factor(1.0 / ratio);
            outcome.map_err(|source| self.shell_error(source))?;
        }
        let is_measured = self.bending_ratio.is_some() || self.strain_ratio() <= 1.0;
        // It was measured on the surface of a key, and the layer begins at rest.
        self.restore(&state)?;
        Ok(is_measured)
    }

    /// Response bending modulus of this mesh, compressed in the main direction, over that of the
    /// material; `None` where nothing is compressed enough or the mesh has no wrinkling mode.
    ///
    /// One direction for all: one that varies from face to face frustrates the mode and would
    /// count as stiffness. What the borders of narrow places add is in the response of a mesh of half
    /// the edges, too, and leaves with their ratio `R`: errors go with the square of the edge, and
    ///
    /// ```text
    /// R = (1 - e)/(1 - e/4),   1 - e = 3 R/(4 - R)
    /// ```
    fn measured_bending_ratio(&self) -> Option<f64> {
        let mesh = &self.skin.mesh;
        let corners = face_corners(mesh, &self.skin.rest.positions);
        let main = self.main_direction(&corners)?;
        // On a body, too, where nothing holds the border: the softest wave runs along a free edge, is
        // about half as stiff as any in the middle, and says nothing of the mesh. Where one half of a symmetric pose
        // ends it is held, too: its mesh is the same there as elsewhere.
        let mut pinned = mesh.border_vertices();
        // Where nothing wrinkles, or in another direction, triangles are long across the main one: the
        // softest wave would be there, and stiffen all of the layer for nothing.
        let too_long = self.too_long_faces(&corners, &main);
        for (face, _) in too_long.iter().filter(|(_, on)| **on) {
            mesh.faces()[face].iter().for_each(|&v| pinned[v] = true);
        }
        let areas = face_areas(mesh, &self.skin.rest.positions);
        let enough = ENOUGH * self.wrinkling.wavelength.powi(2);
        pin_all_but_the_middle(mesh, &areas, &mut pinned, enough);
        let (mesh, corners, pinned) = around_free(mesh, &corners, &pinned);
        let modulus = || self.response(&mesh, &corners, &main, &pinned);
        match self.bending {
            // Hinges are wrong by what shape their triangles have, however small these are.
            BendingModel::Hinge => Some(modulus()? / self.wrinkling.bending_stiffness),
            BendingModel::VertexCurvature => {
                // Side by side: that the first comes to nothing is rare.
                let (modulus, of_halves) = rayon::join(modulus, || {
                    let (mesh, corners, pinned) = halved(&mesh, &corners, &pinned);
                    self.response(&mesh, &corners, &main, &pinned)
                });
                let ratio = modulus? / of_halves?;
                Some(3.0 * ratio / (4.0 - ratio))
            }
        }
    }

    /// Response bending modulus (N m) of a mesh on this layer's foundation, compressed in one direction.
    fn response(
        &self,
        mesh: &TriMesh,
        corners: &[[Vector3<f64>; 3]],
        direction: &Vector3<f64>,
        pinned: &PerVertex<bool>,
    ) -> Option<f64> {
        let directions = vec![*direction; mesh.face_count()];
        let response = response_modulus(&ResponseQuery {
            mesh,
            corners,
            directions: &directions,
            fixed: pinned.as_slice(),
            bending_modulus: self.wrinkling.bending_stiffness,
            hinge_exponent: HINGE_EXPONENT,
            poisson: self.spec.material.poisson,
            bending_model: self.bending,
            normal_stiffness: self.wrinkling.normal_stiffness,
            gradient_stiffness: self.wrinkling.gradient_stiffness,
        });
        let response = response.ok().filter(|response| response.converged);
        response.map(|response| response.bending_modulus)
    }

    /// The faces that are longer along `main` than those are on the average that wrinkle in that direction.
    fn too_long_faces(&self, corners: &[[Vector3<f64>; 3]], main: &Vector3<f64>) -> PerFace<bool> {
        let ratios = self.strain_ratios();
        let mut extents = Vec::with_capacity(corners.len());
        let mut wrinkled = Vec::new();
        for (corners, (face, strain)) in corners.iter().zip(self.strains.iter()) {
            let [u, v] = triangle_frame(corners);
            let [along, beside] = [u.dot(main), v.dot(main)];
            let extent = match along.hypot(beside) {
                // Where the layer stands across the direction there is no wave in it.
                part if part < LEAST_PART => f64::INFINITY,
                part => {
                    let places = corners.map(|x| (u * along + v * beside).dot(&(x - corners[0])));
                    let [low, high] =
                        [f64::min, f64::max].map(|of| places.into_iter().fold(0.0, of));
                    (high - low) / part
                }
            };
            extents.push(extent);
            let direction = u * strain.direction.x + v * strain.direction.y;
            if ratios.of_face(face) > 1.0 && direction.dot(main).abs() > ALONG_MAIN {
                wrinkled.push(extent);
            }
        }
        let count = wrinkled.len() as f64;
        let longest = TOO_LONG * wrinkled.iter().sum::<f64>() / count;
        // Nothing is too long beside no wrinkles.
        extents.iter().map(|extent| *extent > longest).collect()
    }

    /// The direction in space in which most of the compression beyond the critical strain goes.
    fn main_direction(&self, corners: &[[Vector3<f64>; 3]]) -> Option<Vector3<f64>> {
        let mut tensor = Matrix3::zeros();
        let ratios = self.strain_ratios();
        let areas = face_areas(&self.skin.mesh, &self.skin.rest.positions);
        for (corners, (face, strain)) in corners.iter().zip(self.strains.iter()) {
            let excess = ratios.of_face(face) - 1.0;
            let [u, v] = triangle_frame(corners);
            let direction = u * strain.direction.x + v * strain.direction.y;
            // A direction and its opposite are the same wave, and would cancel in a sum of vectors.
            tensor += direction * direction.transpose() * (areas[face] * excess.max(0.0));
        }
        let eigen = SymmetricEigen::new(tensor);
        let largest = eigen.eigenvalues.imax();
        (eigen.eigenvalues[largest] > 0.0).then(|| eigen.eigenvectors.column(largest).into_owned())
    }
}

/// Pins what is beyond an area of `enough` (m²) around the middle of the widest place that is not pinned.
fn pin_all_but_the_middle(
    mesh: &TriMesh,
    areas: &PerFace<f64>,
    pinned: &mut PerVertex<bool>,
    enough: f64,
) {
    let mut of_vertex: PerVertex<f64> = PerVertex::filled(mesh.vertex_count(), 0.0);
    for (face, area) in areas.iter() {
        mesh.faces()[face]
            .iter()
            .for_each(|&v| of_vertex[v] += area / 3.0);
    }
    let free = of_vertex.iter().filter(|(v, _)| !pinned[*v]);
    if free.map(|(_, area)| area).sum::<f64>() <= enough {
        return;
    }
    let around = Neighbourhood::new(mesh);
    let held = pinned.iter().filter(|(_, held)| **held).map(|(v, _)| v.0);
    // The last one lies deepest.
    let reached = around.reached_from(held.collect(), |_| true);
    let Some(&middle) = reached.last() else {
        return;
    };
    let kept = around.reached_from(vec![middle], |v| !pinned[VertexId(v)]);
    pinned.as_mut_slice().fill(true);
    let mut area = 0.0;
    for v in kept.into_iter().map(VertexId) {
        area += of_vertex[v];
        if area > enough {
            return;
        }
        pinned[v] = false;
    }
}

/// The faces around the vertices that are not pinned, two rings deep, with vertices and faces in their old order. What is
/// measured on them is the same to the last bit, and of a large mesh the middle alone is halved; what may be wrong
/// with a face further off does not count.
fn around_free(
    mesh: &TriMesh,
    corners: &[[Vector3<f64>; 3]],
    pinned: &PerVertex<bool>,
) -> (TriMesh, Vec<[Vector3<f64>; 3]>, PerVertex<bool>) {
    let faces = mesh.faces().as_slice();
    let mut is_in: Vec<bool> = pinned.as_slice().iter().map(|pinned| !pinned).collect();
    // A vertex is in the stars of its neighbours, which end at theirs.
    for _ in 0..2 {
        let near = is_in.clone();
        let touching = faces
            .iter()
            .filter(|face| face.iter().any(|v| near[v.index()]));
        touching.flatten().for_each(|v| is_in[v.index()] = true);
    }
    let kept = (0..mesh.vertex_count()).filter(|&v| is_in[v]);
    let kept: Vec<VertexId> = kept.map(VertexId::from_index).collect();
    let mut number = vec![0; mesh.vertex_count()];
    for (new, old) in (0..).zip(&kept) {
        number[old.index()] = new;
    }
    let whole = faces.iter().zip(corners);
    let (faces, corners) = whole
        .filter(|(face, _)| face.iter().all(|v| is_in[v.index()]))
        .map(|(face, corners)| (face.map(|v| number[v.index()]), *corners))
        .unzip();
    let part = TriMesh::new(kept.len(), faces).expect("faces of a manifold are one");
    (part, corners, kept.into_iter().map(|v| pinned[v]).collect())
}

/// The mesh with all triangles split in four where they lie; an edge's middle is pinned if both of its
/// ends are.
fn halved(
    mesh: &TriMesh,
    corners: &[[Vector3<f64>; 3]],
    pinned: &PerVertex<bool>,
) -> (TriMesh, Vec<[Vector3<f64>; 3]>, PerVertex<bool>) {
    let count = mesh.vertex_count();
    let mut faces = Vec::with_capacity(4 * corners.len());
    let mut places = Vec::with_capacity(4 * corners.len());
    for ((face, ends), x) in mesh.faces().iter().zip(corners) {
        let middles = mesh
            .face_edges(face)
            .map(|edge| (count + edge.index()) as u32);
        let between = [0, 1, 2].map(|i: usize| 0.5 * (x[i] + x[(i + 1) % 3]));
        for i in 0..3 {
            let before = (i + 2) % 3;
            faces.push([ends[i].0, middles[i], middles[before]]);
            places.push([x[i], between[i], between[before]]);
        }
        faces.push(middles);
        places.push(between);
    }
    let is_pinned = |edge: &Edge| edge.vertices.iter().all(|&v| pinned[v]);
    let middles = mesh.edges().as_slice().iter().map(is_pinned);
    let pinned = pinned.as_slice().iter().copied().chain(middles).collect();
    let mesh = TriMesh::new(count + mesh.edges().len(), faces);
    (mesh.expect("a manifold stays one"), places, pinned)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of `n` by `n` squares of side 1, its border pinned.
    fn grid(n: u32) -> (TriMesh, PerFace<f64>, PerVertex<bool>) {
        let at = |i, j| i * (n + 1) + j;
        let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let faces = squares.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        let mesh = TriMesh::new((n + 1).pow(2) as usize, faces.collect()).expect("a grid");
        let areas = PerFace::filled(mesh.face_count(), 0.5);
        let pinned = mesh.border_vertices();
        (mesh, areas, pinned)
    }

    /// What is measured around the free vertices is what the whole mesh says, to the last bit.
    #[test]
    fn a_part_is_measured_as_the_whole_is() {
        let (mesh, areas, mut pinned) = grid(40);
        let place = |v: usize| Vector3::new((v / 41) as f64, (v % 41) as f64, 0.0);
        let bumpy = |x: Vector3<f64>| x + Vector3::z() * (0.1 * (0.7 * x.x + 0.3 * x.y).sin());
        let places: Vec<_> = (0..41 * 41).map(|v| bumpy(place(v))).collect();
        let corners = face_corners(&mesh, &places);
        pin_all_but_the_middle(&mesh, &areas, &mut pinned, 80.0);
        let part = around_free(&mesh, &corners, &pinned);
        assert!(part.0.face_count() < mesh.face_count() / 4);
        let modulus = |mesh: &TriMesh, corners: &[[Vector3<f64>; 3]], pinned: &PerVertex<bool>| {
            let directions = vec![Vector3::x(); mesh.face_count()];
            let response = response_modulus(&ResponseQuery {
                mesh,
                corners,
                directions: &directions,
                fixed: pinned.as_slice(),
                bending_modulus: 1.0,
                hinge_exponent: HINGE_EXPONENT,
                poisson: 0.4,
                bending_model: BendingModel::VertexCurvature,
                normal_stiffness: 0.5,
                gradient_stiffness: 0.0,
            });
            response.expect("a stable sheet").bending_modulus
        };
        let found = modulus(&part.0, &part.1, &part.2);
        assert_eq!(found, modulus(&mesh, &corners, &pinned));
        let of_halves = |(mesh, corners, pinned): &(TriMesh, Vec<_>, _)| {
            let (mesh, corners, pinned) = halved(mesh, corners, pinned);
            modulus(&mesh, &corners, &pinned)
        };
        let whole = (mesh, corners, pinned);
        assert_eq!(of_halves(&part), of_halves(&whole));
    }

    #[test]
    fn a_small_place_is_measured_as_it_is() {
        let (mesh, areas, mut pinned) = grid(6);
        let before = pinned.clone();
        pin_all_but_the_middle(&mesh, &areas, &mut pinned, 25.0);
        assert_eq!(pinned.as_slice(), before.as_slice());
    }

    #[test]
    fn of_a_large_place_the_middle_is_measured() {
        let (mesh, areas, mut pinned) = grid(20);
        pin_all_but_the_middle(&mesh, &areas, &mut pinned, 50.0);
        let free: Vec<usize> = (0..21 * 21).filter(|&v| !pinned.as_slice()[v]).collect();
        assert!((45..=50).contains(&free.len()), "{} vertices", free.len());
        let far = |v: usize| (v / 21).abs_diff(10).max((v % 21).abs_diff(10));
        assert!(free.iter().all(|&v| far(v) <= 5), "{free:?}");
    }
}
