"""The command `adwave`, run as anybody runs it."""

import json
import os
import re
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

# Errors of bands far below what is measured here.
ACCURACY = 1e-6
WALK, SURFACE = "walk", "surface"


class Failure(Exception):
    """What the command said when it failed."""


@dataclass(frozen=True)
class Transformed:
    """Bands W_f(1) … W_f(J), lengths σ_0 … σ_J, what the command said of itself, its highest use of memory in bytes."""

    wavelet: np.ndarray
    sigma: np.ndarray
    info: dict
    peak: int


class Adwave:
    def __init__(self, binary, work):
        self.binary, self.work = binary, work
        work.mkdir(parents=True, exist_ok=True)

    @cached_property
    def operators(self):
        """The operators that this build has; a build without the option has the walk."""
        options = subprocess.run([self.binary, "transform", "--help"], capture_output=True, text=True, check=True).stdout
        return (WALK, SURFACE) if re.search(r"--operator\b", options) else (WALK,)

    def chosen(self, operator):
        return ["--operator", operator] if len(self.operators) > 1 else []

    def run(self, *words):
        """The JSON object that the command prints, and the highest memory of its process in bytes."""
        command = [str(w) for w in (self.binary, *words, "--json", "--quiet")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            out, err = process.communicate()
        if process.returncode:
            said = (err.strip().splitlines() or [f"exit code {process.returncode}"])[0]
            raise Failure(f"adwave {words[0]}: {said.replace(f'{Path(words[1]).parent}{os.sep}', '')}")
        return json.loads(out) if out.strip() else {}

    def transform(self, mesh, lengths, operator, *, field=None, kind="mesh", accuracy=ACCURACY):
        out = self.work / "bands.npz"
        signal = [] if field is None else ["--field", self.field(field)]
        info = self.run("transform", mesh.path, "--as", kind, *self.chosen(operator), "--lengths", joined(lengths),
                        "--accuracy", accuracy, *signal, "-o", out)
        with np.load(out) as bands:
            found = Transformed(bands["wavelet"], bands["sigma"], info, info.get("peak_memory_bytes"))
        os.remove(out)
        return found

    def field(self, values):
        path = self.work / "field.npy"
        np.save(path, values)
        return path

    def features(self, mesh, lengths, operator, theta, response):
        """A row for each feature: x, y, z, σ, sign, strength."""
        found = self.run("features", mesh.path, *self.chosen(operator), "--lengths", joined(lengths), "--theta", theta,
                         "--response", response, "--accuracy", ACCURACY)["features"]
        rows = [[*f["position"], f["sigma"], f["sign"], f["strength"]] for f in found]
        return np.array(rows).reshape(-1, 6)

    def saliency(self, mesh, lengths, operator):
        out = self.work / "map.npy"
        self.run("saliency", mesh.path, *self.chosen(operator), "--weighting", "paper", "--lengths", joined(lengths),
                 "--accuracy", ACCURACY, "-o", out)
        return np.load(out)

    def default_lengths(self, mesh):
        """The σ of the levels that the command takes by itself, by the walk."""
        return self.run("info", mesh.path, *self.chosen(WALK))["sigma"][1:]

    def sample(self, name, n_vertices):
        path = self.work / f"{name}.ply"
        self.run("sample", name, "--vertices", n_vertices, "-o", path)
        return path


def joined(lengths):
    return ",".join(repr(float(length)) for length in lengths)
