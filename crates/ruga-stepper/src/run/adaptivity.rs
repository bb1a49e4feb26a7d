//! Meshes that are fine only where, and in the direction that, a pose compresses the skin.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, SymmetricEigen};
use rayon::prelude::*;
use ruga_blend::{Driver, FaceStrain};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id, PerFace, face_areas, triangle_frame};
use ruga_remesh::{FaceDriver, Refinement, RemeshError, RemeshSettings, SizeLimits};

use crate::error::Halt;
use crate::preparing::Preparing;
use crate::run::layer::Layer;
use crate::run::strain_ratio::applied_strains;
use crate::skin::crease_neighbours::near_creases;
use crate::skin::local_skin::{LocalSkin, SkinProperties};
use crate::skin::skin_mesh::{Adapted, RegionMesh, SizingStrains, SkinMesh};
use crate::support::support_surface::SupportSurface;
use crate::{EdgeLimits, LayerSpec, Modelling, StepperError};

/// Longest edge where nothing wrinkles, in wavelengths: the low-pass rows, which reach further,
/// still see a smooth average.
pub(crate) const COARSEST: f64 = 0.5;

/// Edges per wavelength along the wrinkles, at least. With two, oblique waves are so soft that the
/// pattern of a film eight times beyond its onset drifted on for hundreds of iterations (8525
/// vertices, given up after 200 s); with 2.25 it took 37 s, with 2.5 21 s.
const LEAST_ALONG: f64 = 2.5;

/// Distance from a crease (wavelengths) within which edges are short whether the skin there is compressed or not: what
/// a fold brings up beside it is a wave that dies out.
pub(crate) const CREASE_REACH: f64 = 0.5;

/// Vertices in that reach over those that there would be if edges were as short everywhere as on the line: the
/// integral of `(1 + 2 t²)^-2` from 0 to 1.
pub(crate) const CREASE_FILLING: f64 = 0.5;

/// Edges at a share of the reach over those on the line, which are as short as wrinkles need. Of a furrow
/// no less than with short edges everywhere is found, with a twelfth less of a cheek's vertices.
fn crease_edges(share: f64) -> f64 {
    1.0 + 2.0 * share * share
}

/// Largest ratio of edges along and across a crease with `points` vertices per wavelength across it: with fewer
/// than four along it a soft one folds like a saw.
pub(crate) fn crease_aspect(points: f64) -> f64 {
    (points / 4.0).clamp(1.0, 3.0)
}

/// Rounds of averaging of directions, at most: the region's mesh may be far finer than the reach.
const MOST_PASSES: f64 = 40.0;

/// Fraction of the vertices asked for where a layer's mesh may be too coarse before it is fitted anew.
const TOLERATED: f64 = 0.05;

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

/// What a mesh has to resolve.
#[derive(Clone, Copy)]
pub(crate) enum Fitting<'a> {
    /// The wrinkles that these surfaces below ask for.
    Surfaces(&'a [SupportSurface]),
    /// Wrinkles everywhere, in any direction.
    Everywhere,
    /// The large shape alone.
    LargeShape,
}

/// Sizing that a layer asks for, on the faces of its region and at its vertices.
pub(crate) struct SizingRequest {
    drivers: PerFace<FaceDriver>,
    least: Vec<Matrix3<f64>>,
    aspects: Vec<f64>,
    refinement: Refinement,
    budget: usize,
    settings: RemeshSettings,
}

