"""The panel in the sidebar of the 3D viewport, tab `ruga`."""

import bpy

from .bake import RUNNING
from .node_group import STRENGTH_NODE
from .operators import (
    RUGA_OT_add_layer,
    RUGA_OT_bake,
    RUGA_OT_cancel,
    RUGA_OT_export,
    RUGA_OT_load,
    RUGA_OT_refresh_shapes,
    RUGA_OT_remove,
    RUGA_OT_remove_layer,
    RUGA_OT_tick_shapes,
)


class RUGA_UL_layers(bpy.types.UIList):
    """Layers, bottom first."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index) -> None:
        """Name, and what it is."""
        layout.prop(item, "name", text="", emboss=False)
        layout.label(text=item.preset if item.kind == "PRESET" else "by wavelength")


class RUGA_UL_shapes(bpy.types.UIList):
    """Shape keys with ticks."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index) -> None:
        """Tick and name."""
        layout.prop(item, "use", text=item.name)


class RUGA_PT_wrinkles(bpy.types.Panel):
    """Layers, shapes, bake and results of the active object."""

    bl_label = "Wrinkles"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "ruga"

    def draw(self, context: bpy.types.Context) -> None:
        """From top to bottom what is done from first to last."""
        subject, layout = context.object, self.layout
        if subject is None or subject.type != "MESH":
            layout.label(text="Select a mesh with shape keys")
            return
        layout.use_property_split = True
        draw_layers(layout, subject)
        draw_shapes(layout, subject)
        draw_bake(layout, subject)
        draw_results(layout, subject)


def draw_layers(layout: bpy.types.UILayout, subject: bpy.types.Object) -> None:
    """The list of layers and the chosen one's settings."""
    settings = subject.ruga
    layout.label(text="Layers, bottom first")
    row = layout.row()
    row.template_list("RUGA_UL_layers", "", settings, "layers", settings, "active_layer", rows=2)
    column = row.column(align=True)
    column.operator(RUGA_OT_add_layer.bl_idname, text="", icon="ADD")
    column.operator(RUGA_OT_remove_layer.bl_idname, text="", icon="REMOVE")
    if not 0 <= settings.active_layer < len(settings.layers):
        return
    layer, column = settings.layers[settings.active_layer], layout.column()
    column.prop(layer, "kind")
    if layer.kind == "PRESET":
        column.prop(layer, "preset")
    else:
        column.prop(layer, "wavelength")
        column.prop(layer, "critical_strain")
    column.prop(layer, "strength")
    column.prop(layer, "mask_kind")
    if layer.mask_kind == "GROUP":
        column.prop_search(layer, "vertex_group", subject, "vertex_groups")
    elif layer.mask_kind == "IMAGE":
        column.template_ID(layer, "image", open="image.open")
    if len(settings.layers) > 1:
        column.prop(layer, "zone")


def draw_shapes(layout: bpy.types.UILayout, subject: bpy.types.Object) -> None:
    """Which shape keys are baked."""
    settings = subject.ruga
    row = layout.row()
    row.label(text="Shape keys" if settings.shapes else "Shape keys: all")
    row.operator(RUGA_OT_tick_shapes.bl_idname, text="All").use = True
    row.operator(RUGA_OT_tick_shapes.bl_idname, text="None").use = False
    row.operator(RUGA_OT_refresh_shapes.bl_idname, text="", icon="FILE_REFRESH")
    if settings.shapes:
        layout.template_list("RUGA_UL_shapes", "", settings, "shapes", settings, "active_shape", rows=4)
    layout.prop(settings, "join_sides")


def draw_bake(layout: bpy.types.UILayout, subject: bpy.types.Object) -> None:
    """Settings of the bake and its button, or its progress."""
    settings, column = subject.ruga, layout.column()
    column.prop_search(settings, "uv_map", subject.data, "uv_layers")
    column.prop(settings, "keys")
    column.prop(settings, "size")
    column.prop(settings, "quality")
    column.prop(settings, "threads")
    column.prop(settings, "folder")
    bake = RUNNING.get(subject.name)
    if bake is None:
        layout.operator(RUGA_OT_bake.bl_idname, icon="RENDER_STILL")
        layout.operator(RUGA_OT_export.bl_idname)
        return
    layout.progress(factor=bake.fraction(), text=f"{100 * bake.fraction():.0f} %: {bake.text()}")
    layout.operator(RUGA_OT_cancel.bl_idname, icon="CANCEL")


def draw_results(layout: bpy.types.UILayout, subject: bpy.types.Object) -> None:
    """What is shown on the object."""
    layout.operator(RUGA_OT_load.bl_idname, icon="FILE_FOLDER")
    group = subject.ruga.group
    strength = group.nodes.get(STRENGTH_NODE) if group else None
    if strength is not None:
        layout.prop(strength.outputs[0], "default_value", text="Strength")
        layout.operator(RUGA_OT_remove.bl_idname, icon="X")


CLASSES = (RUGA_UL_layers, RUGA_UL_shapes, RUGA_PT_wrinkles)
