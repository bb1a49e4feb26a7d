//! Small sheets of triangles with blend shapes: what scenes are made of, in every odd variant.

use std::fmt::Write;

use nalgebra::{Vector2, Vector3};

use super::Chance;

/// A grid of triangles with texture coordinates and shapes, vertices shared.
#[derive(Clone, Debug)]
pub struct FuzzSheet {
    /// Positions in units of the file.
    pub positions: Vec<Vector3<f64>>,
    /// Texture coordinates, V up as in OBJ; none if the sheet has none.
    pub uvs: Option<Vec<Vector2<f64>>>,
    /// Corners of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Posed positions of every blend shape.
    pub shapes: Vec<(String, Vec<Vector3<f64>>)>,
}

/// What the sheet is bent to.
#[derive(Clone, Copy)]
enum Bend {
    Flat,
    Cylinder,
    Sphere,
}

impl FuzzSheet {
    /// A sound sheet of `side` (m), flat or bent, with one to three shapes that squeeze it.
    pub fn sound(side: f64, chance: &mut Chance) -> Self {
        let cells = [3 + chance.below(4), 3 + chance.below(4)];
        Self::grid(side, cells, chance)
    }

    /// A closed block: such a sheet, a copy of it below, and strips between them, a chart each.
    pub fn block(side: f64, chance: &mut Chance) -> Self {
        let cells = [3 + chance.below(4), 3 + chance.below(4)];
        let depth = side * chance.between(0.2, 0.6);
        Self::grid(side, cells, chance).closed(cells, depth)
    }

    fn grid(side: f64, cells: [usize; 2], chance: &mut Chance) -> Self {
        let bend = [Bend::Flat, Bend::Cylinder, Bend::Sphere][chance.below(3)];
        let places: Vec<Vector2<f64>> = (0..=cells[1])
            .flat_map(|j| (0..=cells[0]).map(move |i| (i, j)))
            .map(|(i, j)| Vector2::new(i as f64 / cells[0] as f64, j as f64 / cells[1] as f64))
            .collect();
        let on = |place: &Vector2<f64>| bent(bend, place.x - 0.5, place.y - 0.5) * side;
        let mut sheet = Self {
            positions: places.iter().map(on).collect(),
            // A margin, so that padding has a place to go.
            uvs: Some(
                places
                    .iter()
                    .map(|p| p * 0.9 + Vector2::repeat(0.05))
                    .collect(),
            ),
            triangles: grid_triangles(cells).collect(),
            shapes: Vec::new(),
        };
        for name in ["squeeze", "twist", "fold"]
            .iter()
            .take(1 + chance.below(3))
        {
            let [x, y, turn] = match *name {
                "squeeze" => [chance.between(0.75, 1.05), chance.between(0.9, 1.1), 0.0],
                "twist" => [1.0, 1.0, chance.between(-0.5, 0.5)],
                _ => [chance.between(0.5, 0.95), 1.0, chance.between(-0.1, 0.1)],
            };
            let posed = sheet.positions.iter().map(|p| {
                let (sin, cos) = (turn * p.y / side).sin_cos();
                Vector3::new(x * (cos * p.x - sin * p.z), y * p.y, sin * p.x + cos * p.z)
            });
            let posed = posed.collect();
            sheet.shapes.push(((*name).to_owned(), posed));
        }
        sheet
    }

