"""`Operator`: the diffusion of a shape, a graph or a walk on a device of PyTorch, prepared once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._options import BandsRequest, LevelsLike, check_steps
from adwave._torch_kernels import SeriesTable, SparseRows, chebyshev_sums, clenshaw_sum, powers
from adwave._torch_series import MOST_TERMS, Semigroup, Series, StepRounding, band_series
from adwave._walk import Walk

#: Sum of the terms that are left out, relative to the sum of all.
_REMAINDER = {torch.float64: 1e-16, torch.float32: 1e-8}
#: Step by which the rate of heat is measured, where, and by how many terms of a power series of the step.
_SHORT, _START, _RATE_TERMS = 2.0**-16, 2.0**-6, 8
#: Accuracy of that measurement.
_FINEST = 1e-13
#: Seed of the signal by which the rate of heat is measured.
_SEED = 37


class Operator:
    """A diffusion on a device: prepared once, then each call multiplies there and copies nothing to the CPU.

    All functions of `adwave.torch` take it where they take a shape. Bands are polynomials of Φ₁ in the type of the operator; the
    first product, ``(I − Φ₁)f``, is always in double precision. On a GPU one kernel a step (by Triton) makes the product,
    the recurrence and the sums of the bands; where Triton is missing, or where some rows are much longer than the mean,
    PyTorch's sparse products do.

    Parameters
    ----------
    domain : shape_like, Decomposer or Walk
        Shape, graph or walk; a `Decomposer` brings its operator, ``aw.Decomposer(shape, operator="surface")`` heat. Walks
        that are not reversible, or whose rows are not normalized, have scattering and imputation only.
    device : torch.device or str
        Device that computes; signals must be there.
    dtype : torch.dtype, optional
        ``torch.float64`` or ``torch.float32``, the type of the signals; the default type of PyTorch without it.

    Raises
    ------
    ValueError
        For a grid, a mask, or an operator without rows.
    TypeError
        For half precision, whose rounding is larger than the finest bands of most signals.

    Notes
    -----
    Memory: about 200 bytes for each vertex of a mesh in double precision. A call takes as much as its bands, and that of
    eight signals.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> operator = aw.torch.Operator(aw.sample("sphere", vertices=500), device="cpu", dtype=torch.float64)
    >>> f = torch.rand(500, 3, dtype=torch.float64)
    >>> bands = aw.torch.bands(operator, f, 4)
    >>> bool(torch.allclose(bands.sum(0), f))
    True
    """

    #: Number of vertices.
    n_vertices: int
    device: torch.device
    dtype: torch.dtype
    #: Meaning of its steps: ``'steps'`` of a lazy walk, ``'plain'`` steps of another walk, ``'heat'``, ``'powers'`` if not
    #: reversible.
    kind: str

    def __init__(self, domain: object, device: torch.device | str = "cpu", dtype: torch.dtype | None = None) -> None:
        from scipy.sparse import csr_array, identity

        dtype = torch.get_default_dtype() if dtype is None else dtype
        if dtype not in _REMAINDER:
            raise TypeError(
                f"dtype must be torch.float64 or torch.float32, got {dtype}: bands are differences of almost equal values; "
                "keep a signal in half precision if you like, and pass signal.float()"
            )
        self._source = (domain, device, dtype)
        self.device, self.dtype = torch.empty(0, device=device).device, dtype
        step, share = self._read(domain)
        one = identity(step.shape[0], format="csr")
        is_polynomial = self.kind != "powers"
        rows = _rows(4 * step - 2 * one if is_polynomial else step)
        self._rows = SparseRows(rows, dtype, self.device)
        self._rounding = StepRounding.of_rows(
            self._rows.longest, float(abs(rows).sum(axis=1).max(initial=0.0)), np.dtype(str(dtype).split(".")[1])
        )
        # P = factors[0]·rows + factors[1]·I.
        self._power = {"steps": (0.25, 0.5), "heat": (0.25, 0.5), "plain": (0.5, 0.0), "powers": (1.0, 0.0)}[self.kind]
        self._difference = SparseRows(_rows(one - step), torch.float64, self.device) if is_polynomial else None
        self._adjoint, self._adjoint_difference = self._rows, self._difference
        # Isolated vertices have no share and keep their values. Others without a share, those without area, lead to
        # vertices that have one; the norms of the polynomials then grow with the degree.
        share = positive_share(step, self._welded, share)
        is_bounded = bool((share > 0).all())
        self._growth = 1.0 if is_bounded else 2.0 + 1.2 * MOST_TERMS
        if not (is_polynomial and is_bounded):
            # The adjoint by the transposed matrix, without the stationary distribution.
            self._adjoint = SparseRows(_rows(rows.T), dtype, self.device)
            if is_polynomial:
                self._adjoint_difference = SparseRows(_rows((one - step).T), torch.float64, self.device)
            share = 1.0 / np.bincount(self._welded, minlength=step.shape[0])[self._welded]
        share = share * (len(share) / share.sum() if share.size else 1.0)
        self._share = torch.from_numpy(np.ascontiguousarray(share)).to(self.device)[:, None]
        self._average: SparseRows | None = None
        if step.shape[0] < self.n_vertices:
            counts = np.bincount(self._welded, minlength=step.shape[0])
            places = np.arange(self.n_vertices)
            mean = csr_array((1.0 / counts[self._welded], (self._welded, places)), shape=(len(counts), len(places)))
            self._average = SparseRows(_rows(mean), torch.float64, self.device)
        self._place = torch.from_numpy(self._welded.astype(np.int64)).to(self.device) if self._average else None
        self._requests: dict[Any, Any] = {}

    def _read(self, domain: object) -> tuple[Any, NDArray[np.float64]]:
        """Φ₁ over the welded vertices, and the share of each vertex in the stationary distribution."""
        self._domain: Decomposer | None = None
        if isinstance(domain, Walk) and not (domain.is_reversible and domain.normalization == "row"):
            self._semigroup, self.kind = Semigroup("powers"), "powers"
            self.n_vertices, self._welded = domain.n_nodes, np.arange(domain.n_nodes)
            return domain.matrix(), np.ones(domain.n_nodes)
        own = prepare_decomposer(domain)
        if own.mask is not None:
            raise ValueError("an operator on a device has no mask; leave the vertices out of the shape, shape.part(…)")
        self.n_vertices, step = own.n_vertices, own.matrix()
        self._welded, share = own._data.welding()
        if step.shape[0] == self.n_vertices:
            # Rows are in the order of the shape.
            self._welded = np.arange(self.n_vertices)
        self._domain = own
        self._semigroup = _semigroup(own, step, share)
        self.kind = self._semigroup.kind
        return step, share

    @property
    def is_fused(self) -> bool:
        """True if one kernel makes a step, and False if PyTorch's sparse products do."""
        return self._rows.is_fused

    @property
    def n_bytes(self) -> int:
        """Bytes on the device."""
        parts = {self._rows, self._difference, self._adjoint, self._adjoint_difference, self._average} - {None}
        return self._share.nbytes + sum(part.bytes for part in parts if part is not None)

    def schedule(self, levels: LevelsLike) -> tuple[float, ...]:
        """Number of steps of each level, as `Decomposer.schedule`.

        Raises
        ------
        ValueError
            If the operator has no bands, or levels are widths and its shape was prepared without an operator.
        """
        if self._domain is None or self.kind == "powers":
            raise ValueError(
                "bands and filters need a reversible walk with normalized rows; use scatter_bands, Scattering or impute"
            )
        return tuple(self._domain.schedule(levels))

    def request(self, steps: Sequence[float]) -> DeviceBands:
        """Bands between these numbers of steps; prepared by the first call with them."""
        key = tuple(check_steps(steps))
        if key not in self._requests:
            self.schedule(1)
            if self.kind == "plain" and any(n != int(n) for n in key):
                raise ValueError(
                    f"steps must be whole, since this walk does not stay half of the time, got {list(key)}"
                )
            pairs = zip((0.0, *key[:-1]), key, strict=True)
            series = [band_series(self._semigroup, a, b, _REMAINDER[self.dtype]) for a, b in pairs]
            self._requests[key] = DeviceBands(self, key, series)
        return self._requests[key]

    def power_request(self, stops: Sequence[int]) -> DevicePowers:
        """Bands between powers of the walk at these whole numbers of steps."""
        key = ("powers", *stops)
        if key not in self._requests:
            self._requests[key] = DevicePowers(self, tuple(stops))
        return self._requests[key]

    def error_bounds(self, signal: torch.Tensor, levels: LevelsLike) -> list[float]:
        """Proven bound of the relative error of each band, in the norm of the stationary distribution.

        The error is that of the terms that were left out and, in single precision, of rounding: as in the library, rounding
        in double precision and of the signal itself come on top. It takes the time of `bands`, and waits for the device.

        Parameters
        ----------
        signal : tensor
            Signal or batch as in `combine_bands`.
        levels : int, Widths, Steps or Octaves
            As in `adwave.decompose`.

        Returns
        -------
        (levels,) list of float
            Infinite where the bound says nothing.

        Examples
        --------
        >>> import adwave as aw, torch
        >>> operator = aw.torch.Operator(aw.sample("sphere", vertices=500), dtype=torch.float32)
        >>> all(bound < 1e-3 for bound in operator.error_bounds(torch.rand(500), 4))
        True
        """
        rows, _, _ = vertex_rows(signal, self.n_vertices)
        request = self.request(self.schedule(levels))
        return request.error_bounds(rows.contiguous(), request.split(rows.contiguous()))

    def check(self, signal: torch.Tensor) -> None:
        """Raise TypeError or ValueError unless a signal has the type and the device of the operator."""
        if signal.dtype != self.dtype:
            raise TypeError(
                f"signal must be of {self.dtype}, the type of the operator, got {signal.dtype}; pass "
                f"signal.to({self.dtype}), or dtype={signal.dtype} to aw.torch.Operator"
            )
        if signal.device != self.device:
            raise ValueError(f"signal is on {signal.device}, and the operator on {self.device}; move one of them")

    def mean(self, values: torch.Tensor) -> torch.Tensor:
        """Mean over the vertices of each welded vertex, in double precision."""
        values = values.double()
        return values if self._average is None else self._average.product(values)

    def spread(self, values: torch.Tensor) -> torch.Tensor:
        """Values of the welded vertices at each vertex."""
        return values if self._place is None else values[self._place]

    def first_difference(self, mean: torch.Tensor) -> torch.Tensor:
        """``(I − Φ₁)f`` in double precision. The mean over all vertices has none, but its rounding would have."""
        assert self._difference is not None, "an operator with bands has differences"
        return self._difference.product(mean - mean.mean(0)) if mean.numel() else mean

    def __repr__(self) -> str:
        return f"<adwave.torch.Operator: {self.n_vertices} vertices, {self.kind}, {self.dtype} on {self.device}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Operator, self._source


