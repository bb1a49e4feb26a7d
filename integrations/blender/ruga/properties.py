"""What the artist chooses, kept with the object in the .blend file."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .presets import PRESETS


class RugaLayer(bpy.types.PropertyGroup):
    """One layer of skin."""

    name: StringProperty(name="Name", default="skin")
    kind: EnumProperty(
        name="Skin",
        items=(
            ("PRESET", "Preset", "Skin from a list"),
            ("WAVELENGTH", "Wavelength", "Skin that wrinkles as finely and as early as you say"),
        ),
    )
    preset: EnumProperty(name="Preset", items=[(name, name, about) for name, about in PRESETS])
    wavelength: FloatProperty(
        name="Wavelength",
        description="From one crest to the next",
        subtype="DISTANCE",
        unit="LENGTH",
        default=0.01,
        min=0.0001,
        soft_max=0.05,
        precision=4,
    )
    critical_strain: FloatProperty(
        name="Critical strain",
        description="Compression from which on the skin wrinkles: at 5 %, 10 mm have become 9.5 mm",
        subtype="PERCENTAGE",
        default=5.0,
        min=0.1,
        max=99.0,
    )
    strength: FloatProperty(
        name="Relief", description="What the relief is multiplied by in the maps", default=1.0, min=0.01, max=4.0
    )
    mask_kind: EnumProperty(
        name="Mask",
        items=(
            ("NONE", "Everywhere", "Wherever a shape compresses the skin enough"),
            ("GROUP", "Vertex Group", "Where a vertex group has weight; wrinkles fade with the weight"),
            ("IMAGE", "Image", "Where an image over the UV map is white; wrinkles fade in its grey"),
        ),
    )
    vertex_group: StringProperty(name="Vertex Group")
    image: PointerProperty(name="Image", type=bpy.types.Image)
    zone: StringProperty(
        name="Zone",
        description="Layers of one zone lie on each other, zones side by side; either every layer has one or none",
    )


class RugaShape(bpy.types.PropertyGroup):
    """A shape key, and whether it is baked."""

    name: StringProperty(name="Shape Key")
    use: BoolProperty(name="Bake", default=True)


class RugaObject(bpy.types.PropertyGroup):
    """Settings and results of an object."""

    folder: StringProperty(
        name="Folder", description="Mesh, scene and maps go into a folder in here", subtype="DIR_PATH", default="//ruga/"
    )
    uv_map: StringProperty(name="UV Map", description="Left empty: the one that is rendered")
    layers: CollectionProperty(type=RugaLayer)
    active_layer: IntProperty()
    shapes: CollectionProperty(type=RugaShape)
    active_shape: IntProperty()
    join_sides: BoolProperty(
        name="Left and Right Together",
        description="One pose for shapes that differ in _L and _R, .L and .R or Left and Right alone",
    )
    keys: StringProperty(
        name="Keys", description="Fractions of a shape at which maps are baked, above 0 and up to 1", default="0.5, 1"
    )
    size: EnumProperty(
        name="Size",
        items=[(str(size), str(size), f"Maps of {size} x {size} texels") for size in (256, 512, 1024, 2048, 4096, 8192)],
        default="2048",
    )
    quality: EnumProperty(
        name="Quality",
        items=(
            ("DRAFT", "Draft", "6 points per wavelength, for a first look"),
            ("STANDARD", "Standard", "12 points per wavelength"),
            ("FINE", "Fine", "24 points per wavelength, about eight times the work of a draft"),
        ),
    )
    threads: IntProperty(name="Threads", description="0: one per core", default=0, min=0, max=256)
    # The node group is the object's own, as its drivers read this object's shape keys.
    group: PointerProperty(type=bpy.types.NodeTree)


def refresh_shapes(subject: bpy.types.Object) -> None:
    """Lists the shape keys as they are now; ticks stay where names do."""
    ticks = {shape.name: shape.use for shape in subject.ruga.shapes}
    subject.ruga.shapes.clear()
    keys = subject.data.shape_keys
    for block in keys.key_blocks if keys else ():
        if block.name != keys.reference_key.name:
            shape = subject.ruga.shapes.add()
            shape.name, shape.use = block.name, ticks.get(block.name, True)
