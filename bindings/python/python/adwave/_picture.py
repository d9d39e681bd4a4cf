"""Pictures by adwave's own rasterizer, without a graphics driver or a window."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._caller import Call, public
from adwave._layout import vertex_weights
from adwave._measures import Features
from adwave._misfit import working_line
from adwave._notebook import PictureRequest
from adwave._option_rules import literal
from adwave._part import own_signal, read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Path, Shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._part import PartOptions

_RENDER = ("values", "colors", "scale", "camera", "size", "background", "balls", "progress")

Color = Union[tuple[int, int, int], "list[int]"]
Ball = tuple[ArrayLike, float, Color]


class Picture:
    """A picture. It shows itself in a notebook, and is an array of height × width × 4 bytes and a PNG.

    Attributes
    ----------
    array : (height, width, 4) array of uint8
        Red, green, blue, alpha.
    png : bytes
        Content of a PNG file.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> red = aw.Picture.from_array(np.full((20, 30, 3), (255, 0, 0), dtype=np.uint8))
    >>> red.hstack(red)
    <adwave.Picture: 60 × 20>
    """

    __slots__ = ("array", "png")

    def __init__(self, png: bytes, array: NDArray[np.uint8]) -> None:
        self.png: bytes = png
        self.array: NDArray[np.uint8] = array

    @classmethod
    def from_array(cls, array: ArrayLike) -> Picture:
        """A picture from height × width × 3 or 4 bytes.

        Parameters
        ----------
        array : (height, width, 3 or 4) array_like of uint8
            Red, green, blue and perhaps alpha.
        """
        given = np.asarray(array)
        if given.dtype != np.uint8 or given.ndim != 3 or given.shape[2] not in (3, 4):
            raise ValueError(f"array must be height × width × 3 or 4 of uint8, got {given.shape} of {given.dtype}")
        if given.shape[2] == 3:
            given = np.dstack([given, np.full(given.shape[:2], 255, np.uint8)])
        given = np.ascontiguousarray(given)
        return cls(_native.encode_png(given), given)

    def hstack(self, *others: Picture) -> Picture:
        """One picture of this one and others of the same height, from left to right.

        Parameters
        ----------
        *others : Picture
            Pictures of the same height.
        """
        heights = {picture.array.shape[0] for picture in (self, *others)}
        if len(heights) > 1:
            raise ValueError(f"the pictures must have one height, got {', '.join(map(str, sorted(heights)))}")
        return Picture.from_array(np.hstack([picture.array for picture in (self, *others)]))

    def save(self, path: Path) -> None:
        """Write the PNG to a file.

        Parameters
        ----------
        path : path_like
            The file, ``.png``.
        """
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


@dataclass(frozen=True, kw_only=True)
class Camera:
    """View of a picture.

    Parameters
    ----------
    view : str or (float, float)
        ``'front'``, ``'back'``, ``'left'``, ``'right'``, ``'top'``, ``'bottom'``, ``'three-quarter'``, or azimuth and
        elevation in degrees.
    up : {'x', 'y', 'z'}, optional
        Axis that points up; guessed by default.
    zoom : float
        Magnification relative to the view that shows the whole shape.
    focus : (3,) array_like, optional
        Point in the middle of the picture, in model units; the center of the shape by default.
    orthographic : bool
        Use a parallel projection.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> aw.render(shape, camera=aw.Camera(view=(25, 8), zoom=1.5), size=(80, 60))
    <adwave.Picture: 80 × 60>
    """

    view: Union[str, tuple[float, float]] = "three-quarter"
    up: Union[Literal["x", "y", "z"], None] = None
    zoom: float = 1.0
    focus: Union[ArrayLike, None] = None
    orthographic: bool = False


@dataclass(frozen=True, kw_only=True)
class ColorScale:
    """Mapping of values to colors.

    Parameters
    ----------
    color_map : str, optional
        By default coolwarm about 0 for values of both signs, else viridis. A wrong name lists all names.
    range : (float, float), optional
        Values at the ends of the map; by default the 1st and the 99th percentile.
    label : str, optional
        Label of the color bar.
    bar : bool
        Whether the color bar is drawn.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> aw.render(shape, values="z", scale=aw.ColorScale(color_map="magma", range=(-1, 1)), size=(80, 60))
    <adwave.Picture: 80 × 60>
    """

    color_map: Union[str, None] = None
    range: Union[tuple[float, float], None] = None
    label: Union[str, None] = None
    bar: bool = True


def _save_picture(call: Call) -> None:
    """The call without the file's name, which `Picture.save` takes."""
    is_name = [isinstance(literal(text), str) and "." in text for text in call.arguments]
    path = call.arguments.pop(is_name.index(True)) if any(is_name) else call.keywords.pop("values", '"picture.png"')
    call.function, call.arguments = f"{call}.save", [path]
    call.keywords = {}


