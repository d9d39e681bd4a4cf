"""A small interactive picture of bands for notebooks: a page of its own, with a slider for each band and no packages."""

from __future__ import annotations

import base64
import json
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native

#: Cells along the longest side of the box; each cell with vertices becomes one vertex of the picture.
_CELLS = 56
#: Vertices up to which a shape is drawn as it is.
_SMALL = 6000
_LARGEST_INDEX = 2**16 - 1


class CoarseShape:
    """Some vertices of a shape, and triangles between them: what a small picture needs of a large shape.

    Vertices in one cell of a grid are represented by one of them, and triangles between three cells remain.
    """

    def __init__(self, data: _native.ShapeData) -> None:
        points, triangles = data.points, data.triangles
        n = len(points)
        faces = np.empty((0, 3), np.uint32) if triangles is None else triangles
        if n <= _SMALL:
            self.vertices: NDArray[Any] = np.arange(n)
            self.faces: NDArray[Any] = faces
            return
        low = points.min(axis=0)
        size = float((points.max(axis=0) - low).max()) or 1.0
        cells = ((points - low) * (_CELLS * (1 - 1e-9) / size)).astype(np.int32)
        key = (cells[:, 0] * _CELLS + cells[:, 1]) * _CELLS + cells[:, 2]
        of_cell = np.full(_CELLS**3, -1, dtype=np.int32)
        of_cell[key] = np.arange(n, dtype=np.int32)
        is_used = of_cell >= 0
        self.vertices = of_cell[is_used]
        place = np.cumsum(is_used, dtype=np.int32) - 1
        ends = place[key][faces]
        is_kept = (ends[:, 0] != ends[:, 1]) & (ends[:, 1] != ends[:, 2]) & (ends[:, 0] != ends[:, 2])
        self.faces = ends[is_kept]

    def data(self, data: _native.ShapeData) -> _native.ShapeData:
        """The coarse shape for the rasterizer."""
        points = np.ascontiguousarray(data.points[self.vertices])
        corners = np.ascontiguousarray(self.faces, dtype=np.uint32).ravel()
        return _native.ShapeData.from_arrays(points, corners, None, None if len(corners) else "cloud")


