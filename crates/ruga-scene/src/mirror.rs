//! Correspondence of the two sides of a mesh that is its own mirror image.

use std::collections::{BTreeMap, HashMap};

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver, Weights};
use ruga_mesh::barycentric;
use ruga_stepper::{ArtistPlace, ComputedMesh, LayerSpec, LayerSurface, Region};
use thiserror::Error;

/// How far a vertex may lie from the mirror image of its partner, in sizes of the mesh: half a millimetre on a
/// head, where scans are mirrored by hand. Each must be the other's nearest.
const TOLERANCE: f64 = 2e-3;

/// How far a blend shape may be from the mirror image of another, as a fraction of its displacements (root of
/// the mean square): sides of a real face move a little differently.
const ALIKE_SHAPES: f64 = 0.1;

/// Difference of grey, or relative one of a property, up to which paint is the same on both sides.
const ALIKE: f64 = 0.1;

/// Why a mesh does not mirror.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SymmetryFault {
    /// A vertex without partner on the other side.
    #[error(
        "vertex {vertex} at ({:.4}, {:.4}, {:.4}) m has no partner at its mirror image, within {:.2} mm",
        at[0], at[1], at[2], 1e3 * reach
    )]
    Vertex {
        /// The vertex, counted from 0 as in the file.
        vertex: usize,
        /// Its place, m.
        at: [f64; 3],
        /// Distance within which one was looked for, m.
        reach: f64,
    },
    /// Two vertices that claim the same partner.
    #[error(
        "vertices {vertices:?} have the same nearest vertex on the other side, near ({:.4}, {:.4}, {:.4}) m",
        at[0], at[1], at[2]
    )]
    Shared {
        /// The vertices, counted from 0 as in the file.
        vertices: [usize; 2],
        /// Place of the first of them, m.
        at: [f64; 3],
    },
    /// A triangle without partner.
    #[error("triangle {0} has no triangle at its mirror image, though its corners have partners")]
    Triangle(usize),
}

/// Correspondence of triangles and blend shapes across the plane `x = 0`.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Texture coordinates of the corners of every triangle of the file.
    uvs: Vec<[Vector2<f64>; 3]>,
    /// Counterpart of every triangle of the file.
    triangles: Vec<Opposite>,
    /// For every blend shape the one that does the same on the other side, if there is one.
    shapes: Vec<Option<usize>>,
}

/// Counterpart of a triangle: another one, or where a square is divided along the other diagonal, parts of two.
#[derive(Clone, Debug)]
struct Opposite {
    /// Texture coordinates opposite of its corners.
    uvs: [Vector2<f64>; 3],
    triangles: Vec<u32>,
}

impl Mirror {
    /// Finds the opposite of every triangle and blend shape.
    ///
    /// # Errors
    /// [`SymmetryFault`] when the mesh does not mirror.
    pub fn new(mesh: &ArtistMesh, driver: &Driver) -> Result<Self, SymmetryFault> {
        let reach = TOLERANCE * extent(driver.rest());
        let opposite = opposite_vertices(mesh, driver, reach)?;
        let uvs = mesh.uvs.as_ref().expect("a driver has texture coordinates");
        let corners = |triangle: &[u32; 3]| triangle.map(|v| uvs[v as usize]);
        let uvs: Vec<_> = mesh.triangles.iter().map(corners).collect();
        Ok(Self {
            triangles: opposite_triangles((mesh, &uvs), driver, &opposite)?,
            shapes: opposite_shapes(mesh, driver, &opposite),
            uvs,
        })
    }

    /// Weights that are simulated in the place of these, when they are the image of others: of a pose and
    /// its mirror image always the same one. `None` for the other, and for what mirrors itself.
    pub fn source_of(&self, weights: &Weights, driver: &Driver) -> Option<Weights> {
        let names: Vec<&str> = driver.shape_names().collect();
        let opposite = self.opposite_weights(weights)?;
        if sorted(opposite.iter().copied()) >= sorted(weights.iter()) {
            return None;
        }
        let named = opposite.into_iter().map(|(shape, w)| (names[shape], w));
        // In the order that they have in a scene, so that sums are the same to the last bit.
        let named: BTreeMap<&str, f64> = named.collect();
        driver.weights(named).ok()
    }

    /// Whether a pose with these weights is its own mirror image.
    pub fn is_own_image(&self, weights: &Weights) -> bool {
        let opposite = self.opposite_weights(weights);
        opposite.is_some_and(|own| sorted(own.into_iter()) == sorted(weights.iter()))
    }

