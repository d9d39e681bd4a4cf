"""`Sequence`: frames of one connectivity, a shape that moves."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterator
from pathlib import Path as FilePath
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave._denoise import denoise
from adwave._denoise_info import DenoiseInfo
from adwave._edits import decompose, filter, smooth
from adwave._methods import Members
from adwave._options import Length, LevelsLike
from adwave._progress import ProgressLike
from adwave._shape import Path, Shape, as_shape, read
from adwave._time import Time


class CleanSequence(NamedTuple):
    """A sequence without noise, and the estimates.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ball = aw.sample("sphere", vertices=300)
    >>> jitter = ball.points + 0.01 * np.random.default_rng(0).normal(size=(20, ball.n_vertices, 3))
    >>> clean, info = aw.sequence(jitter, faces=ball.faces).denoise()
    >>> sorted(info)
    ['mean_steps', 'noise', 'risk', 'steps', 'weights', 'widths']
    """

    result: Sequence
    info: DenoiseInfo


class Sequence(Members):
    """A shape that moves: frames with the same vertices and faces, in the order of time.

    The positions over time are a signal on the first frame, three numbers for each vertex and frame. All methods return new
    sequences.

    Parameters
    ----------
    frames : path_like, sequence of shape_like, or (frames, n, 3) array_like
        Files by a folder or a pattern (``"walk/*.obj"``, in the order of their names), shapes, or positions alone.
    dt : float
        Time from frame to frame.
    faces : array_like, optional
        Faces of positions that are given alone; without them the frames are clouds.

    Raises
    ------
    ValueError
        If there are fewer than two frames, or frames have other numbers of vertices or other faces than the first.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ball = aw.sample("sphere", vertices=500)
    >>> turns = 0.1 * np.arange(20)
    >>> rotations = np.array([[[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]] for t in turns])
    >>> noise = 0.01 * np.random.default_rng(0).normal(size=(20, ball.n_vertices, 3))
    >>> moving = aw.sequence(ball.points @ rotations.transpose(0, 2, 1) + noise, faces=ball.faces)
    >>> moving
    <adwave.Sequence: 20 frames of 500 vertices, one every 1>
    >>> clean, info = moving.denoise()
    >>> bool(abs(info["noise"] - 0.01) < 0.002)
    True
    """

    __slots__ = ("dt", "points", "shape")

    #: Positions, frames × vertices × 3.
    points: NDArray[np.float64]
    #: The first frame, with what its file has.
    shape: Shape
    #: Time from frame to frame.
    dt: float

    def __init__(self, frames: object, dt: float = 1.0, *, faces: object = None) -> None:
        self.shape, self.points = _read_frames(frames, faces)
        self.dt = float(dt)
        if not (np.isfinite(self.dt) and self.dt > 0):
            raise ValueError(f"dt: the time from frame to frame must be a finite number above 0, got {dt}")

    @classmethod
    def _from_parts(cls, shape: Shape, points: NDArray[np.float64], dt: float) -> Sequence:
        made = cls.__new__(cls)
        made.shape, made.points, made.dt = shape, points, dt
        return made

    def _with_series(self, series: NDArray[Any]) -> Sequence:
        """This sequence with positions n × 3 × frames."""
        return Sequence._from_parts(self.shape, np.ascontiguousarray(np.moveaxis(series, 2, 0)), self.dt)

    @property
    def series(self) -> NDArray[np.float64]:
        """Positions as a signal on the vertices, n × 3 × frames."""
        return np.ascontiguousarray(np.moveaxis(self.points, 0, 2))

    @property
    def n_vertices(self) -> int:
        """Number of vertices of each frame."""
        return self.points.shape[1]

    def smooth(
        self,
        *,
        time: float | None = None,
        fwhm: Length | None = None,
        causal: bool = False,
        progress: ProgressLike = None,
    ) -> Sequence:
        """Smooth the motion along time, and the positions of each frame in space.

        Parameters
        ----------
        time : float, optional
            Full width at half maximum along time, in the unit of `dt`.
        fwhm : float or str, optional
            Full width at half maximum in space, which takes detail away.
        causal : bool
            Whether each frame depends on itself and earlier ones alone.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        if time is None and fwhm is None:
            raise TypeError("smooth takes a width along time, in space, or both: sequence.smooth(time=3.0)")
        series = self.series
        if fwhm is not None:
            series = smooth(self.shape, series, fwhm=fwhm, progress=progress)
        if time is not None:
            series = Time(self.dt, fwhm=time, causal=causal).smooth(series, progress=progress)
        return self._with_series(series)

    def filter(
        self,
        gains: ArrayLike,
        *,
        time: ArrayLike | None = None,
        levels: LevelsLike = None,
        progress: ProgressLike = None,
    ) -> Sequence:
        """Multiply bands of the motion by gains: along time, or, without `time`, in space.

        ``filter([2, 1], time=[3, 12])`` doubles what is faster than 3; ``filter([0, 0, 1.5])`` works on the displacements of
        each frame from the mean over all frames, fine to coarse in space, and leaves the mean as it is.

        Parameters
        ----------
        gains : sequence of float
            A gain for each band, fine to coarse. In space one more may be that of the rest, the motion of large parts; it is
            1 if it is left out.
        time : sequence of float, optional
            Full widths at half maximum of the bands along time.
        levels : int, Widths, Steps or Octaves, optional
            Levels in space; by default one for each gain, which are small parts.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> ball = aw.sample("sphere", vertices=500)
        >>> swing = aw.sequence([ball.with_points(ball.points + [0.1 * np.sin(t), 0, 0]) for t in range(6)])
        >>> wide = swing.filter([1, 2], levels=aw.Widths(fwhm=["10%"]))
        >>> bool(np.allclose(np.ptp(wide.points[:, 0], axis=0), 2 * np.ptp(swing.points[:, 0], axis=0)))
        True
        """
        numbers = np.atleast_1d(np.asarray(gains, dtype=np.float64)).tolist()
        series = self.series
        if time is not None:
            if levels is not None:
                raise TypeError("filter takes levels in space or widths along time; leave one out")
            axis = Time(self.dt, fwhm=np.atleast_1d(np.asarray(time, dtype=np.float64)).tolist())
            return self._with_series(axis.filter(series, numbers, progress=progress))
        mean = series.mean(axis=2, keepdims=True)
        moved = series - mean
        n_levels = len(numbers)
        if levels is not None:
            n_levels = len(np.asarray(decompose(self.shape, series[:, 0, 0], levels=levels))) - 1
        if len(numbers) not in (n_levels, n_levels + 1):
            raise ValueError(
                f"gains must have a number for each band, {n_levels}, and may have one more for the rest, got {len(numbers)}"
            )
        rest = numbers[n_levels] if len(numbers) > n_levels else 1.0
        # The rest is what the displacements are without their bands.
        gains = [gain - rest + 1 for gain in numbers[:n_levels]]
        edited = filter(self.shape, moved, gains, levels=levels, local_fit="constant", progress=progress)
        return self._with_series(mean + edited + (rest - 1) * moved)

    def motion(self, *, levels: LevelsLike = None, progress: ProgressLike = None) -> NDArray[np.float64]:
        """Map how much each vertex moves by size of what moves: root mean squares over time, (levels + 1) × n.

        Parameters
        ----------
        levels : int, Widths, Steps or Octaves, optional
            Levels of the displacements from the mean over all frames, as in `adwave.decompose`.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        series = self.series
        bands = decompose(self.shape, series - series.mean(axis=2, keepdims=True), levels=levels, progress=progress)
        return np.sqrt((np.asarray(bands) ** 2).sum(axis=2).mean(axis=2))

    def denoise(
        self, *, strength: float = 1.0, noise: float | None = None, progress: ProgressLike = None
    ) -> CleanSequence:
        """Remove jitter, noise that is independent between vertices and frames; its amount is estimated.

        Parameters
        ----------
        strength : float
            Factor of the noise: below 1 more careful, above 1 more thorough.
        noise : float, optional
            Standard deviation of each coordinate, if it is known.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        time = Time(self.dt)
        found = denoise(self.shape, self.series, strength=strength, noise=noise, time=time, progress=progress)
        return CleanSequence(self._with_series(found.result), found.info)

    def without_motion(self) -> Sequence:
        """Take the rigid motion of the whole out: turn and move each frame onto the mean of all, by least squares."""
        points = self.points - self.points.mean(axis=1, keepdims=True)
        target = turned = points[0]
        for _ in range(10):
            turned = np.stack([frame @ _rotation(frame, target) for frame in points])
            mean = turned.mean(axis=0)
            if np.allclose(mean, target, rtol=0, atol=1e-12 * np.abs(points).max()):
                break
            target = mean
        return Sequence._from_parts(self.shape, turned + self.points[0].mean(axis=0), self.dt)

    def write(self, folder: Path, *, format: str = "ply") -> list[str]:
        """Write each frame as a file of the folder, ``0001.ply`` and so on.

        Returns
        -------
        list of str
            The paths.
        """
        place = FilePath(os.fspath(folder))
        place.mkdir(parents=True, exist_ok=True)
        width = max(4, len(str(len(self))))
        paths = [str(place / f"{k:0{width}}.{format}") for k in range(1, len(self) + 1)]
        for frame, path in zip(self, paths, strict=True):
            frame.write(path)
        return paths

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, index: int) -> Shape:
        return self.shape.with_points(self.points[index])

    def __iter__(self) -> Iterator[Shape]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<adwave.Sequence: {len(self)} frames of {self.n_vertices} vertices, one every {self.dt:g}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Sequence._from_parts, (self.shape, self.points, self.dt)


