"""Options that travel together: how levels are asked for, how the diffusion is built, how vertices may move."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from importlib import import_module
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypedDict, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from adwave._caller import Call
    from adwave._time import Time

#: A length with a unit, such as "6mm" or "0.5 m".
_UNIT = re.compile(r"\s*([0-9.]+(?:[eE][+-]?[0-9]+)?)\s*[A-Za-zµμ]+\s*")

Length = Union[float, str]
"""A length: a number in model units, or a share of the bounding box's diagonal such as ``"2%"``; the width of a level on
a sphere about the origin may be an arc, ``"5deg"``, or ``"100km/6371"`` on a sphere of that radius."""

SignalLike = Union[str, ArrayLike, None]
"""A signal: None for the coordinates, the name of a signal, or an (n,) or (n, channels) array."""

OperatorKind = Literal["walk", "surface"]

#: Number type of signals that results keep.
Float = TypeVar("Float", np.float16, np.float32, np.float64)


class HasArray(Protocol):
    """Data frames, series, tensors and other objects that become arrays."""

    def __array__(self) -> NDArray[Any]: ...


Numbers = Union[
    NDArray[np.integer[Any]],
    NDArray[np.bool_],
    Sequence[float],
    Sequence[Sequence[float]],
    Sequence[Sequence[Sequence[float]]],
]
"""A signal of numbers whose results are in 64 bits."""


@dataclass(frozen=True, kw_only=True)
class Widths:
    """Levels of given widths. The measure is named, so that a width cannot be taken for the σ of another library.

    Levels by width use heat on the surface (``operator="surface"``) unless an operator is given.

    Parameters
    ----------
    rms : sequence of float or str, optional
        Root mean square distances that one value spreads to, in model units or as a share of the bounding box's
        diagonal such as ``"2%"``, or on a sphere about the origin as an arc, ``"5deg"``. On a surface this is √2 times
        the standard deviation along one axis.
    fwhm : sequence of float or str, optional
        Full widths at half maximum, in the same units: 1.665 times the rms width on a surface.

    Raises
    ------
    ValueError
        If not exactly one of both is given.

    Examples
    --------
    >>> import numpy as np
    >>> import adwave as aw
    >>> shape = aw.sample("sphere", vertices=1000)
    >>> aw.decompose(shape, levels=aw.Widths(fwhm=[0.2, 0.4])).fwhm.round(6)
    array([0.2, 0.4])
    >>> len(aw.Widths(rms=["2%", "4%", "8%"]))
    3
    >>> float(np.degrees(aw.decompose(shape, levels=aw.Widths(fwhm="5deg")).fwhm[0]).round(9))
    5.0
    """

    rms: Union[Sequence[Length], None] = None
    fwhm: Union[Sequence[Length], None] = None

    def __post_init__(self) -> None:
        if (self.rms is None) == (self.fwhm is None):
            raise ValueError("aw.Widths takes exactly one of rms and fwhm")
        for name in ("rms", "fwhm"):
            widths = getattr(self, name)
            if widths is not None:
                object.__setattr__(self, name, tuple(_lengths(widths)))

    def __len__(self) -> int:
        return len(self.rms if self.rms is not None else self.fwhm or ())


@dataclass(frozen=True)
class Steps:
    """Levels of given numbers of steps of the diffusion.

    Parameters
    ----------
    steps : sequence of float
        Ascending numbers of steps n_1 … n_J, integers or not, from 1/64. Between whole numbers of steps the walk may leave
        the range of the signal by a few percent (a mask of 0 and 1 becomes −0.03 … 1.015 at 0.3 steps); heat never does.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.decompose(aw.sample("sphere", vertices=500), levels=aw.Steps([0.5, 3, 10])).steps
    array([ 0.5,  3. , 10. ])
    """

    steps: Sequence[float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", tuple(check_steps(self.steps)))

    def __len__(self) -> int:
        return len(self.steps)


@dataclass(frozen=True)
class Octaves:
    """Dyadic levels with further levels between them.

    Parameters
    ----------
    n_levels : int
        Number of dyadic levels: 1, 2, 4 … steps.
    voices : int
        Levels for each doubling of the steps.

    Examples
    --------
    >>> import adwave as aw
    >>> bands = aw.decompose(aw.sample("sphere", vertices=500), levels=aw.Octaves(6, voices=2))
    >>> bands.n_levels, float(bands.steps[-1])
    (11, 32.0)
    """

    n_levels: int
    voices: int = 2


class LevelOptions(TypedDict, total=False):
    """Short forms of levels.

    Parameters
    ----------
    fwhm : float, str or sequence
        Short for ``levels=aw.Widths(fwhm=…)``.
    steps : float or sequence of float
        Short for ``levels=aw.Steps(…)``.
    """

    fwhm: Union[Length, Sequence[Length]]
    steps: Union[float, Sequence[float]]


class GridFilterOptions(LevelOptions, total=False):
    """Further options of `Grid.filter`.

    Parameters
    ----------
    time : Time
        The frames of a signal, and widths along time.
    """

    time: Union[Time, None]


ValueNoise = Literal["gaussian", "poisson", "multiplicative", "rician"]
"""How the noise of a value depends on the value."""


class GridDenoiseCall(TypedDict, total=False):
    """All keywords of `Grid.denoise`, for type checkers."""

    strength: float
    noise: Union[float, ValueNoise, tuple[ValueNoise, float], None]
    local_fit: Literal["linear", "constant"]
    time: Union[Time, None]
    progress: Union[bool, Callable[[int, int], object], None]


class GridFilterCall(GridFilterOptions, total=False):
    """All keywords of `Grid.filter`, for type checkers."""

    where: Union[str, ArrayLike, None]
    levels: Union[int, Widths, Steps, Octaves, None]
    sigma: Union[float, Sequence[float], None]
    local_fit: Literal["linear", "constant"]
    accuracy: float
    progress: Union[bool, Callable[[int, int], object], None]


LevelsLike = Union[int, Widths, Steps, Octaves, None]
"""Levels: a number of dyadic levels, `Widths`, `Steps` or `Octaves`; None for as many as the shape asks for."""


def levels_of(levels: LevelsLike, options: Mapping[str, Any]) -> LevelsLike:
    """Levels, from their short forms too.

    Raises
    ------
    ValueError
        If they are given twice.
    """
    fwhm, steps = options.get("fwhm"), options.get("steps")
    if fwhm is None and steps is None:
        return levels
    given = {"levels": levels, "fwhm": fwhm, "steps": steps}
    names = [name for name, value in given.items() if value is not None]
    if len(names) > 1:
        raise ValueError(f"levels are given twice, by {' and '.join(names)}; leave one out")
    return Widths(fwhm=fwhm) if steps is None else Steps(steps)


def check_levels(levels: Any) -> LevelsLike:
    """Levels as one of the accepted types.

    Raises
    ------
    TypeError
        If `levels` is of another type.
    """
    if levels is None or isinstance(levels, (Widths, Steps, Octaves)):
        return levels
    if isinstance(levels, (int, np.integer)) and not isinstance(levels, bool):
        if levels < 1:
            raise ValueError(f"levels is the number of levels, at least 1, got {levels}; such as levels=8")
        return int(levels)
    if isinstance(levels, (float, np.floating)):
        raise TypeError(
            f"levels must be a whole number of levels, aw.Widths(...), aw.Steps(...) or aw.Octaves(...), got {levels}; "
            f"a level of that many steps is levels=aw.Steps([{levels}]), of that width levels=aw.Widths(fwhm=[{levels}])"
        )
    numbers = _plain_list(levels)
    if numbers is not None:
        raise TypeError(
            "levels must be a number of levels, aw.Widths(...), aw.Steps(...) or aw.Octaves(...), got a list; for widths "
            f"levels=aw.Widths(fwhm={numbers}), for steps levels=aw.Steps({numbers}){_line_for_list(levels)}"
        )
    raise TypeError(
        f"levels must be a number of levels, aw.Widths(...), aw.Steps(...) or aw.Octaves(...), got {levels!r}"
    )


def _line_for_list(levels: Any) -> str:
    """The user's call with a number of levels for a range of their numbers, with numbers of steps for another list."""

    def change(call: Call) -> None:
        text = call.keywords.get("levels")
        if text is not None:
            call.keywords["levels"] = str(len(levels)) if isinstance(levels, range) else f"{call.package}Steps({text})"

    return import_module("adwave._misfit").line_of_levels(change)


