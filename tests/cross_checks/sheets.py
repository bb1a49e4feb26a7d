"""Compares the moving mesh in a sheet's GLB, as Blender plays it, with the OBJ files of the same bake.

    python sheets.py FOLDER...

FOLDERs are those of `ruga bake`. Every key of every pose is reached twice: by its shape key alone, and by the
animation of its pose at the frame of the key. Prints the largest distance; the exit code is 1 where one is beyond
LIMIT, or if there is nothing to compare; without `bpy` the script says so and ends with 0.
"""

import json
import sys
from pathlib import Path

try:
    import bpy
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}. `pip install 'bpy==4.2.*' numpy` into a Python 3.11 runs this check")
    sys.exit(0)

# Metres: glTF has 32 bits.
LIMIT = 1e-6


def read_points(file):
    """Points of an OBJ file, in Blender's axes (Z up)."""
    lines = (line.split() for line in file.read_text().splitlines())
    points = np.array([[float(x) for x in line[1:4]] for line in lines if line and line[0] == "v"])
    return points[:, [0, 2, 1]] * [1, -1, 1]


def shown_points(mesh):
    """Points of the mesh as it is shown now."""
    shown = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(3 * len(shown.data.vertices))
    shown.data.vertices.foreach_get("co", points)
    world = np.array(mesh.matrix_world)
    return points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]


def distance(shown, expected):
    """Largest distance of a point of either from the nearest of the other, as vertices at seams come twice."""
    ways = [(shown, expected), (expected, shown)]
    return max(np.linalg.norm(there - point, axis=1).min() for here, there in ways for point in here)


def compare(folder):
    """Largest distance in one folder, and states that were compared."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    [file] = folder.glob("*.glb")
    bpy.ops.import_scene.gltf(filepath=str(file))
    [mesh] = [shown for shown in bpy.data.objects if shown.type == "MESH"]
    blocks = mesh.data.shape_keys.key_blocks
    animation = mesh.data.shape_keys.animation_data
    worst, states = 0.0, 0
    poses = {}
    for map_ in json.loads((folder / "wrinkles.json").read_text())["maps"]:
        poses.setdefault(map_["pose"], set()).add(map_["key"])
    for pose, keys in poses.items():
        for key in sorted(keys):
            percent = f"{100 * key:g}".replace(".", "p")
            expected = read_points(folder / "bodies" / f"{pose}_{percent}.obj")
            animation.action = None
            for block in blocks[1:]:
                block.value = float(block.name == f"{pose}_{percent}")
            bpy.context.view_layer.update()
            worst = max(worst, distance(shown_points(mesh), expected))
            animation.action = next(action for action in bpy.data.actions if action.name.startswith(f"{pose}_"))
            start, end = animation.action.frame_range
            frame = start + key * (end - start) / max(keys)
            bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
            worst = max(worst, distance(shown_points(mesh), expected))
            states += 2
    return worst, states


def main():
    """Compares all folders."""
    faults, states = 0, 0
    for folder in map(Path, sys.argv[1:]):
        worst, count = compare(folder)
        print(f"{folder}: {count} states, largest distance {worst:.2e} m (limit {LIMIT:.0e})")
        faults += worst > LIMIT
        states += count
    return 0 if states and not faults else 1


if __name__ == "__main__":
    sys.exit(main())