class DeviceBands:
    """Bands of an operator between some numbers of steps: a request of `adwave._torch_functions`."""

    def __init__(self, operator: Operator, steps: tuple[float, ...], series: list[Series]) -> None:
        self.operator, self.steps, self.series = operator, steps, series
        self.table = SeriesTable.on_device([own.coefficients for own in series], operator.dtype, operator.device)
        self._combined: dict[tuple[float, ...], SeriesTable] = {}

    @property
    def n_pieces(self) -> int:
        """Number of bands and the rest."""
        return len(self.steps) + 1

    def split(self, signal: torch.Tensor) -> torch.Tensor:
        """Bands and the rest, (J + 1) × n × channels."""
        operator = self.operator
        operator.check(signal)
        mean = operator.mean(signal)
        start = operator.first_difference(mean).to(operator.dtype)
        found = signal.new_empty((self.n_pieces, *start.shape))
        chebyshev_sums(operator._rows, start, self.table, found[:-1])
        if operator._place is not None:
            found = operator.spread(found.movedim(0, 1)).movedim(1, 0).contiguous()
            found[0] += (signal.double() - operator.spread(mean)).to(signal.dtype)
        torch.sum(found[:-1], 0, out=found[-1])
        torch.sub(signal, found[-1], out=found[-1])
        return found

    def join(self, weights: torch.Tensor) -> torch.Tensor:
        """Adjoint of `split`: with bands self-adjoint under the share π, ``g_J + π·Σ_j W_(j)((g_j − g_J)/π)``."""
        scaled = (weights[:-1] - weights[-1]).div_(self.operator._share.to(weights.dtype))
        return weights[-1] + self._adjoint(scaled, self.table)

    def combine(self, signal: torch.Tensor, factors: Sequence[float], is_adjoint: bool) -> torch.Tensor:
        """``Σ_j factors[j]·W_f(j)`` by one polynomial, n × channels, or its adjoint."""
        operator, factors = self.operator, tuple(factors)
        operator.check(signal)
        if factors not in self._combined:
            total = np.zeros(self.table.n_terms)
            for factor, own in zip(factors, self.series, strict=True):
                total[: len(own.coefficients)] += factor * own.coefficients
            self._combined[factors] = SeriesTable.on_device([total], operator.dtype, operator.device)
        table = self._combined[factors]
        if is_adjoint:
            return self._adjoint((signal / operator._share.to(signal.dtype))[None], table, factors[0])
        mean = operator.mean(signal)
        found = clenshaw_sum(operator._rows, table, operator.first_difference(mean).to(operator.dtype)[None])
        found = operator.spread(found)
        if operator._place is not None:
            found = found + factors[0] * (signal.double() - operator.spread(mean)).to(signal.dtype)
        return found

    def _adjoint(self, scaled: torch.Tensor, table: SeriesTable, first_factor: float = 1.0) -> torch.Tensor:
        """``Σ_j (q_j(Φ₁)(I − Φ₁))ᵀ g_j`` of values that are divided by the share π, ``scaled[j] = g_j/π``."""
        operator, difference = self.operator, self.operator._adjoint_difference
        assert difference is not None, "an operator with bands has differences"
        means = scaled
        if operator._place is not None:
            means = torch.stack([operator.mean(own) for own in scaled]).to(scaled.dtype)
        total = difference.product(clenshaw_sum(operator._adjoint, table, means).double())
        total = operator.spread(total)
        if operator._place is not None:
            total = total + first_factor * (scaled[0] - operator.spread(means[0]))
        return (operator._share * total).to(scaled.dtype)

    def error_bounds(self, signal: torch.Tensor, found: torch.Tensor) -> list[float]:
        """Bound of the relative error of each band that `split` found; see `Operator.error_bounds`."""
        operator = self.operator
        start = operator.spread(operator.first_difference(operator.mean(signal)))
        weights = operator._share / max(operator.n_vertices, 1)
        squares = [(weights * start.square()).sum(), *((weights * own.double().square()).sum() for own in found[:-1])]
        norms = torch.stack(squares).sqrt().tolist()
        bounds = []
        for own, norm in zip(self.series, norms[1:], strict=True):
            error = operator._growth * own.tail * norms[0]
            if operator.dtype == torch.float32 and operator._growth > 1:
                error = np.inf
            elif operator.dtype == torch.float32 and norms[0] > 0:
                error += operator._rounding.error(own.coefficients, norms[0])
            bounds.append(error / (norm - error) if norm > error else 0.0 if error == 0 else np.inf)
        return bounds


