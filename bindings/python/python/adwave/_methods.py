"""The functions of the package as methods of whatever carries a signal: a shape, a walk, a `Decomposer`."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import adwave

#: Module of each function.
_MODULE_OF = {
    "decompose": "_edits",
    "denoise": "_denoise",
    "features": "_measures",
    "filter": "_edits",
    "filter_labels": "_edits",
    "region": "_info",
    "saliency": "_measures",
    "smooth": "_edits",
}


def _method(name: str) -> Callable[..., Any]:
    def method(self: object, *arguments: Any, **options: Any) -> Any:
        # The modules of these functions are above those of their owners.
        return getattr(import_module(f"adwave.{_MODULE_OF[name]}"), name)(self, *arguments, **options)

    method.__name__ = name
    method.__qualname__ = f"Carrier.{name}"
    method.__doc__ = f"`adwave.{name}` with this object as its first argument; its help has the arguments."
    return method


class _Kind(type):
    """Class whose missing constructors lead to the one that was meant."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(f"type object {cls.__name__!r} has no attribute {name!r}")
            raise AttributeError(import_module("adwave._unknown").unknown_constructor(cls, name))


class Members(metaclass=_Kind):
    """Base of objects whose missing attributes lead to the one that was meant."""

    __slots__ = ()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            message = import_module("adwave._unknown").unknown_member(type(self), name)
            raise AttributeError(message, name=name, obj=self)


class Carrier(Members):
    """Something with bands: `Shape`, `Walk` and `Decomposer` have the same methods, and every function takes them."""

    __slots__ = ()

    if TYPE_CHECKING:
        decompose = adwave.decompose
        denoise = adwave.denoise
        features = adwave.features
        filter = adwave.filter
        filter_labels = adwave.filter_labels
        region = adwave.region
        saliency = adwave.saliency
        smooth = adwave.smooth
    else:
        decompose = _method("decompose")
        denoise = _method("denoise")
        features = _method("features")
        filter = _method("filter")
        filter_labels = _method("filter_labels")
        region = _method("region")
        saliency = _method("saliency")
        smooth = _method("smooth")
