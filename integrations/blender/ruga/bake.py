"""One bake: export, plan, run, wiring. Polled by an operator, or waited for by a script."""

import json
from pathlib import Path

import bpy

from .errors import RugaError
from .export import chosen_uv_map, export, legal_name
from .preferences import program
from .program import PoseProgress, Run
from .results import read_results
from .wiring import load_results

# Bakes in work by the name of their object: an object has one at a time.
RUNNING: dict[str, "Bake"] = {}


def work_folder(subject: bpy.types.Object) -> Path:
    """The folder of mesh, scene and results of an object."""
    chosen = subject.ruga.folder
    if not chosen:
        raise RugaError("Choose a folder for the maps")
    if chosen.startswith("//") and not bpy.data.filepath:
        raise RugaError("Save the .blend file first, or choose a folder that does not begin with //")
    return Path(bpy.path.abspath(chosen)).resolve() / legal_name(subject.name)


def result_folder(subject: bpy.types.Object) -> Path:
    """The folder that `ruga bake` fills."""
    return work_folder(subject) / "out"


class Bake:
    """A bake of one object: `plan` first, then `bake`, both beside Blender.

    The plan refuses a scene that cannot be simulated before there is any result, and says how long
    each pose takes, from which the progress is told.
    """

    def __init__(self, context: bpy.types.Context, subject: bpy.types.Object) -> None:
        if subject is not None and subject.name in RUNNING:
            raise RugaError(f"`{subject.name}` is being baked already")
        self.program = program(context)
        self.scene = export(context, subject, work_folder(subject))
        self.subject_name = subject.name
        self.uv_map = chosen_uv_map(subject)
        self.out = result_folder(subject)
        self.quality = subject.ruga.quality.lower()
        self.threads = subject.ruga.threads
        self.progress: PoseProgress | None = None
        self.warnings: list[str] = []
        self.run = Run([self.program, "plan", str(self.scene), "--json", "--quality", self.quality])
        RUNNING[self.subject_name] = self

    def poll(self) -> bool:
        """Goes on where it can; whether all is done. Raises what `ruga` complains about."""
        try:
            return self.advance()
        except RugaError:
            RUNNING.pop(self.subject_name, None)
            raise

    def advance(self) -> bool:
        """One look at the program that runs."""
        code = self.run.poll()
        if self.progress is not None:
            self.progress.update(self.run.said)
        if code is None:
            return False
        if self.run.cancelled and self.progress is None:
            RUNNING.pop(self.subject_name, None)
            return True
        if code not in (0, 1):
            raise RugaError(f"ruga: {self.run.complaint()}")
        if self.progress is None:
            self.start_baking()
            return False
        self.warnings = [line for line in self.run.said if line.startswith("warning")]
        RUNNING.pop(self.subject_name, None)
        return True

    def start_baking(self) -> None:
        """From the plan to the bake."""
        try:
            poses = json.loads("\n".join(self.run.printed))["poses"]
            self.progress = PoseProgress({pose["name"]: float(pose["seconds"]) for pose in poses})
        except (ValueError, KeyError, TypeError) as error:
            raise RugaError(f"`{self.program} plan --json` is not understood ({error!r}): update ruga") from error
        command = [self.program, "bake", str(self.scene), "-o", str(self.out), "--resume", "--maps-only"]
        command += ["--quality", self.quality]
        if self.threads:
            command += ["--threads", str(self.threads)]
        self.run = Run(command)

    def cancel(self) -> None:
        """Asks `ruga` to stop; finished poses and keys stay, and the next bake goes on from there."""
        self.run.cancel()

    @property
    def cancelled(self) -> bool:
        """Whether it was asked to stop."""
        return self.run.cancelled

    def fraction(self) -> float:
        """From 0 to 1."""
        return self.progress.fraction() if self.progress else 0.0

    def text(self) -> str:
        """What is being done."""
        if self.cancelled:
            return "stopping; finished poses are kept"
        return self.progress.text() if self.progress else "planning"

    def wire(self) -> list[str]:
        """Shows what is finished on the object; the poses' names, none where nothing is finished."""
        subject = bpy.data.objects.get(self.subject_name)
        if subject is None:
            raise RugaError(f"`{self.subject_name}` is gone: its maps are in {self.out}")
        if self.cancelled and not ((self.out / "wrinkles.json").is_file() and read_results(self.out)):
            return []
        return load_results(subject, self.out, self.uv_map)

    def wait(self) -> None:
        """Waits for the end: for scripts, and where Blender has no window."""
        while not self.poll():
            self.run.process.wait()
