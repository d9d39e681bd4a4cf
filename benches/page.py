"""What the pages of all comparisons have in common: tables, the machine, and the lines between which they write."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"


def table(head, rows, numbers=False):
    """Rows below a head in Markdown; with `numbers` all columns but the first are set to the right."""
    dashes = ["---", *["--:" if numbers else "---"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(str(c) for c in line) + " |" for line in [head, dashes, *rows])


def sections(parts):
    """Pairs of a head and what stands below it."""
    return "\n\n".join(f"## {head}\n\n{body}" for head, body in parts if body)


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def machine(*packages):
    """The machine and the versions of packages, as a sentence."""
    versions = ", ".join(f"{name} {version(name)}" for name in packages)
    system = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
    return f"{processor()}, {os.cpu_count()} cores; {system}, {versions}."


def write(path, measured):
    """Puts what was measured between the two lines of a page."""
    before, marker, rest = path.read_text().partition(BEGIN)
    _, other, after = rest.partition(END)
    if not (marker and other):
        raise SystemExit(f"{path} has no lines {BEGIN} and {END} to write between")
    path.write_text(f"{before}{BEGIN}\n\n{measured}\n\n{END}{after}")
