//! Where a mesh stands in the world, and so how long its edges are.

use gltf::json::accessor::Type;
use gltf::json::scene::Node;
use gltf::json::{Index, Root};
use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};

use crate::IoError;
use crate::gltf_container::Container;

/// Relative differences of scale below this are rounding of 32-bit matrices.
const SCALE_ROUNDING: f64 = 1e-5;

/// World transform of a mesh and its symmetric part.
pub(crate) struct Placement {
    /// `S` of the linear part `R S`; exactly identity where lengths do not change.
    pub(crate) stretch: Matrix3<f64>,
    pub(crate) world_from_node: Matrix4<f64>,
    pub(crate) warnings: Vec<String>,
    /// Weights that the node sets for the blend shapes.
    pub(crate) weights: Option<Vec<f32>>,
}

/// The first node that carries the mesh, or identity when none does.
pub(crate) fn placement(container: &Container, mesh: usize) -> Result<Placement, IoError> {
    let nodes = &container.root.nodes;
    let carriers = carriers(&container.root, mesh);
    let Some(&first) = carriers.first() else {
        return Ok(Placement {
            stretch: Matrix3::identity(),
            world_from_node: Matrix4::identity(),
            warnings: Vec::new(),
            weights: None,
        });
    };
    let parents = parents(&container.root);
    let world_from_node = world_transform(container, &parents, first)?;
    let stretch = stretch(container, first, &world_from_node)?;
    let mut warnings = Vec::new();
    if nodes[first].skin.is_some() {
        warnings.push(
            "the mesh has an armature, which does not move it here: the shape in which it was bound is \
             simulated, and the GLB keeps the armature; for another shape, export it as a blend shape"
                .to_owned(),
        );
    }
    for &other in &carriers[1..] {
        let world = world_transform(container, &parents, other)?;
        // A flattened copy elsewhere is no reason to refuse the first.
        let differs = self::stretch(container, other, &world).map_or(true, |s| {
            (s - stretch).norm() > SCALE_ROUNDING * stretch.norm()
        });
        if differs {
            warnings.push(format!(
                "nodes {first} and {other} show the mesh at different scales; the size at the first is simulated; if that is the \
                 wrong one, give `scale` under [driver]"
            ));
        }
    }
    Ok(Placement {
        stretch,
        world_from_node,
        warnings,
        weights: nodes[first].weights.clone(),
    })
}

/// World transform of the node called `name` that carries the mesh, else of the first that does;
/// identity when none does.
pub(crate) fn world_from_named_node(
    container: &Container,
    mesh: usize,
    name: &str,
) -> Result<Matrix4<f64>, IoError> {
    let nodes = &container.root.nodes;
    let carriers = carriers(&container.root, mesh);
    let is_named = |node: &&usize| nodes[**node].name.as_deref() == Some(name);
    match carriers.iter().find(is_named).or(carriers.first()) {
        Some(node) => world_transform(container, &parents(&container.root), *node),
        None => Ok(Matrix4::identity()),
    }
}

/// Nodes that carry the mesh.
fn carriers(root: &Root, mesh: usize) -> Vec<usize> {
    let carries = |node: &Node| node.mesh.is_some_and(|index| index.value() == mesh);
    (0..root.nodes.len())
        .filter(|&i| carries(&root.nodes[i]))
        .collect()
}

fn parents(root: &Root) -> Vec<Option<usize>> {
    let mut parents = vec![None; root.nodes.len()];
    for (i, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(Index::value) {
            if let Some(parent) = parents.get_mut(child) {
                *parent = Some(i);
            }
        }
    }
    parents
}

fn world_transform(
    container: &Container,
    parents: &[Option<usize>],
    node: usize,
) -> Result<Matrix4<f64>, IoError> {
    let nodes = &container.root.nodes;
    let skin = nodes[node].skin.map(|index| index.value());
    // A skinned mesh ignores its own node; at rest its first joint carries it.
    let (start, bind) = match skin {
        Some(skin) => first_joint(container, skin)?,
        None => (node, Matrix4::identity()),
    };
    let mut world = bind;
    let mut at = Some(start);
    for _ in 0..=nodes.len() {
        let Some(i) = at else {
            return Ok(world);
        };
        world = local_transform(container, i)? * world;
        at = parents[i];
    }
    Err(container.malformed(format!("node {node}"), "is its own ancestor"))
}

fn first_joint(container: &Container, skin: usize) -> Result<(usize, Matrix4<f64>), IoError> {
    let element = format!("skin {skin}");
    let found = container
        .root
        .skins
        .get(skin)
        .ok_or_else(|| container.malformed(element.clone(), "does not exist"))?;
    let joint = found
        .joints
        .first()
        .map(Index::value)
        .filter(|joint| *joint < container.root.nodes.len())
        .ok_or_else(|| container.malformed(element, "its first joint is not a node"))?;
    let bind = match found.inverse_bind_matrices {
        Some(index) => {
            let matrices = container.read_vectors::<16>(index, Type::Mat4, "bind matrices")?;
            Matrix4::from_column_slice(&matrices[0])
        }
        None => Matrix4::identity(),
    };
    Ok((joint, bind))
}

fn local_transform(container: &Container, index: usize) -> Result<Matrix4<f64>, IoError> {
    let node = &container.root.nodes[index];
    let matrix = match &node.matrix {
        Some(matrix) => Matrix4::from_column_slice(&matrix.map(f64::from)),
        None => from_parts(node),
    };
    if matrix.iter().all(|entry| entry.is_finite()) {
        Ok(matrix)
    } else {
        Err(container.malformed(format!("node {index}"), "its transform is not finite"))
    }
}

fn from_parts(node: &Node) -> Matrix4<f64> {
    let translation = Vector3::from(node.translation.unwrap_or_default().map(f64::from));
    let scale = Vector3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
    let [x, y, z, w] = node.rotation.unwrap_or_default().0.map(f64::from);
    // Files round to 32 bits: without this a rotation would also scale a little.
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    rotation.to_homogeneous().append_translation(&translation)
        * Matrix4::new_nonuniform_scaling(&scale)
}

/// `S = V diag(sigma) V^T` from the singular values of the linear part.
fn stretch(
    container: &Container,
    node: usize,
    world: &Matrix4<f64>,
) -> Result<Matrix3<f64>, IoError> {
    let linear: Matrix3<f64> = world.fixed_view::<3, 3>(0, 0).into_owned();
    let fault = |reason: &str| container.malformed(format!("node {node}"), reason);
    if linear.iter().any(|entry| !entry.is_finite()) {
        return Err(fault("its world transform is not finite"));
    }
    let decomposition = linear
        .try_svd(false, true, f64::EPSILON, 1000)
        .filter(|svd| svd.singular_values.iter().all(|s| s.is_finite()))
        .ok_or_else(|| fault("its world transform cannot be decomposed"))?;
    let sigma = decomposition.singular_values;
    let (least, most) = (sigma.min(), sigma.max());
    if least <= SCALE_ROUNDING * most || !most.is_normal() {
        return Err(fault("its scale is zero along an axis"));
    }
    if (most - 1.0).abs().max((least - 1.0).abs()) < SCALE_ROUNDING {
        return Ok(Matrix3::identity());
    }
    if most - least < SCALE_ROUNDING * most {
        return Ok(Matrix3::from_diagonal_element(sigma.mean()));
    }
    let v_t = decomposition
        .v_t
        .ok_or_else(|| fault("its world transform cannot be decomposed"))?;
    Ok(v_t.transpose() * Matrix3::from_diagonal(&sigma) * v_t)
}
