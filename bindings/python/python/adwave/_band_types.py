"""Types of `Bands` for type checkers; nothing of this is loaded when a program runs."""

from __future__ import annotations

from typing import Any, Generic, Union, overload

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeVar

#: Number type of bands: that of their signal if it has floats. Without one, as in ``def f(bands: aw.Bands)``, float64.
Number = TypeVar("Number", bound=np.floating[Any], default=np.float64)


class Arithmetic(Generic[Number]):
    """An operator between bands and numbers, with the number type that numpy gives the result."""

    @overload
    def __call__(self, other: Union[Operators[Number], NDArray[Number], NDArray[np.bool_]], /) -> NDArray[Number]: ...
    @overload
    def __call__(self, other: np.generic, /) -> NDArray[Any]: ...
    @overload
    def __call__(self, other: float, /) -> NDArray[Number]: ...
    @overload
    def __call__(self, other: object, /) -> NDArray[Any]: ...
    def __call__(self, other: object, /) -> NDArray[Any]:
        raise NotImplementedError


class Operators(Generic[Number]):
    """The operators of numpy's mixin for arrays, with their types."""

    __add__: Arithmetic[Number]
    __radd__: Arithmetic[Number]
    __sub__: Arithmetic[Number]
    __rsub__: Arithmetic[Number]
    __mul__: Arithmetic[Number]
    __rmul__: Arithmetic[Number]
    __truediv__: Arithmetic[Number]
    __rtruediv__: Arithmetic[Number]
    __floordiv__: Arithmetic[Number]
    __mod__: Arithmetic[Number]
    __pow__: Arithmetic[Number]
    __rpow__: Arithmetic[Number]

    def __neg__(self) -> NDArray[Number]: ...
    def __pos__(self) -> NDArray[Number]: ...
    def __abs__(self) -> NDArray[Number]: ...
    def __gt__(self, other: object) -> NDArray[np.bool_]: ...
    def __ge__(self, other: object) -> NDArray[np.bool_]: ...
    def __lt__(self, other: object) -> NDArray[np.bool_]: ...
    def __le__(self, other: object) -> NDArray[np.bool_]: ...
