//! What a layer is made of, and how it wrinkles, at every place of a mesh.

use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;
use ruga_blend::Driver;
use ruga_material::{LayerMaterial, RelativeProperties, Wrinkling, local_wrinkling};
use ruga_mesh::{FaceId, Id, PerFace};

use crate::skin::local_skins::LocalSkins;
use crate::skin::material_places::uv;
use crate::skin::skin_mesh::SkinMesh;
use crate::{LayerSpec, StepperError};

/// Places that a thread samples at least.
const PLACES_AT_ONCE: usize = 256;

/// The layer at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalSkin {
    pub(crate) material: LayerMaterial,
    pub(crate) wrinkling: Wrinkling,
}

/// The layer at the vertices and on the faces of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct SkinProperties {
    vertices: LocalSkins,
    faces: LocalSkins,
}

impl LocalSkin {
    /// Mass per area of the layer there, kg/m².
    pub(crate) fn mass_per_area(&self) -> f64 {
        self.material.density * self.material.thickness
    }
}

impl SkinProperties {
    /// Samples the layer's map and its variation at the vertices; a face has the mean of its corners'
    /// properties (Li 2014, 5.2), except beside a sharp boundary, where it has those of a place inside.
    ///
    /// `tangential_stiffness` (Pa/m) replaces that of the layer's own tangential springs, where given.
    pub(crate) fn new(
        spec: &LayerSpec,
        nominal: &Wrinkling,
        tangential_stiffness: Option<f64>,
        driver: &Driver,
        skin: &SkinMesh,
    ) -> Result<Self, StepperError> {
        let (vertices, faces) = (skin.mesh.vertex_count(), skin.mesh.face_count());
        if spec.map.is_none() && spec.variation.is_none() {
            // An upper layer's tangential stiffness is among the nominal numbers already.
            let local = LocalSkin {
                material: spec.material,
                wrinkling: *nominal,
            };
            let [vertices, faces] =
                [vertices, faces].map(|count| LocalSkins::Even { local, count });
            return Ok(Self { vertices, faces });
        }
        let relative = relative_at_vertices(spec, driver, skin);
        let local = |relative: &RelativeProperties| -> Result<LocalSkin, StepperError> {
            let mut local = local_skin(spec, relative)?;
            if let Some(stiffness) = tangential_stiffness {
                local.wrinkling.tangential_stiffness = stiffness;
            }
            Ok(local)
        };
        let of_faces = relative_on_faces(spec, skin, &relative);
        let local_at = |places: &[RelativeProperties]| {
            let places = places.par_iter().with_min_len(PLACES_AT_ONCE);
            let found: Vec<_> = places.map(local).collect();
            // Of several errors the first is told, whoever was first.
            let found: Result<_, StepperError> = found.into_iter().collect();
            found.map(LocalSkins::Uneven)
        };
        Ok(Self {
            faces: local_at(of_faces.as_slice())?,
            vertices: local_at(&relative)?,
        })
    }

    /// The layer at a vertex.
    pub(crate) fn at_vertex(&self, vertex: usize) -> &LocalSkin {
        self.vertices.at(vertex)
    }

    /// The layer on a face.
    pub(crate) fn on_face(&self, face: FaceId) -> &LocalSkin {
        self.faces.at(face.index())
    }

    /// The layer at every vertex.
    pub(crate) fn at_vertices(&self) -> impl ExactSizeIterator<Item = &LocalSkin> + Clone {
        self.vertices.all()
    }

    /// The layer on every face.
    pub(crate) fn on_faces(&self) -> impl ExactSizeIterator<Item = &LocalSkin> + Clone {
        self.faces.all()
    }
}

