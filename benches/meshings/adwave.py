"""The command `adwave`, run as a user runs it."""

import json
import os
import re
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

# Accuracy of bands, far below the differences that are measured here.
ACCURACY = 1e-6
WALK, SURFACE = "walk", "surface"


class Failure(Exception):
    """A command that failed, with its message."""


@dataclass(frozen=True)
class Transformed:
    """Bands W_f(1) … W_f(J) (J × n × d), widths σ_0 … σ_J, the JSON of the command, its peak memory in bytes."""

    wavelet: np.ndarray
    sigma: np.ndarray
    info: dict
    peak: int


class Adwave:
    """The command, with a folder for its results."""

    def __init__(self, binary, work):
        self.binary, self.work = binary, work
        work.mkdir(parents=True, exist_ok=True)

    @cached_property
    def operators(self):
        """The operators of this build; a build without the option has only the walk."""
        options = subprocess.run([self.binary, "transform", "--help"], capture_output=True, text=True, check=True).stdout
        return (WALK, SURFACE) if re.search(r"--operator\b", options) else (WALK,)

    def operator_option(self, operator):
        """The words that select an operator, if the build has the option."""
        return ["--operator", operator] if len(self.operators) > 1 else []

    def run(self, *words):
        """The JSON object that the command prints."""
        command = [str(w) for w in (self.binary, *words, "--json", "--quiet")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            out, err = process.communicate()
        if process.returncode:
            message = (err.strip().splitlines() or [f"exit code {process.returncode}"])[0]
            raise Failure(f"adwave {words[0]}: {message.replace(f'{Path(words[1]).parent}{os.sep}', '')}")
        return json.loads(out) if out.strip() else {}

    def transform(self, mesh, lengths, operator, *, field=None, kind="mesh", accuracy=ACCURACY):
        """The bands of the coordinates, or of `field`, at widths `lengths` in model units."""
        out = self.work / "bands.npz"
        signal = [] if field is None else ["--field", self.field(field)]
        info = self.run("transform", mesh.path, "--as", kind, *self.operator_option(operator), "--lengths", join_numbers(lengths),
                        "--accuracy", accuracy, *signal, "-o", out)
        with np.load(out) as bands:
            found = Transformed(bands["wavelet"], bands["sigma"], info, info.get("peak_memory_bytes"))
        os.remove(out)
        return found

    def field(self, values):
        """Writes values to a file for the option `--field`; returns its path."""
        path = self.work / "field.npy"
        np.save(path, values)
        return path

    def features(self, mesh, lengths, operator, theta, response):
        """The features as rows of x, y, z, σ, sign, strength (k × 6)."""
        found = self.run("features", mesh.path, *self.operator_option(operator), "--lengths", join_numbers(lengths), "--theta", theta,
                         "--response", response, "--accuracy", ACCURACY)["features"]
        rows = [[*f["position"], f["sigma"], f["sign"], f["strength"]] for f in found]
        return np.array(rows).reshape(-1, 6)

    def saliency(self, mesh, lengths, operator):
        """The map of the paper, eq. 17, one value per vertex."""
        out = self.work / "map.npy"
        self.run("saliency", mesh.path, *self.operator_option(operator), "--weighting", "paper", "--lengths", join_numbers(lengths),
                 "--accuracy", ACCURACY, "-o", out)
        return np.load(out)

    def default_lengths(self, mesh):
        """The widths σ of the default levels of the walk, in model units."""
        return self.run("info", mesh.path, *self.operator_option(WALK))["sigma"][1:]

    def sample(self, name, n_vertices):
        """Writes a built-in shape; returns its path."""
        path = self.work / f"{name}.ply"
        self.run("sample", name, "--vertices", n_vertices, "-o", path)
        return path


def join_numbers(lengths):
    return ",".join(repr(float(length)) for length in lengths)
