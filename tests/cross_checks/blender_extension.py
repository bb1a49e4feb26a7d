"""Installs the Blender extension into a Blender without a window and works with it as an artist does.

    python blender_extension.py [PICTURES]

Needs the package `bpy` and `target/release/ruga`; without `bpy` it says so and ends with 0. Pictures go
into the folder PICTURES, if one is given. Checked are, each with what it measures:

- zip and manifest, by Blender's own validator; presets, against `ruga help presets`;
- export: the forearm comes back with the same positions, texture coordinates and shapes;
- bake, and drivers on the way from 0 to 1; poses of two shapes;
- the blend of two poses and a base map as Cycles sees it, against reoriented normal mapping;
- a rendered frame, which changes with a shape key and is plain at rest;
- growths of poses, which properties of the object drive, alone and with a shape, also without shape keys;
- baking again, taking out; a mask from a vertex group; UDIM tiles in and out;
- a bake that is stopped half way, and the next one, which goes on;
- bad input: a message each, with materials and files as they were.

The exit code is 1 where anything differs.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from unittest.mock import MagicMock

REPOSITORY = Path(__file__).resolve().parents[2]
EXTENSION = REPOSITORY / "integrations" / "blender"
RUGA = REPOSITORY / "target" / "release" / ("ruga.exe" if os.name == "nt" else "ruga")
# Blender reads this when it is imported: nothing of the user's own Blender is touched.
HOME = tempfile.TemporaryDirectory(prefix="ruga-blender-")
for kind in ("RESOURCES", "CONFIG", "SCRIPTS", "EXTENSIONS"):
    os.environ[f"BLENDER_USER_{kind}"] = str(Path(HOME.name) / "user" / kind.lower())

try:
    import bpy
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}. `pip install 'bpy==4.2.*' numpy` into a Python 3.11 runs this check")
    sys.exit(0)

sys.dont_write_bytecode = True
sys.path.insert(0, str(EXTENSION))
import package  # noqa: E402 (the module beside the extension)

# Degrees between the blend that Cycles sees and the formula, at most.
BLEND_LIMIT = 0.05
# Metres and texture coordinates that may be lost by an export and an import.
EXPORT_LIMIT = 1e-7
SIZE = 256


class Checks:
    """Counts what is wrong."""

    def __init__(self):
        self.wrong = 0

    def that(self, right, what):
        """Prints one line; counts it where it is wrong."""
        print(f"  {'ok   ' if right else 'WRONG'} {what}", flush=True)
        self.wrong += not right

    def refused(self, words, action):
        """The action ends in a message with these words."""
        try:
            action()
        except RuntimeError as error:
            message = str(error).strip()
            # Blender makes a message of any exception, with the lines that it passed.
            self.that(words in message and "Traceback" not in message, f"refused: {message}")
        else:
            self.that(False, f"not refused, although: {words}")


def addon(module=""):
    """A module of the installed extension."""
    return __import__(f"bl_ext.user_default.ruga{module}", fromlist=["x"])


def preferences():
    return bpy.context.preferences.addons["bl_ext.user_default.ruga"].preferences


def check_package(checks, folder):
    """Zip, manifest and installation."""
    archive = folder / "ruga.zip"
    package.package(archive)
    tool = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core/bl_pkg/cli/blender_ext.py"
    said = subprocess.run(
        [sys.executable, tool, "validate", archive], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    checks.that(said.returncode == 0, f"Blender's validator: {said.stdout.strip().splitlines()[-1]}".replace(str(folder), ""))
    bpy.ops.extensions.package_install_files(filepath=str(archive), repo="user_default", enable_on_install=True)
    checks.that("bl_ext.user_default.ruga" in bpy.context.preferences.addons.keys(), "installed and switched on")
    listed = subprocess.run([RUGA, "help", "presets"], capture_output=True, text=True, check=True).stdout
    # Those of creases and growths follow under headings of their own.
    of_layers = listed.partition("\n# Presets of creases")[0]
    names = set(re.findall(r"^## `(.+)`", of_layers, re.MULTILINE))
    own = {name for name, _ in addon(".presets").PRESETS}
    checks.that(own == names, f"{len(own)} presets, those of `ruga help presets`")
    preferences().program = str(RUGA)


def fresh(folder, name):
    """A new .blend with the forearm; its object, active."""
    bpy.ops.wm.read_homefile(use_factory_startup=False, use_empty=True)
    (folder / name).mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / name / "file.blend"))
    bpy.ops.import_scene.gltf(filepath=str(REPOSITORY / "assets/forearm/forearm.glb"))
    subject = next(found for found in bpy.context.selected_objects if found.type == "MESH")
    bpy.context.view_layer.objects.active = subject
    subject.ruga.size, subject.ruga.quality, subject.ruga.threads = str(SIZE), "DRAFT", 1
    bpy.ops.ruga.add_layer()
    return subject


def choose(subject, *shapes):
    """Ticks these shapes alone."""
    bpy.ops.ruga.tick_shapes(use=False)
    for shape in subject.ruga.shapes:
        shape.use = shape.name in shapes


def out_folder(subject):
    return addon(".bake").result_folder(subject)


def table(mesh):
    """A row per vertex, ordered by texture coordinates: u, v, position, position in every shape."""
    uv = np.zeros((len(mesh.vertices), 2))
    for loop, found in zip(mesh.loops, mesh.uv_layers[0].uv):
        uv[loop.vertex_index] = found.vector
    columns = [uv]
    for block in sorted(mesh.shape_keys.key_blocks, key=lambda block: block.name):
        columns.append(np.array([point.co for point in block.data]))
    rows = np.hstack(columns)
    return rows[np.lexsort((np.round(uv[:, 1], 5), np.round(uv[:, 0], 5)))]


def check_export(checks, folder):
    """What goes out through the extension and in through Blender's importer is the same."""
    subject = fresh(folder, "export")
    before, shapes = table(subject.data), subject.data.shape_keys.key_blocks.keys()
    objects, meshes = len(bpy.data.objects), len(bpy.data.meshes)
    subject.data.shape_keys.key_blocks["twist"].value = 0.4
    bpy.ops.ruga.export()
    left = [len(bpy.data.objects) - objects, len(bpy.data.meshes) - meshes]
    checks.that(left == [0, 0] and bpy.context.object == subject, "no object is left over, the selection is as it was")
    work = addon(".bake").work_folder(subject)
    first = (work / "mesh.glb").read_bytes()
    bpy.ops.ruga.export()
    checks.that(first == (work / "mesh.glb").read_bytes(), "a second export writes the same bytes")
    bpy.ops.import_scene.gltf(filepath=str(work / "mesh.glb"))
    again = bpy.context.selected_objects[0].data
    checks.that(again.shape_keys.key_blocks.keys() == shapes, f"shapes {', '.join(shapes[1:])}")
    after = table(again)
    off = np.abs(after - before).max() if after.shape == before.shape else np.inf
    checks.that(off < EXPORT_LIMIT, f"positions, texture coordinates, shapes of {len(after)} vertices: off by {off:.1e}")

    bpy.ops.object.select_all(action="DESELECT")
    subject.select_set(True)
    bpy.context.view_layer.objects.active = subject
    subject.scale, bpy.context.scene.unit_settings.scale_length = (-50.0, 50.0, 50.0), 0.01
    bpy.context.view_layer.update()
    bpy.ops.ruga.export()
    # Blender's importer converts from metres itself.
    bpy.context.scene.unit_settings.scale_length = 1.0
    bpy.ops.import_scene.gltf(filepath=str(work / "mesh.glb"))
    small = table(bpy.context.selected_objects[0].data)
    off = np.abs(small[:, 2:] * np.tile([-2.0, 2.0, 2.0], before.shape[1] // 3) - before[:, 2:]).max()
    checks.that(off < EXPORT_LIMIT, f"scale 50, mirrored, in a scene in centimetres: off by {off:.1e} m")
    said = subprocess.run([RUGA, "check", work / "scene.toml"], capture_output=True, text=True)
    checks.that(said.returncode == 0, f"ruga check: {said.stdout.strip().splitlines()[-1] if said.stdout else said.stderr}")


def factors(group):
    """The driven factors by pose and key, as the renderer gets them."""
    bpy.context.view_layer.update()
    evaluated = group.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return {
        (node["ruga_pose"], node["ruga_key"]): node.inputs[0].default_value
        for node in evaluated.nodes
        if "ruga_pose" in node
    }


def check_drivers(checks, subject):
    """Factors of both keys along the way of a shape; the expressions run without Python."""
    group, block = subject.ruga.group, subject.data.shape_keys.key_blocks["compress"]
    wanted = {0.0: (0, 0), 0.25: (0.5, 0), 0.5: (1, 0), 0.75: (1, 0.5), 1.0: (1, 1)}
    worst = 0.0
    for value, (half, full) in wanted.items():
        block.value = value
        found = factors(group)
        worst = max(worst, abs(found["compress", 0.5] - half), abs(found["compress", 1.0] - full))
        worst = max(worst, found["pinch", 0.5], found["pinch", 1.0])
    block.value = 0.0
    checks.that(worst < 1e-6, f"factors at 0, .25, .5, .75, 1 are off by {worst:.1e}")
    curves = group.animation_data.drivers
    checks.that(all(c.is_valid and c.driver.is_simple_expression for c in curves), f"{len(curves)} drivers, all simple expressions")


def check_pair(checks, subject, folder):
    """A pose of two shapes, from a folder that came from elsewhere, follows the one that lags."""
    elsewhere = folder / "elsewhere"
    shutil.copytree(out_folder(subject), elsewhere)
    manifest = json.loads((elsewhere / "wrinkles.json").read_text())
    manifest["poses"]["compress"] = {"compress": 0.8, "pinch": 0.5}
    (elsewhere / "wrinkles.json").write_text(json.dumps(manifest))
    bpy.ops.ruga.load(directory=str(elsewhere))
    blocks = subject.data.shape_keys.key_blocks
    blocks["compress"].value, blocks["pinch"].value = 0.6, 0.125
    found = factors(subject.ruga.group)
    off = max(abs(found["compress", 0.5] - 0.5), found["compress", 1.0])
    checks.that(off < 1e-6, f"compress .6 of .8 with pinch .125 of .5 is a quarter: off by {off:.1e}")
    blocks["compress"].value = blocks["pinch"].value = 0.0
    bpy.ops.ruga.load(directory=str(out_folder(subject)))


def pixels(image):
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], -1)[..., :3].astype(float)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def laid_over(base, detail):
    """Reoriented normal mapping, as docs/results.md wants it."""
    t, u = base + [0.0, 0.0, 1.0], detail * [-1.0, -1.0, 1.0]
    return unit(t * (t * u).sum(-1, keepdims=True) - u * t[..., 2:])


