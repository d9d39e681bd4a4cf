"""Calls that do not fit the parameters of a function: what was meant, and the line that does it.

A `Call` is the text that the user wrote. Each rule here changes it, so that the line in the message has the user's own
names and runs as it is.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import numpy as np

from adwave._caller import Call, written_call
from adwave._other_names import FORMER, OPTIONS_OF, PRESETS, SHAPE_WORDS

_UNKNOWN = object()


def is_image_like(value: object) -> bool:
    """True if an array has the axes of an image or a volume, and not those of points in space."""
    shape = getattr(value, "shape", ())
    return isinstance(shape, tuple) and (len(shape) == 3 or (len(shape) == 2 and shape[1] > 3 and shape[0] > 1))


def is_square(value: object) -> bool:
    """True if an array has the axes of a matrix of a graph."""
    shape = getattr(value, "shape", ())
    return isinstance(shape, tuple) and len(shape) == 2 and shape[0] == shape[1]


def is_number(value: object) -> bool:
    """True for a single number that is no flag."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def looks_like_faces(points: object, faces: object) -> bool:
    """True if two arrays are the vertices and the triangles or quadrilaterals of a mesh."""
    first, second = np.shape(points), np.shape(faces)  # type: ignore[arg-type]
    if len(first) != 2 or len(second) != 2 or first[1] not in (2, 3) or second[1] not in (3, 4):
        return False
    corners = np.asarray(faces)
    # Bytes are colors, and corners of a face differ.
    if corners.dtype.kind not in "iu" or corners.dtype.itemsize == 1 or not corners.size:
        return False
    few = np.sort(corners[:100], axis=1)
    return bool(not (few[:, 1:] == few[:, :-1]).any() and corners.min() >= 0 and corners.max() < first[0])


def working_line(function: str, change: Callable[[Call], None], otherwise: str = "") -> str:
    """The user's call of a function after a change, as ``"; write …"``; without its text, `otherwise` in its place.

    Parameters
    ----------
    function : str
        Name of the function.
    change : callable
        Function that changes a `Call`.
    otherwise : str
        Line with the usual names.
    """
    call = written_call(function)
    if call is None:
        return f"; write {otherwise}" if otherwise else ""
    change(call)
    complete(call, None)
    return f"; write {call}"


def line_with(function: str, **keywords: str) -> str:
    """The user's call of a function with other keywords, as ``"; write …"``."""
    shown = ", ".join(["shape", "f", *(f"{name}={text}" for name, text in keywords.items())])
    return working_line(function, lambda call: call.keywords.update(keywords), f"aw.{function}({shown})")


def known_options(function: Callable[..., Any]) -> tuple[list[str], list[str]]:
    """Names of the positional and of all further parameters of a function, those of ``**options`` too."""
    places, names = [], []
    plain = inspect.unwrap(function)
    for parameter in inspect.signature(plain).parameters.values():
        if parameter.kind in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD):
            places.append(parameter.name)
        elif parameter.kind is parameter.KEYWORD_ONLY:
            names.append(parameter.name)
        elif parameter.kind is parameter.VAR_KEYWORD:
            names += _names_of_dict(parameter.annotation)
    return places, names


def _names_of_dict(annotation: object) -> list[str]:
    """Keys of ``Unpack[SomeOptions]``, which is a text in this package."""
    _options, _part = (import_module(f"adwave.{each}") for each in ("_options", "_part"))
    name = str(annotation).partition("[")[2].rstrip("]'\"")
    options = getattr(_part, name, None) or getattr(_options, name, None)
    return [] if options is None else _all_keys(options)


def _all_keys(options: type) -> list[str]:
    return sorted({*getattr(options, "__required_keys__", ()), *getattr(options, "__optional_keys__", ())})


def misfit(function: Callable[..., Any], arguments: Sequence[Any], options: Mapping[str, Any], why: str) -> str:
    """Message for a call that does not fit the parameters of a function, with the line that works.

    Parameters
    ----------
    function : callable
        The function, a method or a constructor.
    arguments, options : sequence, mapping
        What it was called with.
    why : str
        Python's message.
    """
    places, names = known_options(function)
    qualified = function.__qualname__.split(".")
    is_method = places[:1] == ["self"]
    name = type(arguments[0]).__name__ if is_method and qualified[-1] == "__init__" else qualified[-1]
    values: list[Any] = list(arguments[1:] if is_method else arguments)
    places = places[1:] if is_method else places
    owner = type(arguments[0]).__name__.lower() if is_method and name == qualified[-1] else ""
    call = written_call(name)
    if call is None and name in FORMER and (call := written_call(FORMER[name])) is not None:
        call.function = f"{call.prefix}{name}"
    if call is not None and call.is_method and places[:1] == ["shape"] and len(call.arguments) == len(values) - 1:
        values, places = values[1:], places[1:]
    if call is None or len(call.arguments) != len(values) or set(call.keywords) != set(options):
        call = _stand_in(name, owner, values, options)
    known = [*places, *names]
    reasons = repair(call, known, places, values, dict(options))
    listed = f"{name} takes {', '.join(known)}"
    wrong = next((option for option in options if option not in known), None)
    if wrong is not None:
        start = f"{name}() has no option {wrong!r}"
    else:
        start = " ".join(why.split()).replace(f"{function.__qualname__}()", f"{name}()")
    return f"{start}; {'; '.join([*reasons, listed])}; write {call}"


