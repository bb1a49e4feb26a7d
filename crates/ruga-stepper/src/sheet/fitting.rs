//! The mesh of a sheet that burns: fine where it burns and where it is bent, coarse where it is fresh.

use std::cell::OnceCell;
use std::iter::Sum;
use std::ops::Mul;

use nalgebra::{Matrix3, Vector3};
use ruga_blend::Driver;
use ruga_mesh::{Id, MaterialPoint, PerVertex, TriMesh, VertexId};
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
use crate::error::Halt;
use crate::skin::interpolation::{Interpolation, Values, places_on};
use crate::skin::skin_mesh::{RegionMesh, SkinMesh};
use crate::{LayerSpec, StepperError};

/// Edges of the first mesh over those asked for, one round after the other. Edges between old vertices are spared up to
/// a factor of 0.6, so that a mesh that is to become much coarser does so in two rounds.
const ROUNDS: [f64; 2] = [2.0, 1.0];

/// Longest edges that the remesher leaves over those asked for.
const LONGEST: f64 = 1.5;

/// Turn along an edge up to which natural curvature is shown (rad); at [`ruga_shell::MAX_NATURAL_ANGLE`] it is cut.
const NATURAL_TURN: f64 = 0.25;

/// The mesh of a burning sheet, on the facets of the region's mesh.
pub(super) struct Fitting {
    /// Edges that are asked for where it burns, and where it is fresh and flat, m.
    lengths: [f64; 2],
    mesh: SurfaceMesh,
    /// Sizing that the shape at rest asks for at the vertices of the region's mesh, 1/m².
    at_rest: Vec<Matrix3<f64>>,
    /// Places on it of the vertices of the region's mesh, and whether it was asked to be fine there.
    places: Vec<MaterialPoint>,
    is_fine: Vec<bool>,
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
    /// all of the sheet.
    pub(super) fn new(
        (spec, sheet): (&LayerSpec, &Sheet),
        (driver, region): (&Driver, &RegionMesh),
        (fire, burning): (&FireState<'_>, &Burning),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<(Self, SkinMesh)>, Halt> {
        let rest = &region.skin.rest.positions;
        let [fine, coarse] = sheet.edges(rest);
        if fine == coarse {
            return Ok(None);
        }
        let remesh = |source| Halt::Failed(remesh_error(spec, source));
        let (surface, own) = region.on_facets().map_err(remesh)?;
        let at_rest = sizing_field(&SizingInput {
            mesh: &own,
            shape: rest,
            driver: None,
            refinement: Refinement::default(),
        });
        let at_rest = at_rest.map_err(remesh)?.tensors.into_vec();
        // What a handle holds is the same on every mesh.
        let mut mesh = SurfaceMesh {
            fixed: holders(sheet, rest)?.iter().map(Option::is_some).collect(),
            ..own.clone()
        };
        let zones = fire.zones(burning, &region.skin.mesh, (&[], &[]));
        let lengths = [fine, coarse].map(|edge| edge / LONGEST);
        let wanted = wanted(&zones, lengths, |v| at_rest[v]);
        for round in ROUNDS {
            let made = fitted((&own, &surface), &mesh, (&wanted, round), lengths);
            mesh = made.map_err(remesh)?.mesh;
            if !goes_on() {
                return Err(Halt::Interrupted);
            }
        }
        let made = Self::on((driver, region), (mesh, lengths, at_rest), &zones, goes_on);
        made.ok_or(Halt::Interrupted).map(Some)
    }

    /// With its vertices' places on the driver, and those of the region's on it; `None` as soon as `goes_on` says no.
    fn on(
        (driver, region): (&Driver, &RegionMesh),
        (mesh, lengths, at_rest): (SurfaceMesh, [f64; 2], Vec<Matrix3<f64>>),
        zones: &[Zone],
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<(Self, SkinMesh)> {
        let skin = region.placed(driver, &mesh, goes_on)?;
        let fitting = Self {
            places: places_on(&skin, None, &region.skin, goes_on)?,
            is_fine: zones.iter().map(|zone| *zone != Zone::Quiet).collect(),
            at_rest,
            lengths,
            mesh,
            smooth: OnceCell::new(),
        };
        Some((fitting, skin))
    }

    /// For every vertex whether it was one that a handle holds from the beginning: those that came later may lie in the
    /// box of a handle as well, but not where it has moved to.
    pub(super) fn may_be_held(&self) -> &[bool] {
        self.mesh.fixed.as_slice()
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

    /// Whether something burns where it was not asked to be fine.
    pub(super) fn is_too_coarse(&self, zones: &[Zone]) -> bool {
        let mut places = zones.iter().zip(&self.is_fine);
        places.any(|(zone, is_fine)| *zone == Zone::Burning && !is_fine)
    }

    /// The mesh that these zones want, of a sheet that is at `positions` (m) and whose triangles have these natural
    /// curvatures (1/m).
    pub(super) fn again(
        &self,
        (spec, driver, region): (&LayerSpec, &Driver, &RegionMesh),
        zones: &[Zone],
        (positions, curvatures): (&[Vector3<f64>], &[f64]),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Refitted, Halt> {
        let remesh = |source| Halt::Failed(remesh_error(spec, source));
        let (surface, own) = region.on_facets().map_err(remesh)?;
        let bends = self.bends(positions, curvatures).map_err(remesh)?;
        let bend = |v: usize| {
            let place = &self.places[v];
            let own: Matrix3<f64> = linear_at(&self.mesh.mesh, place, |v| bends.tensors[v]);
            own + self.at_rest[v]
        };
        let wanted = wanted(zones, self.lengths, bend);
        let made = fitted((&own, &surface), &self.mesh, (&wanted, 1.0), self.lengths);
        let Remeshed { mesh, transfer, .. } = made.map_err(remesh)?;
        let of = (mesh, self.lengths, self.at_rest.clone());
        let made = Self::on((driver, region), of, zones, goes_on);
        let (fitting, skin) = made.ok_or(Halt::Interrupted)?;
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
        let at = |place| linear_at(&self.mesh.mesh, place, |v| values[v.index()]);
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
            let prepared = made.and_then(|made| made.prepared(&mut || true));
            prepared.expect("nothing ends it early")
        });
        let [there] = smooth.apply([Values::Vectors(values)]);
        there
    }
}

/// The value at a place of a mesh, linear between those at the corners of its triangle.
fn linear_at<T: Mul<f64, Output = T> + Sum>(
    mesh: &TriMesh,
    place: &MaterialPoint,
    value: impl Fn(VertexId) -> T,
) -> T {
    let corners = mesh.faces()[place.face].into_iter();
    let weighted = corners.zip(place.barycentric);
    weighted.map(|(v, weight)| value(v) * weight).sum()
}

fn remesh_error(spec: &LayerSpec, source: RemeshError) -> StepperError {
    StepperError::Remesh {
        layer: spec.name.clone(),
        source,
    }
}

/// The sizing of the region's vertices: `lengths` by their zones, and what bends there asks for.
fn wanted(
    zones: &[Zone],
    [fine, coarse]: [f64; 2],
    bend: impl Fn(usize) -> Matrix3<f64>,
) -> Vec<Matrix3<f64>> {
    let of_vertex = |(v, zone): (usize, &Zone)| {
        let length = if *zone == Zone::Quiet { coarse } else { fine };
        Matrix3::identity() / (length * length) + bend(v)
    };
    zones.iter().enumerate().map(of_vertex).collect()
}

/// The mesh that a sizing of the vertices of `region` wants, with edges `round` times as long, from another one.
fn fitted(
    (region, surface): (&SurfaceMesh, &PolyhedralSurface<'_>),
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
    let sizing = sizing.limited(region, surface, &limits)?;
    let metric = |place: MaterialPoint, _: Vector3<f64>| -> Matrix3<f64> {
        linear_at(&region.mesh, &place, |v| sizing.tensors[v])
    };
    let settings = RemeshSettings {
        limits,
        ..RemeshSettings::default()
    };
    remesh_to_metric(from, &metric, surface, &settings)
}
