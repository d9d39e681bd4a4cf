"""Arguments that a function does not have: what was meant, and the line that does it.

A `Call` is the text that the user wrote. Each rule here changes it, so that the line in the message has the user's own
names and runs as it is.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import numpy as np

from adwave._caller import Call, written_call

#: Options of other libraries by the option here that they stand for.
_SAME_AS = {
    "levels": (
        *("n_levels", "level", "n_scales", "nscales", "j", "n_bands", "nlevels", "depth", "max_level", "num_levels"),
        *("num_scales", "nb_levels", "max_levels", "nb_scales", "octaves", "n_octaves"),
    ),
    "steps": (
        *(
            "t",
            "n_steps",
            "time",
            "times",
            "tau",
            "iterations",
            "n_iter",
            "n_iterations",
            "iters",
            "power",
            "n",
            "niter",
        ),
        *("number_of_iterations", "num_iterations", "num_steps", "max_iter", "filter_iterations", "repeat", "order"),
        *("diffusion_time", "n_times", "hops", "scales"),
    ),
    "neighbors": (
        *("k", "knn", "n_neighbors", "n_neighbours", "neighbours", "nn", "num_neighbors", "max_nn", "nb_neighbors"),
        *("kneighbors", "n_neigh"),
    ),
    "threads": ("n_jobs", "num_threads", "n_threads", "workers", "nthreads", "num_workers"),
    "color_map": ("cmap", "colormap", "colors_map"),
    "range": ("clim", "vmin", "vmax", "color_range"),
    "signal": (
        *("f", "x", "data", "values", "scalars", "y", "field", "feature", "texture", "img", "value", "scalar", "name"),
        *("function", "s", "sig", "features", "signals", "layer", "vertex_values", "point_data", "array", "arr", "map"),
    ),
    "where": ("region", "roi", "subset"),
    "mask": ("mask_img", "vertex_mask", "indices"),
    "weights": ("weight", "edge_weight", "w", "edge_weights", "edge_attr", "weighting"),
    "operator": ("method", "kernel", "laplacian", "kind", "walk", "lazy", "exact", "normalization", "normalized"),
    "gains": ("preset", "gain", "filter", "coefficients", "coeffs", "g", "mode_gains", "response", "type"),
    "sigma": ("std", "sd", "smoothing", "bandwidth", "sigmas", "s", "stddev", "scale", "sigma_range"),
    "widths": ("lengths", "length", "sizes", "radius", "radii", "rms_width", "width", "size", "distance"),
    "fwhm": ("smoothing_fwhm", "kernel_fwhm", "fwhm_mm"),
    "seed": ("random_state", "rng", "random_seed"),
    "progress": ("verbose", "progress_bar", "show_progress", "disable", "tqdm"),
    "accuracy": ("tol", "tolerance", "eps", "rtol", "atol", "convergence"),
    "noise": ("noise_level", "noise_sigma", "sigma_noise", "noise_std", "std_noise", "variance"),
    "strength": ("alpha", "h", "factor", "amount", "denoise_strength"),
    "vertices": (
        *(
            "target",
            "n_vertices",
            "n_points",
            "target_count",
            "faces_count",
            "n",
            "num_vertices",
            "n_verts",
            "resolution",
        ),
        "target_number_of_points",
    ),
    "faces_wanted": ("face_count", "target_number_of_triangles", "n_faces", "target_faces", "num_faces"),
    "ratio": ("fraction", "percent", "keep", "target_perc", "proportion"),
    "reduction": ("target_reduction", "percent_reduction"),
    "best": ("n_features", "n_best", "top", "top_k", "max_features", "n_keypoints", "num_features", "count", "n_max"),
    "theta": ("threshold", "thresh", "thr", "threshold_abs", "min_response", "contrast_threshold"),
    "open_browser": ("open", "browser", "show", "launch"),
    "axis": ("dim",),
    "axes": ("dims", "axis", "dim", "spatial_dims", "channel_axis"),
    "faces": ("triangles", "tri", "tris", "cells", "f", "elements", "face", "simplices", "topology"),
    "points": ("vertices", "verts", "v", "coords", "coordinates", "pos", "xyz", "nodes", "pts"),
    "spacing": (
        "voxel_size",
        "pixdim",
        "zooms",
        "cellsize",
        "pixel_size",
        "sampling",
        "voxel_sizes",
        "cell_size",
        "dx",
        "res",
    ),
    "affine": (),
    "periodic": ("mode", "boundary", "wrap", "padding", "pad_mode"),
    "nothing": (
        *(
            "lamb",
            "lambda_",
            "lam",
            "mu",
            "nu",
            "relaxation_factor",
            "inplace",
            "copy",
            "metric",
            "normalize",
            "return_info",
        ),
        *(
            "pass_band",
            "feature_angle",
            "boundary_smoothing",
            "feature_smoothing",
            "edge_angle",
            "implicit_time_integration",
        ),
        *(
            "truncate",
            "cval",
            "output",
            "dtype",
            "device",
            "symmetric",
            "volume_constraint",
            "laplacian_operator",
            "in_place",
        ),
        *(
            "filter_scope",
            "solver",
            "random",
            "progress_callback",
            "cutoff",
            "beta",
            "gamma",
            "wavelet",
            "symmetrize",
            "p",
        ),
    ),
}
#: Names of a number of neighbors.
NEIGHBOR_NAMES = ("neighbors", *_SAME_AS["neighbors"])
_MEANINGS: dict[str, list[str]] = {}
for _ours, _names in _SAME_AS.items():
    for _name in (*_names, _ours):
        _MEANINGS.setdefault(_name, []).append(_ours)

#: Functions of this package by names that other libraries give to what they do.
_FUNCTIONS = {
    "Shape": "mesh trimesh trianglemesh polydata graph pointcloud cloud surface from_mesh from_trimesh from_networkx "
    "from_vertices_faces from_arrays pygraph as_mesh create_mesh",
    "read": "load read_mesh load_mesh open loadmesh read_point_cloud read_triangle_mesh read_shape from_file load_shape",
    "decompose": "wavelets wavelet transform dwt wavedec swt bands split analyze analysis wavelet_transform multiscale "
    "decomposition forward diffusion_wavelets wavelet_decompose decompose_signal pyramid starlet wavedec2 waverec",
    "smooth": "diffuse heat_kernel heat heat_diffusion blur lowpass gaussian gaussian_smooth smoothing diffusion smooth_data "
    "smooth_mesh smooth_taubin filter_smooth_simple laplacian_smooth heat_smooth smooth_img smooth_surface smooth_signal "
    "gaussian_filter gaussian_blur smooth_image smooth_array filter_laplacian filter_humphrey heat_method",
    "denoise": "denoising remove_noise clean denoise_mesh denoise_image denoise_wavelet denoise_signal threshold",
    "filter": "sharpen enhance equalize apply_filter bandpass highpass band_pass filter_signal filter_mesh unsharp_mask",
    "saliency": "saliency_map salience mesh_saliency",
    "features": "keypoints detect interest_points detect_features find_features blobs blob_log peaks sift detect_keypoints",
    "match": "icp registration_icp register registration align registration_ransac find_motion match_shapes fit_motion",
    "distances": "distance hausdorff chamfer compare hausdorff_distance chamfer_distance compute_point_cloud_distance",
    "simplify": "decimate decimation simplify_quadric_decimation decimate_pro reduce voxel_down_sample downsample qslim "
    "simplify_quadric simplify_mesh quadric_decimation",
    "subdivide": "loop_subdivision refine upsample",
    "point_walk": "knn knn_graph kneighbors_graph nearest_neighbors neighbor_graph from_points neighbors_walk knn_walk",
    "walk": "random_walk markov transition_matrix diffusion_operator from_adjacency markov_chain walk_from_graph",
    "impute": "magic imputation impute_counts magic_impute",
    "scattering": "scatter scattering_transform geometric_scattering",
    "grid": "image volume raster voxels array from_array from_image image_data imagedata as_grid",
    "render": "plot show view draw picture screenshot snapshot plot_mesh",
    "sample": "example dataset samples load_example example_mesh get_sample",
    "info": "describe summary stats health check",
    "region": "roi select ball mask",
    "Widths": "widths scales",
    "Steps": "steps",
    "Decomposer": "prepare prepared waveletoperator operator_of solver",
    "studio": "gui app editor",
    "threads": "set_num_threads set_threads num_threads n_threads",
    "show_versions": "versions version_info",
    "signal": "curvature mean_curvature normals estimate_normals compute_normals vertex_normals gaussian_curvature",
    "baselines": "taubin filter_taubin harmonics heat_kernel_signature eigenvectors",
}
_FUNCTION_OF = {name: ours for ours, names in _FUNCTIONS.items() for name in names.split()}
#: Signals by names of functions that compute them elsewhere.
_SIGNALS = {
    "curvature": "mean-curvature",
    "mean_curvature": "mean-curvature",
    "gaussian_curvature": "gaussian-curvature",
}
#: Baselines by names of functions elsewhere.
_BASELINES = {"filter_taubin": "taubin", "eigenvectors": "harmonics"}
_UNKNOWN = object()
#: Presets by the words that other programs have for them.
PRESETS = {
    "enhance": ("sharpen", "sharp", "highpass", "high-pass", "high_pass", "boost", "unsharp", "detail"),
    "smooth": ("lowpass", "low-pass", "low_pass", "blur", "gaussian", "heat", "denoise", "laplacian", "taubin"),
}
#: Former names of functions.
_FORMER = {"point_walk": "points"}


def is_image_like(value: object) -> bool:
    """True if an array has the axes of an image or a volume, and not those of points in space."""
    shape = getattr(value, "shape", ())
    return isinstance(shape, tuple) and (len(shape) == 3 or (len(shape) == 2 and shape[1] > 3 and shape[0] > 1))


def is_square(value: object) -> bool:
    """True if an array has the axes of a matrix of a graph."""
    shape = getattr(value, "shape", ())
    return isinstance(shape, tuple) and len(shape) == 2 and shape[0] == shape[1]


def is_number(value: object) -> bool:
    """True for a single number that is no flag."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def looks_like_faces(points: object, faces: object) -> bool:
    """True if two arrays are the vertices and the triangles or quadrilaterals of a mesh."""
    first, second = np.shape(points), np.shape(faces)  # type: ignore[arg-type]
    if len(first) != 2 or len(second) != 2 or first[1] not in (2, 3) or second[1] not in (3, 4):
        return False
    corners = np.asarray(faces)
    # Bytes are colors, and corners of a face differ.
    if corners.dtype.kind not in "iu" or corners.dtype.itemsize == 1 or not corners.size:
        return False
    few = np.sort(corners[:100], axis=1)
    return bool(not (few[:, 1:] == few[:, :-1]).any() and corners.min() >= 0 and corners.max() < first[0])


