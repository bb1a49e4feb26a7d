//! The mesh of a sheet that burns: fine where it burns and where it is bent, coarse where it is fresh.

use std::cell::OnceCell;

use nalgebra::{Matrix3, Vector3};
use ruga_blend::Driver;
use ruga_mesh::{FaceId, MaterialPoint, PerVertex};
use ruga_remesh::{
    PolyhedralSurface, Refinement, RemeshError, RemeshSettings, Remeshed, SizeLimits, Sizing,
    SizingInput, SurfaceMesh, Transfer, remesh_to_metric, sizing_field,
};

use super::Sheet;
use super::burning::{Burning, FireState};
use super::covering::Covering;
use super::field_grid::FieldGrid;
use super::meshed::holders;
use super::zones::Zone;
use crate::skin::interpolation::{Interpolation, places_on};
use crate::skin::skin_mesh::{RegionMesh, SkinMesh, sharp_map};
use crate::{LayerSpec, StepperError};

/// Edges of the first mesh over those asked for, one round after the other. Edges between old vertices are spared up to
/// a factor of 0.6, so that a mesh that is to become much coarser does so in two rounds.
const ROUNDS: [f64; 2] = [2.0, 1.0];

/// Edges over those asked for that the remesher leaves here and there: a mesh with longer ones is too coarse.
const TOO_LONG: f64 = 1.5;

/// Edges of the fresh sheet over those of the burning one from which on it pays to have two lengths.
const WORTH_IT: f64 = 1.5;

/// Turn along an edge up to which natural curvature is shown (rad); at [`ruga_shell::MAX_NATURAL_ANGLE`] it is cut.
const NATURAL_TURN: f64 = 0.25;

/// The mesh of a burning sheet, on the facets of the region's mesh.
pub(super) struct Fitting {
    /// Edges that are asked for where it burns, and where it is fresh and flat, m.
    lengths: [f64; 2],
    mesh: SurfaceMesh,
    /// Places on it of the vertices of the region's mesh.
    places: Vec<MaterialPoint>,
    /// Smooth interpolation to these, made when it is asked for.
    smooth: OnceCell<Interpolation>,
}

/// A mesh to go on with.
pub(super) struct Refitted {
    pub(super) fitting: Fitting,
    pub(super) skin: SkinMesh,
    pub(super) transfer: Transfer,
}

