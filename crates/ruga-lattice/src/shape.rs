//! Shape functions of an element.

use nalgebra::Vector3;

/// The functions that interpolate within an element: products of one per axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Shape {
    /// Quadratic B-splines.
    ///
    /// 27 nodes, 27 quadrature points; first derivatives are continuous across elements. A node's
    /// value is not the value at its place.
    #[default]
    Quadratic,
    /// Trilinear, for comparison.
    ///
    /// The 8 corners, 8 quadrature points; bends at every border between elements.
    Linear,
}

impl Shape {
    /// Nodes along one axis of an element, and Gauss points too.
    pub fn nodes_per_axis(self) -> usize {
        match self {
            Self::Quadratic => 3,
            Self::Linear => 2,
        }
    }

    /// Nodes of an element: 27 or 8.
    pub fn nodes_per_element(self) -> usize {
        self.nodes_per_axis().pow(3)
    }

    /// Where node 0 of an axis lies, in cells from the element's lower end.
    ///
    /// With nodes there and at steps of one the functions reproduce every linear field: for
    /// B-splines these are the Greville abscissae.
    pub(crate) fn first_node(self) -> f64 {
        match self {
            Self::Quadratic => -0.5,
            Self::Linear => 0.0,
        }
    }

    /// Values and derivatives by the local coordinate `t` in 0..1 of one axis's functions.
    fn along(self, t: f64) -> [[f64; 3]; 2] {
        match self {
            Self::Quadratic => [
                [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t - t * t, 0.5 * t * t],
                [t - 1.0, 1.0 - 2.0 * t, t],
            ],
            // Filled up with a zero that nobody reads, so that both shapes have one type.
            Self::Linear => [[1.0 - t, t, 0.0], [-1.0, 1.0, 0.0]],
        }
    }

    /// Gauss points on 0..1 and their weights. Exact for the products of two functions.
    fn gauss(self) -> &'static [[f64; 2]] {
        match self {
            // sqrt(3/5)/2 and sqrt(1/3)/2 from the middle.
            Self::Quadratic => &[
                [0.112_701_665_379_258_3, 5.0 / 18.0],
                [0.5, 8.0 / 18.0],
                [0.887_298_334_620_741_7, 5.0 / 18.0],
            ],
            Self::Linear => &[
                [0.211_324_865_405_187_1, 0.5],
                [0.788_675_134_594_812_9, 0.5],
            ],
        }
    }

    /// Values (1) and gradients (1/m) of all functions at a place in an element.
    ///
    /// `local` runs from 0 to 1 per axis within the element; beyond that the polynomials go on.
    /// `size` is the element's (m). Node `(i, j, k)` along x, y, z is entry `(i n + j) n + k`.
    pub(crate) fn evaluate(self, local: &Vector3<f64>, size: &Vector3<f64>) -> ShapeValues {
        let n = self.nodes_per_axis();
        let axes = [local.x, local.y, local.z].map(|t| self.along(t));
        let mut values = Vec::with_capacity(n * n * n);
        let mut gradients = Vec::with_capacity(n * n * n);
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    let [[x, dx], [y, dy], [z, dz]] =
                        [(0, i), (1, j), (2, k)].map(|(a, m)| [axes[a][0][m], axes[a][1][m]]);
                    values.push(x * y * z);
                    let gradient = Vector3::new(dx * y * z, x * dy * z, x * y * dz);
                    gradients.push(gradient.component_div(size));
                }
            }
        }
        ShapeValues { values, gradients }
    }

    /// The Gauss points of the unit cube, with their share of its volume.
    pub(crate) fn gauss_points(self) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        let gauss = self.gauss();
        gauss.iter().flat_map(move |x| {
            gauss.iter().flat_map(move |y| {
                let point = |z: &[f64; 2]| (Vector3::new(x[0], y[0], z[0]), x[1] * y[1] * z[1]);
                gauss.iter().map(point)
            })
        })
    }
}

/// All shape functions of an element at one place.
#[derive(Clone, Debug)]
pub(crate) struct ShapeValues {
    pub(crate) values: Vec<f64>,
    pub(crate) gradients: Vec<Vector3<f64>>,
}
