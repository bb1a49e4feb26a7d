"""The mesh and the scene file for `ruga`, written from a Blender object."""

import re
from collections.abc import Iterable
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from .errors import RugaError
from .masks import group_masks, group_weights, image_masks, save_grey
from .results import UDIM
from .scene_file import Layer, Scene, check_carriers, parse_keys, poses_of_shapes, scene_text, whole_file

MESH_FILE = "mesh.glb"
SCENE_FILE = "scene.toml"
# Characters that ruga refuses in names, as they would become part of a file's path.
FORBIDDEN = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|.]')


def export(context: bpy.types.Context, subject: bpy.types.Object, folder: Path) -> Path:
    """Writes mesh, masks and scene into `folder`; returns the path of the scene.

    All that can be refused is looked at before the first file is written.
    """
    check_subject(subject)
    if subject.mode != "OBJECT":
        # Changes made in edit mode reach the mesh, and what masks are drawn from, only on leaving it.
        bpy.ops.object.mode_set(mode="OBJECT")
    settings = subject.ruga
    uv_map = chosen_uv_map(subject)
    shapes = chosen_shapes(subject)
    keys = parse_keys(settings.keys)
    layers, masks = chosen_layers(subject, uv_map)
    poses: dict[str, dict[str, float]] = {}
    for name, weights in poses_of_shapes(shapes, settings.join_sides).items():
        poses[unused(legal_name(name), poses)] = weights

    for name, values in masks.items():
        save_grey(values, folder / name)
    mesh_name = write_mesh(context, subject, uv_map, folder / MESH_FILE)
    scene = Scene(MESH_FILE, mesh_name, layers, poses, keys, int(settings.size))
    with whole_file(folder / SCENE_FILE) as unfinished:
        unfinished.write_text(scene_text(scene), encoding="utf-8", newline="\n")
    return folder / SCENE_FILE


def check_subject(subject: bpy.types.Object | None) -> None:
    """Refuses to bake what has no shapes or no texture coordinates."""
    if subject is None or subject.type != "MESH":
        raise RugaError("Select a mesh object with shape keys")
    keys = subject.data.shape_keys
    if keys is None or len(keys.key_blocks) < 2:
        raise RugaError(f"`{subject.name}` has no shape keys: wrinkles are those of its shape keys")
    check_shown(subject)


def check_shown(subject: bpy.types.Object) -> None:
    """Refuses to show maps on a mesh without texture coordinates; growths need no shape keys."""
    keys = subject.data.shape_keys
    if keys is not None and not keys.use_relative:
        raise RugaError(f"`{subject.name}` has absolute shape keys: switch on Relative under Shape Keys")
    if not subject.data.uv_layers:
        raise RugaError(f"`{subject.name}` has no UV map: unwrap it, as maps are baked into its UV map")


def chosen_uv_map(subject: bpy.types.Object) -> str:
    """The name of the UV map to bake into: the one chosen, or the one that is rendered."""
    layers, chosen = subject.data.uv_layers, subject.ruga.uv_map
    if chosen and chosen not in layers:
        raise RugaError(f"`{subject.name}` has no UV map `{chosen}`: choose another one")
    return chosen or next((layer.name for layer in layers if layer.active_render), layers[0].name)


def chosen_shapes(subject: bpy.types.Object) -> list[str]:
    """Names of the shape keys to bake; all but the basis if the list was never filled."""
    blocks = subject.data.shape_keys.key_blocks
    basis = subject.data.shape_keys.reference_key.name
    listed = {shape.name: shape.use for shape in subject.ruga.shapes}
    shapes = [block.name for block in blocks if block.name != basis and listed.get(block.name, True)]
    if not shapes:
        raise RugaError(f"No shape key of `{subject.name}` is chosen: tick those to bake")
    return shapes


def legal_name(name: str) -> str:
    """A shape's name as the name of a pose."""
    return FORBIDDEN.sub("_", name).strip() or "pose"


def unused(name: str, taken: Iterable[str]) -> str:
    """The name, numbered if it is taken; letter case does not count, as in file names."""
    lower, number, free = {other.lower() for other in taken}, 1, name
    while free.lower() in lower:
        number += 1
        free = f"{name}_{number}"
    return free


def chosen_layers(subject: bpy.types.Object, uv_map: str) -> tuple[list[Layer], dict[str, np.ndarray]]:
    """The layers, bottom first, and the masks that they name."""
    if not subject.ruga.layers:
        raise RugaError(f"`{subject.name}` has no layer of skin: add one")
    layers: list[Layer] = []
    masks: dict[str, np.ndarray] = {}
    for entry in subject.ruga.layers:
        name = legal_name(entry.name)
        if name.lower() in {layer.name.lower() for layer in layers}:
            raise RugaError(f"Two layers are called `{name}`: rename one")
        layer = Layer(name, strength=entry.strength, zone=legal_name(entry.zone) if entry.zone else None)
        if entry.kind == "PRESET":
            layer.preset = entry.preset
        else:
            layer.wavelength, layer.critical_strain = entry.wavelength, entry.critical_strain / 100.0
        tiles = masks_of(subject, entry, uv_map)
        if list(tiles) == [1001]:
            layer.mask = f"masks/{name}.png"
            masks[layer.mask] = tiles[1001]
        elif tiles:
            layer.mask = f"masks/{name}.{UDIM}.png"
            masks |= {f"masks/{name}.{tile}.png": values for tile, values in tiles.items()}
        layers.append(layer)
    check_carriers(layers)
    return layers, masks


