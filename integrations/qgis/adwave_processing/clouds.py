"""Algorithms on point clouds: LAS, LAZ, PLY and what else adwave reads, from file to file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from qgis.core import (
    QgsProcessingException,
    QgsProcessingParameterFile,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

from adwave_processing.common import Algorithm, package, progress_of

FILTER = "Point clouds (*.laz *.las *.ply *.pcd *.xyz)"


class CloudAlgorithm(Algorithm):
    """An algorithm from a file of points to one in the same format, with all that its points have."""

    GROUP = "Point cloud"

    def initAlgorithm(self, configuration: Any = None) -> None:
        self.addParameter(QgsProcessingParameterFile("INPUT", "File of points", fileFilter=FILTER))
        self.add_parameters()
        only = QgsProcessingParameterString(
            "ONLY", "Points that take part, such as classification=2 (empty: all)", optional=True
        )
        self.addParameter(only)
        self.addParameter(QgsProcessingParameterFileDestination("OUTPUT", self.TITLE, FILTER))

    def add_parameters(self) -> None:
        """Parameters after the input."""

    def moved(self, shape: Any, parameters: dict[str, Any], context: Any, feedback: Any, only: str | None) -> Any:
        """The shape with new positions."""
        raise NotImplementedError

    def compute(self, parameters: dict[str, Any], context: Any, feedback: Any) -> dict[str, Any]:
        source = self.parameterAsFile(parameters, "INPUT", context)
        out = self.parameterAsFileOutput(parameters, "OUTPUT", context)
        if Path(source).resolve() == Path(out).resolve():
            raise QgsProcessingException(f"the result must be another file than the input, got {out} for both")
        only = self.parameterAsString(parameters, "ONLY", context).strip() or None
        shape = package().read(source)
        feedback.pushInfo(repr(shape))
        self.moved(shape, parameters, context, feedback, only).write(out)
        return {"OUTPUT": out}


class SmoothCloud(CloudAlgorithm):
    """Smoothing of heights by a width in meters."""

    NAME = "smoothcloud"
    TITLE = "Smooth the heights of a point cloud"
    HELP = (
        "Smooths the heights of points by a full width at half maximum in the unit of the file. Positions in plan and all "
        "attributes stay."
    )

    def add_parameters(self) -> None:
        kind = QgsProcessingParameterNumber.Double
        self.addParameter(QgsProcessingParameterNumber("FWHM", "Full width at half maximum", kind, 5.0, minValue=0.0))

    def moved(self, shape: Any, parameters: dict[str, Any], context: Any, feedback: Any, only: str | None) -> Any:
        width = self.parameterAsDouble(parameters, "FWHM", context)
        heights = package().Constraints(along="z")
        options = {"constraints": heights, "only": only, "progress": progress_of(feedback)}
        return package().filter(shape, [0.0], fwhm=[width], **options)


class DenoiseCloud(CloudAlgorithm):
    """Denoising without tuning."""

    NAME = "denoisecloud"
    TITLE = "Denoise a point cloud"
    HELP = "Estimates the noise of a scan from itself and moves the points along the normals; all attributes stay."

    def moved(self, shape: Any, parameters: dict[str, Any], context: Any, feedback: Any, only: str | None) -> Any:
        clean, found = package().denoise(shape, only=only, progress=progress_of(feedback))
        feedback.pushInfo(f"noise {found['noise']:.4g} in the unit of the file")
        return clean
