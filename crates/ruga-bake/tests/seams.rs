//! Padding across seams: filtered on either side of a cut, the map shows the same surface.

mod patch;

use nalgebra::{Vector2, Vector3};
use patch::{Driver, Patch, SIDE, degrees, grid_faces, waves};
use ruga_bake::{
    BakeSettings, Coverage, Detail, Seams, TangentFrame, WrinkleMap, bake_squares, tangent_frames,
};

const SIZE: u32 = 256;

/// Cells of the artist's mesh along each side.
const CELLS: usize = 24;

/// Texture coordinate of a place that belongs to the left or the right half: the right one is turned by
/// a right angle and lies elsewhere; `mirrored` turns it over, too.
fn chart(is_right: bool, mirrored: bool, uv: Vector2<f64>) -> Vector2<f64> {
    if !is_right {
        return Vector2::new(0.05 + 0.6 * uv.x, 0.05 + 0.6 * uv.y);
    }
    let (x, y) = (uv.x - 0.5, uv.y);
    let y = if mirrored { 1.0 - y } else { y };
    Vector2::new(0.37 + 0.6 * (1.0 - y), 0.67 + 0.6 * x)
}

/// A wrinkled patch whose artist's mesh is cut in the middle, and what its seams are found from.
struct Cut {
    patch: Patch,
    positions: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    uvs: Vec<[Vector2<f64>; 3]>,
    frames: Vec<[TangentFrame; 3]>,
    /// Lowest U and V of the square that the right half lies in.
    right: [i32; 2],
}

impl Cut {
    fn new(driver: Driver, mirrored: bool) -> Self {
        Self::apart(driver, mirrored, [0, 0])
    }

    /// The right half in a square of its own.
    fn apart(driver: Driver, mirrored: bool, right: [i32; 2]) -> Self {
        let chart = |is_right: bool, mirrored: bool, uv: Vector2<f64>| {
            let origin = if is_right { right } else { [0, 0] };
            chart(is_right, mirrored, uv) + Vector2::from(origin.map(f64::from))
        };
        let mut patch = Patch::new(driver, [96, CELLS], 1e-3, waves);
        let is_right = |triangle: u32| (triangle as usize / 2) % CELLS >= CELLS / 2;
        for (uvs, (triangle, _)) in patch.uvs.iter_mut().zip(&patch.artist) {
            *uvs = uvs.map(|uv| chart(is_right(*triangle), mirrored, uv));
        }
        let triangles = grid_faces(CELLS);
        let coarse = Patch::new(driver, [CELLS, 1], 0.0, |_, _| 0.0);
        let numbered = (0..).zip(&coarse.uvs);
        let uvs: Vec<_> = numbered
            .map(|(triangle, uvs)| uvs.map(|uv| chart(is_right(triangle), mirrored, uv)))
            .collect();
        // Unindexed, as MikkTSpace sees it: a vertex on the cut has two texture coordinates.
        let corners = || triangles.iter().flatten().map(|&v| v as usize);
        let count = 3 * triangles.len() as u32;
        let singles: Vec<[u32; 3]> = (0..count / 3)
            .map(|t| [0, 1, 2].map(|c| 3 * t + c))
            .collect();
        let positions: Vec<_> = corners().map(|v| coarse.driver_positions[v]).collect();
        let normals: Vec<_> = corners().map(|v| coarse.driver_normals[v]).collect();
        let flat: Vec<_> = uvs.iter().flatten().copied().collect();
        let frames = tangent_frames(&positions, &normals, &flat, &singles).expect("a valid mesh");
        Self {
            patch,
            positions: coarse.driver_positions,
            triangles,
            uvs,
            frames,
            right,
        }
    }