def read_map(subject, name):
    image = bpy.data.images.load(str(out_folder(subject) / "maps" / name))
    image.colorspace_settings.name = "Non-Color"
    return 2.0 * pixels(image) - 1.0


def base_map():
    """A normal map of gentle waves, as an artist's."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE * 40.0
    waves = unit(np.stack([0.3 * np.sin(x), 0.3 * np.cos(1.7 * y), np.ones_like(x)], axis=-1))
    image = bpy.data.images.new("base", SIZE, SIZE, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    colours = np.ones((SIZE, SIZE, 4), np.float32)
    colours[..., :3] = 0.5 * waves + 0.5
    image.pixels.foreach_set(colours.ravel())
    image.pack()
    return image, waves


def wear_base(subject):
    """The artist's material: a normal map at strength .7 into the Principled BSDF."""
    material = bpy.data.materials.new("skin")
    material.use_nodes = True
    subject.data.materials.clear()
    subject.data.materials.append(material)
    tree = material.node_tree
    texture, normal = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeNormalMap")
    texture.image, waves = base_map()
    normal.inputs["Strength"].default_value = 0.7
    tree.links.new(texture.outputs["Color"], normal.inputs["Color"])
    tree.links.new(normal.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])
    return tree, waves


def seen_by_cycles(subject):
    """The group's colour baked into the UV map: what the renderer makes of nodes and drivers."""
    tree = subject.active_material.node_tree
    group = next(node for node in tree.nodes if node.get("ruga") == "group")
    end = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    shader = end.inputs["Surface"].links[0].from_socket
    glow, target = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexImage")
    target.image = bpy.data.images.new("seen", SIZE, SIZE, float_buffer=True)
    target.image.colorspace_settings.name = "Non-Color"
    tree.links.new(group.outputs["Color"], glow.inputs["Color"])
    tree.links.new(glow.outputs["Emission"], end.inputs["Surface"])
    tree.nodes.active = target
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.render.threads_mode = "CYCLES", 1, "FIXED"
    scene.render.threads = 1
    bpy.ops.object.bake(type="EMIT", margin=0)
    seen = pixels(target.image)
    tree.links.new(shader, end.inputs["Surface"])
    tree.nodes.remove(glow)
    tree.nodes.remove(target)
    # Texels without skin stay black; those at its border have the mean of both.
    skin = seen.max(axis=-1) > 0.1
    for axis in (0, 1):
        skin = skin & np.roll(skin, 2, axis) & np.roll(skin, -2, axis)
    return unit(2.0 * seen - 1.0), skin