def check_steps(steps: Any) -> list[float]:
    """Numbers of steps as ascending positive numbers.

    Raises
    ------
    TypeError
        If they are no numbers.
    ValueError
        If they are none, not positive, or do not ascend.
    """
    try:
        given = [float(n) for n in np.atleast_1d(np.asarray(steps))]
    except (TypeError, ValueError) as error:
        raise TypeError(f"steps must be numbers of steps such as [1, 2.5, 8], got {steps!r}") from error
    if not given or not all(0 < n < np.inf for n in given) or any(b <= a for a, b in pairwise(given)):
        raise ValueError(f"steps must be positive and ascend, such as [1, 2.5, 8], got {given}")
    return given


def _plain_list(values: Any) -> str | None:
    """A few numbers or lengths as text; None if they are none."""
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        return None
    items = list(values)
    if not items or not all(isinstance(item, (int, float, str, np.number)) for item in items):
        return None
    texts = [repr(item) if isinstance(item, str) else f"{item:g}" for item in items[:6]]
    return f"[{', '.join(texts)}{', …' if len(items) > 6 else ''}]"


def check_word(name: str, given: object, known: Sequence[str]) -> None:
    """Raise ValueError unless an option is one of the known words."""
    if given not in known:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, known))}, got {given!r}")


@dataclass(frozen=True)
class Operator:
    """Options of the diffusion operator Φ₁. Those that are None take the library's default.

    Parameters
    ----------
    kind : {'walk', 'surface'}, optional
        The lazy random walk of the paper, or heat on the surface, whose widths hardly depend on the mesh. By default
        the walk, and heat on the surface if levels are given by width.
    weld : bool or float, optional
        Whether vertices at equal positions count as one in the analysis, and edges of open borders that nearly coincide
        (within a few steps of 32-bit floats) too; or a tolerance for these in model units, 0 for equal positions only.
    rings : int, optional
        Walk on a mesh: number of rings of neighbors in one step.
    neighbors : int, optional
        Point cloud: number of nearest neighbors in one step.
    directed : bool, optional
        Walk on a cloud: step to the nearest neighbors of each point only, as in the paper.
    area : str, optional
        Walk: area of a vertex of a mesh (``'barycentric'``, ``'mixed-voronoi'``) or of a point of a cloud
        (``'kth-neighbor'``, ``'unit'``, ``'tangent-voronoi'``).
    density_invariant : bool, optional
        Walk: remove the effect of the sampling density.
    keep_creases : bool, optional
        Do not step across creases, where the normals turn sharply.

    Examples
    --------
    >>> import adwave as aw
    >>> cloud = aw.sample("torus", vertices=900).points
    >>> aw.Decomposer(cloud, operator=aw.Operator("walk", neighbors=16)).operator
    'walk'
    """

    kind: Union[OperatorKind, None] = None
    weld: Union[bool, float, None] = None
    rings: Union[int, None] = None
    neighbors: Union[int, None] = None
    directed: Union[bool, None] = None
    area: Union[str, None] = None
    density_invariant: Union[bool, None] = None
    keep_creases: Union[bool, None] = None
    exact: Union[bool, None] = field(default=None, init=False)
    end_points: Union[Literal["keep", "free"], None] = field(default=None, init=False)

    def with_free_ends(self) -> Operator:
        """Options under which the ends of a curve are smoothed like other vertices, instead of keeping their values."""
        return self._with("end_points", "free")

    def with_exact_masses(self) -> Operator:
        """Options under which heat on a surface leaves the masses of all vertices as they are.

        By default those of the 1 % of vertices with the fastest exchange are raised, which bounds the time on meshes with
        tiny or thin triangles. `info` has their number (``raised_masses``) and the share of the area that this adds
        (``added_mass``).
        """
        return self._with("exact", True)

    def _with(self, name: str, value: str | bool) -> Operator:
        changed = copy(self)
        object.__setattr__(changed, name, value)
        return changed

    def with_default_kind(self, kind: OperatorKind) -> Operator:
        """Options with this kind if none was given."""
        return self if self.kind is not None else self._with("kind", kind)

    def needs_walk(self) -> bool:
        """True if an option is given that only the walk has."""
        return any(v is not None for v in (self.rings, self.directed, self.area, self.density_invariant))


