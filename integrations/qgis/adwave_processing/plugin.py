"""The plug-in and its provider."""

from __future__ import annotations

from qgis.core import QgsApplication, QgsProcessingProvider

from adwave_processing.clouds import DenoiseCloud, SmoothCloud
from adwave_processing.rasters import DenoiseRaster, ReliefByScale, Salience, SmoothRaster

ALGORITHMS = (SmoothRaster, DenoiseRaster, ReliefByScale, Salience, SmoothCloud, DenoiseCloud)


class AdwaveProvider(QgsProcessingProvider):
    """Provider `adwave` of the toolbox."""

    def id(self) -> str:
        return "adwave"

    def name(self) -> str:
        return "adwave"

    def longName(self) -> str:
        return "adwave: bands from fine to coarse"

    def loadAlgorithms(self) -> None:
        for algorithm in ALGORITHMS:
            self.addAlgorithm(algorithm())


class AdwavePlugin:
    """Adds the provider as long as the plug-in is loaded."""

    def __init__(self) -> None:
        self.provider: AdwaveProvider | None = None

    def initProcessing(self) -> None:
        """Add the provider; `qgis_process` calls this alone."""
        self.provider = AdwaveProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self) -> None:
        """Add the provider to a window."""
        self.initProcessing()

    def unload(self) -> None:
        """Remove the provider."""
        if self.provider is not None:
            QgsApplication.processingRegistry().removeProvider(self.provider)
            self.provider = None
