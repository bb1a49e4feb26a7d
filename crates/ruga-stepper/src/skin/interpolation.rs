//! Smooth interpolation from one mesh of the skin to another.

use std::borrow::Cow;

use nalgebra::Vector3;
use ruga_mesh::{
    Id, LoopSurface, MaterialPoint, PerVertex, SparseRows, TriMesh, VertexId, limit_rows,
};

use crate::skin::fans::open_along;
use crate::skin::mirror::{Images, Mirrored};
use crate::skin::skin_mesh::SkinMesh;

mod line_shift;
mod parts;
mod places;

use parts::{FACES_AT_A_TIME, LimitPart, for_each_part};

pub(crate) use places::{places_of_limit, places_on};

/// Corrections of control points towards a limit surface that passes through the vertices. The
/// limit alone loses some 4 % of a wave's amplitude at 12 points per wavelength; one correction
/// leaves 0.2 % of it, more would bring back what is as short as the edges and no wrinkle.
const INTERPOLATION_STEPS: usize = 1;

/// Places found, or interpolated at, between two questions whether to go on.
const PLACES_AT_A_TIME: usize = 20_000;

/// Smooth interpolation of what is known at a mesh's vertices.
///
/// The Loop limit of control values that are corrected until it passes through the given ones:
/// smooth as the limit, without its loss of amplitude.
#[derive(Clone, Debug)]
pub(crate) struct Interpolation {
    /// The vertex with the value of every control point: those on creases have one for each side, and those of a mirror
    /// image that of their originals.
    copied: Vec<VertexId>,
    /// What is whose mirror image, of one half of a symmetric pose.
    images: Option<Images>,
    at_vertices: SparseRows,
    limit: Limit,
    places: Vec<MaterialPoint>,
}