def check_blend(checks, subject, waves):
    """Two poses between keys, over a base at strength .7, wrinkles at strength 1.3."""
    blocks = subject.data.shape_keys.key_blocks
    blocks["compress"].value, blocks["pinch"].value = 0.75, 0.2
    subject.ruga.group.nodes["Strength"].outputs[0].default_value = 1.3
    up = np.array([0.0, 0.0, 1.0])
    wanted = unit(up + 0.7 * (waves - up))
    maps = {name: read_map(subject, f"{name}_normal.png") for name in ("compress_50", "compress_100", "pinch_50")}
    details = (0.5 * (maps["compress_50"] + maps["compress_100"]), 0.6 * up + 0.4 * maps["pinch_50"])
    for detail in details:
        wanted = laid_over(wanted, unit(detail * [1.3, 1.3, 1.0]))
    seen, skin = seen_by_cycles(subject)
    angles = np.degrees(2.0 * np.arcsin(np.linalg.norm(seen - wanted, axis=-1)[skin] / 2))
    tilt = np.degrees(np.arccos(np.clip(wanted[skin][..., 2], -1, 1)))
    blocks["compress"].value = blocks["pinch"].value = 0.0
    subject.ruga.group.nodes["Strength"].outputs[0].default_value = 1.0
    rms = np.sqrt(np.mean(angles**2))
    checks.that(
        angles.max() < BLEND_LIMIT,
        f"Cycles - formula: {rms:.5f} degrees RMS, {angles.max():.5f} at most; the blend tilts by {tilt.max():.0f}",
    )


