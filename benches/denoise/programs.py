"""What removes noise: ours and the rivals, each as a command from file to file, with time and memory."""

import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from measure import read

MOST_SECONDS = 900
# Grids that the rivals are tuned on, the clean mesh at hand: width of the range weight, rounds of the normals. The defaults
# are among them.
RANGES, ROUNDS = (0.2, 0.3, 0.35, 0.4, 0.55), (5, 10, 20)
PASS_BANDS, DEGREE = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6), 20


class Failure(Exception):
    """What a program said when it failed."""


@dataclass
class Ran:
    """A result: its file, seconds of the step or of the whole command, highest memory of the process in bytes."""

    path: Path
    seconds: float
    peak: int

    @property
    def mesh(self):
        return read(self.path)


def command(words):
    """Output, wall seconds and highest memory of a command."""
    words = [str(w) for w in words]
    with tempfile.NamedTemporaryFile("r") as usage:
        launch = [sys.executable, "-I", "-S", Path(__file__).with_name("launch.py"), usage.name, *words]
        with subprocess.Popen(launch, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
            try:
                out, err = process.communicate(timeout=MOST_SECONDS)
            except subprocess.TimeoutExpired as late:
                os.killpg(process.pid, signal.SIGKILL)
                raise Failure("took too long") from late
        seconds, _, peak = usage.read().partition(" ")
    if process.returncode:
        said = (err.strip().splitlines() or [f"exit code {process.returncode}"])[-1]
        raise Failure(f"{Path(words[0]).name} {words[1]}: {said}")
    return out, float(seconds), int(peak)


def timed(words, out, whole=False):
    """A command that writes `out`; its seconds are those of all of it, or those that it prints last."""
    said, seconds, peak = command(words)
    return Ran(out, seconds if whole else float(said.split()[-1]), peak)


class Programs:
    def __init__(self, adwave, steps, work):
        self.adwave, self.steps, self.work = adwave, steps, work
        found = subprocess.run([adwave, "denoise", "--help"], capture_output=True)
        self.has_denoise = found.returncode == 0

    def ours(self, noisy, out):
        """`adwave denoise` without options; in a build that has none, four levels of `suppress`. Whole commands."""
        words = ["denoise", noisy] if self.has_denoise else ["filter", noisy, "--preset", "suppress", "--levels", 4]
        return timed([self.adwave, *words, "-o", out, "--quiet"], out, whole=True)

    def step(self, name, *parameters):
        """A step of our own `denoise_case`, on a file."""
        return lambda noisy, out: timed([self.steps, name, *parameters, noisy, out], out)

    def library(self, name):
        script = Path(__file__).with_name("rival.py")
        return lambda noisy, out: timed([sys.executable, script, name, noisy, out], out)

    def defaults(self):
        """Programs that are run without knobs, by the names of the tables."""
        return {
            "adwave": self.ours,
            "bilateral": self.step("bilateral", "-", "-", "-"),
            "guided": self.step("guided", "-", "-", "-"),
            "MeshLib": self.library("meshlib"),
            "MeshLab two-step": self.library("two-step"),
            "MeshLab Taubin": self.library("taubin"),
            "windowed sinc": self.step("sinc", "-", "-"),
        }

    def tuned(self):
        """For each method its settings as (words, program)."""
        grid = lambda name: [(f"{r:g}, {n}", self.step(name, r, n, "-")) for r in RANGES for n in ROUNDS]
        return {
            "bilateral, tuned": grid("bilateral"),
            "guided, tuned": grid("guided"),
            "windowed sinc, tuned": [(f"{p:g}", self.step("sinc", p, DEGREE)) for p in PASS_BANDS],
        }
