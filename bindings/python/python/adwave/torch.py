"""Diffusion and bands as differentiable functions of PyTorch.

All functions are linear in the signal, and so are their gradients: they can be differentiated any number of times, under
`torch.func` too, and `torch.vmap` and batches become further channels of one call. Of a shape they are computed by the
library, on the CPU in double precision; of an `Operator` on its device and in its type.

>>> import torch
>>> import adwave as aw
>>> walk = aw.Decomposer(aw.sample("sphere", vertices=100))
>>> f = torch.rand(100, 2, dtype=torch.float64, requires_grad=True)
>>> torch.autograd.gradcheck(lambda f: aw.torch.smooth(walk, f, 3.0, accuracy=1e-12), f)
True
"""

from __future__ import annotations

from collections.abc import Sequence

import torch

from adwave import _native
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._options import LevelsLike
from adwave._torch_device import Operator, vertex_rows
from adwave._torch_layer import Scattering, scatter_bands
from adwave._torch_library import schedule, split_bands, weighted_bands

__all__ = ["Operator", "Scattering", "bands", "combine_bands", "filter", "impute", "scatter_bands", "smooth"]


def combine_bands(
    walk: object,
    signal: torch.Tensor,
    factors: Sequence[float] | torch.Tensor,
    steps: Sequence[float],
    *,
    accuracy: float | None = None,
) -> torch.Tensor:
    """``Σ_j factors[j−1]·W_f(j)`` with its exact gradient; see `adwave.Decomposer.combine_bands`.

    Parameters
    ----------
    walk : Operator, Decomposer, Walk or shape_like
        Shape or walk with a reversible diffusion. An `Operator` computes on its device; a `Decomposer` is prepared once,
        anything else in each call.
    signal : tensor
        Signal, (n,), (n, channels), or a batch, (batch, n) or (batch, n, channels): of the type and on the device of an
        operator, or else on any device, and the work is done on the CPU in double precision.
    factors : (J,) sequence of float, or tensor
        Factor of each band, from fine to coarse. A tensor has a gradient too, and costs the separate bands.
    steps : (J,) sequence of float
        Number of steps of each level.
    accuracy : float, optional
        Largest error relative to the bands, of a shape; 1e-10 by default. Those of an operator are
        `Operator.error_bounds`.

    Returns
    -------
    tensor like the signal

    Raises
    ------
    ValueError
        If the diffusion is not reversible (directed clouds, masks), or an accuracy is given for an operator.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> sphere = aw.sample("sphere", vertices=100)
    >>> aw.torch.combine_bands(sphere, torch.rand(100, 2), [2.0, 1.0], [1.0, 2.0]).shape
    torch.Size([100, 2])
    """
    own = _prepare(walk, None)
    _refuse_accuracy(own, accuracy)
    rows, channels, axis = vertex_rows(signal, own.n_vertices)
    found = weighted_bands(own, rows, factors, steps, accuracy)
    return found.reshape(rows.shape[0], *channels).movedim(0, axis)


def smooth(walk: object, signal: torch.Tensor, steps: float, *, accuracy: float | None = None) -> torch.Tensor:
    """``Φ₁^steps f`` with its exact gradient.

    Parameters
    ----------
    walk : Operator, Decomposer, Walk or shape_like
        As in `combine_bands`.
    signal : tensor
        Signal or batch as in `combine_bands`.
    steps : float
        Number of steps, an integer or not.
    accuracy : float, optional
        Largest error relative to the change, of a shape; 1e-10 by default.

    Returns
    -------
    tensor like the signal

    Raises
    ------
    TypeError
        If `steps` is a tensor.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> aw.torch.smooth(aw.sample("sphere", vertices=100), torch.ones(100), 3.0).sum()
    tensor(100.)
    """
    return signal + combine_bands(walk, signal, [-1.0], [steps], accuracy=accuracy)


def bands(
    walk: object,
    signal: torch.Tensor,
    levels: LevelsLike,
    *,
    accuracy: float | None = None,
    device: torch.device | str | None = None,
) -> torch.Tensor:
    """The bands of a signal, (levels + 1) × n × …, with their exact gradient.

    It takes the time of `adwave.decompose`, and so does its gradient. For many signals on a GPU prepare an `Operator`;
    `device` prepares one in each call.

    Parameters
    ----------
    walk : Operator, Decomposer, Walk or shape_like
        As in `combine_bands`.
    signal : tensor
        Signal or batch as in `combine_bands`.
    levels : int, Widths, Steps or Octaves
        As in `adwave.decompose`.
    accuracy : float, optional
        Largest error of a band relative to the band; 1e-10 by default. On a device the bounds of `Operator.error_bounds`
        must not exceed it, which waits for the device; an operator without an accuracy is not checked.
    device : torch.device or str, optional
        Device that computes, such as ``"cuda"``, in the type of the signal.

    Returns
    -------
    (levels + 1) × shape of the signal tensor

    Raises
    ------
    ValueError
        If the bound of the error on a device exceeds the accuracy.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> aw.torch.bands(aw.sample("sphere", vertices=100), torch.rand(100, 2), 4).shape
    torch.Size([5, 100, 2])
    """
    own = _prepare(walk, levels)
    if device is not None and not isinstance(own, Operator):
        if not signal.is_floating_point():
            raise TypeError(f"signal must be a tensor of floats, got {signal.dtype}; such as signal.float()")
        own, signal = Operator(own, device, signal.dtype), signal.to(device)
        accuracy = _native.ACCURACY if accuracy is None else accuracy
    rows, channels, axis = vertex_rows(signal, own.n_vertices)
    steps = schedule(own, levels)
    found = split_bands(own, rows, steps, accuracy)
    if isinstance(own, Operator) and accuracy is not None:
        worst = max(own.request(steps).error_bounds(rows.detach(), found.detach()))
        if not worst <= accuracy:
            raise ValueError(
                f"the error of a band on {own.device} may be {worst:.1e}, and accuracy={accuracy:g} was asked for; "
                f"compute in 64-bit floats, or give accuracy={2 * worst:.0e}"
            )
    return found.reshape(*found.shape[:2], *channels).movedim(1, axis + 1)


