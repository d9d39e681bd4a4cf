"""Filters for ParaView and VTK: wavelet bands, an equalizer, saliency, features, denoising.

In ParaView load this file as a plugin (Tools, Manage Plugins, Load New;
`python -c "import adwave.paraview as p; print(p.__file__)"` prints its path), if its Python has adwave and numpy; the filters are listed below *adwave*. They take surfaces
(`vtkPolyData`): for other datasets use Extract Surface first. The same classes work in VTK without ParaView:

    equalizer = adwave.paraview.Equalizer()
    equalizer.SetInputConnection(reader.GetOutputPort())
    equalizer.SetGains("2 1.5 1")
    equalizer.Update()

Errors are one line in ParaView's message window. The input is not changed in place.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

import adwave

try:
    from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy
except ImportError:  # VTK without ParaView, which alone needs the descriptions of properties

    class _NoDecorators:
        """Decorators that return the decorated object unchanged."""

        def __getattr__(self, _: str) -> Callable[..., Callable[[Any], Any]]:
            return lambda *_, **__: lambda described: described

    smdomain = smhint = smproperty = smproxy = _NoDecorators()

__all__ = ["Denoise", "Equalizer", "Features", "Saliency", "WaveletBands"]

_F = TypeVar("_F")


def _filter(name: str, label: str) -> Callable[[_F], _F]:
    def described(kind: _F) -> _F:
        kind = smdomain.datatype(dataTypes=["vtkPolyData"], composite_data_supported=False)(kind)
        kind = smproperty.input(name="Input")(kind)
        kind = smhint.xml('<ShowInMenu category="adwave"/>')(kind)
        return smproxy.filter(name=name, label=label)(kind)

    return described


def _shape(source: vtkPolyData) -> adwave.Shape:
    """Points and polygons of a surface, or its points if it has no polygons."""
    if source.GetNumberOfPoints() == 0:
        raise ValueError("the input has no points")
    if source.GetNumberOfStrips():
        raise ValueError("the input has triangle strips: use Triangulate first")
    points = vtk_to_numpy(source.GetPoints().GetData()).astype(float)
    cells = source.GetPolys()
    if cells.GetNumberOfCells() == 0:
        return adwave.Shape(points)
    corners, ends = vtk_to_numpy(cells.GetConnectivityArray()), vtk_to_numpy(cells.GetOffsetsArray())
    lengths = np.diff(ends)
    if (lengths == lengths[0]).all():
        return adwave.Shape(points, corners.reshape(-1, int(lengths[0])))
    return adwave.Shape(points, [part.tolist() for part in np.split(corners, ends[1:-1])])


def _add(target: vtkPolyData, name: str, values: np.ndarray, *, active: bool = False) -> None:
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    target.GetPointData().AddArray(array)
    if active:
        target.GetPointData().SetActiveScalars(name)


def _move(target: vtkPolyData, before: vtkPolyData, points: np.ndarray) -> None:
    """Set the points of a surface, in the number type of the input."""
    kind = vtk_to_numpy(before.GetPoints().GetData()).dtype
    moved = vtkPoints()
    moved.SetData(numpy_to_vtk(np.ascontiguousarray(points, kind), deep=True))
    target.SetPoints(moved)


class _Surface(VTKPythonAlgorithmBase):
    """A filter from a surface to a surface."""

    def __init__(self) -> None:
        super().__init__(nInputPorts=1, nOutputPorts=1, inputType="vtkPolyData", outputType="vtkPolyData")
        self._given: dict[str, Any] = {}

    def _set(self, name: str, value: Any) -> None:
        if self._given.get(name) != value:
            self._given[name] = value
            self.Modified()

    def _levels(self) -> int | None:
        return self._given.get("levels") or None

    def RequestData(self, request: Any, sources: Any, targets: Any) -> int:
        """Called by the pipeline."""
        source, target = vtkPolyData.GetData(sources[0]), vtkPolyData.GetData(targets)
        target.ShallowCopy(source)
        self._compute(_shape(source), source, target)
        return 1

    def _compute(self, shape: adwave.Shape, source: vtkPolyData, target: vtkPolyData) -> None:
        raise NotImplementedError


@_filter("AdwaveWaveletBands", "Wavelet bands")
class WaveletBands(_Surface):
    """Vectors W1 … WJ (fine to coarse) and S (the rest) at the points, and the sizes |W1| … |WJ|."""

    @smproperty.intvector(name="Levels", default_values=0)
    @smdomain.intrange(min=0, max=24)
    def SetLevels(self, levels: int) -> None:
        """Set the number of levels; 0 for the default."""
        self._set("levels", int(levels))

    def _compute(self, shape: adwave.Shape, source: vtkPolyData, target: vtkPolyData) -> None:
        bands = adwave.decompose(shape, levels=self._levels())
        for level in range(1, bands.n_levels + 1):
            wavelet = bands.wavelet(level)
            _add(target, f"W{level}", wavelet)
            _add(target, f"|W{level}|", np.linalg.norm(wavelet, axis=1), active=level == 1)
        _add(target, "S", bands.scaling(bands.n_levels))


@_filter("AdwaveEqualizer", "Equalizer")
class Equalizer(_Surface):
    """The surface with each band multiplied by its gain, everywhere or in a region."""

    @smproperty.stringvector(name="Gains", default_values="")
    def SetGains(self, gains: str) -> None:
        """Set the gain of each level, fine to coarse, such as ``2 1.5 1``; the last holds for all coarser levels."""
        self._set("gains", gains.replace(",", " ").strip())

    @smproperty.stringvector(name="Preset", default_values="smooth")
    def SetPreset(self, preset: str) -> None:
        """Set the preset that is used without gains: smooth, enhance, suppress, …"""
        self._set("preset", preset.strip())

    @smproperty.stringvector(name="Region", default_values="")
    def SetRegion(self, region: str) -> None:
        """Set the region, such as ``ball:vertex=120,radius=10%``; everywhere by default."""
        self._set("region", region.strip())

    @smproperty.intvector(name="Levels", default_values=0)
    @smdomain.intrange(min=0, max=24)
    def SetLevels(self, levels: int) -> None:
        """Set the number of levels; 0 for the default."""
        self._set("levels", int(levels))

    def _compute(self, shape: adwave.Shape, source: vtkPolyData, target: vtkPolyData) -> None:
        words = self._given.get("gains", "").split()
        where = self._given.get("region") or None
        bands = adwave.decompose(shape, levels=self._levels())
        if words:
            gains = [float(word) for word in words][: bands.n_levels]
            gains += [gains[-1]] * (bands.n_levels - len(gains))
        else:
            gains = list(adwave.preset_gains(self._given.get("preset") or "smooth", bands.n_levels))
        _move(target, source, bands.apply(gains, where=where))


@_filter("AdwaveSaliency", "Saliency")
class Saliency(_Surface):
    """The field ``saliency``: positive where the surface stands out, negative where it is hollow."""

    def _compute(self, shape: adwave.Shape, source: vtkPolyData, target: vtkPolyData) -> None:
        _add(target, "saliency", np.asarray(adwave.saliency(shape)), active=True)


@_filter("AdwaveFeatures", "Features")
class Features(_Surface):
    """The features, as points with ``level``, ``sigma`` (rms width, model units), ``strength``, ``sign`` and ``vertex``.

    Glyphs of size sigma show them.
    """

    @smproperty.doublevector(name="Theta", default_values=1.6)
    def SetTheta(self, theta: float) -> None:
        """Set the smallest response of a feature, in multiples of the mean of its level; larger for fewer features."""
        self._set("theta", float(theta))

    def _compute(self, shape: adwave.Shape, source: vtkPolyData, target: vtkPolyData) -> None:
        theta = self._given.get("theta")
        found = adwave.features(shape) if theta is None else adwave.features(shape, theta=theta)
        target.Initialize()
        points, cells = vtkPoints(), vtkCellArray()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(np.reshape(found["position"], (-1, 3))), deep=True))
        for k in range(len(found)):
            cells.InsertNextCell(1, [k])
        target.SetPoints(points)
        target.SetVerts(cells)
        for name in ("level", "sigma", "strength", "sign", "vertex"):
            _add(target, name, np.asarray(found[name]).astype(float), active=name == "sigma")


@_filter("AdwaveDenoise", "Denoise")
class Denoise(_Surface):
    """The surface without noise, whose size is estimated; creases are preserved."""

    @smproperty.doublevector(name="Strength", default_values=1.0)
    def SetStrength(self, strength: float) -> None:
        """Set the factor of the estimated noise: below 1 more careful, above 1 more thorough."""
        self._set("strength", float(strength))

    def _compute(self, shape: adwave.Shape, source: vtkPolyData, target: vtkPolyData) -> None:
        clean = adwave.denoise(shape, strength=self._given.get("strength", 1.0)).result
        _move(target, source, clean.points)
