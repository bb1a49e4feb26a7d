"""Compares the tangents in a GLB that ruga writes with those of Blender's `Mesh.calc_tangents`.

    python tangents.py MESH.glb...

Each mesh is baked by `target/release/ruga` with skin that does not wrinkle, which takes seconds and
writes the mesh with its TANGENT. Blender gets the same triangles, normals and texture coordinates, and
calculates tangents of its own. Printed are angles over all corners of triangles, in degrees, and how
many signs differ. The exit code is 1 where a corner is above LIMIT or a sign differs;
without `bpy` the script says so and ends with 0.
"""

import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import bpy
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}. `pip install 'bpy==4.2.*' numpy` into a Python 3.11 runs this check")
    sys.exit(0)

RUGA = Path(__file__).resolve().parents[2] / "target" / "release" / "ruga"
# Degrees. Blender rounds normals to 16 bits, up to .03 degrees on a face.
LIMIT = 0.1
SCENE = """version = 1
[driver]
mesh = {mesh}
[substrate]
[[layers]]
name = "skin"
wavelength = 0.01
critical_strain = 0.9
[[poses]]
name = "rest"
weights = {{ {shape} = 0.01 }}
keys = [1.0]
[bake]
size = 64
padding = 2
maps = ["normal"]
"""
KINDS = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read(path):
    """The JSON and the binary part of a GLB."""
    glb = path.read_bytes()
    length = struct.unpack_from("<I", glb, 12)[0]
    return json.loads(glb[20 : 20 + length]), glb[28 + length :]


def array(gltf, binary, number):
    """An accessor's values, a row per element."""
    accessor = gltf["accessors"][number]
    view, kind = gltf["bufferViews"][accessor["bufferView"]], np.dtype(KINDS[accessor["componentType"]])
    width, start = WIDTHS[accessor["type"]], view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", width * kind.itemsize)
    rows = np.ndarray((accessor["count"], width), kind, binary, start, (stride, kind.itemsize))
    return rows.copy()


def with_tangents(mesh, folder):
    """The GLB that ruga writes of a mesh."""
    gltf, _ = read(mesh)
    shape = next(found for found in gltf["meshes"] if "extras" in found)["extras"]["targetNames"][0]
    scene = folder / "scene.toml"
    scene.write_text(SCENE.format(mesh=json.dumps(str(mesh)), shape=json.dumps(shape)), encoding="utf-8")
    out = folder / "out"
    subprocess.run([RUGA, "bake", scene, "-o", out, "--threads", "1"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return next(out.glob("*.glb"))


def welded(positions, normals, uvs, triangles):
    """The same with vertices that are alike joined, as where two materials meet.

    MikkTSpace averages over corners that are alike. Blender rounds the normal of every vertex by the triangles around
    it, so that vertices which were alike before would not be so any more.
    """
    _, first, number = np.unique(
        np.hstack([positions, normals, uvs]), axis=0, return_index=True, return_inverse=True
    )
    return positions[first], normals[first], uvs[first], number.reshape(-1)[triangles]


def blender_tangents(positions, normals, uvs, triangles):
    """Tangents and signs of Blender, three rows per triangle."""
    mesh = bpy.data.meshes.new("check")
    mesh.from_pydata(positions.tolist(), [], triangles.tolist())
    layer = mesh.uv_layers.new(name="UVMap")
    # glTF's V points down, Blender's up.
    flipped = np.stack([uvs[:, 0], 1.0 - uvs[:, 1]], axis=1)[triangles.ravel()]
    layer.uv.foreach_set("vector", flipped.astype(np.float32).ravel())
    mesh.shade_smooth()
    # Per vertex, as all corners of a vertex then have one normal to the last bit: MikkTSpace averages
    # only over corners that are equal.
    mesh.normals_split_custom_set_from_vertices(normals.tolist())
    mesh.calc_tangents(uvmap="UVMap")
    corners = [loop.vertex_index for loop in mesh.loops]
    if corners != triangles.ravel().tolist():
        sys.exit("Blender has changed the triangles")
    found = np.array([[*loop.tangent, loop.bitangent_sign] for loop in mesh.loops])
    kept = np.array([loop.normal[:] for loop in mesh.loops])
    return found[:, :3], found[:, 3], kept


def compare(mesh):
    """Prints the comparison of one file; whether it is within the limit."""
    with tempfile.TemporaryDirectory() as folder:
        gltf, binary = read(with_tangents(mesh, Path(folder)))
    angles, signs, tilt = [], 0, 0.0
    for primitive in (part for found in gltf["meshes"] for part in found["primitives"]):
        if "TANGENT" not in primitive["attributes"]:
            continue
        get = lambda name: array(gltf, binary, primitive["attributes"][name])  # noqa: E731
        positions, normals, uvs, tangents = (get(n) for n in ("POSITION", "NORMAL", "TEXCOORD_0", "TANGENT"))
        triangles = array(gltf, binary, primitive["indices"]).reshape(-1, 3).astype(int)
        own, sign, kept = blender_tangents(*welded(positions, normals, uvs, triangles))
        here = tangents[triangles.ravel()].astype(float)
        angles.append(np.degrees(2.0 * np.arcsin(np.clip(np.linalg.norm(here[:, :3] - own, axis=1) / 2, 0, 1))))
        signs += int((np.sign(here[:, 3]) != np.sign(sign)).sum())
        tilt = max(tilt, np.degrees(np.linalg.norm(kept - normals[triangles.ravel()], axis=1)).max())
    angles = np.concatenate(angles)
    p99 = np.percentile(angles, 99)
    print(
        f"{mesh.name}: {len(angles)} corners, median {np.median(angles):.4f}, 99 % {p99:.4f}, "
        f"largest {angles.max():.4f} degrees, {(angles > LIMIT).sum()} above {LIMIT}; {signs} signs differ; "
        f"normals kept within {tilt:.3f}"
    )
    return bool(angles.max() <= LIMIT) and signs == 0


def main(meshes):
    right = [compare(Path(mesh).resolve()) for mesh in meshes]
    return 0 if right and all(right) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