def working_line(function: str, change: Callable[[Call], None], otherwise: str = "") -> str:
    """The user's call of a function after a change, as ``"; write …"``; without its text, `otherwise` in its place.

    Parameters
    ----------
    function : str
        Name of the function.
    change : callable
        Function that changes a `Call`.
    otherwise : str
        Line with the usual names.
    """
    call = written_call(function)
    if call is None:
        return f"; write {otherwise}" if otherwise else ""
    change(call)
    _complete(call, None)
    return f"; write {call}"


def line_with(function: str, **keywords: str) -> str:
    """The user's call of a function with other keywords, as ``"; write …"``."""
    shown = ", ".join(["shape", "f", *(f"{name}={text}" for name, text in keywords.items())])
    return working_line(function, lambda call: call.keywords.update(keywords), f"aw.{function}({shown})")


def known_options(function: Callable[..., Any]) -> tuple[list[str], list[str]]:
    """Names of the positional and of all further parameters of a function, those of ``**options`` too."""
    places, names = [], []
    plain = inspect.unwrap(function)
    for parameter in inspect.signature(plain).parameters.values():
        if parameter.kind in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD):
            places.append(parameter.name)
        elif parameter.kind is parameter.KEYWORD_ONLY:
            names.append(parameter.name)
        elif parameter.kind is parameter.VAR_KEYWORD:
            names += _names_of_dict(parameter.annotation)
    return places, names


