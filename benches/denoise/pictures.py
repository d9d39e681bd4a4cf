"""A sheet of pictures: noisy, ours, the best other program, clean; colors show the angle to the clean normals."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from measure import angles, doubled_normals, read
from programs import Failure, command

# Degrees of the last color; pixels of a panel and of the caption below it.
MAX_ANGLE, PANEL, CAPTION = 30, 420, 30


def vertex_angles(clean, result):
    """The angle at each vertex in degrees: the mean over its faces, weighted by area."""
    areas, found = np.linalg.norm(doubled_normals(clean), axis=1), angles(clean, result)
    areas = np.where(np.isnan(found), 0, areas)
    total = np.bincount(clean.triangles.ravel(), np.repeat(areas, 3), len(clean.points))
    values = np.bincount(clean.triangles.ravel(), np.repeat(np.nan_to_num(found) * areas, 3), len(clean.points))
    return values / np.maximum(total, 1e-300)


def panel(bench, path, clean):
    """The picture of a result, colored by its angles."""
    field, out = bench.args.work / "error.npy", bench.args.work / "panel.png"
    np.save(field, vertex_angles(clean, read(path)))
    command([bench.args.adwave, "render", path, "-o", out, "--color", field, f"--range=0,{MAX_ANGLE}", "--no-bar", "--quiet",
             "--size", f"{PANEL}x{PANEL}"])
    with Image.open(out) as picture:
        return picture.convert("RGB")


def row(bench, pair, found):
    """Pictures of one pair with their captions."""
    clean = read(pair.clean)
    rivals = {name: m["angle"] for name, m in found.items() if name not in ("noisy", "adwave", "learned") and "angle" in m}
    files = [("noisy", pair.noisy)]
    files += [("adwave", bench.result_path(pair, "adwave"))] if "angle" in found.get("adwave", {}) else []
    files += [(best, bench.result_path(pair, best)) for best in sorted(rivals, key=rivals.get)[:1]]
    panels = [(panel(bench, path, clean), f"{name}, {found[name]['angle']:.1f}°") for name, path in files]
    return [*panels, (panel(bench, pair.clean, clean), f"{pair.name}, clean")]


def draw(bench, pairs, results):
    """Writes the sheet of all pairs to `denoising.jpg` in the work folder."""
    rows = []
    for pair in pairs:
        try:
            rows.append(row(bench, pair, results[pair.name]))
        except Failure as failure:
            bench.add_note(f"picture of {pair.name}: {failure}")
    if not rows:
        return
    sheet = Image.new("RGB", (4 * PANEL, len(rows) * (PANEL + CAPTION)), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(18)
    for y, panels in enumerate(rows):
        for x, (picture, caption) in enumerate(panels):
            sheet.paste(picture, (x * PANEL, y * (PANEL + CAPTION)))
            pen.text((x * PANEL + 10, y * (PANEL + CAPTION) + PANEL + 4), caption, "black", font)
    sheet.save(bench.args.work / "denoising.jpg", quality=88)
