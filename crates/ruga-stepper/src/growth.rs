//! Growth of a layer: rest lengths that a pose changes.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use ruga_blend::{Driver, FaceStrain};
use ruga_material::{LaminatedSheet, NaturalShape};
use ruga_mesh::{FaceId, Id, PerFace, VertexId, triangle_frame};

use crate::run::strain_ratio::relative_to;
use crate::skin::local_skin::{relative_at_vertices, relative_on_faces};
use crate::skin::material_places::uv;
use crate::skin::skin_mesh::SkinMesh;
use crate::{LayerSpec, Mask, PaintedNumber, PoseSpec};

/// Changes of rest lengths that a layer, or each ply of one, can have in a pose, all of its growths together: an
/// isotropic shrinkage to two fifths of the length leaves a sixth of the area, and beyond twice the length film
/// theory, which caps compressions from 15 % on, says nothing more.
pub const GROWTH_RANGE: [f64; 2] = [-0.6, 1.0];

/// A painted direction whose parts are shorter than this has none: middle grey of 8 bits, 128 of 255, is off by
/// 0.004 in each, and filtering and compression of images add a step or two.
const FAINTEST_DIRECTION: f64 = 0.02;

/// A change of the rest lengths of a layer, or of what lies below it, that poses switch on.
///
/// At a strength `s` lengths along the direction are `1 + s p along` times what they were, and across it
/// `1 + s p across`, with the painted `p`. A surface that carries a layer keeps its shape: only the difference
/// between the layer and what is below counts, as if a blend shape had compressed the skin by it.
#[derive(Clone, Debug)]
pub struct GrowthSpec {
    /// Name by which poses switch it on ([`PoseSpec::growths`]).
    pub name: String,
    /// What grows.
    pub grows: Grows,
    /// Change of length along the direction, a share of it; negative for shrinkage.
    pub along: f64,
    /// Change of length across the direction.
    pub across: f64,
    /// Curvatures along the direction and across it to which it bends a free sheet at a strength of 1, positive
    /// where the outer side bulges, 1/m; none for a layer that something carries, which holds it flat. They add to
    /// what plies that grow unequally make.
    pub curl: [f64; 2],
    /// Direction of `along`.
    pub direction: GrowthDirection,
    /// Painted share of it, everywhere 1 without paint.
    pub paint: Option<PaintedNumber>,
}

/// What a [`GrowthSpec`] changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Grows {
    /// The layer itself, all of its plies alike.
    #[default]
    Layer,
    /// One ply of a layer that is a laminate ([`LayerSpec::laminate`]), by its number from the lowest one up, from 0.
    Ply(usize),
    /// What lies below all layers; where it shrinks, layers are compressed.
    Below,
}

/// Direction of a growth in the texture.
#[derive(Clone, Debug)]
pub enum GrowthDirection {
    /// Angle from the texture's right, counter-clockwise as one looks at the image, rad.
    Angle(f64),
    /// Painted parts to the right and up, from -1 (black) to 1 (white), as in glTF's anisotropy textures;
    /// their length does not count. Middle grey has no direction: it grows by the mean of both changes.
    Painted {
        /// Part to the right.
        right: Mask,
        /// Part up.
        up: Mask,
    },
}

