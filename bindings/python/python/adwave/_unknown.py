"""Functions and attributes that do not exist: what was meant, and the line that does it."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

from adwave._caller import Call, written_call
from adwave._misfit import complete, known_options, move_surplus, name_ball
from adwave._option_rules import literal, rename_option, wrap_grid
from adwave._other_names import AS_FUNCTION, BASELINE_OPTIONS, BASELINES, FUNCTION_OF, MEMBER_OF, SIGNALS


def unknown_attribute(name: str) -> str:
    """Message for a name that the package does not have, with the line that does what was meant."""
    start = f"module 'adwave' has no attribute {name!r}"
    if name.startswith("_") or not name.isidentifier():
        return start
    if name == "version":
        return f"{start}; write aw.__version__"
    import adwave

    ours = FUNCTION_OF.get(name.lower())
    if ours is None:
        close = get_close_matches(name, adwave.__all__, n=1, cutoff=0.6) or get_close_matches(
            name.lower(), FUNCTION_OF, n=1, cutoff=0.75
        )
        ours = FUNCTION_OF.get(close[0], close[0]) if close else None
    call = written_call(name)
    if name in ("laplacian", "stiffness", "cotmatrix", "adjacency"):
        given = call.arguments[:2] if call is not None and call.arguments else ["shape"]
        shown = given[0] if len(given) == 1 else f"({', '.join(given)})"
        return f"{start}; the diffusion Φ₁ = I − L is a sparse matrix; write aw.Decomposer({shown}).matrix()"
    if name in ("write", "save", "export", "write_mesh", "save_mesh") and call is not None and len(call.arguments) > 1:
        path, shape = sorted(call.arguments[:2], key=lambda text: not _literal_is_text(text))
        return f"{start}; a shape writes itself; write {call.package}as_shape({shape}).write({path})"
    if (
        name in ("reconstruct", "inverse", "synthesize", "idwt", "iswt", "waverec", "waverec2")
        and call is not None
        and call.arguments
    ):
        return f"{start}; bands sum to their signal; write {call.arguments[0]}.reconstruct()"
    if "time" in name.lower() or "temporal" in name.lower():
        given = call.arguments[0] if call is not None and call.arguments else "series"
        is_smooth = any(each in name.lower() for each in ("smooth", "filter", "denoise"))
        method = "smooth" if is_smooth else "decompose"
        return f"{start}; Time has the bands along an axis of frames; write aw.Time(dt=1, fwhm=4).{method}({given})"
    if ours is None:
        return f"{start}; help(aw) lists the functions"
    if call is None:
        return f"{start}; write aw.{ours}(…)" if not name[0].isupper() else f"{start}; write aw.{ours}"
    return f"{start}; write {_renamed(call, name, ours)}"


def unknown_constructor(kind: type, name: str) -> str:
    """Message for a constructor that a class does not have, such as ``Walk.from_networkx``."""
    start = f"type object {kind.__name__!r} has no attribute {name!r}"
    call = written_call(name) if name.startswith(("from_", "load", "read")) else None
    if call is None:
        return start
    call.function, package = call.prefix[:-1], "aw."
    call.is_method = False
    if kind.__name__ == "Walk" and "points" not in name and "neighbor" not in name:
        call.keywords = {"normalize": "'row'"}
    elif kind.__name__ == "Walk":
        call.function = f"{package}point_walk"
        _fit(call, "point_walk", [])
    return f"{start}; write {call}"


def unknown_member(kind: type, name: str) -> str:
    """Message for an attribute that an object does not have, with the line that does what was meant."""
    start = f"{kind.__name__!r} object has no attribute {name!r}"
    if name.startswith("_"):
        return start
    known = [each for each in dir(kind) if not each.startswith("_")]
    ours = MEMBER_OF.get(name, "")
    if ours.startswith("matrix") and "matrix" not in known and (call := written_call(name)) is not None:
        return f"{start}; the diffusion Φ₁ = I − L is a sparse matrix; write aw.Decomposer({call.prefix[:-1]}).matrix()"
    if ours.startswith("["):
        known = [*known, *([ours] if kind.__name__ == "Bands" else [])]
    if ours.partition("(")[0] not in known:
        close = get_close_matches(name, known, n=1, cutoff=0.7)
        ours = close[0] if close else ""
    function = AS_FUNCTION.get(name, "")
    if not ours and not function:
        return start
    call = written_call(name)
    if call is None:
        return f"{start}; did you mean {ours or f'aw.{function}'}?"
    owner = call.prefix[:-1]
    if function and not (ours and ours not in MEMBER_OF.values()):
        package = owner.partition(".")[0] if owner.startswith(("aw.", "adwave.")) else "aw"
        call.function, call.is_method = f"{package}.{function}", False
        call.arguments.insert(0, owner)
        if not call.is_made:
            call.is_made = True
        _fit(call, function, [owner])
        return f"{start}; write {call}"
    if name in ("toarray", "todense"):
        return f"{start}; write {owner}.matrix().{name}()"
    if ours.endswith(")") or not callable(getattr(kind, ours.partition("(")[0], None)):
        call.is_made, call.function = False, f"{owner}{ours}" if ours.startswith("[") else f"{owner}.{ours}"
    else:
        call.function, call.is_made = f"{owner}.{ours}", True
        if ours == "matrix":
            call.arguments, call.keywords = [], {}
    return f"{start}; write {call}"


def _fit(call: Call, function: str, values: Sequence[Any]) -> None:
    """Change the keywords of a call so that a function of the package takes them."""
    import adwave

    target = getattr(adwave, function)
    places, names = known_options(target.__init__ if isinstance(target, type) else target)
    places = [each for each in places if each != "self"]
    known = [*places, *names, *(("sigma",) if call.is_method else ())]
    for option in [option for option in call.keywords if option not in known]:
        text = call.keywords[option]
        rename_option(call, option, text, literal(text), known)
    if places and not call.is_method:
        move_surplus(call, places, list(values), known)
    complete(call, None, known)


def _renamed(call: Call, name: str, ours: str) -> Call:
    """The call of a function of another library as that of one here."""
    package = call.package
    call.function = f"{package}{ours}"
    lower = name.lower()
    if ours == "signal":
        call.arguments = [*call.arguments[:1], repr(SIGNALS.get(lower, "normals"))]
        call.keywords = {}
        return call
    if ours == "baselines":
        call.function = f"{package}baselines.{BASELINES.get(lower, lower)}"
        meant = {theirs: own for own, names in BASELINE_OPTIONS.items() for theirs in (own, *names)}
        kept = {meant[name]: text for name, text in call.keywords.items() if name in meant} if "taubin" in lower else {}
        if call.function.endswith("harmonics"):
            given = [text for text in (*call.arguments[1:], *call.keywords.values()) if text.isdigit()]
            kept = {"k": (given or ["10"])[0]}
        call.arguments, call.keywords = call.arguments[:1], kept
        return call
    if "outlier" in lower:
        call.arguments, call.keywords = call.arguments[:1], {"outliers": '"pull"'}
        return call
    if lower in ("sharpen", "enhance", "unsharp_mask"):
        call.arguments.append('"enhance"')
    if "gaussian" in lower or "img" in lower or "image" in lower or lower.startswith("wavedec"):
        if lower.startswith("wavedec"):
            call.arguments = call.arguments[:1]
        if len(call.arguments) > 1:
            # `smooth_img` of nilearn takes a full width, the others a standard deviation.
            call.keywords.setdefault("fwhm" if "img" in lower else "sigma", call.arguments.pop(1))
        wrap_grid(call)
        call.function, call.is_method = f"{call.arguments.pop(0)}.{ours}", True
    if ours == "region":
        name_ball(call)
    if ours == "simplify":
        _fewer_by_number(call, lower)
    if ours == "sample" and not call.arguments:
        call.arguments = [repr("creature" if lower in FUNCTION_OF else lower)]
    if lower == "deform":
        call.arguments, call.keywords = call.arguments[:1], {}
        call.function, call.is_method = f"{package}Decomposer({call.arguments.pop(0)}).deformer", True
        call.arguments = ["[0]", "[[1]]"]
        return call
    _fit(call, ours, [])
    return call


def _fewer_by_number(call: Call, theirs: str) -> None:
    """The second argument of a function that simplifies: a number of faces, a number of vertices, or a share that goes."""
    value = literal(call.arguments[1]) if len(call.arguments) > 1 else None
    if not isinstance(value, (int, float)):
        return
    text = call.arguments.pop(1)
    if value > 1:
        # A closed mesh has half as many vertices as faces.
        call.keywords["vertices"] = str(int(value) // 2 + 2) if "quadric" in theirs else text
    else:
        call.keywords["ratio"] = f"{1 - value:.6g}"


def _literal_is_text(text: str) -> bool:
    return isinstance(literal(text), str)