def _names_of_dict(annotation: object) -> list[str]:
    """Keys of ``Unpack[SomeOptions]``, which is a text in this package."""
    _options, _part = (import_module(f"adwave.{each}") for each in ("_options", "_part"))
    name = str(annotation).partition("[")[2].rstrip("]'\"")
    options = getattr(_part, name, None) or getattr(_options, name, None)
    return [] if options is None else _all_keys(options)


def _all_keys(options: type) -> list[str]:
    return sorted({*getattr(options, "__required_keys__", ()), *getattr(options, "__optional_keys__", ())})


def misfit(function: Callable[..., Any], arguments: Sequence[Any], options: Mapping[str, Any], why: str) -> str:
    """Message for a call that does not fit the parameters of a function, with the line that works.

    Parameters
    ----------
    function : callable
        The function, a method or a constructor.
    arguments, options : sequence, mapping
        What it was called with.
    why : str
        Python's message.
    """
    places, names = known_options(function)
    qualified = function.__qualname__.split(".")
    is_method = places[:1] == ["self"]
    name = type(arguments[0]).__name__ if is_method and qualified[-1] == "__init__" else qualified[-1]
    values: list[Any] = list(arguments[1:] if is_method else arguments)
    places = places[1:] if is_method else places
    owner = type(arguments[0]).__name__.lower() if is_method and name == qualified[-1] else ""
    call = written_call(name)
    if call is None and name in _FORMER and (call := written_call(_FORMER[name])) is not None:
        call.function = f"{call.prefix}{name}"
    if call is not None and call.is_method and places[:1] == ["shape"] and len(call.arguments) == len(values) - 1:
        values, places = values[1:], places[1:]
    if call is None or len(call.arguments) != len(values) or set(call.keywords) != set(options):
        call = _stand_in(name, owner, values, options)
    known = [*places, *names]
    reasons = repair(call, known, places, values, dict(options))
    listed = f"{name} takes {', '.join(known)}"
    wrong = next((option for option in options if option not in known), None)
    if wrong is not None:
        start = f"{name}() has no option {wrong!r}"
    else:
        start = " ".join(why.split()).replace(f"{function.__qualname__}()", f"{name}()")
    return f"{start}; {'; '.join([*reasons, listed])}; write {call}"


def _stand_in(name: str, owner: str, values: Sequence[Any], options: Mapping[str, Any]) -> Call:
    """A call with the usual names for values whose text is not at hand."""

    def text(value: Any, place: int) -> str:
        if isinstance(value, (str, bool, int, float, type(None))):
            return repr(value)
        if isinstance(value, (list, tuple)) and len(str(value)) <= 40:
            return repr(value)
        if not owner and place == 0:
            shape = getattr(value, "shape", ())
            return "V" if len(shape) == 2 and shape[1] in (2, 3) else "shape"
        return "F" if place == 1 and looks_like_faces(values[0], value) else "f"

    shown = {key: text(value, -1) for key, value in options.items()}
    texts = [text(value, i) for i, value in enumerate(values)]
    return Call(f"{owner or 'aw'}.{name}", texts, shown, is_method=bool(owner))


def refuse_unknown(function: str, options: Mapping[str, Any], known: Collection[str], wanted: Collection[str]) -> None:
    """Raise TypeError for the first option that is none of `wanted`, the optional ones of a function.

    Parameters
    ----------
    function : str
        Name of the function.
    options : mapping
        Options that were given beyond the named ones.
    known : collection of str
        Named options of the function.
    wanted : collection of str
        Further options that it takes.

    Raises
    ------
    TypeError
        With the line that does what was meant.
    """
    every = [*known, *wanted]
    wrong = [name for name in options if name not in every]
    if not wrong:
        return
    call = written_call(function)
    if call is None or not set(wrong) <= set(call.keywords):
        shown = {name: text_of(value) for name, value in options.items()}
        call = Call(f"aw.{function}", ["shape"], shown)
    reasons = repair(call, every, (), None, dict(options))
    listed = f"{function} takes {', '.join(every)}"
    raise TypeError(f"{function}() has no option {wrong[0]!r}; {'; '.join([*reasons, listed])}; write {call}")