impl GrowthSpec {
    /// Range of the changes of length that a strength of it may bring anywhere, of the layer against what is below;
    /// no numbers where one of its own is none.
    pub fn changes(&self, strength: f64) -> [f64; 2] {
        let shares = self.paint.as_ref().map_or([1.0, 1.0], |paint| paint.range);
        let changes = shares.map(|share| [self.along, self.across].map(|c| strength * share * c));
        let changes = changes.as_flattened();
        if changes.iter().any(|change| change.is_nan()) {
            return [f64::NAN; 2];
        }
        let against = changes.iter().map(|c| self.grows.against_below(*c));
        let low = against.clone().fold(f64::INFINITY, f64::min);
        [low, against.fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Share of it that is painted at a texture coordinate.
    fn share(&self, uv: Vector2<f64>) -> f64 {
        self.paint.as_ref().map_or(1.0, |paint| paint.at(uv))
    }

    /// A tensor with these values along the direction and across it, as it is painted at a texture coordinate of a
    /// driver's face, in a plane with these axes.
    fn tensor(
        &self,
        [along, across]: [f64; 2],
        (place, facet): (&Place, &Facet),
        [x, y]: &[Vector3<f64>; 2],
    ) -> Matrix2<f64> {
        let direction = facet.in_space(&self.direction.at(place.direction_at));
        let direction = Vector2::new(direction.dot(x), direction.dot(y));
        let tensor = match direction.try_normalize(0.0) {
            Some(direction) => {
                let parallel = direction * direction.transpose();
                parallel * along + (Matrix2::identity() - parallel) * across
            }
            None => Matrix2::identity() * (0.5 * (along + across)),
        };
        tensor * self.share(place.uv)
    }
}

impl GrowthDirection {
    /// Direction in the texture, of any length; zero where the paint has none.
    fn at(&self, uv: Vector2<f64>) -> Vector2<f64> {
        // V points down in the texture.
        match self {
            Self::Angle(angle) => Vector2::new(angle.cos(), -angle.sin()),
            Self::Painted { right, up } => {
                let part = |mask: &Mask| 2.0 * mask.grey(uv) - 1.0;
                let direction = Vector2::new(part(right), -part(up));
                match direction.norm() < FAINTEST_DIRECTION {
                    true => Vector2::zeros(),
                    false => direction,
                }
            }
        }
    }

    /// Unit directions on the faces of `skin`, in their rest frames; `None` where the paint has none, or the texture
    /// no area.
    pub(crate) fn on_skin(
        &self,
        driver: &Driver,
        skin: &SkinMesh,
    ) -> PerFace<Option<Vector2<f64>>> {
        on_faces(driver, skin, |(places, facet), [x, y]| {
            let direction = facet.in_space(&self.at(places[0].direction_at));
            Vector2::new(direction.dot(x), direction.dot(y)).try_normalize(0.0)
        })
    }
}

impl Grows {
    /// Change of length of the layer against what is below, where this changes by `change`.
    fn against_below(self, change: f64) -> f64 {
        match self {
            Self::Layer | Self::Ply(_) => change,
            // Nothing shrinks to less than nothing.
            Self::Below if change <= -1.0 => f64::INFINITY,
            Self::Below => 1.0 / (1.0 + change) - 1.0,
        }
    }
}

impl LayerSpec {
    /// The strain of a driver's face as this layer feels it at a load of a pose: relative to what it has grown.
    pub fn felt(
        &self,
        pose: &PoseSpec,
        load: f64,
        (driver, face): (&Driver, FaceId),
        strain: &FaceStrain,
    ) -> FaceStrain {
        let growth = PoseGrowth::new(self, pose);
        if growth.is_none() {
            return *strain;
        }
        let corners = driver.topology().faces()[face].map(|v| driver.rest()[v.index()]);
        let stretch = growth.on_part((driver, face), &driver.uvs()[face], &corners, load);
        relative_to(strain, &stretch)
    }
}

/// The growths of a layer that one pose switches on.
#[derive(Clone, Debug)]
pub(crate) struct PoseGrowth<'a> {
    layer: &'a LayerSpec,
    growths: Vec<(&'a GrowthSpec, f64)>,
}

impl<'a> PoseGrowth<'a> {
    pub(crate) fn new(layer: &'a LayerSpec, pose: &PoseSpec) -> Self {
        let strength = |growth: &&'a GrowthSpec| {
            let named = pose.growths.iter().filter(|(name, _)| *name == growth.name);
            named.map(|(_, strength)| strength).sum::<f64>()
        };
        let growths = layer.growths.iter();
        let growths = growths.map(|growth| (growth, strength(&growth)));
        Self {
            layer,
            growths: growths.filter(|(_, strength)| *strength != 0.0).collect(),
        }
    }

    /// Range of the changes of length at full load, anywhere and of any ply; no numbers where one of them is none.
    pub(crate) fn changes(&self) -> [f64; 2] {
        let plies = 0..self.ply_count();
        let ranges: Vec<[f64; 2]> = plies.map(|ply| self.changes_of(ply)).collect();
        // `min` would make a number of none.
        if ranges.as_flattened().iter().any(|change| change.is_nan()) {
            return [f64::NAN; 2];
        }
        ranges
            .iter()
            .fold([0.0, 0.0], |[least, most], [low, high]| {
                [least.min(*low), most.max(*high)]
            })
    }

    /// Range of the changes of length of one ply.
    fn changes_of(&self, ply: usize) -> [f64; 2] {
        let mut range = [0.0, 0.0];
        for (growth, strength) in self.of_ply(ply) {
            let [low, high] = growth.changes(*strength);
            // Where one of them is not painted, the others are alone. Not `min`, see above.
            range[0] += if low > 0.0 { 0.0 } else { low };
            range[1] += if high < 0.0 { 0.0 } else { high };
        }
        range
    }

    /// Number of plies; a layer that is none of bonded plies is one itself.
    fn ply_count(&self) -> usize {
        let laminate = self.layer.laminate.as_ref();
        laminate.map_or(1, LaminatedSheet::ply_count)
    }

    /// The growths that change the lengths of a ply: its own, and those of the whole layer.
    fn of_ply(&self, ply: usize) -> impl Iterator<Item = &(&'a GrowthSpec, f64)> {
        let is_own = move |grows: Grows| match grows {
            Grows::Layer | Grows::Below => true,
            Grows::Ply(own) => own == ply,
        };
        let growths = self.growths.iter();
        growths.filter(move |(growth, _)| is_own(growth.grows))
    }

    /// Whether nothing grows.
    pub(crate) fn is_none(&self) -> bool {
        self.growths.is_empty()
    }

    /// Stretches of the rest metric of `skin` at a load, one per face in its rest frame; `None` without growth.
    pub(crate) fn on_skin(
        &self,
        driver: &Driver,
        skin: &SkinMesh,
        load: f64,
    ) -> Option<PerFace<Matrix2<f64>>> {
        if self.is_none() {
            return None;
        }
        Some(on_faces(driver, skin, |on, frame| {
            self.stretch(on, frame, load)
        }))
    }

    /// Natural curvatures of the faces of `skin` at a load, in their stretched rest frames, 1/m.
    pub(crate) fn curls_on_skin(
        &self,
        driver: &Driver,
        skin: &SkinMesh,
        load: f64,
    ) -> PerFace<Matrix2<f64>> {
        let mut curls = on_faces(driver, skin, |(places, facet), frame| {
            let curls = self.growths.iter().flat_map(|(growth, strength)| {
                let of_corner = places.iter().map(|place| {
                    growth.tensor(growth.curl, (place, facet), frame) * (load * strength / 3.0)
                });
                of_corner.collect::<Vec<_>>()
            });
            curls.sum()
        });
        if let Some(laminate) = self.laminate_that_bends() {
            let of_plies = on_faces(driver, skin, |on, frame| {
                self.natural_shape(laminate, on, frame, load).curvature
            });
            let relative = relative_at_vertices(self.layer, driver, skin);
            let relative = relative_on_faces(self.layer, skin, &relative);
            for (face, relative) in relative.iter() {
                // The same strains over a thicker sheet bend it less.
                let thickness = relative.wavelength * relative.thickness;
                curls[face] += of_plies[face] / thickness;
            }
        }
        curls
    }

    /// The laminate of which single plies grow.
    fn laminate_that_bends(&self) -> Option<&'a LaminatedSheet> {
        let mut grows = self.growths.iter().map(|(growth, _)| growth.grows);
        let of_ply = grows.any(|grows| matches!(grows, Grows::Ply(_)));
        self.layer.laminate.as_ref().filter(|_| of_ply)
    }

