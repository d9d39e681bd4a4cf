"""Tests of the plug-in in QGIS itself, without a window, as `qgis_process` runs it.

QT_QPA_PLATFORM=offscreen python -m unittest discover -s integrations/qgis/tests    with the Python of QGIS
"""

from __future__ import annotations

import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
try:
    from osgeo import gdal, osr
    from qgis.core import QgsApplication, QgsProcessingContext, QgsProcessingException, QgsProcessingFeedback

    sys.path += [
        str(Path(folder) / "python/plugins") for folder in ("/usr/share/qgis", os.environ.get("QGIS_PREFIX", ""))
    ]
    import adwave as aw
    import processing
    from processing.core.Processing import Processing
except ImportError as missing:
    raise unittest.SkipTest(f"needs QGIS, GDAL and adwave in one Python: {missing}") from missing

gdal.UseExceptions()
application = QgsApplication([], False)
application.initQgis()
Processing.initialize()

import adwave_processing  # noqa: E402, after QGIS has started

plugin = adwave_processing.classFactory(None)
plugin.initProcessing()

ROWS, COLUMNS, CELL = 96, 128, 10.0
#: Largest difference of 32-bit floats from what adwave computes in 64 bits, for heights of tens of meters.
ROUNDING = 1e-4


def heights() -> np.ndarray:
    """Hills of a kilometer, banks of 60 m, and a hole without data."""
    y, x = np.mgrid[:ROWS, :COLUMNS] * CELL
    values = 40 * np.sin(x / 160) * np.cos(y / 160) + 2 * np.sin(2 * np.pi * x / 60)
    values[40:44, 50:60] = np.nan
    return values