def light_and_camera(subject):
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 16, False
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x = scene.render.resolution_y = 256
    corners = [subject.matrix_world @ point.co for point in subject.data.vertices]
    middle = sum(corners, corners[0] * 0.0) / len(corners)
    normal = subject.data.polygons[0].normal
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.11
    camera.data.clip_start = 0.001
    camera.location = middle + normal * 0.5
    camera.rotation_euler = normal.to_track_quat("Z", "Y").to_euler()
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3.0
    sun.rotation_euler = camera.rotation_euler
    sun.rotation_euler.rotate_axis("Y", -0.6)
    sun.rotation_euler.rotate_axis("X", -0.4)
    for found in (camera, sun):
        scene.collection.objects.link(found)
    scene.camera = camera


def frame(folder, name):
    """Renders and reads the picture back."""
    scene = bpy.context.scene
    scene.render.filepath = str(folder / name)
    bpy.ops.render.render(write_still=True)
    return pixels(bpy.data.images.load(str(folder / name)))


def check_frames(checks, subject, pictures):
    """Frames with and without wrinkles: the same at rest, different in the pose."""
    light_and_camera(subject)
    block, strength = subject.data.shape_keys.key_blocks["compress"], subject.ruga.group.nodes["Strength"].outputs[0]
    off = {}
    for value in (0.0, 0.5, 1.0):
        block.value = value
        shown = frame(pictures, f"compress_{100 * value:.0f}.png")
        strength.default_value = 0.0
        plain = frame(pictures, f"compress_{100 * value:.0f}_plain.png")
        strength.default_value = 1.0
        off[value] = np.sqrt(np.mean((shown - plain) ** 2))
    block.value = 0.0
    text = ", ".join(f"{difference:.4f} at {value:g}" for value, difference in off.items())
    checks.that(off[0.0] < 1e-3 < 0.01 < off[0.5] < off[1.0], f"frame with - without wrinkles, RMS of 1: {text}")


