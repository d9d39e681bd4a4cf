"""Pictures by adwave's own rasterizer: no graphics driver, no window."""

from __future__ import annotations

import os
from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._decomposer import Decomposer
from adwave._progress import ProgressLike, reporting
from adwave._shape import Path, Shape, as_shape

if TYPE_CHECKING:
    from adwave._measures import Features

Color = Union[tuple[int, int, int], "list[int]"]
Ball = tuple[ArrayLike, float, Color]


class Picture:
    """A picture: shows itself in a notebook; an array of height × width × 4 bytes; a PNG.

    Attributes
    ----------
    array : (height, width, 4) array of uint8
        Red, green, blue, alpha.
    png : bytes
    """

    __slots__ = ("array", "png")

    def __init__(self, png: bytes, array: NDArray[np.uint8]) -> None:
        self.png: bytes = png
        self.array: NDArray[np.uint8] = array

    @classmethod
    def of(cls, array: ArrayLike) -> Picture:
        """A picture of height × width × 3 or 4 bytes."""
        given = np.asarray(array)
        if given.dtype != np.uint8 or given.ndim != 3 or given.shape[2] not in (3, 4):
            raise ValueError(f"array: shape {given.shape} of {given.dtype}; give height × width × 3 or 4 of uint8")
        if given.shape[2] == 3:
            given = np.dstack([given, np.full(given.shape[:2], 255, np.uint8)])
        given = np.ascontiguousarray(given)
        return cls(_native.png_of(given), given)

    def beside(self, *others: Picture) -> Picture:
        """This one and others of the same height from left to right, as one."""
        heights = {picture.array.shape[0] for picture in (self, *others)}
        if len(heights) > 1:
            raise ValueError(f"the pictures have different heights: {', '.join(map(str, sorted(heights)))}")
        return Picture.of(np.hstack([picture.array for picture in (self, *others)]))

    def save(self, path: Path) -> None:
        """Write the PNG."""
        with open(os.fspath(path), "wb") as file:
            file.write(self.png)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        height, width = self.array.shape[:2]
        return f"<adwave.Picture: {width} × {height}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Picture, (self.png, self.array)


