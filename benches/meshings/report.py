"""The tables of docs/MESHINGS.md, between its markers."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
HEADS = {
    "remeshing": "Two meshings of one surface",
    "cloud": "A mesh and its vertices as a cloud",
    "features": "Features found again on the isotropic remeshing",
    "scipy": "Beside SciPy's exponential",
    "cost": "What it costs",
    "gaze": "Saliency and where people look",
    "pictures": "Pictures",
}


def machine():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        cpu = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        cpu = platform.processor()
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "pymeshlab", "pillow"))
    return f"{cpu}, {os.cpu_count()} cores; {platform.system()} {platform.machine()}, Python {platform.python_version()}, {packages}."


def measured(results, parts):
    whole = sum(results["seconds"].values())
    sections = [("Machine", f"{results['machine']} The whole run took {whole / 60:.0f} minutes.")]
    sections += [(HEADS[name], part.text(results[name])) for name, part in parts.items()]
    if results["notes"]:
        sections.append(("What was left out", "\n".join(f"* {note}" for note in results["notes"])))
    return "\n\n".join(f"## {head}\n\n{body}" for head, body in sections)


def write(results, parts, docs):
    path = docs / "MESHINGS.md"
    text = path.read_text()
    before, marker, rest = text.partition(BEGIN)
    _, other, after = rest.partition(END)
    if not (marker and other):
        raise SystemExit(f"{path} has no lines {BEGIN} and {END} to write between")
    path.write_text(f"{before}{BEGIN}\n\n{measured(results, parts)}\n\n{END}{after}")