def shape_of(tree):
    """Nodes and links of a material, to be compared."""
    nodes = sorted((node.name, node.bl_idname) for node in tree.nodes)
    links = sorted((l.from_node.name, l.from_socket.name, l.to_node.name, l.to_socket.name) for l in tree.links)
    return nodes, links


def check_work(checks, folder, pictures):
    """From the artist's material to the rendered frame, and back."""
    subject = fresh(folder, "work")
    choose(subject, "compress", "pinch")
    tree, waves = wear_base(subject)
    before = shape_of(tree)
    started = time.monotonic()
    bpy.ops.ruga.bake()
    maps = sorted(path.name for path in (out_folder(subject) / "maps").iterdir())
    checks.that(len(maps) == 4, f"baked in {time.monotonic() - started:.1f} s: {', '.join(maps)}")
    check_drivers(checks, subject)
    check_pair(checks, subject, folder)
    check_blend(checks, subject, waves)
    wired = shape_of(tree)
    check_frames(checks, subject, pictures)
    tree.nodes.new("ShaderNodeValue").name = "the artist's"
    started = time.monotonic()
    bpy.ops.ruga.bake()
    nodes = [node for node in shape_of(tree)[0] if node[0] != "the artist's"]
    checks.that(
        (nodes, shape_of(tree)[1]) == wired and "the artist's" in tree.nodes,
        f"baked again in {time.monotonic() - started:.1f} s: the same nodes, and the artist's are left",
    )
    tree.nodes.remove(tree.nodes["the artist's"])
    bpy.ops.ruga.remove()
    checks.that(shape_of(tree) == before, "taken out: the material is as it was")
    checks.that(not any(group.name.startswith("ruga") for group in bpy.data.node_groups), "no node group is left")
    subject.data.materials.clear()
    bpy.ops.ruga.load(directory=str(out_folder(subject)))
    checks.that(len(subject.data.materials) == 1, "an object without a material gets one")
    bpy.ops.wm.save_mainfile()
    paths = [node.image.filepath for node in subject.ruga.group.nodes if node.type == "TEX_IMAGE"]
    checks.that(all(path.startswith("//") for path in paths), f"paths are relative: {paths[0]}")


def check_panel(checks, folder):
    """The panel's code runs on a layout that takes everything: no window is there to draw in."""
    subject = fresh(folder, "panel")
    panel, names = addon(".panel"), []
    for kind, mask in (("PRESET", "GROUP"), ("WAVELENGTH", "IMAGE")):
        subject.ruga.layers[0].kind, subject.ruga.layers[0].mask_kind = kind, mask
        for draw in (panel.draw_layers, panel.draw_shapes, panel.draw_bake, panel.draw_results):
            layout = MagicMock()
            draw(layout, subject)
            column = layout.column.return_value
            names += [call.args[1] for call in [*column.prop.call_args_list, *layout.prop.call_args_list]]
            for call in [*column.prop.call_args_list, *layout.prop.call_args_list]:
                getattr(*call.args[:2])
    checks.that("wavelength" in names and "quality" in names, f"the panel shows {len(set(names))} settings")
    shapes = ["smile_L", "smile_R", "jawLeft", "jawRight", "blink"]
    poses = list(addon(".scene_file").poses_of_shapes(shapes, True))
    checks.that(poses == ["smile", "jawLeft", "jawRight", "blink"], f"left and right together: {', '.join(poses)}")


