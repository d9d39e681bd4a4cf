"""adwave on PyVista's datasets: `mesh.adwave.filter(...)`.

PyVista 0.48 and newer find the accessor without an import; `import adwave.pyvista` registers it in older ones. Arguments are
those of the functions of the same names in `adwave`. Results are new datasets with the points, cells and data of the mesh,
which is not changed.

>>> import pyvista as pv
>>> import adwave.pyvista
>>> mesh = pv.Sphere()
>>> smooth = mesh.adwave.filter("smooth")
>>> smooth.n_points == mesh.n_points
True
>>> "W1" in mesh.adwave.bands(levels=4).point_data
True
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pyvista as pv

import adwave

__all__ = ["Wavelets"]


@pv.register_dataset_accessor("adwave", pv.PolyData)
@pv.register_dataset_accessor("adwave", pv.UnstructuredGrid)
class Wavelets:
    """Functions of adwave on a surface or a point cloud.

    Parameters
    ----------
    mesh : pyvista.PolyData or pyvista.UnstructuredGrid
        Polygons or points; for volumes call ``extract_surface()`` first.

    Examples
    --------
    >>> import pyvista as pv
    >>> "saliency" in pv.Sphere().adwave.saliency().point_data
    True
    """

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def bands(self, **options: Any) -> Any:
        """The mesh with vectors W1 … WJ (fine to coarse) and S in its ``point_data``: their sum is the points.

        Parameters
        ----------
        **options
            Arguments of `adwave.decompose`: ``levels``, ``signal``, …
        """
        bands = adwave.decompose(self._mesh, **options)
        new = self._mesh.copy()
        for level in range(1, bands.n_levels + 1):
            new.point_data[f"W{level}"] = bands.wavelet(level)
        new.point_data["S"] = bands.scaling(bands.n_levels)
        return new

    def filter(self, gains: Any, **options: Any) -> Any:
        """The mesh with its bands changed.

        Parameters
        ----------
        gains : sequence of float, str, or one or more Layer
            A gain for each band, or the name of a preset; see `adwave.filter`.
        **options
            Further arguments of `adwave.filter`: ``levels``, ``where="ball:vertex=120,radius=10%"``, …
        """
        return adwave.filter(self._mesh, gains, **options).to(self._mesh)

    def denoise(self, **options: Any) -> Any:
        """The mesh without its noise.

        Parameters
        ----------
        **options
            Arguments of `adwave.denoise`: ``strength``, ``creases``, …
        """
        return adwave.denoise(self._mesh, **options).result.to(self._mesh)

    def saliency(self, **options: Any) -> Any:
        """The mesh with ``point_data["saliency"]``: positive where it stands out, negative where it is hollow.

        Parameters
        ----------
        **options
            Arguments of `adwave.saliency`.
        """
        new = self._mesh.copy()
        new.point_data["saliency"] = np.asarray(adwave.saliency(self._mesh, **options))
        new.set_active_scalars("saliency", preference="point")
        return new

    def features(self, **options: Any) -> Any:
        """The features, as points with level, sigma (rms width, model units), strength, sign and vertex.

        Parameters
        ----------
        **options
            Arguments of `adwave.features`: ``theta``, ``best``, …
        """
        found = adwave.features(self._mesh, **options)
        places = pv.PolyData(np.reshape(found["position"], (-1, 3)).astype(float))
        for name in ("level", "sigma", "strength", "sign", "vertex"):
            places.point_data[name] = np.array(found[name])
        return places
