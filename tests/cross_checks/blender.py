"""Compares ruga's normal maps with what Blender bakes from the same wrinkled skin.

    python blender.py BAKED SURFACES [HALVINGS]

BAKED is a folder that `ruga bake` filled, SURFACES one that the example `shown_surfaces` filled from the
same scene. Of every pose that is in both, three normals per texel are compared, all of them Blender's:

- seen: the artist's mesh in the pose, with ruga's map in Cycles' own Normal Map node;
- same mesh: the wrinkled skin baked into its own texture coordinates, without rays;
- rays: the wrinkled skin baked onto the artist's mesh, selected to active, as artists do it.

With HALVINGS the edges of the skin are halved as often before Blender sees it, its new vertices on SciPy's
Clough-Tocher cubics through the old ones: Blender shades triangles with a blend of the normals at their corners, which
is further off the smooth skin than what is compared here.

Angles are in degrees. The exit code is 1 if `seen` misses `same mesh` by more than LIMIT (RMS).
"""

import json
import struct
import sys
from pathlib import Path

import bpy
import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator

# Degrees, RMS over the texels inside the skin.
LIMIT = 0.2
# Texels beside the border of the skin that are left out: padding, one-sided normals, and skin whose place on the
# artist's flat triangles is faded back to that of the border (on the finger .66 degrees RMS with 2 texels, .24 with
# 20, .13 with 40, .09 with 70).
BORDER = 40
# How far above the artist's mesh the rays start, m: more than any wrinkle is high.
EXTRUSION = 3e-3


def import_active(operator, path):
    """Imports a file that holds one mesh; its vertices in Blender's world afterwards, smooth."""
    bpy.ops.object.select_all(action="DESELECT")
    operator(filepath=str(path))
    mesh = next(o for o in bpy.context.selected_objects if o.type == "MESH")
    only(mesh)
    bpy.ops.object.transform_apply()
    return mesh


def only(*objects):
    """Selects these and nothing else; the last one is active."""
    bpy.ops.object.select_all(action="DESELECT")
    for chosen in objects:
        chosen.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]


def artist_mesh(path, weights):
    """The artist's mesh of the baked file, frozen in the pose."""
    mesh = import_active(bpy.ops.import_scene.gltf, path)
    for name, weight in weights.items():
        key = mesh.data.shape_keys.key_blocks[name]
        key.slider_min, key.slider_max = min(key.slider_min, weight), max(key.slider_max, weight)
        key.value = weight
    bpy.ops.object.convert(target="MESH")
    normals = file_normals(path, weights)
    if normals is not None:
        corners = [loop.vertex_index for loop in mesh.data.loops]
        own = np.array([normal.vector for normal in mesh.data.corner_normals])
        say("artist's mesh: Blender's normals - the file's", degrees(own, normals[corners], ...))
        # What is flat at rest is imported with flat shading, which normals alone do not undo.
        bpy.ops.object.shade_smooth()
        mesh.data.normals_split_custom_set_from_vertices(normals)
    return mesh


def file_normals(path, weights):
    """Normals of the posed mesh with the shapes' own changes, which Blender does not read.

    None where a shape of the pose has none.
    """
    glb = path.read_bytes()
    length = struct.unpack_from("<I", glb, 12)[0]
    gltf, binary = json.loads(glb[20 : 20 + length]), glb[28 + length :]
    mesh = gltf["meshes"][0]
    primitive = mesh["primitives"][0]

    def view(part, kind, count):
        start = gltf["bufferViews"][part["bufferView"]].get("byteOffset", 0)
        return np.frombuffer(binary, kind, count, start + part.get("byteOffset", 0))

    def read(number):
        accessor = gltf["accessors"][number]
        count, sparse = accessor["count"], accessor.get("sparse")
        values = np.zeros((count, 3), np.float32)
        if "bufferView" in accessor:
            values[:] = view(accessor, np.float32, 3 * count).reshape(-1, 3)
        if sparse:
            kind = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32}
            kind = kind[sparse["indices"]["componentType"]]
            places = view(sparse["indices"], kind, sparse["count"])
            changed = view(sparse["values"], np.float32, 3 * sparse["count"])
            values[places] = changed.reshape(-1, 3)
        return values

    normals = read(primitive["attributes"]["NORMAL"]).astype(float)
    for name, weight in weights.items():
        target = primitive["targets"][mesh["extras"]["targetNames"].index(name)]
        if "NORMAL" not in target:
            return None
        normals += weight * read(target["NORMAL"])
    # Blender's world has Z up.
    upright = normals[:, [0, 2, 1]] * [1, -1, 1]
    return upright / np.linalg.norm(upright, axis=1, keepdims=True)


