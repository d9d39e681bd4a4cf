# Written by `python tests/test_exports.py` from the list in __init__.py.
from adwave import baselines as baselines
from adwave import dask as dask
from adwave import kernels as kernels
from adwave import sklearn as sklearn
from adwave import torch as torch
from adwave._shape import Shape as Shape
from adwave._shape import as_shape as as_shape
from adwave._shape import graph as graph
from adwave._shape import read as read
from adwave._shape import read_bytes as read_bytes
from adwave._shape import sample as sample
from adwave._decomposer import Bands as Bands
from adwave._decomposer import Decomposer as Decomposer
from adwave._decomposer import Layer as Layer
from adwave._options import Constraints as Constraints
from adwave._options import Octaves as Octaves
from adwave._options import Operator as Operator
from adwave._options import Steps as Steps
from adwave._options import Widths as Widths
from adwave._deform import CloneResult as CloneResult
from adwave._deform import Crossing as Crossing
from adwave._deform import Deformer as Deformer
from adwave._detail import morph as morph
from adwave._detail import transfer as transfer
from adwave._edits import decompose as decompose
from adwave._edits import filter as filter
from adwave._edits import filter_labels as filter_labels
from adwave._edits import smooth as smooth
from adwave._denoise import DenoiseResult as DenoiseResult
from adwave._denoise import denoise as denoise
from adwave._measures import FeatureOptions as FeatureOptions
from adwave._measures import Features as Features
from adwave._measures import Saliency as Saliency
from adwave._measures import SaliencyOptions as SaliencyOptions
from adwave._measures import features as features
from adwave._measures import gaze_scores as gaze_scores
from adwave._measures import saliency as saliency
from adwave._resample import Resampler as Resampler
from adwave._resample import resample as resample
from adwave._parcels import Parcels as Parcels
from adwave._repeatability import ChangedShape as ChangedShape
from adwave._repeatability import Repeatability as Repeatability
from adwave._repeatability import Trials as Trials
from adwave._repeatability import repeatability as repeatability
from adwave._register import Distances as Distances
from adwave._register import MatchResult as MatchResult
from adwave._register import SimplifyResult as SimplifyResult
from adwave._register import distances as distances
from adwave._register import match as match
from adwave._register import simplify as simplify
from adwave._hierarchy import Coefficients as Coefficients
from adwave._hierarchy import Hierarchy as Hierarchy
from adwave._hierarchy import hierarchy as hierarchy
from adwave._hierarchy import subdivide as subdivide
from adwave._recipe import Recipe as Recipe
from adwave._recipe import read_recipe as read_recipe
from adwave._walk import ScatteringResult as ScatteringResult
from adwave._walk import Walk as Walk
from adwave._walk import from_edge_index as from_edge_index
from adwave._walk import neighbors as neighbors
from adwave._walk import point_walk as point_walk
from adwave._walk import scattering as scattering
from adwave._walk import walk as walk
from adwave._grid import Grid as Grid
from adwave._grid import grid as grid
from adwave._raster import Raster as Raster
from adwave._raster import rasterize as rasterize
from adwave._time import Time as Time
from adwave._union import union as union
from adwave._sequence import CleanSequence as CleanSequence
from adwave._sequence import Sequence as Sequence
from adwave._sequence import sequence as sequence
from adwave._vectors import Singularities as Singularities
from adwave._vectors import TensorField as TensorField
from adwave._vectors import VectorField as VectorField
from adwave._vectors import tensors as tensors
from adwave._vectors import vectors as vectors
from adwave._impute import Imputation as Imputation
from adwave._impute import impute as impute
from adwave._info import Info as Info
from adwave._info import info as info
from adwave._info import memory_needed as memory_needed
from adwave._info import preset_gains as preset_gains
from adwave._info import region as region
from adwave._info import report as report
from adwave._info import signal as signal
from adwave._picture import Camera as Camera
from adwave._picture import ColorScale as ColorScale
from adwave._picture import Picture as Picture
from adwave._picture import render as render
from adwave._studio import StudioResult as StudioResult
from adwave._studio import studio as studio
from adwave._environment import show_versions as show_versions
from adwave._environment import threads as threads
from adwave._native import InternalError as InternalError

__all__ = [
    "Bands",
    "Camera",
    "ChangedShape",
    "CleanSequence",
    "CloneResult",
    "Coefficients",
    "ColorScale",
    "Constraints",
    "Crossing",
    "Decomposer",
    "Deformer",
    "DenoiseResult",
    "Distances",
    "FeatureOptions",
    "Features",
    "Grid",
    "Hierarchy",
    "Imputation",
    "Info",
    "InternalError",
    "Layer",
    "MatchResult",
    "Octaves",
    "Operator",
    "Parcels",
    "Picture",
    "Raster",
    "Recipe",
    "Repeatability",
    "Resampler",
    "Saliency",
    "SaliencyOptions",
    "ScatteringResult",
    "Sequence",
    "Shape",
    "SimplifyResult",
    "Singularities",
    "Steps",
    "StudioResult",
    "TensorField",
    "Time",
    "Trials",
    "VectorField",
    "Walk",
    "Widths",
    "__version__",
    "as_shape",
    "baselines",
    "decompose",
    "denoise",
    "distances",
    "features",
    "filter",
    "filter_labels",
    "from_edge_index",
    "gaze_scores",
    "graph",
    "grid",
    "hierarchy",
    "impute",
    "info",
    "kernels",
    "match",
    "memory_needed",
    "morph",
    "neighbors",
    "point_walk",
    "preset_gains",
    "rasterize",
    "read",
    "read_bytes",
    "read_recipe",
    "region",
    "render",
    "repeatability",
    "report",
    "resample",
    "saliency",
    "sample",
    "scattering",
    "sequence",
    "show_versions",
    "signal",
    "simplify",
    "smooth",
    "studio",
    "subdivide",
    "tensors",
    "threads",
    "transfer",
    "union",
    "vectors",
    "walk",
]
__version__: str

_EXPORTS: dict[str, tuple[str, ...]]
_MODULES: tuple[str, ...]

def __dir__() -> list[str]: ...