impl Fitting {
    /// The mesh of a fresh sheet, and the same with its places on the driver; `None` where one length of edges serves
    /// all of the sheet: by its size, because the scene says so, or because its map has boundaries to follow.
    pub(super) fn new(
        (spec, sheet): (&LayerSpec, &Sheet),
        (driver, region): (&Driver, &RegionMesh),
        (fire, burning): (&FireState<'_>, &Burning),
    ) -> Result<Option<(Self, SkinMesh)>, StepperError> {
        let rest = &region.skin.rest.positions;
        let lengths = sheet.edges(rest).map(|edge| edge / TOO_LONG);
        if lengths[1] < WORTH_IT * lengths[0] || sharp_map(spec).is_some() {
            return Ok(None);
        }
        let remesh = |source| StepperError::Remesh {
            layer: spec.name.clone(),
            source,
        };
        let (surface, mut mesh) = region.on_facets().map_err(remesh)?;
        // What a handle holds is the same on every mesh.
        let held = holders(sheet, rest)?.iter().map(Option::is_some).collect();
        mesh.fixed = held;
        let zones = fire.zones(burning, rest.len(), (&[], &[]));
        let wanted = wanted(&zones, lengths, |_| Matrix3::zeros());
        for round in ROUNDS {
            let made = fitted((region, &surface), &mesh, (&wanted, round), lengths);
            mesh = made.map_err(remesh)?.mesh;
        }
        Ok(Some(Self::on(driver, region, mesh, lengths)))
    }

    fn on(
        driver: &Driver,
        region: &RegionMesh,
        mesh: SurfaceMesh,
        lengths: [f64; 2],
    ) -> (Self, SkinMesh) {
        let skin = region.placed(driver, &mesh, &mut || true);
        let skin = skin.expect("nothing ends it early");
        let places = places_on(&skin, &region.skin, &mut || true);
        let fitting = Self {
            places: places.expect("nothing ends it early"),
            lengths,
            mesh,
            smooth: OnceCell::new(),
        };
        (fitting, skin)
    }

    /// How the mesh of temperature and fuel lies on it.
    pub(super) fn covering(
        &self,
        grid: &FieldGrid,
        region: &RegionMesh,
        skin: &SkinMesh,
    ) -> Covering {
        let points = self.mesh.points.as_slice();
        Covering::of_fitted(grid, (region, skin), points, &self.places)
    }

    /// Whether it is coarser than these zones of the region's vertices allow.
    pub(super) fn is_too_coarse(&self, zones: &[Zone]) -> bool {
        let longest = (TOO_LONG * self.lengths[0]).powi(2);
        let is_too_long = |face: FaceId| {
            let [a, b, c] = self.mesh.mesh.faces()[face].map(|v| self.mesh.positions[v]);
            [b - a, c - b, a - c]
                .iter()
                .any(|edge| edge.norm_squared() > longest)
        };
        let burning = zones.iter().zip(&self.places);
        burning
            .filter(|(zone, _)| **zone == Zone::Burning)
            .any(|(_, place)| is_too_long(place.face))
    }

    /// The mesh that these zones want, of a sheet that is at `positions` (m) and whose triangles have these natural
    /// curvatures (1/m).
    pub(super) fn again(
        &self,
        (driver, region): (&Driver, &RegionMesh),
        zones: &[Zone],
        (positions, curvatures): (&[Vector3<f64>], &[f64]),
    ) -> Result<Refitted, RemeshError> {
        let (surface, _) = region.on_facets()?;
        let bends = self.bends(positions, curvatures)?;
        let at_place = |v: usize| -> Matrix3<f64> {
            let place = &self.places[v];
            let corners = self.mesh.mesh.faces()[place.face].iter();
            let weighted = corners.zip(place.barycentric);
            weighted.map(|(v, weight)| bends.tensors[*v] * weight).sum()
        };
        let wanted = wanted(zones, self.lengths, at_place);
        let made = fitted((region, &surface), &self.mesh, (&wanted, 1.0), self.lengths)?;
        let Remeshed { mesh, transfer, .. } = made;
        let (fitting, skin) = Self::on(driver, region, mesh, self.lengths);
        Ok(Refitted {
            fitting,
            skin,
            transfer,
        })
    }

    /// The sizing that the shape and the natural curvatures (1/m) of its triangles ask for.
    fn bends(&self, positions: &[Vector3<f64>], curvatures: &[f64]) -> Result<Sizing, RemeshError> {
        let mut sizing = sizing_field(&SizingInput {
            mesh: &self.mesh,
            shape: positions,
            driver: None,
            refinement: Refinement::default(),
        })?;
        let mut most = PerVertex::filled(positions.len(), 0.0_f64);
        for ((_, corners), curvature) in self.mesh.mesh.faces().iter().zip(curvatures) {
            for v in corners {
                most[*v] = most[*v].max(*curvature);
            }
        }
        let tensors = sizing.tensors.as_mut_slice().iter_mut();
        for (tensor, curvature) in tensors.zip(most.as_slice()) {
            *tensor += Matrix3::identity() * (curvature / NATURAL_TURN).powi(2);
        }
        Ok(sizing)
    }

    /// Values at the vertices of the region's mesh, linear over every triangle of this one.
    pub(super) fn linear(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let at = |place: &MaterialPoint| {
            let corners = self.mesh.mesh.faces()[place.face].iter();
            let weighted = corners.zip(place.barycentric);
            weighted
                .map(|(v, weight)| values[v.0 as usize] * weight)
                .sum()
        };
        self.places.iter().map(at).collect()
    }

    /// Values at the vertices of the region's mesh from a smooth surface through those at the vertices of this one,
    /// which is `skin`.
    pub(super) fn smooth(
        &self,
        (skin, region): (&SkinMesh, &RegionMesh),
        values: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let smooth = self.smooth.get_or_init(|| {
            let made = Interpolation::new(skin, &region.skin, &mut || true);
            made.expect("nothing ends it early")
        });
        smooth.apply(values)
    }
}

/// The sizing of the region's vertices: `lengths` by their zones, and what bends there asks for.
fn wanted(
    zones: &[Zone],
    [fine, coarse]: [f64; 2],
    bend: impl Fn(usize) -> Matrix3<f64>,
) -> Vec<Matrix3<f64>> {
    let of_vertex = |(v, zone): (usize, &Zone)| {
        let length = if *zone == Zone::Fresh { coarse } else { fine };
        Matrix3::identity() / (length * length) + bend(v)
    };
    zones.iter().enumerate().map(of_vertex).collect()
}

/// The mesh that a sizing of the region's vertices wants, with edges `round` times as long, from another one.
fn fitted(
    (region, surface): (&RegionMesh, &PolyhedralSurface<'_>),
    from: &SurfaceMesh,
    (wanted, round): (&[Matrix3<f64>], f64),
    [fine, coarse]: [f64; 2],
) -> Result<Remeshed, RemeshError> {
    let limits = SizeLimits {
        min_edge: round * fine,
        max_edge: round * coarse,
        ..SizeLimits::default()
    };
    let longer = |tensor: &Matrix3<f64>| tensor / (round * round);
    let sizing = Sizing {
        tensors: wanted.iter().map(longer).collect(),
    };
    let (_, mesh) = region.on_facets()?;
    let sizing = sizing.limited(&mesh, surface, &limits)?;
    let metric = |place: MaterialPoint, _: Vector3<f64>| {
        let corners = mesh.mesh.faces()[place.face].iter();
        let weighted = corners.zip(place.barycentric);
        weighted
            .map(|(v, weight)| sizing.tensors[*v] * weight)
            .sum::<Matrix3<f64>>()
    };
    let settings = RemeshSettings {
        limits,
        ..RemeshSettings::default()
    };
    remesh_to_metric(from, &metric, surface, &settings)
}
