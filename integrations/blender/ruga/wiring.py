"""Connects an object's node group with its materials, and takes it out again.

The artist's nodes are left as they are. One link changes: that into the Normal of the Principled
BSDF (or of the Bump node before it), which comes from this extension's Normal Map node afterwards.
The artist's own normal map becomes the base that the wrinkles lie on.
"""

from pathlib import Path

import bpy

from .errors import RugaError
from .node_group import BASE, BASE_STRENGTH, COLOUR, check_poses, fill_group, group_of
from .results import PoseMaps, read_results

# Custom property of nodes that this extension made; its value is what they are.
MARK = "ruga"


def load_results(subject: bpy.types.Object, folder: Path, uv_map: str) -> list[str]:
    """Shows the results of a folder on an object; returns the names of the poses.

    Everything is looked at before anything is changed.
    """
    poses = read_results(folder)
    if not poses:
        raise RugaError(
            f"Nothing wrinkles in {folder}: no pose compresses the skin beyond its critical strain. "
            "Choose another preset, a lower critical strain or other shapes; the material was not changed"
        )
    check_shapes(subject, poses)
    check_poses(poses)
    sockets = [(tree, normal_socket(tree)) for tree in material_trees(subject)]
    group = group_of(subject)
    fill_group(group, subject, uv_map, poses)
    for tree, socket in sockets:
        connect(tree, socket, group, uv_map)
    return [pose.name for pose in poses]


def check_shapes(subject: bpy.types.Object, poses: list[PoseMaps]) -> None:
    """Refuses results of a mesh with other shapes."""
    keys = subject.data.shape_keys
    own = set(keys.key_blocks.keys()) if keys else set()
    lacking = sorted({shape for pose in poses for shape in pose.weights} - own)
    if lacking:
        raise RugaError(
            f"`{subject.name}` has no shape key {', '.join(f'`{name}`' for name in lacking[:5])}: "
            "the folder belongs to another mesh, or shape keys were renamed; the material was not changed"
        )


def material_trees(subject: bpy.types.Object) -> list[bpy.types.NodeTree]:
    """Node trees of the object's materials; one material is made if there is none."""
    materials = {slot.material for slot in subject.material_slots if slot.material}
    if not materials:
        material = bpy.data.materials.new(f"{subject.name} skin")
        material.use_nodes = True
        if subject.material_slots:
            subject.material_slots[0].material = material
        else:
            subject.data.materials.append(material)
        materials = {material}
    for material in materials:
        material.use_nodes = True
    return [material.node_tree for material in sorted(materials, key=lambda found: found.name)]


def own_nodes(tree: bpy.types.NodeTree) -> dict[str, bpy.types.Node]:
    """This extension's nodes in a material, by what they are."""
    return {node[MARK]: node for node in tree.nodes if MARK in node}


def source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The socket that a link comes from."""
    return socket.links[0].from_socket if socket.is_linked else None


def normal_socket(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """The input that takes the wrinkled normal: the Principled BSDF's, or that of a Bump before it."""
    shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if shader is None:
        raise RugaError(f"A material of the object has no Principled BSDF (`{tree_name(tree)}`): add one")
    socket = shader.inputs["Normal"]
    while (found := source(socket)) is not None and found.node.type == "BUMP":
        socket = found.node.inputs["Normal"]
    base = source(socket)
    if base is not None and MARK not in base.node:
        if base.node.type != "NORMAL_MAP" or base.node.space != "TANGENT":
            raise RugaError(
                f"In material `{tree_name(tree)}` the normal comes from `{base.node.name}`, which wrinkles "
                "cannot lie on: only a Normal Map node in tangent space can be the base"
            )
    return socket


def tree_name(tree: bpy.types.NodeTree) -> str:
    """The name of the material that a node tree belongs to."""
    return next((material.name for material in bpy.data.materials if material.node_tree == tree), tree.name)


def connect(tree: bpy.types.NodeTree, socket: bpy.types.NodeSocket, group: bpy.types.NodeTree, uv_map: str) -> None:
    """Puts the group between the base and `socket`; where it is already, only its group is renewed."""
    own = own_nodes(tree)
    if len(own) == 2 and source(socket) is not None and MARK in source(socket).node:
        own["group"].node_tree = group
        own["normal"].uv_map = uv_map
        return
    for node in own.values():
        tree.nodes.remove(node)
    base = source(socket)
    wrinkles = tree.nodes.new("ShaderNodeGroup")
    wrinkles.node_tree, wrinkles.label, wrinkles[MARK] = group, "ruga wrinkles", "group"
    normal = tree.nodes.new("ShaderNodeNormalMap")
    normal.label, normal.uv_map, normal[MARK] = "ruga normal", uv_map, "normal"
    x, y = socket.node.location
    wrinkles.location, normal.location = (x - 380.0, y - 560.0), (x - 190.0, y - 560.0)
    if base is not None:
        colour, strength = base.node.inputs["Color"], base.node.inputs["Strength"]
        wrinkles.inputs[BASE].default_value = colour.default_value
        wrinkles.inputs[BASE_STRENGTH].default_value = strength.default_value
        for own_input, there in ((BASE, colour), (BASE_STRENGTH, strength)):
            if source(there) is not None:
                tree.links.new(source(there), wrinkles.inputs[own_input])
    tree.links.new(wrinkles.outputs[COLOUR], normal.inputs["Color"])
    tree.links.new(normal.outputs["Normal"], socket)
    # By its name the artist's node is found again when the wrinkles are taken out.
    wrinkles["ruga_base"] = base.node.name if base is not None else ""


def disconnect(subject: bpy.types.Object) -> int:
    """Takes the wrinkles out of the object's materials; returns how many materials had them."""
    found = 0
    for slot in subject.material_slots:
        tree = slot.material.node_tree if slot.material else None
        own = own_nodes(tree) if tree else {}
        if not own:
            continue
        found += 1
        targets = [link.to_socket for link in own["normal"].outputs[0].links] if "normal" in own else []
        base = tree.nodes.get(own["group"].get("ruga_base", "")) if "group" in own else None
        for node in own.values():
            tree.nodes.remove(node)
        for target in targets if base is not None else []:
            tree.links.new(base.outputs["Normal"], target)
    group = subject.ruga.group
    subject.ruga.group = None
    if group is not None and group.users == 0:
        bpy.data.node_groups.remove(group)
    return found
