"""Part `features`: which share of the features is found again on another meshing of the surface.

A feature is found again by the convention of `RepeatabilityParams`: another of the same sign within its own σ of its place,
with a σ at most 0.75 octaves off.
"""

import numpy as np
from scipy.spatial import cKDTree

from adwave import Failure
from tables import figure, table

SIGMAS, OCTAVES = 1.0, 0.75
# The finest level whose features count, in mean edges, and the coarsest, in parts of the diagonal.
FINEST, COARSEST = 2.0, 0.04
FEWEST_LEVELS = 6
THETAS = tuple(round(1.0 + 0.2 * k, 1) for k in range(14))
# Where fewer are left over all shapes a share says nothing.
FEWEST_FEATURES = 30


def lengths_of(mesh):
    """Half an octave apart. Two levels below the finest that counts are there to compare with: the very first holds all that is
    finer, whatever the mesh can tell of it."""
    lengths = [FINEST * mesh.mean_edge / 2]
    while len(lengths) < FEWEST_LEVELS or lengths[-2] < COARSEST * mesh.diagonal:
        lengths.append(lengths[-1] * 2**0.5)
    return lengths


def found_again(reference, other):
    """How many features of the reference have their like among the others."""
    if not len(reference) or not len(other):
        return 0
    tree = cKDTree(other[:, :3])
    count = 0
    for feature in reference:
        near = other[tree.query_ball_point(feature[:3], SIGMAS * feature[3])]
        octaves = np.abs(np.log2(near[:, 3] / feature[3]))
        count += bool(((near[:, 4] == feature[4]) & (octaves <= OCTAVES)).any())
    return count


def of_pair(a, b, theta):
    """Features of the shape, those found again, features of its remeshing, those that are right."""
    a, b = (f[f[:, 5] >= theta] for f in (a, b))
    return [len(a), found_again(a, b), len(b), found_again(b, a)]


def shares(counts):
    """The share found again, the share that is right, and their mean, over the features of all shapes; None with too few."""
    n_a, again, n_b, right = np.sum(counts, axis=0)
    if min(n_a, n_b) < FEWEST_FEATURES:
        return None
    return [float(again / n_a), float(right / n_b), float((again / n_a + right / n_b) / 2)]


def measure(bench):
    """Features of each shape and of its isotropic remeshing; θ is tuned on every other shape and applied to the rest."""
    names = sorted(mesh.name for mesh in bench.shapes)
    found = {"train": names[::2], "test": names[1::2], "operators": {}}
    for operator in bench.adwave.operators:
        counts = {}
        try:
            for mesh in bench.shapes:
                pair = [bench.adwave.features(m, lengths_of(mesh), operator, THETAS[0]) for m in (mesh, bench.meshings.isotropic(mesh))]
                pair = [f[f[:, 3] >= 0.999 * FINEST * mesh.mean_edge] for f in pair]
                counts[mesh.name] = {theta: of_pair(*pair, theta) for theta in THETAS}
        except Failure as failure:
            bench.note(str(failure))
            continue
        by_theta = {theta: {half: shares([counts[n][theta] for n in found[half]]) for half in ("train", "test")} for theta in THETAS}
        enough = [theta for theta in THETAS if by_theta[theta]["train"]]
        tuned = max(enough, key=lambda theta: by_theta[theta]["train"][2]) if enough else THETAS[0]
        found["operators"][operator] = {"tuned": tuned, "by_theta": {str(t): s for t, s in by_theta.items()},
                                        "shapes": {n: c[tuned] for n, c in counts.items()}}
    return found


def share(part, whole):
    return figure(part / whole if whole else None)


def text(found):
    halves = [("train", "to tune θ"), ("test", "to test")]
    tuned, sweep, shapes = [], [], []
    for operator, of in found["operators"].items():
        for half, label in halves:
            s = of["by_theta"][str(of["tuned"])][half]
            tuned.append([operator, of["tuned"], label, *(map(figure, s or [None] * 3))])
        for theta, by_half in of["by_theta"].items():
            if by_half["train"] and by_half["test"]:
                sweep.append([operator, theta, *(figure(x) for half, _ in halves for x in by_half[half])])
        shapes += [[name, operator, n_a, share(again, n_a), n_b, share(right, n_b)]
                   for name, (n_a, again, n_b, right) in of["shapes"].items()]
    heads = ["found again", "right", "mean"]
    return "\n\n".join([
        f"Tuned on {', '.join(found['train'])}; tested on {', '.join(found['test'])}. *Found again*: the share of the shape's features that its "
        "isotropic remeshing has too. *Right*: the share of the remeshing's features that the shape has, which is the same question the "
        "other way round; the mean of both directions is what is tuned. Features of all shapes together.",
        table(["operator", "θ", "shapes", *heads], tuned),
        "Each shape at the tuned θ:",
        table(["shape", "operator", "features", "found again", "of the remeshing", "right"], shapes),
        "All θ:",
        table(["operator", "θ", *(f"{h}, {label}" for _, label in halves for h in heads)], sweep)])
