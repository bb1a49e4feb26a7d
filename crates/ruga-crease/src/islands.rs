//! The islands of a texture layout, and their borders.

use nalgebra::Vector2;
use ruga_mesh::{FaceId, Id, MaterialPoint, PerFace, PlanarLookup, TriMesh};

use crate::layout_places::{hangs_together, uv_at};
use crate::walk::place_in;

/// Share of a leg up to which two crossings of borders are one.
const SAME_CROSSING: f64 = 1e-9;

/// An edge of a face at the border of an island.
#[derive(Clone, Copy, Debug)]
struct Rim {
    face: FaceId,
    /// The edge's first corner.
    corner: usize,
    island: u32,
    ends: [Vector2<f64>; 2],
    /// The face on the other side of the seam; none at the border of the surface.
    beyond: Option<FaceId>,
}

/// A place on the border of an island.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RimPlace {
    rim: usize,
    fraction: f64,
}

/// Where a ray meets the border of an island.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ahead {
    pub(crate) place: RimPlace,
    /// Length of the ray up to there (texels).
    pub(crate) distance: f64,
    /// Sine of the angle between the ray and the border.
    pub(crate) sine: f64,
}

/// The islands of a layout: faces that hang together there.
#[derive(Debug)]
pub(crate) struct Islands<'a> {
    mesh: &'a TriMesh,
    uvs: &'a PerFace<[Vector2<f64>; 3]>,
    lookup: &'a PlanarLookup,
    /// The island of every face.
    numbers: Vec<u32>,
    rims: Vec<Rim>,
}

impl<'a> Islands<'a> {
    pub(crate) fn new(
        mesh: &'a TriMesh,
        uvs: &'a PerFace<[Vector2<f64>; 3]>,
        lookup: &'a PlanarLookup,
    ) -> Self {
        let next_to = |face: FaceId, corner: usize| {
            let next = mesh.neighbour(face, corner);
            next.filter(|next| hangs_together(mesh, uvs, [face, *next], corner))
        };
        let numbers = numbered(mesh.face_count(), &next_to);
        let sides = (0..mesh.face_count()).flat_map(|face| [0, 1, 2].map(|corner| (face, corner)));
        let rims = sides.filter_map(|(number, corner)| {
            let face = FaceId::from_index(number);
            next_to(face, corner).is_none().then(|| Rim {
                face,
                corner,
                island: numbers[number],
                ends: [uvs[face][corner], uvs[face][(corner + 1) % 3]],
                beyond: mesh.neighbour(face, corner),
            })
        });
        let rims = rims.collect();
        Self {
            mesh,
            uvs,
            lookup,
            numbers,
            rims,
        }
    }

    /// The island that a point lies in.
    pub(crate) fn at(&self, uv: Vector2<f64>) -> Option<u32> {
        let found = self.lookup.locate(uv)?;
        Some(self.numbers[found.face.index()])
    }

    /// Texture coordinates of a place on a border.
    pub(crate) fn uv(&self, place: RimPlace) -> Vector2<f64> {
        let [from, to] = self.rims[place.rim].ends;
        from + (to - from) * place.fraction
    }

    /// A place on a border as one of the mesh.
    pub(crate) fn on_mesh(&self, place: RimPlace) -> MaterialPoint {
        let Rim { face, corner, .. } = self.rims[place.rim];
        let mut barycentric = [0.0; 3];
        barycentric[corner] = 1.0 - place.fraction;
        barycentric[(corner + 1) % 3] = place.fraction;
        MaterialPoint { face, barycentric }
    }

    /// The same place of the surface on the other side of the seam, and its texture coordinates there; none at the
    /// border of the surface.
    pub(crate) fn beyond(&self, place: RimPlace) -> Option<(MaterialPoint, Vector2<f64>)> {
        let face = self.rims[place.rim].beyond?;
        let barycentric = place_in(self.mesh, &self.on_mesh(place), face)?;
        let there = MaterialPoint { face, barycentric };
        Some((there, uv_at(self.uvs, &there)))
    }

