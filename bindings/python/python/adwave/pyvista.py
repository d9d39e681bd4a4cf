"""adwave on PyVista's datasets: `mesh.adwave.filter(...)`.

PyVista 0.48 and newer find the accessor without an import; `import adwave.pyvista` registers it in older ones. Arguments are
those of the functions of the same names in `adwave`, and a name is one of the mesh's `point_data`. Results are new datasets
with the points, cells and data of the mesh, which is not changed; an array that is given comes back as an array.

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

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv

import adwave
from adwave._grid_objects import is_image
from adwave._image_data import scalars_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Wavelets"]


@pv.register_dataset_accessor("adwave", pv.PolyData)
@pv.register_dataset_accessor("adwave", pv.UnstructuredGrid)
@pv.register_dataset_accessor("adwave", pv.ImageData)
@pv.register_dataset_accessor("adwave", pv.StructuredGrid)
@pv.register_dataset_accessor("adwave", pv.RectilinearGrid)
class Wavelets:
    """Functions of adwave on a surface, a point cloud, an image, or the points of a volume.

    Parameters
    ----------
    mesh : pyvista.PolyData, pyvista.UnstructuredGrid or a grid
        Polygons or points; an ImageData is a grid (see `adwave.grid`), and the points of other volumes are the nodes of a
        graph.

    Examples
    --------
    >>> import pyvista as pv
    >>> "saliency" in pv.Sphere().adwave.saliency().point_data
    True
    """

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def decompose(self, signal: Any = None, **options: Any) -> adwave.Bands:
        """The bands of the points or of a signal; see `adwave.decompose`.

        Parameters
        ----------
        signal : str or array_like, optional
            The points by default, a name in ``point_data``, or numbers at the points.
        **options
            Arguments of `adwave.decompose`: ``levels``, ``fwhm``, …
        """
        return adwave.decompose(self._mesh, signal, **options)

    def bands(self, signal: Any = None, **options: Any) -> Any:
        """The mesh with W1 … WJ (fine to coarse) and S in its ``point_data``: their sum is the points, or the signal.

        Parameters
        ----------
        signal : str or array_like, optional
            The points by default, a name in ``point_data``, or numbers at the points.
        **options
            Arguments of `adwave.decompose`: ``levels``, ``fwhm``, …
        """
        bands = adwave.decompose(self._mesh, signal, **options)
        new = self._mesh.copy()
        for level in range(1, bands.n_levels + 1):
            self._store(new, f"W{level}", bands.wavelet(level), signal)
        self._store(new, "S", bands.scaling(bands.n_levels), signal)
        return new

    def _store(self, new: Any, name: str, values: Any, signal: Any) -> None:
        """Values as an array of a dataset, at its points or, of an image, where its signal is."""
        if not is_image(self._mesh):
            new.point_data[name] = values
            return
        scalars = scalars_of(self._mesh, signal)
        rows = values if np.shape(values)[:1] == (math.prod(scalars.sizes),) else scalars.rows(values)
        (new.point_data if scalars.at_points else new.cell_data)[name] = rows

    def smooth(self, signal: Any = None, **options: Any) -> Any:
        """The mesh, or a signal on it, smoothed by one width or number of steps; see `adwave.smooth`.

        Parameters
        ----------
        signal : str or array_like, optional
            The points by default, a name in ``point_data``, or numbers at the points, which come back as an array.
        **options
            Arguments of `adwave.smooth`: ``fwhm``, ``rms``, ``steps``, …
        """
        return adwave.smooth(self._mesh, signal, **options)

    def filter(self, *edit: Any, **options: Any) -> Any:
        """The mesh, or a signal on it, with its bands changed; see `adwave.filter`.

        Parameters
        ----------
        *edit
            The gains, or a signal and the gains, as in `adwave.filter`.
        **options
            Further arguments of `adwave.filter`: ``levels``, ``where="ball:vertex=120,radius=10%"``, …
        """
        return adwave.filter(self._mesh, *edit, **options)

    def denoise(self, signal: Any = None, **options: Any) -> Any:
        """The mesh, or a signal on it, without its noise; see `adwave.denoise`, which also returns the estimates.

        Parameters
        ----------
        signal : str or array_like, optional
            The points by default, a name in ``point_data``, or numbers at the points, which come back as an array.
        **options
            Arguments of `adwave.denoise`: ``strength``, ``creases``, …
        """
        return adwave.denoise(self._mesh, signal, **options).result

    def saliency(self, signal: Any = None, **options: Any) -> Any:
        """The mesh with ``point_data["saliency"]``: positive where it stands out, negative where it is hollow.

        Parameters
        ----------
        signal : str or array_like, optional
            As in `decompose`.
        **options
            Arguments of `adwave.saliency`.
        """
        new = self._mesh.copy()
        self._store(new, "saliency", np.asarray(adwave.saliency(self._mesh, signal, **options)), signal)
        new.set_active_scalars("saliency")
        return new

    def features(self, signal: Any = None, **options: Any) -> Any:
        """The features, as points with level, sigma (rms width, model units), strength, sign and vertex.

        Parameters
        ----------
        signal : str or array_like, optional
            As in `decompose`.
        **options
            Arguments of `adwave.features`: ``theta``, ``best``, …
        """
        found = adwave.features(self._mesh, signal, **options)
        positions = np.reshape(found["position"], (-1, 3)).astype(float)
        if is_image(self._mesh):
            positions = scalars_of(self._mesh, signal).positions(found["vertex"])
        places = pv.PolyData(positions)
        for name in ("level", "sigma", "strength", "sign", "vertex"):
            places.point_data[name] = np.array(found[name])
        return places

    def simplify(self, **options: Any) -> Any:
        """The mesh with fewer points; see `adwave.simplify`, which also measures the distance.

        Parameters
        ----------
        **options
            Arguments of `adwave.simplify`: ``ratio``, ``vertices`` or ``error``, …
        """
        return adwave.simplify(self._mesh, **options).shape

    def match(self, other: Any, **options: Any) -> adwave.MatchResult:
        """Motion from this mesh to another scan of the same object; see `adwave.match`.

        Parameters
        ----------
        other : shape_like
            The other scan.
        **options
            Arguments of `adwave.match`.
        """
        return adwave.match(self._mesh, other, **options)

    def region(self, region: Any, **options: Any) -> NDArray[np.float64]:
        """Weights of a region, one for each point; see `adwave.region`.

        Parameters
        ----------
        region : str or array_like
            A region in its text form, a weight for each point, or indices of points.
        **options
            Arguments of `adwave.region`.
        """
        return adwave.region(self._mesh, region, **options).reshape(-1)

    def info(self, **options: Any) -> adwave.Info:
        """Facts about the mesh; see `adwave.info`.

        Parameters
        ----------
        **options
            Arguments of `adwave.info`.
        """
        return adwave.info(self._mesh, **options)

    def render(self, values: Any = None, **options: Any) -> adwave.Picture:
        """A picture of the mesh; see `adwave.render`.

        Parameters
        ----------
        values : str or array_like, optional
            A number for each point, or a name in ``point_data``.
        **options
            Arguments of `adwave.render`.
        """
        return adwave.render(self._mesh, values, **options)
