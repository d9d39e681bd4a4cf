"""The denoisers, ours and others, each as a command from file to file, with time and memory."""

import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from measure import read

MAX_SECONDS = 900
# Grids for tuning with the clean mesh at hand: width of the range weight, rounds of the normals. They include the defaults.
RANGES, ROUNDS = (0.2, 0.3, 0.35, 0.4, 0.55), (5, 10, 20)
PASS_BANDS, DEGREE = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6), 20


class Failure(Exception):
    """A program that failed, with its message."""


@dataclass
class Result:
    """A result: its file, seconds of the step or of the whole command, peak memory of the process in bytes."""

    path: Path
    seconds: float
    peak: int

    @property
    def mesh(self):
        return read(self.path)


def command(words):
    """Runs a command; returns its output, wall seconds and peak memory in bytes."""
    words = [str(w) for w in words]
    with tempfile.NamedTemporaryFile("r") as usage:
        launch = [sys.executable, "-I", "-S", Path(__file__).with_name("launch.py"), usage.name, *words]
        with subprocess.Popen(launch, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
            try:
                out, err = process.communicate(timeout=MAX_SECONDS)
            except subprocess.TimeoutExpired as error:
                os.killpg(process.pid, signal.SIGKILL)
                raise Failure("took too long") from error
        seconds, _, peak = usage.read().partition(" ")
    if process.returncode:
        message = (err.strip().splitlines() or [f"exit code {process.returncode}"])[-1]
        raise Failure(f"{Path(words[0]).name} {words[1]}: {message}")
    return out, float(seconds), int(peak)


def run_timed(words, out, whole=False):
    """The result of a command that writes `out`; its seconds are those that it prints last or, with `whole`, of all of it."""
    output, seconds, peak = command(words)
    return Result(out, seconds if whole else float(output.split()[-1]), peak)


class Programs:
    """The programs to compare, as functions from a noisy file and an output path to a `Result`."""

    def __init__(self, adwave, steps, work):
        self.adwave, self.steps, self.work = adwave, steps, work
        found = subprocess.run([adwave, "denoise", "--help"], capture_output=True)
        self.has_denoise = found.returncode == 0

    def ours(self, noisy, out):
        """`adwave denoise` without options; a build without it filters by `suppress` with four levels. Whole commands."""
        words = ["denoise", noisy] if self.has_denoise else ["filter", noisy, "--preset", "suppress", "--levels", 4]
        return run_timed([self.adwave, *words, "-o", out, "--quiet"], out, whole=True)

    def step(self, name, *parameters):
        """A step of our program `denoise_case`, on a file."""
        return lambda noisy, out: run_timed([self.steps, name, *parameters, noisy, out], out)

    def library(self, name):
        """The denoiser of a library, by `rival.py`."""
        script = Path(__file__).with_name("rival.py")
        return lambda noisy, out: run_timed([sys.executable, script, name, noisy, out], out)

    def defaults(self):
        """Programs that run without tuning, by their names in the tables."""
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
        """The settings of each tuned method, as pairs of a label and a program."""
        grid = lambda name: [(f"{r:g}, {n}", self.step(name, r, n, "-")) for r in RANGES for n in ROUNDS]
        return {
            "bilateral, tuned": grid("bilateral"),
            "guided, tuned": grid("guided"),
            "windowed sinc, tuned": [(f"{p:g}", self.step("sinc", p, DEGREE)) for p in PASS_BANDS],
        }