def repair(
    call: Call,
    known: Collection[str],
    places: Sequence[str] = (),
    values: Sequence[Any] | None = None,
    options: Mapping[str, Any] | None = None,
) -> list[str]:
    """Change a call so that it fits; returns what was changed, in words.

    Parameters
    ----------
    call : Call
        The call, which is changed.
    known : collection of str
        Names of all parameters of the function.
    places : sequence of str
        Names of those that may be given by position.
    values : sequence, optional
        Values of the arguments by position.
    options : mapping, optional
        Values of the arguments by name.
    """
    reasons: list[str] = []
    options = options or {}
    given = list(values) if values is not None else None
    if given is not None:
        reasons += _pair_faces(call, given)
        reasons += _signal_second(call, given, places)
    for name in [name for name in call.keywords if name not in known]:
        text = call.keywords[name]
        value = options.get(name, _literal(text))
        if places and not call.arguments and places[0] not in call.keywords and places[0] != "signal":
            del call.keywords[name]
            call.arguments.append(text)
            reasons.append(f"{text} goes first")
            continue
        reasons += _rename(call, name, text, value, known)
    if places and given is not None:
        reasons += _move_surplus(call, places, given, known)
    _complete(call, given, known)
    return [reason for reason in reasons if reason]


def _pair_faces(call: Call, values: list[Any]) -> list[str]:
    """Points and faces in a pair."""
    if call.is_method or call.name in ("Shape", "match", "distances"):
        return []
    at = next((i for i in range(len(values) - 1) if looks_like_faces(values[i], values[i + 1])), None)
    if at is None:
        if (
            len(values) > 1
            and isinstance(values[0], list)
            and looks_like_faces(np.array(values[0]), np.array(values[1]))
        ):
            at = 0
        else:
            return []
    pair = (values[at], values[at + 1])
    values[at : at + 2] = [pair]
    call.arguments[at : at + 2] = [f"({call.arguments[at]}, {call.arguments[at + 1]})"]
    return [f"are {call.arguments[at]} points and faces? They go in a pair"]


def _signal_second(call: Call, values: list[Any], places: Sequence[str]) -> list[str]:
    """The shape before its signal."""
    if call.is_method or list(places[:2]) != ["shape", "signal"] or len(values) < 2:
        return []
    first, second = values[:2]
    is_signal = np.ndim(first) == 1 if isinstance(first, np.ndarray) else False
    is_shape = isinstance(second, tuple) or np.ndim(second) == 2 or not hasattr(second, "__len__")
    if not is_signal or not is_shape or is_number(second):
        return []
    values[:2] = [second, first]
    call.arguments[:2] = [call.arguments[1], call.arguments[0]]
    return ["the shape comes first and its signal second"]


#: Meaning of a further argument by position.
SURPLUS = {
    "smooth": "steps",
    "decompose": "levels",
    "saliency": "levels",
    "features": "best",
    "denoise": "strength",
    "simplify": "ratio",
    "point_walk": "neighbors",
    "impute": "steps",
    "render": "path",
}


def _move_surplus(call: Call, places: Sequence[str], values: list[Any], known: Collection[str]) -> list[str]:
    """Arguments beyond those that go by position, by name."""
    if call.name == "Decomposer" and len(call.arguments) == 2:
        text = call.arguments.pop()
        call.keywords.setdefault("operator", text)
        return []
    reasons = []
    while len(call.arguments) > len(places):
        text = call.arguments.pop()
        name = SURPLUS.get(call.name)
        if name is None or name not in known or name in call.keywords:
            reasons.append(f"{text} has no place here")
            continue
        call.keywords[name] = text
        reasons.append(f"{text} goes by name, {name}={text}")
    return reasons


def _complete(call: Call, values: Sequence[Any] | None, known: Collection[str] = ()) -> None:
    """Add what a function cannot do without."""
    name = call.name
    image = values[0] if values and not call.is_method else None
    if image is not None and name in _OF_SHAPES and is_image_like(image) and isinstance(image, np.ndarray):
        wrap_grid(call)
    has_grid = "grid(" in (call.function if call.is_method else call.arguments[0] if call.arguments else "")
    has_width = {"fwhm", "rms", "steps", "sigma"} & call.keywords.keys() or (call.is_method and len(call.arguments) > 1)
    if name == "smooth" and not has_width:
        call.keywords["sigma" if has_grid else "steps"] = "2" if has_grid else "3"
    if name == "filter" and "gains" not in call.keywords:
        own = 0 if call.is_method else 1
        for i, text in enumerate(call.arguments[own:], start=own):
            word = _literal(text)
            meant = next((ours for ours, names in PRESETS.items() if word in names), None)
            call.arguments[i] = text if meant is None else f'"{meant}"'
        gains = [text for text in call.arguments[own:] if _is_gains(text)]
        if not gains and len(call.arguments) in (own, own + 1):
            call.arguments.append('"smooth"')
    if (
        name in ("walk", "Walk")
        and "normalize" not in call.keywords
        and call.arguments
        and "(" not in call.arguments[0]
    ):
        call.keywords["normalize"] = "'row'"
    if name == "simplify" and not {"error", "vertices", "ratio"} & call.keywords.keys():
        call.keywords["ratio"] = "0.5"