def sequence(frames: Union[Path, object], dt: float = 1.0, *, faces: object = None) -> Sequence:
    """Make a `Sequence` from frames of one connectivity: files, shapes or positions.

    Parameters
    ----------
    frames, dt, faces
        As in `Sequence`.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ball = aw.sample("sphere", vertices=300)
    >>> pulse = [ball.with_points(ball.points * (1 + 0.1 * np.sin(t))) for t in range(12)]
    >>> len(aw.sequence(pulse, dt=0.04).smooth(time=0.1))
    12
    """
    return Sequence(frames, dt, faces=faces)


def _read_frames(frames: object, faces: object) -> tuple[Shape, NDArray[np.float64]]:
    """The first frame, and the positions of all."""
    if isinstance(frames, (str, os.PathLike)):
        name = os.fspath(frames)
        pattern = os.path.join(name, "*") if os.path.isdir(name) else name
        paths = sorted(path for path in glob.glob(pattern) if os.path.isfile(path))
        if len(paths) < 2:
            raise ValueError(f"frames: {name} names {len(paths)} files, and a sequence has two frames or more")
        frames = [read(path) for path in paths]
    if isinstance(frames, np.ndarray):
        if frames.ndim != 3 or frames.shape[2] != 3 or len(frames) < 2:
            raise ValueError(f"frames: positions must be (frames, n, 3) with two frames or more, got {frames.shape}")
        shape = as_shape(np.ascontiguousarray(frames[0], dtype=np.float64), faces)
        return shape, np.array(frames, dtype=np.float64)
    shapes = [as_shape(frame) for frame in frames]  # type: ignore[attr-defined]
    if len(shapes) < 2:
        raise ValueError(f"frames: a sequence has two frames or more, got {len(shapes)}")
    first = shapes[0]
    for k, shape in enumerate(shapes):
        if shape.n_vertices != first.n_vertices:
            raise ValueError(
                f"frames: all need the same vertices, and frame {k} has {shape.n_vertices} where the first has "
                f"{first.n_vertices}"
            )
        if shape.n_faces != first.n_faces or not _has_faces_of(shape, first):
            raise ValueError(f"frames: all need the same faces, and those of frame {k} differ from those of the first")
    return first, np.stack([shape.points for shape in shapes])


def _has_faces_of(shape: Shape, first: Shape) -> bool:
    return first.n_faces == 0 or all(map(np.array_equal, shape.polygons(), first.polygons()))


def _rotation(frame: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rotation R that brings ``frame @ R`` closest to the target; both are centered."""
    left, _, right = np.linalg.svd(frame.T @ target)
    sign = np.sign(np.linalg.det(left @ right))
    return (left * np.array([1.0, 1.0, sign])) @ right
