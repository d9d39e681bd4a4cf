"""`GridDecomposer`: the domain of an image or a volume, prepared once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._decomposer import Decomposer
from adwave._grid_layout import GridLayout, finite_grid, plain_array
from adwave._layout import Layout, without_unknown
from adwave._options import LevelsLike, Operator, SignalLike
from adwave._own_operator import GivenOperator
from adwave._shape import Shape

Values = NDArray[np.float64]


@dataclass(frozen=True)
class _GridOptions:
    """Sizes, spacings, borders and places with data, as the extension takes them."""

    sizes: list[int]
    spacing: list[float]
    periodic: list[bool]
    kept: Union[NDArray[np.bool_], None]


class GridSource(Protocol):
    """What a `GridDecomposer` uses of its grid."""

    spacing: tuple[float, ...]
    periodic: tuple[bool, ...]
    _kept: Union[NDArray[np.bool_], None]
    _values: NDArray[Any]

    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def ndim(self) -> int: ...
    @property
    def n_vertices(self) -> int: ...
    def layout_of(self, shape: tuple[int, ...], name: str = "signal") -> Layout: ...
    def _with_array(self, name: str) -> GridSource: ...


class GridDecomposer(Decomposer):
    """A `Decomposer` of a `Grid`: signals and results have the axes of the grid."""

    __slots__ = ("_grid",)

    _grid: GridSource

    def __init__(self, grid: GridSource) -> None:
        none = np.empty(0, dtype=np.uint32)
        self._grid = grid
        shape = _native.ShapeData.from_graph(grid.n_vertices, none, none, None, True)
        self._options = Operator("surface")
        options = _GridOptions(list(grid.shape), list(grid.spacing), list(grid.periodic), grid._kept)
        self._data = _native.Prepared.from_grid(shape, options)
        self._mask = self._given_walk = self._by_width = self._last_masked = None

    @property
    def shape(self) -> Shape:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Shape of a surface, which a grid has not: functions that need one say so."""
        raise ValueError(
            "shape: a grid has no surface, points or file; it goes to aw.decompose, smooth, filter, filter_labels, denoise, "
            "saliency, features and region, and to the methods of aw.grid(…), such as grid.smooth(fwhm=8)"
        )

    @property
    def operator(self) -> str:
        """Kind of the diffusion operator."""
        return "surface" if self._given_walk is None else super().operator

    @property
    def _sizes(self) -> tuple[int, ...]:
        return self._grid.shape

    def _own_signal(self) -> SignalLike:
        return self._grid._values

    def _outsiders(self) -> NDArray[np.bool_] | None:
        return None if self._grid._kept is None else ~self._grid._kept

    def _by_place(self) -> Layout:
        return GridLayout.for_axes(self._grid.shape, tuple(range(self._grid.ndim)))

    def _signal_values(self, signal: SignalLike) -> tuple[Values | None, Layout]:
        if isinstance(signal, str):
            signal = self._grid._with_array(signal)._values
        array = self._grid._values if signal is None else plain_array(signal, "signal")
        layout = self._grid.layout_of(array.shape)
        if layout.n_channels == 0:
            raise ValueError(f"signal: shape {array.shape} has no channels")
        is_grid = isinstance(layout, GridLayout)
        own = (
            layout if is_grid else GridLayout.for_axes((*self._sizes, *layout.channels), tuple(range(len(self._sizes))))
        )
        values = finite_grid(
            array if is_grid else own.arrange(array.reshape(self.n_vertices, -1)), cast(GridLayout, own)
        )
        return values if isinstance(signal, np.ma.MaskedArray) else without_unknown(values), layout

    def for_levels(self, levels: LevelsLike, *, analysis: bool = False) -> GridDecomposer:
        """This grid: its operator suits all levels."""
        return self

    def region(self, region: str | ArrayLike) -> Values:  # type: ignore[override]
        """Weights of a region in the shape of the grid; see `Decomposer.region`."""
        if not isinstance(region, str):
            region = np.reshape(region, -1) if np.shape(region) == self._sizes else region
        return super().region(region).reshape(self._sizes)

    def with_mask(self, mask: ArrayLike) -> GridDecomposer:
        """Grid without some places: the diffusion goes around them, and their bands are NaN.

        Parameters
        ----------
        mask : array of bool
            True at places that are left out, in the shape of the grid.
        """
        given = np.asarray(mask)
        if given.shape not in (self._sizes, (self.n_vertices,)):
            raise ValueError(f"mask: shape {given.shape} is not that of the grid, {self._sizes}")
        flags = np.ascontiguousarray(given, dtype=bool).reshape(-1)
        return self._with_data(self._data.with_mask(flags), flags, self._given_walk)

    def _with_given(self, given: Any) -> GridDecomposer:
        data = (
            given.replace_operator(self._data)
            if isinstance(given, GivenOperator)
            else self._data.with_walk(given._data)
        )
        other = self._with_data(data, None, given)
        return other if self._mask is None else other.with_mask(self._mask)

    def _with_data(self, data: _native.Prepared, mask: NDArray[np.bool_] | None, given: Any) -> GridDecomposer:
        other = GridDecomposer.__new__(GridDecomposer)
        other._grid, other._options, other._data, other._mask, other._given_walk = (
            self._grid,
            self._options,
            data,
            mask,
            given,
        )
        other._by_width = other._last_masked = None
        return other

    def facts(self) -> dict[str, Any]:
        """Facts about the grid: axes, spacings, places with data, and the size to which lengths in % refer."""
        grid, outside = self._grid, self._outsiders()
        known = self.n_vertices if outside is None else int(np.count_nonzero(~outside))
        return {
            **{
                "kind": "grid",
                "shape": list(grid.shape),
                "spacing": list(grid.spacing),
                "periodic": list(grid.periodic),
            },
            **{"places": self.n_vertices, "places_with_data": known, "diagonal": self.diagonal, "extent": self.extent},
        }

    def __repr__(self) -> str:
        return f"<adwave.Decomposer: heat on {self._grid!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_decomposer, (self._grid, self._mask, self._given_walk)


def _restore_decomposer(grid: GridSource, mask: NDArray[np.bool_] | None, given: Any) -> Decomposer:
    prepared: Decomposer = GridDecomposer(grid)
    if given is not None:
        prepared = prepared._with_given(given)
    return prepared if mask is None else prepared.with_mask(mask)
