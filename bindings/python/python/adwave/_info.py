"""What a shape is, and what it has: health, regions, signals, what it would take."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._decomposer import Decomposer, prepared
from adwave._shape import Path, as_shape


class Info(Mapping[str, Any]):
    """What a shape consists of and what is unusual about it, as a mapping; prints as a table."""

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
    return str(value)


def info(shape: object, faces: object = None, **operator: Any) -> Info:
    """What a shape consists of, what is unusual about it, and how its diffusion is built.

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    **operator
        The options of `Decomposer`.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.info(aw.sample("torus", vertices=1000))
    >>> found.closed, found.euler_characteristic, found.components
    (True, 0, 1)
    """
    own = prepared(shape, faces, operator)
    kind = {"kind": own.shape.kind, "format": own.shape.format, "fields": list(own.shape.fields)}
    return Info({**kind, **own._data.facts()})


def region(shape: object, region: str, faces: object = None) -> NDArray[np.float64]:
    """The weights of a region, one in [0, 1] for each vertex; see `Decomposer.region`.

    Examples
    --------
    >>> import adwave as aw
    >>> weights = aw.region(aw.sample("sphere", vertices=500), "half-space:point=0 0 0,normal=0 0 1")
    >>> float(weights.min()), float(weights.max())
    (0.0, 1.0)
    """
    return prepared(shape, faces, {}).region(region)


def signal(shape: object, name: str, faces: object = None, *, texture: Path | None = None) -> NDArray[np.float64]:
    """A signal by its name, as values at the vertices.

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `Shape`.
    name : str
        ``'coords'``, ``'x'``, ``'y'``, ``'z'``, ``'normals'``, ``'mean-curvature'``, ``'gaussian-curvature'``,
        ``'shape-index'``, ``'density'`` (of a cloud), ``'degree'`` (of a graph), ``'luminance'``, ``'lightness'``,
        ``'texture'``, ``'texture-luminance'``, ``'texture-lightness'``, a field of the shape, or a file .npy, .dmat, .csv or .gii.
    texture : path-like, optional
        The picture of the texture, in the place of the one that the materials name.

    Examples
    --------
    >>> import adwave as aw
    >>> curvature = aw.signal(aw.sample("sphere", vertices=2000), "mean-curvature")
    >>> bool(abs(curvature - 1).mean() < 0.05)
    True
    """
    own = shape.shape if isinstance(shape, Decomposer) else as_shape(shape, faces)
    return own.signal(name, texture=texture)


def preset_gains(preset: str, levels: int) -> NDArray[np.float64]:
    """The gains of a preset for so many levels.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.preset_gains("smooth", 3)
    array([0., 0., 2.])
    """
    return np.array(_native.preset_gains(preset, levels))


def memory_needed(shape: object, faces: object = None, *, levels: int = 8, channels: int = 3) -> dict[str, int]:
    """Bytes that `decompose` takes beyond the prepared shape.

    Returns
    -------
    dict
        ``work``: while it runs; ``result``: the bands.
    """
    work, result = prepared(shape, faces, {})._data.bytes(channels, levels)
    return {"work": work, "result": result}


def report(shape: object, path: Path, faces: object = None) -> None:
    """Write one page about a shape: health, bands, saliency, features and presets, as pictures and tables.

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `Shape`.
    path : path-like
        The page, ``.html``.

    Raises
    ------
    ValueError
        The shape or the path is wrong.
    """
    import tempfile

    own = as_shape(shape, faces)
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "shape.mtx" if own.kind == "graph" else "shape.ply")
        own.write(source)
        code = _native.run_command(["adwave", "report", source, "-o", os.fspath(path), "--quiet"])
    if code != 0:
        raise ValueError(f"the report was not written (exit code {code}); what is wrong stands on the standard error")
