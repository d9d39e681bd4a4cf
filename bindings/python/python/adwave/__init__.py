"""Wavelets for shapes: split a mesh, a point cloud or a graph, or any signal on it, into bands from fine to coarse.

Each band is local in space and in frequency. Look at the bands (`saliency`, `features`), change them (`filter`, `Bands.apply`,
`denoise`), and put the shape back together without loss:

>>> import adwave as aw
>>> shape = aw.sample("creature", vertices=3000)
>>> bands = aw.decompose(shape, levels=6)
>>> bands.shape
(7, 3032, 3)
>>> bool(abs(bands.reconstruct() - shape.points).max() < 1e-12)
True

A *shape* may be a path, an array of points, a pair ``(points, faces)``, a sparse matrix or an object of trimesh, PyVista, meshio,
Open3D or networkx. The order and the number of its vertices never change, and nothing is changed in place.

Nothing but this file is loaded by ``import adwave``; numpy and the rest come with the first name that is used.
"""

from __future__ import annotations

_PLACES = {
    "Shape": "_shape",
    "as_shape": "_shape",
    "graph": "_shape",
    "read": "_shape",
    "read_bytes": "_shape",
    "sample": "_shape",
    "Decomposer": "_decomposer",
    "Bands": "_bands",
    "Layer": "_bands",
    "Recipe": "_recipe",
    "read_recipe": "_recipe",
    "Denoised": "_edits",
    "Features": "_measures",
    "Info": "_info",
    "Saliency": "_measures",
    "Changed": "_repeatability",
    "Repeatability": "_repeatability",
    "repeatability": "_repeatability",
    "decompose": "_edits",
    "denoise": "_edits",
    "features": "_measures",
    "filter": "_edits",
    "gaze_scores": "_measures",
    "info": "_info",
    "memory_needed": "_info",
    "preset_gains": "_info",
    "region": "_info",
    "report": "_info",
    "saliency": "_measures",
    "signal": "_info",
    "Distances": "_register",
    "Matched": "_register",
    "Simplified": "_register",
    "distances": "_register",
    "match": "_register",
    "simplify": "_register",
    "Picture": "_picture",
    "render": "_picture",
    "Edited": "_studio",
    "studio": "_studio",
    "show_versions": "_environment",
    "threads": "_environment",
    "InternalError": "_native",
    "__version__": "_native",
}

__all__ = [
    "Bands",
    "Changed",
    "Decomposer",
    "Denoised",
    "Distances",
    "Edited",
    "Features",
    "Info",
    "InternalError",
    "Layer",
    "Matched",
    "Picture",
    "Recipe",
    "Repeatability",
    "Saliency",
    "Shape",
    "Simplified",
    "__version__",
    "as_shape",
    "baselines",
    "decompose",
    "denoise",
    "distances",
    "features",
    "filter",
    "gaze_scores",
    "graph",
    "info",
    "match",
    "memory_needed",
    "preset_gains",
    "read",
    "read_bytes",
    "read_recipe",
    "region",
    "render",
    "repeatability",
    "report",
    "saliency",
    "sample",
    "show_versions",
    "signal",
    "simplify",
    "studio",
    "threads",
]

_MODULES = ("baselines", "dask", "sklearn", "torch")


def __getattr__(name: str) -> object:
    place = name if name in _MODULES else _PLACES.get(name)
    if place is None:
        raise AttributeError(f"module 'adwave' has no attribute {name!r}")
    # Here, since `import adwave` should cost next to nothing.
    from importlib import import_module

    module = import_module(f"{__name__}.{place}")
    value = module if name in _MODULES else getattr(module, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(__all__) | set(_MODULES))
