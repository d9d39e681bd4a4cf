"""Kernels of a GPU: by the interpreter beside PyTorch's products, and compiled without a GPU."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from scipy import sparse

torch = pytest.importorskip("torch", reason="PyTorch is not installed")
triton = pytest.importorskip("triton", reason="Triton is not installed")

from adwave import _torch_kernels as kernels  # noqa: E402

#: Rounding of a few products of numbers of size 1.
ROUNDING = {torch.float64: 1e-13, torch.float32: 2e-5}
IS_INTERPRETED = os.environ.get("TRITON_INTERPRET") == "1"


def rows(n: int, dtype: torch.dtype, fused: bool) -> kernels.SparseRows:
    matrix = sparse.random_array((n, n), density=0.2, rng=np.random.default_rng(1), format="csr")
    found = kernels.SparseRows(matrix, dtype, torch.device("cpu"))
    assert found.is_fused == IS_INTERPRETED
    found.is_fused = fused
    return found


@pytest.mark.skipif(not IS_INTERPRETED, reason="the interpreter is asked for by TRITON_INTERPRET=1")
@pytest.mark.parametrize("dtype", [torch.float64, torch.float32])
@pytest.mark.parametrize("n_channels", [1, 3, 4, 7, 33])
def test_kernels_are_the_products_of_pytorch(dtype: torch.dtype, n_channels: int) -> None:
    generator = torch.Generator().manual_seed(n_channels)
    start = torch.rand(37, n_channels, dtype=dtype, generator=generator)
    values = torch.rand(3, 37, n_channels, dtype=dtype, generator=generator)
    # Series that end within, at and after the vectors that are added together.
    series = [1.0 / np.arange(1, n + 1) ** 2 for n in (2, kernels.TOGETHER, 2 * kernels.TOGETHER + 3)]
    table = kernels.SeriesTable.on_device(series, dtype, torch.device("cpu"))
    found = []
    for fused in (True, False):
        # Sums of a row of size 1 keep the recurrence small.
        own = rows(37, dtype, fused)
        own.values.div_(8)
        outs = torch.full((3, *start.shape), torch.nan, dtype=dtype)
        kernels.chebyshev_sums(own, start, table, outs)
        found.append(
            [outs, kernels.clenshaw_sum(own, table, values), kernels.powers(own, start, (1, 3, 4), (0.5, 0.25))]
        )
    for fused, plain in zip(*found, strict=True):
        torch.testing.assert_close(fused, plain, atol=ROUNDING[dtype], rtol=ROUNDING[dtype])


@pytest.mark.skipif(IS_INTERPRETED, reason="runs the other one")
def test_the_operators_of_a_gpu_pass_by_the_interpreter() -> None:
    folder = os.path.dirname(__file__)
    names = [os.path.join(folder, name) for name in ("test_torch_kernels.py", "test_torch_operator.py")]
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *names]
    done = subprocess.run(words, env={**os.environ, "TRITON_INTERPRET": "1"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-1000:]


@pytest.mark.skipif(IS_INTERPRETED, reason="the interpreter replaces the compiler")
@pytest.mark.parametrize("dtype", ["fp32", "fp64"])
@pytest.mark.parametrize(("n_vectors", "has_terms"), [(0, False), (kernels.TOGETHER, False), (0, True)])
def test_kernels_compile_for_a_gpu_without_one(dtype: str, n_vectors: int, has_terms: bool) -> None:
    from triton.backends.compiler import GPUTarget

    names = kernels._step_kernel.arg_names
    pointers = ("values", "now", "before", "out", "others", "coefficients", "wide")
    constants = {
        **{"HAS_NOW": True, "HAS_BEFORE": True, "HAS_TERMS": has_terms, "N_VECTORS": n_vectors},
        **{"IS_FIRST": False, "ROWS": 32, "CHANNELS": 16},
    }
    signature = {
        **dict.fromkeys(("offsets", "columns"), "*i32"),
        **dict.fromkeys(pointers, f"*{dtype}"),
        **dict.fromkeys(("n_rows", "n_channels", "n_wide", "stride"), "i32"),
        **dict.fromkeys(("alpha", "beta"), "fp32"),
        **dict.fromkeys(constants, "constexpr"),
    }
    source = triton.compiler.ASTSource(
        fn=kernels._step_kernel,
        signature={name: signature[name] for name in names},
        constexprs={(names.index(name),): value for name, value in constants.items()},
    )
    compiled = triton.compile(source, target=GPUTarget("cuda", 90, 32))
    # Products are not in a shorter format, and nothing of a thread spills to memory.
    text = compiled.asm["ptx"]
    assert f"fma.rn.f{dtype[2:]}" in text and "ld.local" not in text and ".tf32" not in text
