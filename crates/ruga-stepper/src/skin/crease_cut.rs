//! Edges along crease lines: in the mesh of a region, and in those that are fitted from it.

use ruga_blend::Driver;
use ruga_crease::{CreaseEdge, CreaseWarning, LineCut, MeshPiece, TracedLine};
use ruga_mesh::{FaceOrigin, Id, MaterialPoint, PerEdge, PerFace, PerVertex, TriMesh, VertexId};

use crate::CreaseSpec;
use crate::skin::boundary_cut::Cut;
use crate::skin::piece::Piece;

/// A piece with edges along crease lines.
pub(crate) struct Creased {
    pub(crate) piece: Piece,
    /// Edges across which the paint jumps.
    pub(crate) boundaries: PerEdge<bool>,
    /// Edges on lines.
    pub(crate) creases: Vec<CreaseEdge>,
    /// The lines over the piece's own mesh.
    pub(crate) lines: Vec<TracedLine>,
    /// Stretches that fold as another line says.
    pub(crate) shared: Vec<CreaseWarning>,
}

/// Gives a piece of the driver edges along the lines of `creases`; without any it stays as it is.
pub(crate) fn cut_along_creases(driver: &Driver, creases: &[CreaseSpec], cut: Cut) -> Creased {
    let Cut { piece, features } = cut;
    if creases
        .iter()
        .all(|crease| crease.line.segments().is_empty())
    {
        return Creased {
            piece,
            boundaries: features,
            creases: Vec::new(),
            lines: Vec::new(),
            shared: Vec::new(),
        };
    }
    let lines: Vec<TracedLine> = creases.iter().map(|crease| crease.line.clone()).collect();
    let is_on_boundary = ends_of(&piece.mesh, &features);
    let cut = LineCut::keeping(
        &lines,
        MeshPiece {
            positions: piece.flat_positions(driver),
            mesh: piece.mesh.clone(),
            origins: piece.origins.clone(),
        },
        &|v| is_on_boundary[v],
    );
    let lines = cut.lines(&lines);
    Creased {
        boundaries: carried_over(&piece.mesh, &features, (&cut.piece.mesh, &cut.parts)),
        creases: cut.edges,
        lines,
        // That a line has no edges where the region ends needs no word.
        shared: cut
            .warnings
            .into_iter()
            .filter(|warning| matches!(warning, CreaseWarning::Shared { .. }))
            .collect(),
        piece: Piece {
            points: points(&cut.piece.mesh, &cut.piece.origins),
            mesh: cut.piece.mesh,
            origins: cut.piece.origins,
        },
    }
}

/// Which vertices marked edges end at.
fn ends_of(mesh: &TriMesh, marked: &PerEdge<bool>) -> PerVertex<bool> {
    let mut ends = PerVertex::filled(mesh.vertex_count(), false);
    for (edge, _) in marked.iter().filter(|(_, is_marked)| **is_marked) {
        mesh.edges()[edge]
            .vertices
            .iter()
            .for_each(|&v| ends[v] = true);
    }
    ends
}

/// The place on the driver of every vertex.
fn points(mesh: &TriMesh, origins: &PerFace<FaceOrigin>) -> Vec<MaterialPoint> {
    let vertices = (0..mesh.vertex_count()).map(VertexId::from_index);
    let place = |vertex| {
        let corner = MaterialPoint::of_vertex(mesh, vertex).expect("every vertex has a face");
        origins[corner.face].place(corner.barycentric)
    };
    vertices.map(place).collect()
}

/// Which edges of a cut mesh lie on marked ones of the mesh before.
fn carried_over(
    before: &TriMesh,
    marked: &PerEdge<bool>,
    (mesh, parts): (&TriMesh, &PerFace<FaceOrigin>),
) -> PerEdge<bool> {
    let mut carried = PerEdge::filled(mesh.edges().len(), false);
    for (face, part) in parts.iter() {
        let edges = before.face_edges(part.face);
        for (corner, edge) in mesh.face_edges(face).into_iter().enumerate() {
            let [from, to] = [corner, (corner + 1) % 3].map(|corner| part.corners[corner]);
            // Edge `i` of a face is where the coordinate of the corner before it is none.
            let on = (0..3).find(|&i| from[(i + 2) % 3] == 0.0 && to[(i + 2) % 3] == 0.0);
            carried[edge] |= on.is_some_and(|i| marked[edges[i]]);
        }
    }
    carried
}
