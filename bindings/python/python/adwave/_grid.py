"""`Grid`: an image or a volume with bands, as arrays and as objects of imaging libraries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar, Union, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._decomposer import Bands, Decomposer, GainsLike, Where
from adwave._edits import DenoiseResult, LocalFit, denoise, filter
from adwave._grid_layout import GridLayout, finite_grid, grid_axes, plain_array
from adwave._grid_objects import FoundGrid, check_same_places, find_grid, results_like
from adwave._layout import Layout, without_unknown
from adwave._measures import FeatureOptions, Features, Saliency, SaliencyOptions, Weighting, features, saliency
from adwave._options import Length, LevelsLike, Operator, SignalLike, Steps, Widths, check_steps, levels_of
from adwave._own_operator import GivenOperator
from adwave._progress import ProgressLike
from adwave._shape import Shape
from adwave._unknown import refuse_unknown

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._options import LevelOptions

#: Kind of the results for the values of the grid itself.
_Own = TypeVar("_Own")

Values = NDArray[np.float64]


@dataclass(frozen=True)
class _GridOptions:
    """Sizes, spacings, borders and places with data, as the extension takes them."""

    sizes: list[int]
    spacing: list[float]
    periodic: list[bool]
    kept: Union[NDArray[np.bool_], None]


class Grid(Generic[_Own]):
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
    #: Whether results have the number type of their signal.
    keep_dtype: bool

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
        self.spacing = own if spacing is None else _spacings(spacing, self._layout)
        self.periodic = _flags(periodic, self._layout)
        self.keep_dtype = bool(keep_dtype)
        self._kept = None if mask is None else _kept_places(mask, found, self._layout)
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
    def n_places(self) -> int:
        """Number of places."""
        return self._layout.n_vertices

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

    def decompose(
        self,
        signal: ArrayLike | None = None,
        *,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands:
        """Split a signal into bands from fine to coarse, which sum to it; see `adwave.decompose`.

        Parameters
        ----------
        signal : array_like, optional
            Values of the shape of the grid, with further axes for channels; the grid's own by default.
        levels : int, Widths, Steps or Octaves, optional
            By default dyadic levels until one is 2 % of the diagonal wide.
        sigma : sequence of float, optional
            Levels by their standard deviations along one axis, in the unit of the spacing, as SciPy counts.
        accuracy : float
            Largest error of a band relative to the band, 1e-13 to 0.1.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        **options
            ``fwhm=[2, 4, 8]`` and ``steps=[1, 2.5, 8]``, short for `levels`.

        Returns
        -------
        Bands
            An array of (levels + 1) × the shape of the signal, in 64 bits.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> image = np.random.default_rng(0).normal(size=(48, 64))
        >>> bands = aw.grid(image).decompose(sigma=[1, 2, 4])
        >>> bands.shape, bool(abs(bands.sum(axis=0) - image).max() < 1e-12)
        ((4, 48, 64), True)
        """
        wanted = _levels("decompose", levels, sigma, dict(options))
        return self.prepare().decompose(self._signal(signal), levels=wanted, accuracy=accuracy, progress=progress)

    @overload
    def smooth(
        self,
        signal: None = None,
        steps: float | None = None,
        *,
        fwhm: Length | None = None,
        sigma: float | None = None,
        rms: Length | None = None,
        accuracy: float = ...,
        progress: ProgressLike = None,
    ) -> _Own: ...

    @overload
    def smooth(
        self,
        signal: ArrayLike,
        steps: float | None = None,
        *,
        fwhm: Length | None = None,
        sigma: float | None = None,
        rms: Length | None = None,
        accuracy: float = ...,
        progress: ProgressLike = None,
    ) -> Values: ...

    def smooth(
        self,
        signal: ArrayLike | None = None,
        steps: float | None = None,
        *,
        fwhm: Length | None = None,
        sigma: float | None = None,
        rms: Length | None = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> _Own | Values:
        """Smooth a signal by one width, with a discrete Gaussian: constants, sums and the range are kept to the accuracy.

        Parameters
        ----------
        signal : array_like, optional
            Values of the shape of the grid, with further axes for channels; the grid's own by default.
        steps : float, optional
            Number of steps, each of the variance h²/2 along each axis, where h is the smallest spacing.
        fwhm : float or str, optional
            Full width at half maximum instead of steps, in the unit of the spacing or as a share of the diagonal such as
            ``"2%"``: 2.3548 standard deviations along each axis, exactly. The kernel crosses its half maximum there if it is
            wide; at a width of w places it does so by about ``1.07/w²`` of the width closer.
        sigma : float, optional
            Standard deviation along one axis instead of steps, as SciPy counts.
        rms : float or str, optional
            Root mean square distance in a plane instead of steps, √2 standard deviations, as for shapes.
        accuracy : float
            Largest error relative to the change.
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
        if sigma is not None:
            if steps is not None or fwhm is not None or rms is not None:
                raise ValueError(
                    "smooth takes one of fwhm=8, sigma=2 and steps=3, got sigma and another; leave one out"
                )
            levels: LevelsLike = _widths_of(sigma)
            if len(levels) != 1:
                raise ValueError(
                    f"sigma: got {len(levels)} numbers, and one width holds for all axes in the unit of the spacing; pass "
                    "spacing=(…) to aw.grid for voxels of different lengths, and smooth(sigma=2.0)"
                )
        else:
            given = {"steps": steps, "fwhm": fwhm, "rms": rms}
            names = [name for name, value in given.items() if value is not None]
            if len(names) != 1:
                raise ValueError(
                    f"smooth takes one of fwhm=8, sigma=2 and steps=3, got {' and '.join(names) or 'none'}, as in "
                    "grid.smooth(fwhm=8.0)"
                )
            levels = Steps(check_steps([steps])) if steps is not None else Widths(**{names[0]: [given[names[0]]]})  # type: ignore[dict-item]
        owner = self.prepare()
        values = owner._smooth(own, owner.schedule(levels), accuracy, progress)
        return self._result(values, signal)

    @overload
    def filter(
        self,
        gains: GainsLike,
        signal: None = None,
        *,
        where: Where = None,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        local_fit: LocalFit = ...,
        accuracy: float = ...,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> _Own: ...

    @overload
    def filter(
        self,
        gains: GainsLike,
        signal: ArrayLike,
        *,
        where: Where = None,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        local_fit: LocalFit = ...,
        accuracy: float = ...,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Values: ...

    def filter(
        self,
        gains: GainsLike,
        signal: ArrayLike | None = None,
        *,
        where: Where = None,
        levels: LevelsLike = None,
        sigma: float | Sequence[float] | None = None,
        local_fit: LocalFit = "constant",
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> _Own | Values:
        """Change the bands of a signal and sum them: smooth, enhance, keep or drop; see `adwave.filter`.

        Parameters
        ----------
        gains : sequence of float, str, or one or more Layer
            A gain for each band from fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Or a preset by its name.
        signal : array_like, optional
            As in `decompose`.
        where : str or array_like, optional
            A region in its text form, with points in the unit of the spacing from the first place
            (``"ball:point=10 20 0,radius=5"``), or a weight for each place, in the shape of the grid.
        levels, sigma, **options
            As in `decompose`; by default one level for each gain.
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
        wanted = _levels("filter", levels, sigma, dict(options))
        found: Any = filter(
            self.prepare(),
            gains,
            where=where,
            signal=self._signal(signal),  # type: ignore[arg-type]
            levels=wanted,
            local_fit=local_fit,
            accuracy=accuracy,
            progress=progress,
        )
        return self._result(found, signal)

    def denoise(
        self,
        signal: ArrayLike | None = None,
        *,
        strength: float = 1.0,
        noise: float
        | Literal["gaussian", "poisson", "multiplicative", "rician"]
        | tuple[Literal["gaussian", "poisson", "multiplicative", "rician"], float]
        | None = None,
        local_fit: LocalFit = "linear",
        progress: ProgressLike = None,
    ) -> DenoiseResult:
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
            progress=progress,
        )
        return DenoiseResult(self._result(found.result, signal), found.info)

    def saliency(
        self,
        signal: ArrayLike | None = None,
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
        wanted = _levels("saliency", levels, sigma, {})
        return saliency(
            self.prepare(),
            self._signal(signal),
            weighting=weighting,
            options=options,
            levels=wanted,
            accuracy=accuracy,
            progress=progress,
        )

    def features(
        self,
        signal: ArrayLike | None = None,
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
        wanted = _levels("features", levels, sigma, {})
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

    def region(self, region: str) -> Values:
        """Weights of a region in its text form, in the shape of the grid; see `Decomposer.region`.

        Points and lengths are in the unit of the spacing, from the first place.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> grid = aw.grid(np.zeros((5, 5)), spacing=2.0)
        >>> int(grid.region("ball:point=4 4 0,radius=4,falloff=0.1").sum())
        9
        """
        return self.prepare().region(region)

    def _signal(self, signal: Any) -> Any:
        """A signal of a method: the grid's own values by default."""
        if signal is None:
            return self._values
        if np.ndim(signal) == 0 and not isinstance(signal, str):
            raise ValueError(
                f"signal: {signal!r} is a single number; a width goes by name, grid.smooth(fwhm={signal!r}), and gains "
                "come first, grid.filter([0, 1])"
            )
        return signal

    def _result(self, values: Any, signal: Any) -> Any:
        """Values in the number type and the kind of object of their signal."""
        if self.keep_dtype:
            values = _in_dtype(values, self._original if signal is None else np.ma.getdata(np.ma.asarray(signal)))
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
        if shape and shape[0] == self.n_places:
            return Layout(self.n_places, shape[1:])
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
    array: NDArray[Any] | Sequence[Sequence[float]],
    spacing: float | Sequence[float] | None = None,
    mask: object = None,
    periodic: bool | Sequence[bool] = False,
    *,
    axes: int | Sequence[int] | None = None,
    keep_dtype: bool = False,
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
        an image of nibabel or SimpleITK, a `pyvista.ImageData` (its active scalars), or an open dataset of rasterio. NaN and
        masked entries are places without a value: values go around them, and they stay NaN.
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
        Results of `Grid.smooth`, `Grid.filter` and `Grid.denoise` in the number type of their signal, integers rounded; by
        default in 64 bits.

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


class GridDecomposer(Decomposer):
    """A `Decomposer` of a `Grid`: signals and results have the axes of the grid."""

    __slots__ = ("_grid",)

    _grid: Grid[Any]

    def __init__(self, grid: Grid[Any]) -> None:
        none = np.empty(0, dtype=np.uint32)
        self._grid = grid
        shape = _native.ShapeData.from_graph(grid.n_places, none, none, None, True)
        self._options = Operator("surface")
        options = _GridOptions(list(grid.shape), list(grid.spacing), list(grid.periodic), grid._kept)
        self._data = _native.Prepared.from_grid(shape, options)
        self._mask = self._given_walk = self._by_width = self._last_masked = None

    @property
    def shape(self) -> Shape:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Shape of a surface, which a grid has not: functions that need one say so."""
        raise ValueError(
            "shape: a grid has no surface, points or file; it goes to aw.decompose, smooth, filter, filter_labels, denoise, "
            "saliency, features and region, and to the methods of aw.grid(…), such as grid.smooth(fwhm=8)"
        )

    @property
    def operator(self) -> str:
        """Kind of the diffusion operator."""
        return "surface" if self._given_walk is None else super().operator

    @property
    def _sizes(self) -> tuple[int, ...]:
        return self._grid.shape

    def _own_signal(self) -> SignalLike:
        return self._grid._values

    def _outsiders(self) -> NDArray[np.bool_] | None:
        return None if self._grid._kept is None else ~self._grid._kept

    def _by_place(self) -> Layout:
        return GridLayout.for_axes(self._grid.shape, tuple(range(self._grid.ndim)))

    def _signal_values(self, signal: SignalLike) -> tuple[Values | None, Layout]:
        if isinstance(signal, str):
            raise ValueError(
                f"signal: a grid has no named signals, got {signal!r}; give an array of shape {self._sizes}"
            )
        array = self._grid._values if signal is None else plain_array(signal, "signal")
        layout = self._grid.layout_of(array.shape)
        if layout.n_channels == 0:
            raise ValueError(f"signal: shape {array.shape} has no channels")
        is_grid = isinstance(layout, GridLayout)
        own = (
            layout if is_grid else GridLayout.for_axes((*self._sizes, *layout.channels), tuple(range(len(self._sizes))))
        )
        values = finite_grid(
            array if is_grid else own.arrange(array.reshape(self.n_vertices, -1)), cast(GridLayout, own)
        )
        return values if isinstance(signal, np.ma.MaskedArray) else without_unknown(values), layout

    def for_levels(self, levels: LevelsLike, *, analysis: bool = False) -> GridDecomposer:
        """This grid: its operator suits all levels."""
        return self

    def region(self, region: str) -> Values:
        """Weights of a region in its text form, in the shape of the grid; see `Decomposer.region`."""
        return super().region(region).reshape(self._sizes)

    def with_mask(self, mask: ArrayLike) -> GridDecomposer:
        """Grid without some places: the diffusion goes around them, and their bands are NaN.

        Parameters
        ----------
        mask : array of bool
            True at places that are left out, in the shape of the grid.
        """
        given = np.asarray(mask)
        if given.shape not in (self._sizes, (self.n_vertices,)):
            raise ValueError(f"mask: shape {given.shape} is not that of the grid, {self._sizes}")
        flags = np.ascontiguousarray(given, dtype=bool).reshape(-1)
        return self._with_data(self._data.with_mask(flags), flags, self._given_walk)

    def _with_given(self, given: Any) -> GridDecomposer:
        data = given.prepare(self._data) if isinstance(given, GivenOperator) else self._data.with_walk(given._data)
        other = self._with_data(data, None, given)
        return other if self._mask is None else other.with_mask(self._mask)

    def _with_data(self, data: _native.Prepared, mask: NDArray[np.bool_] | None, given: Any) -> GridDecomposer:
        other = GridDecomposer.__new__(GridDecomposer)
        other._grid, other._options, other._data, other._mask, other._given_walk = (
            self._grid,
            self._options,
            data,
            mask,
            given,
        )
        other._by_width = other._last_masked = None
        return other

    def __repr__(self) -> str:
        return f"<adwave.Decomposer: heat on {self._grid!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_decomposer, (self._grid, self._mask, self._given_walk)


def _restore_decomposer(grid: Grid[Any], mask: NDArray[np.bool_] | None, given: Any) -> Decomposer:
    prepared: Decomposer = GridDecomposer(grid)
    if given is not None:
        prepared = prepared._with_given(given)
    return prepared if mask is None else prepared.with_mask(mask)


def _spacings(spacing: Any, layout: GridLayout) -> tuple[float, ...]:
    n = len(layout.sizes)
    example = f"aw.grid(array, spacing={tuple([1.0] * n) if n > 1 else 1.0})"
    try:
        given = np.asarray(spacing, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"spacing must be a number or one for each axis, as in {example}, got {spacing!r}") from error
    if given.dtype.kind != "f" or isinstance(spacing, (str, bool)) or given.ndim > 1:
        raise TypeError(f"spacing must be a number or one for each axis, as in {example}, got {spacing!r}")
    if given.ndim == 1 and len(given) != n:
        raise ValueError(
            f"spacing: got {len(given)} numbers, and the grid of shape {layout.sizes} has {n} axes; give one number, or one "
            f"for each, as in {example}"
        )
    each = tuple(float(h) for h in np.broadcast_to(given, (n,)))
    for axis, h in enumerate(each):
        if not (np.isfinite(h) and h > 0):
            raise ValueError(
                f"spacing must be a finite number above 0 along each axis, as in {example}, got {h:g} along axis {axis}"
            )
    return each


def _flags(periodic: Any, layout: GridLayout) -> tuple[bool, ...]:
    n = len(layout.sizes)
    example = f"aw.grid(array, periodic={tuple([False] * (n - 1) + [True]) if n > 1 else True})"
    given = np.asarray(periodic)
    if given.dtype.kind != "b" or given.ndim > 1:
        raise TypeError(
            f"periodic must be True or False, or one of them for each axis, as in {example}, got {periodic!r}"
        )
    if given.ndim == 1 and len(given) != n:
        raise ValueError(
            f"periodic: got {len(given)} flags, and the grid of shape {layout.sizes} has {n} axes; give one for each, as in "
            f"{example}"
        )
    return tuple(bool(each) for each in np.broadcast_to(given, (n,)))


def _kept_places(mask: Any, array: FoundGrid, layout: GridLayout) -> NDArray[np.bool_] | None:
    """Flags of the places with data, in the order of the values."""
    found = find_grid(mask, tuple(range(np.ndim(mask))) if hasattr(mask, "dims") else None)
    check_same_places(array, found)
    given = plain_array(found.values, "mask")
    if given.shape != layout.sizes:
        hint = ", or aw.grid(array, mask=mask.T)" if given.shape == layout.sizes[::-1] else ""
        raise ValueError(
            f"mask: shape {given.shape} is not that of the grid, {layout.sizes}; give one flag for each place, as in "
            f"aw.grid(array, mask=np.isfinite(image)){hint}"
        )
    if given.dtype.kind == "f" and np.isnan(given).any():
        raise ValueError(
            "mask: has NaN; True or nonzero is a place with data: aw.grid(array, mask=np.nan_to_num(mask) > 0)"
        )
    kept = np.ascontiguousarray(given != 0).reshape(-1)
    if not kept.any():
        raise ValueError(
            "mask: leaves out every place, and True or nonzero is a place with data; if True are places to leave out, "
            "aw.grid(array, mask=~mask)"
        )
    return None if kept.all() else kept


def _widths_of(sigma: Any) -> Widths:
    """Levels of these standard deviations along one axis."""
    try:
        given = np.atleast_1d(np.asarray(sigma, dtype=np.float64))
    except (TypeError, ValueError) as error:
        raise TypeError(
            f"sigma must be standard deviations in the unit of the spacing, as in sigma=2.0, got {sigma!r}; shares of the "
            'diagonal go as fwhm="2%"'
        ) from error
    if not (given.size and np.isfinite(given).all() and (given > 0).all()):
        raise ValueError(f"sigma must be above 0, as in sigma=2.0, got {sigma!r}")
    return Widths(rms=[float(np.sqrt(2.0) * each) for each in given.ravel()])


def _levels(function: str, levels: LevelsLike, sigma: Any, options: dict[str, Any]) -> LevelsLike:
    """Levels, from their short forms too."""
    if options:
        refuse_unknown(function, options, ("signal", "levels", "sigma", "accuracy", "progress"), ("fwhm", "steps"))
    if sigma is None:
        return levels_of(levels, options)
    if levels is not None or options:
        raise ValueError("levels are given twice, by sigma and another; leave one out")
    return _widths_of(sigma)


def _in_dtype(values: NDArray[Any], like: NDArray[Any]) -> NDArray[Any]:
    """Values in the number type of an array; integers are rounded, and places without a value keep theirs.

    Raises
    ------
    ValueError
        If a value does not fit into the type.
    """
    dtype = like.dtype
    if dtype.kind == "f":
        return values.astype(dtype)
    if dtype.kind not in "iub":
        return values
    low, high = (0, 1) if dtype.kind == "b" else (np.iinfo(dtype).min, np.iinfo(dtype).max)
    whole = np.rint(values)
    unknown = np.isnan(whole)
    outside = (whole < low) | (whole > high)
    if outside.any():
        value = float(whole[outside][0])
        raise ValueError(
            f"keep_dtype: the value {value:g} does not fit into {dtype}, {low} to {high}; leave keep_dtype out, and clip, "
            f"as in np.clip(result, {low}, {high}).astype('{dtype}')"
        )
    if unknown.any():
        return np.where(unknown, like, np.where(unknown, 0, whole).astype(dtype))
    return whole.astype(dtype)
