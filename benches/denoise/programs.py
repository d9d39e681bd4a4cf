"""What removes noise: ours and the rivals, each as a command from file to file, with time and memory."""

import os
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from measure import read

MOST_SECONDS = 900
# Grids that the rivals are tuned on, the clean mesh at hand: width of the range weight, rounds of the normals.
RANGES, ROUNDS = (0.2, 0.3, 0.4, 0.55), (5, 10, 20)
# The same for guided normals, whose rounds have rounds of vertices in them.
GUIDED_ROUNDS = (5, 10, 20)
PASS_BANDS, DEGREE = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6), 20


class Failure(Exception):
    """What a program said when it failed."""


@dataclass
class Ran:
    """A result: the mesh, seconds of the step or of the whole command, highest memory of the process in bytes."""

    mesh: object
    seconds: float
    peak: int


def command(words):
    """Output, wall seconds and highest memory of a command."""
    start = time.perf_counter()
    with subprocess.Popen([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        stop = threading.Timer(MOST_SECONDS, process.kill)
        stop.start()
        out, err = process.stdout.read(), process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        stop.cancel()
    seconds = time.perf_counter() - start
    if process.returncode:
        said = (err.strip().splitlines() or [f"exit code {process.returncode}"])[-1]
        raise Failure(f"{Path(words[0]).name} {words[1]}: {said}" if seconds < MOST_SECONDS else "took too long")
    scale = 1 if sys.platform == "darwin" else 1024
    return out, seconds, usage.ru_maxrss * scale


class Programs:
    def __init__(self, adwave, steps, work):
        self.adwave, self.steps, self.work = adwave, steps, work
        found = subprocess.run([adwave, "denoise", "--help"], capture_output=True)
        self.has_denoise = found.returncode == 0

    def ours(self, noisy, out):
        """`adwave denoise` without options; in a build that has none, four levels of `suppress`. Whole commands."""
        words = ["denoise", noisy] if self.has_denoise else ["filter", noisy, "--preset", "suppress", "--levels", 4]
        _, seconds, peak = command([self.adwave, *words, "-o", out, "--quiet"])
        return Ran(read(out), seconds, peak)

    def step(self, name, *parameters):
        """A step of our own `denoise_case`, on a file."""
        def run(noisy, out):
            said, _, peak = command([self.steps, name, *parameters, noisy, out])
            return Ran(read(out), float(said), peak)
        return run

    def library(self, name):
        def run(noisy, out):
            said, _, peak = command([sys.executable, Path(__file__).with_name("rival.py"), name, noisy, out])
            return Ran(read(out), float(said.split()[-1]), peak)
        return run

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
        grid = lambda name, rounds: [(f"{r:g}, {n}", self.step(name, r, n, "-")) for r in RANGES for n in rounds]
        return {
            "bilateral, tuned": grid("bilateral", ROUNDS),
            "guided, tuned": grid("guided", GUIDED_ROUNDS),
            "windowed sinc, tuned": [(f"{p:g}", self.step("sinc", p, DEGREE)) for p in PASS_BANDS],
        }