def skin_mesh(path, halvings):
    """The wrinkled skin as maps show it, with smooth shading and no normals but Blender's own."""
    skin = import_active(bpy.ops.wm.obj_import, path)
    if halvings:
        refine(skin, halvings)
    bpy.ops.object.shade_smooth()
    return skin


def refine(skin, halvings):
    """Replaces a mesh of triangles by a finer one on smooth cubics over its texture coordinates."""
    corners = np.empty(3 * len(skin.data.polygons), int)
    skin.data.loops.foreach_get("vertex_index", corners)
    address = np.empty(2 * len(corners), np.float32)
    skin.data.uv_layers.active.data.foreach_get("uv", address)
    place = np.empty(3 * len(skin.data.vertices), np.float32)
    skin.data.vertices.foreach_get("co", place)
    # A vertex on a seam of the texture has several addresses, and becomes as many vertices.
    keys = np.column_stack([corners, address.reshape(-1, 2)])
    unique, triangles = np.unique(keys, axis=0, return_inverse=True)
    address = unique[:, 1:]
    place = place.reshape(-1, 3)[unique[:, 0].astype(int)].astype(float)
    smooth = CloughTocher2DInterpolator(address, place)
    triangles = triangles.reshape(-1, 3)
    for _ in range(halvings):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
        pairs, middle = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
        a, b, c = triangles.T
        ab, bc, ca = middle.reshape(-1, 3).T + len(address)
        address = np.concatenate([address, address[pairs].mean(axis=1)])
        place = np.concatenate([place, place[pairs].mean(axis=1)])
        split = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = np.concatenate([np.column_stack(part) for part in split])
    # Outside of all triangles, on the border, a middle stays on its edge.
    on_cubics = smooth(address)
    place = np.where(np.isnan(on_cubics), place, on_cubics)
    finer = bpy.data.meshes.new("finer")
    finer.from_pydata(place.tolist(), [], triangles.tolist())
    layer = finer.uv_layers.new()
    layer.data.foreach_set("uv", address[triangles.ravel()].astype(np.float32).ravel())
    skin.data = finer


def new_material(mesh):
    """Replaces the materials of a mesh by an empty one; returns its nodes and links."""
    material = bpy.data.materials.new("check")
    material.use_nodes = True
    mesh.data.materials.clear()
    mesh.data.materials.append(material)
    material.node_tree.nodes.clear()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.new("ShaderNodeOutputMaterial")
    return nodes, links


def wear_map(mesh, image):
    """Shades a mesh with a normal map, as an artist would connect it."""
    nodes, links = new_material(mesh)
    texture, normal = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeNormalMap")
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    texture.image, texture.interpolation = image, "Closest"
    links.new(texture.outputs["Color"], normal.inputs["Color"])
    links.new(normal.outputs["Normal"], shader.inputs["Normal"])
    links.new(shader.outputs["BSDF"], nodes["Material Output"].inputs["Surface"])


def wear_address(mesh):
    """Lets a mesh glow with its texture coordinates, and with one where it is at all."""
    nodes, links = new_material(mesh)
    address, add = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeVectorMath")
    glow = nodes.new("ShaderNodeEmission")
    add.inputs[1].default_value = (0.0, 0.0, 1.0)
    links.new(address.outputs["UV"], add.inputs[0])
    links.new(add.outputs["Vector"], glow.inputs["Color"])
    links.new(glow.outputs["Emission"], nodes["Material Output"].inputs["Surface"])


def bake(size, target, source=None, **settings):
    """Bakes `target`, or `source` onto it with rays: rows from the bottom, RGB, linear."""
    image = bpy.data.images.new("bake", size, size, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    nodes = target.data.materials[0].node_tree.nodes
    node = nodes.new("ShaderNodeTexImage")
    node.image, nodes.active = image, node
    only(*([source, target] if source else [target]))
    bpy.ops.object.bake(
        margin=0,
        use_selected_to_active=source is not None,
        cage_extrusion=EXTRUSION if source else 0.0,
        **settings,
    )
    nodes.remove(node)
    return pixels(image)


def pixels(image):
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], -1)[..., :3].astype(float)


