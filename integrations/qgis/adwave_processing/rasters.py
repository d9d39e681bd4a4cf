"""Algorithms on rasters: smooth, denoise, relief by scale, what stands out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from osgeo import gdal
from qgis.core import (
    QgsDistanceArea,
    QgsPointXY,
    QgsProcessingException,
    QgsProcessingParameterBand,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterRasterLayer,
    QgsRasterLayer,
    QgsUnitTypes,
)

from adwave_processing.common import Algorithm, package, progress_of

#: Value of places without data in written rasters.
NODATA = -9999.0


@dataclass
class Raster:
    """One band of a raster.

    Attributes
    ----------
    values
        Rows × columns; NaN where there are no data.
    spacing
        Height and width of a cell in meters.
    transform, projection
        Place of the raster, as GDAL gives them.
    """

    values: np.ndarray
    spacing: tuple[float, float]
    transform: tuple[float, ...]
    projection: str

    def grid(self) -> Any:
        """The raster as a grid of adwave."""
        return package().grid(self.values, spacing=self.spacing)


def cell_size(layer: QgsRasterLayer, context: Any) -> tuple[float, float]:
    """Height and width in meters of the cell at the center of a layer, on the ellipsoid if the layer is in degrees."""
    height, width = layer.rasterUnitsPerPixelY(), layer.rasterUnitsPerPixelX()
    if layer.crs().isGeographic():
        measure = QgsDistanceArea()
        measure.setSourceCrs(layer.crs(), context.transformContext())
        measure.setEllipsoid(layer.crs().ellipsoidAcronym() or "EPSG:7030")
        center = layer.extent().center()
        north = measure.measureLine(center, QgsPointXY(center.x(), center.y() + height))
        east = measure.measureLine(center, QgsPointXY(center.x() + width, center.y()))
        return north, east
    unit = layer.crs().mapUnits()
    if unit == QgsUnitTypes.DistanceUnknownUnit:
        return height, width
    factor = QgsUnitTypes.fromUnitToUnitFactor(unit, QgsUnitTypes.DistanceMeters)
    return factor * height, factor * width


def read(layer: QgsRasterLayer, band: int, context: Any) -> Raster:
    """One band of a layer.

    Raises
    ------
    QgsProcessingException
        If GDAL cannot open the source of the layer.
    """
    dataset = gdal.Open(layer.source())
    if dataset is None:
        raise QgsProcessingException(f"GDAL cannot open {layer.source()}; save the layer as a GeoTIFF first")
    source = dataset.GetRasterBand(band)
    values = source.ReadAsArray().astype(np.float64)
    values[source.GetMaskBand().ReadAsArray() == 0] = np.nan
    spacing = cell_size(layer, context)
    return Raster(values, spacing, dataset.GetGeoTransform(), dataset.GetProjection())


def write(path: str, raster: Raster, values: np.ndarray) -> None:
    """Write values at the place of a raster, as 32-bit floats.

    Raises
    ------
    QgsProcessingException
        If the file cannot be written.
    """
    rows, columns = values.shape
    options = ["COMPRESS=DEFLATE", "PREDICTOR=3"] if path.lower().endswith((".tif", ".tiff")) else []
    driver = gdal.GetDriverByName("GTiff" if options else gdal.IdentifyDriver(path) or "GTiff")
    dataset = driver.Create(path, columns, rows, 1, gdal.GDT_Float32, options)
    if dataset is None:
        raise QgsProcessingException(f"GDAL cannot write {path}; choose another folder or a GeoTIFF")
    dataset.SetGeoTransform(raster.transform)
    dataset.SetProjection(raster.projection)
    band = dataset.GetRasterBand(1)
    band.SetNoDataValue(NODATA)
    band.WriteArray(np.where(np.isnan(values), NODATA, values).astype(np.float32))
    band.FlushCache()


class RasterAlgorithm(Algorithm):
    """An algorithm from one band of a raster to a raster of the same place."""

    GROUP = "Raster"

    def initAlgorithm(self, configuration: Any = None) -> None:
        self.addParameter(QgsProcessingParameterRasterLayer("INPUT", "Raster"))
        self.addParameter(QgsProcessingParameterBand("BAND", "Band", 1, "INPUT", optional=True))
        self.add_parameters()
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", self.TITLE))

    def add_parameters(self) -> None:
        """Parameters between the input and the output."""

    def add_width(self, name: str, text: str, default: float, least: float = 0.0) -> None:
        """Add a width in meters."""
        kind = QgsProcessingParameterNumber.Double
        self.addParameter(QgsProcessingParameterNumber(name, text, kind, default, minValue=least))

    def values(self, raster: Raster, parameters: dict[str, Any], context: Any, feedback: Any) -> np.ndarray:
        """Values of the result, NaN without data."""
        raise NotImplementedError

    def compute(self, parameters: dict[str, Any], context: Any, feedback: Any) -> dict[str, Any]:
        layer = self.parameterAsRasterLayer(parameters, "INPUT", context)
        if layer is None:
            raise QgsProcessingException(self.invalidRasterError(parameters, "INPUT"))
        raster = read(layer, max(1, self.parameterAsInt(parameters, "BAND", context)), context)
        feedback.pushInfo(f"cells of {raster.spacing[0]:g} × {raster.spacing[1]:g} m")
        values = self.values(raster, parameters, context, feedback)
        path = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        write(path, raster, np.asarray(values, dtype=float))
        return {"OUTPUT": path}


class SmoothRaster(RasterAlgorithm):
    """Smoothing by a width in meters."""

    NAME = "smoothraster"
    TITLE = "Smooth a raster by a width"
    HELP = (
        "Smooths by the discrete Gaussian of a full width at half maximum in meters, in any direction. Places without "
        "data take no part, and nothing crosses them. Any width takes the same time."
    )

    def add_parameters(self) -> None:
        self.add_width("FWHM", "Full width at half maximum, in meters", 100.0)

    def values(self, raster: Raster, parameters: dict[str, Any], context: Any, feedback: Any) -> np.ndarray:
        width = self.parameterAsDouble(parameters, "FWHM", context)
        return raster.grid().smooth(fwhm=width, progress=progress_of(feedback))


class DenoiseRaster(RasterAlgorithm):
    """Denoising without tuning."""

    NAME = "denoiseraster"
    TITLE = "Denoise a raster"
    HELP = "Estimates the noise of a raster from itself and removes it. Steps are kept, and no parameter is tuned."

    def values(self, raster: Raster, parameters: dict[str, Any], context: Any, feedback: Any) -> np.ndarray:
        clean, found = raster.grid().denoise(progress=progress_of(feedback))
        feedback.pushInfo(f"noise {found['noise']:.4g} in the unit of the raster")
        return clean


class ReliefByScale(RasterAlgorithm):
    """The band between two widths."""

    NAME = "reliefbyscale"
    TITLE = "Relief by scale"
    HELP = (
        "What is wider than one width and narrower than another, in the unit of the raster: 0 and 50 m show walls, ditches "
        "and noise, 50 and 500 m banks and gullies. Bands of adjoining widths sum to the difference of the raster and "
        "its smoothest version. Widths are full widths at half maximum."
    )

    def add_parameters(self) -> None:
        self.add_width("FINE", "Wider than, in meters (0: from the finest)", 0.0)
        self.add_width("COARSE", "Narrower than, in meters", 100.0)

    def values(self, raster: Raster, parameters: dict[str, Any], context: Any, feedback: Any) -> np.ndarray:
        fine, coarse = (self.parameterAsDouble(parameters, name, context) for name in ("FINE", "COARSE"))
        if not 0 <= fine < coarse:
            raise QgsProcessingException(f"the widths must increase, got {fine:g} and {coarse:g}; exchange them")
        widths = [coarse] if fine == 0 else [fine, coarse]
        return np.asarray(raster.grid().decompose(fwhm=widths, progress=progress_of(feedback)))[len(widths) - 1]


class Salience(RasterAlgorithm):
    """What stands out, on all scales."""

    NAME = "saliency"
    TITLE = "What stands out"
    HELP = "Above 0 where the land is above its surroundings, below 0 where it is below, over all scales at once."

    def values(self, raster: Raster, parameters: dict[str, Any], context: Any, feedback: Any) -> np.ndarray:
        return np.asarray(raster.grid().saliency(progress=progress_of(feedback)))
