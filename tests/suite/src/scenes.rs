//! Random small scenes with everything that they name.

use std::fmt::Write;
use std::path::Path;

use super::{Chance, EXR_CHANNELS, FuzzSheet, GltfParts, PNG_COLOURS, PngChunks, put, sound_exr};

/// Side of the sheets, m, before they are made odd.
const SIDE: f64 = 0.09;

/// What an image is for.
#[derive(Clone, Copy)]
enum Paint {
    Grey,
    Packed,
}

/// A scene and its files. Most are sound; what is simulated has some hundred vertices.
#[derive(Clone, Debug)]
pub struct FuzzScene {
    sheet: FuzzSheet,
    /// Whether the sheet encloses a body.
    is_body: bool,
    binary: bool,
    tables: Vec<String>,
    /// Painted images by name.
    images: Vec<(String, Vec<u8>)>,
}

impl FuzzScene {
    /// A scene of these choices.
    pub fn new(chance: &mut Chance) -> Self {
        let is_body = chance.one_in(4);
        let mut scene = Self {
            sheet: match is_body {
                true => FuzzSheet::block(SIDE, chance),
                false => FuzzSheet::sound(SIDE, chance),
            },
            is_body,
            binary: chance.one_in(2),
            tables: Vec::new(),
            images: Vec::new(),
        };
        scene.name_oddly(chance);
        scene.tables.push("version = 1\n".to_owned());
        scene.add_driver(chance);
        scene.add_layers(chance);
        if is_body {
            scene.add_interior(chance);
        }
        scene.add_poses(chance);
        scene.add_settings(chance);
        scene
    }

    /// The sheet, to make it odd.
    pub fn sheet_mut(&mut self) -> &mut FuzzSheet {
        &mut self.sheet
    }

    /// The text of the scene.
    pub fn toml(&self) -> String {
        self.tables.join("\n")
    }

    /// Its other files by name.
    pub fn files(&self) -> Vec<(String, Vec<u8>)> {
        let mut files = self.images.clone();
        if self.binary {
            files.push((
                "sheet.glb".to_owned(),
                GltfParts::plain(&self.sheet).to_glb(),
            ));
            return files;
        }
        let obj = |positions| self.sheet.obj(positions).into_bytes();
        files.push(("sheet.obj".to_owned(), obj(&self.sheet.positions)));
        for (name, positions) in &self.sheet.shapes {
            files.push((format!("{name}.obj"), obj(positions)));
        }
        files
    }

    /// Writes the scene and its files.
    pub fn write(&self, folder: &Path) {
        put(folder, "scene.toml", self.toml());
        for (name, bytes) in self.files() {
            put(folder, &name, bytes);
        }
    }

    /// Names of shapes are file names and keys, too.
    fn name_oddly(&mut self, chance: &mut Chance) {
        if !self.binary || !chance.one_in(5) {
            return;
        }
        let at = chance.below(self.sheet.shapes.len());
        let odd = [
            "",
            " ",
            "a/b",
            "..",
            "../x",
            "CON",
            "squeeze",
            "a\\b",
            "brow \u{e9}",
            "a\nb",
            ".x",
            "a.b",
        ];
        self.sheet.shapes[at].0 = match chance.one_in(12) {
            true => "x".repeat(300),
            false => chance.pick(&odd).to_owned(),
        };
    }

    fn add_driver(&mut self, chance: &mut Chance) {
        let mut table = String::from("[driver]\n");
        if self.binary {
            table += "mesh = \"sheet.glb\"\n";
        } else {
            table += "mesh = \"sheet.obj\"\n[driver.targets]\n";
            for (name, _) in &self.sheet.shapes {
                let _ = writeln!(table, "{name} = \"{name}.obj\"");
            }
            // Keys after a sub-table would belong to it.
            table = table.replace("[driver.targets]\n", "targets = { ");
            table = table.replace(".obj\"\n", ".obj\", ");
            table = table.replacen("sheet.obj\", ", "sheet.obj\"\n", 1);
            table.truncate(table.len() - 2);
            table += " }\n";
        }
        let region = match chance.below(8) {
            0 => self.add_image("mask", Paint::Grey, chance),
            1 | 2 => "auto".to_owned(),
            _ => "all".to_owned(),
        };
        let _ = writeln!(table, "region = \"{region}\"\nvertex_budget = 600");
        if chance.one_in(4) {
            table += "smoothing = \"none\"\n";
        }
        self.tables.push(table);
    }

