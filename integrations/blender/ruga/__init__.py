"""Wrinkle maps for shape keys, baked by the program `ruga` and driven by the keys."""

import bpy

from . import operators, panel
from .bake import RUNNING
from .preferences import RugaPreferences
from .properties import RugaLayer, RugaObject, RugaShape

CLASSES = (RugaPreferences, RugaLayer, RugaShape, RugaObject, *operators.CLASSES, *panel.CLASSES)


def register() -> None:
    """Called by Blender when the extension is switched on."""
    for item in CLASSES:
        bpy.utils.register_class(item)
    bpy.types.Object.ruga = bpy.props.PointerProperty(type=RugaObject)


def unregister() -> None:
    """Called by Blender when the extension is switched off; a bake in work is asked to stop."""
    for bake in list(RUNNING.values()):
        bake.cancel()
    RUNNING.clear()
    del bpy.types.Object.ruga
    for item in reversed(CLASSES):
        bpy.utils.unregister_class(item)
