"""Wavelets for shapes: split a mesh, a point cloud, a graph, an image, or a signal on it, into bands from fine to coarse.

Start here
----------
>>> import adwave as aw
>>> shape = aw.sample("creature", vertices=3000)  # or aw.read("scan.ply"), (points, faces), a trimesh, a networkx graph …
>>> bands = aw.decompose(shape, levels=6)  # six bands and the rest; they sum to the shape
>>> bands.shape
(7, 3032, 3)
>>> clean, info = aw.denoise(shape)  # the amount of noise is estimated
>>> smooth = aw.filter(shape, "smooth")  # limbs and volume stay
>>> heights = aw.smooth(shape, shape.points[:, 2], fwhm=0.2)  # a signal at the vertices

Every call reads alike: the shape, then the signal, then what to do. Without a signal it is the shape itself that changes,
and it comes back as the kind of object that was given. Numbers come back as numbers, in their own axes and number type.
Nothing is changed in place, and the order and number of vertices never change.

==========================================  ============================================================
smooth(shape, f, fwhm=8)                    smooth a signal, or the shape, by one width or number of steps
decompose(shape, f, levels=8)               split it into `Bands` from fine to coarse
filter(shape, f, [0, 1, 1])                 a gain for each band; filter(shape, "smooth") for the shape
denoise(shape, f)                           remove noise whose amount is estimated
filter_labels(shape, labels, gains)         change labels by their shares
saliency(shape, f), features(shape, f)      map where it stands out; find such places
match(first, second), distances(…)          find the motion between two scans; measure their distance
shape.deformer(fixed, handles)              bend a shape by handles while its detail rides along
transfer(a, onto=b), morph(a, b, 0.5)       carry detail onto another mesh; blend by bands
resample(sphere, f, onto=other)             carry fields and labels between registered spheres, such as fsaverage
simplify(shape, ratio=0.1)                  remove vertices, with a measured error
hierarchy(shape)                            levels of a subdivided mesh, and wavelets on them
render(shape, f), report(shape, "a.html")   draw it; write a page about it
info(shape), signal(shape, name)            facts; signals such as curvatures
region(shape, "ball:vertex=3,radius=5%")    weights of a region
Time(dt=2, fwhm=4)                          along time too: smooth(shape, series, fwhm=8, time=aw.Time(2, fwhm=4))
sequence("walk/*.obj", dt=0.04)             frames of a shape that moves: smooth, filter, denoise, write
vectors(shape, v, symmetry=1)               tangent vectors, lines or crosses; tensors(grid, D) for tensors
rasterize(points, cell=1)                   heights of a scan as a grid, and values back at points
impute(counts, walk), scattering(walk, f)   averages over similar cells; features of fields on a graph
studio(shape)                               an equalizer in the browser
==========================================  ============================================================

Whatever has bands goes in the place of `shape`, and has the same functions as methods, ``shape.smooth(f, fwhm=8)``:

==========================================  ============================================================
read(path), Shape(points, faces)            meshes and clouds; sample() and graph() make others
walk(W, normalize="row"), point_walk(X)     random walks on graphs and on points of any dimension
grid(array, spacing=h, mask=m)              images and volumes of numpy, nibabel, xarray, SimpleITK, PyVista
union([left, right, grid])                  several of them as one, such as both hemispheres
Decomposer(shape)                           any of them prepared once, for many requests
==========================================  ============================================================

A call that cannot run says which line does what was meant. ``help(aw.decompose)`` has the arguments of one function;
`aw.sklearn`, `aw.torch`, `aw.dask`, `aw.kernels` and `aw.baselines` are loaded when they are first used.
"""

# `import adwave` loads this file only; numpy and the extension are loaded with the first name that is used.

from __future__ import annotations

#: Public names of each private module. This is the only list of them: `__all__`, the attributes of the package, its stub
#: `__init__.pyi` and the pages of the reference come from it. `python tests/test_exports.py` writes the stub.
_EXPORTS: dict[str, tuple[str, ...]] = {
    "_shape": ("Shape", "as_shape", "graph", "read", "read_bytes", "sample"),
    "_decomposer": ("Bands", "Decomposer", "Layer"),
    "_options": ("Constraints", "Octaves", "Operator", "Steps", "Widths"),
    "_deform": ("CloneResult", "Crossing", "Deformer"),
    "_detail": ("morph", "transfer"),
    "_edits": ("decompose", "filter", "filter_labels", "smooth"),
    "_denoise": ("DenoiseResult", "denoise"),
    "_measures": (
        "FeatureOptions",
        "Features",
        "Saliency",
        "SaliencyOptions",
        "features",
        "gaze_scores",
        "saliency",
    ),
    "_resample": ("Resampler", "resample"),
    "_parcels": ("Parcels",),
    "_repeatability": ("ChangedShape", "Repeatability", "Trials", "repeatability"),
    "_register": ("Distances", "MatchResult", "SimplifyResult", "distances", "match", "simplify"),
    "_hierarchy": ("Coefficients", "Hierarchy", "hierarchy", "subdivide"),
    "_recipe": ("Recipe", "read_recipe"),
    "_walk": ("ScatteringResult", "Walk", "from_edge_index", "neighbors", "point_walk", "scattering", "walk"),
    "_grid": ("Grid", "grid"),
    "_raster": ("Raster", "rasterize"),
    "_time": ("Time",),
    "_union": ("union",),
    "_sequence": ("CleanSequence", "Sequence", "sequence"),
    "_vectors": ("Singularities", "TensorField", "VectorField", "tensors", "vectors"),
    "_impute": ("Imputation", "impute"),
    "_info": ("Info", "info", "memory_needed", "preset_gains", "region", "report", "signal"),
    "_picture": ("Camera", "ColorScale", "Picture", "render"),
    "_studio": ("StudioResult", "studio"),
    "_environment": ("show_versions", "threads"),
    "_native": ("InternalError", "__version__"),
}

#: Public modules that are loaded when they are first used; all but `baselines` and `kernels` need another package.
_MODULES = ("baselines", "dask", "kernels", "sklearn", "torch")

#: Former names, which go with the next release.
_RENAMED = {"points": "point_walk"}

_MODULE_OF = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = sorted([*_MODULE_OF, "baselines", "kernels"])  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> object:
    module_name = name if name in _MODULES else _MODULE_OF.get(name)
    # Imported here, since `import adwave` should cost next to nothing.
    from importlib import import_module

    if name in _RENAMED:
        import_module(f"{__name__}._caller").warn(f"aw.{name} is now aw.{_RENAMED[name]}", DeprecationWarning)
        return __getattr__(_RENAMED[name])
    if module_name is None:
        message = f"module 'adwave' has no attribute {name!r}"
        if not name.startswith("_"):
            message = import_module(f"{__name__}._unknown").unknown_attribute(name)
        raise AttributeError(message)

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