    /// The weights that are not 0, of the opposite shapes; `None` where one has no such shape.
    fn opposite_weights(&self, weights: &Weights) -> Option<Vec<(usize, f64)>> {
        let weights = weights.iter().filter(|(_, w)| *w != 0.0);
        weights
            .map(|(shape, w)| Some((self.shapes[shape]?, w)))
            .collect()
    }

    /// Triangles of the file opposite of these, ascending.
    pub(crate) fn opposite(&self, triangles: &[u32]) -> Vec<u32> {
        let all = triangles
            .iter()
            .flat_map(|&t| &self.triangles[t as usize].triangles);
        let mut all: Vec<u32> = all.copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Warnings about paint that is not the same on both sides: that of the side that is simulated counts for
    /// both.
    pub(crate) fn warnings(&self, layers: &[LayerSpec], region: Option<&Region>) -> Vec<String> {
        let mut warnings = Vec::new();
        let mut tell = |what: &str, difference: f64| {
            if difference > ALIKE {
                warnings.push(format!(
                    "`driver.symmetry`: {what} differs between the sides by up to {:.0} %; a pose that is made \
                     as a mirror image has the paint of the other side: paint both sides alike, or leave \
                     `symmetry` out",
                    100.0 * difference
                ));
            }
        };
        if let Some(Region::Mask(mask)) = region {
            tell(
                "the mask of `driver.region`",
                self.difference(|uv| mask.grey(uv)),
            );
        }
        for layer in layers {
            let masks = self.difference(|uv| layer.presence.grey(uv));
            tell(&format!("the mask of layer '{}'", layer.name), masks);
            if let Some(map) = &layer.map {
                let thickness = self.difference(|uv| map.sample(&uv).thickness);
                let young = self.difference(|uv| map.sample(&uv).young);
                let wavelength = self.difference(|uv| map.sample(&uv).wavelength);
                let painted = thickness.max(young).max(wavelength);
                tell(&format!("the paint of layer '{}'", layer.name), painted);
            }
        }
        warnings
    }

    /// Largest difference of what is painted in the middle of a triangle and of its counterpart.
    fn difference(&self, painted: impl Fn(Vector2<f64>) -> f64) -> f64 {
        let middle = |corners: &[Vector2<f64>; 3]| corners.iter().sum::<Vector2<f64>>() / 3.0;
        let pairs = self.uvs.iter().zip(&self.triangles);
        let differences = pairs
            .map(|(own, opposite)| (painted(middle(own)) - painted(middle(&opposite.uvs))).abs());
        differences.fold(0.0, f64::max)
    }

    /// The mirror image of a layer, without the mesh that it was computed on.
    pub(crate) fn image(&self, layer: &LayerSurface) -> LayerSurface {
        let all = |points: &[Vector3<f64>]| points.iter().map(reflected).collect();
        LayerSurface {
            name: layer.name.clone(),
            positions: all(&layer.positions),
            relief: all(&layer.relief),
            driver_positions: all(&layer.driver_positions),
            driver_normals: all(&layer.driver_normals),
            offset: layer.offset,
            faces: layer.faces.iter().map(|&face| flipped(face)).collect(),
            uvs: layer
                .artist
                .iter()
                .map(|face| self.opposite_uvs(face))
                .collect(),
            artist: layer
                .artist
                .iter()
                .map(|face| self.opposite_place(face))
                .collect(),
            on_plane: layer.on_plane.clone(),
            face_states: layer.face_states.clone(),
            computed: ComputedMesh::default(),
            // Sheets are simulated whole.
            burnt: None,
        }
    }

    /// Texture coordinates opposite of a face's corners, the last two exchanged.
    pub(crate) fn opposite_uvs(&self, (triangle, corners): &ArtistPlace) -> [Vector2<f64>; 3] {
        let opposite = &self.triangles[*triangle as usize];
        flipped(corners.map(|parts| {
            let pairs = opposite.uvs.iter().zip(parts);
            pairs.map(|(uv, part)| uv * part).sum::<Vector2<f64>>()
        }))
    }

    /// The file's triangle opposite of a face, and where [`Self::opposite_uvs`] lie in it.
    pub(crate) fn opposite_place(&self, face: &ArtistPlace) -> ArtistPlace {
        let (opposite, uvs) = (&self.triangles[face.0 as usize], self.opposite_uvs(face));
        let places = opposite.triangles.iter().map(|&triangle| {
            let own = self.uvs[triangle as usize];
            // In a triangle without area no place is better than its middle.
            let parts = uvs.map(|uv| barycentric(own, uv).unwrap_or([1.0 / 3.0; 3]));
            (triangle, parts)
        });
        // How far inside the middle of the face is.
        let inside = |place: &ArtistPlace| {
            let middle = [0, 1, 2].map(|i| place.1.iter().map(|parts| parts[i]).sum::<f64>());
            middle.into_iter().fold(f64::INFINITY, f64::min)
        };
        let best = places.max_by(|a, b| inside(a).total_cmp(&inside(b)));
        best.expect("something lies opposite of every triangle")
    }
}

/// The corners of a face that a reflection has turned inside out.
pub(crate) fn flipped<T>([a, b, c]: [T; 3]) -> [T; 3] {
    [a, c, b]
}

/// Weights in an order of their own, zeros left out.
pub(crate) fn sorted(weights: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, u64)> {
    // A shape at weight 0 does nothing; the others are compared to the last bit.
    let weights = weights.filter(|(_, w)| *w != 0.0);
    let mut weights: Vec<_> = weights.map(|(shape, w)| (shape, w.to_bits())).collect();
    weights.sort_unstable();
    weights
}

pub(crate) fn reflected(point: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-point.x, point.y, point.z)
}