    /// The stretch of the rest metric of a part of a driver's face at a load, from its corners in the texture and
    /// at rest (m).
    pub(crate) fn on_part(
        &self,
        (driver, face): (&Driver, FaceId),
        uvs: &[Vector2<f64>; 3],
        corners: &[Vector3<f64>; 3],
        load: f64,
    ) -> Matrix2<f64> {
        let places = uvs.map(|uv| Place {
            uv,
            direction_at: uv,
        });
        let facet = Facet::new(driver, face);
        self.stretch((&places, &facet), &triangle_frame(corners), load)
    }

    /// The stretch in a plane.
    fn stretch(
        &self,
        on: (&[Place; 3], &Facet),
        frame: &[Vector3<f64>; 2],
        load: f64,
    ) -> Matrix2<f64> {
        match self.laminate_that_bends() {
            Some(laminate) => self.natural_shape(laminate, on, frame, load).stretch,
            None => self.ply_stretch(0, on, frame, load),
        }
    }

    /// Stretch and curvature in a plane that the plies enforce together.
    fn natural_shape(
        &self,
        laminate: &LaminatedSheet,
        on: (&[Place; 3], &Facet),
        frame: &[Vector3<f64>; 2],
        load: f64,
    ) -> NaturalShape {
        let plies = 0..laminate.ply_count();
        let stretches: Vec<_> = plies
            .map(|ply| self.ply_stretch(ply, on, frame, load))
            .collect();
        let shape = laminate.natural_shape(&stretches);
        shape.expect("the plan has checked that growths leave each ply two fifths of its length")
    }

