"""Widths and heights of pictures, so that a page does not move when they arrive."""

from __future__ import annotations

import re
import struct
from pathlib import Path


def size(path: Path) -> tuple[int, int]:
    """Width and height in pixels of a PNG, JPEG or SVG file."""
    data = path.read_bytes()
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        width, height = struct.unpack(">II", data[16:24])
        return width, height
    if data.startswith(b"\xff\xd8"):
        return _jpeg_size(data, path)
    if path.suffix == ".svg":
        return _svg_size(data.decode("utf-8"), path)
    raise ValueError(f"{path} must be a PNG, JPEG or SVG file")


def _jpeg_size(data: bytes, path: Path) -> tuple[int, int]:
    position = 2
    while position + 9 < len(data):
        marker, length = data[position + 1], int.from_bytes(data[position + 2 : position + 4], "big")
        # Start of frame, but for the tables of Huffman and arithmetic codes and the reserved marker.
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack(">HH", data[position + 5 : position + 9])
            return width, height
        position += 2 + length
    raise ValueError(f"{path} has no start of frame; write the picture again")


def _svg_size(text: str, path: Path) -> tuple[int, int]:
    root = re.search(r"<svg\b[^>]*>", text)
    sizes = [re.search(rf'\b{name}="([\d.]+)(?:px)?"', root[0]) for name in ("width", "height")] if root else []
    if sizes and all(sizes):
        return round(float(sizes[0][1])), round(float(sizes[1][1]))
    box = re.search(r'viewBox="[\d.-]+ [\d.-]+ ([\d.]+) ([\d.]+)"', root[0]) if root else None
    if box is None:
        raise ValueError(f"{path} must have a width and a height or a viewBox")
    return round(float(box[1])), round(float(box[2]))
