"""`Grid`: bands of an image or a volume, and edits by them, as arrays and as objects of imaging libraries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import public, warn
from adwave._decomposer import Bands, GainsLike, Layer, Where
from adwave._denoise import DenoiseResult, denoise
from adwave._edits import LocalFit, _gains_last, filter
from adwave._grid_base import GridBase, array_by_name
from adwave._grid_checks import (
    levels_by_sigma,
    spacings_by_width,
    widths_of_sigma,
)
from adwave._grid_domain import Values
from adwave._misfit import line_with, working_line
from adwave._options import Length, LevelsLike, Numbers, Steps, Widths, check_steps
from adwave._progress import ProgressLike
from adwave._time import Time, split_in_time

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
    return array_by_name(*_gains_last(arguments, options))


class Grid(GridBase[_Own]):
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

    __slots__ = ()

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

    @public(array_by_name)
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

    @public(array_by_name)
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

    @public(array_by_name)
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
