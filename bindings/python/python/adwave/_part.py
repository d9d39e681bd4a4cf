"""Shape arguments of the public functions: their faces, the vertices that take part, and results in the caller's kind.

One rule holds for all functions. Numbers come back in the axes of the numbers that were given. A shape that was changed, or
a signal of it that was named, comes back as an object of the caller's kind: a `trimesh.Trimesh` for a `trimesh.Trimesh`, a
pair for a pair, and a `Shape` for a `Shape`, a path or a `Decomposer`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt
from adwave._argument_order import MAX_CORNERS, ask_about_faces, check_order
from adwave._caller import Call
from adwave._decomposer import Decomposer, GainsLike, Layer, Selection, Where, as_domain
from adwave._grid_objects import is_image, library_of_grid, refuse_image_file
from adwave._image_data import scalars_of
from adwave._layout import Layout, region_weights, signal_values
from adwave._misfit import known_options, refuse_unknown, working_line
from adwave._options import Constraints, Length, LevelOptions, LevelsLike, OperatorLike, SignalLike, as_operator
from adwave._progress import ProgressLike
from adwave._shape import Conditions, Path, Shape, as_shape
from adwave._time import Time


class PartOptions(TypedDict, total=False):
    """Options of all functions of shapes.

    Parameters
    ----------
    faces : array_like
        Faces, if the shape is an array of points; a pair ``(points, faces)`` is the same.
    mask : array_like or path_like
        The vertices that take part, as a flag or number for each; see `Shape.select`. Arrays that are results are NaN at
        the others, and shapes that are results have the others as they were.
    only : str or sequence of str
        Conditions on fields that the vertices that take part fulfill, such as ``'classification=2'``.
    """

    faces: ArrayLike
    mask: Union[ArrayLike, Path]
    only: Conditions


class TimeOption(TypedDict, total=False):
    """Option of functions that work along time too.

    Parameters
    ----------
    time : Time
        The frames of a signal, along its last axis (of (times, n) along its first), and widths along time.
    """

    time: Union[Time, None]


class DenoiseKeywords(PartOptions, TimeOption, total=False):
    """Further options of `denoise`."""


class SmoothOptions(PartOptions, total=False):
    """Options of all functions that smooth.

    Parameters
    ----------
    exact : bool
        Heat on a surface with the masses of the mesh as they are; see `Operator.with_exact_masses`.
    """

    exact: bool


class SmoothInTimeOptions(SmoothOptions, TimeOption, total=False):
    """Further options of `smooth`."""


class SignalOptions(SmoothOptions, LevelOptions, total=False):
    """Options of all functions that split a signal into levels."""


class PrecisionOptions(SignalOptions, total=False):
    """Options of functions that split or filter signals in 32 or 64 bits.

    Parameters
    ----------
    precision : {'auto', 'single', 'double'}
        Number format of the bands: single where its error bound keeps to the accuracy, always, or never.
    """

    precision: Literal["auto", "single", "double"]


class FilterOptions(PrecisionOptions, TimeOption, total=False):
    """Further options of `filter`.

    Parameters
    ----------
    accuracy : float
        Largest error of a band relative to the band.
    """

    accuracy: float


class SmoothCall(SmoothInTimeOptions, total=False):
    """All keywords of `smooth`, for type checkers."""

    fwhm: Union[Length, Sequence[float], None]
    rms: Union[Length, Sequence[float], None]
    lazy: bool
    operator: OperatorLike
    accuracy: float
    progress: ProgressLike


class FilterCall(FilterOptions, total=False):
    """All keywords of `filter`, for type checkers."""

    where: Where
    levels: LevelsLike
    operator: OperatorLike
    constraints: Union[Constraints, None]
    local_fit: Union[Literal["linear", "constant"], None]
    progress: ProgressLike


NoiseModel = Literal["gaussian", "poisson", "multiplicative", "rician", "shared"]


class DenoiseCall(DenoiseKeywords, total=False):
    """All keywords of `denoise`, for type checkers."""

    strength: float
    creases: Literal["auto", "keep", "none"]
    noise: Union[float, NoiseModel, tuple[NoiseModel, float], None]
    local_fit: Literal["linear", "constant"]
    outliers: Literal["keep", "pull"]
    operator: OperatorLike
    progress: ProgressLike


_PART = ("faces", "mask", "only")
_EXACT = (*_PART, "exact")
_SIGNAL = (*_EXACT, "fwhm", "steps")
_WITH_PRECISION = ("decompose", "filter")


@dataclass
class Part:
    """A shape argument: the caller's object, the shape, and the part of it that takes part."""

    given: object
    whole: Union[Shape, Decomposer]
    part: Union[Shape, Decomposer]
    selection: Union[Selection, None]
    function: str = ""

    @property
    def shape(self) -> Shape:
        """The part that takes part, as a shape."""
        return self.part.shape if isinstance(self.part, Decomposer) else self.part

    @property
    def whole_shape(self) -> Shape:
        """The shape with all vertices."""
        return self.whole.shape if isinstance(self.whole, Decomposer) else self.whole

    def take_signal(self, signal: SignalLike) -> SignalLike:
        """A signal at the vertices that take part; names are unchanged."""
        if self.selection is None or signal is None or isinstance(signal, str):
            return signal
        values, layout = signal_values(signal, self.whole_shape.n_vertices)
        rows = np.ascontiguousarray(values[self.selection.rows])
        return layout.with_vertices(len(rows)).arrange(rows)

    def take_where(self, where: Where) -> Where:
        """Weights at the vertices that take part; the text of a region is unchanged."""
        if self.selection is None or where is None or isinstance(where, str):
            return where
        return region_weights(where, self.whole_shape.n_vertices)[self.selection.rows]

    def take_layers(self, gains: GainsLike) -> GainsLike:
        """Layers with weights at the vertices that take part; plain gains are unchanged."""
        if self.selection is None or isinstance(gains, str):
            return gains
        if isinstance(gains, Layer):
            return Layer(gains.gains, self.take_where(gains.where))
        if len(gains) and all(isinstance(layer, Layer) for layer in gains):
            return [Layer(layer.gains, self.take_where(layer.where)) for layer in gains]  # type: ignore[union-attr]
        return gains

    def spread(self, values: NDArray[np.float64], layout: Layout, others: SignalLike = None) -> NDArray[np.float64]:
        """Values in the caller's axes at all vertices: those of `others`, or NaN, where a vertex takes no part."""
        if self.selection is None:
            return values
        n = self.whole_shape.n_vertices
        part = layout.with_vertices(len(self.selection.rows))
        if others is None:
            whole = np.full((n, layout.n_channels), np.nan)
        else:
            whole = np.array(signal_values(others, n)[0])
        whole[self.selection.rows] = part.flatten(values)
        return layout.with_vertices(n).arrange(whole)

    def moved(self, part: Shape) -> Any:
        """The caller's object with the vertices that take part at other positions."""
        moved = part
        if self.selection is not None:
            points = np.array(self.whole_shape.points)
            points[self.selection.rows] = part.points
            moved = self.whole_shape._with_positions(points)
        if self.is_own:
            return moved
        return _adapt.with_results(self.given, points=np.array(moved.points), fields=_normals(self.given, moved))

    def with_named_signal(self, part: Shape, name: str) -> Any:
        """The caller's object with a signal that was named as it is in `part`."""
        if name in ("coords", "x", "y", "z") and name not in part.fields:
            return self.moved(part)
        if name not in part.fields:
            return part if self.is_own else _adapt.with_results(self.given, fields=dict(part.fields))
        values = np.asarray(part.fields[name])
        if self.selection is not None:
            whole = np.array(self.whole_shape.signal(name), dtype=np.float64)
            whole[self.selection.rows] = values
            values = whole
        if self.is_own:
            return part if self.selection is None else self.whole_shape.with_field(name, values)
        return _adapt.with_results(self.given, fields={name: values})

    @property
    def is_own(self) -> bool:
        """True if results are `Shape` objects, because the caller's kind of object cannot store them."""
        given = self.given
        return isinstance(given, (Shape, Decomposer)) or _adapt.is_path(given) or not _adapt.can_hold_results(given)