@public()
def render(
    shape: object,
    values: str | ArrayLike | None = None,
    *,
    colors: ArrayLike | None = None,
    scale: ColorScale | None = None,
    camera: Camera | None = None,
    size: tuple[int, int] = (1200, 900),
    background: Color | None = (255, 255, 255),
    balls: Features | Iterable[Ball] = (),
    progress: ProgressLike = None,
    **options: Unpack[PartOptions],
) -> Picture:
    """Draw a shape, or a field on it.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape with positions; see `Shape`.
    values : str or (n,) array_like, optional
        A number for each vertex, or the name of a signal; gray where NaN.
    colors : (n, 3) array_like of uint8 or of numbers from 0 to 1, optional
        A color for each vertex, instead of values.
    scale : ColorScale, optional
        Mapping of values to colors.
    camera : Camera, optional
        View of the picture.
    size : (int, int)
        Width and height in pixels.
    background : (int, int, int), optional
        Red, green and blue; None for transparent.
    balls : Features, or iterable of (center, radius, color)
        Marks: features as balls whose radius is their rms width, red if their sign is + and blue if it is −.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
    **options
        ``faces=``, and ``mask=`` or ``only=``: the other vertices are not drawn.

    Returns
    -------
    Picture

    Raises
    ------
    ValueError
        If the shape has no positions, or values or colors do not fit its vertices.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> aw.render(shape, values=aw.saliency(shape), size=(200, 150))
    <adwave.Picture: 200 × 150>
    """
    part = read_part("render", shape, options, _RENDER, values)
    own = part.shape
    values = own_signal(part.given) if values is None else values
    if isinstance(values, str) and values.lower().endswith((".png", ".jpg", ".jpeg", ".svg", ".pdf")):
        line = working_line("render", _save_picture, f"aw.render(shape).save({values!r})")
        raise ValueError(f"values: {values!r} is a picture's name, and a picture is saved as PNG{line}")
    if values is not None and not isinstance(values, str):
        values = _one_value(values)
        if part.selection is not None:
            values = vertex_weights(values, part.whole_shape.n_vertices, "values")[part.selection.rows]
    if colors is not None and part.selection is not None:
        colors = np.asarray(colors)[part.selection.rows]
    scale, camera = scale or ColorScale(), camera or Camera()
    label = scale.label
    if label is None:
        label = values if isinstance(values, str) else ""
    view = camera.view if isinstance(camera.view, str) else ",".join(str(float(angle)) for angle in camera.view)
    focus = None if camera.focus is None else tuple(np.asarray(camera.focus, dtype=np.float64).tolist())
    given: Any = balls
    marks = _feature_balls(given) if isinstance(given, np.ndarray) and given.dtype.names else given
    request = PictureRequest(
        width=int(size[0]),
        height=int(size[1]),
        values=None if values is None else _vertex_values(own, values),
        colors=None if colors is None else _vertex_colors(own, colors),
        label=label,
        color_map=scale.color_map,
        range=scale.range,
        color_bar=scale.bar,
        view=view,
        up=camera.up,
        zoom=camera.zoom,
        focus=focus,
        orthographic=camera.orthographic,
        background=None if background is None else tuple(background),
        balls=[([float(c) for c in np.asarray(at)], float(radius), list(color)) for at, radius, color in marks],
    )
    with report_progress(progress, "drawing") as report:
        png, array = _native.render_picture(own._data, request, report)
    return Picture(png, array)


def _one_value(values: ArrayLike) -> ArrayLike:
    """Values of one channel without its axis."""
    array = np.asarray(values)
    return array[:, 0] if array.ndim == 2 and array.shape[1] == 1 else array


def _vertex_values(shape: Shape, values: str | ArrayLike) -> NDArray[np.float64]:
    given = shape.signal(values) if isinstance(values, str) else np.asarray(values)
    numbers = _adapt.values_array(given, shape.n_vertices, "values")
    if numbers.shape[1] != 1:
        raise ValueError(f"values must be one number for each vertex, got shape {numbers.shape}; give colors instead")
    return np.ascontiguousarray(numbers[:, 0])


def _vertex_colors(shape: Shape, colors: ArrayLike) -> NDArray[np.uint8]:
    given = np.asarray(colors)
    if given.dtype.kind == "f" and given.size and given.min() >= 0 and given.max() <= 1:
        given = np.rint(255 * given).astype(np.uint8)
    if given.dtype != np.uint8 or given.ndim != 2 or given.shape[0] != shape.n_vertices or given.shape[1] < 3:
        raise ValueError(
            "colors must be red, green and blue of each vertex as uint8 or from 0 to 1, "
            f"got shape {given.shape} of {given.dtype}"
        )
    return np.ascontiguousarray(given[:, :3])


def _feature_balls(features: NDArray[Any]) -> list[Ball]:
    return [
        (feature["position"], float(feature["sigma"]), (200, 40, 40) if feature["sign"] > 0 else (40, 80, 200))
        for feature in features
    ]
