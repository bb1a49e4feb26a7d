"""Preferences of the extension: where `ruga` is."""

import bpy

from .program import find_program


class RugaPreferences(bpy.types.AddonPreferences):
    """The program's path; empty searches the PATH."""

    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program",
        description="The program ruga; left empty, it is searched on the PATH",
        subtype="FILE_PATH",
    )

    def draw(self, context: bpy.types.Context) -> None:
        """The one field."""
        self.layout.prop(self, "program")


def program(context: bpy.types.Context) -> str:
    """The path of `ruga`, from the preferences or the PATH."""
    addon = context.preferences.addons.get(__package__)
    chosen = addon.preferences.program if addon and addon.preferences else ""
    return find_program(bpy.path.abspath(chosen) if chosen else "")
