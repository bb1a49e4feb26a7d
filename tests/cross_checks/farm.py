"""Runs `ruga job` with Open Job Description's own runner and compares with `ruga bake`.

    python farm.py [SCENE]

SCENE is the forearm of `assets/` unless another one is given. The package `openjd-cli` goes into a virtual
environment that is thrown away afterwards; `ruga` is that of `target/release`. Checked are:

- the template, by `openjd check`;
- a merge before there is anything to merge: it fails;
- tasks that `openjd run` starts one by one, all at a time as on several machines, and then the merge;
- the whole job in one `openjd run`, with other values of the parameters Output and Quality.

Both times the folder has the files of `ruga bake` with the same bytes, but for `seconds`, the times in
report.json and poses/*.json. The exit code is 1 where anything differs or fails.
"""

import json
import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
RELEASE = REPOSITORY / "target" / "release"
# The runner's version that this was last looked at with.
PACKAGE = "openjd-cli==0.8.0"


class Runner:
    """The command `openjd` in an environment of its own, with `ruga` on the path."""

    def __init__(self, folder):
        venv.create(folder, with_pip=True)
        self.programs = folder / ("Scripts" if os.name == "nt" else "bin")
        self.call("python", "-m", "pip", "install", "--quiet", PACKAGE)

    def start(self, program, *arguments):
        """A process, and what it says."""
        path = os.pathsep.join([str(RELEASE), os.environ["PATH"]])
        return subprocess.Popen(
            [str(self.programs / program), *map(str, arguments)],
            env={**os.environ, "PATH": path},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def call(self, *line):
        end(self.start(*line))


def end(process, expected=0):
    """Waits for a process; anything but the expected end ends the check, too."""
    said = process.communicate()[0]
    if (process.returncode == 0) != (expected == 0):
        sys.exit(f"{process.args} ended with {process.returncode}:\n{said}")


def ruga(*arguments):
    subprocess.run([RELEASE / "ruga", *arguments], check=True, stdout=subprocess.DEVNULL)


def without_times(value):
    """JSON without the measured times."""
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k != "seconds"}
    if isinstance(value, list):
        return [without_times(v) for v in value]
    return value


def compare(farm, bake):
    """Names the files that differ; their number."""
    names = {p.relative_to(folder) for folder in (farm, bake) for p in folder.rglob("*")}
    differing = 0
    for name in sorted(names):
        pair = [folder / name for folder in (farm, bake)]
        if not all(path.exists() for path in pair):
            same = False
        elif pair[0].is_dir():
            same = True
        elif name.name == "report.json" or name.parts[0] == "poses" and name.suffix == ".json":
            same = without_times(json.loads(pair[0].read_bytes())) == without_times(
                json.loads(pair[1].read_bytes())
            )
        else:
            same = pair[0].read_bytes() == pair[1].read_bytes()
        if not same:
            differing += 1
            print(f"{name} differs")
    print(f"{len(names)} files and folders, {differing} differ")
    return differing


def main(scene):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        runner = Runner(folder / "venv")
        job = folder / "job"
        ruga("job", scene, "-o", job)
        template = job / "template.json"
        values = ["--job-param", f"file://{job / 'parameters.json'}"]
        runner.call("openjd", "check", template)

        end(runner.start("openjd", "run", template, *values, "--step", "Merge"), expected=1)
        steps = json.loads(template.read_text(encoding="utf-8"))["steps"]
        poses = steps[0]["parameterSpace"]["taskParameterDefinitions"][0]["range"]
        one = ["openjd", "run", template, *values, "--step", "Bake", "--task-param"]
        for task in [runner.start(*one, f"Pose={pose}") for pose in poses]:
            end(task)
        runner.call("openjd", "run", template, *values, "--step", "Merge")
        bake = folder / "bake" / "out"
        ruga("bake", scene, "-o", bake)
        print(f"{len(poses)} tasks at a time:", end=" ")
        differing = compare(job / "out", bake)

        draft = folder / "draft"
        values += ["--job-param", f"Output={draft / 'farm'}", "--job-param", "Quality=draft"]
        runner.call("openjd", "run", template, *values)
        ruga("bake", scene, "-o", draft / "bake", "--quality", "draft")
        print("the whole job, draft quality:", end=" ")
        differing += compare(draft / "farm", draft / "bake")
    return 1 if differing else 0


if __name__ == "__main__":
    forearm = REPOSITORY / "assets" / "forearm" / "scene.toml"
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else forearm).resolve()))