/// The longest side of the box around the points, m.
fn extent(points: &[Vector3<f64>]) -> f64 {
    let mut bounds = [
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    ];
    for point in points {
        bounds = [bounds[0].inf(point), bounds[1].sup(point)];
    }
    (bounds[1] - bounds[0]).max()
}

/// For every welded vertex the one at its mirror image.
fn opposite_vertices(
    mesh: &ArtistMesh,
    driver: &Driver,
    reach: f64,
) -> Result<Vec<usize>, SymmetryFault> {
    let cell = |p: &Vector3<f64>| [p.x, p.y, p.z].map(|c| (c / reach).round() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (vertex, point) in driver.rest().iter().enumerate() {
        cells.entry(cell(point)).or_default().push(vertex);
    }
    let nearest = |point: &Vector3<f64>| {
        let [x, y, z] = cell(point);
        let mut best: Option<(f64, usize)> = None;
        for offset in 0..27 {
            let [dx, dy, dz] = [offset / 9, offset / 3 % 3, offset % 3].map(|o| o - 1);
            for &vertex in cells.get(&[x + dx, y + dy, z + dz]).into_iter().flatten() {
                let distance = (driver.rest()[vertex] - point).norm();
                if distance <= reach && best.is_none_or(|(least, _)| distance < least) {
                    best = Some((distance, vertex));
                }
            }
        }
        best.map(|(_, vertex)| vertex)
    };
    let in_file = |vertex: usize| {
        let mut welded = driver.welded().iter();
        welded
            .position(|w| w.0 as usize == vertex)
            .unwrap_or(vertex)
    };
    let missing = |vertex: usize| SymmetryFault::Vertex {
        vertex: in_file(vertex),
        at: mesh.positions[in_file(vertex)].into(),
        reach,
    };
    let found = driver
        .rest()
        .iter()
        .enumerate()
        .map(|(vertex, point)| nearest(&reflected(point)).ok_or_else(|| missing(vertex)));
    let found = found.collect::<Result<Vec<usize>, SymmetryFault>>()?;
    match (0..found.len()).find(|&vertex| found[found[vertex]] != vertex) {
        Some(vertex) => {
            let vertices = [vertex, found[found[vertex]]].map(in_file);
            Err(SymmetryFault::Shared {
                vertices,
                at: mesh.positions[vertices[0]].into(),
            })
        }
        None => Ok(found),
    }
}

fn opposite_triangles(
    (mesh, uvs): (&ArtistMesh, &[[Vector2<f64>; 3]]),
    driver: &Driver,
    opposite: &[usize],
) -> Result<Vec<Opposite>, SymmetryFault> {
    let welded =
        |triangle: usize| mesh.triangles[triangle].map(|v| driver.welded()[v as usize].0 as usize);
    let mut around = vec![Vec::new(); driver.rest().len()];
    for triangle in 0..mesh.triangles.len() {
        for vertex in welded(triangle) {
            around[vertex].push(triangle as u32);
        }
    }
    let found = (0..mesh.triangles.len()).map(|triangle| {
        let wanted = welded(triangle).map(|v| opposite[v]);
        let shared = |other: &u32| {
            let corners = welded(*other as usize);
            wanted.iter().filter(|v| corners.contains(v)).count()
        };
        let near = || wanted.iter().flat_map(|&v| &around[v]).copied();
        let mut triangles: Vec<u32> = near().filter(|other| shared(other) == 3).take(1).collect();
        if triangles.is_empty() {
            triangles = across_other_diagonal(wanted, near(), &welded);
        }
        let uv_at = |vertex: usize| {
            let mut corners = triangles
                .iter()
                .flat_map(|&other| welded(other as usize).into_iter().zip(uvs[other as usize]));
            corners.find_map(|(own, uv)| (own == vertex).then_some(uv))
        };
        let uvs: Option<Vec<_>> = wanted.iter().map(|&vertex| uv_at(vertex)).collect();
        match uvs.as_deref() {
            Some(&[a, b, c]) => Ok(Opposite {
                uvs: [a, b, c],
                triangles,
            }),
            _ => Err(SymmetryFault::Triangle(triangle)),
        }
    });
    found.collect()
}

/// Two triangles `near` three vertices that have these as corners, one more vertex, and an edge between them.
fn across_other_diagonal(
    wanted: [usize; 3],
    near: impl Iterator<Item = u32> + Clone,
    welded: &impl Fn(usize) -> [usize; 3],
) -> Vec<u32> {
    // Each has two of the three vertices.
    let halves = near.filter(|&other| {
        let corners = welded(other as usize);
        wanted.iter().filter(|v| corners.contains(v)).count() == 2
    });
    let stranger = |other: u32| {
        let corners = welded(other as usize);
        corners.into_iter().find(|v| !wanted.contains(v))
    };
    for first in halves.clone() {
        for second in halves.clone().filter(|&second| second > first) {
            let (a, b) = (welded(first as usize), welded(second as usize));
            let both = |v: &usize| a.contains(v) && b.contains(v);
            // They share the stranger and one of the three: the other diagonal.
            if stranger(first) == stranger(second) && wanted.iter().filter(|v| both(v)).count() == 1
            {
                return vec![first, second];
            }
        }
    }
    Vec::new()
}

/// For every shape the one that moves the opposite vertices most nearly as a mirror would, if any does.
fn opposite_shapes(mesh: &ArtistMesh, driver: &Driver, opposite: &[usize]) -> Vec<Option<usize>> {
    let of_welded = |shape: &BlendShape| {
        let mut own = vec![Vector3::zeros(); driver.rest().len()];
        for (vertex, delta) in driver.welded().iter().zip(&shape.position_deltas) {
            own[vertex.0 as usize] = *delta;
        }
        own
    };
    let displacements: Vec<Vec<Vector3<f64>>> = mesh.shapes.iter().map(of_welded).collect();
    let square = |own: &[Vector3<f64>]| own.iter().map(Vector3::norm_squared).sum::<f64>();
    let squares: Vec<f64> = displacements.iter().map(|own| square(own)).collect();
    let least = |a: usize, b: usize| {
        // Mirror images are as large as each other; most pairs are told apart by that.
        let [a, b] = [squares[a], squares[b]].map(f64::sqrt);
        ((a - b).abs() / a.max(b).max(f64::MIN_POSITIVE)).powi(2)
    };
    let difference = |a: usize, b: usize| {
        let pairs = displacements[a].iter().zip(opposite);
        let squared = |(delta, &other): (&Vector3<f64>, &usize)| {
            (reflected(delta) - displacements[b][other]).norm_squared()
        };
        pairs.map(squared).sum::<f64>() / squares[a].max(squares[b]).max(f64::MIN_POSITIVE)
    };
    let nearest = |shape: usize| {
        let near =
            (0..squares.len()).filter(|&other| least(shape, other) < ALIKE_SHAPES * ALIKE_SHAPES);
        let all = near.map(|other| (difference(shape, other), other));
        let best = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        best.filter(|(far, _)| *far < ALIKE_SHAPES * ALIKE_SHAPES)
            .map(|(_, other)| other)
    };
    let nearest: Vec<Option<usize>> = (0..squares.len()).map(nearest).collect();
    let is_mutual =
        |(own, other): (usize, &Option<usize>)| other.filter(|&other| nearest[other] == Some(own));
    nearest.iter().enumerate().map(is_mutual).collect()
}
