"""Calls that do not fit the parameters of a function: what was meant, and the line that does it.

A `Call` is the text that the user wrote. Each rule here changes it, so that the line in the message has the user's own
names and runs as it is.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Collection, Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave._adapt_objects import library_of
from adwave._caller import Call, name_of, written_call
from adwave._option_rules import (
    FUNCTIONS_OF_SHAPES,
    is_number,
    literal,
    rename_option,
    wrap_grid,
)
from adwave._other_names import FORMER, PRESETS, SHAPE_WORDS


def is_image_like(value: object) -> bool:
    """True if an array has the axes of an image or a volume, and not those of points in space."""
    shape = getattr(value, "shape", ())
    return isinstance(shape, tuple) and (len(shape) == 3 or (len(shape) == 2 and shape[1] > 3 and shape[0] > 1))


def is_edge_index(value: object) -> bool:
    """True for the edges of a graph as 2 × E indices of nodes, as in PyTorch Geometric."""
    if not hasattr(type(value), "__array__") or library_of(value) is not None:
        return False
    sizes = np.shape(value)  # type: ignore[arg-type]
    return len(sizes) == 2 and sizes[0] == 2 and sizes[1] > 3 and np.asarray(value).dtype.kind in "iu"


def is_square(value: object) -> bool:
    """True if an array has the axes of a matrix of a graph."""
    shape = getattr(value, "shape", ())
    return isinstance(shape, tuple) and len(shape) == 2 and shape[0] == shape[1]


def looks_like_faces(points: object, faces: object) -> bool:
    """True if two arrays are the vertices and the triangles or quadrilaterals of a mesh."""
    first, second = np.shape(points), np.shape(faces)  # type: ignore[arg-type]
    if len(first) != 2 or first[1] not in (2, 3) or second == first[:1]:
        return False
    corners = _without_counts(np.asarray(faces)) if len(second) == 1 else np.asarray(faces)
    if corners.ndim != 2 or corners.shape[1] not in (3, 4):
        return False
    # Bytes are colors, and corners of a face differ.
    if corners.dtype.kind not in "iu" or corners.dtype.itemsize == 1 or not corners.size:
        return False
    few = np.sort(corners[:100], axis=1)
    return bool(not (few[:, 1:] == few[:, :-1]).any() and corners.min() >= 0 and corners.max() < first[0])


def _without_counts(faces: NDArray[Any]) -> NDArray[Any]:
    """Corners of faces of one size, each after its number of corners, as VTK lists them; other arrays as they are."""
    width = int(faces[0]) + 1 if faces.size and faces.dtype.kind in "iu" else 0
    if width not in (4, 5) or faces.size % width or (faces[::width] != width - 1).any():
        return faces
    return faces.reshape(-1, width)[:, 1:]


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


def line_of_levels(change: Callable[[Call], None]) -> str:
    """The user's call of whichever function takes levels after a change, as ``"; write …"``; nothing without its text."""
    for function in ("decompose", "smooth", "filter", "saliency", "features", "Decomposer", "Widths"):
        if written_call(function) is not None:
            return working_line(function, change)
    return ""


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
        call = _stand_in(name, owner, values, options, places[0] if places else "shape")
    known = [*places, *names]
    reasons = repair(call, known, places, values, dict(options))
    listed = f"{name} takes {', '.join(known)}"
    wrong = next((option for option in options if option not in known), None)
    if wrong is not None:
        start = f"{name}() has no option {wrong!r}"
    else:
        start = " ".join(why.split()).replace(f"{function.__qualname__}()", f"{name}()")
    return f"{start}; {'; '.join([*reasons, listed])}; write {call}"


def _stand_in(name: str, owner: str, values: Sequence[Any], options: Mapping[str, Any], first: str = "shape") -> Call:
    """A call with the caller's names, or the usual ones, for values whose text is not at hand.

    Parameters
    ----------
    name, owner : str
        The function, and the object of a method.
    values, options : sequence, mapping
        What it was called with.
    first : str
        Name of its first parameter.
    """

    def text(value: Any, place: int) -> str:
        if isinstance(value, (str, bool, int, float, type(None))):
            return repr(value)
        if isinstance(value, (list, tuple)) and len(str(value)) <= 40:
            return repr(value)
        if (known := name_of(value)) is not None:
            return known
        if isinstance(value, tuple) and 0 < len(value) <= 3:
            parts = [name_of(part) for part in value]
            if all(parts):
                return f"({', '.join(str(part) for part in parts)}{',' * (len(parts) == 1)})"
        if not owner and place == 0:
            shape = getattr(value, "shape", ())
            return first if first != "shape" else "V" if len(shape) == 2 and shape[1] in (2, 3) else "shape"
        return "F" if place == 1 and looks_like_faces(values[0], value) else "f"

    shown = {key: text(value, -1) for key, value in options.items()}
    texts = [text(value, i) for i, value in enumerate(values)]
    return Call(f"{owner or 'aw'}.{name}", texts, shown, is_method=bool(owner))


