"""Signals on a road network: bands of passengers at bus stops, and stops without a counter filled in from their neighbors.

    python benches/graphs/traffic.py FOLDER

FOLDER has `montevideo_edges.csv` (source, target, length in meters) and `montevideo_y.npy` (stops × hours). Edges count in both
directions, with the weight exp(−length / mean length). In every hour the same fifth of the stops is held back. The held-back
values are estimated by Φᵗ(known values) / Φᵗ(known stops), relative to the mean of each hour. The number of steps t is chosen on
every other hour and judged on the hours between.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import scipy.sparse as sp

import adwave as aw

STEPS = (1, 2, 4, 8, 16, 32, 64)


def read(folder: Path) -> tuple[sp.csr_matrix, np.ndarray]:
    """Symmetric weights and roots of the passengers per hour, which make their variance even."""
    source, target, length = np.loadtxt(
        folder / "montevideo_edges.csv", delimiter=",", skiprows=1
    ).T
    values = np.sqrt(np.load(folder / "montevideo_y.npy").astype(float))
    n = len(values)
    weights = sp.coo_matrix(
        (np.exp(-length / length.mean()), (source.astype(int), target.astype(int))),
        shape=(n, n),
    )
    return weights.tocsr().maximum(weights.T.tocsr()), values


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    weights, values = read(parser.parse_args().folder)
    n = len(values)
    walk = aw.walk(weights, normalize="row", stay=0.5)
    mean = values.mean(axis=1)
    bands = walk.bands(mean, [1, 4, 16, 64])
    total = np.var(mean)
    print(f"{n} stops, {values.shape[1]} hours; the mean of each stop:")
    i, j = weights.nonzero()
    print(f"  correlation of neighbors {np.corrcoef(mean[i], mean[j])[0, 1]:.2f}")
    print(
        "  share of the variance:", *(f"{np.var(band) / total:.2f}" for band in bands)
    )

    held = np.zeros(n, bool)
    held[np.random.default_rng(0).permutation(n)[: n // 5]] = True
    known = (~held).astype(float)[:, None]
    hours = values[~held].mean(axis=0)
    relative = (values - hours) * known
    first, second = (
        np.arange(values.shape[1]) % 2 == 0,
        np.arange(values.shape[1]) % 2 == 1,
    )
    errors = []
    for steps in STEPS:
        share = walk.smooth(known, steps)
        estimate = np.where(
            share > 1e-6, walk.smooth(relative, steps) / np.maximum(share, 1e-6), 0.0
        )
        error = (values - hours - estimate)[held]
        errors.append((rms(error[:, first]), rms(error[:, second])))
    best = int(np.argmin([error for error, _ in errors]))
    before = rms((values - hours)[held][:, second])
    print(
        "root mean square error of the held-back stops, in roots of passengers, on the hours that chose nothing:"
    )
    print(
        f"  mean of the hour {before:.3f}; from neighbors, {STEPS[best]} steps {errors[best][1]:.3f}"
    )
    print(
        "  by steps:",
        *(
            f"{steps}: {error:.3f}"
            for steps, (_, error) in zip(STEPS, errors, strict=True)
        ),
    )


if __name__ == "__main__":
    main()