def _stand_in(name: str, owner: str, values: Sequence[Any], options: Mapping[str, Any]) -> Call:
    """A call with the usual names for values whose text is not at hand."""

    def text(value: Any, place: int) -> str:
        if isinstance(value, (str, bool, int, float, type(None))):
            return repr(value)
        if isinstance(value, (list, tuple)) and len(str(value)) <= 40:
            return repr(value)
        if not owner and place == 0:
            shape = getattr(value, "shape", ())
            return "V" if len(shape) == 2 and shape[1] in (2, 3) else "shape"
        return "F" if place == 1 and looks_like_faces(values[0], value) else "f"

    shown = {key: text(value, -1) for key, value in options.items()}
    texts = [text(value, i) for i, value in enumerate(values)]
    return Call(f"{owner or 'aw'}.{name}", texts, shown, is_method=bool(owner))


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
    every = [*known, *wanted]
    wrong = [name for name in options if name not in every]
    if not wrong:
        return
    call = written_call(function)
    if call is None or not set(wrong) <= set(call.keywords):
        shown = {name: text_of(value) for name, value in options.items()}
        call = Call(f"aw.{function}", ["shape"], shown)
    reasons = repair(call, every, (), None, dict(options))
    listed = f"{function} takes {', '.join(every)}"
    raise TypeError(f"{function}() has no option {wrong[0]!r}; {'; '.join([*reasons, listed])}; write {call}")


def repair(
    call: Call,
    known: Collection[str],
    places: Sequence[str] = (),
    values: Sequence[Any] | None = None,
    options: Mapping[str, Any] | None = None,
) -> list[str]:
    """Change a call so that it fits; returns what was changed, in words.

    Parameters
    ----------
    call : Call
        The call, which is changed.
    known : collection of str
        Names of all parameters of the function.
    places : sequence of str
        Names of those that may be given by position.
    values : sequence, optional
        Values of the arguments by position.
    options : mapping, optional
        Values of the arguments by name.
    """
    reasons: list[str] = []
    options = options or {}
    given = list(values) if values is not None else None
    if given is not None:
        reasons += _pair_faces(call, given)
        reasons += _signal_second(call, given, places)
    unknown = [name for name in call.keywords if name not in known]
    if unknown and places and not call.arguments and places[0] not in call.keywords and places[0] != "signal":
        first = next((word for word in SHAPE_WORDS if word in unknown), unknown[0])
        unknown.remove(first)
        text = call.keywords.pop(first)
        call.arguments.append(f"{call.package}from_edge_index({text})" if first == "edge_index" else text)
        reasons.append(f"{call.arguments[0]} goes first")
    for name in unknown:
        text = call.keywords[name]
        value = options.get(name, literal(text))
        reasons += rename_option(call, name, text, value, known)
    if places and given is not None:
        reasons += move_surplus(call, places, given, known)
    complete(call, given, known)
    return [reason for reason in reasons if reason]


def _pair_faces(call: Call, values: list[Any]) -> list[str]:
    """Points and faces in a pair."""
    if call.is_method or call.name in ("Shape", "match", "distances"):
        return []
    at = next((i for i in range(len(values) - 1) if looks_like_faces(values[i], values[i + 1])), None)
    if at is None:
        if (
            len(values) > 1
            and isinstance(values[0], list)
            and looks_like_faces(np.array(values[0]), np.array(values[1]))
        ):
            at = 0
        else:
            return []
    pair = (values[at], values[at + 1])
    values[at : at + 2] = [pair]
    call.arguments[at : at + 2] = [f"({call.arguments[at]}, {call.arguments[at + 1]})"]
    return [f"are {call.arguments[at]} points and faces? They go in a pair"]


def _signal_second(call: Call, values: list[Any], places: Sequence[str]) -> list[str]:
    """The shape before its signal."""
    if call.is_method or list(places[:2]) != ["shape", "signal"] or len(values) < 2:
        return []
    first, second = values[:2]
    is_signal = np.ndim(first) == 1 if isinstance(first, np.ndarray) else False
    is_shape = isinstance(second, tuple) or np.ndim(second) == 2 or not hasattr(second, "__len__")
    if not is_signal or not is_shape or is_number(second):
        return []
    values[:2] = [second, first]
    call.arguments[:2] = [call.arguments[1], call.arguments[0]]
    return ["the shape comes first and its signal second"]


