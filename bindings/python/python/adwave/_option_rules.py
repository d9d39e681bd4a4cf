"""Options of other libraries, each with a rule that writes what it is called here into a call."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from adwave._caller import Call
from adwave._other_names import OPTIONS_OF

_UNKNOWN = object()


def is_number(value: object) -> bool:
    """True for a single number that is no flag."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


FUNCTIONS_OF_SHAPES = ("smooth", "decompose", "filter", "denoise", "saliency", "features", "region")


def wrap_grid(call: Call, **options: str) -> None:
    """The first argument, or the object of a method, as a grid with these options."""
    shown = "".join(f", {name}={text}" for name, text in options.items())
    if call.is_method:
        owner = call.prefix[:-1]
        changed = f"{owner[:-1]}{shown})" if "grid(" in owner else owner
        call.function = f"{changed}.{call.name}"
        return
    if not call.arguments:
        return
    text = call.arguments[0]
    is_grid = "grid(" in text
    call.arguments[0] = f"{text[:-1]}{shown})" if is_grid else f"{call.package}grid({text}{shown})"


def rename_keyword(call: Call, name: str, known: Collection[str]) -> None:
    """Replace an unknown keyword of a call by what it is called here."""
    text = call.keywords[name]
    rename_option(call, name, text, literal(text), known)


def rename_option(call: Call, name: str, text: str, value: Any, known: Collection[str]) -> list[str]:
    """Replace an unknown keyword; returns what it is called here."""
    del call.keywords[name]
    if name == "layer" and call.arguments:  # of an AnnData
        text = f"{call.arguments[0]}.X" if value in ("X", None) else f"{call.arguments[0]}.layers[{text}]"
    if name == "weights" and "gains" in known and isinstance(value, (list, tuple)):
        return _as_gains(call, text)
    for meaning in OPTIONS_OF.get(name, OPTIONS_OF.get(name.lower(), [])):
        rule = _RULES.get(meaning)
        found = rule(call, text, value, known) if rule is not None else None
        if found is None and meaning in known and meaning not in call.keywords:
            call.keywords[meaning] = text
            found = f"that is {meaning}={text}"
        if found is not None:
            return [found]
    close = get_close_matches(name, known, n=1)
    if close and close[0] not in call.keywords:
        call.keywords[close[0]] = text
        return [f"did you mean {close[0]}={text}?"]
    return [f"there is no counterpart of {name}"]


def _as_gains(call: Call, text: str) -> list[str]:
    call.arguments.append(text)
    return [f"gains go by position, {text}"]