_OF_SHAPES = ("smooth", "decompose", "filter", "denoise", "saliency", "features", "region")


def _is_gains(text: str) -> bool:
    value = _literal(text)
    if isinstance(value, str):
        return value in ("smooth", "suppress", "suppress-paper", "enhance", "band1", "band2")
    return "Layer(" in text or isinstance(value, (list, tuple))


def wrap_grid(call: Call, **options: str) -> None:
    """The first argument, or the object of a method, as a grid with these options."""
    shown = "".join(f", {name}={text}" for name, text in options.items())
    if call.is_method:
        owner = call.prefix[:-1]
        changed = f"{owner[:-1]}{shown})" if "grid(" in owner else owner
        call.function = f"{changed}.{call.name}"
        return
    if not call.arguments:
        return
    text = call.arguments[0]
    is_grid = "grid(" in text
    call.arguments[0] = f"{text[:-1]}{shown})" if is_grid else f"{call.package}grid({text}{shown})"


def rename_keyword(call: Call, name: str, known: Collection[str]) -> None:
    """Replace an unknown keyword of a call by what it is called here."""
    text = call.keywords[name]
    _rename(call, name, text, _literal(text), known)


def _rename(call: Call, name: str, text: str, value: Any, known: Collection[str]) -> list[str]:
    """Replace an unknown keyword; returns what it is called here."""
    del call.keywords[name]
    if name == "layer" and call.arguments:  # of an AnnData
        text = f"{call.arguments[0]}.layers[{text}]"
    if name == "weights" and "gains" in known and isinstance(value, (list, tuple)):
        return _as_gains(call, text)
    for meaning in _MEANINGS.get(name.lower(), []):
        rule = _RULES.get(meaning)
        found = rule(call, text, value, known) if rule is not None else None
        if found is None and meaning in known and meaning not in call.keywords:
            call.keywords[meaning] = text
            found = f"that is {meaning}={text}"
        if found is not None:
            return [found]
    close = get_close_matches(name, known, n=1)
    if close and close[0] not in call.keywords:
        call.keywords[close[0]] = text
        return [f"did you mean {close[0]}={text}?"]
    return [f"there is no counterpart of {name}"]


def _as_gains(call: Call, text: str) -> list[str]:
    call.arguments.append(text)
    return [f"gains go by position, {text}"]


