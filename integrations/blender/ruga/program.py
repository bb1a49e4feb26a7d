"""The program `ruga`, run beside Blender.

A `Run` is one call: threads read what it prints, so that nothing here waits. Knows nothing of
Blender.
"""

import os
import re
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path

from .errors import RugaError

# Lines that `ruga bake` prints on stderr where that is no terminal.
STARTED = re.compile(r"pose `(?P<name>.*)` \((?P<number>\d+) of (?P<total>\d+)\) started")
ENDED = re.compile(r"pose `(?P<name>.*)`: (?P<how>.*)")
KEPT = re.compile(r"pose `(?P<name>.*)` is there from an earlier run(?: at .* it is kept.*)?")
# A pose in work counts as finished up to this fraction, however long it takes.
ALMOST = 0.95


def find_program(chosen: str) -> str:
    """The path of `ruga`: the one chosen in the preferences, or else the one on the PATH."""
    if chosen:
        if Path(chosen).is_file() and os.access(chosen, os.X_OK):
            return chosen
        raise RugaError(
            f"{chosen}, named in the preferences of the extension, is not a program: "
            "choose the file `ruga` (`ruga.exe` on Windows) there, or leave the field empty to search the PATH"
        )
    found = shutil.which("ruga")
    if found is None:
        raise RugaError(
            "The program `ruga` is not on the PATH. Install it (`cargo install --path crates/ruga-cli` in "
            "ruga's repository) or name it in Preferences > Add-ons > ruga wrinkle maps"
        )
    return found


class Run:
    """A running `ruga`; `poll` says whether it has ended."""

    def __init__(self, command: list[str]) -> None:
        # A group of its own lets Windows interrupt it without interrupting Blender.
        flags = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
        try:
            self.process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                creationflags=flags,
            )
        except OSError as error:
            raise RugaError(f"{command[0]} cannot be started: {error}") from error
        self.printed: list[str] = []
        self.said: list[str] = []
        self.cancelled = False
        streams = ((self.process.stdout, self.printed), (self.process.stderr, self.said))
        self.readers = [threading.Thread(target=collect, args=pair, daemon=True) for pair in streams]
        for reader in self.readers:
            reader.start()

    def poll(self) -> int | None:
        """The exit code, once the program has ended and all that it said is here."""
        code = self.process.poll()
        if code is not None:
            for reader in self.readers:
                reader.join()
        return code

    def cancel(self) -> None:
        """Asks the program to stop as Ctrl-C does: finished poses and keys are kept."""
        self.cancelled = True
        if self.process.poll() is not None:
            return
        try:
            if os.name == "nt":
                self.process.send_signal(signal.CTRL_BREAK_EVENT)
            else:
                self.process.send_signal(signal.SIGINT)
        except OSError:
            # Without a console nothing can be asked; poses that are finished are on disk.
            self.process.terminate()

    def complaint(self) -> str:
        """The program's error in one line, or the last that it said."""
        for index, line in enumerate(self.said):
            if line.startswith("error"):
                return " ".join(part.strip() for part in self.said[index:])
        return self.said[-1] if self.said else "it said nothing"


def collect(stream, lines: list[str]) -> None:
    """Reads a stream to its end, line by line."""
    with stream:
        for line in stream:
            lines.append(line.rstrip("\n"))


class PoseProgress:
    """How far a bake is, from the lines it prints and the seconds that its plan expects."""

    def __init__(self, seconds: dict[str, float]) -> None:
        self.seconds = {name: max(expected, 0.01) for name, expected in seconds.items()}
        self.started: dict[str, float] = {}
        self.ended: dict[str, str] = {}
        self.read = 0

    def update(self, lines: list[str]) -> None:
        """Takes in what was printed since the last call."""
        for line in lines[self.read :]:
            if match := STARTED.fullmatch(line):
                self.started[match["name"]] = time.monotonic()
            elif (match := ENDED.fullmatch(line)) and match["name"] in self.started:
                self.ended[match["name"]] = match["how"]
            elif match := KEPT.fullmatch(line):
                self.ended[match["name"]] = "kept"
        self.read = len(lines)

    def fraction(self) -> float:
        """Finished seconds over all seconds; a pose in work counts by its time so far."""
        now, done = time.monotonic(), 0.0
        for name, expected in self.seconds.items():
            if name in self.ended:
                done += expected
            elif name in self.started:
                done += min(now - self.started[name], ALMOST * expected)
        return done / max(sum(self.seconds.values()), 0.01)

    def text(self) -> str:
        """One line for the artist: the poses in work, and how many are done."""
        working = [name for name in self.started if name not in self.ended]
        what = ", ".join(working[:2]) + (" ..." if len(working) > 2 else "")
        return f"{len(self.ended)} of {len(self.seconds)} poses done" + (f", {what}" if what else "")
