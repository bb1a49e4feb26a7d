"""A result folder of `ruga bake`: which normal maps belong to which pose and key.

Read from `wrinkles.json`, checked before anything in Blender is changed. Knows nothing of Blender.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .errors import RugaError

# Stands for the number of a tile in the name of a file.
UDIM = "<UDIM>"


@dataclass
class KeyMap:
    """A normal map at one key of a pose; `green` is +1 where green points up, -1 otherwise.

    Of a mesh with UDIM tiles `tiles` has their numbers, and `file` has `<UDIM>` in its name.
    """

    key: float
    file: Path
    green: float
    tiles: list[int] = field(default_factory=list)

    def files(self) -> list[Path]:
        """The files of all tiles, or the only one."""
        if not self.tiles:
            return [self.file]
        return [self.file.with_name(self.file.name.replace(UDIM, str(tile))) for tile in self.tiles]


@dataclass
class PoseMaps:
    """The maps of one pose, keys ascending, and the weights of the shapes and growths that make it."""

    name: str
    weights: dict[str, float]
    growths: dict[str, float]
    maps: list[KeyMap]


def read_results(folder: Path) -> list[PoseMaps]:
    """Poses that wrinkle, with their normal maps; all files are there.

    Poses of which `report.json` says that nothing wrinkles are left out: their maps change nothing.
    """
    manifest = read_json(folder / "wrinkles.json")
    try:
        rules = manifest["blend"]
        if manifest["version"] != 1 or rules["normal"] != "reoriented-normal-mapping" or rules["keys"] != "linear":
            raise RugaError(
                f"{folder / 'wrinkles.json'} is of another version of ruga than this extension knows: "
                "update the extension"
            )
        still = still_poses(folder)
        growths = manifest.get("growths", {})
        poses = {
            name: PoseMaps(name, nonzero(weights), nonzero(growths.get(name, {})), [])
            for name, weights in manifest["poses"].items()
            if name not in still
        }
        for entry in manifest["maps"]:
            if entry["kind"] == "normal" and entry["pose"] in poses:
                green = -1.0 if entry["green"] == "-" else 1.0
                tiles = [int(tile) for tile in entry.get("tiles", [])]
                found = KeyMap(float(entry["key"]), folder / entry["file"], green, tiles)
                poses[entry["pose"]].maps.append(found)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise RugaError(f"{folder / 'wrinkles.json'} is not as ruga writes it ({error!r}): bake again") from error
    for pose in poses.values():
        pose.maps.sort(key=lambda found: found.key)
    usable = [pose for pose in poses.values() if pose.maps and (pose.weights or pose.growths)]
    check_files(usable)
    return usable


def nonzero(strengths: dict) -> dict[str, float]:
    """What takes part of shapes or growths."""
    return {name: float(strength) for name, strength in strengths.items() if strength}


def check_files(poses: list[PoseMaps]) -> None:
    """Refuses results whose maps are not all there."""
    files = [file for pose in poses for found in pose.maps for file in found.files()]
    missing = [str(file) for file in files if not is_image(file)]
    if missing:
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        raise RugaError(
            f"{len(missing)} maps are missing or empty: {', '.join(missing[:3])}{more}. "
            "Copy the whole result folder, or bake again; the material was not changed"
        )


def is_image(file: Path) -> bool:
    """Whether the file begins as a PNG or an OpenEXR image does."""
    try:
        with file.open("rb") as opened:
            start = opened.read(8)
    except OSError:
        return False
    return start == b"\x89PNG\r\n\x1a\n" or start.startswith(b"\x76\x2f\x31\x01")


def still_poses(folder: Path) -> set[str]:
    """Names of poses in which no layer has anything to wrinkle; empty without a report."""
    if not (folder / "report.json").is_file():
        return set()
    report = read_json(folder / "report.json")
    return {
        pose["name"]
        for pose in report.get("poses", [])
        if pose.get("layers") and not any(layer.get("vertices") for layer in pose["layers"])
    }


def read_json(path: Path) -> Any:
    """The file's content; a message says what to do where it cannot be read."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise RugaError(
            f"{path} is not there: choose the folder that `ruga bake` filled, which has wrinkles.json in it"
        ) from error
    except (OSError, ValueError) as error:
        raise RugaError(f"{path} cannot be read: {error}") from error