def _levels(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "levels" in known:
        call.keywords["levels"] = text
        return f"that is levels={text}"
    n = int(value) if is_number(value) else 3
    if "steps" in known and call.name == "scattering":
        call.keywords["steps"] = str([2**j for j in range(n)])
        return f"the scales are steps={call.keywords['steps']}"
    if "steps" in known and "steps" not in call.keywords:
        call.keywords["steps"] = str(2 ** max(0, n - 1))
        return f"level {n} has steps={call.keywords['steps']}"
    return None


def _steps(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    numbers = _numbers(value)
    if call.name == "denoise":
        return "denoising takes no number of steps: it estimates the noise"
    if "levels" in known:
        if numbers is not None and len(numbers) == 1 and isinstance(value, int) and call.name != "filter":
            call.keywords["levels"] = f"aw.Steps([{text}])"
        elif numbers is not None and min(numbers) > 0:
            is_whole = all(n >= 1 and n == int(n) for n in numbers)
            kind = "Steps(" if is_whole else "Widths(fwhm="
            call.keywords["levels"] = f"{call.package}{kind}[{_joined(numbers)}])"
        else:
            call.keywords["levels"] = f"{call.package}Steps({text})"
        each = "[…]" if numbers is None else f"[{_joined(numbers)}]"
        return f"widths are levels=aw.Widths(fwhm={each}), numbers of steps levels=aw.Steps({each})"
    if "steps" not in known:
        return None
    if is_number(value) and 0 < value < 1 / 64 and "rms" in known:
        call.keywords["rms"] = f"{2 * value**0.5:.4g}"
        return f"heat of the time {text} has the width rms={call.keywords['rms']}"
    if numbers is None or len(numbers) == 1 or call.name == "scattering":
        call.keywords["steps"] = text
        return f"a number of steps of the diffusion is steps={text}"
    return None


def _sigma(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if call.name == "denoise" and "noise" in known:
        call.keywords["noise"] = text
        return f"the standard deviation of the noise is noise={text}"
    if "sigma" in known:
        call.keywords["sigma"] = text
        return f"that is sigma={text}"
    numbers = _numbers(value)
    if numbers is None:
        if "fwhm" in known or "levels" in known:
            call.keywords["fwhm"] = f"2.3548 * {text}"
            return "a width names its measure: σ along one axis is fwhm=2.3548·σ"
        return None
    widths = [2.3548 * each for each in numbers]
    if "levels" in known:
        call.keywords["levels"] = f"{call.package}Widths(fwhm=[{_joined(widths)}])"
        return f"a width names its measure: σ along one axis is levels=aw.Widths(fwhm=[{_joined(widths)}]), that is 2.355·σ"
    if "fwhm" in known:
        call.keywords["fwhm"] = _joined(widths[:1])
        return f"a width names its measure: σ along one axis is fwhm={_joined(widths[:1])}, that is 2.355·σ"
    return None


def _widths(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    numbers = _numbers(value)
    if "levels" in known and "best" not in known and numbers is not None:
        call.keywords["levels"] = f"{call.package}Widths(fwhm=[{_joined(numbers)}])"
        return f"widths are levels=aw.Widths(fwhm=[{_joined(numbers)}])"
    if "fwhm" in known:
        call.keywords["fwhm"] = text
        return f"a width names its measure, fwhm={text}"
    return "there is no width to choose" if call.name in ("denoise", "region") else None


def _scales(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "levels" in known and is_number(value):
        return _levels(call, text, value, known)
    return _steps(call, text, value, known)


def _neighbors(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "neighbors" in known:
        call.keywords["neighbors"] = text
        return f"that is neighbors={text}"
    if call.name == "denoise":
        return "denoising chooses neighbors itself"
    if call.name == "impute":
        if len(call.arguments) == 1:
            owner = call.arguments[0]
            points = f'{owner}.obsm["X_pca"]' if "adata" in owner else owner
            call.arguments.append(f"{call.package}point_walk({points}, neighbors={text})")
        return "the walk is the second argument, aw.point_walk(coordinates, neighbors=…)"
    if "operator" in known:
        call.keywords["operator"] = f"{call.package}Operator(neighbors={text})"
        return f"that is operator=aw.Operator(neighbors={text})"
    return None


def _operator(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if isinstance(value, bool):
        return (
            "the bands are of the lazy walk; aw.smooth(shape, f, steps=3, lazy=False) takes steps of the walk that always "
            "moves, aw.Decomposer(shape).matrix(lazy=False) is its matrix, and exact=True is for heat on a surface"
        )
    if "operator" not in known:
        return "there is nothing to choose here"
    if value in ("walk", "surface"):
        call.keywords["operator"] = text
    elif isinstance(value, str) and any(part in value.lower() for part in ("cot", "heat", "beltrami", "fem", "gauss")):
        call.keywords["operator"] = '"surface"'
    return "that is operator='walk' or 'surface', or aw.Operator(…)"


def _threads(call: Call, text: str, value: Any, known: Collection[str]) -> str:
    return f"all cores are used; for fewer, with aw.threads({text}): …"


def _color_map(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "scale" not in known:
        return None
    call.keywords["scale"] = f"{call.package}ColorScale(color_map={text})"
    return f"that is scale=aw.ColorScale(color_map={text})"


def _range(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "scale" not in known:
        return None
    if isinstance(value, (tuple, list)):
        call.keywords["scale"] = f"{call.package}ColorScale(range={text})"
    return "that is scale=aw.ColorScale(range=(least, greatest))"


def _signal(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "signal" not in known:
        return None
    call.arguments.insert(0 if call.is_method else 1, text)
    return "the signal is the second argument" if not call.is_method else "the signal is the first argument"


def _where(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "where" in known:
        call.keywords["where"] = text
        return f"that is where={text}"
    if call.name == "smooth":
        call.function = f"{call.prefix}filter"
        for name in ("steps", "fwhm", "sigma", "rms"):
            call.keywords.pop(name, None)
        call.arguments.append('"smooth"')
        call.keywords["where"] = text
        return "only a filter is confined to a region; mask= leaves vertices out"
    if "mask" in known and not isinstance(value, (str, list)) and np.asarray(value).dtype.kind not in "iu":
        call.keywords["mask"] = text
        return f"the vertices that take part are mask={text}"
    return None


def _mask(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "mask" in known:
        call.keywords["mask"] = text
        return f"the places that take part are mask={text}"
    wrap_grid(call, mask=text)
    return f"the mask belongs to the grid, aw.grid(array, mask={text})"


def _weights(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if isinstance(value, str):
        return _operator(call, text, value, known) if "operator" in known else "the weights of the edges are used"
    if "where" in known:
        call.keywords["where"] = text
        return (
            "weights of an edit are where=…, those of a graph aw.graph(n, edges, weights), vertices to leave out mask=…"
        )
    return "weights of the edges are aw.graph(n, edges, weights), the vertices that take part mask=…"


def _gains(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    return _as_gains(call, text)[0] if "gains" in known else None


def _spacing(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "spacing" in known:
        call.keywords["spacing"] = text
        return f"that is spacing={text}"
    if call.name not in _OF_SHAPES:
        return None
    wrap_grid(call, spacing=text)
    return "the distance of places belongs to the grid, aw.grid(array, spacing=…)"


def _affine(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    return _spacing(call, f"np.linalg.norm(({text})[:3, :3], axis=0)", value, known)


def _periodic(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "periodic" in known or call.name in _OF_SHAPES:
        if value not in ("wrap", "periodic", "grid-wrap", "circular", True):
            return "borders reflect"
        if "periodic" in known:
            call.keywords["periodic"] = "True"
        else:
            wrap_grid(call, periodic="True")
        return "axes that repeat are aw.grid(array, periodic=True)"
    return None


def _axes(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "axes" in known:
        call.keywords["axes"] = text
        return f"the axes of the grid are axes={text}"
    if call.name not in _OF_SHAPES:
        return None
    wrap_grid(call, axes=text)
    return "the axes that are smoothed along belong to the grid, aw.grid(array, axes=…)"


def _points(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if call.name == "Shape" and not call.arguments:
        call.arguments.insert(0, text)
        return "the points come first"
    return None


def _vertices(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "vertices" not in known or call.name not in ("sample", "simplify"):
        return None
    call.keywords["vertices"] = text
    return f"that is vertices={text}"


def _faces_wanted(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "vertices" not in known:
        return None
    n = max(4, int(value) // 2 + 2) if is_number(value) else 0
    call.keywords["vertices"] = str(n) if n else f"{text} // 2"
    return "a closed mesh has half as many vertices as faces"


def _reduction(call: Call, text: str, value: Any, known: Collection[str]) -> str | None:
    if "ratio" not in known:
        return None
    call.keywords["ratio"] = f"{1 - value:.6g}" if is_number(value) else f"1 - {text}"
    return "the share that remains is ratio=0.1"


_RULES: dict[str, Callable[[Call, str, Any, Collection[str]], str | None]] = {
    "levels": _levels,
    "widths": _widths,
    "sigma": _sigma,
    "steps": _steps,
    "neighbors": _neighbors,
    "operator": _operator,
    "threads": _threads,
    "color_map": _color_map,
    "range": _range,
    "signal": _signal,
    "where": _where,
    "mask": _mask,
    "weights": _weights,
    "gains": _gains,
    "spacing": _spacing,
    "affine": _affine,
    "periodic": _periodic,
    "axes": _axes,
    "points": _points,
    "vertices": _vertices,
    "faces_wanted": _faces_wanted,
    "reduction": _reduction,
    "nothing": lambda call, text, value, known: "it has no counterpart here",
}


def unknown_attribute(name: str) -> str:
    """Message for a name that the package does not have, with the line that does what was meant."""
    start = f"module 'adwave' has no attribute {name!r}"
    if name.startswith("_") or not name.isidentifier():
        return start
    if name == "version":
        return f"{start}; write aw.__version__"
    import adwave

    ours = _FUNCTION_OF.get(name.lower())
    if ours is None:
        close = get_close_matches(name, adwave.__all__, n=1, cutoff=0.6) or get_close_matches(
            name.lower(), _FUNCTION_OF, n=1, cutoff=0.75
        )
        ours = _FUNCTION_OF.get(close[0], close[0]) if close else None
    call = written_call(name)
    if name in ("laplacian", "stiffness", "cotmatrix", "adjacency"):
        shown = call.arguments[0] if call is not None and call.arguments else "shape"
        return f"{start}; the diffusion Φ₁ = I − L is a sparse matrix; write aw.Decomposer({shown}).matrix()"
    if name in ("write", "save", "export", "write_mesh", "save_mesh") and call is not None and len(call.arguments) > 1:
        path, shape = sorted(call.arguments[:2], key=lambda text: not _literal_is_text(text))
        return f"{start}; a shape writes itself; write {shape}.write({path})"
    if name in ("reconstruct", "inverse", "synthesize", "idwt") and call is not None and call.arguments:
        return f"{start}; bands sum to their signal; write {call.arguments[0]}.reconstruct()"
    if ours is None:
        return f"{start}; help(aw) lists the functions"
    if call is None:
        return f"{start}; write aw.{ours}(…)" if not name[0].isupper() else f"{start}; write aw.{ours}"
    return f"{start}; write {_renamed(call, name, ours)}"


#: Attributes by the names that other libraries have for them, with what follows in place of their arguments.
_MEMBERS = {
    "write": "save export to_file write_mesh save_mesh dump",
    "n_vertices": "n_points n_verts num_vertices n_cells vertex_count n_samples nvertices num_nodes number_of_nodes N n",
    "n_faces": "n_triangles num_faces face_count n_cells_",
    "points": "V v verts xyz coords coordinates pos",
    "faces": "F triangles tris simplices",
    "fields": "point_data vertex_attributes attributes data columns",
    "matrix()": "P W A T L adjacency",
    "matrix": "to_scipy to_sparse toarray todense as_matrix transition_matrix laplacian to_matrix get_matrix dense to_csr",
    'signal("normals")': "normals vertex_normals point_normals compute_normals",
    'signal("mean-curvature")': "curvature mean_curvature",
    "decompose": "transform wavelets wavelet_transform dwt analyze split wavedec",
    "smooth": "diffuse blur gaussian heat apply gaussian_filter lowpass",
    "features": "keypoints detect blobs",
    "reconstruct": "inverse synthesize inverse_transform sum_bands",
    "select": "extract subset crop mask_vertices",
    "mean_length": "mean_edge_length avg_edge_length",
    "to_pyvista": "pyvista wrap",
    "to_trimesh": "trimesh",
}
_MEMBER_OF = {name: ours for ours, names in _MEMBERS.items() for name in names.split()}
#: Functions of the package that objects have as methods elsewhere.
_AS_FUNCTIONS = {
    "render": "plot show draw view render picture",
    "info": "info describe summary is_watertight stats",
    "simplify": "simplify decimate",
    "scattering": "scattering scatter",
    "impute": "impute magic",
    "studio": "studio gui",
    "report": "report",
    "distances": "distances distance hausdorff",
    "match": "match register icp align",
}
_AS_FUNCTION = {name: ours for ours, names in _AS_FUNCTIONS.items() for name in names.split()}


def unknown_constructor(kind: type, name: str) -> str:
    """Message for a constructor that a class does not have, such as ``Walk.from_networkx``."""
    start = f"type object {kind.__name__!r} has no attribute {name!r}"
    call = written_call(name) if name.startswith(("from_", "load", "read")) else None
    if call is None:
        return start
    call.function, package = call.prefix[:-1], "aw."
    call.is_method = False
    if kind.__name__ == "Walk" and "points" not in name and "neighbor" not in name:
        call.keywords = {"normalize": "'row'"}
    elif kind.__name__ == "Walk":
        call.function = f"{package}point_walk"
        _fit(call, "point_walk", [])
    return f"{start}; write {call}"


def unknown_member(kind: type, name: str) -> str:
    """Message for an attribute that an object does not have, with the line that does what was meant."""
    start = f"{kind.__name__!r} object has no attribute {name!r}"
    if name.startswith("_"):
        return start
    known = [each for each in dir(kind) if not each.startswith("_")]
    ours = _MEMBER_OF.get(name, "")
    if ours.startswith("matrix") and "matrix" not in known and (call := written_call(name)) is not None:
        return f"{start}; the diffusion Φ₁ = I − L is a sparse matrix; write aw.Decomposer({call.prefix[:-1]}).matrix()"
    if ours.partition("(")[0] not in known:
        close = get_close_matches(name, known, n=1, cutoff=0.7)
        ours = close[0] if close else ""
    function = _AS_FUNCTION.get(name, "")
    if not ours and not function:
        return start
    call = written_call(name)
    if call is None:
        return f"{start}; did you mean {ours or f'aw.{function}'}?"
    owner = call.prefix[:-1]
    if function and not (ours and ours not in _MEMBER_OF.values()):
        package = owner.partition(".")[0] if owner.startswith(("aw.", "adwave.")) else "aw"
        call.function, call.is_method = f"{package}.{function}", False
        call.arguments.insert(0, owner)
        if not call.is_made:
            call.is_made = True
        _fit(call, function, [owner])
        return f"{start}; write {call}"
    if name in ("toarray", "todense"):
        return f"{start}; write {owner}.matrix().{name}()"
    if ours.endswith(")") or not callable(getattr(kind, ours.partition("(")[0], None)):
        call.is_made, call.function = False, f"{owner}.{ours}"
    else:
        call.function, call.is_made = f"{owner}.{ours}", True
        if ours == "matrix":
            call.arguments, call.keywords = [], {}
    return f"{start}; write {call}"


def _fit(call: Call, function: str, values: Sequence[Any]) -> None:
    """Change the keywords of a call so that a function of the package takes them."""
    import adwave

    target = getattr(adwave, function)
    places, names = known_options(target.__init__ if isinstance(target, type) else target)
    places = [each for each in places if each != "self"]
    known = [*places, *names, *(("sigma",) if call.is_method else ())]
    for option in [option for option in call.keywords if option not in known]:
        text = call.keywords[option]
        _rename(call, option, text, _literal(text), known)
    if places and not call.is_method:
        _move_surplus(call, places, list(values), known)
    _complete(call, None, known)


def _renamed(call: Call, name: str, ours: str) -> Call:
    """The call of a function of another library as that of one here."""
    package = call.package
    call.function = f"{package}{ours}"
    lower = name.lower()
    if ours == "signal":
        call.arguments = [*call.arguments[:1], repr(_SIGNALS.get(lower, "normals"))]
        call.keywords = {}
        return call
    if ours == "baselines":
        call.function = f"{package}baselines.{_BASELINES.get(lower, lower)}"
        call.arguments, call.keywords = call.arguments[:1], {}
        return call
    if lower in ("sharpen", "enhance", "unsharp_mask"):
        call.arguments.append('"enhance"')
    if "gaussian" in lower or "img" in lower or "image" in lower or lower.startswith("wavedec"):
        if lower.startswith("wavedec"):
            call.arguments = call.arguments[:1]
        if len(call.arguments) > 1:
            call.keywords.setdefault("sigma", call.arguments.pop(1))
        wrap_grid(call)
        call.function, call.is_method = f"{call.arguments.pop(0)}.{ours}", True
    if ours == "sample" and not call.arguments:
        call.arguments = [repr(lower)]
    _fit(call, ours, [])
    return call


def _literal_is_text(text: str) -> bool:
    return isinstance(_literal(text), str)


def _literal(text: str) -> Any:
    """Value of a text that is a constant; otherwise an object that is none."""
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError):
        return _UNKNOWN


def _numbers(value: Any) -> list[float] | None:
    """A few numbers, or None."""
    if is_number(value):
        return [float(value)]
    if isinstance(value, (list, tuple, np.ndarray)) and 0 < len(value) <= 12 and all(is_number(v) for v in value):
        return [float(v) for v in value]
    return None


def _joined(numbers: Sequence[float]) -> str:
    return ", ".join(f"{number:.6g}" for number in numbers)


def text_of(value: Any) -> str:
    """Text of a value in a message."""
    if is_number(value):
        return f"{value:.6g}"
    text = repr(value) if isinstance(value, (str, bool, tuple, list, type(None))) else "…"
    return text if len(text) <= 60 else "…"
