"""Imputation of counts whose rates are known, beside MAGIC, on simulations of four laws.

    python benches/graphs/imputation.py [--seeds 1,3,5] [--without-magic]
    python benches/graphs/imputation.py --cells 20000 [--depth 1500] [--without-magic]

Needs the package adwave and, for MAGIC, `benches/graphs/requirements.txt`. Cells of branches, of clusters, or of
clusters on a sheet lose counts by their mean (logistic), by capture of molecules, by zeros at random, or by a mix of these with
overdispersion. Everything gets the same counts, scaled to equal sums of the cells. With the rates scaled to the mean of
each gene, three measures are taken: squared error relative to the squares of the rates; median over the genes of the
squared error relative to the variance of the rates; median over the genes of the correlation with the rates. MAGIC runs
with 5 (its default) and 15 neighbors, on the scaled counts and on their square roots as its graph.

With `--cells`, time and memory on so many cells × 2000 genes instead: dense up to 20 000 cells, else sparse without
MAGIC, which makes them dense.
"""

from __future__ import annotations

import argparse
import importlib
import resource
import time
import warnings
from collections.abc import Callable
from typing import Any

import adwave as aw
import numpy as np
from scipy import sparse

#: Laws by their numbers.
LAWS = ("branches, dropout by mean", "clusters, capture", "branches, zeros at random", "sheet and clusters, mix")
#: Seeds by which the method was developed; the even ones were looked at once.
ODD, EVEN = range(1, 20, 2), range(2, 21, 2)


def law_of(seed: int) -> int:
    """Number of the law of a seed."""
    return (seed - 1) // 2 % 4


def branches(random: np.random.Generator, n: int) -> np.ndarray:
    """Places of cells on three to five branches."""
    k = random.integers(3, 6)
    branch, along = random.integers(0, k, n), random.random(n)
    ends = random.normal(size=(k, 8))
    return along[:, None] * ends[branch] * 1.3 + 0.05 * random.normal(size=(n, 8))


def clusters(random: np.random.Generator, n: int) -> np.ndarray:
    """Places of cells in five to eleven clusters that vary in three directions."""
    k = random.integers(5, 12)
    kind = random.choice(k, n, p=random.dirichlet(np.full(k, 3.0)))
    centers = random.normal(size=(k, 8))
    inside = random.normal(size=(k, 3, 8)) * 0.15
    return centers[kind] + np.einsum("nd,nde->ne", random.normal(size=(n, 3)), inside[kind])


