"""Uses an installed package: reading, bands, denoising, a picture, and the command that comes with it.

python use_package.py
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import adwave as aw
import numpy as np


def main() -> None:
    shape = aw.sample("bracket", vertices=3000)
    bands = aw.decompose(shape, levels=5)
    error = float(np.abs(np.asarray(bands).sum(axis=0) - shape.points).max())
    assert error < 1e-8, f"the bands must sum to the shape, they differ by {error}"
    again = aw.decompose(shape, levels=5)
    assert np.array_equal(np.asarray(bands), np.asarray(again)), "the same call must give the same bits"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shape.write(folder / "part.ply")
        back = aw.read(folder / "part.ply")
        assert back.points.shape == shape.points.shape, "a file must have all points"
        clean, _ = aw.denoise(folder / "part.ply")
        assert np.isfinite(clean.points).all(), "a denoised shape must be finite"
        aw.render(shape).save(folder / "part.png")
        assert (folder / "part.png").read_bytes().startswith(b"\x89PNG"), "a picture must be a PNG"
        command = [sys.executable, "-m", "adwave"]
        for line in ("sample bracket --vertices 3000 --noise 0.3 -o scan.obj", "denoise scan.obj -o clean.obj"):
            subprocess.run([*command, *line.split()], check=True, cwd=folder)
        assert (folder / "clean.obj").stat().st_size > 10_000, "the command must write a shape"
    print(f"adwave {aw.__version__} works with Python {sys.version.split()[0]} on {sys.platform}")


if __name__ == "__main__":
    main()
