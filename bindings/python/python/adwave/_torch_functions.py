"""Derivatives: linear functions of a signal with their adjoints, as functions of PyTorch.

A request is a prepared operator with everything but the signal: `split` gives pieces × n × channels values of n × channels
ones, and `join` is its adjoint.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol
from weakref import WeakValueDictionary

import torch


class Request(Protocol):
    """A linear function of n × channels signals with pieces × n × channels values."""

    #: Number of pieces.
    n_pieces: int

    def split(self, signal: torch.Tensor) -> torch.Tensor:
        """Pieces of a signal."""
        ...

    def join(self, weights: torch.Tensor) -> torch.Tensor:
        """Adjoint of `split`."""
        ...


class BandsRequest(Request, Protocol):
    """Bands, of which a weighted sum is a single polynomial."""

    def combine(self, signal: torch.Tensor, factors: Sequence[float], is_adjoint: bool) -> torch.Tensor:
        """``Σ_j factors[j]·W_f(j)``, n × channels, or its adjoint."""
        ...


class Split(torch.autograd.Function):
    """Pieces of an n × channels signal."""

    @staticmethod
    def forward(signal: Any, request: Request) -> Any:
        return request.split(signal.detach().contiguous())

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.request = inputs[1]

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return Join.apply(gradients[0], ctx.request), None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, _: Any) -> Any:
        return Split.apply(tangent, ctx.request)

    @staticmethod
    def vmap(info: Any, in_dims: Any, signal: Any, request: Request) -> Any:
        # A batch becomes channels: (b, n, c) → (n, c·b).
        last = signal.movedim(in_dims[0], -1)
        found = Split.apply(last.reshape(last.shape[0], -1), request)
        return found.reshape(found.shape[0], *last.shape), 3


class Join(torch.autograd.Function):
    """Adjoint of `Split`."""

    @staticmethod
    def forward(weights: Any, request: Request) -> Any:
        return request.join(weights.detach().contiguous())

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.request = inputs[1]

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return Split.apply(gradients[0], ctx.request), None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, _: Any) -> Any:
        return Join.apply(tangent, ctx.request)

    @staticmethod
    def vmap(info: Any, in_dims: Any, weights: Any, request: Request) -> Any:
        last = weights.movedim(in_dims[0], -1)
        found = Join.apply(last.reshape(*last.shape[:2], -1), request)
        return found.reshape(*last.shape[1:]), 2


class Combine(torch.autograd.Function):
    """``Σ_j factors[j]·W_f(j)`` of an n × channels signal by a single polynomial of Φ₁, and its adjoint."""

    @staticmethod
    def forward(signal: Any, request: BandsRequest, factors: tuple[float, ...], is_adjoint: bool) -> Any:
        return request.combine(signal.detach().contiguous(), factors, is_adjoint)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        _, ctx.request, ctx.factors, ctx.is_adjoint = inputs

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return Combine.apply(gradients[0], ctx.request, ctx.factors, not ctx.is_adjoint), None, None, None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, *_: Any) -> Any:
        return Combine.apply(tangent, ctx.request, ctx.factors, ctx.is_adjoint)

    @staticmethod
    def vmap(
        info: Any, in_dims: Any, signal: Any, request: BandsRequest, factors: tuple[float, ...], is_adjoint: bool
    ) -> Any:
        last = signal.movedim(in_dims[0], -1)
        found = Combine.apply(last.reshape(last.shape[0], -1), request, factors, is_adjoint)
        return found.reshape(last.shape), 2


#: Requests that compiled graphs name by their numbers.
_COMPILED: WeakValueDictionary[int, Request] = WeakValueDictionary()


@torch.library.custom_op("adwave::split", mutates_args=())
def compiled_split(signal: torch.Tensor, request: int) -> torch.Tensor:
    """`Split` in a compiled graph, by the number of the request."""
    return _COMPILED[request].split(signal.contiguous())


@compiled_split.register_fake
def _(signal: torch.Tensor, request: int) -> torch.Tensor:
    return signal.new_empty((_COMPILED[request].n_pieces, *signal.shape))


@torch.library.custom_op("adwave::join", mutates_args=())
def _join_compiled(weights: torch.Tensor, request: int) -> torch.Tensor:
    return _COMPILED[request].join(weights.contiguous())


@_join_compiled.register_fake
def _(weights: torch.Tensor, request: int) -> torch.Tensor:
    return weights.new_empty(weights.shape[1:])


def _keep_request(ctx: Any, inputs: Any, output: Any) -> None:
    ctx.request = inputs[1]


compiled_split.register_autograd(
    lambda ctx, gradient: (_join_compiled(gradient, ctx.request), None), setup_context=_keep_request
)
_join_compiled.register_autograd(
    lambda ctx, gradient: (compiled_split(gradient, ctx.request), None), setup_context=_keep_request
)


def compiled_number(request: Request) -> int:
    """Number of a request in compiled graphs, as long as the request exists."""
    _COMPILED[id(request)] = request
    return id(request)
