"""Shapes changed on purpose, and which of their features are found again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._caller import public
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._measures import FeatureOptions, Features, features
from adwave._options import LevelsLike, Octaves, OperatorLike, Steps, Widths
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape

ChangeKind = Literal["noise", "rotation", "scaling", "resampling", "other-vertices"]
#: Signals computed from the shape alone, so that a changed shape has them too.
_COMPUTED_SIGNALS = (
    "coords",
    "x",
    "y",
    "z",
    "normals",
    "mean-curvature",
    "gaussian-curvature",
    "shape-index",
    "density",
)


class ChangedShape:
    """A shape changed on purpose, with the way back.

    Parameters
    ----------
    shape : shape_like
        Anything that is a mesh or a cloud (see `adwave.Shape`), or an `adwave.Decomposer`.
    kind : {'noise', 'rotation', 'scaling', 'resampling', 'other-vertices'}
        Noise along the normals; a random rotation about the origin; every coordinate multiplied by a factor; four times
        the faces, or half of a cloud's points; as many other vertices on the same surface with other triangles.
    amount : float
        Standard deviation of the noise in mean edges, or the factor of the scaling.
    seed : int
        The same seed gives the same change.
    operator : str or Operator, optional
        As in `decompose`.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> shape = aw.sample("creature", vertices=2000)
    >>> turned = aw.ChangedShape(shape, "rotation", seed=3)
    >>> bool(np.allclose(turned.undo_motion(turned.shape.points), shape.points))
    True
    """

    __slots__ = ("_arguments", "_data", "shape")

    def __init__(
        self,
        shape: object,
        kind: ChangeKind,
        amount: float = 1.0,
        *,
        seed: int = 1,
        operator: OperatorLike = None,
    ) -> None:
        own = prepare_decomposer(shape, operator)
        self._arguments = (own.shape, kind, amount, seed)
        self._data = _native.ChangeData(own._data, kind, amount, seed)
        self.shape: Shape = Shape._from_data(self._data.shape)

    def undo_motion(self, points: ArrayLike) -> NDArray[np.float64]:
        """Positions of points of the changed shape before it was rotated and scaled; noise is not undone.

        Parameters
        ----------
        points : (k, 3) array_like
            Points of the changed shape.

        Returns
        -------
        (k, 3) array
        """
        return self._data.undo_motion(_adapt.points_array(points))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_changed_shape, self._arguments


def _restore_changed_shape(shape: Shape, kind: ChangeKind, amount: float, seed: int) -> ChangedShape:
    return ChangedShape(shape, kind, amount, seed=seed)


class Repeatability(NamedTuple):
    """Features that were found again.

    Attributes
    ----------
    changes : structured array
        For each change: change; share of the features found again; right: share of the found features that are among the
        original ones; chance: share that chance would find again.
    levels : structured array
        For each change and level: change, level, sigma (rms width, model units), features, found.
    features : Features
        Features of the unchanged shape.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.repeatability(aw.sample("creature", vertices=2000), trials=aw.Trials(noise=[], runs=1))
    >>> found.levels.dtype.names
    ('change', 'level', 'sigma', 'features', 'found')
    """

    changes: NDArray[Any]
    levels: NDArray[Any]
    features: Features


@dataclass(frozen=True, kw_only=True)
class Trials:
    """Changes that `repeatability` makes.

    Parameters
    ----------
    noise : sequence of float
        Standard deviations of the noise in mean edges.
    runs : int
        Number of runs of each random change.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.Trials(noise=[0.1, 0.2], runs=1).runs
    1
    """

    noise: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5)
    runs: int = 3


@public()
def repeatability(
    shape: object,
    *,
    signal: str = "coords",
    trials: Trials | None = None,
    within: float = 1.0,
    theta: float | None = None,
    options: FeatureOptions | None = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    progress: ProgressLike = None,
) -> Repeatability:
    """Share of the features that are found again after noise, rotation, scaling, refinement, and with other vertices.

    A feature is found again if one of the same sign and of about the same size lies within ``within`` times its rms width.

    Parameters
    ----------
    shape : shape_like
        Anything that is a mesh or a cloud (see `adwave.Shape`), or an `adwave.Decomposer`.
    signal : str
        Signal of the features: one that is computed from the shape alone.
    trials : Trials, optional
        Amounts of noise, and number of runs.
    within : float
        Largest distance of a feature that is found again, in its rms widths.
    theta : float, optional
        As in `adwave.features`.
    options : FeatureOptions, optional
        As in `adwave.features`; only response and border are used.
    levels : int or Widths, optional
        As in `adwave.features`.
    operator : str or Operator, optional
        As in `adwave.decompose`.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    Repeatability

    Raises
    ------
    ValueError
        If the signal is not computed from the shape, or an option is invalid.

    Notes
    -----
    Levels of the changed shapes have the same widths. By heat (``operator="surface"`` with the response ``"sigma"``) most
    features are found again, by the walk few.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> by_width = aw.FeatureOptions(response="sigma")
    >>> trials = aw.Trials(noise=[0.1], runs=1)
    >>> found = aw.repeatability(shape, trials=trials, operator="surface", options=by_width)
    >>> [str(name) for name in found.changes["change"]]
    ['noise 0.1', 'rotation', 'scaling', 'resampling', 'other-vertices']
    """
    trials = trials or Trials()
    if signal not in _COMPUTED_SIGNALS:
        raise ValueError(f"signal must be one of {', '.join(_COMPUTED_SIGNALS)}, got {signal!r}")
    if trials.runs < 1:
        raise ValueError(f"runs must be at least 1, got {trials.runs}")
    if isinstance(levels, (Octaves, Steps)):
        raise ValueError("levels: numbers of steps differ between meshes; give a number of levels or aw.Widths(...)")
    own = prepare_decomposer(shape, operator, levels, analysis=True)
    steps = own.schedule(levels, extent=own._data.feature_extent())
    given = options or FeatureOptions()
    used = FeatureOptions(response=given.response, border=given.border)

    def find(decomposer: Decomposer, levels: LevelsLike) -> Features:
        return features(decomposer, signal=signal, theta=theta, options=used, levels=levels)

    study = _Study(own, own.measure_widths(steps), not isinstance(levels, Widths), within, find)
    return study.run(trials, find(own, Steps(steps)), progress)


@dataclass(frozen=True)
class _Study:
    """A shape whose features are looked for again on changed shapes."""

    decomposer: Decomposer
    widths: NDArray[np.float64]
    is_dyadic: bool
    within: float
    find: Callable[[Decomposer, LevelsLike], Features]

    def changes(self, trials: Trials) -> list[tuple[str, ChangeKind, float, int]]:
        """Name, kind, amount and number of runs of each change."""
        kinds: list[tuple[str, ChangeKind, float, int]] = []
        kinds.extend((f"noise {p:g}", "noise", p, trials.runs) for p in trials.noise)
        kinds.append(("rotation", "rotation", 1.0, trials.runs))
        kinds.append(("scaling", "scaling", 7.3, 1))
        kinds.append(("resampling", "resampling", 1.0, 1))
        if self.decomposer.shape.kind == "mesh":
            kinds.append(("other-vertices", "other-vertices", 1.0, trials.runs))
        return kinds

    def features_again(self, changed: ChangedShape) -> Features:
        """Features of the changed shape, on levels of the same widths as those of the original."""
        walk = Decomposer(changed.shape, operator=self.decomposer._options)
        if self.is_dyadic:
            step = changed._data.length_before(walk._data.lengths()[2])
            return self.find(walk, max(3, 1 + round(2 * math.log2(self.widths[-1] / step))))
        scale = changed._data.length_before(1.0)
        return self.find(walk, Widths(rms=[width / scale for width in self.widths]))

    def run(self, trials: Trials, reference: Features, progress: ProgressLike) -> Repeatability:
        """Tables of the features that are found again, by change and by level."""
        kinds = self.changes(trials)
        rows: list[tuple[str, float, float, float]] = []
        per_level: list[tuple[str, int, float, int, int]] = []
        total, done = sum(n for *_, n in kinds), 0
        with report_progress(progress, "changing") as report:
            for name, kind, amount, n_runs in kinds:
                counts: dict[int, list[int]] = {}
                n_right = n_found = 0
                chance = 0.0
                for seed in range(1, n_runs + 1):
                    changed = ChangedShape(self.decomposer, kind, amount, seed=seed)
                    again = self.features_again(changed)
                    found, right, by_chance = changed._data.find_repeated(
                        self.decomposer._data, _columns(reference), _columns(again), self.within
                    )
                    n_right, n_found, chance = n_right + right, n_found + len(again), chance + by_chance / n_runs
                    for level, n, n_again in found:
                        count = counts.setdefault(level, [0, 0])
                        count[0], count[1] = count[0] + n, count[1] + n_again
                    done += 1
                    if report is not None:
                        report(done, total)
                n = sum(n_features for n_features, _ in counts.values())
                share = sum(n_again for _, n_again in counts.values()) / n if n else math.nan
                rows.append((name, share, n_right / n_found if n_found else math.nan, chance))
                per_level.extend(
                    (name, at, float(self.widths[at - 1]), counts[at][0], counts[at][1]) for at in sorted(counts)
                )
        return Repeatability(np.array(rows, dtype=_CHANGE), np.array(per_level, dtype=_LEVEL), reference)


_CHANGE = [("change", "U24"), ("share", np.float64), ("right", np.float64), ("chance", np.float64)]
_LEVEL = [
    ("change", "U24"),
    ("level", np.int32),
    ("sigma", np.float64),
    ("features", np.int64),
    ("found", np.int64),
]


def _columns(found: Features) -> dict[str, NDArray[Any]]:
    names = ("vertex", "position", "level", "sigma", "response", "channel")
    # Copies: a column of one feature is contiguous, but not aligned.
    return {name: np.array(found[name], order="C") for name in names}