/// What is known at the vertices of a mesh.
#[derive(Clone, Copy)]
pub(crate) enum Values<'a> {
    /// Vectors, which a mirror reflects.
    Vectors(&'a [Vector3<f64>]),
    /// Three numbers each, which are the same on both sides of a mirror.
    Numbers(&'a [Vector3<f64>]),
}

/// The limit surface at the places.
#[derive(Clone, Debug)]
enum Limit {
    /// Made for each evaluation of this mesh, part by part, and forgotten: as much work as rows take once, and little
    /// memory.
    Mesh(Box<TriMesh>),
    Rows(SparseRows),
}

impl Interpolation {
    /// Transfer of values at the vertices of one mesh to those of another, of the same skin;
    /// `None` as soon as `goes_on` says no.
    pub(crate) fn new(
        from: &SkinMesh,
        to: &SkinMesh,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let mirrored = from.mirrored();
        let places = places_on(from, mirrored.as_ref(), to, goes_on)?;
        if let Some(Mirrored {
            mesh,
            positions,
            images,
            ..
        }) = mirrored
        {
            let copied = images.originals().to_vec();
            let made = Self::smooth((mesh, positions), copied, (places, to), goes_on)?;
            return Some(Self {
                images: Some(images),
                ..made
            });
        }
        if from.creases.is_empty() {
            let own = (0..from.mesh.vertex_count()).map(VertexId::from_index);
            let faces = (from.mesh.clone(), from.rest.positions.clone());
            return Self::smooth(faces, own.collect(), (places, to), goes_on);
        }
        // Across a crease slopes jump: the sides are smooth surfaces with one border curve.
        let creases = from.creases.iter().map(|crease| crease.edge);
        let (faces, copied) = open_along(&from.mesh, creases);
        let opened = TriMesh::new(copied.len(), faces).expect("a manifold opened is one");
        Some(Self {
            at_vertices: limit_rows(&opened, &no_corners(&opened)).position,
            copied,
            images: None,
            limit: Limit::Mesh(Box::new(opened)),
            places,
        })
    }

    /// Transfer from a mesh without creases, at rest at these positions, to the vertices of `to`, which have these
    /// `places` on its faces.
    fn smooth(
        (mesh, rest): (TriMesh, Vec<Vector3<f64>>),
        copied: Vec<VertexId>,
        (places, to): (Vec<MaterialPoint>, &SkinMesh),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let at_vertices = limit_rows(&mesh, &no_corners(&mesh)).position;
        let on = (&mesh, rest.as_slice(), &at_vertices);
        // What is held on the surface below shows nothing, whatever lies beside it.
        let held = to.held();
        let wanted = (to.rest.positions.as_slice(), held.as_slice());
        let places = places_of_limit(on, places, wanted, goes_on)?;
        Some(Self {
            at_vertices,
            copied,
            images: None,
            limit: Limit::Mesh(Box::new(mesh)),
            places,
        })
    }

    /// The same transfer, up to rounding, prepared for being applied many times, 150 bytes a place; `None` as soon as
    /// `goes_on` says no.
    pub(crate) fn prepared(mut self, goes_on: &mut dyn FnMut() -> bool) -> Option<Self> {
        if let Limit::Mesh(mesh) = &self.limit {
            let mut surface = LoopSurface::new(mesh, &no_corners(mesh));
            let mut rows = SparseRows::default();
            // They are made in parts, so that a run on a whole face can be ended meanwhile.
            for chunk in self.places.chunks(PLACES_AT_A_TIME) {
                surface.add_position_rows(chunk, &mut rows);
                // Two places lie on a face of the layer's mesh, and all of its faces would take more memory than
                // the layer.
                surface.forget();
                if !goes_on() {
                    return None;
                }
            }
            self.limit = Limit::Rows(rows);
        }
        Some(self)
    }

    /// Material points on the one mesh of the vertices of the other.
    pub(crate) fn places(&self) -> Cow<'_, [MaterialPoint]> {
        match &self.images {
            None => Cow::Borrowed(&self.places),
            Some(images) => {
                let places = self.places.iter();
                places.map(|place| images.original_place(place)).collect()
            }
        }
    }

    /// Several sets of values at the vertices of the one mesh, at those of the other.
    pub(crate) fn apply<const K: usize>(&self, values: [Values<'_>; K]) -> [Vec<Vector3<f64>>; K] {
        let controls = values.map(|values| {
            let values: Vec<_> = match (values, &self.images) {
                (Values::Vectors(own), Some(images)) => images.vectors(own),
                (Values::Vectors(own) | Values::Numbers(own), _) => {
                    self.copied.iter().map(|v| own[v.index()]).collect()
                }
            };
            through_vertices(&self.at_vertices, &values)
        });
        match &self.limit {
            Limit::Mesh(mesh) => limit_in_parts(
                mesh,
                &self.places,
                controls.each_ref().map(Vec::as_slice),
                FACES_AT_A_TIME,
            ),
            Limit::Rows(rows) => controls.map(|control| rows.apply(&control)),
        }
    }
}

/// The limit surface of `mesh` at `places`, for several sets of control points, prepared for `most` faces at a time.
fn limit_in_parts<const K: usize>(
    mesh: &TriMesh,
    places: &[MaterialPoint],
    controls: [&[Vector3<f64>]; K],
    most: usize,
) -> [Vec<Vector3<f64>>; K] {
    let mut limits = controls.map(|_| vec![Vector3::zeros(); places.len()]);
    let of_part = |part: &LimitPart, own: &[u32]| {
        let on_part = |&i: &u32| {
            part.place(&places[i as usize])
                .expect("a place of the part")
        };
        let points: Vec<MaterialPoint> = own.iter().map(on_part).collect();
        let own = controls.map(|control| part.control(control));
        let own = own.each_ref().map(Vec::as_slice);
        part.surface.positions(&points, own)
    };
    for_each_part(mesh, places, (most, 0), of_part, |own, found| {
        for (limits, found) in limits.iter_mut().zip(found) {
            for (&i, limit) in own.iter().zip(found) {
                limits[i as usize] = limit;
            }
        }
        true
    });
    limits
}

/// Deviations from a smooth surface are smooth, so that no vertex is a corner.
fn no_corners(mesh: &TriMesh) -> PerVertex<bool> {
    PerVertex::filled(mesh.vertex_count(), false)
}

/// Control points whose limit surface, by the rows `at_vertices`, passes closer to `values`.
pub(crate) fn through_vertices(
    at_vertices: &SparseRows,
    values: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let mut control = values.to_vec();
    for _ in 0..INTERPOLATION_STEPS {
        let reached = at_vertices.apply(&control);
        for ((control, value), reached) in control.iter_mut().zip(values).zip(&reached) {
            *control += value - reached;
        }
    }
    control
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use ruga_mesh::FaceId;

    use super::*;
    use crate::test_drivers::{skin, square};

    #[test]
    fn prepared_or_not_it_gives_the_same() {
        let flat = |p: nalgebra::Vector2<f64>| Vector3::new(p.x, p.y, p.x * p.y);
        let driver = square(&flat, &flat);
        let [coarse, fine] = [1, 2].map(|levels| skin(&driver, levels, 0.0));
        let made = || Interpolation::new(&coarse, &fine, &mut || true).expect("nothing ends it");
        let prepared = made().prepared(&mut || true).expect("nothing ends it");
        let wave = |p: &Vector3<f64>| p * (3.0 * p.x).sin();
        let values: Vec<_> = coarse.rest.positions.iter().map(wave).collect();
        let sets = [values.as_slice(), &coarse.rest.positions].map(Values::Vectors);
        assert!(made().apply(sets) == prepared.apply(sets));
        assert!(made().prepared(&mut || false).is_none());
    }

    /// Inside and at corners of all faces; a part by itself, and one that meets the grid at one vertex alone.
    #[test]
    fn parts_of_a_surface_give_the_same_as_all_of_it() {
        let (grid, mut positions) = grid(|i, j| (i + 2 * j) % 3 == 0);
        let faces = grid.faces().as_slice().iter();
        let mut faces: Vec<_> = faces.map(|face| face.map(|v| v.0)).collect();
        faces.extend([[0, 625, 626], [627, 628, 629], [628, 630, 629]]);
        let apart = [
            [-1.0, 0.0],
            [-1.0, -1.0],
            [30.0, 0.0],
            [31.0, 0.0],
            [30.0, 1.0],
            [31.0, 1.0],
        ];
        positions.extend(apart.map(|[x, y]| Vector3::new(x, y, 0.5)));
        let count = faces.len();
        let mesh = TriMesh::new(positions.len(), faces).expect("three parts");
        let within = [
            [0.7, 0.2, 0.1],
            [0.1, 0.7, 0.2],
            [0.2, 0.1, 0.7],
            [0.2, 0.5, 0.3],
            [1.0, 0.0, 0.0],
        ];
        let place = |i: usize| MaterialPoint {
            face: FaceId::from_index(i * 7919 % count),
            barycentric: within[i / count],
        };
        let places: Vec<_> = (0..5 * count).map(place).collect();
        let bowl: Vec<_> = positions.iter().map(|x| x * x.norm()).collect();
        let sets = [bowl.as_slice(), &positions];
        let whole = limit_in_parts(&mesh, &places, sets, count);
        let parts = limit_in_parts(&mesh, &places, sets, 50);
        for (whole, part) in whole.iter().flatten().zip(parts.iter().flatten()) {
            // Sums run in another order.
            assert!((whole - part).norm() < 1e-12 * whole.norm().max(1.0));
        }
    }

    /// A grid of 24 by 24 squares of side 1, each cut in two, some of them the other way.
    fn grid(is_other: impl Fn(u32, u32) -> bool) -> (TriMesh, Vec<Vector3<f64>>) {
        let mut faces = Vec::new();
        for (i, j) in (0..24).flat_map(|j| (0..24).map(move |i| (i, j))) {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| 25 * (j + y) + i + x);
            faces.extend(match is_other(i, j) {
                true => [[a, b, d], [b, c, d]],
                false => [[a, b, c], [a, c, d]],
            });
        }
        let positions = (0..625).map(|v| Vector3::new(f64::from(v % 25), f64::from(v / 25), 0.0));
        (
            TriMesh::new(625, faces).expect("a grid"),
            positions.collect(),
        )
    }

    /// Edges are long and short in turn, as those of a mesh of scattered points are.
    #[test]
    fn a_wave_is_read_at_its_own_place() {
        let (mesh, even) = grid(|i, j| (i + j) % 2 == 0);
        let along = |x: f64| x + 0.05 * (std::f64::consts::PI * x).cos();
        let rest: Vec<_> = even
            .iter()
            .map(|p| Vector3::new(along(p.x), along(p.y), 0.0))
            .collect();
        let places: Vec<_> = mesh
            .faces()
            .ids()
            .map(|face| MaterialPoint {
                face,
                barycentric: [0.5, 0.3, 0.2],
            })
            .collect();
        let wanted: Vec<_> = places
            .iter()
            .map(|place| place.interpolate(&mesh, &rest))
            .collect();
        let at_vertices = limit_rows(&mesh, &no_corners(&mesh)).position;
        let wave = |p: &Vector3<f64>| Vector3::z() * (TAU * (p.x + 0.5 * p.y) / 12.0).sin();
        let values: Vec<_> = rest.iter().map(wave).collect();
        let control = through_vertices(&at_vertices, &values);
        let error = |places: &[MaterialPoint]| {
            let [found] = limit_in_parts(&mesh, places, [&control], FACES_AT_A_TIME);
            let inside = found
                .iter()
                .zip(&wanted)
                .filter(|(_, at)| [at.x, at.y].iter().all(|x| (3.0..21.0).contains(x)));
            let squares: Vec<f64> = inside
                .map(|(found, at)| (found - wave(at)).norm_squared())
                .collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        let before = error(&places);
        let on = (&mesh, rest.as_slice(), &at_vertices);
        let free = vec![false; places.len()];
        let moved = places_of_limit(on, places.clone(), (&wanted, &free), &mut || true);
        let after = error(&moved.expect("nothing ends it"));
        assert!(before > 0.01, "{before}");
        assert!(after < 0.45 * before, "{after} for {before}");
        assert!(places_of_limit(on, places, (&wanted, &free), &mut || false).is_none());
    }

    /// Of a wave of 12 edges, the limit through corrected points loses little, the plain one much.
    #[test]
    fn a_wave_keeps_its_amplitude() {
        let (mesh, positions) = grid(|_, _| false);
        let corners = PerVertex::filled(625, false);
        let at_vertices = limit_rows(&mesh, &corners).position;
        let height = |p: &Vector3<f64>| Vector3::z() * (TAU * p.x / 12.0).sin();
        let wave: Vec<_> = positions.iter().map(height).collect();
        let corrected = at_vertices.apply(&through_vertices(&at_vertices, &wave));
        let plain = at_vertices.apply(&wave);
        // A crest in the middle of the grid.
        let crest = 25 * 12 + 15;
        let loss = |found: &[Vector3<f64>]| 1.0 - found[crest].z / wave[crest].z;
        assert!(loss(&plain).abs() > 0.02, "{}", loss(&plain));
        assert!(loss(&corrected).abs() < 0.003, "{}", loss(&corrected));
    }
}