def _normals(given: object, moved: Shape) -> dict[str, Any]:
    """Normals of moved vertices under the names that the caller's object has for them."""
    if moved.kind != "mesh" or not _adapt.stores_normals(given):
        return {}
    names = [name for name in moved.fields if name.lower() in ("normal", "normals")]
    return {name: moved.fields[name] if name == "normal" else moved.signal("normals") for name in names}


def read_part(
    function: str,
    shape: object,
    options: Mapping[str, Any],
    known: Collection[str],
    signal: object = None,
) -> Part:
    """The shape argument of a public function with its options.

    Parameters
    ----------
    function : str
        Name of the function, for messages.
    shape : shape_like
        The argument.
    options : mapping
        Options of `PartOptions` or `SignalOptions`, or unknown ones.
    known : collection of str
        Names of the function's own options.
    signal : object
        The signal, which may be faces by mistake.

    Raises
    ------
    TypeError
        If an option is unknown, or an argument is not what it looks like.
    ValueError
        If an argument is invalid.
    """
    wanted = _SIGNAL if "levels" in known else _EXACT if "operator" in known else _PART
    wanted += ("precision",) if function in _WITH_PRECISION else ()
    wanted += ("accuracy",) if function == "filter" else ()
    check_order(function, shape, signal, [*known, *wanted])
    if options.get("faces") is None and signal is not None:
        ask_about_faces(function, shape, signal, [*known, *wanted])
    if options:
        refuse_unknown(function, options, known, wanted, [each for each in (shape, signal) if each is not None])
    shape = as_domain(shape)
    faces = options.get("faces")
    mask, only = options.get("mask"), options.get("only")
    if isinstance(shape, Decomposer):
        given = next((name for name in _PART if options.get(name) is not None), None)
        if given is not None:
            raise ValueError(
                f"{given}: a Decomposer is prepared for its whole shape; prepare the part, "
                f"aw.Decomposer(shape.select({given}={given}))"
                if given != "faces"
                else "faces: a Decomposer has a shape already; leave them out"
            )
        return Part(shape, shape, shape, None, function)
    given = shape if faces is None else (shape, faces)
    whole = as_shape(shape, faces)
    if mask is None and only is None:
        return Part(given, whole, whole, None, function)
    part = whole.select(only, mask=mask)
    rows = np.flatnonzero(np.isin(whole.file_rows, part.file_rows))
    return Part(given, whole, part, Selection(whole, rows), function)


