from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Report = Callable[[int, int], object] | None
_Csr = tuple[NDArray[Any], NDArray[np.int32], NDArray[np.int32]]

__all__ = [
    "ACCURACY",
    "ChangeData",
    "EditorData",
    "FWHM",
    "FrameData",
    "InternalError",
    "MultiscaleData",
    "Prepared",
    "REACH",
    "RecipeData",
    "ShapeData",
    "THETA",
    "__version__",
    "apply_bands",
    "asked_threads",
    "basis_matrices",
    "check_region",
    "color_map_names",
    "denoise_points",
    "denoise_values",
    "differential_coordinates",
    "diffusion_matrix",
    "distances",
    "feature_map",
    "find_features",
    "from_differential",
    "gaze_scores",
    "harmonics",
    "lee",
    "matched",
    "png_of",
    "preset_gains",
    "preset_names",
    "render_picture",
    "run_command",
    "saliency_map",
    "set_threads",
    "signature",
    "simplified",
    "studio",
    "taubin",
    "threads",
]
__version__: str
ACCURACY: float
FWHM: float
THETA: float
REACH: dict[str, float]

class InternalError(RuntimeError): ...

@final
class ShapeData:
    @staticmethod
    def read(
        path: str | PathLike[str],
        kind: str | None = None,
        progress: _Report = None,
        bounds: tuple[list[float], list[float]] | None = None,
        resolution: float | None = None,
    ) -> ShapeData: ...
    @staticmethod
    def read_bytes(content: bytes, name: str | None = None, kind: str | None = None) -> ShapeData: ...
    @staticmethod
    def from_arrays(
        points: _Floats, corners: NDArray[np.uint32], offsets: NDArray[np.uint32] | None = None, kind: str | None = None
    ) -> ShapeData: ...
    @staticmethod
    def from_graph(
        n_vertices: int,
        rows: NDArray[np.uint32],
        columns: NDArray[np.uint32],
        weights: _Floats | None,
        undirected: bool,
    ) -> ShapeData: ...
    @staticmethod
    def sample(name: str, vertices: int | None = None, noise: float | None = None, seed: int = 1) -> ShapeData: ...
    @property
    def kind(self) -> Literal["mesh", "cloud", "graph"]: ...
    @property
    def name(self) -> str: ...
    @property
    def format(self) -> str | None: ...
    @property
    def structure(self) -> str | None: ...
    @property
    def n_vertices(self) -> int: ...
    @property
    def n_faces(self) -> int: ...
    @property
    def points(self) -> _Floats: ...
    @property
    def triangles(self) -> NDArray[np.uint32] | None: ...
    def polygons(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]: ...
    def edges(self) -> tuple[NDArray[np.uint32], _Floats, bool]: ...
    def field_names(self) -> list[str]: ...
    def face_field_names(self) -> list[str]: ...
    def field(self, name: str) -> NDArray[Any] | None: ...
    def face_field(self, name: str) -> NDArray[Any] | None: ...
    def with_points(self, points: _Floats) -> ShapeData: ...
    def with_field(self, name: str, values: NDArray[Any]) -> ShapeData: ...
    def with_signal(self, name: str, values: _Floats) -> ShapeData: ...
    def with_face_field(self, name: str, values: NDArray[Any]) -> ShapeData: ...
    def taken_as(self, kind: str) -> ShapeData: ...
    def write(self, path: str | PathLike[str], format: str | None = None, progress: _Report = None) -> list[str]: ...
    def to_bytes(self, format: str) -> bytes: ...
    def signal(self, name: str, texture: str | PathLike[str] | None = None) -> _Floats: ...