def check_mask(checks, folder):
    """Skin by wavelength in the left half, painted as a vertex group."""
    subject = fresh(folder, "mask")
    choose(subject, "compress")
    layer = subject.ruga.layers[0]
    layer.kind, layer.wavelength, layer.critical_strain = "WAVELENGTH", 0.008, 4.0
    layer.mask_kind, layer.vertex_group = "GROUP", "left"
    group = subject.vertex_groups.new(name="left")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh = subject.data
    left = {loop.vertex_index for loop, uv in zip(mesh.loops, mesh.uv_layers[0].uv) if uv.vector.x < 0.5}
    group.add(sorted(left), 1.0, "REPLACE")
    bpy.ops.ruga.bake()
    normals = unit(read_map(subject, "compress_100_normal.png"))
    tilt = np.degrees(np.arccos(np.clip(normals[..., 2], -1, 1)))
    inside, outside = tilt[:, : SIZE * 4 // 10].mean(), tilt[:, SIZE * 6 // 10 :].max()
    checks.that(inside > 3.0 and outside < 0.1, f"tilt inside the mask {inside:.1f} degrees on average, outside at most {outside:.2f}")
    layer.mask_kind, layer.image = "IMAGE", bpy.data.images.new("black", 64, 64)
    layer.image.pixels.foreach_set(np.tile([0.0, 0.0, 0.0, 1.0], 64 * 64).astype(np.float32))
    before = shape_of(subject.active_material.node_tree)
    checks.refused("ruga", bpy.ops.ruga.bake)
    checks.that(shape_of(subject.active_material.node_tree) == before, "the material is as it was")


def check_tiles(checks, folder):
    """The right half of the skin in UDIM tile 1002, masked by a vertex group, and its tiled maps."""
    subject = fresh(folder, "tiles")
    choose(subject, "compress")
    mesh = subject.data
    tiled = mesh.uv_layers[0]
    # What is baked into for the comparison: the texture as it was.
    plain = mesh.uv_layers.new(name="plain")
    for face in mesh.polygons:
        is_right = np.mean([tiled.uv[loop].vector.x for loop in face.loop_indices]) > 0.5
        for loop in face.loop_indices:
            plain.uv[loop].vector = tiled.uv[loop].vector
            if is_right:
                tiled.uv[loop].vector.x += 1.0
    mesh.uv_layers.active = tiled
    subject.ruga.uv_map = tiled.name
    group = subject.vertex_groups.new(name="all")
    group.add(range(len(mesh.vertices)), 1.0, "REPLACE")
    layer = subject.ruga.layers[0]
    layer.mask_kind, layer.vertex_group = "GROUP", "all"
    bpy.ops.ruga.bake()
    masks = sorted(file.name for file in (out_folder(subject).parent / "masks").iterdir())
    checks.that(masks == ["skin.1001.png", "skin.1002.png"], f"masks: {', '.join(masks)}")
    images = [image for image in bpy.data.images if image.source == "TILED"]
    tiles = {tuple(tile.number for tile in image.tiles) for image in images}
    checks.that(len(images) == 2 and tiles == {(1001, 1002)}, f"{len(images)} tiled images with tiles {tiles}")
    bpy.ops.ruga.load(directory=str(out_folder(subject)))
    again = [image for image in bpy.data.images if image.source == "TILED"]
    checks.that(len(again) == 2, "loaded again, the images are the same ones")
    halves = [read_map(subject, f"compress_100_normal.{tile}.png") for tile in (1001, 1002)]
    wanted = unit(np.hstack([halves[0][:, : SIZE // 2], halves[1][:, SIZE // 2 :]]))
    mesh.shape_keys.key_blocks["compress"].value = 1.0
    mesh.uv_layers.active = plain
    seen, skin = seen_by_cycles(subject)
    # Beside the cut padding is read, as it is beside every seam.
    skin[:, SIZE // 2 - 2 : SIZE // 2 + 2] = False
    angles = np.degrees(2.0 * np.arcsin(np.linalg.norm(seen - wanted, axis=-1)[skin] / 2))
    tilts = [np.degrees(np.arccos(half[..., 2].min())) for half in halves]
    checks.that(
        angles.max() < BLEND_LIMIT and min(tilts) > 10.0,
        f"Cycles - maps: {angles.max():.5f} degrees at most; the tiles tilt by {tilts[0]:.0f} and {tilts[1]:.0f}",
    )


def check_growth(checks, folder):
    """A growth alone and with a shape, baked elsewhere: a property of the object is how much of it there is."""
    subject = fresh(folder, "growth")
    choose(subject, "compress")
    bpy.ops.ruga.export()
    work = addon(".bake").work_folder(subject)
    scene = work / "scene.toml"
    with scene.open("a") as file:
        file.write(
            '\n[[growths]]\nname = "dry \'out\'"\nalong = 0.08\nacross = 0.0\n'
            '\n[[poses]]\nname = "dry"\ngrowths = { "dry \'out\'" = 1.0 }\n'
            '\n[[poses]]\nname = "both"\nweights = { compress = 0.5 }\ngrowths = { "dry \'out\'" = 1.0 }\n'
        )
    said = subprocess.run(
        [RUGA, "bake", scene, "-o", out_folder(subject), "--quality", "draft", "--threads", "1", "--pose", "dry", "--pose", "both"],
        capture_output=True, text=True,
    )
    checks.that(said.returncode == 0, f"baked: {said.stderr.strip().splitlines()[-1]}")
    bpy.ops.ruga.load(directory=str(out_folder(subject)))
    name, blocks = "ruga dry 'out'", subject.data.shape_keys.key_blocks
    checks.that(subject.get(name) == 0.0, f"the object has the property `{name}`, at 0")
    worst = 0.0
    for growth, shape, dry, both in ((0, 0, 0, 0), (0.25, 0, 0.5, 0), (0.75, 0.125, 1.5, 0.5), (1, 0.5, 2, 2), (1, 0.2, 2, 0.8)):
        subject[name], blocks["compress"].value = float(growth), shape
        subject.update_tag()
        found = factors(subject.ruga.group)
        # The factors of both keys add up to twice the way.
        ways = {pose: found[pose, 0.5] + found[pose, 1.0] for pose in ("dry", "both")}
        worst = max(worst, abs(ways["dry"] - dry), abs(ways["both"] - both))
    checks.that(worst < 1e-6, f"factors of the growth, alone and with a shape, are off by {worst:.1e}")
    curves = subject.ruga.group.animation_data.drivers
    simple = all(curve.is_valid and curve.driver.is_simple_expression for curve in curves)
    checks.that(simple, f"{len(curves)} drivers, all simple expressions")
    blocks["compress"].value = 0.0
    seen, skin = seen_by_cycles(subject)
    wanted = unit(read_map(subject, "dry_100_normal.png"))
    angles = np.degrees(2.0 * np.arcsin(np.linalg.norm(seen - wanted, axis=-1)[skin] / 2))
    tilt = np.degrees(np.arccos(wanted[skin][..., 2].min()))
    checks.that(angles.max() < BLEND_LIMIT and tilt > 10.0, f"Cycles - map: {angles.max():.5f} degrees at most; it tilts by {tilt:.0f}")
    bpy.ops.ruga.load(directory=str(out_folder(subject)))
    checks.that(subject[name] == 1.0, "loaded again, the property keeps its value")

    subject.shape_key_clear()
    checks.refused("no shape key `compress`", lambda: bpy.ops.ruga.load(directory=str(out_folder(subject))))
    manifest = json.loads((out_folder(subject) / "wrinkles.json").read_text())
    manifest["maps"] = [entry for entry in manifest["maps"] if entry["pose"] == "dry"]
    for table_of in ("poses", "growths"):
        manifest[table_of].pop("both")
    (out_folder(subject) / "wrinkles.json").write_text(json.dumps(manifest))
    bpy.ops.ruga.load(directory=str(out_folder(subject)))
    found = factors(subject.ruga.group)
    checks.that(found == {("dry", 0.5): 1.0, ("dry", 1.0): 1.0}, "a mesh without shape keys shows it, too")


def check_stop(checks, folder):
    """Stops after the first of three poses; the next bake makes the others alone."""
    subject = fresh(folder, "stop")
    subject.ruga.quality = "STANDARD"
    bake = addon(".bake").Bake(bpy.context, subject)
    fractions = [0.0]
    while not bake.poll():
        fractions.append(bake.fraction())
        if bake.progress and bake.progress.ended and not bake.cancelled:
            checks.that(len(bake.progress.ended) == 1, f"stopped at {100 * bake.fraction():.0f} %: {bake.progress.text()}")
            bake.cancel()
        time.sleep(0.02)
    checks.that(fractions == sorted(fractions) and fractions[-1] <= 1.0, f"progress only grows: {len(set(fractions))} values")
    kept = bake.wire()
    whole = [path for path in out_folder(subject).rglob("*") if path.is_file()]
    checks.that(1 <= len(kept) < 3 and not any("tmp" in path.name for path in whole), f"kept and wired: {', '.join(kept)}")
    first = out_folder(subject) / "maps" / f"{kept[0]}_100_normal.png"
    time_before = first.stat().st_mtime_ns
    bpy.ops.ruga.bake()
    found = {pose for pose, _ in factors(subject.ruga.group)}
    checks.that(len(found) == 3 and first.stat().st_mtime_ns == time_before, "the next bake completes it and leaves what was there")


def check_refusals(checks, folder):
    """Bad input: a message each, and nothing changed."""
    subject = fresh(folder, "refusals")
    choose(subject, "compress")
    bpy.ops.ruga.bake()
    tree = subject.active_material.node_tree
    before = shape_of(tree)

    preferences().program = ""
    path, os.environ["PATH"] = os.environ["PATH"], ""
    checks.refused("not on the PATH", bpy.ops.ruga.bake)
    os.environ["PATH"] = path
    preferences().program = str(folder / "nowhere")
    checks.refused("is not a program", bpy.ops.ruga.bake)
    preferences().program = str(RUGA)

    subject.ruga.keys = "0.5, 2"
    checks.refused("Keys:", bpy.ops.ruga.bake)
    subject.ruga.keys = "0.5, 1"
    subject.ruga.layers[0].mask_kind = "GROUP"
    checks.refused("vertex group", bpy.ops.ruga.bake)
    subject.ruga.layers[0].mask_kind = "NONE"
    subject.ruga.folder = ""
    checks.refused("Choose a folder", bpy.ops.ruga.bake)
    subject.ruga.folder = "//ruga/"

    broken = folder / "broken"
    shutil.copytree(out_folder(subject), broken)
    (broken / "maps" / "compress_50_normal.png").unlink()
    (broken / "maps" / "compress_100_normal.png").write_bytes(b"")
    checks.refused("2 maps are missing or empty", lambda: bpy.ops.ruga.load(directory=str(broken)))
    for key in ("50", "100"):
        (broken / "maps" / f"compress_{key}_normal.png").write_bytes(b"\x89PNG\r\n\x1a\n and no more")
    checks.refused("cannot be read", lambda: bpy.ops.ruga.load(directory=str(broken)))
    (broken / "wrinkles.json").write_text("{}")
    checks.refused("is not as ruga writes it", lambda: bpy.ops.ruga.load(directory=str(broken)))
    checks.refused("wrinkles.json is not there", lambda: bpy.ops.ruga.load(directory=str(folder)))
    block = subject.data.shape_keys.key_blocks["compress"]
    block.name = "other"
    checks.refused("no shape key `compress`", lambda: bpy.ops.ruga.load(directory=str(out_folder(subject))))
    block.name = "compress"
    checks.that(shape_of(tree) == before, "the material is as it was")
    unfinished = [path.name for path in (folder / "refusals").rglob(".writing*")]
    checks.that(not unfinished, "no unfinished file is left")

    bpy.ops.ruga.remove()
    odd = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(odd.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])
    checks.refused("only a Normal Map node", lambda: bpy.ops.ruga.load(directory=str(out_folder(subject))))
    while subject.data.uv_layers:
        subject.data.uv_layers.remove(subject.data.uv_layers[0])
    checks.refused("no UV map", bpy.ops.ruga.bake)
    subject.shape_key_clear()
    checks.refused("no shape keys", bpy.ops.ruga.bake)
    bpy.ops.wm.read_homefile(use_factory_startup=False, use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(REPOSITORY / "assets/forearm/forearm.glb"))
    bpy.ops.ruga.add_layer()
    checks.refused("Save the .blend", bpy.ops.ruga.bake)


def main(pictures):
    folder = Path(HOME.name).resolve()
    pictures = pictures or folder
    pictures.mkdir(parents=True, exist_ok=True)
    checks = Checks()
    parts = (check_package, check_export, check_work, check_panel, check_mask, check_tiles, check_growth, check_stop, check_refusals)
    for part in parts:
        print(part.__name__.removeprefix("check_"))
        part(checks, folder, *([pictures] if part is check_work else []))
    print(f"Blender {bpy.app.version_string}: {checks.wrong} wrong")
    return 1 if checks.wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else None))
