"""Keys of the estimates of `denoise`, and the types of their values."""

from __future__ import annotations

from typing import TypedDict, Union

import numpy as np
from numpy.typing import NDArray

__all__ = ["DenoiseInfo"]


class DenoiseInfo(TypedDict):
    """Estimates that a result without noise is based on.

    What was given decides which keys are there; `DenoiseResult` lists them with their meaning. None is marked as optional, so
    that a type checker knows the type of ``info["kept"]`` without a test for the key.
    """

    noise: float
    risk: list[float]
    # A shape's positions.
    noise_in_edges: float
    noise_map: NDArray[np.float64]
    noise_range: list[float]
    kept: float
    crease_weights: list[float]
    smooth_weights: list[float]
    n_far: int
    furthest: float
    # Those of a mesh.
    impulse_share: float
    impulse_size: float
    turned_share: float
    linear_rounds: float
    kept_by_place: list[float]
    shared_noise: float
    shared_noise_at_most: float
    # Those of a cloud.
    noise_interval: list[float]
    neighbors: int
    residual_ratio: Union[float, None]
    two_surfaces: bool
    flat_share: Union[float, None]
    noise_is_doubtful: bool
    n_outliers: int
    strong_noise: Union[float, None]
    n_left: int
    rounding: Union[float, list[float]]
    nearest_distance: list[float]
    outliers: list[int]
    # Those of a curve.
    noise_by_axis: list[float]
    length: list[float]
    # A signal's groups of channels.
    groups: list[DenoiseInfo]
    channels: list[int]
    noise_model: str
    remaining: float
    plain_weights: list[float]
    step_weights: list[float]
    # A series in time.
    widths: list[float]
    steps: list[float]
    mean_steps: list[float]
    weights: list[list[float]]
