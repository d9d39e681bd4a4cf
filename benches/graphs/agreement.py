"""Agreement with other programs: MAGIC, the fixed scales of LEGS, GeoScatConv of PyTorch Geometric, scipy.

    python benches/graphs/agreement.py

Needs the package adwave. A program that is not installed is skipped, with a line that says so.
"""

from __future__ import annotations

import importlib
import time

import numpy as np
from scipy import sparse

import adwave as aw


def row(work: str, peer: str, difference: float, seconds: tuple[float, float]) -> None:
    """A row of the table: largest difference, seconds of the other program and ours."""
    print(f"| {work} | {peer} | {difference:.1e} | {seconds[0]:.2f} s | {seconds[1]:.2f} s |")


def timed(work):
    """The result of a call and its seconds."""
    start = time.perf_counter()
    found = work()
    return found, time.perf_counter() - start


def optional(name: str):
    """A module, or None with a line that says that it is missing."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        print(f"<!-- skipped: {name} is not installed ({error}) -->")
        return None


def cells(n: int, genes: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of cells on a curved sheet, and their counts."""
    random = np.random.default_rng(seed)
    place = random.random((n, 2)) * 3
    coordinates = np.column_stack([np.sin(place @ random.normal(size=(2, 20)) + random.random(20)), place])
    rates = np.exp(np.sin(place @ random.normal(size=(2, genes)) + 6 * random.random(genes)))
    return coordinates, random.poisson(rates).astype(float)


def magic(n: int, genes: int) -> None:
    """Imputation for three steps by MAGIC, on its own graph."""
    module = optional("magic")
    if module is None:
        return
    coordinates, counts = cells(n, genes)
    del coordinates
    # solver="exact" diffuses the genes themselves, not their principal components.
    operator = module.MAGIC(knn=5, t=3, n_pca=50, solver="exact", n_jobs=1, random_state=0, verbose=0)
    operator.fit(counts)
    theirs, seconds = timed(lambda: np.asarray(operator.transform(counts)))
    walk = aw.walk(sparse.csr_array(operator.graph.diff_op))
    ours, own = timed(lambda: aw.impute(counts, walk, steps=3).values)
    row(f"imputation, {n} × {genes}, t = 3", "MAGIC", abs(ours - theirs).max(), (seconds, own))


def scipy_powers(n: int, channels: int, steps: int) -> None:
    """Powers of a walk by scipy's sparse products."""
    coordinates, counts = cells(n, channels)
    walk = aw.point_walk(coordinates, neighbors=15)
    matrix = walk.matrix().tocsr()

    def theirs() -> np.ndarray:
        values = counts
        for _ in range(steps):
            values = matrix @ values
        return values

    (expected, seconds), (found, own) = timed(theirs), timed(lambda: walk.smooth(counts, steps))
    row(f"P^{steps} f, {n} × {channels}", "scipy", abs(found - expected).max(), (seconds, own))


def legs(n: int) -> None:
    """The fixed wavelets of LEGS, P − P², P² − P⁴, … of the column-normalized lazy walk, in single precision."""
    torch = optional("torch")
    if torch is None:
        return
    random = np.random.default_rng(1)
    weights = sparse.random_array((n, n), density=6 / n, rng=random)
    weights = ((weights + weights.T) > 0).astype(float).tolil()
    weights.setdiag(0)
    weights = sparse.csr_array(weights)
    weights.eliminate_zeros()
    signal = random.normal(size=(n, 3))
    degree = np.maximum(np.asarray(weights.sum(axis=0)).ravel(), 1e-12)
    walk = torch.tensor((0.5 * (sparse.eye_array(n) + weights @ sparse.diags_array(1 / degree))).todense()).float()
    powers = [torch.tensor(signal).float()]
    for _ in range(16):
        powers.append(walk @ powers[-1])
    wavelets = [powers[a] - powers[2 * a] for a in (1, 2, 4, 8)]
    lazy = aw.walk(weights, normalize="column", self_loops=0.0, stay=0.5)
    found, own = timed(lambda: aw.scattering(lazy, signal, orders=(1,)).values)
    connected = degree > 0.5
    off = max(abs(found[j + 1] - wavelets[j].abs().numpy())[connected].max() for j in range(4))
    row(f"first order, {n} nodes", "LEGS' fixed scales (float32)", off, (0.0, own))


def geo_scat_conv(n: int) -> None:
    """The layer of PyTorch Geometric, if this version has it."""
    module = optional("torch_geometric.nn")
    if module is None:
        return
    if not hasattr(module, "GeoScatConv"):
        print("<!-- skipped: this torch_geometric has no GeoScatConv; its definition by scipy instead -->")
    random = np.random.default_rng(2)
    weights = sparse.random_array((n, n), density=8 / n, rng=random)
    weights = sparse.csr_array(weights + weights.T)
    weights.setdiag(0)
    weights.eliminate_zeros()
    degree = np.asarray(weights.sum(axis=1)).ravel()
    lazy = 0.5 * (sparse.eye_array(n) + sparse.diags_array(1 / np.where(degree > 0, degree, 1)) @ weights)
    lazy = lazy + 0.5 * sparse.diags_array((degree == 0).astype(float))
    signal = random.normal(size=(n, 4))

    def bands(values: np.ndarray) -> list[np.ndarray]:
        found, now, done = [], values, 0
        for scale in (1, 2, 4, 8, 16):
            before = now
            for _ in range(done, scale):
                now = lazy @ now
            done = scale
            found.append(abs(before - now))
        return found

    def definition() -> np.ndarray:
        first = bands(signal)
        second = [bands(first[j])[k] for j in range(5) for k in range(j + 1, 5)]
        return np.stack([signal, *first, *second])

    expected, seconds = timed(definition)
    walk = aw.walk(weights, normalize="row", stay=0.5)
    found, own = timed(lambda: aw.scattering(walk, signal).values)
    row(f"orders 0 to 2, {n} nodes × 4", "definition by scipy", abs(found - expected).max(), (seconds, own))


def main() -> None:
    print("| work | other program | largest difference | theirs | ours |")
    print("|---|---|---|---|---|")
    magic(1_500, 400)
    magic(5_000, 8_000)
    scipy_powers(20_000, 200, 8)
    legs(800)
    geo_scat_conv(20_000)


if __name__ == "__main__":
    main()
