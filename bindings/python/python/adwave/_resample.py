"""Values carried between registered spheres, such as those of fsaverage and fs_LR."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from adwave import _adapt, _native
from adwave._caller import public, warn
from adwave._layout import signal_values
from adwave._progress import ProgressLike, report_progress
from adwave._shape import as_shape

Keep = Literal["mean", "sum", "integral", "labels"]


class Resampler:
    """Weights from one sphere to another, or for both hemispheres, prepared for many fields; see `resample`.

    Parameters
    ----------
    source, onto : shape_like, or a list or dict of them
        Registered spheres, one for each hemisphere.
    areas, onto_areas : shape_like or (n,) array_like, or a list or dict of them, optional
        Surfaces with the vertices of the spheres whose areas count, or the areas; those of the spheres by default.
    onto_mask : (m,) array_like of bool, or a list or dict of them, optional
        True for the vertices of `onto` that get values.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Attributes
    ----------
    sizes : list of (int, int)
        Numbers of vertices of the source and of `onto`, for each hemisphere.

    Raises
    ------
    ValueError
        If a sphere is not round, not closed or does not cover each direction once, or numbers do not match.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> coarse, fine = aw.sample("sphere", vertices=600), aw.sample("sphere", vertices=2500)
    >>> there, back = aw.Resampler(coarse, fine), aw.Resampler(fine, coarse)
    >>> counts = np.random.default_rng(0).poisson(3, coarse.n_vertices).astype(float)
    >>> both_ways = back.apply(there.apply(counts, keep="sum"), keep="sum")
    >>> bool(np.isclose(both_ways.sum(), counts.sum(), rtol=1e-12))
    True
    """

    sizes: list[tuple[int, int]]

    def __init__(
        self,
        source: object,
        onto: object,
        *,
        areas: object = None,
        onto_areas: object = None,
        onto_mask: object = None,
        progress: ProgressLike = None,
    ) -> None:
        first, names = _hemispheres(source)
        second, other_names = _hemispheres(onto)
        if len(first) != len(second) or (names and other_names and names != other_names):
            raise ValueError(
                f"source and onto must have the same hemispheres, got {_listed(names, first)} and "
                f"{_listed(other_names, second)}; give a pair (left, right) for each"
            )
        n, pairs = len(first), []
        masks = _each(onto_mask, n, "onto_mask")
        for k, (one, other) in enumerate(zip(first, second)):  # noqa: B905
            sphere = _sphere(one, _each(areas, n, "areas")[k], "source")
            target = _sphere(other, _each(onto_areas, n, "onto_areas")[k], "onto")
            pairs.append((sphere, target, masks[k]))
        self._sources = [len(sphere.areas()) for sphere, _, _ in pairs]
        self._targets = [len(target.areas()) for _, target, _ in pairs]
        self.sizes = list(zip(self._sources, self._targets))  # noqa: B905
        self._names = names
        self._data = []
        with report_progress(progress, "resampling") as report:
            for (sphere, target, mask), n_targets in zip(pairs, self._targets):  # noqa: B905
                kept = None if mask is None else _mask(mask, n_targets)
                self._data.append(_native.SphereResamplerData(sphere, target, kept, report))

    def __repr__(self) -> str:
        sizes = " and ".join(f"{source} → {target}" for source, target in self.sizes)
        return f"<adwave.Resampler: {sizes} vertices>"

    def apply(
        self, values: object, *, keep: Union[Keep, None] = None, zeros: Literal["wall", "values"] = "wall"
    ) -> Any:
        """Values of the source at the vertices of `onto`; see `resample`.

        Parameters
        ----------
        values : (n,) or (n, channels) array_like, or a list or dict of them
            Values of the source, one hemisphere after the other in an array, or an array for each.
        keep : {'mean', 'sum', 'integral', 'labels'}, optional
            What is kept.
        zeros : {'wall', 'values'}
            Meaning of one connected piece of zeros.

        Raises
        ------
        ValueError
            If the number of values is another, one is infinite, or labels are no whole numbers.
        """
        if isinstance(values, Mapping):
            if not self._names or sorted(values) != sorted(self._names):
                raise ValueError(f"values must have the hemispheres {self._names or 'of a list'}, got {list(values)}")
            found = self._apply_each([values[name] for name in self._names], keep, zeros)
            return dict(zip(self._names, found))  # noqa: B905
        if isinstance(values, (list, tuple)) and len(values) == len(self.sizes):
            each: list[Any] = list(values)
            if all(np.ndim(part) for part in each):
                found = self._apply_each(each, keep, zeros)
                return found if isinstance(values, list) else tuple(found)
        array = values if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
        n = sum(self._sources)
        _, layout = signal_values(_as_floats(array), n, "values")
        axis = -1 if layout.is_last else 0
        parts = np.split(array, np.cumsum(self._sources)[:-1], axis=axis) if len(self.sizes) > 1 else [array]
        return np.concatenate(self._apply_each(parts, keep, zeros), axis=axis)

    def _apply_each(self, parts: list[Any], keep: Union[str, None], zeros: str) -> list[NDArray[Any]]:
        found, n_wall, n_missing = [], 0, 0
        for data, part, n, n_targets in zip(self._data, parts, self._sources, self._targets):  # noqa: B905
            array = part if isinstance(part, np.ma.MaskedArray) else np.asarray(part)
            is_whole = array.dtype.kind in "iub"
            own = keep or ("labels" if is_whole else "mean")
            values, layout = signal_values(_as_floats(array), n, "values")
            if own == "labels" and not is_whole and not np.all(np.isnan(values) | (values == np.round(values))):
                raise ValueError("labels must be whole numbers; give keep='mean' to average the values")
            rows = np.ascontiguousarray(values, dtype=np.float64)
            new, missing, wall = data.apply(rows, own, zeros)
            n_wall, n_missing = n_wall + wall, n_missing + (0 if wall else missing)
            if own == "labels" and is_whole:
                new = np.nan_to_num(new).astype(array.dtype)
            found.append(layout.with_vertices(n_targets).arrange(new))
        if n_wall:
            share = 100 * n_wall / sum(self._sources)
            warn(
                f"values: {n_wall} vertices ({share:.1f} %) that are exactly 0 and connected are taken as the medial "
                "wall, which has no values; zeros='values' averages them too"
            )
        return found


def _as_floats(array: Any) -> Any:
    return array.astype(np.float64) if array.dtype.kind in "iub" else array


def _is_sphere(x: object) -> bool:
    """True for one sphere: a mesh, a path, or points and faces."""
    if isinstance(x, (str, os.PathLike)) or _adapt.is_domain(x):
        return True
    return isinstance(x, (tuple, list)) and len(x) == 2 and _adapt.depth(x[0]) == 2


def _hemispheres(x: Any) -> tuple[list[Any], list[str]]:
    """Spheres, and their names if they have some."""
    parts = getattr(x, "parts", None)
    if isinstance(parts, Mapping):  # a PolyMesh of nilearn
        return list(parts.values()), [str(name) for name in parts]
    if isinstance(x, Mapping) and x and all(_is_sphere(part) for part in x.values()):
        return list(x.values()), [str(name) for name in x]
    if isinstance(x, (tuple, list)) and x and all(_is_sphere(part) for part in x):
        return list(x), []
    return [x], []


def _listed(names: list[str], parts: list[Any]) -> str:
    return ", ".join(names) if names else str(len(parts))


def _each(x: Any, n: int, name: str) -> list[Any]:
    """An option for each hemisphere."""
    if x is None or n == 1:
        return [x[0] if isinstance(x, list) and len(x) == 1 else x] * n
    parts = getattr(x, "parts", x)
    found = list(parts.values()) if isinstance(parts, Mapping) else parts
    if not isinstance(found, (list, tuple)) or len(found) != n:
        raise ValueError(f"{name} must have one entry for each of the {n} hemispheres; give a list of {n}")
    return list(found)


def _sphere(shape: object, areas: Any, name: str) -> _native.SphereData:
    own = as_shape(shape)
    numbers = surface = None
    if areas is not None:
        is_numbers = not _is_sphere(areas) and np.ndim(areas) == 1
        if is_numbers:
            numbers = np.ascontiguousarray(areas, dtype=np.float64)
        else:
            surface = np.ascontiguousarray(as_shape(areas).points)
    try:
        sphere = _native.SphereData(own._data, numbers, surface)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    for remark in sphere.remarks():
        warn(f"{name}: {remark}")
    return sphere


def _mask(mask: Any, n: int) -> NDArray[np.bool_]:
    array = np.asarray(mask)
    if array.shape != (n,):
        raise ValueError(f"onto_mask must have a flag for each of the {n} vertices, got shape {array.shape}")
    if array.dtype.kind == "f" and not np.isin(array, (0, 1)).all():
        raise ValueError("onto_mask must be flags, or 0 and 1")
    return np.ascontiguousarray(array != 0)


@public()
def resample(
    source: object,
    values: object,
    *,
    onto: object,
    keep: Union[Keep, None] = None,
    areas: object = None,
    onto_areas: object = None,
    onto_mask: object = None,
    zeros: Literal["wall", "values"] = "wall",
    progress: ProgressLike = None,
) -> Any:
    """Carry values from the vertices of a sphere to those of another one that is registered to it.

    Made for cortical surfaces: fields, bands, labels and parcels between levels of fsaverage, fs_LR and any spheres in
    register, both hemispheres at once. The weights are barycentric, both ways, and corrected by area: the rule of
    Connectome Workbench's ``ADAP_BARY_AREA``. All data count where the source is finer.

    Parameters
    ----------
    source : shape_like, or a list or dict of them
        Sphere of the values, or one for each hemisphere: a file, ``(points, faces)``, a mesh; see `Shape`.
    values : (n,) or (n, channels) array_like, or a list or dict of them
        Values at the vertices, of both hemispheres one after the other or each by itself. NaN and masked numbers are no
        values.
    onto : shape_like, or a list or dict of them
        The other sphere, or one for each hemisphere, in register with `source`.
    keep : {'mean', 'sum', 'integral', 'labels'}, optional
        ``'mean'`` keeps constants, for thickness or activation. ``'sum'`` keeps the sum of the values, for areas or
        counts. ``'integral'`` keeps the sum of value × area, for densities. ``'labels'`` gives each vertex the label with
        the largest weight, of equal ones the smallest. By default ``'labels'`` for whole numbers and flags, and else ``'mean'``.
    areas, onto_areas : shape_like or (n,) array_like, or a list or dict of them, optional
        Anatomical surfaces with the vertices of the spheres, such as the midthickness, whose areas correct the weights; or
        the areas. Those of the spheres by default.
    onto_mask : (m,) array_like of bool, or a list or dict of them, optional
        True for the vertices of `onto` that get values, as without its medial wall. Amounts that would go elsewhere go to
        the nearest ones. Other vertices are NaN, and 0 in whole numbers.
    zeros : {'wall', 'values'}
        For means: one connected piece of exact zeros, 2 % to 20 % of the vertices, is taken as the medial wall, with a
        warning. It takes no part, and the wall of the result is 0 too. ``'values'`` averages zeros like all numbers.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    array, or a list or dict of arrays
        Like `values`, with the vertices of `onto`. A mean or label is NaN where less than half of its weight has a value.

    Raises
    ------
    ValueError
        If a sphere is not round, not closed or does not cover each direction once, or numbers do not match.

    Notes
    -----
    O(vertices + weights × channels). `Resampler` keeps the weights for many calls. Spheres of other radii are scaled, and
    folds are passed over.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> coarse, fine = aw.sample("sphere", vertices=600), aw.sample("sphere", vertices=2500)
    >>> heights = coarse.points[:, 2]
    >>> found = aw.resample(coarse, heights, onto=fine)
    >>> bool(abs(found - fine.points[:, 2]).max() < 0.02)
    True
    >>> amounts = aw.resample(coarse, np.ones(coarse.n_vertices), onto=fine, keep="sum")
    >>> bool(np.isclose(amounts.sum(), coarse.n_vertices, rtol=1e-12))
    True
    >>> parcels = (heights > 0).astype(int) + 2 * (heights > 0.5)
    >>> [int(label) for label in np.unique(aw.resample(coarse, parcels, onto=fine))]
    [0, 1, 3]
    >>> left, right = aw.resample([coarse, coarse], [heights, -heights], onto=[fine, fine])
    >>> left.shape == right.shape == (fine.n_vertices,)
    True
    """
    resampler = Resampler(source, onto, areas=areas, onto_areas=onto_areas, onto_mask=onto_mask, progress=progress)
    return resampler.apply(values, keep=keep, zeros=zeros)