def masks_of(subject: bpy.types.Object, entry: bpy.types.PropertyGroup, uv_map: str) -> dict[int, np.ndarray]:
    """Grey values of a layer's mask by UDIM tile, 1001 alone without tiles; empty where it has no mask."""
    if entry.mask_kind == "GROUP":
        group = subject.vertex_groups.get(entry.vertex_group)
        if group is None:
            raise RugaError(f"Layer `{entry.name}`: there is no vertex group `{entry.vertex_group}`: choose one")
        return group_masks(subject.data, group, uv_map)
    if entry.mask_kind == "IMAGE":
        if entry.image is None:
            raise RugaError(f"Layer `{entry.name}`: choose an image as its mask")
        return image_masks(entry.image)
    return {}


def write_mesh(context: bpy.types.Context, subject: bpy.types.Object, uv_map: str, path: Path) -> str:
    """Writes the mesh as GLB, in metres, without modifiers and materials; returns its name there."""
    copy = plain_copy(context, subject, uv_map)
    mesh, selected, active = copy.data, context.selected_objects, context.view_layer.objects.active
    context.scene.collection.objects.link(copy)
    try:
        for other in selected:
            other.select_set(False)
        copy.select_set(True)
        context.view_layer.objects.active = copy
        with whole_file(path) as unfinished:
            export_selected(unfinished)
            if not unfinished.is_file():
                raise RugaError(f"Blender's glTF exporter wrote no {path.name}; its messages are in the console")
    except RuntimeError as error:
        raise RugaError(f"Blender's glTF exporter failed: {error}") from error
    finally:
        name = mesh.name
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)
        for other in selected:
            other.select_set(True)
        context.view_layer.objects.active = active
    return name


def export_selected(path: Path) -> None:
    """Calls Blender's exporter for what is selected."""
    bpy.ops.export_scene.gltf(
        filepath=str(path),
        export_format="GLB",
        use_selection=True,
        export_apply=False,
        export_yup=True,
        export_texcoords=True,
        export_normals=True,
        export_tangents=False,
        export_materials="NONE",
        export_attributes=False,
        export_extras=False,
        export_animations=False,
        export_skins=False,
        export_morph=True,
        # ruga computes the normals of posed meshes itself.
        export_morph_normal=False,
        export_morph_tangent=False,
        export_cameras=False,
        export_lights=False,
    )


def plain_copy(context: bpy.types.Context, subject: bpy.types.Object, uv_map: str) -> bpy.types.Object:
    """A copy that stands at the origin at its size in metres, with one UV map and bare shape keys."""
    copy = subject.copy()
    copy.data = subject.data.copy()
    # The exporter takes what is selected.
    copy.hide_select = copy.hide_viewport = False
    mesh, keys = copy.data, copy.data.shape_keys
    copy.animation_data_clear()
    keys.animation_data_clear()
    copy.modifiers.clear()
    copy.constraints.clear()
    copy.parent = None
    # The name is the same in every export, so that `--resume` knows the file again.
    mesh.name = f"{subject.data.name} for ruga"
    mesh.materials.clear()
    for other in [layer.name for layer in mesh.uv_layers if layer.name != uv_map]:
        mesh.uv_layers.remove(mesh.uv_layers[other])
    apply_shape_groups(copy)
    for block in keys.key_blocks:
        block.mute = False
        block.value = 0.0
    size = subject.matrix_world.copy()
    size.translation = (0.0, 0.0, 0.0)
    metres = Matrix.Scale(context.scene.unit_settings.scale_length, 4)
    mesh.transform(metres @ size, shape_keys=True)
    if size.determinant() < 0.0:
        # A mirrored object would be inside out.
        mesh.flip_normals()
    copy.matrix_world.identity()
    return copy


def apply_shape_groups(copy: bpy.types.Object) -> None:
    """Fades shapes that are limited to a vertex group as Blender does, which glTF cannot say."""
    for block in copy.data.shape_keys.key_blocks:
        group = copy.vertex_groups.get(block.vertex_group) if block.vertex_group else None
        if group is None:
            continue
        weights = group_weights(copy.data, group.index)[:, None]
        shape, rest = (np.empty(3 * len(copy.data.vertices), np.float32) for _ in range(2))
        block.data.foreach_get("co", shape)
        block.relative_key.data.foreach_get("co", rest)
        faded = rest.reshape(-1, 3) + weights * (shape - rest).reshape(-1, 3)
        block.data.foreach_set("co", faded.astype(np.float32).ravel())
        block.vertex_group = ""