def vectors(colours):
    """Unit vectors from the colours of a normal map."""
    decoded = 2.0 * colours - 1.0
    return decoded / np.maximum(np.linalg.norm(decoded, axis=-1, keepdims=True), 1e-9)


def degrees(a, b, where):
    """Angles between two maps at some texels; exact for small ones, as a cosine is not."""
    return np.degrees(2.0 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=-1)[where] / 2, 0, 1)))


def shrunk(mask, texels):
    for _ in range(texels):
        padded = np.pad(mask, 1)
        mask = mask & padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
    return mask


def at(colours, address):
    """Bilinear lookup with the image's lower left corner at (0, 0)."""
    size = colours.shape[0]
    place = np.clip(address[..., :2] * size - 0.5, 0, size - 1.001)
    first = place.astype(int)
    (u, v), (x, y) = np.moveaxis(first, -1, 0), np.moveaxis(place - first, -1, 0)[..., None]
    low = colours[v, u] * (1 - x) + colours[v, u + 1] * x
    high = colours[v + 1, u] * (1 - x) + colours[v + 1, u + 1] * x
    return low * (1 - y) + high * y


def say(what, angles):
    rms, p99 = np.sqrt(np.mean(angles**2)), np.percentile(angles, 99)
    print(f"  {what:<52} RMS {rms:7.4f}   99 % {p99:7.4f}   largest {angles.max():7.3f}")
    return rms


def compare(baked, mesh_file, weights, map_file, skin_file, halvings):
    """Prints the angles of one pose and returns the RMS between `seen` and `same mesh`."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.engine = "CYCLES"
    bpy.context.scene.cycles.samples = 1
    image = bpy.data.images.load(str(baked / map_file))
    image.colorspace_settings.name = "Non-Color"
    size, ruga = image.size[0], pixels(image)

    print(map_file)
    artist, skin = artist_mesh(baked / mesh_file, weights), skin_mesh(skin_file, halvings)
    wear_map(artist, image)
    wear_address(skin)
    seen = vectors(bake(size, artist, type="NORMAL", normal_space="OBJECT"))
    same = vectors(bake(size, skin, type="NORMAL", normal_space="OBJECT"))
    own = bake(size, skin, type="EMIT")
    rays = bake(size, artist, skin, type="NORMAL", normal_space="TANGENT")
    hit = bake(size, artist, skin, type="EMIT")

    inside = shrunk(own[..., 2] > 0.5, BORDER)
    reached = inside & (hit[..., 2] > 0.5)
    print(f"  {inside.sum()} texels, skin of {len(skin.data.polygons)} triangles")
    rms = say("seen - same mesh", degrees(seen, same, inside))
    say("tilt of the map, for scale", degrees(vectors(ruga), np.array([0.0, 0.0, 1.0]), inside))
    rounded = vectors(np.round(ruga * 255) / 255)
    say("map rounded to 8 bits - map", degrees(rounded, vectors(ruga), inside))
    say("map - rays", degrees(vectors(ruga), vectors(rays), reached))
    say("map where the rays hit - rays", degrees(vectors(at(ruga, hit)), vectors(rays), reached))
    shift = np.linalg.norm((hit - own)[..., :2], axis=-1)[reached] * size
    print(f"  rays hit {np.sqrt(np.mean(shift**2)):.2f} texels (RMS) from the skin's own address")
    return rms


def main(baked, surfaces, halvings):
    manifest = json.loads((baked / "wrinkles.json").read_text())
    mesh_file = next(baked.glob("*.glb")).name
    worst = 0.0
    for entry in manifest["maps"]:
        pose = entry["pose"]
        skin = surfaces / f"{pose}.obj"
        if entry["kind"] != "normal" or entry["key"] != 1.0 or not skin.exists():
            continue
        weights = manifest["poses"][pose]
        worst = max(worst, compare(baked, mesh_file, weights, entry["file"], skin, halvings))
    print(f"Blender {bpy.app.version_string}: worst RMS {worst:.4f} degrees, limit {LIMIT}")
    return int(worst > LIMIT or worst == 0.0)


if __name__ == "__main__":
    halvings = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), halvings))
