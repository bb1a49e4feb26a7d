"""The scene file that `ruga` reads, written from plain values.

Strings are TOML's literal strings, so that a backslash in a name or a path stays what it is. Knows
nothing of Blender.
"""

import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from .errors import RugaError

# Endings of the names of shapes for the left and the right side, most specific first.
SIDES = (("_L", "_R"), (".L", ".R"), ("_l", "_r"), (".l", ".r"), ("Left", "Right"), ("left", "right"))
# Without their side, shapes of ARKit that move one way or the other: together they would cancel.
OPPOSITE = ("jaw", "mouth")


@dataclass
class Layer:
    """One layer of skin: a preset, or a wavelength (m) with a critical strain (0 to 1)."""

    name: str
    preset: str | None = None
    wavelength: float = 0.01
    critical_strain: float = 0.05
    strength: float = 1.0
    mask: str | None = None
    zone: str | None = None


@dataclass
class Scene:
    """What `ruga` is asked to bake; `mesh` is a file beside the scene."""

    mesh: str
    mesh_name: str
    layers: list[Layer]
    poses: dict[str, dict[str, float]]
    keys: list[float] = field(default_factory=lambda: [0.5, 1.0])
    size: int = 2048


def toml_string(text: str) -> str:
    """A literal string, or an escaped one where the text has a quote or a control character."""
    if "'" in text or not text.isprintable():
        # Escapes of JSON are escapes of TOML; TOML wants DEL escaped, too.
        return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
    return f"'{text}'"


def scene_text(scene: Scene) -> str:
    """The scene as TOML."""
    lines = [
        "# Written by the Blender extension; the next bake writes it anew.",
        "version = 1",
        "",
        "[driver]",
        f"mesh = {toml_string(scene.mesh)}",
        f"mesh_name = {toml_string(scene.mesh_name)}",
    ]
    if any(layer.preset is None for layer in lowest_layers(scene.layers)):
        lines += ["", "# What carries layers that are given by a wavelength: ruga's reference values.", "[substrate]"]
    for layer in scene.layers:
        lines += ["", "[[layers]]", f"name = {toml_string(layer.name)}"]
        if layer.preset:
            lines.append(f"preset = {toml_string(layer.preset)}")
        else:
            lines.append(f"wavelength = {layer.wavelength:.9g}")
            lines.append(f"critical_strain = {layer.critical_strain:.9g}")
        if layer.strength != 1.0:
            lines.append(f"strength = {layer.strength:.9g}")
        if layer.zone:
            lines.append(f"zone = {toml_string(layer.zone)}")
        if layer.mask:
            lines.append(f"mask = {toml_string(layer.mask)}")
    for name, weights in scene.poses.items():
        table = ", ".join(f"{toml_string(shape)} = {weight:.9g}" for shape, weight in weights.items())
        lines += ["", "[[poses]]", f"name = {toml_string(name)}", f"weights = {{ {table} }}"]
        lines.append(f"keys = [{', '.join(f'{key:.9g}' for key in scene.keys)}]")
    lines += ["", "[bake]", f"size = {scene.size}", 'maps = ["normal"]', ""]
    return "\n".join(lines)


def lowest_layers(layers: list[Layer]) -> list[Layer]:
    """The layer of every zone that lies on the substrate: the first of each in the list."""
    lowest: dict[str | None, Layer] = {}
    for layer in layers:
        lowest.setdefault(layer.zone, layer)
    return list(lowest.values())


def check_carriers(layers: list[Layer]) -> None:
    """Refuses zones that begin with a preset beside zones that begin with a wavelength.

    A scene has one substrate: with it, the presets would lose their own, and wrinkle otherwise.
    """
    lowest = lowest_layers(layers)
    if len({layer.preset is None for layer in lowest}) > 1:
        names = ", ".join(f"`{layer.name}`" for layer in lowest)
        raise RugaError(f"The lowest layers of the zones ({names}) must be either all presets or all by wavelength")


def poses_of_shapes(shapes: list[str], join_sides: bool) -> dict[str, dict[str, float]]:
    """A pose per shape; with `join_sides`, one for the left and the right shape together."""
    poses: dict[str, dict[str, float]] = {}
    for shape in shapes:
        if any(shape in weights for weights in poses.values()):
            continue
        pair = partner(shape, shapes) if join_sides else None
        if pair is None:
            poses[shape] = {shape: 1.0}
            continue
        name, other = pair
        # The joint name may be that of a third shape, which keeps it.
        while not name or name in shapes or name in poses:
            name = f"{name}_both"
        poses[name] = {shape: 1.0, other: 1.0}
    return poses


def partner(shape: str, shapes: list[str]) -> tuple[str, str] | None:
    """The name without its side and the shape of the other side, if that is there."""
    for left, right in SIDES:
        for own, other in ((left, right), (right, left)):
            stem = shape.removesuffix(own)
            if stem != shape and stem + other in shapes and stem not in OPPOSITE:
                return stem, stem + other
    return None


def parse_keys(text: str) -> list[float]:
    """Keys from text such as `0.5, 1`: ascending, above 0 and up to 1."""
    try:
        keys = sorted({float(part) for part in text.replace(";", ",").split(",") if part.strip()})
    except ValueError:
        keys = []
    if not keys or not 0.0 < keys[0] or not keys[-1] <= 1.0:
        raise RugaError(f"Keys: `{text}` is not a list of numbers above 0 and up to 1, such as 0.5, 1")
    return keys


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A path to write to; the file takes its name only when the block has ended well."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".writing-") as folder:
            unfinished = Path(folder) / path.name
            yield unfinished
            os.replace(unfinished, path)
    except OSError as error:
        raise RugaError(f"{path} cannot be written: {error}") from error