/// Properties on the faces of a mesh, from those at its vertices: the means of their corners (Li 2014, 5.2), except
/// beside a sharp boundary, where a face has those of a place inside.
pub(crate) fn relative_on_faces(
    spec: &LayerSpec,
    skin: &SkinMesh,
    at_vertices: &[RelativeProperties],
) -> PerFace<RelativeProperties> {
    let corners = skin.mesh.faces().as_slice().iter();
    let mut of_faces: PerFace<RelativeProperties> = corners
        .map(|corners| mean(corners.map(|v| at_vertices[v.index()])))
        .collect();
    // Corners of such a face lie on the boundary, where paint of both sides is mixed.
    for (face, inside) in &skin.beside {
        let corners = skin.mesh.faces()[*face].map(|v| skin.rest.positions[v.index()]);
        let centre = corners.iter().sum::<Vector3<f64>>() / 3.0;
        of_faces[*face] = uneven(spec, painted(spec, inside), &centre);
    }
    of_faces
}

/// Properties by the layer's map and its variation at the vertices of a mesh.
pub(crate) fn relative_at_vertices(
    spec: &LayerSpec,
    driver: &Driver,
    skin: &SkinMesh,
) -> Vec<RelativeProperties> {
    let vertices = (0..skin.mesh.vertex_count()).into_par_iter();
    vertices
        .with_min_len(PLACES_AT_ONCE)
        .map(|vertex| relative_at(spec, driver, skin, vertex))
        .collect()
}

/// Properties by the layer's map and its variation at a vertex of a mesh.
pub(crate) fn relative_at(
    spec: &LayerSpec,
    driver: &Driver,
    skin: &SkinMesh,
    vertex: usize,
) -> RelativeProperties {
    let place = &skin.points.points()[vertex];
    uneven(
        spec,
        painted(spec, &uv(driver, place)),
        &skin.rest.positions[vertex],
    )
}

/// Properties by the layer's map at a texture coordinate.
pub(crate) fn painted(spec: &LayerSpec, uv: &Vector2<f64>) -> RelativeProperties {
    let sample = spec.map.as_ref().map(|map| map.sample(uv));
    sample.unwrap_or_default()
}

/// Critical mode of the layer on a face with these corners in the texture and at rest.
pub(crate) fn wrinkling_on_face(
    spec: &LayerSpec,
    nominal: &Wrinkling,
    (uvs, corners): (&[Vector2<f64>; 3], [Vector3<f64>; 3]),
) -> Result<Wrinkling, StepperError> {
    if spec.map.is_none() && spec.variation.is_none() {
        return Ok(*nominal);
    }
    // The map is read at the middle of the face. Beside a sharp boundary two corners lie on it, and
    // their mean would take two thirds of the jump away.
    let painted = spec.map.as_ref().map(|map| map.sample_face(uvs));
    let centre = corners.iter().sum::<Vector3<f64>>() / 3.0;
    let relative = uneven(spec, painted.unwrap_or_default(), &centre);
    Ok(local_skin(spec, &relative)?.wrinkling)
}

/// Adds the layer's natural unevenness at a rest position to what is painted there.
pub(crate) fn uneven(
    spec: &LayerSpec,
    painted: RelativeProperties,
    place: &Vector3<f64>,
) -> RelativeProperties {
    let factor = spec.variation.as_ref();
    let factor = factor.map_or(1.0, |field| field.thickness_factor(place));
    RelativeProperties {
        thickness: factor * painted.thickness,
        ..painted
    }
}

/// The layer where its map says `relative`.
pub(crate) fn local_skin(
    spec: &LayerSpec,
    relative: &RelativeProperties,
) -> Result<LocalSkin, StepperError> {
    let wrinkling = local_wrinkling(&spec.material, &spec.substrate, spec.model, relative);
    Ok(LocalSkin {
        material: relative.scaled(&spec.material),
        wrinkling: wrinkling.map_err(|source| StepperError::Material {
            layer: spec.name.clone(),
            source,
        })?,
    })
}

