//! A stiff skin on a soft block as a volume, in plane strain, over half a wave.
//!
//! Nothing of a shell or a foundation is in it: skin and block are the same kind of elements, nine
//! nodes each, so fine that they wrinkle by themselves (Rémillard and Kry 2013, figure 6). Crest and
//! trough are planes of symmetry; what lies below moves with the compression.

use nalgebra::{DMatrix, Matrix4, SMatrix, Vector2, Vector4};
use ruga_material::{LayerMaterial, Substrate};

use super::analytic::Onset;
use super::lowest;

/// Skin on a block, and how finely the two are cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenseBlock {
    /// The skin.
    pub skin: LayerMaterial,
    /// The block below it.
    pub block: Substrate,
    /// Elements along half a wave; 4 to 8.
    pub along: usize,
    /// Elements through the skin; 1 or 2.
    pub through: usize,
    /// Elements down the block, each longer than the one above; 8 to 16.
    pub down: usize,
}

/// Growth of the elements' height from the skin downwards.
const GROWTH: f64 = 1.35;

/// Strain up to which the flat block is asked for its stability.
const LARGEST_STRAIN: f64 = 0.3;

/// Nodes of an element along one side, and their places.
const NODES: [f64; 3] = [-1.0, 0.0, 1.0];

/// Gauss points of an element along one side, with their weights.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

impl DenseBlock {
    /// `skin` on `block`, fine enough for a wavelength within 1 %.
    pub fn new(skin: LayerMaterial, block: Substrate) -> Self {
        Self {
            skin,
            block,
            along: 5,
            through: 1,
            down: 10,
        }
    }

    /// Where the flat block becomes unstable first, among wavelengths between two (m).
    pub fn onset(&self, [low, high]: [f64; 2]) -> Onset {
        // On a flat minimum of the strain the wavelength is known to the root of its tolerance.
        let wavelength = lowest(low, high, 1e-3, |wavelength| self.onset_at(wavelength));
        Onset {
            strain: self.onset_at(wavelength),
            wavelength,
        }
    }

    /// Strain at which the flat block becomes unstable against one wavelength (m).
    pub fn onset_at(&self, wavelength: f64) -> f64 {
        let grid = HalfWave::new(self, wavelength);
        let (mut low, mut high) = (0.0, LARGEST_STRAIN);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            match grid.stiffness(middle).cholesky() {
                Some(_) => low = middle,
                None => high = middle,
            }
        }
        0.5 * (low + high)
    }
}

/// Rotated linear elasticity in plane strain.
///
/// ```text
/// W = mu sum (s_k - 1)^2 + lambda/2 (sum s_k - 2)^2,     s_1 + s_2 = |(F11 + F22, F21 - F12)|
/// ```
#[derive(Clone, Copy)]
struct Solid {
    shear: f64,
    lame: f64,
}

impl Solid {
    fn new(young: f64, poisson: f64) -> Self {
        Self {
            shear: young / (2.0 * (1.0 + poisson)),
            lame: young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        }
    }

    /// Stretch across that leaves no stress across, beside the stretch `along`.
    fn relaxed_stretch(&self, along: f64) -> f64 {
        1.0 + self.lame * (1.0 - along) / (2.0 * self.shear + self.lame)
    }

    /// Second derivative by `F11, F21, F12, F22` at `F = diag(along, across)`, Pa.
    fn tangent(&self, along: f64, across: f64) -> Matrix4<f64> {
        let sum = along + across;
        // `s_1 + s_2` grows with `F11 + F22` and bends with `F21 - F12`.
        let grows = Vector4::new(1.0, 0.0, 0.0, 1.0);
        let turns = Vector4::new(0.0, 1.0, -1.0, 0.0);
        let pull = self.lame * (sum - 2.0) - 2.0 * self.shear;
        Matrix4::identity() * (2.0 * self.shear)
            + grows * grows.transpose() * self.lame
            + turns * turns.transpose() * (pull / sum)
    }
}

/// The elements of half a wave.
struct HalfWave<'a> {
    spec: &'a DenseBlock,
    width: f64,
    /// Heights of the rows of elements, m, from the bottom, and what they are made of.
    rows: Vec<(f64, Solid)>,
    /// Number of every coordinate among those that move, node by node, row by row.
    unknowns: Vec<[Option<usize>; 2]>,
    count: usize,
}

