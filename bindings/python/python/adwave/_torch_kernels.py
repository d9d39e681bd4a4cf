"""Sparse products of the recurrence on a device: by one Triton kernel a step, or by PyTorch.

Both compute ``alpha·A·now + beta·before + Σ_j c_j·term_j``, and add the last few vectors of a recurrence to its sums at
once, so that the sums are read and written once for every few steps.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

try:
    import triton
    import triton.language as tl
except ImportError:  # PyTorch for this machine comes without it
    triton = None

#: Vectors of a recurrence that are added to the sums together.
TOGETHER = 8
#: Longest row, relative to the mean, up to which a thread for each row is used: a kernel waits for the longest of a block.
_MOST_UNEVEN = 8.0
#: Rows of a block, for up to 4, 16 and more channels.
_ROWS = {4: 128, 16: 32, 32: 16}


@dataclass(frozen=True)
class SeriesTable:
    """Coefficients of several series on a device, and their numbers of terms."""

    #: series × terms, 0 beyond the end of a series.
    coefficients: torch.Tensor
    lengths: tuple[int, ...]

    @classmethod
    def on_device(cls, series: Sequence[NDArray[np.float64]], dtype: torch.dtype, device: torch.device) -> SeriesTable:
        """The table of some series."""
        lengths = tuple(len(own) for own in series)
        table = np.zeros((len(series), max(lengths)))
        for row, own in zip(table, series, strict=True):
            row[: len(own)] = own
        return cls(torch.from_numpy(table).to(device, dtype), lengths)

    def first(self, k: int) -> int:
        """Number of the first series with terms from k on; those before it have none."""
        return next(j for j, length in enumerate(self.lengths) if length > k)

    @property
    def n_terms(self) -> int:
        """Number of terms of the longest series."""
        return max(self.lengths)


class SparseRows:
    """A sparse matrix on a device, for products with n × channels vectors."""

    def __init__(self, matrix: Any, dtype: torch.dtype, device: torch.device) -> None:
        index = torch.int32 if matrix.nnz < 2**31 else torch.int64
        lengths = matrix.indptr[1:] - matrix.indptr[:-1]
        self.shape: tuple[int, int] = matrix.shape
        self.longest = int(lengths.max(initial=0))
        self.offsets, self.columns = (
            torch.from_numpy(part).to(device, index) for part in (matrix.indptr, matrix.indices)
        )
        self.values = torch.from_numpy(matrix.data).to(device, dtype)
        is_even = self.longest <= _MOST_UNEVEN * max(float(lengths.mean()) if lengths.size else 0.0, 1.0)
        self.is_fused = is_even and has_kernels(device)
        # Shares the three arrays.
        self._matrix = torch.sparse_csr_tensor(
            self.offsets, self.columns, self.values, size=self.shape, check_invariants=False
        )

    @property
    def bytes(self) -> int:
        """Bytes on the device."""
        return sum(part.nbytes for part in (self.offsets, self.columns, self.values))

    def product(self, now: torch.Tensor) -> torch.Tensor:
        """``A·now`` in the type of the matrix."""
        return self.step(now, out=now.new_empty((self.shape[0], now.shape[1]), dtype=self.values.dtype))

    def step(
        self,
        now: torch.Tensor,
        before: torch.Tensor | None = None,
        *,
        out: torch.Tensor,
        factors: tuple[float, float] = (1.0, 0.0),
    ) -> torch.Tensor:
        """``out = factors[0]·A·now + factors[1]·before``.

        Factors are powers of 2 or their negatives, so that products with them are exact. `out` overlaps no other tensor.
        """
        alpha, beta = factors
        if out.numel() == 0:
            return out
        if self.is_fused:
            _launch(self, now, before, out, factors)
        elif before is None:
            torch.addmm(out, self._matrix, now, beta=0.0, alpha=alpha, out=out)
        else:
            torch.addmm(before, self._matrix, now, beta=beta, alpha=alpha, out=out)
        return out

    def add_product(self, now: torch.Tensor, out: torch.Tensor, factor: float) -> None:
        """Adds ``factor·A·now`` to `out` by PyTorch."""
        if out.numel():
            out.addmm_(self._matrix, now, alpha=factor)


def chebyshev_sums(rows: SparseRows, start: torch.Tensor, table: SeriesTable, outs: torch.Tensor) -> None:
    """``outs[j] = Σ_k a_jk T_k start`` with ``T_{k+1} = A T_k − T_{k−1}`` and ``T_1 = ½A T_0``.

    `outs` is series × n × channels, contiguous, and `start` n × channels, both in the type of the rows.
    """
    together = min(TOGETHER, max(table.n_terms, 3))
    vectors = start.new_empty((together, *start.shape))
    each = vectors.unbind()
    for k in range(table.n_terms):
        at = k % together
        is_last = at == together - 1 or k == table.n_terms - 1
        sums = None
        if is_last:
            first = table.first(k - at)
            sums = Sums(vectors[: at + 1], table.coefficients[first:, k - at : k + 1], outs[first:], k == at)
        if k == 0:
            vectors[0] = start
            if sums is not None:
                sums.add()
            continue
        now, before = each[(k - 1) % together], each[(k - 2) % together] if k > 1 else None
        factors = (1.0, -1.0) if k > 1 else (0.5, 0.0)
        if rows.is_fused and start.numel():
            _launch(rows, now, before, each[at], factors, sums)
        else:
            rows.step(now, before, out=each[at], factors=factors)
            if sums is not None:
                sums.add()


def clenshaw_sum(rows: SparseRows, table: SeriesTable, values: torch.Tensor) -> torch.Tensor:
    """``Σ_j Σ_k a_jk T_k values[j]``, n × channels, by one recurrence from the last term to the first.

    `values` is series × n × channels, contiguous, in the type of the rows.
    """
    now = before = None
    # The last two vectors of a group lie in one buffer while the next group fills the other.
    buffers = values.new_empty((2, min(TOGETHER, table.n_terms), *values.shape[1:]))
    for number, end in enumerate(range(table.n_terms, 0, -TOGETHER)):
        start = max(end - TOGETHER, 0)
        first = table.first(start)
        coefficients, given = table.coefficients[first:, start:end], values[first:]
        found = buffers[number % 2, : end - start]
        if not rows.is_fused:
            torch.mm(coefficients.T, given.flatten(1), out=found.flatten(1))
        for k in range(end - 1, start - 1, -1):
            out, factor = found[k - start], 1.0 if k else 0.5
            if rows.is_fused and values.numel():
                terms = Terms(coefficients[:, k - start], given)
                _launch(rows, now, before, out, (factor, -1.0), terms)
            else:
                if before is not None:
                    out.sub_(before)
                if now is not None:
                    rows.add_product(now, out, factor)
            now, before = out, now
    assert now is not None, "a series has a term"
    return now


def powers(rows: SparseRows, start: torch.Tensor, stops: Sequence[int], factors: tuple[float, float]) -> torch.Tensor:
    """``P^n start`` for each of the ascending numbers n, stops × n × channels, with ``P = factors[0]·A + factors[1]·I``."""
    found = start.new_empty((len(stops), *start.shape))
    now, spare, taken = start, None, 0
    for out, stop in zip(found, stops, strict=True):
        for step in range(stop - taken):
            is_last = step == stop - taken - 1
            new = out if is_last else torch.empty_like(start) if spare is None else spare
            rows.step(now, now if factors[1] else None, out=new, factors=factors)
            # The start and results are kept; any other vector is used again.
            now, spare = new, now if step > 0 else None
        if stop == taken:
            out.copy_(now)
        taken = stop
    return found


@dataclass(frozen=True)
class Sums:
    """Sums ``outs[j] += Σ_i coefficients[j, i]·vectors[i]`` over the last vectors of a recurrence."""

    #: The vectors, m × n × channels, contiguous; a kernel computes the last one.
    vectors: torch.Tensor
    #: series × m.
    coefficients: torch.Tensor
    #: series × n × channels, contiguous.
    outs: torch.Tensor
    #: True if `outs` has no values yet.
    is_first: bool

    def add(self) -> None:
        """Adds all vectors by PyTorch."""
        vectors, outs = (part.view(len(part), -1) for part in (self.vectors, self.outs))
        torch.addmm(outs, self.coefficients, vectors, beta=0.0 if self.is_first else 1.0, out=outs)


@dataclass(frozen=True)
class Terms:
    """Terms ``Σ_j coefficients[j]·values[j]`` that a step of a kernel adds."""

    coefficients: torch.Tensor
    #: series × n × channels, contiguous.
    values: torch.Tensor


def has_kernels(device: torch.device) -> bool:
    """True if Triton's kernels run on a device: on a GPU, and on the CPU by its interpreter."""
    if triton is None:
        return False
    return device.type == "cuda" or os.environ.get("TRITON_INTERPRET") == "1"