    /// A grid of these cells and its copy `depth` below.
    fn closed(&self, [columns, rows]: [usize; 2], depth: f64) -> Self {
        let at = |i: usize, j: usize| j * (columns + 1) + i;
        // Around the border, from corner to corner.
        let borders: [Vec<usize>; 4] = [
            (0..=columns).map(|i| at(i, 0)).collect(),
            (0..=rows).map(|j| at(columns, j)).collect(),
            (0..=columns).rev().map(|i| at(i, rows)).collect(),
            (0..=rows).rev().map(|j| at(0, j)).collect(),
        ];
        let level = |row: &[usize], depth: f64| -> Vec<(usize, f64)> {
            row.iter().map(|&vertex| (vertex, depth)).collect()
        };
        let below: Vec<usize> = (0..=rows)
            .flat_map(|j| (0..=columns).rev().map(move |i| at(i, j)))
            .collect();
        let all: Vec<usize> = (0..self.positions.len()).collect();
        let mut charts = vec![
            ([columns, rows], level(&all, 0.0)),
            ([columns, rows], level(&below, depth)),
        ];
        for border in &borders {
            let strip = [level(border, depth), level(border, 0.0)].concat();
            charts.push(([border.len() - 1, 1], strip));
        }
        let (mut from, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for (number, (cells, vertices)) in charts.into_iter().enumerate() {
            let first = from.len() as u32;
            triangles.extend(grid_triangles(cells).map(|t| t.map(|v| first + v)));
            for place in 0..vertices.len() {
                let [i, j] = [place % (cells[0] + 1), place / (cells[0] + 1)];
                let [u, v] = [(i, cells[0]), (j, cells[1])]
                    .map(|(k, count)| 0.05 + 0.9 * k as f64 / count as f64);
                uvs.push(Vector2::new((number as f64 + u) / 6.0, v));
            }
            from.extend(vertices);
        }
        let lowered = |positions: &Vec<Vector3<f64>>| -> Vec<Vector3<f64>> {
            let place = |&(vertex, depth): &(usize, f64)| positions[vertex] - Vector3::z() * depth;
            from.iter().map(place).collect()
        };
        let shapes = self.shapes.iter();
        Self {
            positions: lowered(&self.positions),
            uvs: Some(uvs),
            triangles,
            shapes: shapes
                .map(|(name, positions)| (name.clone(), lowered(positions)))
                .collect(),
        }
    }

    /// Makes the sheet odd in one of the ways in which artists' meshes are.
    pub fn make_odd(&mut self, chance: &mut Chance) {
        let vertices = self.positions.len();
        let vertex = chance.below(vertices);
        let face = chance.below(self.triangles.len());
        match chance.below(14) {
            // A triangle without area, or nearly so.
            0 => {
                let [a, b, _] = self.triangles[face].map(|v| v as usize);
                let share = chance.pick(&[&0.0, &1e-9, &1e-4]);
                self.move_towards(a, b, *share);
            }
            1 => self.triangles[face][1] = self.triangles[face][0],
            // Vertices in the same place, split or not.
            2 => self.double_vertex(vertex, face),
            3 => {
                let copy = self.triangles[face];
                self.triangles.push(copy);
            }
            4 => self.triangles[face].swap(1, 2),
            5 => drop(self.triangles.remove(face)),
            // Three faces at an edge, or two fans at a vertex.
            6 => self.triangles.push([
                self.triangles[face][0],
                self.triangles[face][1],
                vertex as u32,
            ]),
            7 => self.triangles = self.triangles.split_off(chance.below(self.triangles.len())),
            8 => self.scale(chance.magnitude(-12.0, 12.0)),
            9 => self.uvs = None,
            10 => self.change_uvs(vertex, chance),
            11 => {
                let shift = Vector3::repeat(chance.magnitude(-2.0, 8.0));
                self.each_position(|p| *p += shift);
            }
            12 => {
                let amount = chance.magnitude(-6.0, -1.0);
                let [x, y] = [chance.between(-1.0, 1.0), chance.between(-1.0, 1.0)];
                self.positions[vertex] += Vector3::new(x, y, x * y) * amount;
            }
            _ => {
                let at = chance.below(self.shapes.len());
                let wild = chance.wild_float();
                self.shapes[at].1[vertex].x = wild;
            }
        }
        if self.triangles.is_empty() {
            self.triangles.push([0, 1, 2]);
        }
    }

    fn move_towards(&mut self, from: usize, to: usize, share: f64) {
        let all = self.shapes.iter_mut().map(|shape| &mut shape.1);
        for positions in std::iter::once(&mut self.positions).chain(all) {
            positions[from] = positions[to] + (positions[from] - positions[to]) * share;
        }
    }

    fn double_vertex(&mut self, vertex: usize, face: usize) {
        let number = self.positions.len() as u32;
        self.positions.push(self.positions[vertex]);
        for (_, positions) in &mut self.shapes {
            positions.push(positions[vertex]);
        }
        if let Some(uvs) = &mut self.uvs {
            uvs.push(uvs[vertex]);
        }
        for corner in &mut self.triangles[face] {
            if *corner == vertex as u32 {
                *corner = number;
            }
        }
    }

    fn change_uvs(&mut self, vertex: usize, chance: &mut Chance) {
        let Some(uvs) = &mut self.uvs else {
            return;
        };
        match chance.below(5) {
            0 => uvs.iter_mut().for_each(|uv| *uv *= 3.0),
            1 => uvs.iter_mut().for_each(|uv| *uv -= Vector2::repeat(0.5)),
            2 => uvs.iter_mut().for_each(|uv| *uv *= 0.0),
            3 => uvs.iter_mut().for_each(|uv| uv.x = 1.0 - uv.x),
            _ => uvs[vertex].x = chance.wild_float(),
        }
    }

    fn scale(&mut self, factor: f64) {
        self.each_position(|p| *p *= factor);
    }

    fn each_position(&mut self, change: impl Fn(&mut Vector3<f64>)) {
        let shapes = self.shapes.iter_mut().flat_map(|shape| &mut shape.1);
        self.positions.iter_mut().chain(shapes).for_each(change);
    }

    /// The sheet as OBJ with the given positions, those at rest or those of a shape.
    pub fn obj(&self, positions: &[Vector3<f64>]) -> String {
        let mut text = String::from("o Sheet\n");
        // Writing to a string cannot fail.
        for p in positions {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        for uv in self.uvs.iter().flatten() {
            let _ = writeln!(text, "vt {} {}", uv.x, uv.y);
        }
        for triangle in &self.triangles {
            text.push('f');
            for corner in triangle.map(|v| v + 1) {
                let _ = match self.uvs {
                    Some(_) => write!(text, " {corner}/{corner}"),
                    None => write!(text, " {corner}"),
                };
            }
            text.push('\n');
        }
        text
    }
}

fn bent(bend: Bend, x: f64, y: f64) -> Vector3<f64> {
    match bend {
        Bend::Flat => Vector3::new(x, y, 0.0),
        Bend::Cylinder => Vector3::new(x.sin(), y, x.cos() - 1.0),
        Bend::Sphere => Vector3::new(x.sin() * y.cos(), y.sin(), x.cos() * y.cos() - 1.0),
    }
}

fn grid_triangles([columns, rows]: [usize; 2]) -> impl Iterator<Item = [u32; 3]> {
    let at = move |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    (0..rows)
        .flat_map(move |j| (0..columns).map(move |i| (i, j)))
        .flat_map(move |(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
}