@final
class Prepared:
    def __new__(cls, shape: ShapeData, options: dict[str, Any], progress: _Report = None) -> Prepared: ...
    @property
    def n_vertices(self) -> int: ...
    @property
    def operator(self) -> str: ...
    @property
    def is_graph(self) -> bool: ...
    def masked(self, flags: NDArray[np.bool_]) -> Prepared: ...
    def facts(self) -> dict[str, Any]: ...
    def lengths(self) -> tuple[float, float, float]: ...
    def is_reversible(self) -> bool: ...
    def areas(self) -> _Floats: ...
    def welding(self) -> tuple[NDArray[np.uint32], _Floats]: ...
    def levels(
        self,
        levels: int | None = None,
        voices: int | None = None,
        lengths: Sequence[float | str] | None = None,
        fwhm: Sequence[float | str] | None = None,
        reach: float | None = None,
    ) -> tuple[list[float], str]: ...
    def sigma(self, steps: Sequence[float]) -> list[float]: ...
    def bytes(self, n_channels: int, n_levels: int) -> tuple[int, int]: ...
    def bands(
        self, signal: _Floats | None, steps: Sequence[float], accuracy: float, progress: _Report = None
    ) -> tuple[_Floats, float, int, int]: ...
    def weighted(
        self,
        signal: _Floats | None,
        steps: Sequence[float],
        factors: Sequence[float],
        accuracy: float,
        progress: _Report = None,
    ) -> _Floats: ...
    def editor(
        self, signal: _Floats | None, steps: Sequence[float], accuracy: float, progress: _Report = None
    ) -> EditorData: ...
    def settled(
        self,
        after: _Floats,
        along: str | None = None,
        border: str = "natural",
        volume: str = "free",
        progress: _Report = None,
    ) -> _Floats: ...
    def region(self, region: str) -> _Floats: ...
    def vertex_functions(
        self, vertex: int, steps: Sequence[float], progress: _Report = None
    ) -> tuple[_Floats, _Floats, int]: ...

@final
class EditorData:
    def apply(
        self, layers: Sequence[tuple[Sequence[float] | str, str | _Floats | None]], out: _Floats | None = None
    ) -> _Floats: ...
    def apply_recipe(self, recipe: RecipeData) -> _Floats: ...

@final
class RecipeData:
    def __new__(cls, text: str) -> RecipeData: ...
    @property
    def n_layers(self) -> int: ...
    def text(self) -> str: ...
    def write(self, path: str | PathLike[str]) -> None: ...
    def content(self) -> dict[str, Any]: ...