if triton is not None:

    @triton.jit(do_not_specialize=["n_rows", "n_wide", "stride"])
    def _step_kernel(
        offsets,
        columns,
        values,
        now,
        before,
        out,
        others,
        coefficients,
        wide,
        n_rows,
        n_channels,
        alpha,
        beta,
        n_wide,
        stride,
        HAS_NOW: tl.constexpr,
        HAS_BEFORE: tl.constexpr,
        HAS_TERMS: tl.constexpr,
        N_VECTORS: tl.constexpr,
        IS_FIRST: tl.constexpr,
        ROWS: tl.constexpr,
        CHANNELS: tl.constexpr,
    ):
        rows = tl.program_id(0) * ROWS + tl.arange(0, ROWS)
        channels = tl.program_id(1) * CHANNELS + tl.arange(0, CHANNELS)
        is_row, is_channel = rows < n_rows, channels < n_channels
        first = tl.load(offsets + rows, mask=is_row, other=0)
        length = tl.load(offsets + rows + 1, mask=is_row, other=0) - first
        total = tl.zeros((ROWS, CHANNELS), dtype=out.dtype.element_ty)
        if HAS_NOW:
            for e in range(tl.max(length, axis=0)):
                is_entry = e < length
                column = tl.load(columns + first + e, mask=is_entry, other=0).to(tl.int64)
                weight = tl.load(values + first + e, mask=is_entry, other=0.0)
                here = now + column[:, None] * n_channels + channels[None, :]
                total += weight[:, None] * tl.load(here, mask=is_entry[:, None] & is_channel[None, :], other=0.0)
        place = rows.to(tl.int64)[:, None] * n_channels + channels[None, :]
        size = tl.cast(n_rows, tl.int64) * n_channels
        is_value = is_row[:, None] & is_channel[None, :]
        total = (alpha * total).to(out.dtype.element_ty)
        if HAS_BEFORE:
            total += (beta * tl.load(before + place, mask=is_value, other=0.0)).to(out.dtype.element_ty)
        if HAS_TERMS:
            for j in range(n_wide):
                total += tl.load(coefficients + j * stride) * tl.load(wide + j * size + place, mask=is_value, other=0.0)
        tl.store(out + place, total, mask=is_value)
        if N_VECTORS > 0:
            for j in range(n_wide):
                added = tl.load(coefficients + j * stride + N_VECTORS - 1) * total
                for i in tl.static_range(N_VECTORS - 1):
                    vector = tl.load(others + i * size + place, mask=is_value, other=0.0)
                    added += tl.load(coefficients + j * stride + i) * vector
                if not IS_FIRST:
                    added += tl.load(wide + j * size + place, mask=is_value, other=0.0)
                tl.store(wide + j * size + place, added, mask=is_value)


