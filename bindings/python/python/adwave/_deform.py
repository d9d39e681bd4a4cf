"""`Deformer`, a shape bent by handles with its detail kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import public, warn
from adwave._layout import vertex_weights
from adwave._options import Length, LevelsLike
from adwave._progress import ProgressLike, report_progress

RegionLike = Union[str, ArrayLike]
"""A region in its text form, a flag or weight for each vertex, or the indices of vertices."""

_SIZE = 4


@dataclass(frozen=True)
class DeformOptions:
    """Regions, stiffness and share of lengths, as the extension takes them."""

    fixed: list[int]
    handles: list[list[int]]
    stiffness: Union[Length, None]
    keep_lengths: float


@dataclass(frozen=True)
class CloneOptions:
    """A clone of detail, as the extension takes it."""

    source: int
    target: int
    radius: Length
    angle: float
    first_level: int
    last_level: int


class BoundShape(Protocol):
    """Interface of a `Decomposer` that a `Deformer` uses."""

    @property
    def _data(self) -> _native.Prepared: ...
    @property
    def n_vertices(self) -> int: ...
    def for_levels(self, levels: LevelsLike) -> BoundShape: ...
    def schedule(self, levels: LevelsLike) -> list[float]: ...
    def region(self, region: Any) -> NDArray[np.float64]: ...


def _vertices(decomposer: BoundShape, region: RegionLike | None, name: str) -> list[int]:
    """Vertices of a region: those with a weight above 0."""
    if region is None:
        return []
    if isinstance(region, str):
        return np.flatnonzero(decomposer.region(region) > 0).tolist()
    return np.flatnonzero(vertex_weights(region, decomposer.n_vertices, name) > 0).tolist()


def _fixed_first(arguments: tuple[Any, ...], options: dict[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments of `Deformer` with what is fixed before the handles; the former order is taken with a warning."""
    if len(arguments) == 3 and "handles" not in options:
        warn(
            "Deformer(decomposer, handles, fixed=…) is now Deformer(decomposer, fixed, handles), and will go in the next "
            "release",
            DeprecationWarning,
        )
        options = dict(options)
        return (*arguments[:2], options.pop("fixed", None), arguments[2]), options
    return arguments, options


def _matrix(motion: ArrayLike) -> list[list[float]]:
    """A motion as a 4 × 4 matrix."""
    given = np.asarray(motion, dtype=np.float64)
    matrix = np.eye(_SIZE)
    if given.shape == (3,):
        matrix[:3, 3] = given
    elif given.shape in ((3, _SIZE), (_SIZE, _SIZE)):
        matrix[: len(given)] = given
    else:
        raise ValueError(f"motion must have shape (3,), (3, 4) or (4, 4), got {given.shape}")
    return matrix.tolist()


class Crossing(NamedTuple):
    """Place where a deformed surface crosses itself.

    Attributes
    ----------
    vertex : int
        A vertex of the place.
    point : (3,) array
        Its middle in model units.
    n_pairs : int
        Number of pairs of triangles that pierce each other.

    Examples
    --------
    >>> import adwave as aw
    >>> import numpy as np
    >>> aw.Crossing(7, np.zeros(3), 4).n_pairs
    4
    """

    vertex: int
    point: NDArray[np.float64]
    n_pairs: int


