//! Maps of a burning sheet against fields whose maps are known.

mod patch;

use nalgebra::Vector2;
use patch::Patch;
use rayon::ThreadPoolBuilder;
use ruga_bake::{BakeError, BurntFields, Detail, Encoding, WrinkleMap};

const SIZE: u32 = 64;

const DETAILS: [Detail; 5] = [
    Detail::Mask,
    Detail::Char,
    Detail::Ash,
    Detail::Temperature,
    Detail::Thickness,
];

/// A sheet over the whole unit square on an irregular mesh, which no field lies along.
struct Sheet {
    faces: Vec<[u32; 3]>,
    uvs: Vec<[Vector2<f64>; 3]>,
    places: Vec<Vector2<f64>>,
    temperature: Vec<f64>,
    fuel: Vec<f64>,
    level: Vec<f64>,
}

impl Sheet {
    fn fresh() -> Self {
        let patch = Patch::scattered(20, 0.3, |_, _| 0.0);
        let mut places = vec![Vector2::zeros(); patch.positions.len()];
        for (face, uvs) in patch.faces.iter().zip(&patch.uvs) {
            for (&vertex, uv) in face.iter().zip(uvs) {
                places[vertex as usize] = *uv;
            }
        }
        Self {
            faces: patch.faces,
            uvs: patch.uvs,
            temperature: vec![300.0; places.len()],
            fuel: vec![1.0; places.len()],
            level: vec![0.8; places.len()],
            places,
        }
    }

    fn field(&self, value: impl Fn(&Vector2<f64>) -> f64) -> Vec<f64> {
        self.places.iter().map(value).collect()
    }

    fn fields(&self) -> BurntFields<'_> {
        BurntFields {
            faces: &self.faces,
            uvs: &self.uvs,
            temperature: &self.temperature,
            fuel: &self.fuel,
            level: &self.level,
            char_thickness: 0.6,
        }
    }

    fn map(&self, supersample: u32) -> WrinkleMap {
        let mut map = WrinkleMap::neutral(SIZE, [0, 0]);
        map.paint_burnt(&self.fields(), &DETAILS, supersample)
            .expect("valid fields");
        map
    }
}

fn values(map: &WrinkleMap, detail: Detail) -> &[f32] {
    map.detail(detail).expect("it was asked for")
}

/// Texture coordinate of a texel's centre.
fn centre(texel: usize) -> Vector2<f64> {
    let side = SIZE as usize;
    Vector2::new((texel % side) as f64 + 0.5, (texel / side) as f64 + 0.5) / f64::from(SIZE)
}

#[test]
fn a_fresh_sheet_is_white_and_cold() {
    let map = Sheet::fresh().map(4);
    for (detail, value) in DETAILS.into_iter().zip([1.0, 0.0, 0.0, 300.0, 1.0]) {
        let off = values(&map, detail).iter().map(|v| (v - value).abs());
        assert!(off.fold(0.0, f32::max) < 1e-4, "{detail:?}");
    }
    assert!(values(&map, Detail::Mask).iter().all(|v| *v == 1.0));
}

#[test]
fn the_mask_of_a_half_plane_is_antialiased() {
    let normal = Vector2::new(0.8, 0.6);
    let mut sheet = Sheet::fresh();
    sheet.level = sheet.field(|uv| normal.dot(uv) - 0.62);
    let map = sheet.map(4);
    let mask = values(&map, Detail::Mask);
    // The line meets the top (v = 0) at u = .775 and the bottom at u = .025.
    let area = mask.iter().map(|v| f64::from(*v)).sum::<f64>() / f64::from(SIZE * SIZE);
    assert!((area - 0.6).abs() < 1e-3, "{area}");
    for (texel, value) in mask.iter().enumerate() {
        // From the line to the centre of the texel, in texels; no corner is farther away than .7 of them.
        let distance = (normal.dot(&centre(texel)) - 0.62) * f64::from(SIZE);
        // The share beside a slanted line is near the one beside a line along the texels.
        let expected = (0.5 + distance).clamp(0.0, 1.0);
        assert!((f64::from(*value) - expected).abs() < 0.25, "{distance}");
        if distance.abs() > 0.71 {
            assert_eq!(f64::from(*value), expected);
        }
    }
    let grey = mask.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
    assert!(grey >= SIZE as usize, "{grey} texels in between");
}

#[test]
fn char_and_temperature_are_linear_also_where_the_sheet_is_gone() {
    let mut sheet = Sheet::fresh();
    let fuel = |uv: &Vector2<f64>| 0.1 + 0.5 * uv.x + 0.3 * uv.y;
    let temperature = |uv: &Vector2<f64>| 1200.0 - 500.0 * uv.x - 300.0 * uv.y;
    sheet.fuel = sheet.field(fuel);
    sheet.temperature = sheet.field(temperature);
    sheet.level = sheet.field(|uv| uv.x - 0.5);
    for supersample in [1, 2, 4] {
        let map = sheet.map(supersample);
        for texel in 0..map.coverage.len() {
            let at = |detail| f64::from(values(&map, detail)[texel]);
            let uv = centre(texel);
            assert!((at(Detail::Char) - (1.0 - fuel(&uv))).abs() < 1e-6);
            assert!((at(Detail::Temperature) - temperature(&uv)).abs() < 1e-3);
            // Texels end where the sheet does, on the middle of the square.
            let left = f64::from(uv.x > 0.5);
            assert_eq!(at(Detail::Mask), left);
            let thickness = left * (1.0 - 0.4 * (1.0 - fuel(&uv)));
            assert!((at(Detail::Thickness) - thickness).abs() < 1e-6);
            assert_eq!(at(Detail::Ash), 0.0);
        }
    }
}

