"""Parts that the pages of all comparisons share: tables, the machine, and the lines between which a page is written."""

import os
import platform
import textwrap
from importlib.metadata import version
from pathlib import Path

# Characters of a line of prose in a page.
WIDTH = 118


def table(head, rows, numbers=False):
    """A Markdown table of `rows` below `head`; with `numbers`, all columns but the first are aligned to the right."""
    dashes = ["---", *["--:" if numbers else "---"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(str(c) for c in line) + " |" for line in [head, dashes, *rows])


def paragraph(text):
    """A paragraph wrapped at the width of a page."""
    return textwrap.fill(text, WIDTH, break_long_words=False, break_on_hyphens=False)


def bullets(items):
    """A list, one item per text, wrapped at the width of a page; empty without items."""
    wrap = lambda text: textwrap.fill(text, WIDTH, initial_indent="* ", subsequent_indent="  ",
                                      break_long_words=False, break_on_hyphens=False)
    return "\n".join(map(wrap, items))


def sections(parts):
    """Sections from pairs of a heading and a body; pairs with an empty body are left out."""
    return "\n\n".join(f"## {head}\n\n{body}" for head, body in parts if body)


def processor():
    """The name of the processor."""
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


def write(path, measured, name="measured"):
    """Replaces the text between the two lines of a page that are marked with a name by `measured`."""
    begin, end = (f"<!-- {name}: {edge} -->" for edge in ("begin", "end"))
    before, marker, rest = path.read_text().partition(begin)
    _, other, after = rest.partition(end)
    if not (marker and other):
        raise SystemExit(f"{path} has no lines {begin} and {end} to write between")
    path.write_text(f"{before}{begin}\n\n{measured}\n\n{end}{after}")
