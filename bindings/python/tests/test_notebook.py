"""Descriptions in notebooks: of large shapes too, at once."""

from __future__ import annotations

import base64
import html
import json
import re
import shutil
import subprocess
import time
from pathlib import Path

import adwave as aw
import numpy as np
import pytest


def source_of(bands: aw.Bands) -> str:
    """The page in a description of bands."""
    frame = re.search(r"srcdoc='(.*?)'></iframe>", bands._repr_html_(), re.S)
    assert frame is not None
    page = html.unescape(frame.group(1))
    assert "http://" not in page and "https://" not in page, "the page loads nothing"
    return page


def page_of(bands: aw.Bands) -> dict:
    """Content that the page in a description of bands draws."""
    page = source_of(bands)
    content = re.search(r"const content = (\{.*?\});\n", page)
    assert content is not None
    return json.loads(content.group(1))


def test_the_page_has_every_band_of_some_vertices() -> None:
    shape = aw.sample("creature", vertices=2000)
    content = page_of(aw.decompose(shape, levels=4))
    assert len(content["titles"]) == len(content["bands"]) == len(content["scales"]) == 5
    total = sum(
        scale * np.frombuffer(base64.b64decode(text), "<i2").reshape(-1, 3)
        for text, scale in zip(content["bands"], content["scales"], strict=True)
    )
    assert np.abs(total - shape.points).max() < 1e-3
    faces = np.frombuffer(base64.b64decode(content["faces"]), "<u2").reshape(-1, 3)
    assert np.array_equal(faces, shape.faces)
    by_color = page_of(aw.decompose(shape, shape.points[:, 1], levels=3))
    assert len(by_color["bands"]) == 4 and "points" in by_color


def test_large_shapes_are_drawn_coarser() -> None:
    shape = aw.sample("torus", vertices=200_000)
    bands = aw.decompose(shape, levels=3)
    content = page_of(bands)
    n = len(base64.b64decode(content["bands"][0])) // 6
    faces = np.frombuffer(base64.b64decode(content["faces"]), "<u2").reshape(-1, 3)
    assert 1000 < n < 20_000 and faces.max() < n and len(faces) > n
    start = time.perf_counter()
    assert "200,000" in shape._repr_html_() and "<img" in shape._repr_html_()
    bands._repr_html_()
    # 0.2 s for all three on a quiet machine.
    assert time.perf_counter() - start < 2.0


@pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")
def test_the_sliders_change_the_sum(tmp_path: Path) -> None:
    shape = aw.sample("creature", vertices=2000)
    script = re.search(r"<script>(.*)</script>", source_of(aw.decompose(shape, levels=4)), re.S)
    assert script is not None
    # A page without a screen: everything that draws does nothing.
    page = """
const nothing = new Proxy({}, {get: (_, name) => /^[A-Z_]+$/.test(name) ? 1 : () => ({})}), made = [];
const element = () => ({append() {}, getContext: () => nothing});
globalThis.document = {querySelector: element, getElementById: element,
  createElement: () => { const one = element(); made.push(one); return one; }};
"""
    report = """
const before = Array.from(sum), slider = made.find(one => one.oninput);
slider.value = 0; slider.oninput();
console.log(JSON.stringify([before, Array.from(sum)]));
"""
    (tmp_path / "page.js").write_text(page + script.group(1) + report, encoding="utf-8")
    out = subprocess.run(["node", str(tmp_path / "page.js")], capture_output=True, text=True, check=True).stdout
    before, after = (np.reshape(values, (-1, 3)) for values in json.loads(out))
    bands = aw.decompose(shape, levels=4)
    assert np.abs(before - shape.points).max() < 1e-3
    assert np.abs(after - bands.apply([0, 1, 1, 1])).max() < 1e-3


def test_what_has_no_faces_is_described() -> None:
    graph = aw.graph(4, [[0, 1], [1, 2], [2, 3]])
    assert "levels" in aw.decompose(graph, [1.0, 2, 3, 4], levels=2)._repr_html_()
    cloud = aw.Shape(aw.sample("sphere", vertices=30_000).points)
    assert "<img" in cloud._repr_html_()
