"""`Grid`: an image or a volume with bands, as arrays and as objects of imaging libraries."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import Call, public, warn
from adwave._decomposer import Bands, Decomposer, GainsLike, Layer, Where
from adwave._denoise import DenoiseResult, denoise
from adwave._edits import LocalFit, _gains_last, filter, filter_labels
from adwave._grid_checks import (
    cast_values,
    check_flags,
    check_spacings,
    find_kept_places,
    levels_by_sigma,
    spacings_by_width,
    widths_of_sigma,
)
from adwave._grid_domain import GridDecomposer, Values
from adwave._grid_layout import GridLayout, grid_axes, plain_array
from adwave._grid_objects import find_grid, results_like
from adwave._image_data import scalars_of
from adwave._layout import Layout, float_type
from adwave._measures import FeatureOptions, Features, Saliency, SaliencyOptions, Weighting, features, saliency
from adwave._methods import Members
from adwave._misfit import line_with, working_line
from adwave._options import Length, LevelsLike, Numbers, Steps, Widths, check_steps
from adwave._progress import ProgressLike
from adwave._time import Time, frames_axis, split_in_time

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._options import (
        Float,
        GridDenoiseCall,
        GridFilterCall,
        GridFilterOptions,
        LevelOptions,
        ValueNoise,
    )

#: Kind of the results for the values of the grid itself.
_Own = TypeVar("_Own")
#: Number type of results that are rounded.
_Integer = TypeVar("_Integer", bound=np.integer[Any])


def _gains_after_signal(arguments: tuple[Any, ...], options: dict[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments of `Grid.filter` with the signal before the gains; the former order is taken with a warning."""
    if len(arguments) == 3 and isinstance(arguments[1], (str, list, tuple, Layer)) and np.ndim(arguments[2]) > 1:
        warn("grid.filter(gains, f) is now grid.filter(f, gains), and will go in the next release", DeprecationWarning)
        return (arguments[0], arguments[2], arguments[1]), options
    return _by_name(*_gains_last(arguments, options))


