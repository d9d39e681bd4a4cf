"""`GridBase`: values of an image or a volume in their axes, and what is measured on them."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave._caller import Call, public, warn
from adwave._decomposer import Decomposer, GainsLike
from adwave._edits import filter_labels
from adwave._grid_checks import cast_values, check_flags, check_spacings, find_kept_places, levels_by_sigma
from adwave._grid_domain import GridDecomposer, Values
from adwave._grid_layout import GridLayout, grid_axes, plain_array
from adwave._grid_objects import find_grid, results_like
from adwave._image_data import scalars_of
from adwave._layout import Layout, float_type
from adwave._measures import FeatureOptions, Features, Saliency, SaliencyOptions, Weighting, features, saliency
from adwave._methods import Members
from adwave._misfit import working_line
from adwave._options import LevelsLike
from adwave._progress import ProgressLike
from adwave._time import Time, frames_axis

if TYPE_CHECKING:
    from typing_extensions import Self

#: Kind of the results for the values of the grid itself.
_Own = TypeVar("_Own")


def array_by_name(arguments: tuple[Any, ...], options: dict[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments of a method of `Grid` without a signal, for the grid of the array that the signal names."""
    grid, *rest = arguments
    if rest and isinstance(rest[0], str):
        return (grid._with_array(rest[0]), None, *rest[1:]), options
    if isinstance(options.get("signal"), str):
        return (grid._with_array(options["signal"]), *rest), {**options, "signal": None}
    return arguments, options


