"""Bands, gradients and scattering on a device beside the library on the CPU.

    python benches/torch/measure.py [--device cuda] [--vertices 1000000] [--channels 3 64]

Prints for each type of number the seconds of the library, of a call that prepares (`device=`), and of a prepared
`aw.torch.Operator`, forward and backward; the least of some calls each. `share` is the part of the bandwidth of a copy that
the plain recurrence would need in that time, which reads and writes every band in each step. `differs` is the largest
difference of a band to the library, relative to the band.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from typing import Any

import adwave as aw
import numpy as np
import torch


def seconds(function: Callable[[], Any], device: torch.device, repeat: int) -> float:
    """Least of some times, without the first call."""
    best = np.inf
    for _ in range(repeat + 1):
        begin = time.perf_counter()
        function()
        if device.type == "cuda":
            torch.cuda.synchronize(device)
        # The first call compiles.
        best = min(best, time.perf_counter() - begin) if _ else best
    return best


def bandwidth(device: torch.device) -> float:
    """Bytes that a copy reads and writes in a second."""
    values = torch.empty(1 << (28 if device.type == "cuda" else 26), dtype=torch.float32, device=device)
    other = torch.empty_like(values)
    return 2 * values.nbytes / seconds(lambda: other.copy_(values), device, 5)


def needed_bytes(operator: aw.torch.Operator, request: Any, n_channels: int) -> int:
    """Bytes of a recurrence that adds each term to each band."""
    width = operator.dtype.itemsize
    rows, size = operator._rows, operator.n_vertices * n_channels * width
    step = len(rows.values) * (width + rows.columns.dtype.itemsize) + 3 * size
    return request.table.n_terms * step + 2 * sum(request.table.lengths) * size


def measure(walk: aw.Decomposer, n_channels: int, levels: int, options: argparse.Namespace) -> None:
    """One row of the table for each type."""
    device, repeat = torch.device(options.device), options.repeat
    f = np.random.default_rng(0).standard_normal((walk.n_vertices, n_channels))
    steps = walk.schedule(levels)
    for dtype, accuracy in ((torch.float64, 1e-10), (torch.float32, 1e-3)):
        x = torch.from_numpy(f).to(dtype)
        library = seconds(lambda: aw.torch.bands(walk, x, levels, accuracy=accuracy), torch.device("cpu"), 1)
        exact = aw.torch.bands(walk, x.double(), levels)
        x = x.to(device).requires_grad_()
        whole = seconds(lambda: aw.torch.bands(walk, x, levels, accuracy=accuracy, device=device), device, 1)
        begin = time.perf_counter()
        operator = aw.torch.Operator(walk, device=device, dtype=dtype)
        request = operator.request(steps)
        prepare = time.perf_counter() - begin
        with torch.no_grad():
            forward = seconds(lambda: aw.torch.bands(operator, x, levels), device, repeat)
        found = aw.torch.bands(operator, x, levels)
        weights = torch.rand_like(found)
        backward = seconds(lambda: torch.autograd.grad(found, x, weights, retain_graph=True), device, repeat)
        share = needed_bytes(operator, request, n_channels) / forward / options.bandwidth
        difference = (found.detach().double().cpu() - exact)[:-1].flatten(1).norm(dim=1) / exact[:-1].flatten(1).norm(
            dim=1
        )
        print(
            f"| {walk.n_vertices} × {n_channels}, {levels} bands | {str(dtype)[6:]} | {library:.3g} | {whole:.3g} | "
            f"{prepare:.3g} | {forward:.3g} | {backward:.3g} | {share:.2f} | {difference.max():.1e} |",
            flush=True,
        )


def measure_scattering(walk: aw.Decomposer, options: argparse.Namespace) -> None:
    """Scattering with J = 6 and orders 0 to 2 of one channel, forward and backward."""
    device = torch.device(options.device)
    operator = aw.torch.Operator(walk, device=device, dtype=torch.float32)
    layer = aw.torch.Scattering([1, 2, 4, 8, 16, 32]).to(device)
    x = torch.rand(walk.n_vertices, 1, device=device, requires_grad=True)
    with torch.no_grad():
        forward = seconds(lambda: layer(x, operator), device, options.repeat)
    found = layer(x, operator)
    weights = torch.rand_like(found)
    backward = seconds(lambda: torch.autograd.grad(found, x, weights, retain_graph=True), device, options.repeat)
    print(f"scattering of {walk.n_vertices} nodes, J = 6: {forward:.3g} s, backward {backward:.3g} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--vertices", type=int, default=1_000_000)
    parser.add_argument("--channels", type=int, nargs="+", default=[3, 64])
    parser.add_argument("--levels", type=int, default=8)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    device = torch.device(options.device)
    name = torch.cuda.get_device_name(device) if device.type == "cuda" else f"{os.cpu_count()} processors"
    options.bandwidth = bandwidth(device)
    print(f"{name}, PyTorch {torch.__version__}, a copy moves {options.bandwidth / 1e9:.0f} GB/s")
    walk = aw.Decomposer(aw.sample("creature", vertices=options.vertices), operator="walk")
    print("| bands | type | library | prepares | preparation | forward | backward | share | differs |")
    print("|---|---|---|---|---|---|---|---|---|")
    for n_channels in options.channels:
        measure(walk, n_channels, options.levels, options)
    measure_scattering(walk, options)


if __name__ == "__main__":
    main()