def sheet_and_clusters(random: np.random.Generator, n: int) -> np.ndarray:
    """Places of cells, a third of them on a curved sheet."""
    place = random.random((n // 3, 2)) * 2 - 1
    sheet = np.sin(place @ random.normal(size=(2, 8)) * 1.5)
    return random.permutation(np.concatenate([sheet, clusters(random, n - n // 3)]))


def simulate(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Shares of the genes in each cell, and counts, cells × genes."""
    random = np.random.default_rng([59, seed])
    law = law_of(seed)
    n, genes = int(random.integers(1000, 3001)), int(random.integers(400, 2001))
    place = (branches, clusters, branches, sheet_and_clusters)[law](random, n)
    amplitude = random.gamma(2.0, 0.4, genes)
    rate = np.exp(amplitude * np.tanh(place @ random.normal(size=(8, genes)) * 0.7) + 1.2 * random.normal(size=genes))
    share = rate / rate.sum(axis=1, keepdims=True)
    depth = genes * np.exp(random.uniform(np.log(0.5), np.log(5.0)))
    counts = (by_mean, by_capture, by_chance, by_a_mix)[law](random, share, depth)
    cells, counted = counts.sum(axis=1) > 0, (counts > 0).sum(axis=0) >= 5
    return share[cells][:, counted], counts[cells][:, counted].astype(float)


def by_mean(random: np.random.Generator, share: np.ndarray, depth: float) -> np.ndarray:
    """Counts that are lost with a probability by their mean."""
    mean = depth * share
    counts = random.poisson(mean)
    kept = 1 / (1 + np.exp(-1.2 * (np.log(mean + 1e-12) - np.log(random.uniform(0.5, 1.5)))))
    return counts * (random.random(mean.shape) < kept)


def by_capture(random: np.random.Generator, share: np.ndarray, depth: float) -> np.ndarray:
    """One in ten molecules of cells with different library sizes."""
    library = depth * random.lognormal(0, 0.5, len(share))
    return random.binomial(random.poisson(library[:, None] * share * 10), 0.1)


def by_chance(random: np.random.Generator, share: np.ndarray, depth: float) -> np.ndarray:
    """Counts of which a share is lost."""
    library = random.lognormal(0, 0.2, len(share))[:, None]
    return random.poisson(depth * share * library) * (random.random(share.shape) > random.uniform(0.2, 0.5))


def by_a_mix(random: np.random.Generator, share: np.ndarray, depth: float) -> np.ndarray:
    """Overdispersed counts that are lost by their mean and by chance."""
    library = depth * random.lognormal(0, 0.35, len(share))
    mean = library[:, None] * share
    counts = random.poisson(mean * random.gamma(5, 1 / 5, mean.shape))
    kept = 1 / (1 + np.exp(-(np.log(mean + 1e-12) + 1.0)))
    return counts * (random.random(mean.shape) < kept) * (random.random(mean.shape) > 0.1)


def scaled(counts: np.ndarray) -> np.ndarray:
    """Counts of cells scaled to the median of their sums."""
    totals = counts.sum(axis=1, keepdims=True)
    return counts * (np.median(totals) / totals)


def measures(values: np.ndarray, share: np.ndarray, given: np.ndarray) -> np.ndarray:
    """Error in all, median error and median correlation of the genes."""
    truth = share * (given.mean(axis=0) / share.mean(axis=0))
    errors = ((values - truth) ** 2).sum(axis=0)
    centered, exact = values - values.mean(axis=0), truth - truth.mean(axis=0)
    variance = (exact**2).sum(axis=0)
    norm = np.sqrt((centered**2).sum(axis=0) * variance)
    correlation = np.divide((centered * exact).sum(axis=0), norm, out=np.zeros(len(norm)), where=norm > 0)
    return np.array([errors.sum() / (truth**2).sum(), np.median(errors / variance), np.median(correlation)])


def magic(counts: np.ndarray, neighbors: int, is_rooted: bool) -> np.ndarray:
    """MAGIC's imputation of scaled counts."""
    module = importlib.import_module("magic")
    operator = module.MAGIC(knn=neighbors, n_jobs=1, random_state=0, verbose=0)
    operator.fit(np.sqrt(counts) if is_rooted else counts)
    return np.asarray(operator.transform(counts))


def methods(with_magic: bool) -> dict:
    """What is compared: functions of counts and scaled counts."""
    found = {
        "ours before": lambda counts, _: aw.impute(counts, steps="molecules", library_size="median").values,
        "ours now": lambda counts, _: aw.impute(counts, library_size="median").values,
    }
    if with_magic:
        for neighbors in (5, 15):
            for rooted, text in ((False, ""), (True, ", graph of roots")):
                name = f"MAGIC, knn = {neighbors}{text}"
                found[name] = lambda _, values, k=neighbors, is_rooted=rooted: magic(values, k, is_rooted)
    return found


def large(n: int, depth: float, genes: int = 2000) -> Any:
    """Sparse counts of clusters of cells, drawn in parts."""
    random = np.random.default_rng(1)
    place = clusters(random, n)
    amplitude, program = random.gamma(2.0, 0.4, genes), random.normal(size=(8, genes)) * 0.7
    base = 1.2 * random.normal(size=genes)
    parts = []
    for start in range(0, n, 5000):
        rate = np.exp(amplitude * np.tanh(place[start : start + 5000] @ program) + base)
        mean = depth * random.lognormal(0, 0.3, len(rate))[:, None] * rate / rate.sum(axis=1, keepdims=True)
        parts.append(sparse.csr_matrix(random.poisson(mean).astype(float)))
    return sparse.vstack(parts).tocsr()


def measure(name: str, work: Callable[[], object]) -> None:
    """A row of seconds, processor seconds and the largest memory until now."""
    start, used = time.perf_counter(), time.process_time()
    work()
    seconds, processors = time.perf_counter() - start, time.process_time() - used
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"| {name} | {seconds:.1f} | {processors:.1f} | {memory:.2f} GB |", flush=True)


def measure_large(n: int, depth: float, with_magic: bool) -> None:
    """Time and memory on many cells."""
    counts = large(n, depth)
    print(f"| {n} × 2000, {counts.nnz / n / 2000:.0%} positive | seconds | of processors | memory until then |")
    print("|---|---|---|---|")
    given = counts.toarray() if n <= 20_000 else counts
    measure("ours now", lambda: aw.impute(given))
    if with_magic and n <= 20_000:
        module = importlib.import_module("magic")
        measure("MAGIC, t = 3", lambda: module.MAGIC(t=3, random_state=0, verbose=0).fit_transform(given))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default=",".join(map(str, ODD)))
    parser.add_argument("--cells", type=int, help="measure time and memory on so many cells")
    parser.add_argument("--depth", type=float, default=1500, help="counts of a cell with --cells")
    parser.add_argument("--without-magic", action="store_true")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    if arguments.cells:
        measure_large(arguments.cells, arguments.depth, not arguments.without_magic)
        return
    seeds = [int(seed) for seed in arguments.seeds.split(",")]
    compared = methods(not arguments.without_magic)
    found: dict = {name: [] for name in compared}
    seconds: dict = {name: [] for name in compared}
    for seed in seeds:
        share, counts = simulate(seed)
        given = scaled(counts)
        print(
            f"<!-- seed {seed}, {LAWS[law_of(seed)]}, {counts.shape}, {(counts == 0).mean():.0%} zeros -->", flush=True
        )
        for name, method in compared.items():
            start = time.perf_counter()
            values = method(counts, given)
            seconds[name].append(time.perf_counter() - start)
            found[name].append(measures(values, share, given))
            row = " · ".join(f"{m:.4f}" for m in found[name][-1])
            print(f"<!--   {name}: {row} ({seconds[name][-1]:.1f} s) -->", flush=True)
    print("| method | in all | per gene | correlation | seconds |\n|---|---|---|---|---|")
    for name, rows in found.items():
        print(f"| {name} |", " | ".join(f"{m:.3f}" for m in np.mean(rows, axis=0)), f"| {np.mean(seconds[name]):.1f} |")


if __name__ == "__main__":
    main()