impl SizingRequest {
    /// Sizing of the region by `fitting`; `None` where meshes are to stay uniform.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] when the observer asks for it between the steps.
    pub(crate) fn new(
        driver: &Driver,
        (layer, wrinkling): (&LayerSpec, &Wrinkling),
        region: &RegionMesh,
        fitting: Fitting<'_>,
        (modelling, points): (&Modelling, f64),
        preparing: &mut Preparing<'_>,
    ) -> Result<Option<Self>, Halt> {
        let limits = match (fitting, modelling.remesh) {
            (_, Some(limits)) => limits,
            // This mesh is given up before there are results.
            (Fitting::LargeShape, None) => EdgeLimits::default(),
            (_, None) => return Ok(None),
        };
        let properties = SkinProperties::new(layer, wrinkling, None, driver, &region.skin)?;
        preparing.step()?;
        let below = match fitting {
            Fitting::Surfaces(below) => below,
            Fitting::Everywhere | Fitting::LargeShape => &[],
        };
        let drivers = face_drivers(layer.material.poisson, &properties, &region.skin, below);
        preparing.step()?;
        let waves = properties.at_vertices();
        let waves = waves.map(|local| local.wrinkling.wavelength);
        let across = waves.clone().fold(f64::MAX, f64::min) / points;
        let aspect = aspect(&limits, points);
        let (longest, refinement) = match fitting {
            Fitting::Everywhere => (
                1.0 / points,
                Refinement {
                    // Edges are as short as wrinkles need already. Curved places ask for no more.
                    angle: f64::INFINITY,
                    points_per_wavelength: points,
                    ..Refinement::default()
                },
            ),
            // On a body a mesh may be coarser than its waves are long.
            Fitting::Surfaces(_) | Fitting::LargeShape => (
                COARSEST.max(1.0 / points),
                Refinement {
                    points_per_wavelength: points,
                    ..Refinement::default()
                },
            ),
        };
        let edge = |edge: f64| edge.clamp(limits.min_edge, limits.max_edge);
        let mut aspects = aspects(&region.skin, &drivers, aspect, aspect * across);
        let mut least: Vec<Matrix3<f64>> = waves
            .clone()
            .map(|wave| Matrix3::identity() / edge(longest * wave).powi(2))
            .collect();
        let along_crease = crease_aspect(points);
        let reach = CREASE_REACH * waves.clone().fold(0.0, f64::max);
        for near in near_creases(&region.skin, reach, |_| true) {
            let (v, wave) = (
                near.vertex,
                properties.at_vertex(near.vertex).wrinkling.wavelength,
            );
            if near.distance <= CREASE_REACH * wave {
                let along = near.along * near.along.transpose();
                let stretched = along * along_crease.powi(-2) + Matrix3::identity() - along;
                let longer = crease_edges(near.distance / (CREASE_REACH * wave));
                let wanted = (longer / points).min(longest.max(1.0 / points));
                least[v] = stretched / edge(wanted * wave).powi(2);
                aspects[v] = aspects[v].min(along_crease);
            }
        }
        Ok(Some(Self {
            least,
            aspects,
            drivers,
            refinement,
            budget: modelling.vertex_budget,
            settings: settings(&limits, points),
        }))
    }

    /// Fits the region's mesh to the sizing.
    pub(crate) fn fitted(
        &self,
        driver: &Driver,
        layer: &LayerSpec,
        region: &RegionMesh,
        preparing: &mut Preparing<'_>,
    ) -> Result<Adapted, Halt> {
        let mut goes_on = || preparing.goes_on();
        let adapted = region.adapted(driver, &self.strains(), &self.settings, &mut goes_on);
        let adapted = adapted.map_err(|source| remesh_error(layer, source))?;
        adapted.ok_or(Halt::Interrupted)
    }

    /// Whether the mesh of `layer`, on the same region, is fine enough.
    pub(crate) fn are_met_by(&self, layer: &Layer) -> Result<bool, StepperError> {
        // Without a fitted mesh the layer is on the uniform one, which no pose changes.
        let Some(interpolation) = layer.interpolation() else {
            return Ok(true);
        };
        let places = interpolation.places();
        let region = layer.region();
        let too_coarse =
            region.fraction_too_coarse(layer.skin(), &places, &self.strains(), &self.settings);
        Ok(too_coarse.map_err(|source| remesh_error(&layer.spec, source))? <= TOLERATED)
    }

    fn strains(&self) -> SizingStrains<'_> {
        SizingStrains {
            drivers: &self.drivers,
            least: &self.least,
            aspects: &self.aspects,
            refinement: self.refinement,
            budget: self.budget,
        }
    }
}