#[test]
fn ash_is_where_no_fuel_is_left() {
    let mut sheet = Sheet::fresh();
    sheet.fuel = sheet.field(|uv| if uv.x < 0.5 { 0.0 } else { 1.0 });
    let map = sheet.map(2);
    for texel in 0..map.coverage.len() {
        let [ash, thickness] =
            [Detail::Ash, Detail::Thickness].map(|detail| values(&map, detail)[texel]);
        // Vertices are a twentieth of the side apart, and up to a third of that out of place.
        let u = centre(texel).x;
        if u < 0.5 - 0.07 {
            assert_eq!(ash, 1.0);
            assert!((thickness - 0.6).abs() < 1e-6, "it stays as thin char");
        }
        if u > 0.5 {
            assert_eq!(ash, 0.0);
        }
    }
    sheet.level.fill(-0.1);
    let map = sheet.map(2);
    assert!(values(&map, Detail::Thickness).iter().all(|v| *v == 0.0));
    assert!(values(&map, Detail::Mask).iter().all(|v| *v == 0.0));
}

#[test]
fn squares_beside_the_sheet_are_neutral_and_its_border_has_no_gap() {
    let mut sheet = Sheet::fresh();
    sheet.level.fill(-1.0);
    let mut beside = WrinkleMap::neutral(SIZE, [1, 0]);
    beside
        .paint_burnt(&sheet.fields(), &DETAILS, 1)
        .expect("valid fields");
    let mut neutral = WrinkleMap::neutral(SIZE, [1, 0]);
    neutral.add_neutral(&DETAILS);
    assert_eq!(beside, neutral);

    // The sheet misses the centres of a column of texels by a rounding error.
    let column = 31;
    let end = (column as f64 + 0.5) / f64::from(SIZE) - 1e-7;
    for uv in sheet.uvs.iter_mut().flatten() {
        uv.x *= end;
    }
    let map = sheet.map(1);
    for (texel, value) in values(&map, Detail::Mask).iter().enumerate() {
        let is_beside = texel % SIZE as usize > column;
        assert_eq!(*value, f32::from(is_beside));
    }
}

#[test]
fn fields_that_do_not_fit_are_refused_by_name() {
    let sheet = Sheet::fresh();
    let error = |fields: BurntFields<'_>, supersample: u32| {
        let mut map = WrinkleMap::neutral(8, [0, 0]);
        let result = map.paint_burnt(&fields, &DETAILS, supersample);
        assert!(map.details.is_empty(), "nothing is painted");
        result.expect_err("a field that does not fit")
    };
    let fields = sheet.fields();
    let fuel = &fields.fuel[1..];
    assert_eq!(
        error(BurntFields { fuel, ..fields }, 1).to_string(),
        "fuel has 440 elements, expected 441"
    );
    let level = &fields.level[1..];
    assert_eq!(
        error(BurntFields { level, ..fields }, 1).to_string(),
        "level has 440 elements, expected 441"
    );
    let uvs = &fields.uvs[1..];
    assert_eq!(
        error(BurntFields { uvs, ..fields }, 1).to_string(),
        "uvs has 799 elements, expected 800"
    );
    let mut faces = sheet.faces.clone();
    faces[3][1] = 441;
    let faces = &faces;
    assert_eq!(
        error(BurntFields { faces, ..fields }, 1).to_string(),
        "faces[3] refers to 441, but there are only 441"
    );
    let mut hot = sheet.temperature.clone();
    hot[7] = f64::NAN;
    let temperature = &hot;
    let not_finite = |array, index| BakeError::NotFinite { array, index };
    assert_eq!(
        error(
            BurntFields {
                temperature,
                ..fields
            },
            1
        ),
        not_finite("temperature", 7)
    );
    let char_thickness = f64::INFINITY;
    assert_eq!(
        error(
            BurntFields {
                char_thickness,
                ..fields
            },
            1
        ),
        not_finite("char_thickness", 0)
    );
    assert_eq!(error(fields, 3), BakeError::Supersample(3));
}

#[test]
fn one_and_two_threads_give_the_same_maps() {
    let mut sheet = Sheet::fresh();
    sheet.fuel = sheet.field(|uv| (uv.x + 0.3 * uv.y).min(1.0));
    sheet.level = sheet.field(|uv| uv.x * uv.y - 0.2);
    let maps = [1, 2].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| sheet.map(2))
    });
    assert_eq!(maps[0], maps[1]);
}

#[test]
fn temperatures_keep_their_digits_in_sixteen_bits() {
    let encoding = Encoding::temperature(1100.0);
    assert_eq!([encoding.mid, encoding.scale], [0.0, 2000.0]);
    let codes = encoding.to_u16(&[293.15, 1100.0]);
    for (code, kelvin) in codes.into_iter().zip([293.15, 1100.0]) {
        let found = encoding.number(f64::from(code) / 65535.0);
        assert!((found - kelvin).abs() < 0.02, "{found}");
    }
    assert_eq!(Encoding::temperature(2500.0).to_u16(&[2500.0]), [65535]);
}
