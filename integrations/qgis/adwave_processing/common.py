"""Parts that all algorithms share: the package, its stop, and texts."""

from __future__ import annotations

from typing import Any

from qgis.core import QgsProcessingAlgorithm, QgsProcessingException, QgsProcessingFeedback

INSTALL = (
    "adwave is not installed in the Python of QGIS. Install it from the Python console: "
    "import pip; pip.main(['install', 'adwave']), and start QGIS again."
)


def package() -> Any:
    """The package adwave.

    Raises
    ------
    QgsProcessingException
        If it is not installed; the message says how to install it.
    """
    try:
        import adwave
    except ImportError as error:
        raise QgsProcessingException(INSTALL) from error
    return adwave


class Canceled(Exception):
    """The user pressed Cancel."""


def progress_of(feedback: QgsProcessingFeedback) -> Any:
    """Function for the argument `progress` of adwave, which shows what is done and stops where the user cancels."""

    def show(done: float, total: float) -> None:
        feedback.setProgress(100.0 * done / max(total, 1))
        if feedback.isCanceled():
            raise Canceled

    return show


class Algorithm(QgsProcessingAlgorithm):
    """An algorithm described by attributes of its class."""

    NAME = ""
    TITLE = ""
    GROUP = ""
    HELP = ""

    def name(self) -> str:
        return self.NAME

    def displayName(self) -> str:
        return self.TITLE

    def group(self) -> str:
        return self.GROUP

    def groupId(self) -> str:
        return self.GROUP.lower().replace(" ", "")

    def shortHelpString(self) -> str:
        return self.HELP

    def createInstance(self) -> QgsProcessingAlgorithm:
        return type(self)()

    def compute(self, parameters: dict[str, Any], context: Any, feedback: QgsProcessingFeedback) -> dict[str, Any]:
        """Results of the algorithm by the names of its outputs."""
        raise NotImplementedError

    def processAlgorithm(
        self, parameters: dict[str, Any], context: Any, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        try:
            return self.compute(parameters, context, feedback)
        except Canceled:
            return {}
        except (ValueError, TypeError, OSError) as error:
            raise QgsProcessingException(str(error)) from error