def filter(
    walk: object,
    signal: torch.Tensor,
    gains: torch.Tensor | Sequence[float],
    levels: LevelsLike = None,
    *,
    accuracy: float | None = None,
) -> torch.Tensor:
    """``f + Σ_j (g_j − 1)·W_f(j)`` with gradients of the signal and of the gains, which may be learned.

    Parameters
    ----------
    walk : Operator, Decomposer, Walk or shape_like
        As in `combine_bands`.
    signal : tensor
        Signal or batch as in `combine_bands`.
    gains : (J,) sequence of float, or (J,) or (J, n) tensor
        A gain for each band from fine to coarse, or for each band and vertex. Plain numbers cost a single polynomial.
    levels : int, Widths, Steps or Octaves, optional
        As in `adwave.decompose`; by default one dyadic level for each gain.
    accuracy : float, optional
        Largest error of a band relative to the band, of a shape; 1e-10 by default.

    Returns
    -------
    tensor like the signal

    Raises
    ------
    ValueError
        If there is not one gain for each level.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> gains = torch.ones(4, requires_grad=True)
    >>> aw.torch.filter(aw.sample("sphere", vertices=100), torch.rand(100, 2), gains).square().sum().backward()
    >>> gains.grad.shape
    torch.Size([4])
    """
    own = _prepare(walk, levels)
    _refuse_accuracy(own, accuracy)
    steps = schedule(own, len(gains) if levels is None else levels)
    if not torch.is_tensor(gains) and not all(isinstance(gain, (int, float)) for gain in gains):
        gains = torch.as_tensor(gains)
    shape = tuple(gains.shape) if torch.is_tensor(gains) else (len(gains),)
    if shape not in ((len(steps),), (len(steps), own.n_vertices)):
        raise ValueError(
            f"gains must be one for each of {len(steps)} levels, or for each level and vertex, got shape {shape}"
        )
    rows, channels, axis = vertex_rows(signal, own.n_vertices)
    if len(shape) == 1:
        factors = gains - 1.0 if torch.is_tensor(gains) else [gain - 1.0 for gain in gains]
        change = weighted_bands(own, rows, factors, steps, accuracy)
    else:
        wavelets = split_bands(own, rows, steps, accuracy)[:-1]
        change = torch.einsum("jn,jnc->nc", torch.as_tensor(gains).to(rows) - 1.0, wavelets)
    return (rows + change).reshape(own.n_vertices, *channels).movedim(0, axis)


def impute(
    walk: object,
    counts: torch.Tensor,
    t: int,
    *,
    library_size: float | None = None,
    square_root: bool = False,
) -> torch.Tensor:
    """Counts averaged over similar cells, ``Pᵗ X``, with its gradient; see `adwave.impute`, which chooses the time.

    Parameters
    ----------
    walk : Operator, Walk or shape_like
        Walk on the cells; an `Operator` computes on its device.
    counts : (cells, genes) tensor
        Counts.
    t : int
        Number of steps, such as ``adwave.impute(…).steps``.
    library_size : float, optional
        Sum to which the counts of each cell are scaled before.
    square_root : bool
        Takes square roots before; the result stays in square roots.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> aw.torch.impute(aw.walk([[0.5, 0.5], [0.5, 0.5]]), torch.tensor([[2.0], [4.0]]), 1)
    tensor([[3.],
            [3.]])
    """
    if t != int(t) or t < 0:
        raise ValueError(f"t must be a whole number of steps from 0, got {t}")
    if library_size is not None:
        totals = counts.sum(1, keepdim=True)
        counts = counts * torch.where(totals > 0, library_size / totals.where(totals > 0, 1.0), 0.0)
    values = counts.sqrt() if square_root else counts
    return scatter_bands(walk, values, [int(t)])[-1] if t > 0 else values


def _prepare(walk: object, levels: LevelsLike) -> Decomposer | Operator:
    return walk if isinstance(walk, Operator) else prepare_decomposer(walk, levels=levels)


def _refuse_accuracy(own: Decomposer | Operator, accuracy: float | None) -> None:
    if isinstance(own, Operator) and accuracy is not None:
        raise ValueError("accuracy: an operator computes in its type; leave it out, and see Operator.error_bounds")