/// Largest length over width of triangles at every vertex, at most `most`, where the direction
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
        // The third value, the least, belongs to the normal and is left out.
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
        // The scatter grows without bound where no direction prevails. Directions differ by a right
        // angle at most.
        (2.0 / scatter.min(FRAC_PI_2).sin()).clamp(1.0, most)
    };
    tensors.par_iter().map(aspect).collect()
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
    let areas = face_areas(mesh, &skin.rest.positions);
    let area: f64 = areas.as_slice().iter().sum();
    let directions = drivers.as_slice().par_iter().map(|driver| {
        // Tension does not wrinkle; the larger compression decides where both do.
        let eigen = SymmetricEigen::new(driver.compression);
        let values = eigen.eigenvalues.map(|value| value.max(0.0).powi(2));
        let vectors = eigen.eigenvectors;
        vectors * Matrix3::from_diagonal(&values) * vectors.transpose()
    });
    let directions: Vec<_> = directions.collect();
    for ((face, corners), directions) in mesh.faces().iter().zip(directions) {
        for v in corners {
            tensors[v.index()] += directions * (areas[face] / 3.0);
        }
    }
    // Triangles are taken as equilateral ones of the mean area.
    let edge_squared = area / mesh.face_count().max(1) as f64 * 4.0 / 3f64.sqrt();
    // A pass moves by half an edge's square in each direction of the plane.
    let passes = (reach * reach / edge_squared).ceil().min(MOST_PASSES) as usize;
    // A vertex counts itself in, which keeps a pass from swapping values between neighbours.
    let mut counts = vec![1.0; tensors.len()];
    for edge in mesh.edges().as_slice() {
        for v in edge.vertices {
            counts[v.index()] += 1.0;
        }
    }
    let mut before = tensors.clone();
    for _ in 0..passes {
        before.copy_from_slice(&tensors);
        for edge in mesh.edges().as_slice() {
            let [a, b] = edge.vertices.map(Id::index);
            tensors[a] += before[b];
            tensors[b] += before[a];
        }
        for (tensor, count) in tensors.iter_mut().zip(&counts) {
            *tensor /= *count;
        }
    }
    tensors
}

/// Every face's compression on the surface that asks most of it.
fn face_drivers(
    poisson: f64,
    properties: &SkinProperties,
    skin: &SkinMesh,
    below: &[SupportSurface],
) -> PerFace<FaceDriver> {
    let unloaded = |local: &LocalSkin| FaceDriver {
        compression: Matrix3::zeros(),
        wavelength: local.wrinkling.wavelength,
        critical_strain: local.wrinkling.critical_strain,
        poisson,
    };
    let faces = properties.on_faces();
    let mut drivers: PerFace<FaceDriver> = faces.map(unloaded).collect();
    let mut largest = PerFace::filled(drivers.len(), f64::NEG_INFINITY);
    for surface in below {
        let strains = applied_strains(skin, surface);
        let faces = drivers.as_mut_slice().par_iter_mut();
        let faces = faces.zip(largest.as_mut_slice()).enumerate();
        faces.for_each(|(face, (driver, largest))| {
            let face = FaceId::from_index(face);
            let effective = strains[face].effective(poisson);
            if effective > *largest {
                *largest = effective;
                // The tensor is in space, because averages are taken across faces, each of which
                // has a frame of its own.
                driver.compression = in_space(skin, face, &strains[face]);
            }
        });
    }
    drivers
}

/// The compression `I - U` of a face as a tensor in space.
fn in_space(skin: &SkinMesh, face: FaceId, strain: &FaceStrain) -> Matrix3<f64> {
    let corners = skin.mesh.faces()[face].map(|v| skin.rest.positions[v.index()]);
    let [u, v] = triangle_frame(&corners);
    let first = u * strain.direction.x + v * strain.direction.y;
    let second = v * strain.direction.x - u * strain.direction.y;
    first * first.transpose() * strain.first + second * second.transpose() * strain.second
}
