"""Bands as features for scikit-learn.

>>> import adwave as aw
>>> from adwave.sklearn import WaveletFeatures
>>> shapes = [aw.sample("sphere", vertices=300), aw.sample("torus", vertices=300)]
>>> WaveletFeatures(levels=4).fit_transform(shapes).shape
(2, 20)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, TransformerMixin

from adwave._edits import decompose

__all__ = ["WaveletFeatures"]

_QUANTILES = (0.1, 0.5, 0.9)


class WaveletFeatures(TransformerMixin, BaseEstimator):
    """Describe shapes by the sizes of their bands, for classification or regression.

    For each level: the mean, the root mean square and the 10th, 50th and 90th percentile of ‖W(j,x)‖ over the vertices (by area),
    in units of the root of the area. Unchanged by rotation, translation, scale and the order of the vertices; ``widths`` in %,
    which are of the axis-aligned bounding box's diagonal, change with the rotation.

    Parameters
    ----------
    levels : int
        Dyadic levels.
    operator : {'walk', 'surface'}
        As for `adwave.Decomposer`. For shapes of different meshings ``widths`` with ``'surface'``.
    widths : sequence of float or str, optional
        Levels of these widths, such as ``("1%", "2%", "4%")``, in the place of ``levels``.
    """

    def __init__(self, levels: int = 6, operator: str = "walk", widths: Sequence[float | str] | None = None) -> None:
        self.levels = levels
        self.operator = operator
        self.widths = widths

    def fit(self, shapes: Sequence[object], y: Any = None) -> WaveletFeatures:
        """Nothing is learned; the number of features is noted.

        Parameters
        ----------
        shapes : sequence of shape-like
        """
        n = self.levels if self.widths is None else len(self.widths)
        self.n_features_out_ = n * (2 + len(_QUANTILES))
        return self

    def transform(self, shapes: Sequence[object]) -> NDArray[np.float64]:
        """One row for each shape.

        Returns
        -------
        (shapes, levels × 5) array
        """
        return np.array([self._row(shape) for shape in shapes]).reshape(len(shapes), -1)

    def get_feature_names_out(self, input_features: Any = None) -> NDArray[np.object_]:
        """``level1_mean``, ``level1_rms``, ``level1_q10`` …"""
        names = ["mean", "rms", *(f"q{round(100 * q)}" for q in _QUANTILES)]
        n = self.levels if self.widths is None else len(self.widths)
        return np.array([f"level{j}_{name}" for j in range(1, n + 1) for name in names], dtype=object)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.requires_fit = False
        tags.no_validation = True
        return tags

    def _more_tags(self) -> dict[str, Any]:
        return {"X_types": ["shapes"], "requires_fit": False, "stateless": True, "no_validation": True}

    def _row(self, shape: object) -> NDArray[np.float64]:
        chosen: dict[str, Any] = {"levels": self.levels} if self.widths is None else {"lengths": self.widths}
        bands = decompose(shape, operator=self.operator, **chosen)
        own = bands.decomposer
        areas = own.areas
        unit = float(np.sqrt(areas.sum())) or 1.0
        row: list[float] = []
        for level in range(1, bands.n_levels + 1):
            sizes = np.linalg.norm(bands.wavelet(level), axis=1) / unit
            total = areas.sum() or 1.0
            row += [float(areas @ sizes / total), float(np.sqrt(areas @ sizes**2 / total))]
            order = np.argsort(sizes)
            shares = np.cumsum(areas[order]) / total
            row += [float(sizes[order[min(np.searchsorted(shares, q), len(order) - 1)]]) for q in _QUANTILES]
        return np.array(row)
