"""Description of a shape for notebooks: a table of facts and a small picture."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from html import escape
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._options import Operator
from adwave._viewer import CoarseShape

_UNUSUAL = ("boundary_edges", "non_manifold_edges", "misoriented_edges", "zero_area_faces", "welded_vertices")


@dataclass(frozen=True)
class PictureRequest:
    """Everything that a picture of a shape depends on, as the extension takes it."""

    width: int
    height: int
    values: Union[NDArray[np.float64], None] = None
    colors: Union[NDArray[np.uint8], None] = None
    label: str = ""
    color_map: Union[str, None] = None
    range: Union[tuple[float, float], None] = None
    color_bar: bool = True
    view: str = "three-quarter"
    up: Union[str, None] = None
    zoom: float = 1.0
    focus: Union[tuple[float, float, float], None] = None
    orthographic: bool = False
    background: Union[tuple[int, ...], None] = None
    balls: Any = ()


#: Vertices up to which the facts of a shape are computed for its description.
_DESCRIBED = 20_000


def shape_html(data: _native.ShapeData) -> str:
    """HTML with a table of what a shape consists of, and a picture of 240 × 180 pixels.

    A large shape is drawn coarser, and without the facts that need its operator.
    """
    rows = [("kind", data.kind), ("vertices", f"{data.n_vertices:,}")]
    if data.n_vertices > _DESCRIBED:
        if data.n_faces:
            rows.append(("faces", f"{data.n_faces:,}"))
        if data.points.size:
            rows.append(("box", f"{np.linalg.norm(np.ptp(data.points, axis=0)):.4g} across"))
    else:
        rows += _facts(data)
    names = data.field_names()
    if names:
        rows.append(("fields", ", ".join(names)))
    picture = ""
    if data.points.size:
        coarse = data if data.n_vertices <= _DESCRIBED else CoarseShape(data).data(data)
        png, _ = _native.render_picture(coarse, PictureRequest(240, 180))
        picture = f"<img alt='' src='data:image/png;base64,{base64.b64encode(png).decode()}'>"
    return f"<div style='display:flex;gap:1em;align-items:center'>{picture}{_table(rows)}</div>"


def _facts(data: _native.ShapeData) -> list[tuple[str, str]]:
    try:
        facts = _native.Prepared(data, Operator("walk")).facts()
    except ValueError as error:
        return [("note", str(error))]
    rows = [("faces", f"{facts['faces']:,}") if facts["faces"] else ("edges", f"{facts['edges']:,}")]
    rows.append(("components", str(facts["components"])))
    if facts["faces"]:
        rows.append(("surface", "closed" if facts["closed"] else "open"))
    rows.append(("diagonal", f"{facts['diagonal']:.4g}"))
    return rows + [(name.replace("_", " "), f"{facts[name]:,}") for name in _UNUSUAL if facts[name]]


def _table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><th style='text-align:left'>{escape(a)}</th><td>{escape(b)}</td></tr>" for a, b in rows)
    return f"<table>{cells}</table>"