class Deformer:
    """A shape whose coarse base bends by handles while its detail rides along in turning frames.

    ``f' = S_J' + R (f - S_J)``: the base S_J of the last level moves by affine maps of nodes, blended over it, such that it
    stretches and bends as little as possible (`sorkine2007`, `sumner2007`). `Shape.deformer` and `Decomposer.deformer`
    create it.

    Notes
    -----
    Handles follow their motions exactly, up to rounding. Parts without a handle follow the nearest part that has one. A
    step costs the same on any number of vertices; `points` costs O(n).

    With ``keep_lengths`` above 0, `solve` then moves each vertex so that edges keep their lengths: 1 keeps them as well as
    as-rigid-as-possible deformation does, values between weigh them against the detail. `step` shows the shape for 0.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=3000)
    >>> feet, head = "half-space:point=0 0.4 0,normal=0 -1 0", "half-space:point=0 1.6 0,normal=0 1 0"
    >>> d = shape.deformer(feet, [head])
    >>> d.move(0, [0.1, 0.2, 0.0])
    >>> d.points.shape == shape.points.shape
    True
    """

    __slots__ = ("_data", "_is_moved", "info")

    #: Number of nodes, width of the base and bending length in model units, and parts without a handle with their vertices.
    info: dict[str, Any]

    @public(_fixed_first)
    def __init__(
        self,
        decomposer: BoundShape,
        fixed: RegionLike | None,
        handles: Sequence[RegionLike],
        *,
        levels: LevelsLike = None,
        stiffness: Length | None = None,
        keep_lengths: float = 0.0,
        progress: ProgressLike = None,
    ) -> None:
        own = decomposer.for_levels(levels)
        if isinstance(handles, str):
            raise TypeError("handles must be a sequence of regions, got one str; put it into a list")
        regions = [_vertices(own, handle, f"handles[{i}]") for i, handle in enumerate(handles)]
        options = DeformOptions(_vertices(own, fixed, "fixed"), regions, stiffness, float(keep_lengths))
        with report_progress(progress, "binding") as report:
            steps = _native.base_steps(own._data) if levels is None else own.schedule(levels)
            self._data = _native.DeformerData(own._data, steps, options, report)
        self._is_moved = False
        self.info = self._data.info()

    def move(self, handle: int, motion: ArrayLike) -> None:
        """Set the motion of a handle, from the shape at rest.

        Parameters
        ----------
        handle : int
            Number of the handle, counted from 0.
        motion : (3,) or (3, 4) or (4, 4) array_like
            A translation in model units, or an affine map, whose determinant is positive.

        Raises
        ------
        ValueError
            If there is no such handle, or the motion mirrors or is not finite.
        """
        self._data.set(handle, _matrix(motion))
        self._is_moved = True

    def blend(self, handle: int, motions: Sequence[ArrayLike], shares: Sequence[float]) -> None:
        """Set the motion of a handle to a blend of the motions that it has in several poses.

        Rotations are blended as rotations, so that a limb swings from pose to pose and keeps its length on the way. The
        pose at rest has what the shares leave to 1.

        Parameters
        ----------
        handle : int
            Number of the handle, counted from 0.
        motions : sequence of array_like
            Motion of the handle in each pose, as `move` takes them.
        shares : sequence of float
            Share of each pose; shares beyond [0, 1] exaggerate.

        Raises
        ------
        ValueError
            If there is no such handle, the numbers of motions and shares differ, or a motion mirrors.

        Examples
        --------
        >>> import adwave as aw
        >>> shape = aw.sample("creature", vertices=2000)
        >>> d = shape.deformer(None, ["half-space:point=0 1.6 0,normal=0 1 0"])
        >>> d.blend(0, [[0.2, 0.0, 0.0], [0.0, 0.0, 0.4]], [0.5, 0.25])
        >>> (d.points - shape.points).mean(axis=0).round(3).tolist()
        [0.1, 0.0, 0.1]
        """
        self._data.set_blend(handle, [_matrix(motion) for motion in motions], [float(share) for share in shares])
        self._is_moved = True

    def crossings(self) -> list[Crossing]:
        """Places where triangles of the deformed shape cross and did not before, the largest first.

        Returns
        -------
        list of Crossing
            ``vertex``, ``point`` and ``n_pairs`` of each; empty for a cloud.

        Examples
        --------
        >>> import adwave as aw
        >>> shape = aw.sample("creature", vertices=2000)
        >>> d = shape.deformer(None, ["half-space:point=0 1.6 0,normal=0 1 0"])
        >>> d.crossings()
        []
        """
        if self._is_moved:
            self.solve()
        return [Crossing(vertex, np.array(point), n_pairs) for vertex, point, n_pairs in self._data.crossings()]

    def step(self) -> dict[str, Any]:
        """One step toward the handles, for use while one is dragged; `points` then solves no further.

        Returns
        -------
        dict
            ``energy``, ``steps``, ``products`` and ``converged``.
        """
        self._is_moved = False
        return self._data.step()

    def solve(self, progress: ProgressLike = None) -> dict[str, Any]:
        """Steps until the shape has come to rest; `points` does it after a `move`.

        Parameters
        ----------
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        dict
            ``energy``, ``steps``, ``products`` and ``converged``.
        """
        with report_progress(progress, "bending") as report:
            found = self._data.solve(report)
        self._is_moved = False
        return found

    @property
    def points(self) -> NDArray[np.float64]:
        """Positions of the deformed shape, (n, 3); solves first if a handle was moved since."""
        if self._is_moved:
            self.solve()
        return self._data.points()

    @property
    def rotations(self) -> NDArray[np.float64]:
        """Rotation of the frame of each vertex, (n, 4): unit quaternions w, x, y, z."""
        if self._is_moved:
            self.solve()
        return self._data.rotations()


class CloneResult(NamedTuple):
    """Positions after detail was cloned.

    Attributes
    ----------
    points : (n, 3) array
        New positions.
    n_changed : int
        Number of vertices that received detail.
    n_without_source : int
        Number of vertices for which the source has no detail, as beyond a border.
    distortion : float
        Largest stretch of the target's neighborhood against its map: 1 where it is flat, more on a tip.

    Examples
    --------
    >>> import adwave as aw
    >>> bands = aw.decompose(aw.sample("creature", vertices=2000), levels=5)
    >>> bands.clone_detail(0, 900, "10%").n_changed > 0
    True
    """

    points: NDArray[np.float64]
    n_changed: int
    n_without_source: int
    distortion: float
