"""adwave on PyVista's datasets: `mesh.adwave.filter(...)`.

With PyVista 0.48 and newer nothing needs to be imported; `import adwave.pyvista` does it too. Keywords are those of the functions of the same
names in `adwave`; results are new datasets with the points, cells and data of the mesh, which is not changed.

>>> import pyvista as pv
>>> import adwave.pyvista
>>> mesh = pv.Sphere()
>>> smooth = mesh.adwave.filter(preset="smooth")
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
    """What adwave does with a surface or a cloud of points.

    Parameters
    ----------
    mesh : pyvista.PolyData or pyvista.UnstructuredGrid
        Of flat polygons; of volumes call ``extract_surface()`` first.
    """

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def bands(self, **given: Any) -> Any:
        """The mesh with vectors W1 … WJ (fine to coarse) and S in its ``point_data``: their sum is the points.

        Parameters
        ----------
        **given
            As for `adwave.decompose`: ``levels``, ``lengths``, ``signal``, …
        """
        bands = adwave.decompose(self._mesh, **given)
        new = self._mesh.copy()
        for level in range(1, bands.n_levels + 1):
            new.point_data[f"W{level}"] = bands.wavelet(level)
        new.point_data["S"] = bands.scaling(bands.n_levels)
        return new

    def filter(self, **given: Any) -> Any:
        """The mesh with its bands changed.

        Parameters
        ----------
        **given
            As for `adwave.filter`: ``gains=[2, 1.5, 1]``, ``preset="smooth"``, ``where="ball:vertex=120,radius=10%"``, …
        """
        return adwave.filter(self._mesh, **given).to(self._mesh)

    def denoise(self, **given: Any) -> Any:
        """The mesh without its noise.

        Parameters
        ----------
        **given
            As for `adwave.denoise`: ``strength``, ``creases``, …
        """
        return adwave.denoise(self._mesh, **given).result.to(self._mesh)

    def saliency(self, **given: Any) -> Any:
        """The mesh with ``point_data["saliency"]``: positive where it stands out, negative where it is hollow.

        Parameters
        ----------
        **given
            As for `adwave.saliency`.
        """
        new = self._mesh.copy()
        new.point_data["saliency"] = np.asarray(adwave.saliency(self._mesh, **given))
        new.set_active_scalars("saliency", preference="point")
        return new

    def features(self, **given: Any) -> Any:
        """The places that stand out, as points with level, sigma (model units), strength, sign and vertex.

        Parameters
        ----------
        **given
            As for `adwave.features`: ``theta``, ``best``, …
        """
        found = adwave.features(self._mesh, **given)
        places = pv.PolyData(np.reshape(found["position"], (-1, 3)).astype(float))
        for name in ("level", "sigma", "strength", "sign", "vertex"):
            places.point_data[name] = np.array(found[name])
        return places