def _levels(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "levels" in known:
        call.keywords["levels"] = text
        return f"that is levels={text}"
    n = int(value) if is_number(value) else 3
    if "steps" in known and call.name == "scattering":
        call.keywords["steps"] = str([2**j for j in range(n)])
        return f"the scales are steps={call.keywords['steps']}"
    if "steps" in known and "steps" not in call.keywords:
        call.keywords["steps"] = str(2 ** max(0, n - 1))
        return f"level {n} has steps={call.keywords['steps']}"
    return None


def _steps(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    numbers = _numbers(value)
    if call.name == "denoise":
        return "denoising takes no number of steps: it estimates the noise"
    if "levels" in known:
        if numbers is not None and len(numbers) == 1 and isinstance(value, int) and call.name != "filter":
            call.keywords["levels"] = f"aw.Steps([{text}])"
        elif numbers is not None and min(numbers) > 0:
            is_whole = all(n >= 1 and n == int(n) for n in numbers)
            kind = "Steps(" if is_whole else "Widths(fwhm="
            call.keywords["levels"] = f"{call.package}{kind}[{_joined(numbers)}])"
        else:
            call.keywords["levels"] = f"{call.package}Steps({text})"
        each = "[…]" if numbers is None else f"[{_joined(numbers)}]"
        return f"widths are levels=aw.Widths(fwhm={each}), numbers of steps levels=aw.Steps({each})"
    if "steps" not in known:
        return None
    if is_number(value) and 0 < value < 1 / 64 and "rms" in known:
        call.keywords["rms"] = f"{2 * value**0.5:.4g}"
        return f"heat of the time {text} has the width rms={call.keywords['rms']}"
    if numbers is None or len(numbers) == 1 or call.name == "scattering":
        call.keywords["steps"] = text
        return f"a number of steps of the diffusion is steps={text}"
    return None


def _sigma(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if call.name == "denoise" and "noise" in known:
        call.keywords["noise"] = text
        return f"the standard deviation of the noise is noise={text}"
    if "sigma" in known:
        call.keywords["sigma"] = text
        return f"that is sigma={text}"
    numbers = _numbers(value)
    if numbers is None:
        if "fwhm" in known or "levels" in known:
            call.keywords["fwhm"] = f"2.3548 * {text}"
            return "a width names its measure: σ along one axis is fwhm=2.3548·σ"
        return None
    widths = [2.3548 * each for each in numbers]
    if "levels" in known:
        call.keywords["levels"] = f"{call.package}Widths(fwhm=[{_joined(widths)}])"
        return f"a width names its measure: σ along one axis is levels=aw.Widths(fwhm=[{_joined(widths)}]), that is 2.355·σ"
    if "fwhm" in known:
        call.keywords["fwhm"] = _joined(widths[:1])
        return f"a width names its measure: σ along one axis is fwhm={_joined(widths[:1])}, that is 2.355·σ"
    return None


def _widths(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    numbers = _numbers(value)
    if "levels" in known and "best" not in known and numbers is not None:
        call.keywords["levels"] = f"{call.package}Widths(fwhm=[{_joined(numbers)}])"
        return f"widths are levels=aw.Widths(fwhm=[{_joined(numbers)}])"
    if "fwhm" in known:
        call.keywords["fwhm"] = text
        return f"a width names its measure, fwhm={text}"
    return "there is no width to choose" if call.name in ("denoise", "region") else None


def _scales(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "levels" in known and is_number(value):
        return _levels(call, text, value, known)
    return _steps(call, text, value, known)


def _neighbors(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if call.name in ("walk", "Walk", "neighbors") and call.arguments:
        call.function = f"{call.prefix}point_walk"
        call.arguments[:] = [_coordinates(call.arguments[0])]
        call.keywords = {"neighbors": text}
        return "a walk to the nearest neighbors is aw.point_walk(coordinates, neighbors=…)"
    if "neighbors" in known:
        call.keywords["neighbors"] = text
        return f"that is neighbors={text}"
    if call.name == "denoise":
        return "denoising chooses neighbors itself"
    if call.name == "impute":
        if len(call.arguments) == 1:
            walk = f"{call.package}point_walk({_coordinates(call.arguments[0])}, neighbors={text})"
            call.arguments.append(walk)
        return "the walk is the second argument, aw.point_walk(coordinates, neighbors=…)"
    if "operator" in known:
        call.keywords["operator"] = f"{call.package}Operator(neighbors={text})"
        return f"that is operator=aw.Operator(neighbors={text})"
    return None


def _coordinates(owner: str) -> str:
    """Coordinates of cells, by the name of what has them."""
    return f'{owner}.obsm["X_pca"]' if "adata" in owner and "." not in owner else owner


def _nodes(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if call.name == "graph" and len(call.arguments) == 1:
        call.function = f"{call.prefix}from_edge_index"
        call.keywords["nodes"] = text
        return "a graph by 2 × E indices is aw.from_edge_index(edge_index, nodes=…)"
    return None


def _operator(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if isinstance(value, bool):
        return (
            "the bands are of the lazy walk; aw.smooth(shape, f, steps=3, lazy=False) takes steps of the walk that always "
            "moves, aw.Decomposer(shape).matrix(lazy=False) is its matrix, and exact=True is for heat on a surface"
        )
    if "operator" not in known:
        return "there is nothing to choose here"
    if value in ("walk", "surface"):
        call.keywords["operator"] = text
    elif isinstance(value, str) and any(part in value.lower() for part in ("cot", "heat", "beltrami", "fem", "gauss")):
        call.keywords["operator"] = '"surface"'
    return "that is operator='walk' or 'surface', or aw.Operator(…)"


def _threads(call: Call, text: str, value: Any, known: Collection[str]) -> str:
    return f"all cores are used; for fewer, with aw.threads({text}): …"


def _color_map(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "scale" not in known:
        return None
    call.keywords["scale"] = f"{call.package}ColorScale(color_map={text})"
    return f"that is scale=aw.ColorScale(color_map={text})"


def _range(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "scale" not in known:
        return None
    if isinstance(value, (tuple, list)):
        call.keywords["scale"] = f"{call.package}ColorScale(range={text})"
    return "that is scale=aw.ColorScale(range=(least, greatest))"


def _signal(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "signal" not in known and "values" not in known:
        return None
    call.arguments.insert(0 if call.is_method else 1, text)
    return "the signal is the second argument" if not call.is_method else "the signal is the first argument"


def _genes(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "signal" not in known or not call.arguments:
        return None
    names = f"[{text}]" if isinstance(value, str) else text
    return _signal(call, f"{call.arguments[0]}[:, {names}].X", value, known)


def _edge_index(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if not call.arguments or call.is_method:
        return None
    signal, call.arguments[0] = call.arguments[0], f"{call.package}from_edge_index({text})"
    call.arguments.insert(1, signal)
    return "a graph by its edges is aw.from_edge_index(edge_index)"


def _where(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "where" in known:
        call.keywords["where"] = text
        return f"that is where={text}"
    if call.name == "smooth":
        call.function = f"{call.prefix}filter"
        for name in ("steps", "fwhm", "sigma", "rms"):
            call.keywords.pop(name, None)
        call.arguments.append('"smooth"')
        call.keywords["where"] = text
        return "only a filter is confined to a region; mask= leaves vertices out"
    if "mask" in known and not isinstance(value, (str, list)) and np.asarray(value).dtype.kind not in "iu":
        call.keywords["mask"] = text
        return f"the vertices that take part are mask={text}"
    return None


def _mask(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "mask" in known:
        call.keywords["mask"] = text
        return f"the places that take part are mask={text}"
    wrap_grid(call, mask=text)
    return f"the mask belongs to the grid, aw.grid(array, mask={text})"


def _weights(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if isinstance(value, str):
        return _operator(call, text, value, known) if "operator" in known else "the weights of the edges are used"
    if "where" in known:
        call.keywords["where"] = text
        return (
            "weights of an edit are where=…, those of a graph aw.graph(n, edges, weights), vertices to leave out mask=…"
        )
    return "weights of the edges are aw.graph(n, edges, weights), the vertices that take part mask=…"


def _gains(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    return _as_gains(call, text)[0] if "gains" in known else None


def _spacing(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "spacing" in known:
        call.keywords["spacing"] = text
        return f"that is spacing={text}"
    if call.name not in FUNCTIONS_OF_SHAPES:
        return None
    wrap_grid(call, spacing=text)
    return "the distance of places belongs to the grid, aw.grid(array, spacing=…)"


def _affine(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    return _spacing(call, f"np.linalg.norm(({text})[:3, :3], axis=0)", value, known)


def _periodic(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "periodic" in known or call.name in FUNCTIONS_OF_SHAPES:
        if value not in ("wrap", "periodic", "grid-wrap", "circular", True):
            return "borders reflect"
        if "periodic" in known:
            call.keywords["periodic"] = "True"
        else:
            wrap_grid(call, periodic="True")
        return "axes that repeat are aw.grid(array, periodic=True)"
    return None


def _axes(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "axes" in known:
        call.keywords["axes"] = text
        return f"the axes of the grid are axes={text}"
    if call.name not in FUNCTIONS_OF_SHAPES:
        return None
    wrap_grid(call, axes=text)
    return "the axes that are smoothed along belong to the grid, aw.grid(array, axes=…)"


def _points(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if call.name == "Shape" and not call.arguments:
        call.arguments.insert(0, text)
        return "the points come first"
    return None


def _vertices(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "vertices" not in known or call.name not in ("sample", "simplify"):
        return None
    call.keywords["vertices"] = text
    return f"that is vertices={text}"


def _faces_wanted(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "vertices" not in known:
        return None
    n = max(4, int(value) // 2 + 2) if is_number(value) else 0
    call.keywords["vertices"] = str(n) if n else f"{text} // 2"
    return "a closed mesh has half as many vertices as faces"


def _reduction(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "ratio" not in known:
        return None
    call.keywords["ratio"] = f"{1 - value:.6g}" if is_number(value) else f"1 - {text}"
    return "the share that remains is ratio=0.1"


_RULES: dict[str, Callable[[Call, str, Any, Collection[str]], str | None]] = {
    "levels": _levels,
    "widths": _widths,
    "sigma": _sigma,
    "steps": _steps,
    "neighbors": _neighbors,
    "operator": _operator,
    "threads": _threads,
    "color_map": _color_map,
    "range": _range,
    "signal": _signal,
    "genes": _genes,
    "edge_index": _edge_index,
    "where": _where,
    "mask": _mask,
    "weights": _weights,
    "gains": _gains,
    "spacing": _spacing,
    "affine": _affine,
    "periodic": _periodic,
    "axes": _axes,
    "points": _points,
    "vertices": _vertices,
    "faces_wanted": _faces_wanted,
    "nodes": _nodes,
    "reduction": _reduction,
    "nothing": lambda call, text, value, known: "it has no counterpart here",
}


def literal(text: str) -> Any:
    """Value of a text that is a constant; otherwise an object that is none."""
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError):
        return _UNKNOWN


def _numbers(value: Any) -> list[float] | None:
    """A few numbers, or None."""
    if is_number(value):
        return [float(value)]
    if isinstance(value, (list, tuple, np.ndarray)) and 0 < len(value) <= 12 and all(is_number(v) for v in value):
        return [float(v) for v in value]
    return None


def _joined(numbers: Sequence[float]) -> str:
    return ", ".join(f"{number:.6g}" for number in numbers)
