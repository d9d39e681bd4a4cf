"""The diffusion time by cross-validation against the time of the least error, at three depths, and its curve.

    python benches/graphs/diffusion_time.py [--picture curve.png] [--cells N] [--genes N]

Counts are drawn from known rates, so the error of every time is known.
"""

from __future__ import annotations

import argparse

import numpy as np

import adwave as aw


def rates(n: int, genes: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of cells on a branching path, and relative rates of their genes."""
    random = np.random.default_rng(seed)
    branch, along = random.integers(0, 3, n), random.random(n)
    ends = random.normal(size=(3, 8))
    latent = along[:, None] * ends[branch] + 0.05 * random.normal(size=(n, 8))
    found = np.exp(1.2 * np.tanh(latent @ random.normal(size=(8, genes))) + random.normal(size=genes))
    return latent, found / found.sum(axis=1, keepdims=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture")
    parser.add_argument("--cells", type=int, default=3000)
    parser.add_argument("--genes", type=int, default=500)
    arguments = parser.parse_args()
    latent, share = rates(arguments.cells, arguments.genes, seed=3)
    random = np.random.default_rng(4)
    print("| molecules per cell | chosen t | best t | error / least | fixed t = 3: error / least |")
    print("|---|---|---|---|---|")
    curves = []
    for depth in (200, 1000, 10_000):
        truth = depth * share
        counts = random.poisson(truth)
        # The graph is that of all molecules, as in practice; cross-validation makes its own.
        found = aw.impute(counts, steps="molecules")
        walk = found.walk
        errors, values = [], counts.astype(float)
        for _ in range(len(found.errors)):
            errors.append(((values - truth) ** 2).mean())
            values = walk.smooth(values, 1)
        errors = np.array(errors)
        best = int(errors.argmin())
        least = errors[best]
        print(f"| {depth} | {found.steps:.0f} | {best} | {errors[int(found.steps)] / least:.3f} | {errors[3] / least:.3f} |")
        curves.append((depth, found, errors))
    if arguments.picture:
        draw(curves, arguments.picture)


def draw(curves: list, path: str) -> None:
    """Both errors over the number of steps, each depth in its own panel."""
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(curves), figsize=(10, 3.2), layout="constrained")
    for axis, (depth, found, errors) in zip(axes, curves, strict=True):
        shift = (found.errors - errors)[int(found.steps)]
        axis.plot(errors, color="#777777", label="error against the rates")
        axis.plot(found.errors - shift, color="#c44e52", linestyle="--", label="cross-validation, shifted")
        axis.axvline(found.steps, color="#c44e52", linewidth=0.8)
        axis.set(title=f"{depth} molecules per cell", xlabel="steps", yscale="log")
    axes[0].set_ylabel("mean squared error")
    axes[0].legend(fontsize=8)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
