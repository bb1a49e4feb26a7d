"""Grey images over the UV square or UDIM tiles, from vertex groups and images."""

from pathlib import Path

import bpy
import numpy as np

from .errors import RugaError
from .results import UDIM
from .scene_file import whole_file

# Texels around each island that repeat its border, so that lookups there do not mix in black.
PADDING = 4
# Width and height of the masks of vertex groups.
SIZE = 1024


def group_masks(
    mesh: bpy.types.Mesh, group: bpy.types.VertexGroup, uv_map: str, size: int = SIZE
) -> dict[int, np.ndarray]:
    """A vertex group's weights, linear on each triangle, as `size` rows from the bottom, 0 to 1.

    By the numbers of the UDIM tiles that the mesh lies in: 1001 alone where it has none.
    """
    weights = group_weights(mesh, group.index)
    if not weights.any():
        raise RugaError(f"Vertex group `{group.name}` has no weights: paint it, or take another mask")
    uvs = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[uv_map].uv.foreach_get("vector", uvs)
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertices)
    corners = corners.reshape(-1, 3)
    uvs = uvs.reshape(-1, 2)[corners].astype(float)
    masks = {}
    for column, row in tiles_of(uvs):
        # Texel centres have whole coordinates from here on.
        places = (uvs - (column, row)) * size - 0.5
        masks[1001 + column + 10 * row] = rasterise(places, weights[vertices[corners]], size)
    return masks


def tiles_of(uvs: np.ndarray) -> list[tuple[int, int]]:
    """Columns and rows of the UDIM tiles in which the middles of triangles lie; the first where none do."""
    squares = np.unique(np.floor(uvs.mean(axis=1)).astype(int), axis=0)
    tiles = [(int(column), int(row)) for column, row in squares if 0 <= column < 10 and 0 <= row < 100]
    return tiles or [(0, 0)]


def group_weights(mesh: bpy.types.Mesh, index: int) -> np.ndarray:
    """The weight of every vertex in a group; 0 outside."""
    weights = np.zeros(len(mesh.vertices))
    for vertex in mesh.vertices:
        for member in vertex.groups:
            if member.group == index:
                weights[vertex.index] = member.weight
    return weights


def rasterise(places: np.ndarray, values: np.ndarray, size: int) -> np.ndarray:
    """Triangles with a value per corner, drawn into an image and padded."""
    image = np.zeros((size, size))
    covered = np.zeros((size, size), bool)
    for (a, b, c), value in zip(places, values):
        low = np.maximum(np.floor(np.minimum(np.minimum(a, b), c)).astype(int), 0)
        high = np.minimum(np.ceil(np.maximum(np.maximum(a, b), c)).astype(int), size - 1)
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0.0 or (low > high).any():
            continue
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        second = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        third = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        # A little more than the triangle, so that no texel between two of them stays empty.
        inside = (second >= -1e-6) & (third >= -1e-6) & (second + third <= 1.0 + 1e-6)
        drawn = value[0] + second * (value[1] - value[0]) + third * (value[2] - value[0])
        box = np.s_[low[1] : high[1] + 1, low[0] : high[0] + 1]
        image[box][inside], covered[box][inside] = drawn[inside], True
    return pad(image, covered, PADDING)


def pad(image: np.ndarray, covered: np.ndarray, texels: int) -> np.ndarray:
    """Repeats the border of what is covered outwards."""
    for _ in range(texels):
        total, count = np.zeros_like(image), np.zeros_like(image)
        for step in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            beside = np.roll(covered, step, (0, 1))
            total += np.where(beside, np.roll(image, step, (0, 1)), 0.0)
            count += beside
        grown = ~covered & (count > 0)
        image = np.where(grown, total / np.maximum(count, 1), image)
        covered = covered | grown
    return np.clip(image, 0.0, 1.0)


def image_masks(image: bpy.types.Image) -> dict[int, np.ndarray]:
    """An image as grey values by the numbers of its UDIM tiles; a plain one is that of tile 1001."""
    if image.source != "TILED":
        return {1001: image_mask(image)}
    if image.is_dirty:
        raise RugaError(f"Image `{image.name}` has tiles that are not saved: save it, as its files are read")
    masks = {}
    for tile in image.tiles:
        path = bpy.path.abspath(image.filepath).replace(UDIM, str(tile.number))
        try:
            alone = bpy.data.images.load(path)
        except RuntimeError as error:
            raise RugaError(f"Image `{image.name}`: {path} cannot be read: save the image") from error
        try:
            masks[tile.number] = image_mask(alone)
        finally:
            bpy.data.images.remove(alone)
    return masks


def image_mask(image: bpy.types.Image) -> np.ndarray:
    """An image as grey values, rows from the bottom, as stored in the file."""
    width, height = image.size
    if width == 0 or height == 0:
        raise RugaError(f"Image `{image.name}` has no pixels: its file {image.filepath} cannot be read")
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)
    return pixels[..., : min(image.channels, 3)].mean(axis=-1)


def save_grey(values: np.ndarray, path: Path) -> None:
    """Writes grey values as PNG, 8 bit."""
    height, width = values.shape
    image = bpy.data.images.new("ruga mask", width, height)
    try:
        image.colorspace_settings.name = "Non-Color"
        colours = np.ones((height, width, 4), np.float32)
        colours[..., :3] = values[..., None]
        image.pixels.foreach_set(colours.ravel())
        image.file_format = "PNG"
        with whole_file(path) as unfinished:
            try:
                image.save(filepath=str(unfinished))
            except RuntimeError as error:
                raise RugaError(f"{path} cannot be written: {error}") from error
    finally:
        bpy.data.images.remove(image)