    /// An image that has one of these kinds of colour, or rarely any.
    fn add_image(&mut self, name: &str, kind: Paint, chance: &mut Chance) -> String {
        let (colours, channels): (&[u8], &[&[&str]]) = match kind {
            _ if chance.one_in(12) => (&PNG_COLOURS, &EXR_CHANNELS),
            Paint::Grey => (&[0, 4], &[&["Y"]]),
            Paint::Packed => (&[2, 6], &[&["R", "G", "B"], &["R", "G", "B", "A"]]),
        };
        let (extension, bytes) = match chance.below(3) {
            0 => ("exr", sound_exr(channels, chance)),
            _ => ("png", PngChunks::sound(colours, chance).to_bytes()),
        };
        let file = format!("{name}{}.{extension}", self.images.len());
        self.images.push((file.clone(), bytes));
        file
    }

    fn add_layers(&mut self, chance: &mut Chance) {
        if !chance.one_in(3) {
            self.tables.push(format!(
                "[substrate]\nyoung = {:e}\npoisson = {}\nthickness = {:e}\n",
                chance.magnitude(3.5, 5.5),
                chance.pick(&["0.48", "0.3", "0.499", "0", "-0.5"]),
                chance.magnitude(-3.0, -1.5),
            ));
        } else {
            self.tables.push("[substrate]\n".to_owned());
        }
        // A body has one.
        let count = match self.is_body {
            true => 1,
            false => [1, 1, 1, 1, 2, 2, 2, 3][chance.below(8)],
        };
        // Keys of the scene itself come before its tables.
        let stacks: &[&str] = match count {
            2 => &["nominal", "composite", "joint"],
            _ => &["nominal", "composite"],
        };
        let nominal = chance.one_in(2);
        if !nominal {
            let stack = chance.pick(stacks);
            self.tables[0] += &format!("stack = \"{stack}\"\n");
        }
        for index in 0..count {
            let table = self.layer(index, nominal, chance);
            self.tables.push(table);
        }
    }

    fn layer(&mut self, index: usize, nominal: bool, chance: &mut Chance) -> String {
        let mut table = format!("[[layers]]\nname = \"layer{index}\"\n");
        let finer = 0.6_f64.powi(index as i32);
        // The others may wrinkle so finely on what lies below that planning takes its time.
        let kind = if index == 0 { chance.below(12) } else { 2 };
        match kind {
            0 => table += "preset = \"forehead-furrow\"\n",
            1 => {
                let (young, thickness) = (chance.magnitude(5.0, 8.0), chance.magnitude(-3.7, -2.5));
                let _ = writeln!(table, "young = {young:e}\nthickness = {thickness:e}");
            }
            _ => {
                let (length, strain) = (
                    finer * chance.between(0.025, 0.06),
                    chance.between(0.01, 0.1),
                );
                let _ = writeln!(table, "wavelength = {length}\ncritical_strain = {strain}");
            }
        }
        let mut word = |key: &str, words: &[&str], chance: &mut Chance| {
            if chance.one_in(3) {
                let _ = writeln!(table, "{key} = \"{}\"", chance.pick(words));
            }
        };
        word("coupling", &["constraint", "elastic", "hybrid"], chance);
        word("sampling", &["area", "adjusted", "quadrature"], chance);
        word("model", &["layer", "half-space", "cerda-mahadevan"], chance);
        if chance.one_in(4) {
            let _ = writeln!(table, "density = {:e}", chance.magnitude(1.0, 5.0));
        }
        if index > 0 && chance.one_in(3) {
            let _ = writeln!(table, "bending_transfer = {}", chance.between(0.0, 1.0));
        }
        // Other stacks know uniform layers only.
        if (nominal && chance.one_in(3)) || chance.one_in(20) {
            let property = chance.pick(&["wavelength", "young", "thickness"]);
            let (image, file) = match chance.one_in(2) {
                true => (
                    "image".to_owned(),
                    self.add_image("paint", Paint::Packed, chance),
                ),
                false => (
                    format!("{property}_image"),
                    self.add_image("paint", Paint::Grey, chance),
                ),
            };
            let [low, high] = [chance.between(0.4, 1.0), chance.between(1.0, 2.0)];
            let sharp = if chance.one_in(2) {
                ", sharp = true"
            } else {
                ""
            };
            let wrap = if chance.one_in(3) {
                ", wrap = \"repeat\""
            } else {
                ""
            };
            let _ = writeln!(
                table,
                "map = {{ {image} = \"{file}\", {property} = [{low}, {high}]{sharp}{wrap} }}"
            );
        }
        table
    }

