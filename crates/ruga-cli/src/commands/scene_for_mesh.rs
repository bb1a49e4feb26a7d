//! The text of a scene for somebody's own mesh.

use std::fmt::Write as _;
use std::path::{Component, Path};

use ruga_blend::{Driver, face_strains};
use ruga_io::{IoError, MeshFile, ObjOptions, read_mesh};
use ruga_material::{PRESETS, Preset, preset};
use ruga_mesh::face_areas;
use ruga_scene::file::usable_file_name;
use ruga_scene::mesh_size::{is_unlikely, length, likely_scale, width};
use ruga_scene::{counted, driver_of};

use crate::error::CliError;

/// Poses that the scene has; the other shapes stand beside them as comments.
const MOST_POSES: usize = 4;

/// A mesh with what a scene for it needs to know.
pub(crate) struct OwnMesh {
    file: MeshFile,
    driver: Driver,
    /// The meshes of the file, if it has several.
    names: Vec<String>,
}

impl OwnMesh {
    /// Reads a mesh; of several in a file the one with the most blend shapes.
    ///
    /// # Errors
    /// [`CliError::NothingToPose`], and what the file is refused for.
    pub(crate) fn read(path: &Path) -> Result<Self, CliError> {
        let read = |name: Option<&str>| read_mesh(path, name, &ObjOptions::default());
        let (file, names) = match read(None) {
            Ok(file) => (file, Vec::new()),
            Err(IoError::MeshNotChosen { names, path }) => {
                let files = names.iter().filter_map(|name| read(Some(name)).ok());
                // The first of equals: `max_by_key` would take the last.
                let most = files.rev().max_by_key(|file| file.mesh.shapes.len());
                match most {
                    Some(file) => (file, names),
                    None => return Err(IoError::MeshNotChosen { names, path }.into()),
                }
            }
            Err(error) => return Err(error.into()),
        };
        if file.mesh.shapes.is_empty() {
            return Err(CliError::NothingToPose { mesh: file.path });
        }
        let driver = driver_of(&file)?;
        Ok(Self {
            file,
            driver,
            names,
        })
    }

    /// A scene in `folder`, which exists, with comments for somebody who sees it for the first time.
    ///
    /// # Errors
    /// [`CliError::Output`] when the way from the folder to the mesh cannot be written.
    pub(crate) fn scene(&self, folder: &Path) -> Result<String, CliError> {
        let mesh = way(folder, &self.file.path)?;
        let skin = self.preset();
        let mut text = self.introduction();
        let _ = write!(text, "version = 1\n\n[driver]\nmesh = {}\n", quoted(&mesh));
        self.write_name(&mut text);
        self.write_scale(&mut text);
        text.push_str(
            "# Skin is simulated where a pose compresses it enough to wrinkle. To keep it to a part, \
             paint a\n# grey image over the UV square, white where skin is simulated, and write its \
             path here.\nregion = \"auto\"\n\n",
        );
        write_layer(&mut text, skin);
        self.write_poses(&mut text, skin);
        text.push_str("[bake]\nsize = 2048\nmaps = [\"normal\", \"height\"]\nformat = \"png16\"\n");
        Ok(text)
    }

    fn introduction(&self) -> String {
        let shapes = counted(self.file.mesh.shapes.len(), "blend shape");
        format!(
            "# Wrinkles for a mesh with {shapes}, {} wide.\n\
             #\n\
             # In this folder:\n\
             #   ruga plan scene.toml\n\
             #   ruga bake scene.toml -o out\n\
             #\n\
             # `ruga help scene` explains every key. Lengths are metres, moduli pascals.\n\n",
            length(self.metres() * width(&self.file))
        )
    }

    /// Metres per unit of the file, as far as the size of the mesh tells.
    fn metres(&self) -> f64 {
        self.guess().map_or(1.0, |(_, scale)| scale)
    }

    fn guess(&self) -> Option<(&'static str, f64)> {
        let width = width(&self.file);
        likely_scale(width).filter(|_| is_unlikely(width))
    }

    fn write_name(&self, text: &mut String) {
        let name = &self.file.mesh.name;
        let again = read_mesh(&self.file.path, Some(name), &ObjOptions::default());
        if again.is_err() {
            return;
        }
        if !self.names.is_empty() {
            let names: Vec<String> = self.names.iter().map(|name| quoted(name)).collect();
            let _ = writeln!(text, "# The file has {}.", names.join(", "));
        }
        let _ = writeln!(text, "mesh_name = {}", quoted(name));
    }

    fn write_scale(&self, text: &mut String) {
        let Some((_, scale)) = self.guess() else {
            return;
        };
        let width = width(&self.file);
        let _ = writeln!(
            text,
            "# Metres per unit of the file: without this the mesh would be {} wide. Please check.\n\
             scale = {scale}",
            length(width)
        );
    }

