//! Linear constraints on a sheet: averages over clusters, and sides that slide.

use nalgebra::Vector3;
use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
use ruga_material::Wrinkling;
use ruga_mesh::{Id, MaterialPoint, PerVertex, TriMesh, VertexId, vertex_normals};
use ruga_solver::ConstraintRows;

use super::{FilmCoupling, Strip};

/// Entries of one row: unknown and weight.
pub(crate) type Row = Vec<(usize, f64)>;

/// One row per coordinate of each cluster.
pub(super) fn averages(
    strip: &Strip,
    (rest, pinned, free): (&[Vector3<f64>], &[bool], &[u32]),
    theory: &Wrinkling,
    coupling: FilmCoupling,
) -> Vec<Row> {
    let (spacing, kernel) = match coupling {
        FilmCoupling::Elastic => return Vec::new(),
        FilmCoupling::Hybrid => {
            let spacing = 1.5 * theory.wavelength;
            (spacing, Kernel::beside_foundation(spacing))
        }
        FilmCoupling::Constraint(spacing) => (
            spacing * theory.wavelength,
            Kernel::alone(theory.wavelength),
        ),
    };
    let mesh = TriMesh::new(rest.len(), strip.faces.clone()).expect("a valid mesh");
    let candidates: Vec<VertexId> = free.iter().map(|&v| VertexId(v)).collect();
    let spacings = PerVertex::filled(mesh.vertex_count(), spacing);
    let settings = ClusterSettings::default();
    let centres =
        cluster_centres(&mesh, rest, &spacings, &candidates, &settings).expect("valid centres");
    let place = |&centre: &VertexId| MaterialPoint::of_vertex(&mesh, centre);
    let centres: Vec<_> = centres.iter().filter_map(place).collect();
    let normals = vertex_normals(&mesh, rest);
    let kernels = vec![kernel; centres.len()];
    let sampling = Sampling::Quadrature;
    let set =
        constraint_rows(&mesh, rest, &normals, &centres, &kernels, sampling).expect("valid rows");
    let weights = set.rows.iter().map(|row| {
        row.weights
            .iter()
            .filter(|(v, _)| !pinned[v.index()])
            .filter_map(|&(v, w)| Some((free.binary_search(&v.0).ok()?, w)))
            .collect::<Row>()
    });
    weights
        .flat_map(|row| [0, 1, 2].map(|axis| row.iter().map(|(u, w)| (3 * u + axis, *w)).collect()))
        .collect()
}

/// Fixes y along both sides.
pub(super) fn side_rollers(strip: &Strip, free: &[u32]) -> Vec<Row> {
    let tolerance = 1e-9 * strip.length;
    free.iter()
        .enumerate()
        .filter(|(_, v)| {
            let y = strip.points[**v as usize].y;
            y < tolerance || y > strip.width - tolerance
        })
        .map(|(unknown, _)| vec![(3 * unknown + 1, 1.0)])
        .collect()
}

pub(crate) fn to_constraint_rows(rows: &[Row], unknowns: usize) -> ConstraintRows {
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for row in rows {
        columns.extend(row.iter().map(|entry| entry.0));
        values.extend(row.iter().map(|entry| entry.1));
        starts.push(columns.len());
    }
    ConstraintRows::new(starts, columns, values, unknowns).expect("valid rows")
}