    /// The place on the border of an island that is nearest to a point, with distances in texels of this size.
    pub(crate) fn nearest(
        &self,
        island: u32,
        uv: Vector2<f64>,
        texel: Vector2<f64>,
    ) -> Option<RimPlace> {
        let own = self.rims.iter().enumerate();
        let places = own.filter(|(_, rim)| rim.island == island);
        let places = places.map(|(number, rim)| {
            let [from, to] = rim.ends.map(|end| (end - uv).component_div(&texel));
            let side = to - from;
            let share = -from.dot(&side) / side.norm_squared().max(f64::MIN_POSITIVE);
            let fraction = share.clamp(0.0, 1.0);
            let place = RimPlace {
                rim: number,
                fraction,
            };
            (place, (from + side * fraction).norm_squared())
        });
        let nearest = places.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map(|(place, _)| place)
    }

    /// Where a ray from a point inside an island first meets its border.
    pub(crate) fn ahead(
        &self,
        island: u32,
        from: Vector2<f64>,
        direction: Vector2<f64>,
        texel: Vector2<f64>,
    ) -> Option<Ahead> {
        let along = direction.component_div(&texel).try_normalize(0.0)?;
        let own = self.rims.iter().enumerate();
        let met = own.filter_map(|(number, rim)| {
            let [a, b] = rim.ends.map(|end| (end - from).component_div(&texel));
            let sides = [a, b].map(|end| along.perp(&end));
            if rim.island != island || (sides[0] > 0.0) == (sides[1] > 0.0) {
                return None;
            }
            let fraction = sides[0] / (sides[0] - sides[1]);
            let distance = along.dot(&(a + (b - a) * fraction));
            let place = RimPlace {
                rim: number,
                fraction,
            };
            let sine = along.perp(&(b - a)).abs() / (b - a).norm();
            (distance > 0.0).then_some(Ahead {
                place,
                distance,
                sine,
            })
        });
        met.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Borders that a polyline may meet.
    pub(crate) fn around(&self, points: &[Vector2<f64>]) -> Around {
        let none = Vector2::repeat(f64::INFINITY);
        let (low, high) = points
            .iter()
            .fold((none, -none), |(low, high), p| (low.inf(p), high.sup(p)));
        let is_near = |rim: &&Rim| {
            let [a, b] = rim.ends;
            (0..2).all(|i| a[i].max(b[i]) >= low[i] && a[i].min(b[i]) <= high[i])
        };
        Around(
            self.rims
                .iter()
                .filter(is_near)
                .map(|rim| rim.ends)
                .collect(),
        )
    }
}

/// Borders of islands around a polyline.
pub(crate) struct Around(Vec<[Vector2<f64>; 2]>);

impl Around {
    /// Shares of the way from one point to another between which no border is crossed, from 0 to 1.
    pub(crate) fn shares(&self, [from, to]: [Vector2<f64>; 2]) -> Vec<f64> {
        let leg = to - from;
        let square = leg.norm_squared();
        let crossed = self.0.iter().filter_map(|[a, b]| {
            let sides = [a, b].map(|end| leg.perp(&(end - from)));
            if (sides[0] > 0.0) == (sides[1] > 0.0) {
                return None;
            }
            let at = a + (b - a) * (sides[0] / (sides[0] - sides[1]));
            let share = leg.dot(&(at - from)) / square;
            (share > 0.0 && share < 1.0).then_some(share)
        });
        let mut shares: Vec<f64> = crossed.chain([0.0, 1.0]).collect();
        shares.sort_by(f64::total_cmp);
        shares.dedup_by(|next, last| *next - *last < SAME_CROSSING);
        // The end counts, not the crossing just before it.
        if let Some(last) = shares.last_mut() {
            *last = 1.0;
        }
        shares
    }
}

/// Numbers for faces, equal for those that hang together.
fn numbered(count: usize, next_to: &impl Fn(FaceId, usize) -> Option<FaceId>) -> Vec<u32> {
    let mut numbers: Vec<Option<u32>> = vec![None; count];
    let mut islands = 0;
    for start in 0..count {
        if numbers[start].is_some() {
            continue;
        }
        numbers[start] = Some(islands);
        let mut open = vec![FaceId::from_index(start)];
        while let Some(face) = open.pop() {
            for next in [0, 1, 2]
                .into_iter()
                .filter_map(|corner| next_to(face, corner))
            {
                let number = &mut numbers[next.index()];
                if number.is_none() {
                    *number = Some(islands);
                    open.push(next);
                }
            }
        }
        islands += 1;
    }
    numbers.into_iter().flatten().collect()
}
