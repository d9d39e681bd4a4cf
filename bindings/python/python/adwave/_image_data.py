"""Images of VTK and PyVista: which of their arrays is meant, its axes and lengths, and results as an image."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Names of the class of images; the second is that of PyVista until 0.43.
CLASS_NAMES = ("ImageData", "UniformGrid", "vtkImageData")
#: Array in which VTK marks hidden and repeated points, which is no signal.
_GHOSTS = "vtkGhostType"


@dataclass(frozen=True)
class Scalars:
    """One array of an image, at its points or in its cells, which are voxels.

    Parameters
    ----------
    image : pyvista.ImageData
        The image.
    name : str or None
        Name of the array; None for the places alone, where a signal is given as numbers.
    at_points : bool
        True for `point_data`, False for `cell_data`.
    """

    image: Any
    name: str | None
    at_points: bool

    @property
    def _kept(self) -> list[int]:
        """Axes x, y, z as 0, 1, 2 that have more than one place, the slowest first."""
        counts = self._counts
        return [axis for axis in (2, 1, 0) if counts[axis] > 1] or [0]

    @property
    def _counts(self) -> list[int]:
        return [int(n) if self.at_points else max(int(n) - 1, 1) for n in self.image.dimensions]

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of places along each axis with more than one, the slowest first: (z, y, x), or (y, x) of a 2-D image."""
        return tuple(self._counts[axis] for axis in self._kept)

    @property
    def values(self) -> NDArray[Any]:
        """The array with the axes of `sizes`, and components last."""
        if self.name is None:
            return np.broadcast_to(0.0, self.sizes)
        array = np.asarray(self._data(self.image)[self.name])
        return array.reshape(*self.sizes, *array.shape[1:])

    @property
    def columns(self) -> NDArray[np.float64]:
        """Step from a place to the next along each axis of `sizes`, as the columns of a 3 × axes matrix."""
        steps = np.asarray(direction(self.image)) * np.asarray(self.image.spacing, dtype=np.float64)
        return steps[:, self._kept]

    @property
    def affine(self) -> NDArray[np.float64]:
        """Place of each index along x, y and z, 4 × 4."""
        matrix = np.eye(4)
        matrix[:3, :3] = np.asarray(direction(self.image)) * np.asarray(self.image.spacing, dtype=np.float64)
        matrix[:3, 3] = self.image.GetPoint(0)
        return matrix

    def fits(self, shape: tuple[int, ...]) -> bool:
        """True if an array of this shape has a value for each place."""
        sizes, n = self.sizes, math.prod(self.sizes)
        own = (shape[: len(sizes)], shape[-len(sizes) :])
        return bool(shape) and (shape[0] == n or shape[-1] == n or sizes in own)

    def positions(self, places: Sequence[int]) -> NDArray[np.float64]:
        """Positions of places by their numbers, n × 3, in the space of the image."""
        found = self.image if self.at_points else self.image.cell_centers()
        return np.array([found.GetPoint(int(place)) for place in places], dtype=np.float64).reshape(-1, 3)

    def rows(self, values: Any) -> NDArray[Any]:
        """Values with the axes of `sizes` in the order of the image, one row for each place."""
        array = np.asarray(values)
        return np.ascontiguousarray(array.reshape(-1, *array.shape[len(self.sizes) :]))

    def image_with(self, values: Any, name: str | None = None) -> Any:
        """A copy of the image with other values under the name of the array, or another name."""
        copy = self.image.copy()
        self._data(copy)[name or self.name] = self.rows(values)
        return copy

    def _data(self, image: Any) -> Any:
        return image.point_data if self.at_points else image.cell_data


def direction(image: Any) -> NDArray[np.float64]:
    """Directions of the axes x, y and z of an image as columns."""
    matrix = image.GetDirectionMatrix()
    return np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)])


def scalars_of(given: Any, signal: Any = None) -> Scalars:
    """The array of an image that is meant: by its name, by the number of values of a signal, or the active scalars.

    Raises
    ------
    ValueError
        If there is no array of this name, or none is active among several; the message names them.
    """
    if isinstance(given, Scalars):
        if signal is None:
            return given
        given = given.image
    image = given if hasattr(given, "active_scalars_name") else import_module("pyvista").wrap(given)
    if isinstance(signal, str):
        return _named(image, signal)
    if signal is not None:
        both = (Scalars(image, None, True), Scalars(image, None, False))
        return next((each for each in both if each.fits(np.shape(signal))), both[0])
    active = image.active_scalars_name
    if active in _names(image):
        return _named(image, active)
    names = _names(image)
    if len(names) == 1:
        return _named(image, names[0])
    if not names:
        raise ValueError(
            "array: the ImageData has no values; store them, image['values'] = values, or give them as the signal, "
            "aw.smooth(image, values, fwhm=8)"
        )
    raise ValueError(
        f"array: the ImageData has the arrays {', '.join(map(repr, names))}, and none is active; choose one, "
        f"image.set_active_scalars({names[0]!r}), or give its name as the signal, aw.smooth(image, {names[0]!r}, fwhm=8)"
    )


def _names(image: Any) -> list[str]:
    names = dict.fromkeys([*image.point_data.keys(), *image.cell_data.keys()])
    return [name for name in names if name != _GHOSTS]


def _named(image: Any, name: str) -> Scalars:
    at_points, in_cells = name in image.point_data, name in image.cell_data
    if at_points and in_cells:
        # PyVista counts points as 0 and cells as 1.
        active = image.active_scalars_info
        at_points = active.name != name or int(active.association.value) == 0
    elif not at_points and not in_cells:
        names = ", ".join(map(repr, _names(image))) or "none"
        raise ValueError(f"signal: the ImageData has no array {name!r}; it has {names}")
    return Scalars(image, name, at_points)