class DevicePowers:
    """Bands between powers of a walk: a request of `adwave._torch_functions`."""

    def __init__(self, operator: Operator, stops: tuple[int, ...]) -> None:
        self.operator, self.stops = operator, stops

    @property
    def n_pieces(self) -> int:
        """Number of bands and the rest."""
        return len(self.stops) + 1

    def split(self, signal: torch.Tensor) -> torch.Tensor:
        """``P^{n_{j−1}} f − P^{n_j} f``, n_0 = 0, and the rest, (J + 1) × n × channels."""
        operator = self.operator
        operator.check(signal)
        mean = operator.mean(signal).to(signal.dtype)
        taken = operator.spread(powers(operator._rows, mean, self.stops, operator._power).movedim(0, 1)).movedim(1, 0)
        found = torch.empty((self.n_pieces, *signal.shape), dtype=signal.dtype, device=signal.device)
        found[0] = signal
        found[1:] = taken
        found[:-1] -= taken
        return found

    def join(self, weights: torch.Tensor) -> torch.Tensor:
        """Adjoint of `split` by the adjoint of the walk: ``g_0 + Σ_j (P^{n_j})ᵀ(g_j − g_{j−1})``, nested."""
        operator = self.operator
        share = operator._share.to(weights.dtype)
        now = None
        for stop, before, own in zip(
            reversed(self.stops), reversed((0, *self.stops[:-1])), reversed(weights[1:] - weights[:-1]), strict=True
        ):
            # Σ_j Pᵀ^{n_j} d_j = Pᵀ^{n_1}(d_1 + Pᵀ^{n_2 − n_1}(d_2 + …)).
            given = operator.mean(own / share).to(own.dtype)
            now = given if now is None else now + given
            now = powers(operator._adjoint, now.contiguous(), (stop - before,), operator._power)[0]
        assert now is not None, "there is a number of steps"
        return weights[0] + share * operator.spread(now)