    /// The map of the left half, and of the right one if that has its own.
    fn baked_all(&self, across: bool) -> Vec<WrinkleMap> {
        let settings = BakeSettings {
            size: SIZE,
            ..BakeSettings::default()
        };
        let details = [Detail::Curvature, Detail::Displacement];
        let relief = self.patch.relief();
        let squares = [[0, 0], self.right];
        let squares = &squares[..1 + usize::from(self.right != [0, 0])];
        let maps = bake_squares(&relief, &self.frames, &settings, &details, squares);
        let mut maps = maps.expect("a patch");
        let seams = Seams::new(&self.positions, &self.triangles, &self.uvs, &self.frames);
        let seams = seams.expect("a valid mesh");
        match across {
            true => WrinkleMap::pad_across(&mut maps, &seams, 8).expect("finite"),
            false => {
                for map in &mut maps {
                    map.pad(&self.uvs, 8).expect("finite");
                }
            }
        }
        maps
    }

    fn baked(&self, across: bool) -> WrinkleMap {
        self.baked_all(across).remove(0)
    }

    /// Direction (unit) and displacement (m) in space at a place of the cut, filtered on one side of it.
    fn filtered(
        &self,
        map: &WrinkleMap,
        mirrored: bool,
        is_right: bool,
        t: f64,
    ) -> [Vector3<f64>; 2] {
        let uv = chart(is_right, mirrored, patch::uv([SIDE / 2.0, t]));
        let row = ((t / SIDE * CELLS as f64) as usize).min(CELLS - 1);
        let quad = row * CELLS + CELLS / 2 - usize::from(!is_right);
        // On a flat driver the frame is the same everywhere in a chart; along a cylinder, too.
        let frame = self.frames[2 * quad][usize::from(!is_right)];
        let bitangent = frame.normal.cross(&frame.tangent) * frame.sign;
        let space = |v: Vector3<f64>| frame.tangent * v.x + bitangent * v.y + frame.normal * v.z;
        let normal = bilinear(uv, |texel| Vector3::from(map.normals[texel].map(f64::from)));
        let values = map.detail(Detail::Displacement).expect("asked for");
        let way = bilinear(uv, |texel| {
            Vector3::from_column_slice(&values[3 * texel..3 * texel + 3]).map(f64::from)
        });
        [space(normal).normalize(), space(way)]
    }

    /// The largest difference across the cut: degrees, and metres.
    fn gap(&self, across: bool, mirrored: bool) -> [f64; 2] {
        let maps = self.baked_all(across);
        let of_side = |is_right: bool| &maps[usize::from(is_right).min(maps.len() - 1)];
        let mut most = [0.0_f64; 2];
        for step in 0..200 {
            let t = SIDE * (0.1 + 0.8 * f64::from(step) / 200.0);
            let sides =
                [false, true].map(|right| self.filtered(of_side(right), mirrored, right, t));
            let [a, b] = sides;
            most[0] = most[0].max(degrees(&a[0], &b[0]));
            most[1] = most[1].max((a[1] - b[1]).norm());
        }
        most
    }
}

fn bilinear(uv: Vector2<f64>, at: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
    let place = uv * f64::from(SIZE) - Vector2::repeat(0.5);
    let (x, y) = (place.x.floor(), place.y.floor());
    let (fx, fy) = (place.x - x, place.y - y);
    let texel = |dx: f64, dy: f64| at((y + dy) as usize * SIZE as usize + (x + dx) as usize);
    let row = |dy: f64| texel(0.0, dy) * (1.0 - fx) + texel(1.0, dy) * fx;
    row(0.0) * (1.0 - fy) + row(1.0) * fy
}

#[test]
fn both_sides_of_a_cut_show_the_same() {
    for driver in [Driver::Flat, Driver::Cylinder(0.04)] {
        for mirrored in [false, true] {
            let cut = Cut::new(driver, mirrored);
            let [plain, across] = [false, true].map(|across| cut.gap(across, mirrored));
            // The waves tilt the normal by up to 27 degrees; a texel is 0.65 mm, a seventh of the
            // shorter wave.
            assert!(plain[0] > 5.0 && plain[1] > 2e-4, "{plain:?}");
            assert!(across[0] < 0.5, "{across:?}");
            assert!(across[1] < 1e-5, "{across:?}");
        }
    }
}