OperatorLike = Union[OperatorKind, Operator, None]
"""An operator: ``'walk'``, ``'surface'`` or an `Operator` with options; None for the default."""


def as_operator(operator: object) -> Operator:
    """An `Operator` from a name, an `Operator` or None.

    Raises
    ------
    TypeError
        If `operator` is of another type.
    """
    if operator is None:
        return Operator()
    if isinstance(operator, str):
        return Operator(operator)  # type: ignore[arg-type]
    if isinstance(operator, Operator):
        return operator
    raise TypeError(f"operator must be 'walk', 'surface' or aw.Operator(...), got {operator!r}")


@dataclass(frozen=True, kw_only=True)
class Constraints:
    """Constraints on the motion of vertices when the coordinates are filtered.

    Parameters
    ----------
    along : {'free', 'normal', 'surface', 'x', 'y', 'z'}, optional
        Direction in which vertices may move. By default clouds move along their normals, and meshes freely except for
        their open borders; ``'free'`` also frees borders.
    border : {'natural', 'keep', 'free'}
        Treatment of open borders; on a curve ``'free'`` frees the end points too.
    volume : {'free', 'keep'}
        Whether a closed surface keeps its volume, by an offset along the normals.

    Examples
    --------
    >>> import adwave as aw
    >>> plane = aw.sample("plane", vertices=400, noise=0.3)
    >>> flat = aw.filter(plane, "smooth", levels=3, constraints=aw.Constraints(along="z"))
    >>> bool((flat.points[:, :2] == plane.points[:, :2]).all())
    True
    """

    along: Union[Literal["free", "normal", "surface", "x", "y", "z"], None] = None
    border: Literal["natural", "keep", "free"] = "natural"
    volume: Literal["free", "keep"] = "free"

    def __post_init__(self) -> None:
        if self.along is not None:
            check_word("along", self.along, ("free", "normal", "surface", "x", "y", "z"))
        check_word("border", self.border, ("natural", "keep", "free"))
        check_word("volume", self.volume, ("free", "keep"))


@dataclass(frozen=True)
class BandsRequest:
    """A signal, the levels, the accuracy, the local fit and the number format of its bands, as the extension takes them."""

    signal: Union[NDArray[np.float64], None]
    steps: Sequence[float]
    accuracy: float
    local_fit: str = "constant"
    precision: str = "auto"


def _lengths(widths: Any) -> list[Length]:
    each = [widths] if isinstance(widths, str) or np.ndim(widths) == 0 else widths
    for width in each:
        is_arc = isinstance(width, str) and width.strip().endswith("deg")
        if isinstance(width, str) and not is_arc and (unit := _UNIT.fullmatch(width)):
            raise ValueError(
                f"{width!r}: lengths are numbers in the unit of the points{_line_without_unit(width, unit[1])}"
            )
    return [width if isinstance(width, str) else float(width) for width in each]


def _line_without_unit(width: str, number: str) -> str:
    """The user's call with a number for a length with a unit."""

    def change(call: Call) -> None:
        for name, text in call.keywords.items():
            call.keywords[name] = text.replace(f'"{width}"', number).replace(f"'{width}'", number)

    return import_module("adwave._misfit").line_of_levels(change)