class GridBase(Members, Generic[_Own]):
    """An image or a volume as a domain: its values, its axes, and measures of them."""

    __slots__ = (
        "_decomposer",
        "_found",
        "_given",
        "_kept",
        "_layout",
        "_original",
        "_values",
        "keep_dtype",
        "periodic",
        "spacing",
    )

    #: Distance between places along each axis of the grid.
    spacing: tuple[float, ...]
    #: Whether each axis of the grid repeats.
    periodic: tuple[bool, ...]
    #: Whether results have the number type of a signal of integers; they always have that of floats.
    keep_dtype: bool

    @public()
    def __init__(
        self,
        array: object,
        spacing: float | Sequence[float] | None = None,
        mask: object = None,
        periodic: bool | Sequence[bool] = False,
        *,
        axes: int | str | Sequence[int] | Sequence[str] | None = None,
        keep_dtype: bool = False,
    ) -> None:
        found = find_grid(array, axes)
        self._values = plain_array(found.values)
        # With the entries under a mask and in the number type that it had.
        self._original = np.ma.getdata(found.values) if isinstance(found.values, np.ndarray) else self._values
        given = axes if found.axes is None else found.axes
        self._layout = GridLayout.for_axes(self._values.shape, grid_axes(self._values.shape, given))
        self._given, self._found = array, replace(found, values=None)
        own = tuple(found.spacing_of(axis) for axis in self._layout.axes)
        self.spacing = own if spacing is None else check_spacings(spacing, self._layout)
        self.periodic = check_flags(periodic, self._layout)
        self.keep_dtype = bool(keep_dtype)
        self._kept = None if mask is None else find_kept_places(mask, found, self._layout)
        self._decomposer: GridDecomposer | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of places along each axis of the grid, without channels."""
        return self._layout.sizes

    @property
    def ndim(self) -> int:
        """Number of axes of the grid, 1 to 3."""
        return len(self._layout.sizes)

    @property
    def n_vertices(self) -> int:
        """Number of places."""
        return self._layout.n_vertices

    @property
    def n_places(self) -> int:
        """Former name of `n_vertices`."""
        warn("Grid.n_places is now Grid.n_vertices", DeprecationWarning)
        return self.n_vertices

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes of the array that are those of the grid; the others are channels."""
        return self._layout.axes

    @property
    def mask(self) -> NDArray[np.bool_] | None:
        """True at places with data, in the shape of the grid; None if all are."""
        return None if self._kept is None else self._kept.reshape(self.shape)

    def prepare(self) -> Decomposer:
        """The grid as an `adwave.Decomposer`, which keeps its operator for many requests.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> aw.grid(np.zeros((8, 9))).prepare().n_vertices
        72
        """
        if self._decomposer is None:
            self._decomposer = GridDecomposer(self)
        return self._decomposer

    def _as_domain(self) -> Decomposer:
        """The grid as a domain, which functions of shapes take in its place."""
        return self.prepare()

    @public(array_by_name)
    def saliency(
        self,
        signal: str | ArrayLike | None = None,
        *,
        weighting: Weighting = "signed",
        options: SaliencyOptions | None = None,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float | None = None,
        progress: ProgressLike = None,
    ) -> Saliency:
        """Map where a signal stands out over all levels, + above its surroundings and − below; see `adwave.saliency`.

        Parameters
        ----------
        signal : array_like, optional
            As in `decompose`.
        weighting, options
            As in `adwave.saliency`.
        levels, sigma, accuracy, progress
            As in `decompose`; by default until a level is 16 % of the diagonal wide.

        Returns
        -------
        Saliency
            An array of the shape of the grid, NaN outside the mask.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> spot = np.zeros((32, 32))
        >>> spot[12, 20] = 1
        >>> found = aw.grid(spot).saliency()
        >>> found.shape, np.unravel_index(found.argmax(), found.shape) == (12, 20)
        ((32, 32), True)
        """
        wanted = levels_by_sigma("saliency", levels, sigma, {})
        return saliency(
            self.prepare(),
            self._signal(signal),
            weighting=weighting,
            options=options,
            levels=wanted,
            accuracy=accuracy,
            progress=progress,
        )

    @public(array_by_name)
    def features(
        self,
        signal: str | ArrayLike | None = None,
        *,
        theta: float | None = None,
        best: int | None = None,
        options: FeatureOptions | None = None,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float | None = None,
        progress: ProgressLike = None,
    ) -> Features:
        """Find the places where a level stands out among its neighbors in space and in scale; see `adwave.features`.

        Parameters
        ----------
        signal : array_like, optional
            As in `decompose`.
        theta, best
            As in `adwave.features`.
        options : FeatureOptions, optional
            As in `adwave.features`. With ``theta`` the response is by default the band itself, a difference of Gaussians
            (``response='literal'``), since the mean of a level, by which others divide, is that of the background.
        levels, sigma, accuracy, progress
            As in `decompose`; by default until a level is 10 % of the diagonal wide.

        Returns
        -------
        Features
            A table. ``vertex`` counts places in the order of the values (`numpy.unravel_index` gives the indices),
            ``position`` is in the unit of the spacing from the first place, and ``sigma`` is the standard deviation of a
            Gaussian spot of that size. Without ``theta`` and ``options`` only those are returned that noise, measured
            around each place on the finest levels, does not explain.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> i, j = np.mgrid[:64, :64]
        >>> spot = np.exp(-((i - 20) ** 2 + (j - 40) ** 2) / 18)
        >>> found = aw.grid(spot).features(best=1, levels=8)
        >>> found["position"].tolist()
        [[20.0, 40.0, 0.0]]
        """
        wanted = levels_by_sigma("features", levels, sigma, {})
        return features(
            self.prepare(),
            self._signal(signal),
            theta=theta,
            best=best,
            options=options or (None if theta is None else FeatureOptions(response="literal")),
            levels=wanted,
            accuracy=accuracy,
            progress=progress,
        )

    def filter_labels(self, labels: ArrayLike, gains: GainsLike, **options: Any) -> Values:
        """Change labels by filtering the share of each label; see `adwave.filter_labels`.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> labels = np.zeros((5, 5))
        >>> labels[2, 2] = 1
        >>> float(aw.grid(labels).filter_labels(labels, [0, 0]).max())
        0.0
        """
        return filter_labels(self.prepare(), labels, gains, **options)  # type: ignore[arg-type]

    def region(self, region: str | ArrayLike) -> Values:
        """Weights of a region, in the shape of the grid; see `Decomposer.region`.

        Points and lengths are in the unit of the spacing, from the first place.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> grid = aw.grid(np.zeros((5, 5)), spacing=2.0)
        >>> int(grid.region("ball:point=4 4 0,radius=4,falloff=0.1").sum())
        9
        """
        return self.prepare().region(region)

    def _with_array(self, name: str) -> Self:
        """This grid with another array of its image.

        Raises
        ------
        ValueError
            If the image has none of this name, or the object has no names.
        """
        if self._found.library != "pyvista":
            raise ValueError(f"signal: a grid has no named signals, got {name!r}; give an array of shape {self.shape}")
        found = scalars_of(self._given, name)
        spacing = self.spacing if found.sizes == self.shape else None
        return type(self)(found, spacing, self.mask, self.periodic, keep_dtype=self.keep_dtype)

    def _with_spacing(self, spacing: tuple[float, ...]) -> Self:
        """This grid with other distances between places."""
        return type(self)(self._given, spacing, self.mask, self.periodic, axes=self.axes, keep_dtype=self.keep_dtype)

    def _signal(self, signal: Any) -> Any:
        """A signal of a method: the grid's own values by default."""
        if signal is None:
            return self._values
        if np.ndim(signal) == 0 and not isinstance(signal, str):

            def name_it(call: Call) -> None:
                text = call.arguments.pop(1 if not call.is_method and len(call.arguments) > 1 else 0)
                if call.name == "smooth":
                    # In neuroimaging a bare number is a full width, elsewhere a standard deviation.
                    call.keywords["fwhm" if self._found.library in ("nibabel", "SimpleITK") else "sigma"] = text

            line = working_line(sys._getframe(1).f_code.co_name, name_it, f"grid.smooth(sigma={signal!r})")
            raise ValueError(f"signal: {signal!r} is a single number; a width goes by name{line}")
        return signal

    def _in_time(self, time: Time | None, values: Any, signal: Any, progress: ProgressLike) -> Any:
        """Values of a signal smoothed along time too."""
        if time is None:
            return values
        return time.smooth(values, axis=frames_axis(self.layout_of(np.shape(signal))), progress=progress)

    def _result(self, values: Any, signal: Any) -> Any:
        """Values in the number type and the kind of object of their signal."""
        given = self._original if signal is None else signal
        if self.keep_dtype:
            values = cast_values(values, np.ma.getdata(np.ma.asarray(given)))
        else:
            values = np.asarray(values).astype(float_type(given), copy=False)
        if signal is not None:
            return values
        return results_like(self._given, self._found.library, values)

    def layout_of(self, shape: tuple[int, ...], name: str = "signal") -> Layout:
        """Axes of a signal of this shape: those of the grid first, last, or where the grid's own array has them.

        Raises
        ------
        ValueError
            If the shape does not fit.
        """
        sizes, n, own = self.shape, len(self.shape), self._layout.axes
        if shape == self._layout.shape:
            return self._layout
        for axes in (tuple(range(n)), own, tuple(range(len(shape) - n, len(shape)))):
            if len(shape) > max(axes) and min(axes) >= 0 and tuple(shape[axis] for axis in axes) == sizes:
                return GridLayout.for_axes(shape, axes)
        if shape and shape[0] == self.n_vertices:
            return Layout(self.n_vertices, shape[1:])
        wanted = f"{sizes}, or {(*sizes, 3)} with channels"
        turned = f"; pass {name}.T" if shape == sizes[::-1] else ""
        raise ValueError(f"{name}: shape {shape} does not fit the grid, {sizes}; give {wanted}{turned}")

    def __repr__(self) -> str:
        sizes = " × ".join(map(str, self.shape))
        lengths = " × ".join(f"{h:g}" for h in self.spacing)
        n = self._layout.n_channels
        parts = [f"{sizes} places", f"spacing {lengths}"]
        parts += [f"{n} channel{'s' if n > 1 else ''}"] if self._layout.channels else []
        parts += [f"{np.count_nonzero(self._kept)} in the mask"] if self._kept is not None else []
        parts += [f"periodic along {', '.join(str(i) for i, each in enumerate(self.periodic) if each)}"] * any(
            self.periodic
        )
        return f"<adwave.Grid: {', '.join(parts)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_grid, (
            type(self),
            self._given,
            self.spacing,
            self.mask,
            self.periodic,
            self._layout.axes,
            self.keep_dtype,
        )


def _restore_grid(
    kind: type[GridBase[Any]],
    array: object,
    spacing: tuple[float, ...],
    mask: NDArray[np.bool_] | None,
    periodic: tuple[bool, ...],
    axes: tuple[int, ...],
    keep_dtype: bool,
) -> GridBase[Any]:
    return kind(array, spacing, mask, periodic, axes=axes, keep_dtype=keep_dtype)