#[test]
fn both_sides_of_a_cut_between_squares_show_the_same() {
    for (mirrored, right) in [(false, [1, 0]), (true, [0, -1])] {
        let cut = Cut::apart(Driver::Flat, mirrored, right);
        let [plain, across] = [false, true].map(|across| cut.gap(across, mirrored));
        assert!(plain[0] > 5.0 && across[0] < 0.5, "{plain:?} {across:?}");
        assert!(across[1] < 1e-5, "{across:?}");
    }
    // Without the map of what lies beyond, padding goes on with the nearest texel.
    let cut = Cut::apart(Driver::Flat, false, [1, 0]);
    let mut alone = [false, true].map(|across| {
        let mut maps = cut.baked_all(false);
        maps.truncate(1);
        let seams = Seams::new(&cut.positions, &cut.triangles, &cut.uvs, &cut.frames);
        if across {
            WrinkleMap::pad_across(&mut maps, &seams.expect("a valid mesh"), 8).expect("finite");
        }
        maps.remove(0)
    });
    let [plain, across] = &mut alone;
    assert_eq!(plain, across);
}

#[test]
fn padding_goes_on_with_the_surface_as_far_as_it_reaches() {
    let cut = Cut::new(Driver::Flat, true);
    let [plain, across] = [false, true].map(|across| {
        let map = cut.baked(across);
        let errors: Vec<f64> = (0..map.coverage.len())
            .filter(|&texel| map.coverage[texel] == Coverage::Padded)
            .filter_map(|texel| error_beside_the_left_chart(&map, texel))
            .collect();
        // A strip of 7 texels along 8 tenths of 154.
        assert!(errors.len() > 700, "{}", errors.len());
        patch::rms(errors.into_iter())
    });
    // The layer has four vertices on its shorter wave, and interpolation flattens it.
    assert!(across < 2.5 && plain > 4.0 * across, "{across}, {plain}");
}

/// Angle (degrees) between a texel and the surface that goes on there beyond the left chart.
fn error_beside_the_left_chart(map: &WrinkleMap, texel: usize) -> Option<f64> {
    let centre = [texel % SIZE as usize, texel / SIZE as usize].map(|i| i as f64 + 0.5);
    let place = (Vector2::from(centre) / f64::from(SIZE) - Vector2::repeat(0.05)) / 0.6;
    let is_beside = place.x > 0.5 && place.x < 0.55 && (0.1..0.9).contains(&place.y);
    let [s, t] = [place.x * SIDE, (1.0 - place.y) * SIDE];
    let slope = |ds: f64, dt: f64| (waves(s + ds, t + dt) - waves(s - ds, t - dt)) / 2e-6;
    let exact = Vector3::new(-slope(1e-6, 0.0), -slope(0.0, 1e-6), 1.0).normalize();
    let found = Vector3::from(map.normals[texel].map(f64::from));
    is_beside.then(|| degrees(&found, &exact))
}

#[test]
fn open_borders_and_covered_texels_are_left_alone() {
    let cut = Cut::new(Driver::Flat, false);
    let [plain, across] = [false, true].map(|across| cut.baked(across));
    assert_eq!(plain.coverage, across.coverage);
    let mut changed = 0;
    for texel in 0..plain.coverage.len() {
        let is_padding = plain.coverage[texel] == Coverage::Padded;
        if plain.normals[texel] != across.normals[texel] {
            assert!(is_padding);
            changed += 1;
        }
        // Above the left chart is an open border.
        let (column, row) = (texel % SIZE as usize, texel / SIZE as usize);
        if row < 12 && column < 80 {
            assert_eq!(plain.normals[texel], across.normals[texel]);
        }
    }
    // Two strips of 8 texels along 154.
    assert!((2000..3000).contains(&changed), "{changed}");
}
