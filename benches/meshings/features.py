"""Part `features`: which share of the features is found again on another meshing of the surface.

A feature is found again by the convention of `RepeatabilityParams`: another of the same sign within its own σ of its place,
with a σ at most 0.75 octaves off.
"""

import numpy as np
from scipy.spatial import cKDTree

from adwave import Failure
from page import table
from tables import figure

SIGMAS, OCTAVES = 1.0, 0.75
# The finest level whose features count, in mean edges, and the coarsest, in parts of the diagonal.
FINEST, COARSEST = 2.0, 0.04
FEWEST_LEVELS = 6
# From what is no more than the mean of its level upwards.
THETAS = tuple(round(1.0 + 0.2 * k, 1) for k in range(14))
# What both shares shall reach on the shapes that θ is tuned on.
WANTED = 0.75
# Where fewer are left over all shapes a share says little, and no θ is chosen by it.
FEWEST_FEATURES = 30
# Lines of the table of all θ.
FEWEST_SHOWN = 10
# Responses that are compared in place and scale, by their names in `--response`: the default, and one that needs no mean.
RESPONSES = ("normalized", "sigma")
# What is found by chance: features of the remeshing put at places drawn by area, so many times.
DRAWS, SEED = 10, 1


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


def strong(features, theta):
    return features[features[:, 5] >= theta]


def of_pair(a, b, theta):
    """Features of the shape, those found again, features of its remeshing, those that are right."""
    a, b = strong(a, theta), strong(b, theta)
    return [len(a), found_again(a, b), len(b), found_again(b, a)]


def by_chance(a, b, mesh, theta):
    """How many are found again on the average when each feature of the other mesh is put at a place drawn by area."""
    a, b = strong(a, theta), strong(b, theta)
    random = np.random.default_rng(SEED)
    moved, counts = b.copy(), []
    for _ in range(DRAWS):
        moved[:, :3] = mesh.points[random.choice(len(mesh.points), len(b), p=mesh.vertex_areas / mesh.vertex_areas.sum())]
        counts.append(found_again(a, moved))
    return float(np.mean(counts))


def shares(counts):
    """Features of all shapes, the share found again, the share that is right, and their mean; None with no features."""
    n_a, again, n_b, right = map(int, np.sum(counts, axis=0))
    if not n_a or not n_b:
        return None
    return {"features": [n_a, n_b], "shares": [again / n_a, right / n_b, (again / n_a + right / n_b) / 2]}


def tuned(by_theta):
    """The smallest θ with both shares as wanted on the shapes to tune it, else the one with the largest mean."""
    enough = {t: s["train"]["shares"] for t, s in by_theta.items() if s["train"] and min(s["train"]["features"]) >= FEWEST_FEATURES}
    reached = [t for t, s in enough.items() if min(s[:2]) >= WANTED]
    if reached:
        return min(reached)
    return max(enough, key=lambda t: enough[t][2]) if enough else THETAS[0]


def measure(bench):
    """Features of each shape and of its isotropic remeshing; θ is tuned on every other shape and applied to the rest."""
    names = sorted(mesh.name for mesh in bench.shapes)
    found = {"train": names[::2], "test": names[1::2], "settings": []}
    for operator in bench.adwave.operators:
        for response in RESPONSES:
            pairs = {}
            try:
                for mesh in bench.shapes:
                    pair = [bench.adwave.features(m, lengths_of(mesh), operator, THETAS[0], response)
                            for m in (mesh, bench.meshings.isotropic(mesh))]
                    pairs[mesh.name] = [f[f[:, 3] >= 0.999 * FINEST * mesh.mean_edge] for f in pair]
            except Failure as failure:
                bench.note(str(failure))
                continue
            found["settings"].append({"operator": operator, "response": response, **of_setting(bench, pairs, found)})
    return found


def of_setting(bench, pairs, halves):
    counts = {theta: {name: of_pair(*pair, theta) for name, pair in pairs.items()} for theta in THETAS}
    by_theta = {theta: {half: shares([of[n] for n in halves[half]]) for half in ("train", "test")} for theta, of in counts.items()}
    theta = tuned(by_theta)
    even = {mesh.name: bench.meshings.isotropic(mesh) for mesh in bench.shapes}
    chance = {}
    for half in ("train", "test"):
        features = sum(counts[theta][n][0] for n in halves[half])
        hits = sum(by_chance(*pairs[n], even[n], theta) for n in halves[half])
        chance[half] = hits / features if features else None
    return {"theta": theta, "chance": chance, "by_theta": {str(t): s for t, s in by_theta.items()}, "shapes": counts[theta]}


def share(part, whole):
    return figure(part / whole if whole else None)


def counted(of_half):
    """Features of the shapes → of their remeshings."""
    return " → ".join(map(str, of_half["features"])) if of_half else "0"


def text(found):
    halves = [("train", "to tune θ"), ("test", "to test")]
    heads = ["found again", "right", "mean"]
    summary, sweep, shapes = [], [], []
    for of in found["settings"]:
        label = [of["operator"], of["response"]]
        for half, name in halves:
            s = of["by_theta"][str(of["theta"])][half]
            summary.append([*label, of["theta"], name, counted(s), *map(figure, s["shares"] if s else [None] * 3), figure(of["chance"][half])])
        for theta, by_half in of["by_theta"].items():
            if all(by_half[half] and min(by_half[half]["features"]) >= FEWEST_SHOWN for half, _ in halves):
                sweep.append([*label, theta, *(x for half, _ in halves for x in (counted(by_half[half]), *map(figure, by_half[half]["shares"][:2])))])
        shapes += [[name, *label, n_a, share(again, n_a), n_b, share(right, n_b)] for name, (n_a, again, n_b, right) in of["shapes"].items()]
    return "\n\n".join([
        f"Tuned on {', '.join(found['train'])}; tested on {', '.join(found['test'])}. *Found again*: the share of the shape's features that its "
        "isotropic remeshing has too. *Right*: the share of the remeshing's features that the shape has, which is the same question the "
        f"other way round. θ is the smallest from {THETAS[0]} up with both at least {WANTED} on the shapes that it is tuned on, else the one with "
        f"the largest mean of both, from {FEWEST_FEATURES} features on each side up. *By chance*: the share found again when each feature of the "
        "remeshing lies at a random place of it. Features of all shapes together.",
        table(["operator", "response", "θ", "shapes", "features → of the remeshing", *heads, "found again by chance"], summary),
        "Each shape at the tuned θ:",
        table(["shape", "operator", "response", "features", "found again", "of the remeshing", "right"], shapes),
        f"All θ with at least {FEWEST_SHOWN} features on each side:",
        table(["operator", "response", "θ", *(f"{h}, {label}" for _, label in halves for h in ("features", *heads[:2]))], sweep)])
