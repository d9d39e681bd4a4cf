"""`Time`: the frames of a signal as an axis with bands of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._adapt_arrays import float_type
from adwave._layout import Layout
from adwave._methods import Members
from adwave._progress import ProgressLike, report_progress

_ENDS = ("reflect", "periodic", "causal")

Ends = Literal["reflect", "periodic", "causal"]


@dataclass(frozen=True)
class _TimeOptions:
    """Frames and widths, as the extension takes them."""

    step: Union[float, None]
    times: Union[list[float], None]
    ends: str
    widths: list[float]


class Time(Members):
    """Time as a second axis: frames that follow each other, and bands along them.

    ``aw.smooth(shape, f, fwhm=8, time=aw.Time(dt=2, fwhm=4))`` smooths in space and in time, and
    ``aw.decompose(shape, f, levels=4, time=aw.Time(dt=2, fwhm=[4, 8]))`` has the bands ``bands[j, i]`` of both. The methods
    take arrays alone, with the frames along one axis. Both orders are the same, since the two act on different axes.

    Parameters
    ----------
    dt : float, optional
        Time from frame to frame, in the unit of the widths.
    fwhm : float or sequence of float, optional
        Full widths at half maximum of the bands, increasing; `denoise` chooses its own and needs none.
    widths : float or sequence of float, optional
        Widths σ instead, as for shapes: standard deviations times √2, ``fwhm / 1.665``.
    ends : {'reflect', 'periodic', 'causal'}
        Nothing flows past the ends; the first frame follows the last; or each frame depends on itself and earlier ones
        alone, so that what comes out is late by `delay`.
    causal : bool
        Short for ``ends='causal'``.
    times : sequence of float, optional
        Times of all frames instead of `dt`, if the steps differ.

    Raises
    ------
    TypeError
        If not one of `dt` and `times` is given, or both of `fwhm` and `widths` are.
    ValueError
        If the widths do not increase from above 0, or `ends` is another.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> series = np.sin(np.arange(200) / 3) + np.random.default_rng(0).normal(size=(50, 200))
    >>> time = aw.Time(dt=0.5, fwhm=[2, 6])
    >>> bands = time.decompose(series)
    >>> bands.shape, bool(np.allclose(bands.sum(axis=0), series))
    ((3, 50, 200), True)
    >>> time.filter(series, gains=[0, 1]).shape  # without what is faster than 2
    (50, 200)
    """

    __slots__ = ("dt", "ends", "times", "widths")

    #: Time from frame to frame; None if `times` are given.
    dt: float | None
    #: Times of all frames, if they were given.
    times: NDArray[np.float64] | None
    #: Widths σ of the bands, increasing.
    widths: NDArray[np.float64]
    #: Treatment of the ends.
    ends: Ends

    def __init__(
        self,
        dt: float | None = None,
        *,
        fwhm: float | Sequence[float] | None = None,
        widths: float | Sequence[float] | None = None,
        ends: Ends = "reflect",
        causal: bool = False,
        times: ArrayLike | None = None,
    ) -> None:
        if (dt is None) == (times is None):
            raise TypeError(
                "Time takes dt, the time from frame to frame, or times, those of all frames: aw.Time(dt=2.0, fwhm=4.0)"
            )
        if fwhm is not None and widths is not None:
            raise TypeError(
                f"Time takes the widths of its bands as fwhm or as widths: aw.Time(dt={dt or 2.0}, fwhm=4.0)"
            )
        if causal and ends == "periodic":
            raise ValueError("ends: a cycle has no later frames; leave out causal=True or ends='periodic'")
        if ends not in _ENDS:
            raise ValueError(f"ends must be 'reflect', 'periodic' or 'causal', got {ends!r}")
        self.dt = None if dt is None else float(dt)
        self.times = None if times is None else np.asarray(times, dtype=np.float64).ravel()
        of = () if fwhm is None and widths is None else widths if fwhm is None else fwhm
        given = np.atleast_1d(np.asarray(of, dtype=np.float64)).ravel()
        self.widths = given if fwhm is None else given / _native.FWHM
        self.ends = "causal" if causal else ends
        # With a number of frames that any axis may have, so that wrong steps and widths are found here.
        probe = _TimeOptions(self.dt, self._options.times, self.ends, self.widths.tolist() or [1.0])
        n_frames = 2 if self.times is None else len(self.times)
        _native.time_filter(np.zeros((1, n_frames)), probe, [1.0] * len(probe.widths))

    @property
    def fwhm(self) -> NDArray[np.float64]:
        """Full widths at half maximum of the bands."""
        return self.widths * _native.FWHM

    @property
    def delay(self) -> float:
        """Time by which smoothed values are late; 0 unless the axis is causal."""
        return _native.time_delay(2 if self.times is None else len(self.times), self._options)

    @property
    def _options(self) -> _TimeOptions:
        times = None if self.times is None else self.times.tolist()
        return _TimeOptions(self.dt, times, self.ends, self.widths.tolist())

    def smooth(self, values: ArrayLike, *, axis: int = -1, progress: ProgressLike = None) -> NDArray[Any]:
        """Smooth an array along time by the widest of the widths.

        Parameters
        ----------
        values : array_like
            Numbers with the frames along `axis`. A row of frames with NaN keeps its values.
        axis : int
            Axis of the frames.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        array of the shape of `values`, in their number type if they are floats
        """
        return self.filter(values, [0.0] * len(self.widths), axis=axis, progress=progress)

    def filter(
        self, values: ArrayLike, gains: Sequence[float], *, axis: int = -1, progress: ProgressLike = None
    ) -> NDArray[Any]:
        """Multiply the bands along time by gains, and sum them.

        Parameters
        ----------
        values, axis, progress
            As in `smooth`.
        gains : sequence of float
            A gain for each band, fine to coarse: 0 drops it, 1 keeps it.

        Returns
        -------
        array of the shape of `values`, in their number type if they are floats
        """
        numbers = [float(gain) for gain in gains]

        def change(rows: NDArray[np.float64], report: Callable[..., Any] | None) -> NDArray[np.float64]:
            return _native.time_filter(rows, self._options, numbers, report)

        return self._along(values, axis, progress, change)

    def decompose(self, values: ArrayLike, *, axis: int = -1, progress: ProgressLike = None) -> NDArray[Any]:
        """Split an array into its bands along time.

        Parameters
        ----------
        values, axis, progress
            As in `smooth`; a row of frames with NaN is NaN in all bands.

        Returns
        -------
        array of (widths + 1) × the shape of `values`
            The bands, fine to coarse, and the rest; they sum to `values`.
        """

        def split(rows: NDArray[np.float64], report: Callable[..., Any] | None) -> NDArray[np.float64]:
            return _native.time_bands(rows, self._options, report)

        return self._along(values, axis, progress, split)

    def _along(
        self,
        values: ArrayLike,
        axis: int,
        progress: ProgressLike,
        work: Callable[[NDArray[np.float64], Callable[..., Any] | None], NDArray[np.float64]],
    ) -> NDArray[Any]:
        """Results of a function of places × frames, in the axes of the values."""
        if not len(self.widths):
            raise TypeError(f"Time has no widths; give them: aw.Time(dt={self.dt or 2.0:g}, fwhm=4.0)")
        array = np.asarray(values)
        if array.ndim == 0:
            raise ValueError("values: a single number has no frames; give an array with the frames along its last axis")
        moved = np.moveaxis(array, axis, -1)
        if self.times is not None and moved.shape[-1] != len(self.times):
            raise ValueError(f"values: axis {axis} has {moved.shape[-1]} frames, and there are {len(self.times)} times")
        rows = np.ascontiguousarray(moved.reshape(-1, moved.shape[-1]), dtype=np.float64)
        with report_progress(progress, "filtering along time") as report:
            found = work(rows, report)
        found = found.reshape(*found.shape[:-2], *moved.shape)
        target = axis if axis < 0 else axis + found.ndim - array.ndim
        return np.moveaxis(found, -1, target).astype(float_type(array), copy=False)

    def __repr__(self) -> str:
        frames = f"{len(self.times)} times" if self.times is not None else f"a frame every {self.dt:g}"
        widths = "".join(f", FWHM {', '.join(f'{width:g}' for width in self.fwhm)}" for _ in [0] if len(self.widths))
        return f"<adwave.Time: {frames}{widths}, {self.ends}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_time, (self.dt, self.widths, self.ends, self.times)


def _restore_time(dt: float | None, widths: NDArray[np.float64], ends: Ends, times: NDArray[np.float64] | None) -> Time:
    return Time(dt, widths=widths.tolist() if len(widths) else None, ends=ends, times=times)


def frames_axis(layout: Layout) -> int:
    """Axis of the frames in the axes of a signal: its last axis, or the first if that of the vertices is the last.

    Raises
    ------
    ValueError
        If the signal has one number at each vertex.
    """
    if not layout.channels:
        raise ValueError(
            f"time: the signal has one number at each vertex, {layout.shape}, and no frames; give (n, times)"
        )
    return 0 if layout.is_last else -1


def split_in_time(time: Time, bands: NDArray[Any], layout: Layout, progress: ProgressLike) -> NDArray[Any]:
    """Bands (levels of space + 1) × (levels of time + 1) × the shape of the signal."""
    axis = frames_axis(layout)
    return np.moveaxis(time.decompose(bands, axis=axis if axis < 0 else axis + 1, progress=progress), 0, 1)


def frames_of(values: NDArray[np.float64], layout: Layout) -> NDArray[np.float64]:
    """Values of n × channels numbers as n × frames × components."""
    frames_axis(layout)
    channels = values.reshape(len(values), *layout.channels)
    moved = channels if layout.is_last else np.moveaxis(channels, -1, 1)
    return np.ascontiguousarray(moved.reshape(len(values), moved.shape[1], -1))


def channels_of(frames: NDArray[np.float64], layout: Layout) -> NDArray[np.float64]:
    """The reverse of `frames_of`."""
    if layout.is_last:
        return frames.reshape(len(frames), -1)
    times, others = layout.channels[-1], layout.channels[:-1]
    return np.moveaxis(frames.reshape(len(frames), times, *others), 1, -1).reshape(len(frames), -1)