def threads() -> int: ...
def asked_threads() -> int: ...
def set_threads(n: int) -> None: ...
def run_command(arguments: Sequence[str]) -> int: ...
def preset_gains(name: str, n_levels: int) -> list[float]: ...
def preset_names() -> list[str]: ...
def check_region(region: str) -> None: ...
def color_map_names() -> list[str]: ...
def saliency_map(
    prepared: Prepared,
    signal: _Floats | None,
    steps: Sequence[float],
    accuracy: float,
    weighting: str,
    unsigned: bool,
    skip: int | None,
    border: float | None,
    up: int | None,
    per_level: bool,
    progress: _Report = None,
) -> tuple[_Floats, list[_Floats], list[tuple[int, float, float, float, float]], str]: ...
def find_features(
    prepared: Prepared,
    signal: _Floats | None,
    steps: Sequence[float],
    accuracy: float,
    theta: float,
    response: str,
    per_component: bool,
    refine: bool,
    edge_ratio: float | None,
    border: float | None,
    best: int | None,
    descriptors: bool,
    progress: _Report = None,
) -> dict[str, NDArray[Any]]: ...
def denoise_points(
    shape: ShapeData, strength: float, creases: str, noise: float | None, weld: bool, progress: _Report = None
) -> tuple[_Floats, dict[str, Any]]: ...
def denoise_values(
    prepared: Prepared,
    signal: _Floats | None,
    strength: float,
    creases: str,
    noise: float | None,
    progress: _Report = None,
) -> tuple[_Floats, list[dict[str, Any]]]: ...
def gaze_scores(
    map: _Floats, fixations: _Floats, threshold: float, points: _Floats | None = None
) -> dict[str, float]: ...
def diffusion_matrix(prepared: Prepared) -> _Csr: ...
def basis_matrices(
    prepared: Prepared,
    n_levels: int,
    drop_tolerance: float | None,
    max_bytes: int | None,
    progress: _Report = None,
) -> tuple[list[_Csr], list[_Csr]]: ...
def png_of(array: NDArray[np.uint8]) -> bytes: ...
def render_picture(
    shape: ShapeData,
    size: tuple[int, int],
    values: _Floats | None = None,
    colors: NDArray[np.uint8] | None = None,
    label: str = "",
    color_map: str | None = None,
    range: tuple[float, float] | None = None,
    color_bar: bool = True,
    view: str = "three-quarter",
    up: str | None = None,
    zoom: float = 1.0,
    focus: Sequence[float] | None = None,
    orthographic: bool = False,
    background: Sequence[int] | None = None,
    balls: Sequence[tuple[Sequence[float], float, Sequence[int]]] | None = None,
    samples: int = 3,
    progress: _Report = None,
) -> tuple[bytes, NDArray[np.uint8]]: ...
def simplified(
    shape: ShapeData,
    error: float | str | None,
    vertices: int | None,
    ratio: float | None,
    keep_border: bool,
    progress: _Report = None,
) -> tuple[ShapeData, NDArray[np.uint32] | None, float, float]: ...
def matched(
    first: Prepared, second: Prepared, theta: float, within: float, scaled: bool, progress: _Report = None
) -> dict[str, Any]: ...
def distances(
    first: Prepared, second: Prepared, fitted: bool, limit: float | str | None, progress: _Report = None
) -> tuple[_Floats, bool, _Floats]: ...
def harmonics(shape: ShapeData, k: int, progress: _Report = None) -> tuple[_Floats, _Floats]: ...
def signature(
    shape: ShapeData, kind: str, k: int, n_scales: int, progress: _Report = None
) -> tuple[_Floats, _Floats]: ...
def lee(shape: ShapeData, progress: _Report = None) -> tuple[_Floats, _Floats]: ...
def studio(shape: ShapeData, port: int, ready: Callable[[str], object]) -> tuple[str, _Floats]: ...
def taubin(shape: ShapeData, signal: _Floats, weights: str, lam: float, mu: float, iterations: int) -> _Floats: ...
def feature_map(
    shape: ShapeData, signal: _Floats, times: Sequence[float], progress: _Report = None
) -> list[tuple[float, _Floats, list[tuple[int, int, int, float]], int]]: ...
def apply_bands(
    prepared: Prepared,
    signal: _Floats | None,
    bands: _Floats,
    layers: Sequence[tuple[Sequence[float] | str, str | _Floats | None]],
    out: _Floats | None = None,
) -> _Floats: ...
def differential_coordinates(shape: ShapeData, signal: _Floats, weights: str) -> _Floats: ...
def from_differential(
    shape: ShapeData,
    coordinates: _Floats,
    anchors: Sequence[int],
    targets: _Floats,
    anchor_weight: float,
    weights: str,
) -> _Floats: ...
@final
class FrameData:
    def __new__(cls, prepared: Prepared, family: str, n_kernels: int, accuracy: float) -> FrameData: ...
    @property
    def bounds(self) -> tuple[float, float]: ...
    @property
    def degree(self) -> int: ...
    @property
    def n_kernels(self) -> int: ...
    def kernels(self, lambda_: Sequence[float]) -> _Floats: ...
    def analyze(self, signal: _Floats, progress: _Report = None) -> _Floats: ...
    def synthesize(self, coefficients: _Floats, tolerance: float, progress: _Report = None) -> tuple[_Floats, int]: ...

@final
class MultiscaleData:
    def __new__(
        cls, prepared: Prepared, orthogonal: bool, n_levels: int, precision: float, progress: _Report = None
    ) -> MultiscaleData: ...
    @property
    def ranks(self) -> list[int]: ...
    def analyze(self, signal: _Floats) -> list[_Floats]: ...
    def synthesize(self, coefficients: Sequence[_Floats]) -> _Floats: ...
    def functions(self, level: int, kind: int) -> _Floats: ...

@final
class ChangeData:
    def __new__(cls, prepared: Prepared, kind: str, amount: float, seed: int) -> ChangeData: ...
    @property
    def shape(self) -> ShapeData: ...
    def length_before(self, length: float) -> float: ...
    def before(self, points: _Floats) -> _Floats: ...
    def found_again(
        self, reference: Prepared, before: dict[str, NDArray[Any]], after: dict[str, NDArray[Any]], sigmas: float
    ) -> tuple[list[tuple[int, int, int]], int, float]: ...