class Qgis(unittest.TestCase):
    """Algorithms of the provider, each beside the same call of the package."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, values: np.ndarray, code: int = 32632, cell: float = CELL) -> str:
        """A GeoTIFF with the values at a place in a system of coordinates."""
        path = str(self.folder / f"dem-{code}.tif")
        dataset = gdal.GetDriverByName("GTiff").Create(path, values.shape[1], values.shape[0], 1, gdal.GDT_Float64)
        origin = (500000.0, 5400000.0) if cell >= 1 else (9.0, 60.0)
        dataset.SetGeoTransform((origin[0], cell, 0.0, origin[1], 0.0, -cell))
        system = osr.SpatialReference()
        system.ImportFromEPSG(code)
        dataset.SetProjection(system.ExportToWkt())
        dataset.GetRasterBand(1).SetNoDataValue(-1.0)
        dataset.GetRasterBand(1).WriteArray(np.where(np.isnan(values), -1.0, values))
        dataset.FlushCache()
        return path

    def run_raster(self, name: str, source: str, **parameters: object) -> np.ndarray:
        """Values of the result, NaN without data."""
        out = str(self.folder / f"{name}.tif")
        result = processing.run(f"adwave:{name}", {"INPUT": source, "BAND": 1, "OUTPUT": out, **parameters})
        self.assertEqual(result["OUTPUT"], out)
        before, after = gdal.Open(source), gdal.Open(out)
        self.assertEqual(before.GetGeoTransform(), after.GetGeoTransform())
        self.assertTrue(
            osr.SpatialReference(after.GetProjection()).IsSame(osr.SpatialReference(before.GetProjection()))
        )
        band = after.GetRasterBand(1)
        values = band.ReadAsArray().astype(float)
        values[values == band.GetNoDataValue()] = np.nan
        return values

    def test_the_provider_has_all_algorithms_with_help(self) -> None:
        provider = QgsApplication.processingRegistry().providerById("adwave")
        names = {algorithm.name() for algorithm in provider.algorithms()}
        rasters = {"smoothraster", "denoiseraster", "reliefbyscale", "saliency"}
        self.assertEqual(names, rasters | {"smoothcloud", "denoisecloud"})
        for algorithm in provider.algorithms():
            self.assertGreater(len(algorithm.shortHelpString()), 40, algorithm.name())

    def test_smoothing_is_that_of_the_package_and_keeps_places_without_data(self) -> None:
        values = heights()
        found = self.run_raster("smoothraster", self.write(values), FWHM=80.0)
        wanted = aw.grid(values, spacing=(CELL, CELL)).smooth(fwhm=80.0)
        np.testing.assert_array_equal(np.isnan(found), np.isnan(values))
        self.assertLess(np.nanmax(np.abs(found - wanted)), ROUNDING)
        self.assertLess(np.nanstd(np.diff(found, axis=1)), np.nanstd(np.diff(values, axis=1)))

    def test_relief_by_scale_sums_to_the_raster(self) -> None:
        values = heights()
        source = self.write(values)
        fine = self.run_raster("reliefbyscale", source, FINE=0.0, COARSE=80.0)
        middle = self.run_raster("reliefbyscale", source, FINE=80.0, COARSE=400.0)
        rest = self.run_raster("smoothraster", source, FWHM=400.0)
        self.assertLess(np.nanmax(np.abs(fine + middle + rest - values)), ROUNDING)
        with self.assertRaisesRegex(QgsProcessingException, "the widths must increase, got 80 and 50"):
            processing.run("adwave:reliefbyscale", {"INPUT": source, "FINE": 80, "COARSE": 50, "OUTPUT": "x.tif"})

    def test_denoising_finds_the_noise(self) -> None:
        values = heights()
        noisy = values + np.random.default_rng(0).normal(0, 0.5, values.shape)
        found = self.run_raster("denoiseraster", self.write(noisy))
        self.assertLess(np.nanstd(found - values), 0.8 * np.nanstd(noisy - values))

    def test_what_stands_out_is_positive_on_a_mound(self) -> None:
        y, x = np.mgrid[:ROWS, :COLUMNS]
        mound = 5 * np.exp(-((x - 64) ** 2 + (y - 48) ** 2) / 30.0)
        found = self.run_raster("saliency", self.write(mound))
        self.assertGreater(found[48, 64], 0)
        self.assertGreater(found[48, 64], np.abs(found[5:20, 5:20]).max())

    def test_cells_in_degrees_are_measured_in_meters(self) -> None:
        # At 60° north a degree of longitude is half as long as one of latitude, so the same width in meters spans twice
        # as many columns as rows.
        values = np.zeros((81, 81))
        values[40, 40] = 1.0
        found = self.run_raster("smoothraster", self.write(values, code=4326, cell=0.001), FWHM=700.0)
        offsets = np.arange(81) - 40.0
        along_rows, along_columns = (np.sqrt((found.sum(axis=axis) * offsets**2).sum()) for axis in (1, 0))
        self.assertAlmostEqual(along_columns / along_rows, 2.0, delta=0.02)

    def test_clouds_are_smoothed_with_their_attributes(self) -> None:
        source, out = str(self.folder / "land.laz"), str(self.folder / "smooth.laz")
        rng = np.random.default_rng(0)
        points = np.column_stack([rng.uniform(0, 60, (3000, 2)), rng.normal(0, 0.3, 3000)])
        classes = np.where(points[:, 0] < 30, 2, 5).astype(np.uint8)
        aw.Shape(points, fields={"classification": classes}).write(source)
        for name, more in (("smoothcloud", {"FWHM": 4.0}), ("denoisecloud", {})):
            with self.subTest(name):
                processing.run(f"adwave:{name}", {"INPUT": source, "ONLY": "classification=2", "OUTPUT": out, **more})
                before, after = aw.read(source), aw.read(out)
                np.testing.assert_array_equal(after["classification"], before["classification"])
                moved = np.abs(after.points - before.points)
                self.assertEqual(moved[before["classification"] == 5].max(), 0)
                self.assertGreater(moved[before["classification"] == 2].max(), 0.01)
                if name == "smoothcloud":
                    self.assertEqual(moved[:, :2].max(), 0)
                Path(out).unlink()
        with self.assertRaisesRegex(QgsProcessingException, "must be another file than the input"):
            processing.run("adwave:denoisecloud", {"INPUT": source, "OUTPUT": source})

    def test_cancel_ends_an_algorithm_without_a_result(self) -> None:
        feedback = QgsProcessingFeedback()
        feedback.cancel()
        out = self.folder / "canceled.tif"
        algorithm = QgsApplication.processingRegistry().algorithmById("adwave:smoothraster")
        parameters = {"INPUT": self.write(heights()), "OUTPUT": str(out)}
        result, is_done = algorithm.run(parameters, QgsProcessingContext(), feedback)
        self.assertTrue(is_done)
        self.assertEqual(result, {})
        self.assertFalse(out.exists())

    def test_a_missing_package_says_how_to_install_it(self) -> None:
        from unittest import mock

        with mock.patch.dict(sys.modules, {"adwave": None}), self.assertRaisesRegex(QgsProcessingException, "pip"):
            processing.run("adwave:smoothraster", {"INPUT": self.write(heights()), "OUTPUT": "x.tif"})


if __name__ == "__main__":
    unittest.main()