    fn add_interior(&mut self, chance: &mut Chance) {
        let mut table = format!(
            "[interior]\ncells = {}\nfollow = {:e}\n",
            1 + chance.below(4),
            chance.magnitude(4.0, 7.0)
        );
        if chance.one_in(4) {
            table += "shape = \"linear\"\n";
        }
        if chance.one_in(3) {
            let pull = chance.between(-10.0, 10.0);
            let _ = writeln!(table, "gravity = [0.0, {pull}, -9.81]");
        }
        if chance.one_in(2) {
            let end = chance.between(-0.4, 0.5) * SIDE;
            let _ = writeln!(
                table,
                "[[interior.handles]]\nname = \"foot\"\nmin = [-1.0, -1.0, -1.0]\nmax = [{end}, 1.0, 1.0]"
            );
        }
        let below = -SIDE * chance.between(0.2, 1.0);
        let _ = writeln!(
            table,
            "[[interior.obstacles]]\nname = \"table\"\nplane = {{ point = [0.0, 0.0, {below}], normal = [0.0, 0.0, 1.0] }}"
        );
        if chance.one_in(2) {
            let radius = SIDE * chance.between(0.1, 0.5);
            let above = radius + SIDE * chance.between(-0.05, 0.2);
            let _ = writeln!(
                table,
                "[[interior.obstacles]]\nname = \"ball\"\nsphere = {{ centre = [0.0, 0.0, {above}], radius = {radius} }}"
            );
        }
        self.tables.push(table);
    }

    fn add_poses(&mut self, chance: &mut Chance) {
        if chance.one_in(6) {
            return;
        }
        let count = 1 + usize::from(chance.one_in(4));
        for index in 0..count {
            let mut weights = Vec::new();
            for (name, _) in &self.sheet.shapes {
                if weights.is_empty() || chance.one_in(2) {
                    // JSON's strings are TOML's.
                    let key = serde_json::json!(name);
                    weights.push(format!("{key} = {}", chance.between(-0.3, 1.3)));
                }
            }
            let motions = match self.is_body {
                true => format!(
                    "motions = [{{ of = \"{}\", at = {}, move = [0.0, {}, {}] }}]\n",
                    chance.pick(&["foot", "table", "table", "ball"]),
                    chance.pick(&["1.0", "0.4"]),
                    chance.between(-0.01, 0.01),
                    chance.between(-0.01, 0.02),
                ),
                false => String::new(),
            };
            let keys = chance.pick(&["[1.0]", "[1.0]", "[0.5, 1.0]", "[0.3, 0.6]", "[1.0, 0.1]"]);
            self.tables.push(format!(
                "[[poses]]\nname = \"pose{index}\"\nweights = {{ {} }}\n{motions}keys = {keys}\nsteps = {}\n",
                weights.join(", "),
                1 + chance.below(2),
            ));
        }
    }

    fn add_settings(&mut self, chance: &mut Chance) {
        let mut table = String::from("[solver]\n");
        if chance.one_in(5) {
            let (step, damping) = (chance.magnitude(-3.0, 0.0), chance.magnitude(-1.0, 2.0));
            let _ = writeln!(
                table,
                "mode = \"dynamic\"\ntime_step = {step:e}\ndamping = {damping}"
            );
        }
        if chance.one_in(4) {
            let _ = writeln!(
                table,
                "tolerance = {:e}\nseed = {}",
                chance.magnitude(-12.0, -1.0),
                chance.below(99)
            );
        }
        self.tables.push(table);
        let mut table = format!(
            "[remesh]\npoints_per_wavelength = {}\n",
            3 + chance.below(4)
        );
        if chance.one_in(5) {
            table += "enabled = false\n";
        }
        if chance.one_in(4) {
            let _ = writeln!(table, "aspect = {}", chance.between(1.0, 4.0));
        }
        if chance.one_in(5) {
            let longest = chance.magnitude(-2.3, 0.0);
            let _ = writeln!(
                table,
                "max_edge = {longest}\nmin_edge = {}",
                longest * chance.between(0.0, 0.9)
            );
        }
        self.tables.push(table);
        let mut table = format!("[bake]\nsize = {}\n", 16 + chance.below(32));
        let _ = writeln!(table, "padding = {}", chance.below(6));
        let mut word = |key: &str, words: &[&str]| {
            if chance.one_in(3) {
                let _ = writeln!(table, "{key} = {}", chance.pick(words));
            }
        };
        word("format", &["\"png8\"", "\"png16\"", "\"exr\""]);
        word("frame", &["\"driver\"", "\"mesh\""]);
        word("normal_y", &["\"+\"", "\"-\""]);
        word(
            "maps",
            &["[\"normal\"]", "[\"height\"]", "[\"height\", \"normal\"]"],
        );
        word("supersample", &["1", "2", "4"]);
        self.tables.push(table);
    }
}
