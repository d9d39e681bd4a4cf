"""Jitter added to animations whose frames are clean, and what is left of it: the table of docs/SPACETIME.md.

    python benches/python/animations.py [--seed K] FOLDER...

Each folder holds the frames of one animation, in the order of their names. adwave chooses widths by the noisy frames alone;
the single width along time is the best of ten, chosen by the truth.
"""

import argparse
from pathlib import Path

import adwave as aw
import numpy as np

NOISES = (0.1, 0.3, 1.0)  # in mean edges of the first frame
WIDTHS = (0.3, 0.5, 0.7, 1, 1.4, 2, 3, 4, 6, 8)  # full widths at half maximum, in frames


def rms(values):
    return np.sqrt((values**2).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    random = np.random.default_rng(args.seed)
    print("| animation, noise | found / true | promised | left | left by the best width |")
    print("| --- | --: | --: | --: | --: |")
    for folder in args.folders:
        clean = aw.sequence(folder)
        a, b = (clean.points[0][clean.shape.faces[:, k]] for k in (0, 1))
        edge = np.linalg.norm(a - b, axis=1).mean()
        for noise in NOISES:
            size = noise * edge
            frames = clean.points + size * random.normal(size=clean.points.shape)
            noisy = aw.sequence(frames, faces=clean.shape.faces)
            found, info = noisy.denoise()
            left = rms(found.points - clean.points) / size
            best = min(rms(noisy.smooth(time=width).points - clean.points) for width in WIDTHS) / size
            numbers = [info["noise"] / size, np.sqrt(info["risk"][1]) / size, left, best]
            print(f"| {folder.name}, {noise:g} | {' | '.join(f'{n:.2f}' for n in numbers)} |")


if __name__ == "__main__":
    main()
