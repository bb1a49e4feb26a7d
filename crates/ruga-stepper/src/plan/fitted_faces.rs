//! How many triangles a fitted mesh will have.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{FaceId, PerFace, TriMesh, edge_distances};
use ruga_remesh::{FaceDriver, Refinement, SizeLimits};

use crate::EdgeLimits;
use crate::plan::region::PoseStrains;
use crate::run::adaptivity::{COARSEST, CREASE_FILLING, CREASE_REACH, aspect, crease_aspect};

/// Share of the vertices that a border would need by itself which fitted meshes have for it: from 250 poses of a face.
const BORDER_SHARE: f64 = 0.2;

/// Triangles of a mesh fitted to what a pose asks for, in the `active` faces of a surface at its rest positions (m).
///
/// Where the layer wrinkles, edges across the wrinkles have the asked fraction of a wavelength, along
/// them they are longer by the aspect, unless it wrinkles that way too; elsewhere they grow with the
/// distance from there towards half a wavelength. Where the surface bends they are shorter, whichever way
/// it does.
pub(crate) fn fitted_faces(
    ((mesh, positions), active): ((&TriMesh, &[Vector3<f64>]), &[FaceId]),
    (pose_strains, curvatures): (&PoseStrains, &PerFace<f64>),
    (wavelengths, poisson): (&PerFace<f64>, f64),
    limits: &EdgeLimits,
    points: f64,
) -> f64 {
    let refinement = Refinement {
        points_per_wavelength: points,
        ..Refinement::default()
    };
    let wrinkled = active
        .iter()
        .filter(|&&face| pose_strains.is_wrinkled(face));
    let corners = wrinkled.flat_map(|&face| mesh.faces()[face]);
    let longest = active.iter().map(|&face| wavelengths[face]);
    // Beyond its limit a distance is infinite; twice as far as edges grow, because three corners are averaged.
    let growth = SizeLimits::default().grading;
    let reach = 2.0 * COARSEST / growth * longest.fold(0.0, f64::max);
    let distances = edge_distances(mesh, positions, corners, reach);
    let per_area = |face: FaceId| {
        let wavelength = wavelengths[face];
        let longest = (COARSEST * wavelength).min(limits.max_edge);
        let finest = (wavelength / points).max(limits.min_edge);
        let bent = (refinement.angle / curvatures[face]).max(finest);
        let across = finest;
        let (across, along) = match pose_strains.is_wrinkled(face) {
            true => {
                let driver = FaceDriver {
                    compression: Matrix3::zeros(),
                    wavelength,
                    critical_strain: pose_strains.critical(face),
                    poisson,
                };
                let [first, second] = pose_strains.principal[face];
                // The two strains change places: this is the size that wrinkles across the second
                // direction ask for, which only exist where that is compressed beyond its critical
                // strain, too.
                let size = driver.wrinkle_size(second, first, &refinement);
                let along = (aspect(limits, points) * across).min(longest);
                let along = along.min(size.sqrt().recip()).max(across);
                (across, along.min(bent))
            }
            false => {
                let distance = mesh.faces()[face].map(|v| distances[v]);
                let distance = distance.iter().sum::<f64>() / 3.0;
                let graded = (finest + growth * distance).min(longest);
                let across = graded.min(bent);
                (across, graded.min(aspect(limits, points) * across))
            }
        };
        // Triangles are counted as equilateral ones, stretched in one direction.
        4.0 / (3f64.sqrt() * across.min(longest) * along.min(longest))
    };
    active
        .iter()
        .map(|&face| pose_strains.areas[face] * per_area(face))
        .sum()
}

/// Vertices along creases of a `length` (m) in a layer of a wavelength (m) with so many points to it.
pub(crate) fn creased_vertices(length: f64, wavelength: f64, points: f64) -> f64 {
    let across = wavelength / points;
    let band = 2.0 * CREASE_REACH * wavelength;
    // A vertex of a mesh of stretched equilateral triangles has the area of two of them.
    let even = length * band / (0.75f64.sqrt() * across * across * crease_aspect(points));
    CREASE_FILLING * even
}

/// Vertices between a border of `edges` of a mean length (m), which meshes keep as it is, and edges of
/// the length `coarsest` (m) inside: where edges grow by `g` per length, `2 / (sqrt(3) g)` for each of the
/// border's edges if those inside were endless, less what coarse triangles would have had there. Of these a
/// [share](BORDER_SHARE) is found, because most edges near a border are short anyway.
pub(crate) fn graded_vertices((edges, length): (f64, f64), coarsest: f64) -> f64 {
    let growth = SizeLimits::default().grading;
    let share = (1.0 - length / coarsest).max(0.0);
    BORDER_SHARE * edges * 2.0 / (3f64.sqrt() * growth) * share * share
}
