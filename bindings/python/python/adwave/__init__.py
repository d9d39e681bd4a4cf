"""Wavelets for shapes: split a mesh, a point cloud or a graph, or a signal on it, into bands from fine to coarse.

Each band is local in space and in frequency. Look at the bands (`saliency`, `features`), change them (`filter`,
`Bands.apply`, `denoise`), and reconstruct the shape without loss:

>>> import adwave as aw
>>> shape = aw.sample("creature", vertices=3000)
>>> bands = aw.decompose(shape, levels=6)
>>> bands.shape
(7, 3032, 3)
>>> bool(abs(bands.reconstruct() - shape.points).max() < 1e-12)
True

A *shape* may be a path, an array of points, a pair ``(points, faces)``, a sparse matrix or an object of trimesh,
PyVista, meshio, Open3D, networkx, nilearn, PyTorch Geometric, PyGSP or laspy. The order and the number of its vertices
never change, and nothing is changed in place.

==========================================  ============================================================
smooth(shape, f, fwhm=8)                    smooth a signal, or the shape, by one width or number of steps
decompose(shape, f, levels=8)               split it into `Bands` from fine to coarse
filter(shape, "smooth")                     change the bands of the shape or of a signal, and sum them
denoise(shape, f)                           remove noise whose amount is estimated
filter_labels(shape, labels, gains)         change labels by their shares
saliency(shape, f), features(shape, f)      map where it stands out; find such places
match(a, b), distances(a, b)                find the motion between two scans; measure their distance
shape.deformer(fixed, handles)              bend a shape by handles while its detail rides along
transfer(a, onto=b), morph(a, b, 0.5)       carry detail onto another mesh; blend by bands
simplify(shape, ratio=0.1)                  remove vertices, with a measured error
hierarchy(shape)                            levels of a subdivided mesh, and wavelets on them
render(shape, f), report(shape, "a.html")   draw it; write a page about it
info(shape), signal(shape, name)            facts; signals such as curvatures
region(shape, "ball:vertex=3,radius=5%")    weights of a region
read(path), Shape(points, faces)            shapes; sample() and graph() make others
grid(array, spacing=h, mask=m)              images and volumes with the same methods
rasterize(points, cell=1)                   heights of a scan as a grid, and values back at points
walk(P), points(X)                          random walks on graphs and on points of any dimension
impute(counts, walk), scattering(walk, f)   averages over similar cells; features of fields on a graph
Decomposer(shape)                           a shape prepared once, for many requests
studio(shape)                               an equalizer in the browser
==========================================  ============================================================

``help(aw.decompose)`` has the arguments of one function; `aw.torch`, `aw.sklearn`, `aw.dask` and `aw.baselines` are
loaded when they are first used.

``import adwave`` loads this file only; numpy and the extension are loaded with the first name that is used.
"""

from __future__ import annotations

#: Public names of each private module. This is the only list of them: `__all__`, the attributes of the package, its stub
#: `__init__.pyi` and the pages of the reference come from it. `python tests/test_exports.py` writes the stub.
_EXPORTS: dict[str, tuple[str, ...]] = {
    "_shape": ("Shape", "as_shape", "graph", "read", "read_bytes", "sample"),
    "_decomposer": ("Bands", "Decomposer", "Layer"),
    "_options": ("Constraints", "Octaves", "Operator", "Steps", "Widths"),
    "_deform": ("CloneResult", "Deformer"),
    "_detail": ("morph", "transfer"),
    "_edits": ("DenoiseResult", "decompose", "denoise", "filter", "filter_labels", "smooth"),
    "_measures": (
        "FeatureOptions",
        "Features",
        "Saliency",
        "SaliencyOptions",
        "features",
        "gaze_scores",
        "saliency",
    ),
    "_repeatability": ("ChangedShape", "Repeatability", "Trials", "repeatability"),
    "_register": ("Distances", "MatchResult", "SimplifyResult", "distances", "match", "simplify"),
    "_hierarchy": ("Coefficients", "Hierarchy", "hierarchy", "subdivide"),
    "_recipe": ("Recipe", "read_recipe"),
    "_walk": ("ScatteringResult", "Walk", "from_edge_index", "neighbors", "points", "scattering", "walk"),
    "_grid": ("Grid", "grid"),
    "_raster": ("Raster", "rasterize"),
    "_impute": ("Imputation", "impute"),
    "_info": ("Info", "info", "memory_needed", "preset_gains", "region", "report", "signal"),
    "_picture": ("Camera", "ColorScale", "Picture", "render"),
    "_studio": ("StudioResult", "studio"),
    "_environment": ("show_versions", "threads"),
    "_native": ("InternalError", "__version__"),
}

#: Public modules that are loaded when they are first used; all but `baselines` need another package.
_MODULES = ("baselines", "dask", "sklearn", "torch")

_MODULE_OF = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = sorted([*_MODULE_OF, "baselines"])  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> object:
    module_name = name if name in _MODULES else _MODULE_OF.get(name)
    if module_name is None:
        raise AttributeError(f"module 'adwave' has no attribute {name!r}")
    # Imported here, since `import adwave` should cost next to nothing.
    from importlib import import_module

    try:
        module = import_module(f"{__name__}.{module_name}")
    except ModuleNotFoundError as error:
        if name not in _MODULES:
            raise
        # An attribute that is missing, as `hasattr` asks.
        raise AttributeError(f"adwave.{name} needs the package {error.name}, which is not installed") from error
    value = module if name in _MODULES else getattr(module, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})
