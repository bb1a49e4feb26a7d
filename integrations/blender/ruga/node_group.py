"""The node group of an object: all its wrinkle maps, mixed by its shape keys, over a base.

Per pose the maps of its keys are mixed linearly, from neutral through one key to the next; the
result is normalised, and the poses are laid over each other and over the base by reoriented normal
mapping (Barré-Brisebois and Hill 2012, *Blending in detail*).
"""

import bpy

from .errors import RugaError
from .results import KeyMap, PoseMaps

NEUTRAL_COLOUR = (0.5, 0.5, 1.0, 1.0)
UP = (0.0, 0.0, 1.0)
BASE, BASE_STRENGTH, COLOUR = "Base", "Base Strength", "Color"
STRENGTH_NODE = "Strength"
# Blender cuts longer driver expressions off.
LONGEST_EXPRESSION = 255


class Nodes:
    """Adds nodes to a tree, one column to the right of the other."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.tree = tree
        self.place = 0.0

    def add(self, kind: str, label: str = "") -> bpy.types.Node:
        """A new node; a label shows in the editor."""
        node = self.tree.nodes.new(kind)
        node.label = label
        node.location = (self.place, 0.0)
        self.place += 180.0
        return node

    def link(self, value, socket: bpy.types.NodeSocket) -> None:
        """Connects a socket, or sets a plain value."""
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def vector(self, operation: str, *values) -> bpy.types.NodeSocket:
        """Vector arithmetic; the result is a vector, or a number for a dot product."""
        node = self.add("ShaderNodeVectorMath")
        node.operation = operation
        for value, socket in zip(values, node.inputs):
            self.link(value, socket)
        return node.outputs["Value" if operation == "DOT_PRODUCT" else "Vector"]

    def scaled(self, vector, factor) -> bpy.types.NodeSocket:
        """A vector times a number."""
        node = self.add("ShaderNodeVectorMath")
        node.operation = "SCALE"
        self.link(vector, node.inputs[0])
        self.link(factor, node.inputs["Scale"])
        return node.outputs["Vector"]

    def mix(self, start, end, factor, label: str = "") -> bpy.types.Node:
        """A linear mix of two vectors: `start` at 0, `end` at 1, further on beyond."""
        node = self.add("ShaderNodeMix", label)
        node.data_type, node.clamp_factor = "VECTOR", False
        self.link(factor, node.inputs[0])
        self.link(start, node.inputs[4])
        self.link(end, node.inputs[5])
        return node

    def decoded(self, colour, green: float = 1.0) -> bpy.types.NodeSocket:
        """A vector from the colour of a normal map."""
        return self.vector("MULTIPLY_ADD", colour, (2.0, 2.0 * green, 2.0), (-1.0, -green, -1.0))

    def laid_over(self, base, detail) -> bpy.types.NodeSocket:
        """Reoriented normal mapping: `detail` on `base`, unit vectors both."""
        t = self.vector("ADD", base, UP)
        u = self.vector("MULTIPLY", detail, (-1.0, -1.0, 1.0))
        part = self.add("ShaderNodeSeparateXYZ")
        self.link(t, part.inputs[0])
        along = self.scaled(t, self.vector("DOT_PRODUCT", t, u))
        across = self.scaled(u, part.outputs["Z"])
        return self.vector("NORMALIZE", self.vector("SUBTRACT", along, across))


def group_of(subject: bpy.types.Object) -> bpy.types.NodeTree:
    """The object's node group, made if it has none."""
    group = subject.ruga.group
    if group is None:
        group = bpy.data.node_groups.new(f"ruga {subject.name}", "ShaderNodeTree")
        interface = group.interface
        base = interface.new_socket(BASE, in_out="INPUT", socket_type="NodeSocketColor")
        base.default_value = NEUTRAL_COLOUR
        base.description = "The skin's own normal map; the wrinkles lie on it"
        strength = interface.new_socket(BASE_STRENGTH, in_out="INPUT", socket_type="NodeSocketFloat")
        strength.default_value = 1.0
        interface.new_socket(COLOUR, in_out="OUTPUT", socket_type="NodeSocketColor")
        subject.ruga.group = group
    return group


def fill_group(group: bpy.types.NodeTree, subject: bpy.types.Object, uv_map: str, poses: list[PoseMaps]) -> None:
    """Builds the group anew for these poses; the artist's strength is kept."""
    old = group.nodes.get(STRENGTH_NODE)
    strength = old.outputs[0].default_value if old else 1.0
    group.animation_data_clear()
    group.nodes.clear()
    nodes = Nodes(group)
    outside = nodes.add("NodeGroupInput")
    height = nodes.add("ShaderNodeValue", "Height of the wrinkles")
    height.name = STRENGTH_NODE
    height.outputs[0].default_value = strength
    spread = nodes.add("ShaderNodeCombineXYZ")
    nodes.link(height.outputs[0], spread.inputs["X"])
    nodes.link(height.outputs[0], spread.inputs["Y"])
    spread.inputs["Z"].default_value = 1.0
    address = nodes.add("ShaderNodeUVMap")
    address.uv_map = uv_map

    base = nodes.vector("NORMALIZE", nodes.decoded(outside.outputs[BASE]))
    faded = nodes.mix(UP, base, outside.outputs[BASE_STRENGTH])
    total = nodes.vector("NORMALIZE", faded.outputs[1])
    for pose in poses:
        wrinkles = add_pose(nodes, subject, pose, address)
        wrinkles = nodes.vector("MULTIPLY", wrinkles, spread.outputs[0])
        total = nodes.laid_over(total, nodes.vector("NORMALIZE", wrinkles))
    coded = nodes.vector("MULTIPLY_ADD", total, (0.5, 0.5, 0.5), (0.5, 0.5, 0.5))
    end = nodes.add("NodeGroupOutput")
    nodes.link(coded, end.inputs[COLOUR])