    /// The stretch of a ply in a plane: a face takes the mean of its corners (Li 2014, 5.2).
    fn ply_stretch(
        &self,
        ply: usize,
        (places, facet): (&[Place; 3], &Facet),
        frame: &[Vector3<f64>; 2],
        load: f64,
    ) -> Matrix2<f64> {
        let changes = places
            .iter()
            .map(|place| self.change(ply, (place, facet), frame, load));
        Matrix2::identity() + changes.sum::<Matrix2<f64>>() / 3.0
    }

    /// Change of a ply's lengths, against what is below of a layer that is carried, in a plane.
    fn change(
        &self,
        ply: usize,
        on: (&Place, &Facet),
        frame: &[Vector3<f64>; 2],
        load: f64,
    ) -> Matrix2<f64> {
        let changes = self.of_ply(ply).map(|(growth, strength)| {
            let lengths = [growth.along, growth.across];
            let change = growth.tensor(lengths, on, frame) * (load * strength);
            if growth.grows != Grows::Below {
                return change;
            }
            let eigen = SymmetricEigen::new(change);
            let values = eigen.eigenvalues;
            let values = values.map(|change| growth.grows.against_below(change));
            let vectors = eigen.eigenvectors;
            vectors * Matrix2::from_diagonal(&values) * vectors.transpose()
        });
        changes.sum()
    }
}

/// A value for every face of `skin` from its corners, the driver's face whose directions it has, and its rest frame.
fn on_faces<T>(
    driver: &Driver,
    skin: &SkinMesh,
    of_face: impl Fn((&[Place; 3], &Facet), &[Vector3<f64>; 2]) -> T,
) -> PerFace<T> {
    let (points, rest) = (skin.points.points(), &skin.rest.positions);
    let faces = skin.mesh.faces().as_slice().iter();
    let values = faces.map(|corners: &[VertexId; 3]| {
        let frame = triangle_frame(&corners.map(|v| rest[v.index()]));
        // Directions are those at the corner farthest inside a face of the driver. At a seam of the texture a corner
        // may be addressed in the island beside, which may lie turned in the texture; where all three lie on
        // edges of the driver, the first one decides, and may be such a corner.
        let inside = |v: &VertexId| {
            points[v.index()]
                .barycentric
                .into_iter()
                .fold(1.0, f64::min)
        };
        let [a, b, c] = corners;
        let farthest = [b, c]
            .into_iter()
            .fold(a, |best, v| if inside(v) > inside(best) { v } else { best });
        let at = &points[farthest.index()];
        let facet = Facet::new(driver, at.face);
        let direction_at = uv(driver, at);
        let places = corners.map(|v| Place {
            uv: uv(driver, &points[v.index()]),
            direction_at,
        });
        of_face((&places, &facet), &frame)
    });
    values.collect()
}

/// Texture coordinates of a corner: its own, and those at which directions are read.
struct Place {
    uv: Vector2<f64>,
    direction_at: Vector2<f64>,
}

/// Derivatives of places in space by texture coordinates on one of the driver's faces.
///
/// Directions in the texture are those on the artist's own facets. Derivatives of the smooth surface would turn
/// them by up to ten degrees around vertices with more or fewer than six edges, because texture coordinates are
/// linear on a facet and places on the smooth surface are not.
struct Facet {
    by_u: Vector3<f64>,
    by_v: Vector3<f64>,
}

impl Facet {
    fn new(driver: &Driver, face: FaceId) -> Self {
        let [a, b, c] = driver.topology().faces()[face].map(|v| driver.rest()[v.index()]);
        let [p, q, r] = driver.uvs()[face];
        let edges = Matrix2::from_columns(&[q - p, r - p]);
        // A face without an area in the texture has no directions there.
        let inverse = edges.try_inverse().unwrap_or_else(Matrix2::zeros);
        // x = a + [b - a, c - a] t with uv = p + edges t: the columns of the inverse say how t changes
        // with u and v.
        let by = |k: usize| (b - a) * inverse[(0, k)] + (c - a) * inverse[(1, k)];
        Self {
            by_u: by(0),
            by_v: by(1),
        }
    }

    fn in_space(&self, direction: &Vector2<f64>) -> Vector3<f64> {
        self.by_u * direction.x + self.by_v * direction.y
    }
}
