from adwave import baselines as baselines
from adwave._bands import Bands as Bands, Layer as Layer
from adwave._decomposer import Decomposer as Decomposer
from adwave._environment import show_versions as show_versions, threads as threads
from adwave._functions import (
    Denoised as Denoised,
    Features as Features,
    Info as Info,
    Saliency as Saliency,
    decompose as decompose,
    denoise as denoise,
    features as features,
    filter as filter,
    gaze_scores as gaze_scores,
    info as info,
    memory_needed as memory_needed,
    preset_gains as preset_gains,
    region as region,
    report as report,
    saliency as saliency,
    signal as signal,
)
from adwave._native import InternalError as InternalError
from adwave._picture import Picture as Picture, render as render
from adwave._recipe import Recipe as Recipe, read_recipe as read_recipe
from adwave._shape import (
    Shape as Shape,
    as_shape as as_shape,
    graph as graph,
    read as read,
    read_bytes as read_bytes,
    sample as sample,
)

__all__ = [
    "Bands",
    "Decomposer",
    "Denoised",
    "Features",
    "Info",
    "InternalError",
    "Layer",
    "Picture",
    "Recipe",
    "Saliency",
    "Shape",
    "__version__",
    "as_shape",
    "baselines",
    "decompose",
    "denoise",
    "features",
    "filter",
    "gaze_scores",
    "graph",
    "info",
    "memory_needed",
    "preset_gains",
    "read",
    "read_bytes",
    "read_recipe",
    "region",
    "render",
    "report",
    "saliency",
    "sample",
    "show_versions",
    "signal",
    "threads",
]
__version__: str

def __dir__() -> list[str]: ...
