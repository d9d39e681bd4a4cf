"""Bands for scikit-learn: shapes described by the sizes of their bands, and signals on one shape split into bands.

>>> import adwave as aw
>>> from adwave.sklearn import WaveletFeatures
>>> shapes = [aw.sample("sphere", vertices=300), aw.sample("torus", vertices=300)]
>>> WaveletFeatures(levels=4).fit_transform(shapes).shape
(2, 20)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import check_is_fitted

from adwave._adapt_objects import library_of
from adwave._caller import public
from adwave._decomposer import prepare_decomposer
from adwave._edits import decompose
from adwave._layout import float_type
from adwave._options import LevelsLike, OperatorLike, Steps
from adwave._shape import graph

__all__ = ["SignalBands", "WaveletFeatures"]

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

    @public()
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

    def fit_transform(self, shapes: Sequence[object], y: Any = None, **options: Any) -> NDArray[np.float64]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Equals `transform`, because nothing is learned.

        Parameters
        ----------
        shapes : sequence of shape_like
            Anything that is a shape; see `adwave.Shape`.
        y : None
            Not used.
        **options
            Not used.
        """
        return self.fit(shapes, y).transform(shapes)

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


class SignalBands(TransformerMixin, BaseEstimator):
    """Split signals on one shape or graph into bands: rows of samples × vertices become features by level.

    Images on surfaces of nilearn are signals of both hemispheres: `fit` takes their meshes, `transform` gives a row for each
    time, and `inverse_transform` an image again.

    Parameters
    ----------
    shape : shape_like, optional
        Anything that is a shape; see `adwave.Shape`. A sparse matrix of weights is a graph. It is prepared by `fit`. By
        default the meshes of an image on surfaces, or a chain in which each column has the next one as its neighbor.
    levels : int, Widths, Steps or Octaves, optional
        As in `adwave.decompose`.
    output : {'bands', 'energy', 'smooth'}
        Features of a sample: all bands, (levels + 1) × vertices; the root mean square of each band over the vertices by
        area, levels + 1; or the signal without its bands, vertices.
    operator : str or Operator, optional
        As in `adwave.decompose`.

    Attributes
    ----------
    decomposer_ : Decomposer
        The prepared shape.
    n_features_in_ : int
        Number of vertices.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ring = aw.graph(60, [[i, (i + 1) % 60] for i in range(60)])
    >>> samples = np.random.default_rng(0).normal(size=(5, 60))
    >>> split = SignalBands(ring, levels=3)
    >>> bands = split.fit_transform(samples)
    >>> bands.shape, bool(np.allclose(split.inverse_transform(bands), samples))
    ((5, 240), True)
    >>> SignalBands(ring, levels=3, output="energy").fit_transform(samples).shape
    (5, 4)
    """

    @public()
    def __init__(
        self,
        shape: object = None,
        levels: LevelsLike = 6,
        output: Literal["bands", "energy", "smooth"] = "bands",
        operator: OperatorLike = None,
    ) -> None:
        self.shape: object = shape
        self.levels: LevelsLike = levels
        self.output: Literal["bands", "energy", "smooth"] = output
        self.operator: OperatorLike = operator

    def fit(self, X: object, y: Any = None) -> SignalBands:
        """Prepare the shape; nothing is learned from the samples.

        Parameters
        ----------
        X : (samples, vertices) array_like, or image on surfaces of nilearn
            Signals as rows. NaN is a vertex without a value.
        y : None
            Not used.

        Raises
        ------
        ValueError
            If the output is unknown, or rows do not have a value for each vertex.
        """
        if self.output not in ("bands", "energy", "smooth"):
            raise ValueError(f"output must be one of 'bands', 'energy', 'smooth', got {self.output!r}")
        rows = self._rows(X, reset=True)
        shape = self.shape
        if shape is None:
            n = rows.shape[1]
            if n < 2:
                raise ValueError(f"X has {n} feature(s), and a chain has two columns or more; give a shape")
            shape = X if _is_surface_image(X) else graph(n, np.column_stack([np.arange(n - 1), np.arange(1, n)]))
        self.decomposer_ = prepare_decomposer(shape, self.operator, self.levels)
        self.steps_ = self.decomposer_.schedule(self.levels)
        self._check_columns(rows)
        return self

    def fit_transform(self, X: object, y: Any = None, **options: Any) -> NDArray[Any]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Prepare the shape and split the samples.

        Parameters
        ----------
        X : (samples, vertices) array_like, or image on surfaces of nilearn
            Signals as rows.
        y : None
            Not used.
        **options
            Not used.
        """
        return self.fit(X, y).transform(X)

    def transform(self, X: object) -> NDArray[Any]:
        """Features of samples, as rows.

        Parameters
        ----------
        X : (samples, vertices) array_like, or image on surfaces of nilearn
            Signals as rows.

        Returns
        -------
        (samples, features) array, in the number type of samples of floats

        Raises
        ------
        sklearn.exceptions.NotFittedError
            Before `fit`.
        """
        check_is_fitted(self)
        rows = self._rows(X)
        levels = Steps(self.steps_)
        bands = self.decomposer_.decompose(np.ascontiguousarray(rows.T), levels=levels).array
        dtype = float_type(rows)
        if self.output == "smooth":
            return np.ascontiguousarray(bands[-1].T)
        if self.output == "bands":
            return np.ascontiguousarray(bands.transpose(2, 0, 1)).reshape(len(rows), -1)
        areas = self.decomposer_.areas
        squares = np.einsum("jnc,n->cj", np.nan_to_num(bands) ** 2, areas)
        return np.sqrt(squares / (areas.sum() or 1.0)).astype(dtype, copy=False)

    def inverse_transform(self, X: ArrayLike) -> Any:
        """Signals from their bands, as sums over the levels; an image on surfaces if `fit` was given one.

        Parameters
        ----------
        X : (samples, (levels + 1) · vertices) array_like
            Result of `transform`, perhaps changed; (samples, vertices) of the output ``'smooth'``.

        Returns
        -------
        (samples, vertices) array, or image on surfaces of nilearn

        Raises
        ------
        ValueError
            If the output is ``'energy'``, or rows have another length.
        """
        check_is_fitted(self)
        if self.output == "energy" or (self.output == "smooth" and self._image is None):
            raise ValueError(f"only output='bands' has an inverse, got {self.output!r}")
        given = np.asarray(X)
        given = given.astype(float_type(given), copy=False)
        n_bands = 1 if self.output == "smooth" else len(self.steps_) + 1
        if given.ndim != 2 or given.shape[1] != n_bands * self.n_features_in_:
            raise ValueError(f"X must have {n_bands} × {self.n_features_in_} columns, got shape {given.shape}")
        rows = given.reshape(len(given), n_bands, -1).sum(axis=1)
        return rows if self._image is None else _image_of_rows(self._image, rows)

    def get_feature_names_out(self, input_features: Any = None) -> NDArray[np.object_]:
        """Names ``level1_vertex0`` …, ``level1_rms`` … or ``vertex0`` …; the last level is the rest.

        Parameters
        ----------
        input_features : None
            Not used.
        """
        check_is_fitted(self)
        levels = [*(f"level{j}" for j in range(1, len(self.steps_) + 1)), "rest"]
        vertices = [f"vertex{i}" for i in range(self.n_features_in_)]
        if self.output == "energy":
            return np.array([f"{level}_rms" for level in levels], dtype=object)
        if self.output == "smooth":
            return np.array(vertices, dtype=object)
        return np.array([f"{level}_{vertex}" for level in levels for vertex in vertices], dtype=object)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        tags.transformer_tags.preserves_dtype = ["float64", "float32"]
        return tags

    def _more_tags(self) -> dict[str, Any]:
        return {"allow_nan": True, "preserves_dtype": [np.float64, np.float32]}

    def _rows(self, X: object, *, reset: bool = False) -> NDArray[Any]:
        """Samples as rows of floats."""
        if reset:
            self._image = X if _is_surface_image(X) else None
        if _is_surface_image(X):
            rows = _rows_of_image(X)
            self.n_features_in_ = rows.shape[1] if reset else self.n_features_in_
            return rows
        shape = np.shape(X) if not reset and hasattr(X, "shape") else ()  # type: ignore[arg-type]
        if len(shape) == 2 and shape[0] == self.n_features_in_ != shape[1]:
            raise ValueError(
                f"X has {shape[1]} features, but {type(self).__name__} is expecting {shape[0]} features as input: it must be "
                f"samples × {shape[0]} vertices; pass X.T"
            )
        settings: dict[str, Any] = {"dtype": [np.float64, np.float32], "reset": reset}
        try:
            from sklearn.utils import validation

            validate: Any = validation.validate_data
        except (ImportError, AttributeError):  # before version 1.6
            return self._validate_data(X, force_all_finite="allow-nan", **settings)  # type: ignore[attr-defined]
        return validate(self, X, ensure_all_finite="allow-nan", **settings)

    def _check_columns(self, rows: NDArray[Any]) -> None:
        n = self.decomposer_.n_vertices
        if rows.shape[1] != n:
            hint = "; pass X.T" if rows.shape[0] == n else ""
            raise ValueError(f"X must be samples × {n} vertices, got shape {rows.shape}{hint}")


def _is_surface_image(X: object) -> bool:
    return library_of(X) == "nilearn" and hasattr(X, "data") and hasattr(X, "mesh")


def _rows_of_image(image: Any) -> NDArray[Any]:
    """Times × vertices of an image on surfaces, hemisphere after hemisphere."""
    values = np.concatenate([np.asarray(part) for part in image.data.parts.values()])
    return np.atleast_2d(values.T if values.ndim == 2 else values)


def _image_of_rows(image: Any, rows: NDArray[Any]) -> Any:
    """An image on the surfaces of another with a row of values for each time."""
    values, start, parts = rows.T, 0, {}
    for name, part in image.data.parts.items():
        own = values[start : start + len(part)]
        parts[name] = np.ascontiguousarray(own if np.ndim(part) == 2 or own.shape[1] > 1 else own[:, 0])
        start += len(part)
    return type(image)(mesh=image.mesh, data=parts)