def _rows(matrix: Any) -> Any:
    """A matrix in compressed rows with sorted columns and without zeros."""
    from scipy.sparse import csr_array

    rows = csr_array(matrix, dtype=np.float64)
    rows.eliminate_zeros()
    rows.sort_indices()
    return rows


def _semigroup(own: Decomposer, step: Any, share: NDArray[np.float64]) -> Semigroup:
    """Meaning of n steps of a prepared shape."""
    if not own._data.is_reversible():
        return Semigroup("powers")
    if own.operator == "surface":
        return Semigroup("heat", _heat_rate(own, step, share))
    given = own._given_walk
    is_lazy = not isinstance(given, Walk) or abs(given.matrix() - step).max() == 0
    return Semigroup("steps" if is_lazy else "plain")


def _heat_rate(own: Decomposer, step: Any, share: NDArray[np.float64]) -> float:
    """Rate r of heat ``exp(−n·r·(I − Φ₁))``, from a short band of the library.

    With ``g = S(a)``, ``D = I − Φ₁`` and ``u = Dg``, the band of h more steps is ``W = −Σ_k (−z)^k/k!·D^{k−1}u`` with
    z = hr, and ``⟨W, u⟩/⟨u, u⟩`` is a power series of z. Since g is smoothed by a steps, its terms fall as fast as (h/a)^k.
    """
    signal = np.random.default_rng(_SEED).standard_normal((own.n_vertices, 1))
    found, _ = own._data.bands(BandsRequest(signal, [_START, _START + _SHORT], _FINEST, precision="double"))
    place, n = own.vertex_map(), step.shape[0]
    if n == own.n_vertices:
        place = np.arange(n)
    vertex = np.zeros(n, dtype=np.int64)
    vertex[place] = np.arange(own.n_vertices)
    weights = np.bincount(place, share, minlength=n)
    band, smooth = found[1, vertex, 0], (signal - found[0])[vertex, 0]
    first = smooth - step @ smooth
    power, products, factor = first, [], 1.0
    for k in range(1, _RATE_TERMS + 1):
        products.append(factor * float((weights * power * first).sum()))
        power, factor = power - step @ power, -factor / (k + 1)
    if not products[0] > 0:
        return 1.0
    total = float((weights * band * first).sum())
    z = 0.0
    for _ in range(_RATE_TERMS):
        z = total / float(np.polynomial.Polynomial(products)(z))
    return z / _SHORT


def positive_share(step: Any, welded: NDArray[np.integer[Any]], share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shares of vertices in the stationary distribution; 1 at isolated vertices, which take no step."""
    return np.where((share == 0) & (step.diagonal()[welded] == 1.0), 1.0, share)


def vertex_rows(signal: torch.Tensor, n: int) -> tuple[torch.Tensor, tuple[int, ...], int]:
    """A signal as n × channels with the axes that the channels stand for, and the axis of the vertices.

    The vertices are the first axis if it has their number, or else the last but one, or the last: a batch is
    (batch, n, channels) or (batch, n).
    """
    if not torch.is_tensor(signal):
        raise TypeError(f"signal must be a tensor, got {type(signal).__name__}; torch.as_tensor(f) of an array")
    axes = [axis for axis in (0, signal.ndim - 2, signal.ndim - 1) if axis >= 0 and signal.shape[axis] == n]
    if not axes:
        raise ValueError(
            f"signal: shape {tuple(signal.shape)} has no axis of {n} vertices; give ({n},), ({n}, channels), "
            f"(batch, {n}) or (batch, {n}, channels)"
        )
    rows = signal.movedim(axes[0], 0)
    return rows.reshape(n, -1), tuple(rows.shape[1:]), axes[0]
