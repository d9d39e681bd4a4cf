"""Layers as what adwave splits: images and volumes as grids, surfaces and points as shapes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import adwave as aw
import numpy as np
from napari.layers import Image, Layer, Points, Surface


@dataclass
class Signal:
    """Something that has bands.

    Attributes
    ----------
    domain
        Grid, or what adwave takes as a shape.
    values
        Values at its places, or None if its coordinates are the signal.
    layer
        Layer that it comes from.
    """

    domain: Any
    values: np.ndarray | None
    layer: Layer

    def decompose(self, n_levels: int) -> Any:
        """Bands from fine to coarse, and the rest."""
        if isinstance(self.layer, Image):
            return self.domain.decompose(levels=n_levels)
        return aw.decompose(self.domain, self.values, levels=n_levels)

    def denoise(self) -> np.ndarray:
        """Values or coordinates without noise."""
        if isinstance(self.layer, Image):
            return np.asarray(self.domain.denoise()[0])
        if self.values is not None:
            return np.asarray(aw.denoise(self.domain, self.values)[0])
        clean = aw.denoise(self.domain)[0]
        return np.asarray(clean[0] if isinstance(clean, tuple) else clean)

    def saliency(self) -> np.ndarray:
        """Saliency of each place: + above its surroundings, − below."""
        if isinstance(self.layer, Image):
            return np.asarray(self.domain.saliency())
        return np.asarray(aw.saliency(self.domain, self.values))

    def new_layer(self, result: np.ndarray, name: str) -> Layer:
        """Layer of changed values or coordinates, placed as the one that it comes from."""
        layer = self.layer
        place = {"name": name, "scale": layer.scale, "translate": layer.translate}
        if isinstance(layer, Image):
            if layer.rgb:
                return Image(to_colors(result, layer.data.dtype), rgb=True, **place)
            limits = layer.contrast_limits if np.isfinite(layer.contrast_limits).all() else None
            return Image(result, colormap=layer.colormap, contrast_limits=limits, **place)
        if self.values is None:
            # Shapes are split in the lengths of the scale, in as many axes as the layer has.
            result = result[:, : layer.ndim] / layer.scale
        if isinstance(layer, Points):
            return Points(result, size=layer.size, features=layer.features, **place)
        vertices, faces, *_ = layer.data
        if self.values is None:
            return Surface((result, faces), **place)
        return Surface((vertices, faces, result), colormap=layer.colormap, **place)

    def map_layer(self, values: np.ndarray, name: str) -> Layer:
        """Layer of a signed map, white at zero."""
        layer = self.layer
        place = {"name": name, "scale": layer.scale, "translate": layer.translate}
        limit = float(np.nanmax(np.abs(values))) or 1.0
        colors = {"colormap": "PiYG", "contrast_limits": (-limit, limit)}
        if isinstance(layer, Image):
            return Image(values, **colors, **place)
        if isinstance(layer, Points):
            features = {"saliency": values}
            points = Points(layer.data, size=layer.size, features=features, face_color="saliency", **place)
            points.face_colormap = "PiYG"
            points.face_contrast_limits = (-limit, limit)
            return points
        vertices, faces, *_ = layer.data
        return Surface((vertices, faces, values), **colors, **place)


def to_colors(values: np.ndarray, dtype: np.dtype) -> np.ndarray:
    """Colors in the number type of an image, cut to its range."""
    if np.issubdtype(dtype, np.integer):
        limits = np.iinfo(dtype)
        return np.clip(np.rint(values), limits.min, limits.max).astype(dtype)
    return np.clip(values, 0, 1).astype(dtype)


def signal_of(layer: Layer | None) -> Signal:
    """Signal of a layer; lengths are in the unit of its scale.

    Raises
    ------
    ValueError
        If the layer has no bands; the message says what has.
    """
    if isinstance(layer, Image) and not layer.multiscale:
        return image_signal(layer)
    if isinstance(layer, Surface):
        vertices, faces, *rest = layer.data
        if np.asarray(vertices).shape[1] != 3:
            raise ValueError(f"the surface must have 3 coordinates, got {np.asarray(vertices).shape[1]}")
        values = np.asarray(rest[0], dtype=float) if rest else np.ones(len(vertices))
        is_plain = values.ndim != 1 or np.ptp(values) == 0
        shape = (np.asarray(vertices, dtype=float) * layer.scale, np.asarray(faces))
        return Signal(shape, None if is_plain else values, layer)
    if isinstance(layer, Points) and layer.ndim in (2, 3) and len(layer.data) > 0:
        return Signal(np.asarray(layer.data, dtype=float) * layer.scale, None, layer)
    kind = "no layer" if layer is None else f"a {type(layer).__name__} layer"
    raise ValueError(f"choose an image of one scale, a surface, or points in 2 or 3 dimensions; got {kind}")


def image_signal(layer: Image) -> Signal:
    """Signal of an image or a volume.

    Raises
    ------
    ValueError
        If it has more than three axes.
    """
    values = np.asarray(layer.data)
    scale = tuple(float(length) for length in np.abs(layer.scale))
    if layer.rgb:
        return Signal(aw.grid(values.astype(float), spacing=scale, axes=(0, 1)), None, layer)
    if values.ndim > 3:
        raise ValueError(f"an image must have at most 3 axes, got {values.ndim}; take one frame or channel")
    if not np.issubdtype(values.dtype, np.floating):
        values = values.astype(float)
    return Signal(aw.grid(values, spacing=scale), None, layer)
