"""Sizes of bands as features for scikit-learn.

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
from adwave._options import LevelsLike, OperatorLike

__all__ = ["WaveletFeatures"]

_QUANTILES = (0.1, 0.5, 0.9)


class WaveletFeatures(TransformerMixin, BaseEstimator):
    """Describe shapes by the sizes of their bands, for classification or regression.

    For each level: the mean, the root mean square and the 10th, 50th and 90th percentile of ‖W(j,x)‖ over the vertices (by
    area), in units of the root of the area. These are invariant to translation, scale and the order of the vertices, and
    to rotation unless the levels are widths in %, which refer to the diagonal of the axis-aligned bounding box.

    Parameters
    ----------
    levels : int, Widths or Steps
        Levels as in `adwave.decompose`; their number must not depend on the shape.
    operator : str or Operator
        As in `adwave.Decomposer`. For shapes of different meshings take ``aw.Widths(...)`` with ``'surface'``.

    Examples
    --------
    >>> import adwave as aw
    >>> by_width = WaveletFeatures(levels=aw.Widths(rms=["2%", "4%"]), operator="surface")
    >>> by_width.fit_transform([aw.sample("sphere", vertices=300)]).shape
    (1, 10)
    """

    def __init__(self, levels: LevelsLike = 6, operator: OperatorLike = "walk") -> None:
        self.levels: LevelsLike = levels
        self.operator: OperatorLike = operator

    def fit(self, shapes: Sequence[object], y: Any = None) -> WaveletFeatures:
        """Note the number of features; nothing is learned.

        Parameters
        ----------
        shapes : sequence of shape_like
            Shapes, which are not used.
        y : None
            Not used.
        """
        self.n_features_out_ = self._n_levels() * (2 + len(_QUANTILES))
        return self

    def transform(self, shapes: Sequence[object]) -> NDArray[np.float64]:
        """Features of shapes, as rows.

        Parameters
        ----------
        shapes : sequence of shape_like
            Anything that is a shape; see `adwave.Shape`.

        Returns
        -------
        (shapes, levels × 5) array
        """
        return np.array([self._row(shape) for shape in shapes]).reshape(len(shapes), -1)

    def get_feature_names_out(self, input_features: Any = None) -> NDArray[np.object_]:
        """Names ``level1_mean``, ``level1_rms``, ``level1_q10`` …

        Parameters
        ----------
        input_features : None
            Not used.
        """
        names = ["mean", "rms", *(f"q{round(100 * q)}" for q in _QUANTILES)]
        return np.array([f"level{j}_{name}" for j in range(1, self._n_levels() + 1) for name in names], dtype=object)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.requires_fit = False
        tags.no_validation = True
        return tags

    def _more_tags(self) -> dict[str, Any]:
        return {"X_types": ["shapes"], "requires_fit": False, "stateless": True, "no_validation": True}

    def _n_levels(self) -> int:
        levels: Any = self.levels
        return int(levels) if isinstance(levels, (int, np.integer)) else len(levels)

    def _row(self, shape: object) -> NDArray[np.float64]:
        bands = decompose(shape, levels=self.levels, operator=self.operator)
        areas = bands.decomposer.areas
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
