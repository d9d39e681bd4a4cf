"""Detail carried onto another shape, and shapes blended band by band."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from adwave import _native
from adwave._caller import public
from adwave._decomposer import Where, prepare_decomposer
from adwave._layout import region_weights
from adwave._options import Length, LevelsLike, OperatorLike
from adwave._part import read_part
from adwave._progress import ProgressLike, report_progress

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._part import PartOptions

_TRANSFER = ("onto", "where", "width", "progress")


@public()
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
        weights = second.region(where) if isinstance(where, str) else region_weights(where, own.n_vertices)
    with report_progress(progress, "splitting") as report:
        points, _, _, _ = _native.transfer(first._data, second._data, width, weights, report)
    return target.moved(own._with_positions(points))


@public(a="first", b="second", t="share")
def morph(
    first: object,
    second: object,
    share: float,
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
    first, second : shape_like
        The shapes at the shares 0 and 1; see `Shape`.
    share : float
        Share of `second` in the base, and in all bands without one in `by_band`. Shares beyond [0, 1] exaggerate.
    by_band : sequence of float, optional
        Shares of `second` in the bands, from the finest on.
    levels : int, Widths, Steps or Octaves, optional
        By default until a level is 2 % of the diagonal wide.
    operator : str or Operator, optional
        How positions are smoothed; see `Decomposer`.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    object like `first`
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
    part = read_part("morph", first, {}, ())
    one = prepare_decomposer(part.shape, operator, levels)
    other = prepare_decomposer(read_part("morph", second, {}, ()).shape, operator, levels)
    steps = one.schedule(levels)
    given = [] if by_band is None else [float(each) for each in by_band]
    if len(given) > len(steps):
        raise ValueError(f"by_band must have at most {len(steps)} shares, one per band, got {len(given)}")
    shares = [*given, *[float(share)] * (len(steps) + 1 - len(given))]
    with report_progress(progress, "splitting") as report:
        points = _native.morph(one._data, other._data, steps, shares, report)
    return part.moved(part.shape._with_positions(points))
