"""Options of images and volumes, checked: spacings, borders, masks, widths, and the number type of results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave._grid_layout import GridLayout, plain_array
from adwave._grid_objects import FoundGrid, check_same_places, find_grid
from adwave._misfit import refuse_unknown
from adwave._options import LevelsLike, Widths, levels_of


def check_spacings(spacing: Any, layout: GridLayout) -> tuple[float, ...]:
    """Distances along the axes of a grid, as one number for each."""
    n = len(layout.sizes)
    example = f"aw.grid(array, spacing={tuple([1.0] * n) if n > 1 else 1.0})"
    try:
        given = np.asarray(spacing, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"spacing must be a number or one for each axis, as in {example}, got {spacing!r}") from error
    if given.dtype.kind != "f" or isinstance(spacing, (str, bool)) or given.ndim > 1:
        raise TypeError(f"spacing must be a number or one for each axis, as in {example}, got {spacing!r}")
    if given.ndim == 1 and len(given) != n:
        raise ValueError(
            f"spacing: got {len(given)} numbers, and the grid of shape {layout.sizes} has {n} axes; give one number, or one "
            f"for each, as in {example}"
        )
    each = tuple(float(h) for h in np.broadcast_to(given, (n,)))
    for axis, h in enumerate(each):
        if not (np.isfinite(h) and h > 0):
            raise ValueError(
                f"spacing must be a finite number above 0 along each axis, as in {example}, got {h:g} along axis {axis}"
            )
    return each


def check_flags(periodic: Any, layout: GridLayout) -> tuple[bool, ...]:
    """One flag for each axis of a grid."""
    n = len(layout.sizes)
    example = f"aw.grid(array, periodic={tuple([False] * (n - 1) + [True]) if n > 1 else True})"
    given = np.asarray(periodic)
    if given.dtype.kind != "b" or given.ndim > 1:
        raise TypeError(
            f"periodic must be True or False, or one of them for each axis, as in {example}, got {periodic!r}"
        )
    if given.ndim == 1 and len(given) != n:
        raise ValueError(
            f"periodic: got {len(given)} flags, and the grid of shape {layout.sizes} has {n} axes; give one for each, as in "
            f"{example}"
        )
    return tuple(bool(each) for each in np.broadcast_to(given, (n,)))


def find_kept_places(mask: Any, array: FoundGrid, layout: GridLayout) -> NDArray[np.bool_] | None:
    """Flags of the places with data, in the order of the values."""
    found = find_grid(mask, tuple(range(np.ndim(mask))) if hasattr(mask, "dims") else None)
    check_same_places(array, found)
    given = plain_array(found.values, "mask")
    if array.library == "pyvista" and given.shape == (layout.n_vertices,):
        given = given.reshape(layout.sizes)
    if given.shape != layout.sizes:
        hint = ", or aw.grid(array, mask=mask.T)" if given.shape == layout.sizes[::-1] else ""
        raise ValueError(
            f"mask: shape {given.shape} is not that of the grid, {layout.sizes}; give one flag for each place, as in "
            f"aw.grid(array, mask=np.isfinite(image)){hint}"
        )
    if given.dtype.kind == "f" and np.isnan(given).any():
        raise ValueError(
            "mask: has NaN; True or nonzero is a place with data: aw.grid(array, mask=np.nan_to_num(mask) > 0)"
        )
    kept = np.ascontiguousarray(given != 0).reshape(-1)
    if not kept.any():
        raise ValueError(
            "mask: leaves out every place, and True or nonzero is a place with data; if True are places to leave out, "
            "aw.grid(array, mask=~mask)"
        )
    return None if kept.all() else kept


def widths_of_sigma(sigma: Any) -> Widths:
    """Levels of these standard deviations along one axis."""
    try:
        given = np.atleast_1d(np.asarray(sigma, dtype=np.float64))
    except (TypeError, ValueError) as error:
        raise TypeError(
            f"sigma must be standard deviations in the unit of the spacing, as in sigma=2.0, got {sigma!r}; shares of the "
            'diagonal go as fwhm="2%"'
        ) from error
    if not (given.size and np.isfinite(given).all() and (given > 0).all()):
        raise ValueError(f"sigma must be above 0, as in sigma=2.0, got {sigma!r}")
    return Widths(rms=[float(np.sqrt(2.0) * each) for each in given.ravel()])


def spacings_by_width(name: str, widths: Any, spacing: Sequence[float]) -> tuple[float, ...]:
    """Spacings on which one width of 1 is a width for each axis.

    Raises
    ------
    ValueError
        If there is not one width above 0 for each axis.
    """
    each = np.ravel(widths).tolist()
    if len(each) == 1:
        each *= len(spacing)
    if len(each) != len(spacing):
        raise ValueError(
            f"{name}: got {len(each)} numbers for {len(spacing)} axes; give one number, or one for each axis"
        )
    if not all(isinstance(width, (int, float)) and 0 < width < np.inf for width in each):
        raise ValueError(
            f"{name}: widths must be finite numbers above 0, got {widths!r}; an axis that is not smoothed is left out, "
            "aw.grid(array, axes=(1, 2))"
        )
    return tuple(h / width for h, width in zip(spacing, each, strict=True))


def levels_by_sigma(function: str, levels: LevelsLike, sigma: Any, options: dict[str, Any]) -> LevelsLike:
    """Levels, from their short forms too."""
    if options:
        refuse_unknown(function, options, ("signal", "levels", "sigma", "accuracy", "progress"), ("fwhm", "steps"))
    if sigma is None:
        return levels_of(levels, options)
    if levels is not None or options:
        raise ValueError("levels are given twice, by sigma and another; leave one out")
    return widths_of_sigma(sigma)


def cast_values(values: NDArray[Any], like: NDArray[Any]) -> NDArray[Any]:
    """Values in the number type of an array; integers are rounded, and places without a value keep theirs.

    Raises
    ------
    ValueError
        If a value does not fit into the type.
    """
    dtype = like.dtype
    if dtype.kind == "f":
        return values.astype(dtype)
    if dtype.kind not in "iub":
        return values
    low, high = (0, 1) if dtype.kind == "b" else (np.iinfo(dtype).min, np.iinfo(dtype).max)
    whole = np.rint(values)
    unknown = np.isnan(whole)
    outside = (whole < low) | (whole > high)
    if outside.any():
        value = float(whole[outside][0])
        raise ValueError(
            f"keep_dtype: the value {value:g} does not fit into {dtype}, {low} to {high}; leave keep_dtype out, and clip, "
            f"as in np.clip(result, {low}, {high}).astype('{dtype}')"
        )
    if unknown.any():
        return np.where(unknown, like, np.where(unknown, 0, whole).astype(dtype))
    return whole.astype(dtype)