    /// A plain choice by the name of the mesh; furrows of the forehead where it says nothing.
    fn preset(&self) -> &'static Preset {
        let stem = self.file.path.file_stem().unwrap_or_default();
        let name = format!("{} {}", self.file.mesh.name, stem.to_string_lossy()).to_lowercase();
        let has = |words: &[&str]| words.iter().any(|word| name.contains(word));
        let choice = if has(&["hand", "finger", "knuckle", "palm"]) {
            "knuckle"
        } else if has(&["neck"]) {
            "neck"
        } else {
            "forehead-furrow"
        };
        preset(choice).unwrap_or(&PRESETS[0])
    }

    fn write_poses(&self, text: &mut String, skin: &Preset) {
        text.push_str(
            "# Maps are baked half way to each pose and at the full pose. Without any pose every \
             blend shape\n# is one. A pose may mix shapes: weights = { smile = 1.0, blink = 0.5 }\n",
        );
        let mut names = Vec::new();
        for shape in self.driver.shape_names() {
            names.push(usable_file_name(shape, &names));
        }
        let shapes: Vec<&str> = self.driver.shape_names().collect();
        let ranked = self.most_compressing_first(skin);
        for (place, index) in ranked.into_iter().enumerate() {
            let mark = if place < MOST_POSES { "" } else { "# " };
            if place == MOST_POSES {
                text.push_str("# The other shapes; take the marks away from those you want.\n");
            }
            let (name, shape) = (quoted(&names[index]), quoted(shapes[index]));
            let _ = write!(
                text,
                "{mark}[[poses]]\n{mark}name = {name}\n{mark}weights = {{ {shape} = 1.0 }}\n\n"
            );
        }
    }

    /// The shapes by the area that they compress beyond the critical strain of the skin.
    fn most_compressing_first(&self, skin: &Preset) -> Vec<usize> {
        let critical = ruga_material::wrinkling(
            &skin.layer,
            &skin.substrate,
            ruga_material::WavelengthModel::default(),
        );
        let critical = critical.map_or(0.05, |wave| wave.critical_strain);
        let driver = &self.driver;
        let areas = face_areas(driver.topology(), driver.rest());
        let compressed = |shape: &str| -> f64 {
            let weights = driver.weights([(shape, 1.0)]);
            let posed = driver.pose(&weights.expect("one of the driver's shapes"));
            let strains = face_strains(driver.topology(), driver.rest(), &posed);
            strains
                .iter()
                .filter(|(_, strain)| strain.effective(skin.layer.poisson) > critical)
                .map(|(face, _)| areas[face])
                .sum()
        };
        let areas: Vec<f64> = driver.shape_names().map(compressed).collect();
        let mut order: Vec<usize> = (0..areas.len()).collect();
        order.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]));
        order
    }
}

fn write_layer(text: &mut String, skin: &Preset) {
    text.push_str("# What the skin is made of. All of it starts as one preset; the others are:\n");
    for other in PRESETS.iter().filter(|other| other.name != skin.name) {
        let _ = writeln!(text, "#   {:20} {}", other.name, other.description);
    }
    let _ = write!(
        text,
        "# Its own mask and strength: mask = \"mask.png\", strength = 0.5\n[[layers]]\nname = \"skin\"\n\
         # {}\npreset = {}\n\n",
        skin.description,
        quoted(skin.name)
    );
}

/// A TOML string: what JSON escapes, TOML reads.
fn quoted(text: &str) -> String {
    let json = serde_json::Value::from(text).to_string();
    json.replace('\u{7f}', "\\u007f")
}

/// The relative path from a folder to a file, with `/` on every system; absolute where there is none.
fn way(folder: &Path, file: &Path) -> Result<String, CliError> {
    let wrong = |reason: String| CliError::Output {
        path: folder.to_owned(),
        reason,
    };
    let whole = |path: &Path| {
        path.canonicalize()
            .map_err(|error| wrong(error.to_string()))
    };
    let (folder, file) = (whole(folder)?, whole(file)?);
    let (from, to): (Vec<Component<'_>>, Vec<_>) =
        (folder.components().collect(), file.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let text = |path: &Path| {
        let text = path.to_str().map(str::to_owned);
        text.ok_or_else(|| wrong(format!("{} is not UTF-8", path.display())))
    };
    // Nothing shared: another drive. The root alone: a path from there is plainer.
    if shared <= 1 {
        return text(&file);
    }
    let mut parts = vec!["..".to_owned(); from.len() - shared];
    for component in &to[shared..] {
        parts.push(text(Path::new(component.as_os_str()))?);
    }
    Ok(parts.join("/"))
}