fn mean(corners: [RelativeProperties; 3]) -> RelativeProperties {
    let of =
        |property: fn(&RelativeProperties) -> f64| corners.iter().map(property).sum::<f64>() / 3.0;
    RelativeProperties {
        wavelength: of(|p| p.wavelength),
        young: of(|p| p.young),
        thickness: of(|p| p.thickness),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::{Matrix3, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use ruga_blend::{ArtistMesh, BaseSurface, Smoothing};
    use ruga_material::{PropertyImage, PropertyMap, Wrap, preset};
    use ruga_remesh::{FaceDriver, Refinement, RemeshSettings};

    use ruga_mesh::face_areas;

    use super::*;
    use crate::error::Halt;
    use crate::skin::piece::Piece;
    use crate::skin::skin_mesh::{RegionMesh, SizingStrains};
    use crate::{Coupling, Presence, Sampling};

    /// Depth inside the thick part at a place, m.
    type Paint<'a> = &'a dyn Fn(f64, f64) -> f64;

    /// Texels along the side of a map.
    const TEXELS: usize = 1024;

    /// A flat square metre of 8 by 8 squares. Right of the middle the texture coordinates may be those
    /// of another chart, turned by a right angle, with a gap between the two.
    fn square(has_seam: bool) -> Driver {
        let mut mesh = ArtistMesh::default();
        let mut uvs = Vec::new();
        for (i, j) in (0..8).flat_map(|j| (0..8).map(move |i| (i, j))) {
            let at = mesh.positions.len() as u32;
            for [x, y] in [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]] {
                let [x, y] = [x, y].map(|c| f64::from(c) / 8.0);
                mesh.positions.push(Vector3::new(x, y, 0.0));
                uvs.push(match (has_seam, i < 4) {
                    (false, _) => Vector2::new(x, y),
                    (true, true) => Vector2::new(0.9 * x, y),
                    (true, false) => Vector2::new(1.0 - 0.4 * y, x - 0.5),
                });
            }
            mesh.triangles
                .extend([[at, at + 1, at + 2], [at, at + 2, at + 3]]);
        }
        mesh.uvs = Some(uvs);
        Driver::new(&mesh).expect("a valid mesh")
    }

    /// The place of the square under a texture coordinate of its two charts.
    fn unfolded(u: f64, v: f64) -> [f64; 2] {
        match u < 0.525 {
            true => [u / 0.9, v],
            false => [v + 0.5, (1.0 - u) / 0.4],
        }
    }

    /// Thickness 1 where `depth`, in texture coordinates, is positive, and 0.5 elsewhere.
    fn map(depth: impl Fn(f64, f64) -> f64) -> PropertyMap {
        let texel = |i: usize| (i as f64 + 0.5) / TEXELS as f64;
        let cover = |i: usize| depth(texel(i % TEXELS), texel(i / TEXELS)) * TEXELS as f64 + 0.5;
        let values = (0..TEXELS * TEXELS).map(|i| cover(i).clamp(0.0, 1.0) as f32);
        let thickness = PropertyImage {
            width: TEXELS,
            height: TEXELS,
            values: values.collect(),
            range: [0.5, 1.0],
        };
        PropertyMap::new(None, None, Some(thickness), Wrap::ClampToEdge).expect("a map")
    }

    fn layer(map: PropertyMap, sharp: bool) -> LayerSpec {
        let preset = preset("forehead-furrow").expect("a preset");
        LayerSpec {
            name: "skin".to_owned(),
            material: preset.layer,
            laminate: None,
            substrate: preset.substrate,
            model: Default::default(),
            coupling: Coupling::Hybrid,
            sampling: Sampling::Quadrature,
            map: Some(Arc::new(map)),
            sharp,
            bending_transfer: None,
            variation: None,
            presence: Presence::default(),
            creases: Vec::new(),
            growths: Vec::new(),
        }
    }

    fn region(driver: &Driver, layer: &LayerSpec) -> Result<RegionMesh, StepperError> {
        let faces: Vec<ruga_mesh::FaceId> = driver.topology().faces().ids().collect();
        let base = BaseSurface::new(driver, &faces, 2, Smoothing::None);
        let on = (Piece::of(&base), Smoothing::None, 0.0);
        RegionMesh::new(driver, layer, on, &mut || true).map_err(|halt| match halt {
            Halt::Failed(error) => error,
            Halt::Interrupted => unreachable!("nothing ends it early"),
        })
    }

    /// A mesh of edges `length` (m), the region's own being some 0.03 long.
    fn fitted(driver: &Driver, region: &RegionMesh, length: f64) -> SkinMesh {
        let idle = FaceDriver {
            compression: Matrix3::zeros(),
            wavelength: 1.0,
            critical_strain: 1.0,
            poisson: 0.3,
        };
        let vertices = region.skin.mesh.vertex_count();
        let demand = SizingStrains {
            drivers: &PerFace::filled(region.skin.mesh.face_count(), idle),
            least: &vec![Matrix3::identity() / (length * length); vertices],
            aspects: &vec![1.0; vertices],
            refinement: Refinement::default(),
            budget: 1_000_000,
        };
        let adapted = region.adapted(driver, &demand, &RemeshSettings::default(), &mut || true);
        let adapted = adapted.expect("a mesh of a square");
        adapted.expect("nobody interrupts").skin
    }

    /// Fraction of the square that has another thickness than painted, weighted with the difference in
    /// jumps, and the largest part of a face beyond the boundary, in mean faces.
    fn misplaced(
        (driver, layer, skin): (&Driver, &LayerSpec, &SkinMesh),
        is_thick: impl Fn(f64, f64) -> bool,
    ) -> [f64; 2] {
        let nominal = local_skin(layer, &RelativeProperties::default()).expect("a material");
        let properties = SkinProperties::new(layer, &nominal.wrinkling, None, driver, skin);
        let properties = properties.expect("a material everywhere");
        let areas = face_areas(&skin.mesh, &skin.rest.positions);
        let (mut wrong, mut total, mut straddling) = (0.0, 0.0, 0.0f64);
        for (face, corners) in skin.mesh.faces().iter() {
            let [a, b, c] = corners.map(|v| skin.rest.positions[v.index()]);
            let area = areas[face];
            let thickness = properties.on_face(face).material.thickness / layer.material.thickness;
            let thick = thick_fraction([a, b, c], &is_thick);
            wrong += area * (thick * (1.0 - thickness) + (1.0 - thick) * (thickness - 0.5)) / 0.5;
            total += area;
            straddling = straddling.max(area * thick.min(1.0 - thick));
        }
        [
            wrong / total,
            straddling * skin.mesh.face_count() as f64 / total,
        ]
    }

    /// Fraction of a triangle that is painted thick, from the middles of its 144 parts.
    fn thick_fraction([a, b, c]: [Vector3<f64>; 3], is_thick: impl Fn(f64, f64) -> bool) -> f64 {
        let cells = (0..12).flat_map(|i| (0..12).map(move |j| [i, j]));
        let places = cells.flat_map(|cell| {
            [1.0, 2.0].map(|third| cell.map(|k| (f64::from(k) + third / 3.0) / 12.0))
        });
        let inside = places.filter(|[u, v]| u + v < 1.0);
        let is_thick = |[u, v]: [f64; 2]| {
            let p = a + (b - a) * u + (c - a) * v;
            is_thick(p.x, p.y)
        };
        let (mut thick, mut count) = (0.0, 0.0);
        for place in inside {
            thick += f64::from(u8::from(is_thick(place)));
            count += 1.0;
        }
        thick / count
    }

    /// Meshes finer than, as fine as and coarser than the region follow steps along the mesh, aslant
    /// and in a circle: without `sharp` 0.5 to 4 % of the square are smeared.
    #[test]
    fn sharp_steps_are_followed() {
        let driver = square(false);
        let slanted = |x: f64, y: f64| 0.5 * (x - 0.48) + 0.75f64.sqrt() * (y - 0.51);
        let on_edges = |x: f64, _: f64| x - 0.5;
        let along = |x: f64, _: f64| x - 0.517;
        let round = |x: f64, y: f64| 0.3 - (x - 0.5).hypot(y - 0.5);
        let paints: [(&str, Paint<'_>); 4] = [
            ("slanted", &slanted),
            ("on edges", &on_edges),
            ("along", &along),
            ("round", &round),
        ];
        for (name, depth) in paints {
            let is_thick = |x: f64, y: f64| depth(x, y) > 0.0;
            let [plain, sharp] = [false, true].map(|sharp| layer(map(depth), sharp));
            let [uncut, cut] =
                [&plain, &sharp].map(|layer| region(&driver, layer).expect("one boundary"));
            let [wrong, _] = misplaced((&driver, &sharp, &cut.skin), is_thick);
            assert!(wrong < 2e-4, "{name}: {wrong}");
            for length in [0.015, 0.03, 0.06] {
                let [smeared, _] = misplaced(
                    (&driver, &plain, &fitted(&driver, &uncut, length)),
                    is_thick,
                );
                let [wrong, straddling] =
                    misplaced((&driver, &sharp, &fitted(&driver, &cut, length)), is_thick);
                assert!(smeared > 0.004, "{name} {length}: {smeared}");
                assert!(wrong < 0.0015, "{name} {length}: {wrong}");
                assert!(straddling < 0.15, "{name} {length}: {straddling}");
            }
        }
    }

    /// A step that crosses a seam keeps its place and its two sides there.
    #[test]
    fn a_seam_does_not_matter() {
        let driver = square(true);
        let depth = |x: f64, y: f64| 0.5 * (x - 0.48) + 0.75f64.sqrt() * (y - 0.51);
        let is_thick = |x: f64, y: f64| depth(x, y) > 0.0;
        let painted = |u: f64, v: f64| {
            let [x, y] = unfolded(u, v);
            depth(x, y)
        };
        let layer = layer(map(painted), true);
        let region = region(&driver, &layer).expect("one boundary");
        for skin in [&region.skin, &fitted(&driver, &region, 0.02)] {
            let [wrong, straddling] = misplaced((&driver, &layer, skin), is_thick);
            assert!(wrong < 0.001, "{wrong}");
            assert!(straddling < 0.15, "{straddling}");
        }
    }

    /// Where nothing jumps, meshes and properties are the same to the last bit.
    #[test]
    fn without_steps_nothing_changes() {
        let driver = square(false);
        // A ramp over 300 texels.
        let ramp = map(|x, y| (x + y - 0.9) / 300.0);
        let mut unpainted = layer(ramp.clone(), false);
        unpainted.map = None;
        for spec in [layer(ramp, false), unpainted] {
            let [plain, sharp] = [false, true].map(|sharp| {
                let spec = LayerSpec {
                    sharp,
                    ..spec.clone()
                };
                let region = region(&driver, &spec).expect("no boundary");
                let skin = fitted(&driver, &region, 0.04);
                let nominal = local_skin(&spec, &RelativeProperties::default());
                let nominal = nominal.expect("a material").wrinkling;
                let found = SkinProperties::new(&spec, &nominal, None, &driver, &skin);
                let found = found.expect("a material everywhere");
                (skin.rest.positions, format!("{:?}", found.faces))
            });
            assert!(plain == sharp);
        }
    }

    /// Noise is refused where it is as fine as the mesh, and otherwise cut without end of vertices.
    #[test]
    fn noise_is_refused_or_bounded() {
        let driver = square(false);
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let mut refused = 0;
        for texels in [2, 8, 32, 128, 512] {
            let values = (0..texels * texels).map(|_| random.random_range(0.0..1.0));
            let noise = PropertyImage {
                width: texels,
                height: texels,
                values: values.collect(),
                range: [0.2, 2.0],
            };
            let noise = PropertyMap::new(None, None, Some(noise), Wrap::ClampToEdge);
            let layer = layer(noise.expect("a map"), true);
            match region(&driver, &layer) {
                Err(error) => {
                    refused += 1;
                    let said = error.to_string();
                    assert!(
                        said.contains("'skin'") && said.contains("`sharp`"),
                        "{said}"
                    );
                }
                Ok(region) => {
                    let vertices = region.skin.mesh.vertex_count();
                    assert!(vertices < 4 * 33 * 33, "{texels} texels: {vertices}");
                    fitted(&driver, &region, 0.04);
                }
            }
        }
        assert!((2..5).contains(&refused), "{refused}");
    }
}