#: Meaning of a further argument by position.
SURPLUS = {
    "smooth": "steps",
    "decompose": "levels",
    "saliency": "levels",
    "features": "best",
    "denoise": "strength",
    "simplify": "ratio",
    "point_walk": "neighbors",
    "impute": "steps",
    "render": "path",
}


def move_surplus(call: Call, places: Sequence[str], values: list[Any], known: Collection[str]) -> list[str]:
    """Arguments beyond those that go by position, by name."""
    if call.name == "Decomposer" and len(call.arguments) == 2:
        text = call.arguments.pop()
        call.keywords.setdefault("operator", text)
        return []
    reasons = []
    while len(call.arguments) > len(places):
        text = call.arguments.pop()
        name = SURPLUS.get(call.name)
        if name is None or name not in known or name in call.keywords:
            reasons.append(f"{text} has no place here")
            continue
        call.keywords[name] = text
        reasons.append(f"{text} goes by name, {name}={text}")
    return reasons


def complete(call: Call, values: Sequence[Any] | None, known: Collection[str] = ()) -> None:
    """Add what a function cannot do without."""
    name = call.name
    image = values[0] if values and not call.is_method else None
    if image is not None and name in _OF_SHAPES and is_image_like(image) and isinstance(image, np.ndarray):
        wrap_grid(call)
    has_grid = "grid(" in (call.function if call.is_method else call.arguments[0] if call.arguments else "")
    has_width = {"fwhm", "rms", "steps", "sigma"} & call.keywords.keys() or (call.is_method and len(call.arguments) > 1)
    if name == "smooth" and not has_width:
        call.keywords["sigma" if has_grid else "steps"] = "2" if has_grid else "3"
    if name == "filter" and "gains" not in call.keywords:
        own = 0 if call.is_method else 1
        for i, text in enumerate(call.arguments[own:], start=own):
            word = literal(text)
            meant = next((ours for ours, names in PRESETS.items() if word in names), None)
            call.arguments[i] = text if meant is None else f'"{meant}"'
        gains = [text for text in call.arguments[own:] if _is_gains(text)]
        if not gains and len(call.arguments) in (own, own + 1):
            call.arguments.append('"smooth"')
    if (
        name in ("walk", "Walk")
        and "normalize" not in call.keywords
        and call.arguments
        and "(" not in call.arguments[0]
    ):
        call.keywords["normalize"] = "'row'"
    if name == "simplify" and not {"error", "vertices", "ratio"} & call.keywords.keys():
        call.keywords["ratio"] = "0.5"


_OF_SHAPES = ("smooth", "decompose", "filter", "denoise", "saliency", "features", "region")


def _is_gains(text: str) -> bool:
    value = literal(text)
    if isinstance(value, str):
        return value in ("smooth", "suppress", "suppress-paper", "enhance", "band1", "band2")
    return "Layer(" in text or isinstance(value, (list, tuple))


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
    if "neighbors" in known:
        call.keywords["neighbors"] = text
        return f"that is neighbors={text}"
    if call.name == "denoise":
        return "denoising chooses neighbors itself"
    if call.name == "impute":
        if len(call.arguments) == 1:
            owner = call.arguments[0]
            points = f'{owner}.obsm["X_pca"]' if "adata" in owner else owner
            call.arguments.append(f"{call.package}point_walk({points}, neighbors={text})")
        return "the walk is the second argument, aw.point_walk(coordinates, neighbors=…)"
    if "operator" in known:
        call.keywords["operator"] = f"{call.package}Operator(neighbors={text})"
        return f"that is operator=aw.Operator(neighbors={text})"
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
    if "signal" not in known:
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
    if call.name not in _OF_SHAPES:
        return None
    wrap_grid(call, spacing=text)
    return "the distance of places belongs to the grid, aw.grid(array, spacing=…)"


def _affine(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    return _spacing(call, f"np.linalg.norm(({text})[:3, :3], axis=0)", value, known)


def _periodic(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "periodic" in known or call.name in _OF_SHAPES:
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
    if call.name not in _OF_SHAPES:
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
    "reduction": _reduction,
    "nothing": lambda call, text, value, known: "it has no counterpart here",
}


def elements(text: str) -> list[str] | None:
    """Texts of the elements of a tuple or a list; None for other texts."""
    try:
        node = ast.parse(text, mode="eval").body
    except SyntaxError:
        return None
    return [ast.unparse(each) for each in node.elts] if isinstance(node, (ast.Tuple, ast.List)) else None


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


def text_of(value: Any) -> str:
    """Text of a value in a message."""
    if is_number(value):
        return f"{value:.6g}"
    text = repr(value) if isinstance(value, (str, bool, tuple, list, type(None))) else "…"
    return text if len(text) <= 60 else "…"
