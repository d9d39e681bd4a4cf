"""Facts about a shape: health, regions, signals, presets, and the memory that bands need."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._caller import Call, public
from adwave._decomposer import Where, prepare_decomposer
from adwave._grid_domain import GridDecomposer
from adwave._layout import Layout, region_weights
from adwave._misfit import working_line
from adwave._options import Length, OperatorLike, check_levels
from adwave._part import exact_operator, read_part
from adwave._shape import Path

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._part import PartOptions, SmoothOptions


class Info(Mapping[str, Any]):
    """Facts about a shape: its parts and its irregularities. A mapping that prints as a table.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.info(aw.sample("sphere", vertices=500))
    >>> found["vertices"], found.closed
    (500, True)
    """

    __slots__ = ("_facts",)

    def __init__(self, facts: dict[str, Any]) -> None:
        self._facts = facts

    def __getitem__(self, name: str) -> Any:
        return self._facts[name]

    def __iter__(self) -> Any:
        return iter(self._facts)

    def __len__(self) -> int:
        return len(self._facts)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._facts:
            raise AttributeError(f"there is no {name!r}; there is {', '.join(self._facts)}")
        return self._facts[name]

    def __reduce__(self) -> tuple[Any, ...]:
        return Info, (self._facts,)

    def __repr__(self) -> str:
        return "\n".join(f"{name:<20} {_plain(value)}" for name, value in self._facts.items())


def _plain(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, tuple):
        return " to ".join(" ".join(f"{c:.4g}" for c in corner) for corner in value)
    if isinstance(value, list) and len(value) > 5:
        return f"{len(value)}: {', '.join(map(str, value[:5]))}, …"
    return str(value)


@public()
def info(shape: object, *, operator: OperatorLike = None, **options: Unpack[SmoothOptions]) -> Info:
    """Facts about a shape: what it consists of, what is unusual about it, and how its diffusion is built.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    operator : str or Operator, optional
        As in `decompose`.
    **options
        ``faces=``, and ``mask=`` or ``only=``, the vertices that take part.

    Returns
    -------
    Info
        Numbers of vertices, faces, edges and components, areas and lengths in model units, and more. With
        ``operator="surface"`` also ``raised_masses``, the number of vertices whose masses were raised to bound the time, and
        ``added_mass``, the share of the area that this adds; ``exact=True`` raises none. Of an image or a volume its axes,
        spacings and places.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.info(aw.sample("torus", vertices=1000))
    >>> found.closed, found.euler_characteristic, found.components
    (True, 0, 1)
    """
    part = read_part("info", shape, options, ("operator",)).part
    decomposer = prepare_decomposer(part, exact_operator(operator, options))
    if isinstance(decomposer, GridDecomposer):
        return Info(decomposer.facts())
    own = decomposer.shape
    return Info({"kind": own.kind, "format": own.format, "fields": list(own.fields), **decomposer._data.facts()})


@public()
def region(
    shape: object, region: Where, *, blur: Length | None = None, **options: Unpack[PartOptions]
) -> NDArray[np.float64]:
    """Weights of a region, (n,), in [0, 1].

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    region : str or array_like
        A region in its text form (see `Decomposer.region`), a weight for each vertex, or indices of vertices.
    blur : float or str, optional
        Length over which the weights are smoothed along the shape, in model units or as a share of the diagonal.
    **options
        ``faces=``, and ``mask=`` or ``only=``, the vertices that take part; the others are 0.

    Raises
    ------
    ValueError
        If the text is not a region of this shape.

    Examples
    --------
    >>> import adwave as aw
    >>> sphere = aw.sample("sphere", vertices=500)
    >>> weights = aw.region(sphere, "half-space:point=0 0 0,normal=0 0 1")
    >>> float(weights.min()), float(weights.max())
    (0.0, 1.0)
    >>> soft = aw.region(sphere, sphere.points[:, 2] > 0, blur="5%")
    >>> bool(((0.2 < soft) & (soft < 0.8)).any())
    True
    """
    part = read_part("region", shape, options, ("region", "blur"))
    text, own = part.take_where(region), part.part
    if not isinstance(text, str):
        if text is None:
            raise ValueError("region must be a text such as 'ball:vertex=120,radius=10%', weights or indices, got None")
        weights = region_weights(text, part.shape.n_vertices, "region")
        own, text = part.shape.with_field(_REGION, weights), f"field:name={_REGION},low=0,high=1"
    if blur is not None:
        text = f"blurred:by={blur}({text})"
    try:
        found = prepare_decomposer(own).region(text)
    except ValueError as error:
        if "there is no region" not in str(error):
            raise
        example = '"ball:vertex=0,radius=10%"'

        def change(call: Call) -> None:
            call.arguments[-1] = example

        raise ValueError(f"{error}{working_line('region', change, f'aw.region(shape, {example})')}") from None
    if part.selection is None:
        return found
    return part.spread(found, Layout(len(found)), np.zeros(part.whole_shape.n_vertices))


#: Field that holds the weights of a region which is given by numbers.
_REGION = "_region"


@public()
def signal(shape: object, name: str, *, texture: Path | None = None) -> NDArray[np.float64]:
    """A signal by its name, as values at the vertices.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `Shape`.
    name : str
        ``'coords'``, ``'x'``, ``'y'``, ``'z'``, ``'normals'``, ``'mean-curvature'``, ``'gaussian-curvature'``,
        ``'shape-index'``, ``'principal-direction'`` (times κ₁ − κ₂; a line for `vectors`), ``'density'`` (of a cloud),
        ``'degree'`` (of a graph), ``'luminance'``, ``'lightness'``, ``'texture'``, ``'texture-luminance'``,
        ``'texture-lightness'``, a field of the shape, or a file .npy, .dmat, .csv or .gii.
    texture : path_like, optional
        Picture of the texture, instead of the one that the materials name.

    Returns
    -------
    (n,) or (n, channels) array

    Raises
    ------
    ValueError
        If the shape has no such signal.

    Examples
    --------
    >>> import adwave as aw
    >>> curvature = aw.signal(aw.sample("sphere", vertices=2000), "mean-curvature")
    >>> bool(abs(curvature - 1).mean() < 0.05)
    True
    """
    return read_part("signal", shape, {}, ()).shape.signal(name, texture=texture)


def preset_gains(preset: str, levels: int) -> NDArray[np.float64]:
    """Gains of a preset, (levels,), from fine to coarse.

    Parameters
    ----------
    preset : str
        Name of a preset; see `filter`.
    levels : int
        Number of levels.

    Raises
    ------
    ValueError
        If there is no such preset.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.preset_gains("smooth", 3)
    array([0., 0., 2.])
    """
    checked = check_levels(levels)
    if not isinstance(checked, int):
        raise TypeError(f"levels must be a number of levels such as 8, got {levels!r}")
    return np.array(_native.preset_gains(preset, checked))


@public()
def memory_needed(shape: object, *, levels: int = 8, channels: int = 3) -> dict[str, int]:
    """Bytes that `decompose` needs beyond the prepared shape.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    levels : int
        Number of levels.
    channels : int
        Numbers at each vertex: 3 for the coordinates.

    Returns
    -------
    dict
        ``work``: during the call; ``result``: the bands.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.memory_needed(aw.sample("sphere", vertices=1000), levels=4)["result"]
    120000
    """
    work, result = prepare_decomposer(shape)._data.bytes(channels, levels)
    return {"work": work, "result": result}


@public()
def report(shape: object, path: Path) -> None:
    """Write a page about a shape: health, bands, saliency, features and presets, as pictures and tables.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `Shape`.
    path : path_like
        The page, ``.html``.

    Raises
    ------
    ValueError
        If the shape or the path is invalid.

    Examples
    --------
    >>> import adwave as aw, os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:  # doctest: +SKIP
    ...     aw.report(aw.sample("sphere", vertices=500), os.path.join(folder, "page.html"))
    """
    import tempfile

    own = read_part("report", shape, {}, ()).shape
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "shape.mtx" if own.kind == "graph" else "shape.ply")
        own.write(source)
        code = _native.run_command(["adwave", "report", source, "-o", os.fspath(path), "--quiet"])
    if code != 0:
        raise ValueError(f"the report was not written (exit code {code}); the reason was printed to standard error")
