"""Facts about a shape: health, regions, signals, presets, and the memory that bands need."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._options import OperatorLike
from adwave._shape import Path, as_shape


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


def info(shape: object, *, operator: OperatorLike = None) -> Info:
    """Facts about a shape: what it consists of, what is unusual about it, and how its diffusion is built.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    operator : str or Operator, optional
        As in `decompose`.

    Returns
    -------
    Info
        Numbers of vertices, faces, edges and components, areas and lengths in model units, and more.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.info(aw.sample("torus", vertices=1000))
    >>> found.closed, found.euler_characteristic, found.components
    (True, 0, 1)
    """
    decomposer = prepare_decomposer(shape, operator)
    own = decomposer.shape
    return Info({"kind": own.kind, "format": own.format, "fields": list(own.fields), **decomposer._data.facts()})


def region(shape: object, region: str) -> NDArray[np.float64]:
    """Weights of a region, (n,), in [0, 1].

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    region : str
        A region in its text form; see `Decomposer.region`.

    Raises
    ------
    ValueError
        If the text is not a region of this shape.

    Examples
    --------
    >>> import adwave as aw
    >>> weights = aw.region(aw.sample("sphere", vertices=500), "half-space:point=0 0 0,normal=0 0 1")
    >>> float(weights.min()), float(weights.max())
    (0.0, 1.0)
    """
    return prepare_decomposer(shape).region(region)


def signal(shape: object, name: str, *, texture: Path | None = None) -> NDArray[np.float64]:
    """A signal by its name, as values at the vertices.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `Shape`.
    name : str
        ``'coords'``, ``'x'``, ``'y'``, ``'z'``, ``'normals'``, ``'mean-curvature'``, ``'gaussian-curvature'``,
        ``'shape-index'``, ``'density'`` (of a cloud), ``'degree'`` (of a graph), ``'luminance'``, ``'lightness'``,
        ``'texture'``, ``'texture-luminance'``, ``'texture-lightness'``, a field of the shape, or a file .npy, .dmat,
        .csv or .gii.
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
    own = shape.shape if isinstance(shape, Decomposer) else as_shape(shape)
    return own.signal(name, texture=texture)


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
    return np.array(_native.preset_gains(preset, levels))


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

    own = as_shape(shape)
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "shape.mtx" if own.kind == "graph" else "shape.ply")
        own.write(source)
        code = _native.run_command(["adwave", "report", source, "-o", os.fspath(path), "--quiet"])
    if code != 0:
        raise ValueError(f"the report was not written (exit code {code}); the reason was printed to standard error")
