//! The embedding of a surface: from node vectors to positions and normals, and forces back.

use nalgebra::Vector3;
use ruga_mesh::{
    MaterialPoint, PerVertex, SparseRows, face_normals, tangent_frame, vertex_normals,
};

use crate::error::check_length;
use crate::{Lattice, LatticeError, LatticePoint};

/// The linear map `B` from node vectors to points of a surface (RK 3), and its gradient along two
/// tangents of the surface.
///
/// ```text
/// x = B q     t_k = (t_k . grad) B q     n = t_1 x t_2     f_q = B^T f_x
/// ```
/// Row `i` weighs the 27 or 8 nodes of the element that point `i` lies in. Weights sum to one and
/// reproduce every affine motion; with quadratic elements positions have continuous derivatives
/// across elements, so normals are continuous wherever the rest normals are.
#[derive(Clone, Debug)]
pub struct Embedding {
    positions: SparseRows,
    tangents: [SparseRows; 2],
    node_count: usize,
}

/// Shortest normal that has a direction; far below that of any face in metres.
const LEAST_NORMAL: f64 = 1e-100;

impl Embedding {
    /// Every vertex of the lattice's own surface, with area-weighted normals at rest.
    ///
    /// # Errors
    /// [`LatticeError::IsolatedVertex`], [`LatticeError::NoNormal`].
    pub fn of_vertices(lattice: &Lattice) -> Result<Self, LatticeError> {
        let (mesh, positions) = (lattice.surface().mesh(), lattice.surface().positions());
        let points: Vec<MaterialPoint> = PerVertex::filled(mesh.vertex_count(), ())
            .ids()
            .map(|vertex| {
                let isolated = LatticeError::IsolatedVertex { vertex };
                MaterialPoint::of_vertex(mesh, vertex).ok_or(isolated)
            })
            .collect::<Result<_, _>>()?;
        Self::of_surface(
            lattice,
            &points,
            positions,
            &vertex_normals(mesh, positions),
        )
    }

    /// Material points of the lattice's surface, on its facets and with their normals.
    ///
    /// # Errors
    /// [`LatticeError::FaceOutOfRange`], [`LatticeError::NotFinite`], [`LatticeError::NoNormal`].
    pub fn of_points(lattice: &Lattice, points: &[MaterialPoint]) -> Result<Self, LatticeError> {
        let (mesh, rest) = (lattice.surface().mesh(), lattice.surface().positions());
        let facets = face_normals(mesh, rest);
        let mut located = Vec::with_capacity(points.len());
        let mut normals = Vec::with_capacity(points.len());
        for (index, point) in points.iter().enumerate() {
            located.push(lattice.locate_numbered(index, point)?);
            normals.push(facets[point.face]);
        }
        Self::of_lattice_points(lattice, &located, &normals)
    }

    /// Points of another surface close to the lattice's, such as its smooth limit or a layer above
    /// it: for each its address on the lattice's surface, its rest position (m) and normal there.
    ///
    /// The address decides which piece of the body carries the point; where the position lies
    /// outside that piece's cells, the closest one is extrapolated.
    ///
    /// # Errors
    /// [`LatticeError::Length`] and those of [`Self::of_points`].
    pub fn of_surface(
        lattice: &Lattice,
        points: &[MaterialPoint],
        positions: &[Vector3<f64>],
        normals: &[Vector3<f64>],
    ) -> Result<Self, LatticeError> {
        check_length("rest positions", points.len(), positions.len())?;
        let located: Vec<LatticePoint> = (points.iter().zip(positions).enumerate())
            .map(|(index, (point, position))| lattice.locate_moved(index, point, position))
            .collect::<Result<_, _>>()?;
        Self::of_lattice_points(lattice, &located, normals)
    }

    /// Any points of the lattice, with a rest normal each (any length).
    ///
    /// # Errors
    /// [`LatticeError::Length`], [`LatticeError::ElementOutOfRange`], [`LatticeError::NotFinite`],
    /// [`LatticeError::NoNormal`].
    pub fn of_lattice_points(
        lattice: &Lattice,
        points: &[LatticePoint],
        normals: &[Vector3<f64>],
    ) -> Result<Self, LatticeError> {
        check_length("rest normals", points.len(), normals.len())?;
        let mut this = Self {
            positions: SparseRows::default(),
            tangents: [SparseRows::default(), SparseRows::default()],
            node_count: lattice.node_count(),
        };
        for (index, (point, normal)) in points.iter().zip(normals).enumerate() {
            lattice.check_point(index, point)?;
            let length = normal.norm();
            if !(length > LEAST_NORMAL && length.is_finite()) {
                return Err(LatticeError::NoNormal {
                    point: index,
                    length,
                });
            }
            this.push(lattice, point, &(normal / length));
        }
        Ok(this)
    }

    fn push(&mut self, lattice: &Lattice, point: &LatticePoint, normal: &Vector3<f64>) {
        let shape = lattice.shape().evaluate(&point.local, &lattice.cell_size());
        let nodes = || {
            lattice
                .element_nodes(point.element)
                .iter()
                .map(|node| node.0)
        };
        let mut values: Vec<(u32, f64)> = nodes().zip(shape.values).collect();
        self.positions.push_row(&mut values);
        // Any right-handed pair does: another one has the same cross product.
        let frame = tangent_frame(*normal, Vector3::x());
        for (rows, tangent) in self.tangents.iter_mut().zip(frame) {
            let slopes = shape.gradients.iter().map(|g| g.dot(&tangent));
            rows.push_row(&mut nodes().zip(slopes).collect::<Vec<_>>());
        }
    }

    /// Number of embedded points.
    pub fn point_count(&self) -> usize {
        self.positions.row_count()
    }

    /// `B`: one row per point, one column per node; the same weights for x, y and z.
    pub fn rows(&self) -> &SparseRows {
        &self.positions
    }

    /// The derivatives of `B` along two orthonormal tangents of the rest surface (1/m), right-handed
    /// with the rest normal.
    pub fn tangent_rows(&self) -> &[SparseRows; 2] {
        &self.tangents
    }

    /// Positions of the points (m) with the nodes at `q` (m): `B q`.
    ///
    /// # Panics
    /// When there is not one vector per node.
    pub fn positions(&self, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.check(q);
        self.positions.apply(q)
    }

    /// Unit normals of the points with the nodes at `q` (m); zero where the surface has collapsed.
    ///
    /// # Panics
    /// When there is not one vector per node.
    pub fn normals(&self, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.check(q);
        let [first, second] = [0, 1].map(|k| self.tangents[k].apply(q));
        // Two tangents are carried along, and not the normal itself, because after a shear F n is
        // no longer normal to the surface.
        let normals = first.iter().zip(&second).map(|(a, b)| a.cross(b));
        normals
            .map(|n| n.try_normalize(0.0).unwrap_or_else(Vector3::zeros))
            .collect()
    }

    /// Forces on the nodes that do the same work as `forces` on the points (N): `B^T f`.
    ///
    /// # Panics
    /// When there is not one force per point.
    pub fn pull_back(&self, forces: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        assert_eq!(forces.len(), self.point_count(), "one force per point");
        let mut on_nodes = vec![Vector3::zeros(); self.node_count];
        for (row, force) in forces.iter().enumerate() {
            for (node, weight) in self.positions.row(row) {
                on_nodes[node as usize] += force * weight;
            }
        }
        on_nodes
    }

    pub(crate) fn node_count(&self) -> usize {
        self.node_count
    }

    fn check(&self, q: &[Vector3<f64>]) {
        assert_eq!(q.len(), self.node_count, "one vector per node");
    }
}
