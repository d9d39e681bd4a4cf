"""The call that a user wrote, as text, so that a message can show the line that works; and warnings at that line."""

from __future__ import annotations

import ast
import linecache
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, TypeVar

_FOLDER = str(Path(__file__).parent)
_Function = TypeVar("_Function", bound=Callable[..., Any])


@dataclass
class Call:
    """A call as text.

    Attributes
    ----------
    function
        What is called, such as ``aw.smooth``.
    arguments
        Arguments by position.
    keywords
        Arguments by name.
    is_made
        False for an attribute that is not called.
    is_method
        True if the function belongs to an object, not to the package.
    """

    function: str
    arguments: list[str]
    keywords: dict[str, str]
    is_made: bool = True
    is_method: bool = False

    @property
    def name(self) -> str:
        """Last name of the function."""
        return self.function.rpartition(".")[2]

    @property
    def prefix(self) -> str:
        """Text before the last name, with its dot."""
        return self.function[: len(self.function) - len(self.name)]

    @property
    def package(self) -> str:
        """Name of this package in the caller's text, with a dot."""
        return self.prefix if self.prefix and not self.is_method else "aw."

    def __str__(self) -> str:
        if not self.is_made:
            return self.function
        parts = [*self.arguments, *(f"{name}={text}" for name, text in self.keywords.items())]
        return f"{self.function}({', '.join(parts)})"


def user_frame() -> FrameType | None:
    """The frame that called this package."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and _is_own(frame):
        frame = frame.f_back
    return frame


def _is_own(frame: FrameType) -> bool:
    """True for code of this package, also for the constructors that `dataclass` writes, which have no file."""
    path = frame.f_code.co_filename
    return path.startswith(_FOLDER) or (
        path == "<string>" and str(frame.f_globals.get("__name__")).startswith("adwave.")
    )


def name_of(value: object) -> str | None:
    """Name of an object in the caller's text, where the text itself is not kept, as in shells before Python 3.13."""
    frame = user_frame()
    if frame is None:
        return None
    for names in (frame.f_locals, frame.f_globals):
        found = next((name for name, each in names.items() if each is value and not name.startswith("_")), None)
        if found is not None:
            return found
    return None


def warn(message: str, category: type[Warning] = UserWarning) -> None:
    """Warn at the line that called this package."""
    level, frame = 1, sys._getframe(0)
    while frame.f_back is not None and _is_own(frame):
        frame = frame.f_back
        level += 1
    warnings.warn(message, category, stacklevel=level)


def written_call(name: str) -> Call | None:
    """The call of a function, method, class or attribute `name` that is being made, if its text is at hand.

    Notes
    -----
    Notebooks, scripts and the shells of Python from 3.13 keep the text. From Python 3.11 each instruction knows its place;
    before, the line must have one call of that name.
    """
    frame = user_frame()
    if frame is None:
        return None
    lines = linecache.getlines(frame.f_code.co_filename, frame.f_globals)
    source = "".join(lines)
    try:
        tree = ast.parse(source)
        nodes = list(_calls(tree, name))
    except (SyntaxError, ValueError, RecursionError):
        return None
    place = _place(frame)
    found = next((node for node in nodes if place in (_span(node), _span(node.func))), None)
    if found is None and place is None:  # before Python 3.11
        line = frame.f_lineno
        nodes = [node for node in nodes if node.lineno <= line <= (node.end_lineno or line)]
        found = nodes[0] if len(nodes) == 1 else None
    if found is not None:
        call = _as_text(found, source)
        if call is not None:
            owner = call.prefix[:-1]
            known = frame.f_locals.get(owner, frame.f_globals.get(owner))
            call.is_method = bool(owner) and not isinstance(known, ModuleType)
        return call
    for node in ast.walk(tree) if place is not None else ():
        if isinstance(node, ast.Attribute) and node.attr == name and _span(node) == place:
            text = ast.get_source_segment(source, node) or ast.unparse(node)
            return Call(text, [], {}, is_made=False, is_method=True)
    return None


def _calls(tree: ast.AST, name: str) -> Iterator[ast.Call]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _last_name(node.func) == name:
            yield node


def _last_name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _place(frame: FrameType) -> tuple[int | None, ...] | None:
    positions = getattr(frame.f_code, "co_positions", None)
    if positions is None:
        return None
    for i, place in enumerate(positions()):
        if 2 * i == frame.f_lasti:
            return place
    return None


def _span(node: ast.expr) -> tuple[int | None, ...]:
    return node.lineno, node.end_lineno, node.col_offset, node.end_col_offset


def _as_text(node: ast.Call, source: str) -> Call | None:
    def text(part: ast.expr) -> str:
        found = ast.get_source_segment(source, part) or ast.unparse(part)
        return found if "\n" not in found else ast.unparse(part)

    if any(isinstance(each, ast.Starred) for each in node.args) or any(each.arg is None for each in node.keywords):
        return None
    keywords = {each.arg or "": text(each.value) for each in node.keywords}
    return Call(text(node.func), [text(each) for each in node.args], keywords)


#: Change of the arguments of a call before it is made.
Order = Callable[[tuple[Any, ...], dict[str, Any]], "tuple[tuple[Any, ...], dict[str, Any]]"]


def public(order: Order | None = None, **renamed: str) -> Callable[[_Function], _Function]:
    """Decorator of public functions and constructors: arguments that do not fit lead to the line that works.

    Parameters
    ----------
    order : callable, optional
        Change of the arguments before the call.
    **renamed
        New names of keywords by their old names, which are taken with a `DeprecationWarning`.
    """

    def decorate(function: _Function) -> _Function:
        @wraps(function)
        def call(*arguments: Any, **options: Any) -> Any:
            for old in renamed.keys() & options.keys():
                warn(f"{old}= is now {renamed[old]}=, and will go in the next release", DeprecationWarning)
                options[renamed[old]] = options.pop(old)
            if order is not None:
                arguments, options = order(arguments, options)
            try:
                return function(*arguments, **options)
            except TypeError as error:
                # Only Python itself raises before the first line of the function.
                trace = error.__traceback__
                if trace is None or trace.tb_next is not None:
                    raise
                misfit = import_module("adwave._misfit").misfit
                raise TypeError(misfit(function, arguments, options, str(error))) from None

        return call  # type: ignore[return-value]

    return decorate
