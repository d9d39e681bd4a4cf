"""A picture of where tiles meet: tiles, their difference from the whole, and that of tiles without what is around them.

python border.py --adwave PROGRAM --work FOLDER --out PICTURE.png [--points N]

Needs the Python package. Both differences are printed: that of tiles with their rings must be exactly 0.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
from pathlib import Path

import adwave as aw
import numpy as np

BAND, TILES = 6, 6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adwave", required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--points", type=int, default=300_000)
    args = parser.parse_args()
    work = args.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)

    def adwave(*words: object) -> None:
        subprocess.run([args.adwave, *map(str, words), "--quiet"], check=True)

    adwave("sample", "terrain", "--points", args.points, "-o", work / "flight")
    (file,) = (work / "flight").glob("*.laz")

    def fields(name: str, *words: object) -> list[aw.Shape]:
        adwave("tiles", file, "-o", f"{work / name}/", "--magnitudes", BAND, *words)
        return [aw.read(path) for path in sorted((work / name).glob("tile-*.laz"))]

    tiles, whole = fields("tiles", "--tiles", TILES), fields("whole", "--tiles", 1)
    band = f"wavelet_{BAND}"
    values = [np.concatenate([shape.fields[band] for shape in shapes]) for shapes in (tiles, whole)]
    points = np.concatenate([shape.points for shape in tiles])
    assert np.array_equal(points, whole[0].points)
    alone = []
    for shape in tiles:
        bands = aw.decompose(shape.points, levels=8)
        alone.append(np.linalg.norm(bands[BAND - 1], axis=1).astype(np.float32))
    difference = np.abs(values[0] - values[1])
    without = np.abs(np.concatenate(alone) - values[1])
    for name, d in (("tiles and the whole", difference), ("tiles without rings and the whole", without)):
        print(f"{name}: at most {d.max():.3g}, other in {(d > 1e-5).sum()} of {len(d)} points")
    numbers = np.concatenate([np.full(len(shape.points), k, np.uint8) for k, shape in enumerate(tiles, 1)])
    shape = aw.Shape(points).with_fields({"tile": numbers.astype(float), "difference": difference, "without_rings": without})
    shape.write(work / "border.ply")
    colors = [word for name in ("tile", "difference", "without_rings") for word in ("--color", name)]
    adwave("render", work / "border.ply", "-o", args.out, "--grid", *colors, "--view", "top", "--orthographic", "--size", "420x340")


if __name__ == "__main__":
    main()
