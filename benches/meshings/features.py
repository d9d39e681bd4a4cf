"""Part `features`: the share of features that is found again on another meshing of the surface.

A feature is found again by the convention of `RepeatabilityParams`: another one of the same sign lies within its own σ, and
the two σ differ by at most 0.75 octaves.
"""

import numpy as np
from scipy.spatial import cKDTree

from adwave import Failure
from page import paragraph, table
from tables import figure

SIGMAS, OCTAVES = 1.0, 0.75
# The finest level whose features count, in mean edges, and the coarsest, in parts of the diagonal.
FINEST, COARSEST = 2.0, 0.04
MIN_LEVELS = 6
# Thresholds, from the mean response of a level upwards.
THETAS = tuple(round(1.0 + 0.2 * k, 1) for k in range(14))
# Goal for both shares on the shapes on which θ is tuned.
GOAL = 0.75
# Features on each side, over all shapes, that a θ needs to be chosen.
MIN_FEATURES = 30
# Features on each side that a θ needs to be listed.
MIN_LISTED = 10
# Responses by their names in `--response`: the default, and one that needs no mean.
RESPONSES = ("normalized", "sigma")
# Draws for the share found by chance: features of the remeshing at random places, uniform by area.
DRAWS, SEED = 10, 1


def level_widths(mesh):
    """Widths σ of the levels, half an octave apart, in model units.

    Two levels finer than the finest that counts are only compared with: the very first holds everything finer.
    """
    lengths = [FINEST * mesh.mean_edge / 2]
    while len(lengths) < MIN_LEVELS or lengths[-2] < COARSEST * mesh.diagonal:
        lengths.append(lengths[-1] * 2**0.5)
    return lengths


def count_found_again(reference, other):
    """The number of features of the reference that have a counterpart among the others."""
    if not len(reference) or not len(other):
        return 0
    tree = cKDTree(other[:, :3])
    count = 0
    for feature in reference:
        near = other[tree.query_ball_point(feature[:3], SIGMAS * feature[3])]
        octaves = np.abs(np.log2(near[:, 3] / feature[3]))
        count += bool(((near[:, 4] == feature[4]) & (octaves <= OCTAVES)).any())
    return count


def above_threshold(features, theta):
    """Features with a strength of at least `theta`."""
    return features[features[:, 5] >= theta]


def count_pair(a, b, theta):
    """Numbers of features of the shape, of those found again, of features of its remeshing, and of those that are right."""
    a, b = above_threshold(a, theta), above_threshold(b, theta)
    return [len(a), count_found_again(a, b), len(b), count_found_again(b, a)]


def expected_by_chance(a, b, mesh, theta):
    """The mean number found again if each feature of the other mesh lies at a random place, uniform by area."""
    a, b = above_threshold(a, theta), above_threshold(b, theta)
    random = np.random.default_rng(SEED)
    moved, counts = b.copy(), []
    for _ in range(DRAWS):
        moved[:, :3] = mesh.points[random.choice(len(mesh.points), len(b), p=mesh.vertex_areas / mesh.vertex_areas.sum())]
        counts.append(count_found_again(a, moved))
    return float(np.mean(counts))


def shares(counts):
    """Features of all shapes, the share found again, the share that is right, and their mean; None without features."""
    n_a, again, n_b, right = map(int, np.sum(counts, axis=0))
    if not n_a or not n_b:
        return None
    return {"features": [n_a, n_b], "shares": [again / n_a, right / n_b, (again / n_a + right / n_b) / 2]}


def tune(by_theta):
    """The smallest θ at which both shares reach the goal on the tuning shapes, otherwise the one with the largest mean."""
    enough = {t: s["train"]["shares"] for t, s in by_theta.items() if s["train"] and min(s["train"]["features"]) >= MIN_FEATURES}
    reached = [t for t, s in enough.items() if min(s[:2]) >= GOAL]
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
                    pair = [bench.adwave.features(m, level_widths(mesh), operator, THETAS[0], response)
                            for m in (mesh, bench.meshings.isotropic(mesh))]
                    pairs[mesh.name] = [f[f[:, 3] >= 0.999 * FINEST * mesh.mean_edge] for f in pair]
            except Failure as failure:
                bench.add_note(str(failure))
                continue
            found["settings"].append({"operator": operator, "response": response, **measure_setting(bench, pairs, found)})
    return found


def measure_setting(bench, pairs, halves):
    """The tuned θ of an operator and a response, the shares for every θ, and those expected by chance."""
    counts = {theta: {name: count_pair(*pair, theta) for name, pair in pairs.items()} for theta in THETAS}
    by_theta = {theta: {half: shares([counts_of_theta[n] for n in halves[half]]) for half in ("train", "test")}
                for theta, counts_of_theta in counts.items()}
    theta = tune(by_theta)
    even = {mesh.name: bench.meshings.isotropic(mesh) for mesh in bench.shapes}
    chance = {}
    for half in ("train", "test"):
        features = sum(counts[theta][n][0] for n in halves[half])
        hits = sum(expected_by_chance(*pairs[n], even[n], theta) for n in halves[half])
        chance[half] = hits / features if features else None
    return {"theta": theta, "chance": chance, "by_theta": {str(t): s for t, s in by_theta.items()}, "shapes": counts[theta]}


def share(part, whole):
    return figure(part / whole if whole else None)


def format_counts(half):
    """Features of the shapes → of their remeshings."""
    return " → ".join(map(str, half["features"])) if half else "0"


def text(found):
    """The section of the page."""
    halves = [("train", "tuning"), ("test", "test")]
    heads = ["found again", "right", "mean"]
    summary, sweep, shapes = [], {half: [] for half, _ in halves}, []
    for setting in found["settings"]:
        label = [setting["operator"], setting["response"]]
        for half, name in halves:
            s = setting["by_theta"][str(setting["theta"])][half]
            summary.append([*label, setting["theta"], name, format_counts(s), *map(figure, s["shares"] if s else [None] * 3),
                            figure(setting["chance"][half])])
        for theta, by_half in setting["by_theta"].items():
            if all(by_half[half] and min(by_half[half]["features"]) >= MIN_LISTED for half, _ in halves):
                for half, _ in halves:
                    sweep[half].append([*label, theta, format_counts(by_half[half]), *map(figure, by_half[half]["shares"][:2])])
        shapes += [[name, *label, n_a, share(again, n_a), n_b, share(right, n_b)]
                   for name, (n_a, again, n_b, right) in setting["shapes"].items()]
    parts = [
        paragraph(f"Tuned on {', '.join(found['train'])}; tested on {', '.join(found['test'])}. *Found again* is the share of the shape's "
                  "features that its isotropic remeshing has too. *Right* is the share of the remeshing's features that the shape has. "
                  f"θ is the smallest from {THETAS[0]} up at which both are at least {GOAL} on the tuning shapes, otherwise the one with the "
                  f"largest mean of both among those with {MIN_FEATURES} features on each side. *By chance* is the share found again if each "
                  "feature of the remeshing lies at a random place. Features are counted over all shapes."),
        table(["operator", "response", "θ", "shapes", "features → remeshing", *heads, "by chance"], summary),
        "Each shape at the tuned θ:",
        table(["shape", "operator", "response", "features", "found again", "of the remeshing", "right"], shapes)]
    for half, name in halves:
        parts += [f"All θ with at least {MIN_LISTED} features on each side, {name} shapes:",
                  table(["operator", "response", "θ", "features → remeshing", *heads[:2]], sweep[half])]
    return "\n\n".join(parts)
