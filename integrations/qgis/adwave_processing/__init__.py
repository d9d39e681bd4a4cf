"""Plug-in of QGIS: a provider of Processing that smooths, denoises and splits rasters and point clouds by adwave."""

from __future__ import annotations

from typing import Any


def classFactory(iface: Any) -> Any:
    """Plug-in for a window of QGIS; `iface` is None in `qgis_process`."""
    from adwave_processing.plugin import AdwavePlugin

    return AdwavePlugin()
