"""Messages for options that a function does not have: what it has, and the line that does what was meant."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from difflib import get_close_matches
from typing import Any

import numpy as np

#: Options of other libraries by the option here that they stand for.
_SAME_AS = {
    "levels": ("n_levels", "level", "n_scales", "nscales", "j", "n_bands", "nlevels", "depth", "max_level"),
    "steps": ("t", "n_steps", "time", "times", "tau", "iterations", "n_iter", "n_iterations", "iters", "power"),
    "neighbors": ("k", "knn", "n_neighbors", "n_neighbours", "neighbours", "nn"),
    "threads": ("n_jobs", "num_threads", "n_threads", "workers", "nthreads"),
    "color_map": ("cmap", "colormap", "colors_map"),
    "range": ("clim", "vmin", "vmax", "color_range"),
    "signal": ("f", "x", "data", "values", "scalars", "y", "field", "feature", "texture", "img"),
    "where": ("region", "roi", "subset"),
    "weights": ("weight", "edge_weight", "w"),
    "operator": ("method", "kernel", "laplacian", "kind", "walk", "lazy", "exact"),
    "gains": ("preset", "gain", "filter", "coefficients"),
    "sigma": ("std", "sd", "smoothing", "bandwidth", "sigmas"),
    "widths": ("scales", "lengths", "length", "sizes", "radius", "radii", "rms_width"),
    "seed": ("random_state", "rng"),
    "progress": ("verbose", "progress_bar", "show_progress"),
    "accuracy": ("tol", "tolerance", "eps", "rtol"),
    "noise": ("noise_level", "noise_sigma", "sigma_noise"),
    "vertices": ("target", "n_vertices", "n_points", "target_count", "faces_count", "target_number_of_triangles"),
    "ratio": ("target_reduction", "reduction", "fraction", "percent"),
    "axis": ("dim",),
}
_MEANING = {name: ours for ours, names in _SAME_AS.items() for name in (*names, ours)}


def refuse_unknown(function: str, options: Mapping[str, Any], known: Collection[str], wanted: Collection[str]) -> None:
    """Raise TypeError for the first option that is none of `wanted`, the optional ones of a function.

    Parameters
    ----------
    function : str
        Name of the function.
    options : mapping
        Options that were given beyond the named ones.
    known : collection of str
        Named options of the function.
    wanted : collection of str
        Further options that it takes.

    Raises
    ------
    TypeError
        With the line that does what was meant.
    """
    for name, value in options.items():
        if name not in wanted:
            every = [*known, *wanted]
            advice = _advice(name, value, every)
            listed = f"{function} takes {', '.join(every)}"
            raise TypeError(f"{function}() has no option {name!r}; {advice + '; ' if advice else ''}{listed}")


def _advice(name: str, value: Any, known: Collection[str]) -> str:
    meaning = _MEANING.get(name.lower())
    if meaning in _LINES and (advice := _LINES[meaning](value, known)):
        return advice
    if meaning in known:
        return f"that is {meaning}={_text(value)}"
    close = get_close_matches(name, known, n=1)
    return f"did you mean {close[0]}={_text(value)}?" if close else ""


def _levels_by(kind: str) -> Callable[[Any, Collection[str]], str]:
    def line(value: Any, known: Collection[str]) -> str:
        if "levels" not in known:
            return ""
        each = _list_text(value)
        return f"widths are levels=aw.Widths({kind}={each}), numbers of steps levels=aw.Steps({each})"

    return line


def _sigma(value: Any, known: Collection[str]) -> str:
    if "sigma" in known:
        return f"that is sigma={_text(value)}"
    fwhm = _list_text(value, 2.3548)
    if "levels" in known:
        return f"a width names its measure: σ along one axis is levels=aw.Widths(fwhm={fwhm}), that is 2.355·σ"
    if "fwhm" in known:
        single = _text(2.3548 * float(value)) if _is_number(value) else fwhm
        return f"a width names its measure: σ along one axis is fwhm={single}, that is 2.355·σ"
    return ""


def _steps(value: Any, known: Collection[str]) -> str:
    if "steps" in known and "levels" not in known:
        return f"a number of steps of the diffusion is steps={_text(value)}"
    return f"steps of the diffusion are levels=aw.Steps({_list_text(value)})" if "levels" in known else ""


def _neighbors(value: Any, known: Collection[str]) -> str:
    if "operator" in known:
        return f"that is operator=aw.Operator(neighbors={_text(value)})"
    return f"that is best={_text(value)}" if "best" in known else ""


def _operator(value: Any, known: Collection[str]) -> str:
    if isinstance(value, bool):
        return (
            "the bands are of the lazy walk; aw.smooth(shape, f, steps=3, lazy=False) takes steps of the walk that always "
            "moves, aw.Decomposer(shape).matrix(lazy=False) is its matrix, and exact=True is for heat on a surface"
        )
    return "that is operator='walk' or 'surface', or aw.Operator(…)" if "operator" in known else ""


def _threads(value: Any, known: Collection[str]) -> str:
    return f"all cores are used; for fewer, with aw.threads({_text(value)}): …"


def _color_map(value: Any, known: Collection[str]) -> str:
    return f"that is scale=aw.ColorScale(color_map={_text(value)})" if "scale" in known else ""


def _range(value: Any, known: Collection[str]) -> str:
    return "that is scale=aw.ColorScale(range=(least, greatest))" if "scale" in known else ""


def _signal(value: Any, known: Collection[str]) -> str:
    return "that is the second argument, or signal=…" if "signal" in known else ""


def _weights(value: Any, known: Collection[str]) -> str:
    if "where" in known:
        return (
            "weights of an edit are where=…, those of a graph aw.graph(n, edges, weights), vertices to leave out mask=…"
        )
    return "weights of the edges are aw.graph(n, edges, weights), the vertices that take part mask=…"


_LINES: dict[str | None, Callable[[Any, Collection[str]], str]] = {
    "widths": _levels_by("fwhm"),
    "sigma": _sigma,
    "steps": _steps,
    "neighbors": _neighbors,
    "operator": _operator,
    "threads": _threads,
    "color_map": _color_map,
    "range": _range,
    "signal": _signal,
    "weights": _weights,
    "ratio": lambda value, known: "the share that remains is ratio=0.1" if "ratio" in known else "",
}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _text(value: Any) -> str:
    if _is_number(value):
        return f"{value:.6g}"
    text = repr(value) if isinstance(value, (str, bool, tuple, list, type(None))) else "…"
    return text if len(text) <= 40 else "…"


def _list_text(value: Any, factor: float = 1.0) -> str:
    if _is_number(value):
        return f"[{factor * value:.6g}]"
    if isinstance(value, (list, tuple, np.ndarray)) and 0 < len(value) <= 6 and all(_is_number(v) for v in value):
        return f"[{', '.join(f'{factor * v:.6g}' for v in value)}]"
    return "[…]"
