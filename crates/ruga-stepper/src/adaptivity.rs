//! Meshes that are fine only where, and in the direction that, a pose compresses the skin.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, SymmetricEigen};
use ruga_blend::{Driver, FaceStrain, rest_frame};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id, PerFace};
use ruga_remesh::{FaceDriver, Refinement, RemeshError, RemeshSettings, SizeLimits};

use crate::below::BelowSurface;
use crate::layer::{Layer, offered_strains};
use crate::local_skin::{LocalSkin, SkinProperties};
use crate::skin_mesh::{Adapted, MeshDemand, RegionMesh, SkinMesh};
use crate::{EdgeLimits, LayerSpec, Modelling, StepperError};

/// Longest edge where nothing wrinkles, in wavelengths: the low-pass rows, which reach further,
/// still see a smooth average.
pub(crate) const COARSEST: f64 = 0.5;

/// Edges per wavelength along the wrinkles, at least. With two, oblique waves are so soft that the
/// pattern of a film eight times beyond its onset drifted on for hundreds of iterations (8525
/// vertices, given up after 200 s); with 2.25 it took 37 s, with 2.5 21 s.
const LEAST_ALONG: f64 = 2.5;

/// Rounds of averaging of directions, at most: the region's mesh may be far finer than the reach.
const MOST_PASSES: f64 = 40.0;

/// Share of the region that may be coarser than asked for before its mesh is fitted anew.
const TOLERATED: f64 = 0.05;

/// The region's mesh fitted to what the surfaces `below` ask of it; `None` where meshes are to stay
/// uniform.
pub(crate) fn adapted(
    driver: &Driver,
    layer: &LayerSpec,
    wrinkling: &Wrinkling,
    region: &RegionMesh,
    below: &[BelowSurface],
    (modelling, points): (&Modelling, f64),
) -> Result<Option<Adapted>, StepperError> {
    let Some(limits) = modelling.remesh else {
        return Ok(None);
    };
    let drivers = SkinDemand::new(driver, layer, wrinkling, region, below)?;
    let wishes = Wishes::new(&drivers, region, &limits, points);
    let demand = wishes.demand(modelling.vertex_budget);
    let adapted = region.adapted(driver, &demand, &settings(&limits, points));
    adapted
        .map(Some)
        .map_err(|source| remesh_error(layer, source))
}

/// Whether the mesh of `layer` is fine enough for the surface `below` the region's own mesh.
pub(crate) fn still_serves(
    driver: &Driver,
    layer: &Layer,
    below: &BelowSurface,
    (modelling, points): (&Modelling, f64),
) -> Result<bool, StepperError> {
    let (Some(limits), Some(interpolation)) = (modelling.remesh, layer.interpolation()) else {
        return Ok(true);
    };
    let (spec, region) = (&layer.spec, layer.region());
    let below = std::slice::from_ref(below);
    let drivers = SkinDemand::new(driver, spec, &layer.wrinkling, region, below)?;
    let wishes = Wishes::new(&drivers, region, &limits, points);
    let demand = wishes.demand(modelling.vertex_budget);
    let places = interpolation.places();
    let share = region.share_too_coarse(layer.skin(), places, &demand, &settings(&limits, points));
    Ok(share.map_err(|source| remesh_error(spec, source))? <= TOLERATED)
}

/// Largest ratio of edges along and across the wrinkles where these have `points` per wavelength.
pub(crate) fn aspect(limits: &EdgeLimits, points: f64) -> f64 {
    limits.aspect.min(points / LEAST_ALONG).max(1.0)
}

fn settings(limits: &EdgeLimits, points: f64) -> RemeshSettings {
    RemeshSettings {
        limits: SizeLimits {
            min_edge: limits.min_edge,
            max_edge: limits.max_edge,
            aspect: aspect(limits, points),
            ..SizeLimits::default()
        },
        ..RemeshSettings::default()
    }
}

fn remesh_error(layer: &LayerSpec, source: RemeshError) -> StepperError {
    StepperError::Remesh {
        layer: layer.name.clone(),
        source,
    }
}

/// What drives wrinkles on the region's faces, and the layer at its vertices.
struct SkinDemand {
    drivers: PerFace<FaceDriver>,
    properties: SkinProperties,
}

impl SkinDemand {
    fn new(
        driver: &Driver,
        layer: &LayerSpec,
        wrinkling: &Wrinkling,
        region: &RegionMesh,
        below: &[BelowSurface],
    ) -> Result<Self, StepperError> {
        let properties = SkinProperties::new(layer, wrinkling, None, driver, &region.skin)?;
        Ok(Self {
            drivers: face_drivers(layer.material.poisson, &properties, &region.skin, below),
            properties,
        })
    }
}

/// What a layer asks of its mesh, on the region's faces and at its vertices.
struct Wishes<'a> {
    drivers: &'a PerFace<FaceDriver>,
    longest: Vec<f64>,
    aspects: Vec<f64>,
    points: f64,
}

impl<'a> Wishes<'a> {
    fn new(demand: &'a SkinDemand, region: &RegionMesh, limits: &EdgeLimits, points: f64) -> Self {
        let waves = demand.properties.vertices.iter();
        let waves = waves.map(|local| local.wrinkling.wavelength);
        let across = waves.clone().fold(f64::MAX, f64::min) / points;
        let aspect = aspect(limits, points);
        let reach = aspect * across;
        Self {
            longest: waves.map(|wavelength| COARSEST * wavelength).collect(),
            aspects: aspects(&region.skin, &demand.drivers, aspect, reach),
            drivers: &demand.drivers,
            points,
        }
    }

