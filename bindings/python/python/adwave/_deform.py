"""`Deformer`, a shape bent by handles with its detail kept; detail carried onto other shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._decomposer import prepare_decomposer
from adwave._layout import vertex_weights
from adwave._options import Length, LevelsLike, OperatorLike
from adwave._part import read_part
from adwave._progress import ProgressLike, report_progress

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._decomposer import Decomposer, Where
    from adwave._part import PartOptions

RegionLike = Union[str, ArrayLike]
"""A region in its text form, a flag or weight for each vertex, or the indices of vertices."""

_TRANSFER = ("onto", "where", "width", "progress")
_SIZE = 4


@dataclass(frozen=True)
class DeformOptions:
    """Regions and stiffness, as the extension takes them."""

    fixed: list[int]
    handles: list[list[int]]
    stiffness: Union[Length, None]


@dataclass(frozen=True)
class CloneOptions:
    """A clone of detail, as the extension takes it."""

    source: int
    target: int
    radius: Length
    angle: float
    first_level: int
    last_level: int


def _vertices(decomposer: Decomposer, region: RegionLike | None, name: str) -> list[int]:
    """Vertices of a region: those with a weight above 0."""
    if region is None:
        return []
    if isinstance(region, str):
        return np.flatnonzero(decomposer.region(region) > 0).tolist()
    return np.flatnonzero(vertex_weights(region, decomposer.shape.n_vertices, name) > 0).tolist()


class Deformer:
    """A shape whose coarse base bends by handles while its detail rides along in turning frames.

    ``f' = S_J' + R (f - S_J)``: the base S_J of the last level moves by affine maps of nodes, blended over it, such that it
    stretches and bends as little as possible (`sorkine2007`, `sumner2007`). `Shape.deformer` and `Decomposer.deformer`
    create it.

    Notes
    -----
    Handles follow their motions exactly, up to rounding. Parts without a handle follow the nearest part that has one. A
    step costs the same on any number of vertices; `points` costs O(n).

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

    def __init__(
        self,
        decomposer: Decomposer,
        handles: Sequence[RegionLike],
        *,
        fixed: RegionLike | None = None,
        levels: LevelsLike = None,
        stiffness: Length | None = None,
        progress: ProgressLike = None,
    ) -> None:
        own = decomposer.for_levels(levels)
        if isinstance(handles, str):
            raise TypeError("handles must be a sequence of regions, got one str; put it into a list")
        regions = [_vertices(own, handle, f"handles[{i}]") for i, handle in enumerate(handles)]
        options = DeformOptions(_vertices(own, fixed, "fixed"), regions, stiffness)
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
        given = np.asarray(motion, dtype=np.float64)
        matrix = np.eye(_SIZE)
        if given.shape == (3,):
            matrix[:3, 3] = given
        elif given.shape in ((3, _SIZE), (_SIZE, _SIZE)):
            matrix[: len(given)] = given
        else:
            raise ValueError(f"motion must have shape (3,), (3, 4) or (4, 4), got {given.shape}")
        self._data.set(handle, matrix.tolist())
        self._is_moved = True

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
    """

    points: NDArray[np.float64]
    n_changed: int
    n_without_source: int
    distortion: float


def transfer(
    shape: object,
    *,
    onto: object,
    where: Where = None,
    width: Length = "2%",
    progress: ProgressLike = None,
    **options: Unpack[PartOptions],
) -> Any:
    """Carry the detail of a shape onto another mesh or cloud of the same surface, in the same place.

    Both are smoothed by heat to the same width. Each vertex of `onto` keeps its place on its own smooth base and takes the
    detail of `shape` at the nearest place there, turned between the normals.

    Parameters
    ----------
    shape : shape_like
        Shape whose detail is taken; see `Shape`.
    onto : shape_like
        Shape that takes the detail.
    where : str or (n,) array_like, optional
        A region of `onto`, or a weight for each of its vertices; everywhere by default.
    width : float or str
        Width σ below which detail is taken, in model units or as a share of the diagonal of `onto`.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
    **options
        ``faces=``, and ``mask=`` or ``only=`` of `shape`.

    Returns
    -------
    object like `onto`
        With new positions. Vertices farther than the width from the smooth `shape` keep their own.

    Raises
    ------
    ValueError
        If a shape has no positions or the width is no length.

    Examples
    --------
    >>> import adwave as aw
    >>> fine = aw.sample("creature", vertices=4000)
    >>> coarse = aw.simplify(aw.smooth(fine, steps=16), ratio=0.8).shape
    >>> detailed = aw.transfer(fine, onto=coarse)
    >>> detailed.n_vertices == coarse.n_vertices
    True
    """
    source = read_part("transfer", shape, options, _TRANSFER)
    target = read_part("transfer", onto, {}, _TRANSFER)
    own = target.shape
    first = prepare_decomposer(source.shape, "surface")
    second = prepare_decomposer(own, "surface")
    weights = None
    if where is not None:
        weights = second.region(where) if isinstance(where, str) else vertex_weights(where, own.n_vertices)
    with report_progress(progress, "splitting") as report:
        points, _, _, _ = _native.transfer(first._data, second._data, width, weights, report)
    return target.moved(own._with_positions(points))


def morph(
    a: object,
    b: object,
    t: float,
    *,
    by_band: Sequence[float] | None = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    progress: ProgressLike = None,
) -> Any:
    """Blend two shapes with the same vertices and faces, band by band.

    Bases are blended along straight lines, and detail turns from both to the blend.

    Parameters
    ----------
    a, b : shape_like
        The shapes at ``t = 0`` and ``t = 1``; see `Shape`.
    t : float
        Share of `b` in the base, and in all bands without one in `by_band`. Shares beyond [0, 1] exaggerate.
    by_band : sequence of float, optional
        Shares of `b` in the bands, from the finest on.
    levels : int, Widths, Steps or Octaves, optional
        By default until a level is 2 % of the diagonal wide.
    operator : str or Operator, optional
        How positions are smoothed; see `Decomposer`.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    object like `a`
        With new positions.

    Raises
    ------
    ValueError
        If vertices or faces differ, or a share is not finite.

    Examples
    --------
    >>> import adwave as aw
    >>> a = aw.sample("creature", vertices=2000)
    >>> b = aw.smooth(a, steps=16)
    >>> rough_b = aw.morph(a, b, 1.0, by_band=[0, 0], levels=4)
    >>> rough_b.n_vertices == a.n_vertices
    True
    """
    part = read_part("morph", a, {}, ())
    first = prepare_decomposer(part.shape, operator, levels)
    second = prepare_decomposer(read_part("morph", b, {}, ()).shape, operator, levels)
    steps = first.schedule(levels)
    given = [] if by_band is None else [float(share) for share in by_band]
    if len(given) > len(steps):
        raise ValueError(f"by_band must have at most {len(steps)} shares, one per band, got {len(given)}")
    shares = [*given, *[float(t)] * (len(steps) + 1 - len(given))]
    with report_progress(progress, "splitting") as report:
        points = _native.morph(first._data, second._data, steps, shares, report)
    return part.moved(part.shape._with_positions(points))
