"""Images and volumes of other libraries, in and out: xarray, nibabel, SimpleITK, PyVista and rasterio.

No library is imported before an object of it arrives; each is known by the module and the attributes of its class.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave import _image_data
from adwave._caller import Call, warn
from adwave._grid_layout import MAX_AXES, MAX_COLORS
from adwave._misfit import working_line

#: Largest difference between steps of a coordinate, relative to their mean: that of coordinates in 32 bits.
UNEVEN = 1e-3
#: Largest cosine of the angle between two axes that count as orthogonal.
SHEARED = 1e-3
#: Names of dimensions of xarray that are channels rather than places.
CHANNEL_NAMES = ("band", "channel", "c", "variable", "member", "number", "ensemble", "realization", "time", "t")


@dataclass
class FoundGrid:
    """Values of an image or a volume, and what the object says about its axes.

    Parameters
    ----------
    values : object
        An array, or nested lists.
    axes : tuple of int, optional
        Axes of the grid, if the object knows them.
    spacing : sequence of float or None, optional
        Distance along each axis of the array that the object knows; None along the others.
    affine : (4, 4) array, optional
        Places of the voxels, which those of a mask must equal.
    names : sequence of str, optional
        Names of the axes of the array.
    library : str, optional
        The library of the object; None for arrays.
    """

    values: Any
    axes: tuple[int, ...] | None = None
    spacing: Sequence[float | None] | None = None
    affine: NDArray[np.float64] | None = None
    names: Sequence[str] | None = None
    library: str | None = None

    def spacing_of(self, axis: int) -> float:
        """Distance along an axis of the array; 1 if the object has none."""
        own = self.spacing[axis] if self.spacing is not None else None
        return 1.0 if own is None else float(own)


def find_grid(given: Any, axes: Any = None) -> FoundGrid:
    """Values and axes of an object: those of its library, or an array.

    Raises
    ------
    TypeError, ValueError
        If the object is no image, or has no even spacing along an axis of the grid.
    """
    library = library_of_grid(given)
    if library is None:
        _refuse_others(given)
        return FoundGrid(given)
    found = _READERS[library](given, axes)
    found.library = library
    return found


def library_of_grid(given: object) -> str | None:
    """Library of an image or a volume; None for arrays and other objects."""
    if isinstance(given, np.ndarray):
        return None
    if isinstance(given, _image_data.Scalars):
        return "pyvista"
    for cls in type(given).__mro__:
        root = cls.__module__.partition(".")[0]
        if root == "xarray" and cls.__name__ == "DataArray":
            return "xarray"
        if root == "SimpleITK" and cls.__name__ == "Image":
            return "SimpleITK"
        if root in ("pyvista", "vtkmodules", "vtk") and cls.__name__ in _image_data.CLASS_NAMES:
            return "pyvista"
        if root == "rasterio" and hasattr(given, "transform"):
            return "rasterio"
    if all(hasattr(given, name) for name in ("dataobj", "affine", "header")):
        return "nibabel"
    return None


def is_image(given: object) -> bool:
    """True for an image or a volume of a library that has no other shapes of its kind."""
    return library_of_grid(given) in ("nibabel", "SimpleITK", "rasterio", "pyvista")


def refuse_image_file(function: str, path: object) -> None:
    """Raise TypeError for the path of an image that another library reads, with the line that reads it."""
    if not isinstance(path, (str, os.PathLike)):
        return
    name = os.fspath(path).lower()
    reader = next((reader for reader, ends in _FILE_READERS.items() if name.endswith(ends)), None)
    if reader is None or re.search(r"\.[dp][a-z]+\.nii$", name):  # CIFTI files are meshes with values.
        return

    def load(call: Call) -> None:
        if call.is_method:
            call.function, call.is_method = f"aw.{call.name}", False
        call.arguments[:1] = [f"{reader}({call.arguments[0] if call.arguments else repr(path)})"]

    line = working_line(function, load, f"aw.{function}({reader}(path))")
    line = line.replace("; write ", f"; write import {reader.partition('.')[0]}; ", 1)
    raise TypeError(f"{function}: {path!r} is the file of an image, which {reader} reads{line}")


#: Functions that read files of images, by the ends of their names.
_FILE_READERS = {
    "nibabel.load": (".nii", ".nii.gz", ".mgz", ".mgh", ".hdr", ".img"),
    "SimpleITK.ReadImage": (".nrrd", ".nhdr", ".mha", ".mhd"),
}


def _refuse_others(given: object) -> None:
    refuse_image_file("grid", given)
    if isinstance(given, (str, bytes)) or hasattr(given, "__fspath__"):
        raise TypeError(
            f"array: {given!r} is a path or text; read it first, as in aw.grid(nibabel.load(path)), "
            "aw.grid(xarray.open_dataarray(path)) or aw.grid(imageio.imread(path), axes=(0, 1))"
        )
    if type(given).__module__.partition(".")[0] == "xarray":
        raise TypeError("array: an xarray.Dataset has several variables; pass one of them, aw.grid(dataset['name'])")
    if given is None:
        raise TypeError("array: None has no places; pass an image or a volume, aw.grid(np.zeros((64, 64)))")


def _read_xarray(given: Any, axes: Any) -> FoundGrid:
    names = [str(name) for name in given.dims]
    if axes is not None:
        each = [axes] if isinstance(axes, (str, int)) else list(axes)
        unknown = [name for name in each if isinstance(name, str) and name not in names]
        if unknown:
            raise ValueError(f"axes: {unknown[0]!r} is no dimension; the DataArray has {', '.join(names)}")
        chosen = tuple(names.index(name) if isinstance(name, str) else int(name) % len(names) for name in each)
    else:
        chosen = _own_dimensions(given, names)
    spacing: list[float | None] = [None] * len(names)
    for axis in chosen:
        spacing[axis] = _even_spacing(given, names[axis])
    return FoundGrid(given.values, chosen, spacing, names=names)


def _own_dimensions(given: Any, names: list[str]) -> tuple[int, ...]:
    """Dimensions of the grid of a DataArray, unless they need to be named."""

    def is_channel(axis: int) -> bool:
        coordinate = given.coords.get(names[axis])
        is_number = coordinate is None or coordinate.dtype.kind in "iuf"
        return not is_number or names[axis].lower() in CHANNEL_NAMES

    places = [axis for axis in range(len(names)) if not is_channel(axis)]
    is_clear = len(places) == len(names) <= MAX_AXES
    if is_clear and len(names) == MAX_AXES:
        is_clear = given.shape[0] > MAX_COLORS and given.shape[-1] > MAX_COLORS
    if is_clear:
        return tuple(places)
    some = tuple(names[axis] for axis in (places or range(len(names)))[-MAX_AXES:])
    also = tuple(names[-MAX_AXES:]) if some != tuple(names[-MAX_AXES:]) else tuple(names[-2:])
    raise ValueError(
        f"array: the DataArray has the dimensions {', '.join(names)}; name those of the grid, aw.grid(array, axes={some!r}) "
        f"or aw.grid(array, axes={also!r}): the others are channels"
    )


def _even_spacing(given: Any, name: str) -> float:
    coordinate = given.coords.get(name)
    if coordinate is None or coordinate.ndim != 1 or coordinate.size < 2:
        return 1.0
    if coordinate.dtype.kind not in "iuf":
        raise ValueError(
            f"axes: the coordinate {name!r} has no lengths (dtype {coordinate.dtype}); leave it out of axes, or give "
            f"lengths, aw.grid(array.drop_vars({name!r}), axes=…, spacing=…)"
        )
    steps = np.diff(np.asarray(coordinate.values, dtype=np.float64))
    mean = float(steps.mean())
    if mean == 0 or not np.isfinite(mean) or np.abs(steps - mean).max() > UNEVEN * abs(mean):
        raise ValueError(
            f"array: the coordinate {name!r} has steps of {steps.min():g} to {steps.max():g}, and a grid has even ones; "
            f"interpolate it, array.interp({name}=np.linspace(…)), or count in places, aw.grid(array.drop_vars({name!r}))"
        )
    return abs(mean)


def _read_nibabel(given: Any, _: Any) -> FoundGrid:
    values = np.asanyarray(given.dataobj)
    n = min(values.ndim, MAX_AXES)
    affine = given.affine
    if affine is None:
        zooms: list[float] = [float(zoom) for zoom in given.header.get_zooms()[:n]]
        return FoundGrid(values, tuple(range(n)), [*zooms, *[None] * (values.ndim - n)])
    affine = np.asarray(affine, dtype=np.float64)
    lengths = _lengths_of(affine[:3, :n], "np.asarray(image.dataobj)")
    return FoundGrid(values, tuple(range(n)), [*lengths, *[None] * (values.ndim - n)], affine=affine)


def _lengths_of(columns: NDArray[np.float64], array: str) -> list[float]:
    """Lengths of the steps along the axes of an image, with a warning if they are not at right angles."""
    lengths = np.sqrt((columns**2).sum(axis=0))
    if not (lengths > 0).all():
        raise ValueError(
            f"array: an axis of the image has no length; give lengths, aw.grid({array}, spacing=(1.0, 1.0, 1.0))"
        )
    cosines = np.abs((columns / lengths).T @ (columns / lengths) - np.eye(len(lengths))).max()
    if cosines > SHEARED:
        warn(
            f"array: the axes of the image are sheared (cosine {cosines:.3g} between two of them); lengths are taken along "
            "the axes: resample the image for exact ones"
        )
    return [float(length) for length in lengths]


def _read_simpleitk(given: Any, _: Any) -> FoundGrid:
    # The order of its axes is the reverse of that of the array, and components come last.
    n = int(given.GetDimension())
    if n > MAX_AXES:
        raise ValueError(
            f"array: the image has {n} dimensions; take a volume of it, aw.grid(image[:, :, :, 0]), or its values, "
            "aw.grid(SimpleITK.GetArrayFromImage(image), axes=(1, 2, 3))"
        )
    values = import_module("SimpleITK").GetArrayFromImage(given)
    spacing: list[float | None] = [float(h) for h in reversed(given.GetSpacing())]
    return FoundGrid(values, tuple(range(n)), [*spacing, *[None] * (values.ndim - n)])


def _read_pyvista(given: Any, _: Any) -> FoundGrid:
    scalars = _image_data.scalars_of(given)
    array, n = scalars.values, len(scalars.sizes)
    lengths = _lengths_of(scalars.columns, f"array.reshape({scalars.sizes})")
    return FoundGrid(array, tuple(range(n)), [*lengths, *[None] * (array.ndim - n)], affine=scalars.affine)


def _read_rasterio(given: Any, _: Any) -> FoundGrid:
    transform = given.transform
    spacing: list[float | None] = [
        None,
        float(np.hypot(transform.b, transform.e)),
        float(np.hypot(transform.a, transform.d)),
    ]
    if getattr(given.crs, "is_geographic", False):
        warn(
            "array: the raster is in degrees, which are shorter from east to west than from north to south; lengths are "
            "degrees: reproject it for meters"
        )
    return FoundGrid(given.read(masked=True), (1, 2), spacing)


_READERS: dict[str, Callable[[Any, Any], FoundGrid]] = {
    "xarray": _read_xarray,
    "nibabel": _read_nibabel,
    "SimpleITK": _read_simpleitk,
    "pyvista": _read_pyvista,
    "rasterio": _read_rasterio,
}


def results_like(given: Any, library: str | None, values: NDArray[Any]) -> Any:
    """Values as an object like the given one, with its places and metadata; an array for arrays and rasterio."""
    return _WRITERS[library](given, values) if library in _WRITERS else values


def _to_xarray(given: Any, values: NDArray[Any]) -> Any:
    return given.copy(data=values)


def _to_nibabel(given: Any, values: NDArray[Any]) -> Any:
    header = given.header.copy()
    header.set_data_dtype(values.dtype)
    return type(given)(values, given.affine, header)


def _to_simpleitk(given: Any, values: NDArray[Any]) -> Any:
    is_vector = values.ndim > int(given.GetDimension())
    image = import_module("SimpleITK").GetImageFromArray(np.ascontiguousarray(values), isVector=is_vector)
    image.CopyInformation(given)
    for key in given.GetMetaDataKeys():
        image.SetMetaData(key, given.GetMetaData(key))
    return image


def _to_pyvista(given: Any, values: NDArray[Any]) -> Any:
    return _image_data.scalars_of(given).image_with(values)


_WRITERS: dict[str | None, Callable[[Any, NDArray[Any]], Any]] = {
    "xarray": _to_xarray,
    "nibabel": _to_nibabel,
    "SimpleITK": _to_simpleitk,
    "pyvista": _to_pyvista,
}


def check_same_places(array: FoundGrid, mask: FoundGrid) -> None:
    """Refuse a mask that lies elsewhere.

    Raises
    ------
    ValueError
        If both have an affine, and these differ.
    """
    if array.affine is None or mask.affine is None or array.library != mask.library:
        return
    if not np.allclose(array.affine, mask.affine, rtol=1e-4, atol=1e-3):
        other = "mask.resample(reference_image=image, interpolation='nearest')"
        if array.library != "pyvista":
            other = "nilearn.image.resample_to_img(mask, image, interpolation='nearest')"
        raise ValueError(f"mask: its affine differs from that of the image; resample it, {other}")