def _launch(
    rows: SparseRows,
    now: torch.Tensor | None,
    before: torch.Tensor | None,
    out: torch.Tensor,
    factors: tuple[float, float],
    then: Sums | Terms | None = None,
) -> None:
    """Runs the kernel of a step on contiguous tensors of the type of the matrix, all parts of which are apart."""
    n_channels = out.shape[1]
    width = 4 if n_channels <= 4 else 16 if n_channels <= 16 else 32
    height = _ROWS[width]
    others, wide, n_vectors = out, out, 0
    coefficients, stride = out, 0
    if isinstance(then, Sums):
        others, wide, n_vectors = then.vectors, then.outs, len(then.vectors)
        coefficients, stride = then.coefficients, then.coefficients.stride(0)
    elif then is not None:
        wide, coefficients, stride = then.values, then.coefficients, then.coefficients.stride(0)
    grid = (triton.cdiv(rows.shape[0], height), triton.cdiv(n_channels, width))
    is_current = not out.is_cuda or out.device.index == torch.cuda.current_device()
    with nullcontext() if is_current else torch.cuda.device(out.device):
        _step_kernel[grid](
            *(rows.offsets, rows.columns, rows.values),
            *(out if part is None else part for part in (now, before)),
            *(out, others, coefficients, wide, rows.shape[0], n_channels, *factors),
            *(0 if then is None else len(wide), stride),
            HAS_NOW=now is not None,
            HAS_BEFORE=before is not None,
            HAS_TERMS=isinstance(then, Terms),
            N_VECTORS=n_vectors,
            IS_FIRST=isinstance(then, Sums) and then.is_first,
            ROWS=height,
            CHANNELS=width,
        )