impl<'a> HalfWave<'a> {
    fn new(spec: &'a DenseBlock, wavelength: f64) -> Self {
        let (skin, block) = (&spec.skin, &spec.block);
        let steps = (0..spec.down as i32).map(|i| GROWTH.powi(i));
        let first = block.thickness / steps.clone().sum::<f64>();
        let soft = Solid::new(block.young, block.poisson);
        let stiff = Solid::new(skin.young, skin.poisson);
        let mut rows: Vec<(f64, Solid)> = steps.map(|step| (first * step, soft)).collect();
        rows.reverse();
        let through = (0..spec.through).map(|_| (skin.thickness / spec.through as f64, stiff));
        rows.extend(through);
        let columns = 2 * spec.along + 1;
        let mut count = 0;
        let mut number = |moves: bool| {
            moves.then(|| {
                count += 1;
                count - 1
            })
        };
        let unknowns = (0..columns * (2 * rows.len() + 1))
            .map(|node| {
                let (column, row) = (node % columns, node / columns);
                let is_side = column == 0 || column + 1 == columns;
                [number(row > 0 && !is_side), number(row > 0)]
            })
            .collect();
        Self {
            spec,
            width: 0.5 * wavelength / spec.along as f64,
            rows,
            unknowns,
            count,
        }
    }

    /// Second derivative of the energy at the flat state of a strain, N/m^2.
    fn stiffness(&self, strain: f64) -> DMatrix<f64> {
        let mut stiffness = DMatrix::zeros(self.count, self.count);
        for (row, (height, solid)) in self.rows.iter().enumerate() {
            let along = 1.0 - strain;
            let tangent = solid.tangent(along, solid.relaxed_stretch(along));
            let element = element_stiffness(self.width, *height, &tangent);
            for column in 0..self.spec.along {
                self.add(&mut stiffness, row, column, &element);
            }
        }
        stiffness
    }

    fn add(
        &self,
        stiffness: &mut DMatrix<f64>,
        row: usize,
        column: usize,
        element: &SMatrix<f64, 18, 18>,
    ) {
        let columns = 2 * self.spec.along + 1;
        let unknown = |i: usize| {
            let (node, axis) = (i / 2, i % 2);
            let (x, y) = (2 * column + node % 3, 2 * row + node / 3);
            self.unknowns[y * columns + x][axis]
        };
        for i in 0..18 {
            for j in 0..18 {
                if let (Some(a), Some(b)) = (unknown(i), unknown(j)) {
                    stiffness[(a, b)] += element[(i, j)];
                }
            }
        }
    }
}

/// Of nine nodes, x and y of each in turn, per length out of the plane.
fn element_stiffness(width: f64, height: f64, tangent: &Matrix4<f64>) -> SMatrix<f64, 18, 18> {
    let mut stiffness = SMatrix::zeros();
    for (x, weight_x) in GAUSS {
        for (y, weight_y) in GAUSS {
            let mut strains = SMatrix::<f64, 4, 18>::zeros();
            for node in 0..9 {
                let gradient = Vector2::new(
                    slope(node % 3, x) * value(node / 3, y) * 2.0 / width,
                    value(node % 3, x) * slope(node / 3, y) * 2.0 / height,
                );
                for axis in 0..2 {
                    strains[(axis, 2 * node + axis)] = gradient.x;
                    strains[(2 + axis, 2 * node + axis)] = gradient.y;
                }
            }
            let area = 0.25 * width * height * weight_x * weight_y;
            stiffness += strains.transpose() * tangent * strains * area;
        }
    }
    stiffness
}

/// The quadratic that is one at a node and zero at the two others.
fn value(node: usize, at: f64) -> f64 {
    let others = (0..3).filter(|&other| other != node);
    others
        .map(|other| (at - NODES[other]) / (NODES[node] - NODES[other]))
        .product()
}

fn slope(node: usize, at: f64) -> f64 {
    let [a, b] = match node {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    };
    let scale = (NODES[node] - NODES[a]) * (NODES[node] - NODES[b]);
    (2.0 * at - NODES[a] - NODES[b]) / scale
}
