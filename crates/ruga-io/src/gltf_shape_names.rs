//! Names of blend shapes, which glTF keeps in `extras`.

use gltf::json::extras::RawValue;
use gltf::json::mesh::Mesh;
use ruga_blend::ArtistMesh;

/// `targetNames` of the mesh; some exporters put them on its primitives.
pub(crate) fn target_names(mesh: &Mesh) -> Vec<String> {
    #[derive(serde::Deserialize)]
    struct Extras {
        #[serde(rename = "targetNames")]
        target_names: Vec<String>,
    }
    let parse = |raw: &RawValue| serde_json::from_str::<Extras>(raw.get()).ok();
    let of_primitive = mesh.primitives.iter().find_map(|p| p.extras.as_deref());
    mesh.extras
        .as_deref()
        .and_then(parse)
        .or_else(|| of_primitive.and_then(parse))
        .map(|extras| extras.target_names)
        .unwrap_or_default()
}

/// Gives every shape a name of its own: the given ones, numbered where they repeat.
pub(crate) fn name_shapes(mesh: &mut ArtistMesh, names: &[String], warnings: &mut Vec<String>) {
    let mut taken: Vec<String> = Vec::new();
    for (i, shape) in mesh.shapes.iter_mut().enumerate() {
        let given = names.get(i).filter(|name| !name.is_empty());
        let base = given.cloned().unwrap_or_else(|| format!("shape_{i}"));
        shape.name = base.clone();
        let mut number = 2;
        while taken.contains(&shape.name) {
            shape.name = format!("{base}_{number}");
            number += 1;
        }
        if shape.name != base {
            let new = &shape.name;
            warnings.push(format!(
                "two blend shapes are named `{base}`; the later one is called `{new}` in scenes and \
                 maps"
            ));
        }
        taken.push(shape.name.clone());
    }
}
