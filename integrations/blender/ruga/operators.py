"""What the buttons do."""

from pathlib import Path

import bpy

from .bake import RUNNING, Bake, work_folder
from .errors import RugaError
from .export import check_shown, chosen_uv_map, export
from .properties import refresh_shapes
from .wiring import disconnect, load_results

# Seconds between two looks at the program.
INTERVAL = 0.2


class ObjectOperator:
    """Operators on the active object: a `RugaError` becomes the message that the artist sees."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only for meshes."""
        return context.object is not None and context.object.type == "MESH"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Acts, or says why not."""
        try:
            self.act(context, context.object)
        except RugaError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class RUGA_OT_bake(ObjectOperator, bpy.types.Operator):
    """Bake the wrinkles of the ticked shape keys beside Blender, then drive them with the shape keys"""

    bl_idname = "ruga.bake"
    bl_label = "Bake Wrinkles"

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Waits for the end: what a script or a Blender without a window does."""
        bake = Bake(context, subject)
        bake.wait()
        self.end(bake)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts the bake and comes back to it with a timer."""
        if bpy.app.background:
            return self.execute(context)
        try:
            self.bake = Bake(context, context.object)
        except RugaError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self.timer = manager.event_timer_add(INTERVAL, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Looks at the program now and then; Esc asks it to stop."""
        if event.type == "ESC" and event.value == "PRESS":
            self.bake.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        redraw(context)
        try:
            if not self.bake.poll():
                return {"PASS_THROUGH"}
            self.end(self.bake)
        except RugaError as error:
            self.report({"ERROR"}, str(error))
            self.stop(context)
            return {"CANCELLED"}
        except BaseException:
            # Whatever it was, the next bake must be able to begin.
            self.stop(context)
            raise
        self.stop(context)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender closes, or opens another file: nothing may go on running."""
        self.bake.cancel()
        self.stop(context)

    def stop(self, context: bpy.types.Context) -> None:
        """Leaves no timer behind."""
        RUNNING.pop(self.bake.subject_name, None)
        context.window_manager.event_timer_remove(self.timer)
        redraw(context)

    def end(self, bake: Bake) -> None:
        """Wires what is finished, and says what it is."""
        names = bake.wire()
        for warning in bake.warnings:
            self.report({"WARNING"}, warning.removeprefix("warning: "))
        if bake.cancelled:
            self.report({"WARNING"}, f"Stopped; {len(names)} finished poses are kept. Bake goes on from there")
        else:
            self.report({"INFO"}, f"{len(names)} poses wrinkle: {', '.join(names)}")


class RUGA_OT_cancel(bpy.types.Operator):
    """Stop the bake; finished poses are kept, and the next bake goes on from there"""

    bl_idname = "ruga.cancel"
    bl_label = "Stop"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Asks the active object's bake to stop."""
        bake = RUNNING.get(context.object.name) if context.object else None
        if bake is None:
            return {"CANCELLED"}
        bake.cancel()
        return {"FINISHED"}


class RUGA_OT_export(ObjectOperator, bpy.types.Operator):
    """Write mesh, masks and scene for ruga without baking, for another machine or a farm"""

    bl_idname = "ruga.export"
    bl_label = "Export Only"

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Writes the files and says where."""
        self.report({"INFO"}, f"Written: {export(context, subject, work_folder(subject))}")


class RUGA_OT_load(ObjectOperator, bpy.types.Operator):
    """Show the maps of a folder that `ruga bake` filled, here or elsewhere"""

    bl_idname = "ruga.load"
    bl_label = "Load Result Folder"

    directory: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for the folder."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Wires the maps that are there."""
        check_shown(subject)
        names = load_results(subject, Path(bpy.path.abspath(self.directory)).resolve(), chosen_uv_map(subject))
        self.report({"INFO"}, f"{len(names)} poses wrinkle: {', '.join(names)}")


class RUGA_OT_remove(ObjectOperator, bpy.types.Operator):
    """Take the wrinkles out of the materials again; the maps stay on disk"""

    bl_idname = "ruga.remove"
    bl_label = "Remove from Materials"

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Takes this extension's nodes out and restores the link that they replaced."""
        self.report({"INFO"}, f"Wrinkles taken out of {disconnect(subject)} materials")


class RUGA_OT_refresh_shapes(ObjectOperator, bpy.types.Operator):
    """List the shape keys as they are now"""

    bl_idname = "ruga.refresh_shapes"
    bl_label = "Refresh Shape Keys"

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Fills the list."""
        refresh_shapes(subject)


class RUGA_OT_tick_shapes(ObjectOperator, bpy.types.Operator):
    """Tick all shape keys, or none"""

    bl_idname = "ruga.tick_shapes"
    bl_label = "Tick Shape Keys"

    use: bpy.props.BoolProperty(name="Tick", default=True)

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Lists and ticks."""
        refresh_shapes(subject)
        for shape in subject.ruga.shapes:
            shape.use = self.use


class RUGA_OT_add_layer(ObjectOperator, bpy.types.Operator):
    """Add a layer of skin, on top of those above it in the list"""

    bl_idname = "ruga.add_layer"
    bl_label = "Add Layer"

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Adds it with a name of its own."""
        taken = {layer.name for layer in subject.ruga.layers}
        layer = subject.ruga.layers.add()
        names = ["skin", *(f"skin {number}" for number in range(2, len(taken) + 3))]
        layer.name = next(name for name in names if name not in taken)
        subject.ruga.active_layer = len(subject.ruga.layers) - 1


class RUGA_OT_remove_layer(ObjectOperator, bpy.types.Operator):
    """Remove the chosen layer"""

    bl_idname = "ruga.remove_layer"
    bl_label = "Remove Layer"

    def act(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        """Removes it; the one before is chosen then."""
        settings = subject.ruga
        settings.layers.remove(settings.active_layer)
        settings.active_layer = max(min(settings.active_layer, len(settings.layers) - 1), 0)


def redraw(context: bpy.types.Context) -> None:
    """Lets the panel show the progress."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


CLASSES = (
    RUGA_OT_bake,
    RUGA_OT_cancel,
    RUGA_OT_export,
    RUGA_OT_load,
    RUGA_OT_remove,
    RUGA_OT_refresh_shapes,
    RUGA_OT_tick_shapes,
    RUGA_OT_add_layer,
    RUGA_OT_remove_layer,
)
