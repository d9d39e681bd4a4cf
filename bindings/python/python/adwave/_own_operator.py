"""Operators of one's own: one step of a diffusion as a function, without stored rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave._layout import values_array

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

    from adwave._native import Prepared

_Floats = NDArray[np.float64]
#: I − Φ₁ as an operator with ``@``, or as a function of an (n, channels) array.
LaplacianLike = Union["LinearOperator", Callable[[_Floats], ArrayLike]]


@dataclass(frozen=True)
class OwnOperator:
    """Operator as the extension takes it; `adwave.Decomposer.with_operator` has the meaning of its fields."""

    difference: Callable[[_Floats], _Floats]
    masked: Callable[[NDArray[np.bool_]], Callable[[_Floats], _Floats]] | None
    reversible: bool
    step_length: float
    weights: _Floats | None


@dataclass(frozen=True)
class GivenOperator:
    """An operator as the caller gave it."""

    laplacian: LaplacianLike
    reversible: bool
    step_length: float
    weights: ArrayLike | None
    masked: Callable[[NDArray[np.bool_]], LaplacianLike] | None

    def replace_operator(self, data: Prepared) -> Prepared:
        """The prepared shape with this operator.

        Raises
        ------
        TypeError
            If the Laplacian is neither a function nor an operator.
        ValueError
            If a value is out of its range.
        """
        n = data.n_vertices
        if not 0 < self.step_length < math.inf:
            raise ValueError(f"step_length must be a positive length, got {self.step_length}")
        weights = None if self.weights is None else np.ascontiguousarray(values_array(self.weights, n, "weights")[:, 0])
        masked = self.masked
        without = None if masked is None else (lambda flags: _difference(masked(flags), n, "masked"))
        difference = _difference(self.laplacian, n, "laplacian")
        own = OwnOperator(difference, without, bool(self.reversible), float(self.step_length), weights)
        return data.with_operator(own)


def _difference(laplacian: Any, n: int, name: str) -> Callable[[_Floats], _Floats]:
    """The Laplacian as a function of (n, channels) numbers, whose results are checked."""
    if hasattr(laplacian, "shape"):
        if tuple(laplacian.shape) != (n, n):
            raise ValueError(
                f"{name} must be {n} × {n}, with a row for each vertex, got shape {tuple(laplacian.shape)}"
            )
        product = laplacian.__matmul__
    elif callable(laplacian):
        product = laplacian
    else:
        raise TypeError(
            f"{name} must be a function of an (n, channels) array, or an operator with @ such as "
            f"scipy.sparse.linalg.LinearOperator, got {type(laplacian).__name__}"
        )

    def difference(x: _Floats) -> _Floats:
        found = np.ascontiguousarray(product(x), dtype=np.float64)
        if found.shape != x.shape:
            raise ValueError(f"{name}: a result must have the shape of its argument, {x.shape}, got {found.shape}")
        if not np.isfinite(found).all():
            raise ValueError(f"{name}: a result must be finite")
        return found

    return difference
