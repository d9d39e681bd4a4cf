"""A sheet of pictures: noisy, ours, the best rival, clean; colors are the angle to the clean normals."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from measure import angles, doubled_normals, read
from programs import Failure, command

# Degrees of the last color; pixels of a panel and of the line of words below it.
LARGEST, PANEL, WORDS = 30, 420, 30


def at_vertices(clean, result):
    """The angle at each vertex: the mean of its faces', weighted by area."""
    areas, found = np.linalg.norm(doubled_normals(clean), axis=1), angles(clean, result)
    areas = np.where(np.isnan(found), 0, areas)
    total = np.bincount(clean.triangles.ravel(), np.repeat(areas, 3), len(clean.points))
    values = np.bincount(clean.triangles.ravel(), np.repeat(np.nan_to_num(found) * areas, 3), len(clean.points))
    return values / np.maximum(total, 1e-300)


def panel(bench, path, clean):
    field, out = bench.args.work / "error.npy", bench.args.work / "panel.png"
    np.save(field, at_vertices(clean, read(path)))
    command([bench.args.adwave, "render", path, "-o", out, "--color", field, f"--range=0,{LARGEST}", "--no-bar", "--quiet",
             "--size", f"{PANEL}x{PANEL}"])
    with Image.open(out) as picture:
        return picture.convert("RGB")


def row(bench, pair, found):
    clean = read(pair.clean)
    rivals = {name: m["angle"] for name, m in found.items() if name not in ("noisy", "adwave", "learned") and "angle" in m}
    shown = [("noisy", pair.noisy)]
    shown += [("adwave", bench.out(pair, "adwave"))] if "angle" in found.get("adwave", {}) else []
    shown += [(best, bench.out(pair, best)) for best in sorted(rivals, key=rivals.get)[:1]]
    panels = [(panel(bench, path, clean), f"{name}, {found[name]['angle']:.1f}°") for name, path in shown]
    return [*panels, (panel(bench, pair.clean, clean), f"{pair.name}, clean")]


def draw(bench, pairs, results):
    rows = []
    for pair in pairs:
        try:
            rows.append(row(bench, pair, results[pair.name]))
        except Failure as failure:
            bench.note(f"picture of {pair.name}: {failure}")
    if not rows:
        return
    sheet = Image.new("RGB", (4 * PANEL, len(rows) * (PANEL + WORDS)), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(18)
    for y, panels in enumerate(rows):
        for x, (picture, words) in enumerate(panels):
            sheet.paste(picture, (x * PANEL, y * (PANEL + WORDS)))
            pen.text((x * PANEL + 10, y * (PANEL + WORDS) + PANEL + 4), words, "black", font)
    sheet.save(bench.args.work / "denoising.jpg", quality=88)