def refuse_unknown(
    function: str,
    options: Mapping[str, Any],
    known: Collection[str],
    wanted: Collection[str],
    values: Sequence[Any] = (),
) -> None:
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
    values : sequence, optional
        What it was called with by position, for the line where the text of the call is not kept.

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
        call = _stand_in(function, "", values, {})
        call.arguments = call.arguments or ["shape"]
        call.keywords = {name: text_of(value) for name, value in options.items()}
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
    name_ball(call)
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
        if name not in call.keywords:  # a rule for another one has taken it
            continue
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


def surplus_of(function: str, text: str) -> str | None:
    """Name of the option that a further argument by position is."""
    value = literal(text)
    if function == "simplify" and is_number(value) and value > 1:
        return "vertices"
    return SURPLUS.get(function)


def name_ball(call: Call) -> None:
    """A center and a radius as the text of a region."""
    if call.name != "region" or call.is_method:
        return
    radius = next((call.keywords.pop(name) for name in ("radius", "r", "size") if name in call.keywords), None)
    names = ("center", "vertex", "seed", "source", "index", "point")
    center = next((call.keywords.pop(name) for name in names if name in call.keywords), None)
    if center is None and len(call.arguments) > 1 and not isinstance(literal(call.arguments[1]), str):
        center = call.arguments.pop(1)
    if radius is None and center is not None and len(call.arguments) > 1:
        radius = call.arguments.pop(1)
    value = literal(center) if center is not None else None
    if isinstance(value, (list, tuple)):
        call.arguments.append(f'"ball:point={" ".join(map(str, value))},radius={radius or "10%"}"')
    elif isinstance(value, int):
        call.arguments.append(f'"ball:vertex={value},radius={radius or "10%"}"')


def move_surplus(call: Call, places: Sequence[str], values: list[Any], known: Collection[str]) -> list[str]:
    """Arguments beyond those that go by position, by name."""
    if call.name == "Decomposer" and len(call.arguments) == 2:
        text = call.arguments.pop()
        call.keywords.setdefault("operator", text)
        return []
    reasons = []
    while len(call.arguments) > len(places):
        text = call.arguments.pop()
        name = surplus_of(call.name, text)
        if name is None or name not in known or name in call.keywords:
            reasons.append(f"{text} has no place here")
            continue
        call.keywords[name] = text
        reasons.append(f"{text} goes by name, {name}={text}")
    return reasons


#: Functions whose second argument is a signal.
_SIGNAL_SECOND = ("smooth", "decompose", "saliency", "features", "denoise", "filter")


def complete(call: Call, values: Sequence[Any] | None, known: Collection[str] = ()) -> None:
    """Add what a function cannot do without."""
    name = call.name
    image = values[0] if values and not call.is_method else None
    if image is not None and name in FUNCTIONS_OF_SHAPES and is_image_like(image) and isinstance(image, np.ndarray):
        wrap_grid(call)
    has_grid = "grid(" in (call.function if call.is_method else call.arguments[0] if call.arguments else "")
    # A number in the place of the signal is the option that else goes by name.
    own = 0 if call.is_method else 1
    if name in _SIGNAL_SECOND and len(call.arguments) > own and is_number(literal(call.arguments[own])):
        text = call.arguments.pop(own)
        option = SURPLUS.get(name)
        if option is not None:
            call.keywords.setdefault("sigma" if has_grid and option == "steps" else option, text)
    has_width = {"fwhm", "rms", "steps", "sigma"} & call.keywords.keys() or len(call.arguments) > own + 1
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
    if name == "scattering" and values and call.arguments:
        if is_edge_index(values[0]):
            call.arguments[0] = f"{call.package}from_edge_index({call.arguments[0]})"
        elif len(call.arguments) == 1 and library_of(values[0]) == "torch_geometric":
            call.arguments.append(f"{call.arguments[0]}.x")
    if name == "graph" and len(call.arguments) == 1 and not call.keywords:
        call.function = f"{call.package}as_shape"
    if name == "simplify" and not {"error", "vertices", "ratio"} & call.keywords.keys():
        call.keywords["ratio"] = "0.5"


def _is_gains(text: str) -> bool:
    value = literal(text)
    if isinstance(value, str):
        return value in ("smooth", "suppress", "suppress-paper", "enhance", "band1", "band2")
    return "Layer(" in text or isinstance(value, (list, tuple))


def elements(text: str) -> list[str] | None:
    """Texts of the elements of a tuple or a list; None for other texts."""
    node = _expression(text)
    return [ast.unparse(each) for each in node.elts] if isinstance(node, (ast.Tuple, ast.List)) else None


def values_of(text: str) -> list[str] | None:
    """Texts of the values of a dictionary that is written out; None for other texts."""
    node = _expression(text)
    return [ast.unparse(each) for each in node.values] if isinstance(node, ast.Dict) else None


def is_simple(text: str) -> bool:
    """True for a text that an index may follow as it is."""
    return isinstance(_expression(text), (ast.Name, ast.Attribute, ast.Subscript, ast.Call))


def _expression(text: str) -> ast.expr | None:
    try:
        return ast.parse(text, mode="eval").body
    except SyntaxError:
        return None


def text_of(value: Any) -> str:
    """Text of a value in a message."""
    if is_number(value):
        return f"{value:.6g}"
    text = repr(value) if isinstance(value, (str, bool, tuple, list, type(None))) else "…"
    return text if len(text) <= 60 else "…"
