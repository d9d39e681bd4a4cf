"""`rasterize`: heights or other values of points as a grid in the plane, and values of the grid back at points."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave._grid import Grid
from adwave._grid import grid as make_grid
from adwave._shape import Shape

#: Value of a cell from those of the points in it.
Statistic = Literal["mean", "min", "max", "count"]

_STATISTICS = ("mean", "min", "max", "count")
#: Most cells: more are a wrong unit of the cell, not a raster.
_MOST_CELLS = 2**31


class Raster:
    """Values of points in square cells of the plane, as `adwave.rasterize` makes it.

    Rows run from the least y upward and columns from the least x: ``values[i, j]`` is the cell with its center at
    ``origin + cell · (j, i)``.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> x, y = np.random.default_rng(0).uniform(0, 30, size=(2, 9000))
    >>> ground = aw.rasterize(np.column_stack([x, y, 0.5 * x - y]), cell=1.0)
    >>> wide = ground.grid.smooth(fwhm=6)
    >>> bool(np.isfinite(ground.interpolate(np.column_stack([x, y]), wide)).all())
    True
    """

    __slots__ = ("cell", "origin", "values")

    #: Value of each cell, rows × columns; NaN without points, except for counts.
    values: NDArray[np.float64]
    #: Center (x, y) of the first cell, in model units.
    origin: NDArray[np.float64]
    #: Side of a cell, in model units.
    cell: float

    def __init__(self, values: NDArray[np.float64], origin: NDArray[np.float64], cell: float) -> None:
        self.values, self.origin, self.cell = values, origin, cell

    @property
    def grid(self) -> Grid[NDArray[np.float64]]:
        """The cells as a grid, in which those without points take no part."""
        return make_grid(self.values, spacing=self.cell)

    def interpolate(self, points: ArrayLike | Shape, values: ArrayLike | None = None) -> NDArray[np.float64]:
        """Interpolate values of the cells at points, linearly between the centers of the four cells around each.

        Parameters
        ----------
        points : array_like of n × 2 or more, or Shape
            Positions; x and y are used.
        values : array_like, optional
            A number for each cell, such as a smoothed grid or a band; those of the raster by default.

        Returns
        -------
        numpy.ndarray
            n numbers. Cells that are NaN have no weight; NaN where all four are, and beyond the raster.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> plane = aw.rasterize([[0, 0, 0], [1, 0, 2], [0, 1, 4], [1, 1, 6]], cell=1)
        >>> plane.interpolate([[0.5, 0.25]])
        array([2.])
        """
        given = self.values if values is None else np.asarray(values, dtype=np.float64)
        if given.shape != self.values.shape:
            raise ValueError(
                f"values: shape {given.shape} is not that of the raster, {self.values.shape}; give a number for each cell, "
                "as in raster.interpolate(points, raster.grid.smooth(fwhm=5))"
            )
        # The outer half of a cell at the border lies beyond all centers, and has the value of the nearest.
        position = (_planar(points, "points") - self.origin) / self.cell
        half = 0.5 * np.array(given.shape[::-1])
        inside: NDArray[np.bool_] = np.all(np.abs(position - (half - 0.5)) <= half, axis=1)
        low = np.floor(np.where(inside[:, None], position, 0.0)).astype(np.int64)
        part = np.where(inside[:, None], position, 0.0) - low
        total, weights = np.zeros(len(low)), np.zeros(len(low))
        for dx in (0, 1):
            for dy in (0, 1):
                column = np.clip(low[:, 0] + dx, 0, given.shape[1] - 1)
                row = np.clip(low[:, 1] + dy, 0, given.shape[0] - 1)
                share = np.abs(1 - dx - part[:, 0]) * np.abs(1 - dy - part[:, 1])
                corner = given[row, column]
                share = np.where(np.isfinite(corner), share, 0.0)
                total += share * np.where(share > 0, corner, 0.0)
                weights += share
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(inside & (weights > 0), total / weights, np.nan)

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        return f"<adwave.Raster: {rows} × {columns} cells of {self.cell:g}>"


def rasterize(
    points: ArrayLike | Shape, cell: float, values: ArrayLike | None = None, *, statistic: Statistic = "mean"
) -> Raster:
    """Put points into square cells of the plane: heights of a scan as a terrain.

    Parameters
    ----------
    points : array_like of n × 3, or Shape
        Positions in model units, as of `adwave.read`.
    cell : float
        Side of a cell in model units. About the distance of the points leaves few cells empty.
    values : array_like, optional
        A number for each point; z by default. Points at which it is NaN take no part.
    statistic : {'mean', 'min', 'max', 'count'}
        Value of a cell: ``'min'`` for ground below plants, ``'max'`` for roofs and tree tops, ``'count'`` for the density.

    Returns
    -------
    Raster
        Values of the cells; ``raster.grid`` has bands, and ``raster.interpolate(points, values)`` puts values back.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.rasterize([[0, 0, 3], [0.2, 0, 5], [2, 1, 7]], cell=1).values
    array([[ 4., nan, nan],
           [nan, nan,  7.]])
    """
    planar = _planar(points, "points")
    if statistic not in _STATISTICS:
        raise ValueError(f"statistic must be one of {', '.join(map(repr, _STATISTICS))}, got {statistic!r}")
    length: Any = cell
    is_number = isinstance(length, (int, float, np.integer, np.floating)) and not isinstance(length, bool)
    if not (is_number and np.isfinite(length) and length > 0):
        raise ValueError(f"cell must be a length above 0 in model units, as in rasterize(points, 1.0), got {cell!r}")
    if values is None:
        position = _positions(points, "points")
        if position.shape[1] < 3:
            raise ValueError("points: have no third coordinate; give values, one number for each point")
        given = position[:, 2]
    else:
        given = np.asarray(values, dtype=np.float64)
        if given.shape != (len(planar),):
            raise ValueError(f"values: shape {given.shape}, and {(len(planar),)} is needed, one number for each point")
    known = np.isfinite(given) & np.isfinite(planar).all(axis=1)
    if not known.any():
        raise ValueError("points: none has a position and a value; a raster needs at least one")
    planar, given = planar[known], given[known]
    origin = planar.min(axis=0)
    columns, rows = (int(n) for n in np.floor((planar.max(axis=0) - origin) / cell + 0.5) + 1)
    if rows * columns > _MOST_CELLS:
        raise ValueError(
            f"cell: {cell:g} makes {rows:,} × {columns:,} cells of points that extend over "
            f"{np.ptp(planar, axis=0).max():g}; take a larger one, about as long as points are apart"
        )
    at = np.floor((planar - origin) / cell + 0.5).astype(np.int64)
    place = at[:, 1] * columns + at[:, 0]
    count = np.bincount(place, minlength=rows * columns)
    if statistic == "count":
        found: NDArray[Any] = count.astype(np.float64)
    elif statistic == "mean":
        # About the first value, so that heights far above 0 lose no digits.
        sums = np.bincount(place, weights=given - given[0], minlength=rows * columns)
        with np.errstate(invalid="ignore"):
            found = given[0] + sums / count
    else:
        found = np.full(rows * columns, np.nan)
        (np.fmin if statistic == "min" else np.fmax).at(found, place, given)
    return Raster(found.reshape(rows, columns), origin, float(cell))


def _positions(points: Any, name: str) -> NDArray[np.float64]:
    found = points.points if isinstance(points, Shape) else np.asarray(points, dtype=np.float64)
    if found.ndim != 2 or found.shape[1] < 2 or not len(found):
        raise ValueError(f"{name}: need one row for each point with x and y, got shape {found.shape}")
    return np.asarray(found, dtype=np.float64)


def _planar(points: Any, name: str) -> NDArray[np.float64]:
    return _positions(points, name)[:, :2]
