//! Places that were to wrinkle and did not.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_material::{CAP_START, capped_strain};
use ruga_mesh::{FaceId, Id, VertexId, edge_distances, face_areas};

use super::Layer;
use crate::skin::material_places::uv;
use crate::skin::place::{ShapeCentres, place_of_points};

/// Applied strain over the critical one from which on wrinkles are expected: nearer to 1 they are
/// shallow, and neighbours that pull decide.
const EXPECTED: f64 = 1.5;

/// Size of a place, in squares of its wavelength, from which on a missing wrinkle is told.
const LEAST_AREA: f64 = 4.0;

/// Height over the amplitude predicted there from which on a vertex counts as part of a wrinkle.
const WRINKLED: f64 = 0.3;

/// Distance from the nearest wrinkle, in wavelengths, from which on a place counts as smooth: between
/// two crests no place is further than a quarter from one.
const AWAY: f64 = 1.0;

/// Points per wavelength below which a mesh cannot bend into it.
const COARSE: f64 = 4.0;

/// A connected part of the layer of which its pose asks for wrinkles.
struct Patch {
    faces: Vec<FaceId>,
    area: f64,
    /// Medians over its faces.
    wavelength: f64,
    critical_strain: f64,
    strain: f64,
}

impl Layer {
    /// Warnings of places that the pose compresses well beyond their critical
    /// strain and that have stayed smooth: where, and why.
    pub(crate) fn unwrinkled(&self, driver: &Driver) -> Vec<String> {
        let smooth = self.smooth_patches();
        if smooth.is_empty() {
            return Vec::new();
        }
        let shapes = ShapeCentres::new(driver);
        let told = smooth.iter().map(|patch| {
            format!(
                "{:.2} cm2 were to wrinkle and stayed smooth, {}: {}",
                1e4 * patch.area,
                self.place(driver, &shapes, patch),
                self.reason(patch)
            )
        });
        told.collect()
    }

    fn smooth_patches(&self) -> Vec<Patch> {
        let poisson = self.spec.material.poisson;
        let mesh = &self.skin.mesh;
        let areas = face_areas(mesh, &self.skin.rest.positions);
        let critical = |face: FaceId| self.properties.on_face(face).wrinkling.critical_strain;
        let strain = |face: FaceId| self.strains[face].effective(poisson);
        let is_expected = |face: FaceId| strain(face) > EXPECTED * critical(face);
        let heights = self.heights();
        let is_in_wrinkle = |face: FaceId| {
            let wrinkling = &self.properties.on_face(face).wrinkling;
            // Beyond the cap the layer feels hardly more. Where its critical strain is near the cap
            // itself, the predicted amplitude would be zero there, and any noise a wrinkle.
            let effective = strain(face).min(CAP_START);
            let effective = effective.max(EXPECTED * wrinkling.critical_strain);
            let least = WRINKLED * wrinkling.amplitude(effective);
            mesh.faces()[face]
                .iter()
                // One corner is enough, because between crest and trough a wave has no height.
                .any(|v| heights[v.index()].abs() > least)
        };
        let crests = mesh
            .faces()
            .ids()
            .filter(|f| is_expected(*f) && is_in_wrinkle(*f));
        let crests = crests.flat_map(|face| mesh.faces()[face]);
        let waves = self.properties.at_vertices();
        let waves: Vec<f64> = waves.map(|local| local.wrinkling.wavelength).collect();
        let furthest = AWAY * waves.iter().copied().fold(0.0, f64::max);
        let away = edge_distances(mesh, &self.skin.rest.positions, crests, furthest);
        let is_smooth = |face: FaceId| {
            let mut corners = mesh.faces()[face].iter();
            is_expected(face) && corners.all(|v| away[*v] > AWAY * waves[v.index()])
        };
        let parts = mesh.connected_parts(is_smooth).into_iter();
        let patches = parts.map(|faces| {
            let median = |value: &dyn Fn(FaceId) -> f64| {
                let mut values: Vec<f64> = faces.iter().map(|f| value(*f)).collect();
                values.sort_by(f64::total_cmp);
                values[values.len() / 2]
            };
            Patch {
                area: faces.iter().map(|f| areas[*f]).sum(),
                wavelength: median(&|f| self.properties.on_face(f).wrinkling.wavelength),
                critical_strain: median(&critical),
                strain: median(&strain),
                faces,
            }
        });
        let is_large = |patch: &Patch| patch.area > LEAST_AREA * patch.wavelength.powi(2);
        patches.filter(is_large).collect()
    }

    fn corners(&self, face: FaceId) -> [Vector3<f64>; 3] {
        self.skin.mesh.faces()[face].map(|v| self.skin.rest.positions[v.index()])
    }

    fn place(&self, driver: &Driver, shapes: &ShapeCentres, patch: &Patch) -> String {
        let corners = patch.faces.iter().flat_map(|f| self.skin.mesh.faces()[*f]);
        let corners: Vec<VertexId> = corners.collect();
        let points = self.skin.points.points();
        place_of_points(
            shapes,
            corners.iter().map(|v| uv(driver, &points[v.index()])),
            corners.iter().map(|v| self.skin.rest.positions[v.index()]),
        )
    }

    /// Why a place has no wrinkles, and what to do.
    fn reason(&self, patch: &Patch) -> String {
        let Patch {
            wavelength,
            critical_strain,
            strain,
            ..
        } = *patch;
        if capped_strain(strain) < critical_strain {
            return format!(
                "its critical strain there is {:.1} %, and beyond 15 % compression counts less and less. Paint it stiffer, or lower `critical_strain`",
                100.0 * critical_strain
            );
        }
        // Across the wrinkles edges are the shortest.
        let shortest = |f: &FaceId| {
            let [a, b, c] = self.corners(*f);
            (b - a).norm().min((c - b).norm()).min((a - c).norm())
        };
        let mut edges: Vec<f64> = patch.faces.iter().map(shortest).collect();
        edges.sort_by(f64::total_cmp);
        let points = wavelength / edges[edges.len() / 2];
        if points < COARSE {
            return format!(
                "its mesh has {points:.1} points per wavelength there, too few to bend. Take a finer `--quality`, or raise `vertex_budget` under [driver]"
            );
        }
        // The area over half of the outline is the width of a long strip, and the radius of a disc.
        if 0.5 * wavelength > patch.area / self.outline(patch) {
            return "the place is narrower than its wrinkles are long, and the smooth skin beside it holds it. Paint a shorter wavelength, or a wider place".to_owned();
        }
        "no wrinkled state was found from the smooth one. A map of it can be used as it is; `keys` closer together may find one, or on a soft body more `steps`".to_owned()
    }

    /// Half of the length of the edges around a place, m.
    fn outline(&self, patch: &Patch) -> f64 {
        let mesh = &self.skin.mesh;
        let inside: std::collections::BTreeSet<FaceId> = patch.faces.iter().copied().collect();
        let mut length = 0.0;
        for &face in &patch.faces {
            let corners = self.corners(face);
            for corner in 0..3 {
                let neighbour = mesh.neighbour(face, corner);
                if neighbour.is_none_or(|next| !inside.contains(&next)) {
                    length += (corners[(corner + 1) % 3] - corners[corner]).norm();
                }
            }
        }
        0.5 * length
    }
}