def add_pose(
    nodes: Nodes, subject: bpy.types.Object, pose: PoseMaps, address: bpy.types.Node
) -> bpy.types.NodeSocket:
    """The mix of a pose's keys, driven by its shapes."""
    start, mixed = 0.0, UP
    for found in pose.maps:
        texture = nodes.add("ShaderNodeTexImage", f"{pose.name} {100 * found.key:g} %")
        texture.image = load_map(found)
        texture.extension = "EXTEND"
        nodes.link(address.outputs["UV"], texture.inputs["Vector"])
        normal = nodes.decoded(texture.outputs["Color"], found.green)
        # Below `start` the factor is 0, beyond `key` it is 1: so the mixes in a row are linear
        # from key to key.
        node = nodes.mix(mixed, normal, 0.0, f"{pose.name} to {100 * found.key:g} %")
        node["ruga_pose"], node["ruga_key"] = pose.name, found.key
        drive(node.inputs[0], subject, pose, start, found.key)
        start, mixed = found.key, node.outputs[1]
    return mixed


def drive(socket: bpy.types.NodeSocket, subject: bpy.types.Object, pose: PoseMaps, start: float, end: float) -> None:
    """Drives a factor from 0 to 1 while the pose goes from `start` to `end`.

    A pose of several shapes is as far as the shape that is least far; a growth counts like a shape, by a property
    of the object. The expression is one that Blender evaluates without Python, so that no permission to run
    scripts is needed.
    """
    curve = socket.driver_add("default_value")
    curve.driver.type = "SCRIPTED"
    shapes = [("KEY", f'key_blocks["{bpy.utils.escape_identifier(shape)}"].value') for shape in pose.weights]
    properties = [growth_property(subject, name) for name in pose.growths]
    growths = [("OBJECT", f'["{bpy.utils.escape_identifier(name)}"]') for name in properties]
    for number, (kind, path) in enumerate(shapes + growths):
        variable = curve.driver.variables.new()
        variable.name, variable.type = f"v{number}", "SINGLE_PROP"
        target = variable.targets[0]
        target.id_type, target.id = kind, subject.data.shape_keys if kind == "KEY" else subject
        target.data_path = path
    curve.driver.expression = expression_of(strengths_of(pose), start, end)


def growth_property(subject: bpy.types.Object, growth: str) -> str:
    """The object's property that says how much of a growth there is, made if it has none; its name."""
    name = f"ruga {growth}"
    if name not in subject:
        subject[name] = 0.0
        subject.id_properties_ui(name).update(
            soft_min=0.0, soft_max=1.0, description="How much of this growth there is: 0 none, 1 all of it"
        )
        # A driver that meets the object before Blender has copied the property fails once and stays off.
        subject.update_tag()
    return name


def strengths_of(pose: PoseMaps) -> list[float]:
    """Weights of the shapes of a pose, then strengths of its growths."""
    return [*pose.weights.values(), *pose.growths.values()]


def expression_of(weights: list[float], start: float, end: float) -> str:
    """The driver's expression; the variables `v0`, `v1`, ... are the values of shapes, then of growths."""
    terms = [f"v{n}" if weight == 1.0 else f"v{n}/{weight:.6g}" for n, weight in enumerate(weights)]
    reached = terms[0] if len(terms) == 1 else f"min({','.join(terms)})"
    return f"clamp(({reached}-{start:.6g})/{end - start:.6g})"


def check_poses(poses: list[PoseMaps]) -> None:
    """Refuses, before anything is changed, maps that Blender cannot read and poses it cannot drive."""
    for pose in poses:
        start = 0.0
        for found in pose.maps:
            if len(expression_of(strengths_of(pose), start, found.key)) > LONGEST_EXPRESSION:
                raise RugaError(f"Pose `{pose.name}` is made of more shapes than a driver of Blender can read")
            if 0 in load_map(found).size:
                raise RugaError(f"{found.file} cannot be read: bake again; the material was not changed")
            start = found.key


def load_map(found: KeyMap) -> bpy.types.Image:
    """The image of a map, read anew if Blender has it already; of UDIM tiles one tiled image."""
    image = load_tiles(found) if found.tiles else bpy.data.images.load(str(found.file), check_existing=True)
    image.reload()
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "NONE"
    if bpy.data.filepath:
        try:
            image.filepath = bpy.path.relpath(str(found.file))
        except ValueError:
            # On Windows nothing on another drive has a relative path.
            pass
    return image


def load_tiles(found: KeyMap) -> bpy.types.Image:
    """The tiled image of a map with a file per UDIM tile."""
    pattern = str(found.file)
    tiled = (image for image in bpy.data.images if image.source == "TILED")
    image = next((image for image in tiled if bpy.path.abspath(image.filepath) == pattern), None)
    if image is None:
        image = bpy.data.images.load(str(found.files()[0]))
        image.source, image.filepath = "TILED", pattern
        image.name = found.file.name
    there = {tile.number for tile in image.tiles}
    for tile in found.tiles:
        if tile not in there:
            image.tiles.new(tile)
    # A new tiled image has tile 1001, and an earlier bake may have had others.
    for tile in [tile for tile in image.tiles if tile.number not in found.tiles]:
        image.tiles.remove(tile)
    return image