def render(
    shape: object,
    faces: object = None,
    *,
    values: str | ArrayLike | None = None,
    colors: ArrayLike | None = None,
    label: str | None = None,
    color_map: str | None = None,
    range: tuple[float, float] | None = None,
    color_bar: bool = True,
    size: tuple[int, int] = (1200, 900),
    view: str | tuple[float, float] = "three-quarter",
    up: Literal["x", "y", "z"] | None = None,
    zoom: float = 1.0,
    focus: ArrayLike | None = None,
    orthographic: bool = False,
    background: Color | None = (255, 255, 255),
    balls: Features | Iterable[Ball] = (),
    progress: ProgressLike = None,
) -> Picture:
    """Draw a shape, or a field on it.

    Parameters
    ----------
    shape, faces
        Anything that is a shape with positions; see `Shape`.
    values : str or (n,) array-like, optional
        A number for each vertex, or the name of a signal; gray where NaN.
    colors : (n, 3) array-like of uint8 or of numbers from 0 to 1, optional
        A color for each vertex, in the place of values.
    label : str, optional
        What the values are, for the bar.
    color_map : str, optional
        By default coolwarm about 0 for values of both signs, else viridis. A wrong name lists them all.
    range : (float, float), optional
        What the ends of the map stand for; the 1st and the 99th percentile by default.
    color_bar : bool
    size : (int, int)
        Width and height, pixels.
    view : str or (float, float)
        ``'front'``, ``'back'``, ``'left'``, ``'right'``, ``'top'``, ``'bottom'``, ``'three-quarter'``, or azimuth and elevation in
        degrees.
    up : {'x', 'y', 'z'}, optional
        Which axis points up; guessed where it is not given.
    zoom : float
        How many times as large as the whole shape would fit.
    focus : (3,) array-like, optional
        The place in the middle.
    orthographic : bool
        Parallel rays.
    background : (int, int, int), optional
        None for transparent.
    balls : Features, or iterable of (center, radius, color)
        Marks: features as balls of radius σ, red where their sign is + and blue where it is −.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Returns
    -------
    Picture

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> aw.render(shape, values=aw.saliency(shape), size=(200, 150))
    <adwave.Picture: 200 × 150>
    """
    own = shape.shape if isinstance(shape, Decomposer) else as_shape(shape, faces)
    numbers: NDArray[np.float64] | None = None
    if isinstance(values, str):
        label = values if label is None else label
        values = own.signal(values)
    if values is not None:
        numbers = _adapt.values_array(np.asarray(values), own.n_vertices, "values")
        if numbers.shape[1] != 1:
            raise ValueError(f"values: shape {numbers.shape}; give one number for each vertex, or colors")
        numbers = np.ascontiguousarray(numbers[:, 0])
    painted: NDArray[np.uint8] | None = None
    if colors is not None:
        given = np.asarray(colors)
        if given.dtype.kind == "f" and given.size and given.min() >= 0 and given.max() <= 1:
            given = np.rint(255 * given).astype(np.uint8)
        if given.dtype != np.uint8 or given.ndim != 2 or given.shape[0] != own.n_vertices or given.shape[1] < 3:
            raise ValueError(
                f"colors: shape {given.shape} of {given.dtype}; give red, green and blue as uint8 or from 0 to 1"
            )
        painted = np.ascontiguousarray(given[:, :3])
    look = view if isinstance(view, str) else ",".join(str(float(angle)) for angle in view)
    middle = None if focus is None else [float(c) for c in np.asarray(focus, dtype=np.float64)]
    marked = _balls_of(balls) if isinstance(balls, np.ndarray) and balls.dtype.names else balls
    marks = [([float(c) for c in np.asarray(at)], float(radius), list(color)) for at, radius, color in marked]
    with reporting(progress, "drawing") as report:
        png, array = _native.render_picture(
            own._data,
            (int(size[0]), int(size[1])),
            numbers,
            painted,
            label or "",
            color_map,
            range,
            color_bar,
            look,
            up,
            zoom,
            middle,
            orthographic,
            None if background is None else list(background),
            marks,
            3,
            report,
        )
    return Picture(png, array)


def _balls_of(features: NDArray[Any]) -> list[Ball]:
    return [
        (feature["position"], float(feature["sigma"]), (200, 40, 40) if feature["sign"] > 0 else (40, 80, 200))
        for feature in features
    ]


def shape_html(shape: Shape) -> str:
    """A table of what a shape consists of, and a small picture, for notebooks."""
    import base64

    from adwave._info import info

    rows = [("kind", shape.kind), ("vertices", f"{shape.n_vertices:,}")]
    try:
        found = info(shape)
        rows.append(("faces", f"{found['faces']:,}") if found["faces"] else ("edges", f"{found['edges']:,}"))
        rows.append(("components", str(found["components"])))
        if found["faces"]:
            rows.append(("surface", "closed" if found["closed"] else "open"))
        rows.append(("diagonal", f"{found['diagonal']:.4g}"))
        unusual = ("boundary_edges", "non_manifold_edges", "misoriented_edges", "zero_area_faces", "welded_vertices")
        rows += [(name.replace("_", " "), f"{found[name]:,}") for name in unusual if found[name]]
    except ValueError as error:
        rows.append(("note", str(error)))
    if shape.fields:
        rows.append(("fields", ", ".join(shape.fields)))
    cells = "".join(f"<tr><th style='text-align:left'>{escape(a)}</th><td>{escape(b)}</td></tr>" for a, b in rows)
    picture = ""
    if shape.points.size:
        small = render(shape, size=(240, 180), background=None)
        picture = f"<img alt='' src='data:image/png;base64,{base64.b64encode(small.png).decode()}'>"
    return f"<div style='display:flex;gap:1em;align-items:center'>{picture}<table>{cells}</table></div>"