def _by_name(arguments: tuple[Any, ...], options: dict[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments of a method of `Grid` without a signal, for the grid of the array that the signal names."""
    grid, *rest = arguments
    if rest and isinstance(rest[0], str):
        return (grid._with_array(rest[0]), None, *rest[1:]), options
    if isinstance(options.get("signal"), str):
        return (grid._with_array(options["signal"]), *rest), {**options, "signal": None}
    return arguments, options


class Grid(Members, Generic[_Own]):
    """An image or a volume with heat along its axes, as `adwave.grid` makes it.

    Every function that takes a `Decomposer` takes a grid in its place, as in ``aw.filter_labels(grid, labels, [0, 0])``.
    Signals and results have the axes of the grid; the methods take the grid's own values without a signal.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> grid = aw.grid(np.eye(64), spacing=0.5)
    >>> grid
    <adwave.Grid: 64 × 64 places, spacing 0.5 × 0.5>
    >>> grid.smooth(fwhm=2).shape
    (64, 64)
    """

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

    @overload
    def decompose(
        self,
        signal: NDArray[Float],
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = ...,
        time: None = None,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Float]: ...

    @overload
    def decompose(
        self,
        signal: Numbers,
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = ...,
        time: None = None,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands: ...

    @overload
    def decompose(
        self: Grid[NDArray[Float]],
        signal: None = None,
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = ...,
        time: None = None,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Float]: ...

    @overload
    def decompose(
        self,
        signal: str | ArrayLike | None = None,
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = ...,
        time: None = None,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Any]: ...

    @overload
    def decompose(
        self,
        signal: NDArray[Float],
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = ...,
        time: Time,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> NDArray[Float]: ...

    @overload
    def decompose(
        self,
        signal: str | ArrayLike | None = None,
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = ...,
        time: Time,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> NDArray[Any]: ...

    @public(_by_name)
    def decompose(
        self,
        signal: str | ArrayLike | None = None,
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = _native.ACCURACY,
        time: Time | None = None,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Any] | NDArray[Any]:
        """Split a signal into bands from fine to coarse, which sum to it; see `adwave.decompose`.

        Parameters
        ----------
        signal : str or array_like, optional
            Values of the shape of the grid, with further axes for channels, or the name of an array of an `ImageData`; the
            grid's own by default.
        levels : int, Widths, Steps or Octaves, optional
            By default dyadic levels until one is 2 % of the diagonal wide.
        sigma : sequence of float, optional
            Levels by their standard deviations along one axis, in the unit of the spacing, as SciPy counts.
        accuracy : float
            Largest error of a band relative to the band, 1e-13 to 0.1.
        time : Time, optional
            Bands along time too, of a signal whose axes of channels are frames.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        **options
            ``fwhm=[2, 4, 8]`` and ``steps=[1, 2.5, 8]``, short for `levels`.

        Returns
        -------
        Bands, or with `time` a plain array
            An array of (levels + 1) × the shape of the signal, in its number type if it has floats.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> image = np.random.default_rng(0).normal(size=(48, 64))
        >>> bands = aw.grid(image).decompose(sigma=[1, 2, 4])
        >>> bands.shape, bool(abs(bands.sum(axis=0) - image).max() < 1e-12)
        ((4, 48, 64), True)
        """
        wanted = levels_by_sigma("decompose", levels, sigma, dict(options))
        own = self._signal(signal)
        bands = self.prepare().decompose(own, levels=wanted, accuracy=accuracy, progress=progress)
        return (
            bands if time is None else split_in_time(time, np.asarray(bands), self.layout_of(np.shape(own)), progress)
        )

    @overload
    def smooth(
        self,
        signal: str | None = None,
        steps: float | None = None,
        *,
        fwhm: Length | Sequence[float] | None = None,
        sigma: float | Sequence[float] | None = None,
        rms: Length | Sequence[float] | None = None,
        accuracy: float = ...,
        time: Time | None = None,
        progress: ProgressLike = None,
    ) -> _Own: ...

    @overload
    def smooth(
        self,
        signal: NDArray[Float],
        steps: float | None = None,
        *,
        fwhm: Length | Sequence[float] | None = None,
        sigma: float | Sequence[float] | None = None,
        rms: Length | Sequence[float] | None = None,
        accuracy: float = ...,
        time: Time | None = None,
        progress: ProgressLike = None,
    ) -> NDArray[Float]: ...

    @overload
    def smooth(
        self,
        signal: Numbers,
        steps: float | None = None,
        *,
        fwhm: Length | Sequence[float] | None = None,
        sigma: float | Sequence[float] | None = None,
        rms: Length | Sequence[float] | None = None,
        accuracy: float = ...,
        time: Time | None = None,
        progress: ProgressLike = None,
    ) -> Values: ...

    @overload
    def smooth(
        self,
        signal: ArrayLike,
        steps: float | None = None,
        *,
        fwhm: Length | Sequence[float] | None = None,
        sigma: float | Sequence[float] | None = None,
        rms: Length | Sequence[float] | None = None,
        accuracy: float = ...,
        time: Time | None = None,
        progress: ProgressLike = None,
    ) -> NDArray[Any]: ...

    @public(_by_name)
    def smooth(
        self,
        signal: str | ArrayLike | None = None,
        steps: float | None = None,
        *,
        fwhm: Length | Sequence[float] | None = None,
        sigma: float | Sequence[float] | None = None,
        rms: Length | Sequence[float] | None = None,
        accuracy: float = _native.ACCURACY,
        time: Time | None = None,
        progress: ProgressLike = None,
    ) -> _Own | NDArray[Any]:
        """Smooth a signal by one width, with a discrete Gaussian: constants, sums and the range are kept to the accuracy.

        Parameters
        ----------
        signal : str or array_like, optional
            Values of the shape of the grid, with further axes for channels, or the name of an array of an `ImageData`; the
            grid's own by default.
        steps : float, optional
            Number of steps, each of the variance h²/2 along each axis, where h is the smallest spacing.
        fwhm : float or str, optional
            Full width at half maximum instead of steps, in the unit of the spacing or as a share of the diagonal such as
            ``"2%"``: 2.3548 standard deviations along each axis, exactly. The kernel crosses its half maximum there if it is
            wide; at a width of w places it does so by about ``1.07/w²`` of the width closer. Also a width for each axis, as in
            nilearn and SciPy.
        sigma : float, optional
            Standard deviation along one axis instead of steps, as SciPy counts.
        rms : float or str, optional
            Root mean square distance in a plane instead of steps, √2 standard deviations, as for shapes.
        accuracy : float
            Largest error relative to the change.
        time : Time, optional
            Smooth along time too, a signal whose axes of channels are frames.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        array like the signal, or an object like the grid's own
            Values outside the mask are unchanged, and NaN stays NaN.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> step = np.repeat([0.0, 1.0], 8)
        >>> aw.grid(step).smooth(sigma=1)[6:10].round(3)
        array([0.059, 0.267, 0.733, 0.941])
        """
        own = self._signal(signal)
        each = {"sigma": sigma, "fwhm": fwhm, "rms": rms}
        name, widths = next(((name, widths) for name, widths in each.items() if np.ndim(widths or 0)), ("", None))
        if widths is not None:
            # One width where the spacings are divided by those of the axes.
            scaled = self._with_spacing(spacings_by_width(name, widths, self.spacing))
            each[name] = 1.0
            return scaled.smooth(signal, steps, **each, accuracy=accuracy, time=time, progress=progress)  # type: ignore[arg-type]
        if sigma is not None:
            if steps is not None or fwhm is not None or rms is not None:
                raise ValueError(
                    "smooth takes one of fwhm=8, sigma=2 and steps=3, got sigma and another; leave one out"
                )
            levels: LevelsLike = widths_of_sigma(sigma)
        else:
            given = {"steps": steps, "fwhm": fwhm, "rms": rms}
            names = [name for name, value in given.items() if value is not None]
            if len(names) != 1:
                line = line_with("smooth", sigma="2") if not names else "; leave one out"
                raise ValueError(
                    f"smooth takes one of fwhm=8, sigma=2 and steps=3, got {' and '.join(names) or 'none'}{line}"
                )
            levels = Steps(check_steps([steps])) if steps is not None else Widths(**{names[0]: [given[names[0]]]})  # type: ignore[dict-item]
        owner = self.prepare()
        values = owner._smooth(own, owner.schedule(levels), accuracy, progress)
        return self._result(self._in_time(time, values, own, progress), signal)

    @overload
    def filter(self, gains: GainsLike, /, **options: Unpack[GridFilterCall]) -> _Own: ...

    @overload
    def filter(self, signal: str | None, gains: GainsLike, **options: Unpack[GridFilterCall]) -> _Own: ...

    @overload
    def filter(self, signal: NDArray[Float], gains: GainsLike, **options: Unpack[GridFilterCall]) -> NDArray[Float]: ...

    @overload
    def filter(self, signal: Numbers, gains: GainsLike, **options: Unpack[GridFilterCall]) -> Values: ...

    @public(_gains_after_signal)
    def filter(
        self,
        signal: ArrayLike | GainsLike | None = None,
        gains: GainsLike | None = None,
        *,
        where: Where = None,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        local_fit: LocalFit = "constant",
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
        **options: Unpack[GridFilterOptions],
    ) -> object:
        """Change the bands of a signal and sum them: smooth, enhance, keep or drop; see `adwave.filter`.

        Parameters
        ----------
        signal : array_like, optional
            As in `decompose`; it may be left out, ``grid.filter(gains)``.
        gains : sequence of float, str, or one or more Layer
            A gain for each band from fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Or a preset by its name.
        where : str or array_like, optional
            A region in its text form, with points in the unit of the spacing from the first place
            (``"ball:point=10 20 0,radius=5"``), or a weight for each place, in the shape of the grid.
        levels, sigma, **options
            As in `decompose`; by default one level for each gain. ``time=aw.Time(dt=2, fwhm=4)`` smooths along time too.
        local_fit : {'linear', 'constant'}
            What smoothing leaves unchanged: ``'constant'`` is heat itself, which keeps the sum; ``'linear'`` keeps slopes
            up to the border.
        accuracy, progress
            As in `decompose`.

        Returns
        -------
        array like the signal, or an object like the grid's own

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> image = np.random.default_rng(0).normal(size=(32, 32))
        >>> sharp = aw.grid(image).filter([2, 1.5, 1], where=np.arange(1024).reshape(32, 32) < 512)
        >>> bool((sharp[16:] == image[16:]).all())
        True
        """
        time = options.pop("time", None)
        wanted = levels_by_sigma("filter", levels, sigma, dict(options))
        if gains is None:
            line = working_line("filter", lambda call: None, 'grid.filter("smooth")')
            raise TypeError(f"filter takes a gain for each band or the name of a preset, got none{line}")
        found: Any = filter(
            self.prepare(),
            self._signal(signal),
            gains,
            where=where,
            levels=wanted,
            local_fit=local_fit,
            accuracy=accuracy,
            progress=progress,
        )
        return self._result(self._in_time(time, found, self._signal(signal), progress), signal)

    @overload
    def denoise(self, signal: str | None = None, **options: Unpack[GridDenoiseCall]) -> DenoiseResult[_Own]: ...
    @overload
    def denoise(self, signal: NDArray[Float], **options: Unpack[GridDenoiseCall]) -> DenoiseResult[NDArray[Float]]: ...
    @overload
    def denoise(self, signal: Numbers, **options: Unpack[GridDenoiseCall]) -> DenoiseResult[Values]: ...

    @public(_by_name)
    def denoise(
        self,
        signal: str | ArrayLike | None = None,
        *,
        strength: float = 1.0,
        noise: float | ValueNoise | tuple[ValueNoise, float] | None = None,
        local_fit: LocalFit = "linear",
        time: Time | None = None,
        progress: ProgressLike = None,
    ) -> DenoiseResult[Any]:
        """Remove noise whose amount is estimated, and keep steps; see `adwave.denoise`.

        Parameters
        ----------
        signal : array_like, optional
            As in `decompose`.
        strength : float
            Factor of the noise: below 1 more careful, above 1 more thorough.
        noise : float or str or (str, float), optional
            Standard deviation of the noise, if it is known, or how it depends on the values: ``'poisson'`` for counts,
            ``'rician'`` for magnitudes of magnetic resonance, whose bias is removed too.
        local_fit : {'linear', 'constant'}
            With ``'linear'`` slopes are not taken for noise.
        time : Time, optional
            Remove noise in space and time together, ``time=aw.Time(dt=2)``.
        progress : bool or callable, optional
            As in `decompose`.

        Returns
        -------
        DenoiseResult
            ``result``, like the signal or the grid's own object, and ``info``, the estimates.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> noisy = np.hypot(*np.mgrid[:40, :40]) + np.random.default_rng(0).normal(size=(40, 40))
        >>> clean, info = aw.grid(noisy).denoise()
        >>> clean.shape, bool(0.7 < info["noise"] < 1.3)
        ((40, 40), True)
        """
        found = denoise(
            self.prepare(),
            self._signal(signal),
            strength=strength,
            noise=noise,
            local_fit=local_fit,
            time=time,
            progress=progress,
        )
        return DenoiseResult(self._result(found.result, signal), found.info)

    @public(_by_name)
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

    @public(_by_name)
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

    def _with_array(self, name: str) -> Grid[Any]:
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
        return Grid(found, spacing, self.mask, self.periodic, keep_dtype=self.keep_dtype)

    def _with_spacing(self, spacing: tuple[float, ...]) -> Grid[_Own]:
        """This grid with other distances between places."""
        return Grid(self._given, spacing, self.mask, self.periodic, axes=self.axes, keep_dtype=self.keep_dtype)

    def _signal(self, signal: Any) -> Any:
        """A signal of a method: the grid's own values by default."""
        if signal is None:
            return self._values
        if np.ndim(signal) == 0 and not isinstance(signal, str):

            def name_it(call: Call) -> None:
                text = call.arguments.pop(1 if not call.is_method and len(call.arguments) > 1 else 0)
                if call.name == "smooth":
                    call.keywords["sigma"] = text

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
        return _restore_grid, (self._given, self.spacing, self.mask, self.periodic, self._layout.axes, self.keep_dtype)


def _restore_grid(
    array: object,
    spacing: tuple[float, ...],
    mask: NDArray[np.bool_] | None,
    periodic: tuple[bool, ...],
    axes: tuple[int, ...],
    keep_dtype: bool,
) -> Grid[Any]:
    return Grid(array, spacing, mask, periodic, axes=axes, keep_dtype=keep_dtype)


@overload
def grid(
    array: NDArray[Float],
    spacing: float | Sequence[float] | None = None,
    mask: object = None,
    periodic: bool | Sequence[bool] = False,
    *,
    axes: int | Sequence[int] | None = None,
    keep_dtype: bool = False,
) -> Grid[NDArray[Float]]: ...


@overload
def grid(
    array: NDArray[_Integer],
    spacing: float | Sequence[float] | None = None,
    mask: object = None,
    periodic: bool | Sequence[bool] = False,
    *,
    axes: int | Sequence[int] | None = None,
    keep_dtype: Literal[True],
) -> Grid[NDArray[_Integer]]: ...


@overload
def grid(
    array: NDArray[np.integer[Any]] | NDArray[np.bool_] | Sequence[Sequence[float]],
    spacing: float | Sequence[float] | None = None,
    mask: object = None,
    periodic: bool | Sequence[bool] = False,
    *,
    axes: int | Sequence[int] | None = None,
    keep_dtype: Literal[False] = False,
) -> Grid[Values]: ...


@overload
def grid(
    array: _Own,
    spacing: float | Sequence[float] | None = None,
    mask: object = None,
    periodic: bool | Sequence[bool] = False,
    *,
    axes: int | str | Sequence[int] | Sequence[str] | None = None,
    keep_dtype: bool = False,
) -> Grid[_Own]: ...


@public()
def grid(
    array: object,
    spacing: float | Sequence[float] | None = None,
    mask: object = None,
    periodic: bool | Sequence[bool] = False,
    *,
    axes: int | str | Sequence[int] | Sequence[str] | None = None,
    keep_dtype: bool = False,
) -> Grid[Any]:
    """An image or a volume with bands: exact heat along its axes, any width at one cost, and nothing crosses a mask.

    Heat is ``exp(−tL)`` with the second differences ``L = Σ_a D_a/h_a²`` of the axes a with spacings h_a. Along each axis its
    kernel is the discrete Gaussian ``e^(−s)·I_k(s)``, ``s = σ²/h_a²``, of variance σ² exactly: it is positive, sums to 1, and
    approaches the sampled Gaussian where σ is large. One step has ``σ² = h²/2``, h the smallest spacing.

    Parameters
    ----------
    array : array_like or image
        Values, of 1 to 3 axes and further ones for channels: an array, an `xarray.DataArray` (spacing by its coordinates),
        an image of nibabel or SimpleITK, a `pyvista.ImageData` or `vtkImageData` (its active scalars, at the points or in
        the cells; its axes are z, y, x, the order of `point_data`, without those of one place), or an open dataset of
        rasterio. NaN and masked entries are places without a value: values go around them, and they stay NaN.
    spacing : float or sequence of float, optional
        Distance between places, one for all axes or one for each axis of the grid; by default that of the object, or 1.
    mask : array_like or image, optional
        True or nonzero at places with data, in the shape of the grid. Values outside are not seen from inside, and stay as
        they are.
    periodic : bool or sequence of bool
        Whether the axes repeat, as longitudes do; for all, or for each axis of the grid. Other borders reflect.
    axes : int, str or sequence, optional
        Axes of the array that are the grid's, as in `scipy.ndimage`; all others are channels. Needed where it is ambiguous:
        ``axes=(0, 1)`` for RGB of shape (rows, columns, 3), ``axes=(0, 1, 2)`` for a volume with times. Dimensions of a
        `DataArray` may be given by name.
    keep_dtype : bool
        Results of `Grid.smooth`, `Grid.filter` and `Grid.denoise` in the number type of a signal of integers too, rounded;
        by default those of integers are in 64 bits, and those of floats in the type of the signal (float32 for float32).

    Returns
    -------
    Grid
        Its methods return arrays like their signal, and without a signal objects like `array`.

    Raises
    ------
    TypeError
        If the array is no image, or has complex numbers or objects.
    ValueError
        If axes are ambiguous, or an argument does not fit; the message has the line that works.

    Notes
    -----
    Without a mask and NaN heat is one pass along each axis for any width, O(places · channels); with them it takes about
    ``3.5·σ/h + 8`` products. Memory is about 3 times that of the values in 64 bits.

    References
    ----------
    Lindeberg, "Scale-space for discrete signals", IEEE PAMI 1990.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> volume = np.random.default_rng(0).normal(size=(20, 24, 16)).astype(np.float32)
    >>> grid = aw.grid(volume, spacing=(1.0, 1.0, 2.5), mask=volume > -3)
    >>> grid.smooth(fwhm=4.0).shape
    (20, 24, 16)
    >>> grid.decompose(fwhm=[2, 4, 8]).shape
    (4, 20, 24, 16)
    >>> aw.grid(np.zeros((48, 64, 3)), axes=(0, 1))
    <adwave.Grid: 48 × 64 places, spacing 1 × 1, 3 channels>
    """
    return Grid(array, spacing, mask, periodic, axes=axes, keep_dtype=keep_dtype)
