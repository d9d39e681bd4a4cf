"""Which features are found again when a shape is changed on purpose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._decomposer import Length, prepared
from adwave._measures import Features, features
from adwave._progress import ProgressLike, reporting
from adwave._shape import Shape

Kind = Literal["noise", "rotation", "scaling", "resampling", "other-vertices"]
#: Signals that a shape has by itself, so that a changed one has them too.
_OWN = ("coords", "x", "y", "z", "normals", "mean-curvature", "gaussian-curvature", "shape-index", "density")


class Changed:
    """A shape that was changed on purpose, and the way back.

    Parameters
    ----------
    shape, faces
        Anything that is a mesh or a cloud; see `adwave.Shape`.
    kind : {'noise', 'rotation', 'scaling', 'resampling', 'other-vertices'}
        Noise along the normals; a random rotation about the origin; every coordinate times a factor; four times the faces, or half of
        a cloud's points; as many other vertices on the same surface with other triangles.
    amount : float
        Of noise its standard deviation in mean edges, of scaling the factor.
    seed : int
        The same seed gives the same change.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> shape = aw.sample("creature", vertices=2000)
    >>> turned = aw.Changed(shape, "rotation", seed=3)
    >>> bool(np.allclose(turned.before(turned.shape.points), shape.points))
    True
    """

    __slots__ = ("_arguments", "_data", "shape")

    def __init__(
        self, shape: object, kind: Kind, amount: float = 1.0, faces: object = None, *, seed: int = 1, **operator: Any
    ) -> None:
        own = prepared(shape, faces, operator)
        self._arguments = (own.shape, kind, amount, seed)
        self._data = _native.ChangeData(own._data, kind, amount, seed)
        self.shape: Shape = Shape._of(self._data.shape)

    def before(self, points: ArrayLike) -> NDArray[np.float64]:
        """Where points of the changed shape were before it was turned and scaled; noise is not undone."""
        return self._data.before(_adapt.points_array(points))

    def __reduce__(self) -> tuple[Any, ...]:
        return _changed_again, self._arguments


def _changed_again(shape: Shape, kind: Kind, amount: float, seed: int) -> Changed:
    return Changed(shape, kind, amount, seed=seed)


class Repeatability(NamedTuple):
    """Which features were found again."""

    changes: NDArray[Any]
    """For each change: change; share of the features found again; right: the share of what was found that is one of them; chance: the
    share that chance would find again."""
    levels: NDArray[Any]
    """For each change and level: change, level, sigma, features, found."""
    features: Features
    """Of the shape as it is."""


def repeatability(
    shape: object,
    faces: object = None,
    *,
    signal: str = "coords",
    noise: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5),
    runs: int = 3,
    within: float = 1.0,
    theta: float = _native.THETA,
    response: Literal["normalized", "literal", "channels", "sigma"] = "normalized",
    border: float | None = None,
    levels: int | None = None,
    lengths: Sequence[Length] | None = None,
    fwhm: Sequence[Length] | None = None,
    progress: ProgressLike = None,
    **operator: Any,
) -> Repeatability:
    """How many features are found again after noise, rotation, scaling, on four times the faces, and on other vertices.

    A feature is found again where one of the same sign and of about the same size is within ``within``·σ.

    Parameters
    ----------
    shape, faces
        Anything that is a mesh or a cloud (see `adwave.Shape`), or a `adwave.Decomposer`.
    signal : str
        What the features are of: a signal that the shape has by itself.
    noise : sequence of float
        Standard deviations of the noise in mean edges.
    runs : int
        How many times each random change is made.
    within : float
        How far off a feature may be, in its σ.
    theta, response, border, levels, lengths, fwhm, **operator
        As for `adwave.features`.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Returns
    -------
    Repeatability

    Notes
    -----
    Levels of the changed shapes have the same widths. By heat (``operator="surface", response="sigma"``) most are found again, by
    the walk few.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> found = aw.repeatability(shape, noise=[0.1], runs=1, operator="surface", response="sigma")
    >>> [str(name) for name in found.changes["change"]]
    ['noise 0.1', 'rotation', 'scaling', 'resampling', 'other-vertices']
    """
    if signal not in _OWN:
        raise ValueError(f"signal: {signal!r} is none of {', '.join(_OWN)}; others are not known on a changed shape")
    if runs < 1:
        raise ValueError(f"runs: {runs}; take at least 1")
    own = prepared(shape, faces, operator, lengths is not None or fwhm is not None)
    options = own._options
    chosen = own.steps(levels=levels, lengths=lengths, fwhm=fwhm, reach=_native.REACH["features"])
    sigma = own.sigma(chosen)
    is_dyadic = lengths is None and fwhm is None
    asked: dict[str, Any] = {"theta": theta, "response": response, "border": border}
    reference = features(own, signal=signal, steps=chosen, **asked)
    kinds: list[tuple[str, Kind, float, int]] = [(f"noise {p:g}", "noise", p, runs) for p in noise]
    kinds.extend(
        [("rotation", "rotation", 1.0, runs), ("scaling", "scaling", 7.3, 1), ("resampling", "resampling", 1.0, 1)]
    )
    if own.shape.kind == "mesh":
        kinds.append(("other-vertices", "other-vertices", 1.0, runs))
    rows: list[tuple[str, float, float, float]] = []
    per_level: list[tuple[str, int, float, int, int]] = []
    total, done = sum(n for *_, n in kinds), 0
    with reporting(progress, "changing") as report:
        for name, kind, amount, n_runs in kinds:
            sums: dict[int, list[int]] = {}
            n_right = n_found = 0
            chance = 0.0
            for seed in range(1, n_runs + 1):
                changed = Changed(own, kind, amount, seed=seed)
                walk = prepared(changed.shape, None, dict(options))
                step = changed._data.length_before(walk._data.lengths()[2])
                if is_dyadic:
                    n_levels = max(3, 1 + round(2 * math.log2(sigma[-1] / step)))
                    again = features(walk, signal=signal, levels=n_levels, **asked)
                else:
                    scale = changed._data.length_before(1.0)
                    again = features(walk, signal=signal, lengths=[s / scale for s in sigma], **asked)
                found, right, by_chance = changed._data.found_again(
                    own._data, _columns(reference), _columns(again), within
                )
                n_right, n_found, chance = n_right + right, n_found + len(again), chance + by_chance / n_runs
                for level, n, n_again in found:
                    sum_of = sums.setdefault(level, [0, 0])
                    sum_of[0], sum_of[1] = sum_of[0] + n, sum_of[1] + n_again
                done += 1
                if report is not None:
                    report(done, total)
            n = sum(of for of, _ in sums.values())
            share = sum(again for _, again in sums.values()) / n if n else math.nan
            rows.append((name, share, n_right / n_found if n_found else math.nan, chance))
            per_level.extend((name, at, float(sigma[at - 1]), sums[at][0], sums[at][1]) for at in sorted(sums))
    kinds_of = [("change", "U24"), ("share", np.float64), ("right", np.float64), ("chance", np.float64)]
    levels_of = [
        ("change", "U24"),
        ("level", np.int32),
        ("sigma", np.float64),
        ("features", np.int64),
        ("found", np.int64),
    ]
    return Repeatability(np.array(rows, dtype=kinds_of), np.array(per_level, dtype=levels_of), reference)


def _columns(found: Features) -> dict[str, NDArray[Any]]:
    names = ("vertex", "position", "level", "sigma", "response", "channel")
    return {name: np.ascontiguousarray(found[name]) for name in names}
