"""Parcels of a surface as signals: values of each, and back at its vertices."""

from __future__ import annotations

from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave._layout import signal_values


class Parcels:
    """Parcels of a surface, such as those of an atlas.

    Parameters
    ----------
    labels : (n,) array_like of int
        Label of each vertex.
    areas : (n,) array_like, optional
        Areas at the vertices, by which means are weighted; ``aw.Decomposer(surface, operator="surface").areas`` has them.
        Equal by default.
    background : sequence of int
        Labels that are no parcel, such as the medial wall.

    Attributes
    ----------
    labels : (m,) array of int
        Label of each parcel, ascending.
    areas : (m,) array
        Area of each parcel.

    Raises
    ------
    ValueError
        If labels are no whole numbers, all are background, or there is not one positive area per vertex.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> parcels = aw.Parcels([7, 7, 0, 3, 3], areas=[1.0, 3.0, 1.0, 1.0, 1.0])
    >>> parcels.labels, parcels.means([1.0, 2.0, 9.0, 4.0, np.nan])
    (array([3, 7]), array([4.  , 1.75]))
    >>> parcels.fill([0.5, -1.0])
    array([-1. , -1. ,  nan,  0.5,  0.5])
    """

    labels: NDArray[Any]
    areas: NDArray[np.float64]

    def __init__(
        self, labels: ArrayLike, *, areas: Union[ArrayLike, None] = None, background: tuple[int, ...] = (0, -1)
    ) -> None:
        array = np.asarray(labels)
        if array.ndim != 1 or array.dtype.kind not in "iu":
            raise ValueError(
                f"labels must be one whole number for each vertex, got {array.dtype} of shape {array.shape}"
            )
        weights = np.ones(len(array)) if areas is None else np.asarray(areas, dtype=np.float64)
        if weights.shape != array.shape or not (np.isfinite(weights) & (weights > 0)).all():
            raise ValueError(f"areas must be one positive number for each of the {len(array)} vertices")
        inside = ~np.isin(array, background)
        if not inside.any():
            raise ValueError(f"all labels are background {tuple(background)}; name others as background=")
        self.labels, numbers = np.unique(array[inside], return_inverse=True)
        self._parcel = np.full(len(array), -1)
        self._parcel[inside] = numbers
        self._weights = weights
        self.areas = np.asarray(np.bincount(numbers, weights[inside]), dtype=np.float64)

    def __repr__(self) -> str:
        return f"<adwave.Parcels: {len(self.labels)} on {len(self._parcel)} vertices>"

    def __len__(self) -> int:
        return len(self.labels)

    def means(self, values: ArrayLike) -> NDArray[np.float64]:
        """Means of the parcels by area, without NaN: (m,) or (m, channels), or (times, m) of (times, n).

        Parameters
        ----------
        values : (n,), (n, channels) or (times, n) array_like
            Values at the vertices.

        Raises
        ------
        ValueError
            If the number of vertices is another, or a value is infinite.
        """
        rows, layout = signal_values(values, len(self._parcel), "values")
        inside = self._parcel >= 0
        rows, parcels, weights = rows[inside], self._parcel[inside], self._weights[inside]
        means = np.empty((len(self.labels), rows.shape[1]))
        for c, column in enumerate(rows.T):
            known = ~np.isnan(column)
            amounts = np.bincount(parcels[known], weights[known] * column[known], len(self.labels))
            totals = np.bincount(parcels[known], weights[known], len(self.labels))
            means[:, c] = np.divide(amounts, totals, out=np.full(len(totals), np.nan), where=totals > 0)
        return layout.with_vertices(len(self.labels)).arrange(means)

    def fill(self, values: ArrayLike) -> NDArray[np.float64]:
        """Values of the parcels at their vertices, NaN in the background: the reverse of `means`.

        Parameters
        ----------
        values : (m,), (m, channels) or (times, m) array_like
            Values of the parcels, in the order of `labels`.

        Raises
        ------
        ValueError
            If the number of parcels is another.
        """
        rows, layout = signal_values(values, len(self.labels), "values")
        filled = np.where((self._parcel >= 0)[:, None], rows[self._parcel], np.nan)
        return layout.with_vertices(len(self._parcel)).arrange(filled)