def _packed(values: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def _quantized(values: NDArray[Any]) -> tuple[str, float]:
    values = np.nan_to_num(values)
    scale = float(np.abs(values).max(initial=0.0)) / 32767 or 1.0
    return _packed(np.rint(values / scale).astype("<i2")), scale


def bands_html(data: _native.ShapeData, bands: NDArray[np.float64], titles: list[str], is_shape: bool) -> str:
    """Self-contained HTML that draws the sum of bands with a gain for each, which sliders change.

    Parameters
    ----------
    data : ShapeData
        The shape.
    bands : (J + 1, n, channels) array
        Bands and the rest. The first channel colors the shape unless `is_shape`.
    titles : list of str
        Titles of the bands.
    is_shape : bool
        Whether the bands are those of the positions.
    """
    coarse = CoarseShape(data)
    if not len(coarse.faces) or len(coarse.vertices) > _LARGEST_INDEX:
        return ""
    chosen = bands[:, coarse.vertices, :3] if is_shape else bands[:, coarse.vertices, :1]
    packed = [_quantized(band) for band in chosen]
    content: dict[str, Any] = {
        "faces": _packed(coarse.faces.astype("<u2")),
        "bands": [text for text, _ in packed],
        "scales": [scale for _, scale in packed],
        "titles": titles,
    }
    if not is_shape:
        content["points"], content["scale"] = _quantized(data.points[coarse.vertices])
    page = _PAGE.replace("{{content}}", json.dumps(content).replace("</", "<\\/"))
    style = "width:100%;max-width:820px;height:400px;border:0"
    return f"<iframe sandbox='allow-scripts' style='{style}' srcdoc='{escape(page, quote=True)}'></iframe>"


_PAGE = """<!doctype html><meta charset="utf-8"><style>
body{margin:0;font:13px sans-serif;display:flex;gap:12px;color:#888}
canvas{width:500px;height:390px;touch-action:none;cursor:grab}
label{display:grid;grid-template-columns:7.5em 1fr 2.6em;gap:6px;align-items:center;margin:2px 0}
</style><canvas width="1000" height="780"></canvas><div id="sliders" style="flex:1"></div><script>
"use strict";
const content = {{content}};
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
const faces = new Uint16Array(bytes(content.faces));
const bands = content.bands.map(text => new Int16Array(bytes(text)));
const gains = bands.map(() => 1);
const colored = content.points !== undefined;
const fixed = colored ? Float32Array.from(new Int16Array(bytes(content.points)), v => v * content.scale) : null;
const sum = new Float32Array(bands[0].length);
const n = (colored ? fixed.length : sum.length) / 3;
const normals = new Float32Array(3 * n), values = new Float32Array(n);
const canvas = document.querySelector("canvas"), gl = canvas.getContext("webgl");
if (!gl) { document.body.textContent = "This view needs WebGL, which this browser does not offer."; throw new Error("no WebGL"); }
const shader = (type, text) => { const s = gl.createShader(type); gl.shaderSource(s, text); gl.compileShader(s); return s; };
const program = gl.createProgram();
gl.attachShader(program, shader(gl.VERTEX_SHADER, `attribute vec3 position, normal; attribute float value;
uniform mat3 turn; uniform vec3 middle; uniform float scale; varying vec3 n; varying float v;
void main() { vec3 p = turn * (position - middle) * scale; n = turn * normal; v = value;
gl_Position = vec4(p.x * .78, p.y, -p.z * .5, 1.); }`));
gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `precision mediump float; varying vec3 n; varying float v;
void main() { float light = .35 + .65 * abs(normalize(n).z);
vec3 c = v > 0. ? mix(vec3(.87), vec3(.71,.02,.15), v) : mix(vec3(.87), vec3(.23,.30,.75), -v);
gl_FragColor = vec4(c * light, 1.); }`));
gl.linkProgram(program); gl.useProgram(program); gl.enable(gl.DEPTH_TEST);
const buffers = {};
for (const [name, width] of [["position", 3], ["normal", 3], ["value", 1]]) {
  const at = gl.getAttribLocation(program, name); buffers[name] = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]); gl.enableVertexAttribArray(at);
  gl.vertexAttribPointer(at, width, gl.FLOAT, false, 0, 0);
}
gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
const fill = (name, data) => { gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]); gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW); };
const uniform = name => gl.getUniformLocation(program, name);
let around = .6, up = .35, placed = false, reach = 0;
function update() {
  sum.fill(0);
  bands.forEach((band, j) => { const f = gains[j] * content.scales[j]; for (let i = 0; i < sum.length; i++) sum[i] += f * band[i]; });
  const points = colored ? fixed : sum;
  if (!placed) {
    const low = [0, 1, 2].map(() => Infinity), high = [0, 1, 2].map(() => -Infinity);
    for (let i = 0; i < points.length; i++) { low[i % 3] = Math.min(low[i % 3], points[i]); high[i % 3] = Math.max(high[i % 3], points[i]); }
    gl.uniform3fv(uniform("middle"), low.map((v, i) => (v + high[i]) / 2));
    gl.uniform1f(uniform("scale"), 1.7 / Math.hypot(...high.map((v, i) => v - low[i])));
    reach = colored ? sum.reduce((most, v) => Math.max(most, Math.abs(v)), 1e-30) : 1;
    placed = true;
  }
  normals.fill(0);
  for (let t = 0; t < faces.length; t += 3) {
    const [a, b, c] = [3 * faces[t], 3 * faces[t + 1], 3 * faces[t + 2]];
    const u = [0, 1, 2].map(i => points[b + i] - points[a + i]), v = [0, 1, 2].map(i => points[c + i] - points[a + i]);
    const m = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const at of [a, b, c]) for (let i = 0; i < 3; i++) normals[at + i] += m[i];
  }
  for (let i = 0; i < n; i++) values[i] = colored ? Math.max(-1, Math.min(1, sum[i] / reach)) : 0;
  fill("position", points); fill("normal", normals); fill("value", values); draw();
}
function draw() {
  const [s, c, t, d] = [Math.sin(around), Math.cos(around), Math.sin(up), Math.cos(up)];
  gl.uniformMatrix3fv(uniform("turn"), false, [c, t * s, -d * s, 0, d, t, s, -t * c, d * c]);
  gl.clearColor(1, 1, 1, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.drawElements(gl.TRIANGLES, faces.length, gl.UNSIGNED_SHORT, 0);
}
canvas.onpointermove = e => { if (e.buttons) { around += e.movementX / 120; up += e.movementY / 120; draw(); } };
canvas.onpointerdown = e => canvas.setPointerCapture(e.pointerId);
content.titles.forEach((title, j) => {
  const label = document.createElement("label"), slider = document.createElement("input"), shown = document.createElement("output");
  Object.assign(slider, {type: "range", min: 0, max: 4, step: .05, value: 1});
  shown.textContent = "1.0";
  slider.oninput = () => { gains[j] = +slider.value; shown.textContent = gains[j].toFixed(1); update(); };
  slider.ondblclick = () => { slider.value = 1; slider.oninput(); };
  label.append(title, slider, shown); document.getElementById("sliders").append(label);
});
update();
</script>"""