def exact_operator(operator: OperatorLike, options: Mapping[str, Any]) -> OperatorLike:
    """The operator with exact masses, if these are asked for."""
    return as_operator(operator).with_exact_masses() if options.get("exact") else operator


def own_signal(given: object) -> SignalLike:
    """Data of an object that is a signal on a shape, such as an image on a surface; None for a shape."""
    return given._own_signal() if isinstance(given, Decomposer) else _adapt.own_signal(given)


def default_signal(part: Part, signal: SignalLike) -> SignalLike:
    """The signal, or the data of an object that is a signal on a shape, such as an image on a surface.

    Raises
    ------
    ValueError
        If there is none, and the shape is a graph without positions, which are the signal of all others.
    """
    given = part.given
    if isinstance(signal, Mapping) and _adapt.has_nodes(given):
        # Values by the names of the nodes, as in NetworkX.
        return np.array([signal.get(node, np.nan) for node in given], dtype=np.float64)  # type: ignore[attr-defined]
    if isinstance(signal, os.PathLike):
        return os.fspath(signal)  # type: ignore[return-value]
    if isinstance(signal, str):
        _refuse_values_of_faces(part, signal)
    if signal is not None:
        return signal
    own = own_signal(given)
    if own is None and part.whole_shape.kind == "graph" and not part.whole_shape.points.size:
        fields = part.whole_shape.fields
        names = [repr(name) for name in fields if fields[name].ndim == 1]
        text = names[0] if names else "f"

        def add(call: Call) -> None:
            call.arguments.insert(0 if call.is_method else 1, text)

        line = working_line(part.function, add, f"aw.{part.function}(graph, f)")
        raise ValueError(f"{part.function}: a graph without positions needs a signal, one value for each node{line}")
    return own


def _refuse_values_of_faces(part: Part, name: str) -> None:
    """Raise ValueError for the name of values at faces; those of PyVista become values at points in the line."""
    whole = part.whole
    if not isinstance(whole, Shape) or name in whole.fields or name not in whole.face_fields:
        return

    def average(call: Call) -> None:
        at = call.prefix[:-1] if call.is_method else call.arguments[0]
        changed = f"{at}.cell_data_to_point_data()"
        if call.is_method:
            call.function = f"{changed}.{call.name}"
        else:
            call.arguments[0] = changed

    line = "; average them at the vertices first"
    if hasattr(part.given, "cell_data_to_point_data"):
        line = working_line(part.function, average, f"aw.{part.function}(mesh.cell_data_to_point_data(), {name!r})")
    raise ValueError(f"signal: {name!r} has values at the faces, and a signal has one at each vertex{line}")


def grid_method(function: str, shape: Any, options: Any, signal: Any = None) -> Callable[..., Any] | None:
    """Method of an image or a volume, which knows the axes of its signals; None for all other shapes.

    Images of nibabel, SimpleITK, PyVista, rasterio and xarray are grids, and so is an array of three long axes. A mask
    belongs to the grid, and is taken out of the options. The signal says which array of an `ImageData` is meant.
    """
    kind = type(shape)
    if kind.__name__ == "Grid" and kind.__module__.startswith("adwave."):
        places, names = known_options(getattr(kind, function))
        refuse_unknown(function, options, [*places[1:], *names], ())
        return getattr(shape, function)
    refuse_image_file(function, shape)
    library = library_of_grid(shape)
    is_points = np.ndim(shape) == 2 and np.shape(shape)[1] in (2, 3) if library == "xarray" else not is_image(shape)
    if is_points and not (isinstance(shape, np.ndarray) and shape.ndim == 3 and min(shape.shape) > MAX_CORNERS):
        return None
    import adwave  # the package loads the module of `Grid`, which is above this one

    Grid = adwave.Grid
    mask = options.pop("mask", None)
    places, names = known_options(getattr(Grid, function))
    refuse_unknown(function, options, [*places[1:], *names], ())
    if library == "pyvista":
        shape = scalars_of(shape, signal)
    return getattr(Grid(shape, mask=mask), function)