    fn demand(&self, budget: usize) -> MeshDemand<'_> {
        MeshDemand {
            drivers: self.drivers,
            longest: &self.longest,
            aspects: &self.aspects,
            refinement: Refinement {
                points_per_wavelength: self.points,
                ..Refinement::default()
            },
            budget,
        }
    }
}

/// How much longer than wide triangles may be at every vertex, at most `most`, where the direction
/// of the compression varies over the distance `reach`.
///
/// With a scatter `D` of the direction, an edge `r` times as long as the short ones `a` crosses
/// the wrinkles by `r a sin D`, which is to stay below `2 a`. The scatter follows from the
/// coherence `C` of the averaged direction as `sqrt(-ln(C) / 2)`.
fn aspects(skin: &SkinMesh, drivers: &PerFace<FaceDriver>, most: f64, reach: f64) -> Vec<f64> {
    // Up to here no scatter asks for less, and the mesh's own limit holds.
    if most <= 2.0 {
        return vec![f64::INFINITY; skin.mesh.vertex_count()];
    }
    let tensors = averaged_directions(skin, drivers, reach);
    let aspect = |tensor: &Matrix3<f64>| {
        let mut values = tensor.symmetric_eigenvalues();
        values.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
        let sum = values[0] + values[1];
        let coherence = if sum > 0.0 {
            (values[0] - values[1]) / sum
        } else {
            1.0
        };
        let scatter = (-0.5 * coherence.max(f64::MIN_POSITIVE).ln())
            .max(0.0)
            .sqrt();
        (2.0 / scatter.min(FRAC_PI_2).sin()).clamp(1.0, most)
    };
    tensors.iter().map(aspect).collect()
}

/// Directions `d d^T` of the faces' compression, weighted by area and size, averaged over `reach`
/// by diffusion from vertex to vertex.
fn averaged_directions(
    skin: &SkinMesh,
    drivers: &PerFace<FaceDriver>,
    reach: f64,
) -> Vec<Matrix3<f64>> {
    let mesh = &skin.mesh;
    let mut tensors = vec![Matrix3::zeros(); mesh.vertex_count()];
    let mut area = 0.0;
    for (face, corners) in mesh.faces().iter() {
        let [a, b, c] = corners.map(|v| skin.rest.positions[v.index()]);
        let share = 0.5 * (b - a).cross(&(c - a)).norm();
        area += share;
        // Tension does not wrinkle; the larger compression decides where both do.
        let eigen = SymmetricEigen::new(drivers[face].compression);
        let values = eigen.eigenvalues.map(|value| value.max(0.0).powi(2));
        let vectors = eigen.eigenvectors;
        let directions = vectors * Matrix3::from_diagonal(&values) * vectors.transpose();
        for v in corners {
            tensors[v.index()] += directions * (share / 3.0);
        }
    }
    let edge_squared = area / mesh.face_count().max(1) as f64 * 4.0 / 3f64.sqrt();
    // A pass moves by half an edge's square in each direction of the plane.
    let passes = (reach * reach / edge_squared).ceil().min(MOST_PASSES) as usize;
    for _ in 0..passes {
        let before = tensors.clone();
        let mut counts = vec![1.0; tensors.len()];
        for edge in mesh.edges().as_slice() {
            let [a, b] = edge.vertices.map(Id::index);
            tensors[a] += before[b];
            tensors[b] += before[a];
            counts[a] += 1.0;
            counts[b] += 1.0;
        }
        for (tensor, count) in tensors.iter_mut().zip(counts) {
            *tensor /= count;
        }
    }
    tensors
}

/// Every face's compression on the surface that asks most of it.
fn face_drivers(
    poisson: f64,
    properties: &SkinProperties,
    skin: &SkinMesh,
    below: &[BelowSurface],
) -> PerFace<FaceDriver> {
    let unloaded = |local: &LocalSkin| FaceDriver {
        compression: Matrix3::zeros(),
        wavelength: local.wrinkling.wavelength,
        critical_strain: local.wrinkling.critical_strain,
        poisson,
    };
    let faces = properties.faces.as_slice().iter();
    let mut drivers: PerFace<FaceDriver> = faces.map(unloaded).collect();
    let mut largest = PerFace::filled(drivers.len(), f64::NEG_INFINITY);
    for surface in below {
        for (face, strain) in offered_strains(skin, surface).iter() {
            let effective = strain.effective(poisson);
            if effective > largest[face] {
                largest[face] = effective;
                drivers[face].compression = in_space(skin, face, strain);
            }
        }
    }
    drivers
}

/// The compression `I - U` of a face as a tensor in space.
fn in_space(skin: &SkinMesh, face: FaceId, strain: &FaceStrain) -> Matrix3<f64> {
    let corners = skin.mesh.faces()[face].map(|v| skin.rest.positions[v.index()]);
    let [u, v] = rest_frame(corners);
    let first = u * strain.direction.x + v * strain.direction.y;
    let second = v * strain.direction.x - u * strain.direction.y;
    first * first.transpose() * strain.first + second * second.transpose() * strain.second
}
