"""Relief by scale: bands beside windows, those of xDEM and of Whitebox Workflows.

`python relief.py ADWAVE OUT.md` makes terrains, runs `adwave filter`, `xdem.terrain.topographic_position_index` and
`difference_from_mean_elevation` on them, and writes the table of docs/GRIDS.md. Packages: numpy, tifffile, rasterio, xdem,
whitebox-workflows.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import rasterio
import whitebox_workflows
import xdem
from rasterio.transform import from_origin

# Scales in meters on pixels of 10 m: what is finer than 60 m is left out, and what is wider than 480 m.
PIXEL, FINE, WIDE = 10.0, 60.0, 480.0
# A window of w pixels has the variance (w² − 1)/12 along an axis; σ² = 2·variance, as the command counts.
SIGMA_ALONG_AN_AXIS = WIDE / np.sqrt(2)
WINDOW = int(np.sqrt(12 * (SIGMA_ALONG_AN_AXIS / PIXEL) ** 2 + 1)) // 2 * 2 + 1


def save(path, values, nodata=None, pixel=(PIXEL, PIXEL)):
    """A GeoTIFF in meters."""
    height, width = values.shape
    transform = from_origin(0, height * pixel[1], *pixel)
    meta = {"driver": "GTiff", "dtype": "float32", "count": 1, "crs": "EPSG:32633", "nodata": nodata}
    with rasterio.open(path, "w", height=height, width=width, transform=transform, **meta) as file:
        file.write(values.astype(np.float32), 1)


def load(path):
    with rasterio.open(path) as file:
        return file.read(1).astype(float)


class Peers:
    def __init__(self, adwave, folder):
        self.adwave, self.folder = adwave, folder
        self.whitebox = whitebox_workflows.WbEnvironment()
        self.whitebox.verbose = False

    def ours(self, dem):
        """Heights less those without what is finer than WIDE."""
        out = self.folder / "ours.tif"
        options = ["--lengths", f"{WIDE:g}", "--gains", "0", "--value-type", "f32", "--quiet"]
        subprocess.run([self.adwave, "filter", dem, "-o", out, *options], check=True)
        return load(dem) - load(out)

    def theirs_xdem(self, dem):
        found = xdem.terrain.topographic_position_index(xdem.DEM(dem, silent=True), window_size=WINDOW)
        return np.asarray(found.data.filled(np.nan), dtype=float)

    def theirs_whitebox(self, dem):
        raster = self.whitebox.read_raster(str(dem))
        out = self.folder / "whitebox.tif"
        self.whitebox.write_raster(self.whitebox.difference_from_mean_elevation(raster, WINDOW, WINDOW), str(out))
        return load(out)

    def all(self):
        return {"adwave": self.ours, "xDEM": self.theirs_xdem, "Whitebox": self.theirs_whitebox}


def share(peers, heights, pixel=(PIXEL, PIXEL)):
    """Share of ridges 10 m high in the relief of each program, away from the border."""
    dem, n = peers.folder / "wave.tif", len(heights)
    save(dem, heights, pixel=pixel)
    center = slice(n // 2 - 60, n // 2 + 60)
    part = (heights - 100)[center, center]
    return [(part * relief(dem)[center, center]).sum() / (part * part).sum() for relief in peers.all().values()]


def responses(peers, lengths):
    """Shares by the distance of the ridges, of ridges along an axis and of diagonal ones."""
    y, x = np.mgrid[:801, :801] * PIXEL
    directions = (x, (x + y) / np.sqrt(2))
    waves = lambda length: (100 + 10 * np.cos(2 * np.pi * along / length) for along in directions)  # noqa: E731
    return [[length, *(share(peers, wave) for wave in waves(length))] for length in lengths]


def border(peers):
    """Largest relief of a slope without relief, near the border and beside a lake without data."""
    n = 401
    heights = np.full((n, n), 250.0)
    heights[150:200, 150:260] = -9999.0
    dem = peers.folder / "flat.tif"
    save(dem, heights, nodata=-9999.0)
    known = heights > 0
    rows = []
    for name, relief in peers.all().items():
        found = relief(dem)[known]
        is_value = np.isfinite(found) & (np.abs(found) < 1e4)
        rows.append([name, float(np.abs(found[is_value]).max()), float(1 - is_value.mean())])
    return rows


def oblong(peers):
    """Shares of ridges along both axes, on pixels of 10 m × 30 m."""
    pixel = (PIXEL, 3 * PIXEL)
    y, x = np.mgrid[:601, :601] * np.array(pixel[::-1])[:, None, None]
    return [share(peers, 100 + 10 * np.cos(2 * np.pi * along / 1500), pixel) for along in (y, x)]


def seconds(peers):
    """Least seconds of three runs on 4096² pixels, file to file."""
    rng = np.random.default_rng(3)
    heights = np.cumsum(np.cumsum(rng.standard_normal((4096, 4096)), 0), 1) * 1e-3
    dem = peers.folder / "large.tif"
    save(dem, heights)
    rows = []
    for name, relief in peers.all().items():
        times = []
        for _ in range(3):
            start = time.perf_counter()
            relief(dem)
            times.append(time.perf_counter() - start)
        rows.append([name, min(times)])
    return rows


def main():
    adwave, out = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        peers = Peers(adwave, Path(folder))
        lines = [f"Window of {WINDOW} pixels for σ = {WIDE:g} m, and the share of ridges in the relief:", ""]
        lines += ["| ridges every | adwave | xDEM | Whitebox | diagonal: adwave | xDEM | Whitebox |"]
        lines += ["| --: | --: | --: | --: | --: | --: | --: |"]
        for length, *found in responses(peers, [60, 200, 400, 600, 800, 1000, 1500, 2000, 3000]):
            lines.append(f"| {length} m | " + " | ".join(f"{x:.3f}" for each in found for x in each) + " |")
        lines += ["", "| | adwave | xDEM | Whitebox |", "| --- | --: | --: | --: |"]
        flat = border(peers)
        lines.append(
            "| largest relief of flat land with a lake without data | "
            + " | ".join(f"{x:.2g} m" for _, x, _ in flat)
            + " |"
        )
        lines.append("| places without a result there | " + " | ".join(f"{100 * x:.0f} %" for *_, x in flat) + " |")
        north, east = oblong(peers)
        lines.append(
            "| ridges every 1500 m along y, along x; pixels of 10 m × 30 m | "
            + " | ".join(f"{a:.3f}, {b:.3f}" for a, b in zip(north, east, strict=True))
            + " |"
        )
        lines.append("| 4096² pixels, file to file | " + " | ".join(f"{x:.2f} s" for _, x in seconds(peers)) + " |")
        Path(out).write_text("\n".join(lines) + "\n")
        print("\n".join(lines))


if __name__ == "__main__":
    main()
