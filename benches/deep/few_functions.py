"""Deep levels from few functions: true errors and computable bounds of a Rayleigh–Ritz approximation, for docs/SCALE.md.

python few_functions.py [--vertices N] [--shapes NAME…] [--clusters KIND…] [--obj FILE]

Vertices are put in clusters about as wide as 32 steps of the lazy random walk Φ; the columns of B are Φ³² applied to the clusters'
indicator functions. S_n = Φⁿf is replaced by Φᵖ B Hⁿ⁻²ᵖ Π_B Φᵖf, where Π_B is the orthogonal projection (in the stationary distribution) on
the span of B and H = Π_B Φ restricted to it; all its Ritz pairs are computed by dense eigensolvers, so what is measured is the space and
not a solver. Errors are those of W_9 … W_14 (W_j = S_2^(j-2) - S_2^(j-1)), relative to the norm of that band. In brackets is what a program
could know of them: ‖(I - Π_B)Φᵖf‖ and the residuals of all coarse steps added up, relative to the same norm.

Shapes are generated, or with --obj the one mesh of a Wavefront OBJ file is taken: a thin sheet, a cloud whose density jumps by ten (with the
plain walk of the k nearest neighbors and with α = 1), a random geometric graph and a graph like roads (both without coordinates; lengths
there are hops, so one kind of clusters is enough). The terrain is bare hills: that of `adwave sample terrain`, with roofs and trees, errs
2 to 12 times as much. Needs numpy and scipy. B is dense: memory is some 40 bytes for each vertex and function.
"""

from __future__ import annotations

import argparse
import heapq
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.integrate import trapezoid
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree
from scipy.special import gammaln

SMOOTHING = 32  # steps of the walk that make B of the indicator functions
EXACT_STEPS = (0, 64, 128)  # p: exact steps before and after the coarse ones
BANDS = range(9, 15)
RADIUS = 0.85  # of clusters that grow, in widths of SMOOTHING steps
SMALLEST = 1e-280  # of the kernel: no edge is lost to underflow
KINDS = ("grown", "hops", "voxels")


@dataclass
class Walk:
    """A lazy random walk on the largest component of a shape, and a signal with mean 0."""

    name: str
    phi: sp.csr_matrix  # rows sum to 1
    pi: np.ndarray  # the stationary distribution
    length: sp.csr_matrix  # of the edges
    points: np.ndarray | None
    signal: np.ndarray  # a column for each channel

    @property
    def size(self) -> int:
        return len(self.pi)

    def norm(self, values: np.ndarray) -> float:
        """The norm in the stationary distribution, of all channels together."""
        return float(np.sqrt((self.pi @ (values * values)).sum()))

    def step(self, length: sp.csr_matrix) -> float:
        """The root of the mean square length of one step of the walk."""
        return float(np.sqrt(self.pi @ np.asarray(self.phi.multiply(length.power(2)).sum(axis=1)).ravel()))


def symmetric(pairs: np.ndarray, values: np.ndarray, size: int) -> sp.csr_matrix:
    """A symmetric matrix of one value for each unordered pair."""
    rows, columns = np.concatenate([pairs, pairs[:, ::-1]]).T
    return sp.csr_matrix((np.concatenate([values, values]), (rows, columns)), shape=(size, size))


def gaussian(length: sp.csr_matrix, width: float) -> sp.csr_matrix:
    """exp(-d²/2w²) of each edge."""
    kernel = length.copy()
    kernel.data = np.maximum(np.exp(-(length.data**2) / (2 * width**2)), SMALLEST)
    return kernel


def morton(points: np.ndarray) -> np.ndarray:
    """Keys of the Z-order curve, 20 bits for each coordinate."""
    extent = max(np.ptp(points, axis=0).max(), 1e-300)
    cells = ((points - points.min(axis=0)) / extent * (2**20 - 1)).astype(np.uint64)
    keys = np.zeros(len(points), np.uint64)
    for bit in range(20):
        for axis in range(3):
            keys |= ((cells[:, axis] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(3 * bit + axis)
    return keys


def lazy_walk(
    name: str,
    kernel: sp.csr_matrix,
    mass: np.ndarray,
    length: sp.csr_matrix,
    points: np.ndarray | None,
    signal: np.ndarray,
) -> Walk:
    """The walk that stays with probability ½ and else goes from x to y with a probability proportional to kernel(x, y)·mass(y)."""
    part = connected_components(kernel, directed=False)[1]
    keep = np.flatnonzero(part == np.bincount(part).argmax())
    if points is not None:
        keep = keep[np.argsort(morton(points[keep]), kind="stable")]
        points = points[keep]
    kernel, length, mass = kernel[keep][:, keep], length[keep][:, keep].tocsr(), mass[keep]
    weights = kernel @ sp.diags(mass)
    sums = np.asarray(weights.sum(axis=1)).ravel()
    phi = (0.5 * sp.identity(len(keep)) + 0.5 * sp.diags(1 / sums) @ weights).tocsr()
    pi = mass * sums  # detailed balance, as the kernel is symmetric
    pi /= pi.sum()
    assert np.abs(phi.T @ pi - pi).max() < 1e-9 * pi.max()
    signal = signal[keep].astype(float)
    return Walk(name, phi, pi, length, points, signal - pi @ signal)


def mesh(name: str, points: np.ndarray, faces: np.ndarray, signal: np.ndarray | None = None) -> Walk:
    """Steps along the edges of triangles, Gaussian in their length, a vertex weighted by a third of the area of its triangles."""
    sides = [points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2)]
    area = np.linalg.norm(np.cross(*sides), axis=1) / 2
    mass = np.bincount(faces.ravel(), np.repeat(area / 3, 3), len(points))
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    edges = edges[edges[:, 0] != edges[:, 1]]
    distances = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    length = symmetric(edges, distances, len(points))
    return lazy_walk(name, gaussian(length, distances.mean()), mass, length, points, points if signal is None else signal)


def cloud(name: str, points: np.ndarray, invariant: bool, neighbors: int = 10) -> Walk:
    """Steps to the k nearest neighbors; `invariant`: to all within one length, normalized by the density (α = 1)."""
    points = np.unique(points, axis=0)
    size = len(points)
    tree = cKDTree(points)
    distances, near = tree.query(points, neighbors + 1)
    rows = np.repeat(np.arange(size), neighbors)
    directed = sp.csr_matrix((distances[:, 1:].ravel(), (rows, near[:, 1:].ravel())), shape=(size, size))
    length = directed.maximum(directed.T).tocsr()
    mass = np.pi * distances[:, -1] ** 2 / neighbors
    if not invariant:
        return lazy_walk(name, gaussian(length, distances[:, 1:].mean()), mass, length, points, points)
    reach = float(np.quantile(distances[:, -1], 0.95))
    pairs = tree.query_pairs(reach, output_type="ndarray")
    while 2 * len(pairs) > 128 * size:
        reach *= 0.8
        pairs = tree.query_pairs(reach, output_type="ndarray")
    within = symmetric(pairs, np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1), size)
    length = within.maximum(length).tocsr()
    kernel = gaussian(length, reach / 2)
    for _ in range(4):
        mass = mass / (mass + kernel @ mass)
    return lazy_walk(name, kernel, mass / mass.max(), length, points, points)


def graph(name: str, edges: np.ndarray, signal: np.ndarray) -> Walk:
    """Steps along edges of weight 1 and length 1."""
    ones = symmetric(edges, np.ones(len(edges)), len(signal))
    return lazy_walk(name, ones, np.ones(len(signal)), ones, None, signal)


def read_obj(path: Path) -> Walk:
    """The mesh of a Wavefront OBJ: polygons as fans of triangles, vertices at the same place merged."""
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    with open(path, encoding="utf-8", errors="replace") as lines:
        for line in lines:
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                numbers = [int(word.split("/")[0]) for word in words[1:]]
                corners = [number - 1 if number > 0 else len(vertices) + number for number in numbers]
                faces += [[corners[0], *pair] for pair in pairwise(corners[1:])]
    if not faces:
        raise SystemExit(f"{path}: no faces")
    points, inverse = np.unique(np.array(vertices), axis=0, return_inverse=True)
    return mesh(path.stem, points, inverse.ravel()[np.array(faces)])


def sheet(vertices: int, thickness: float = 0.5, spacing: float = 100 / 131) -> Walk:
    """A closed box with two large sides nearer to each other than their vertices are among themselves, jittered in the plane."""
    rng = np.random.default_rng(0)
    n = max(3, round(np.sqrt(vertices / 2)))
    line = np.linspace(0, spacing * (n - 1), n)
    x, y = np.meshgrid(line, line, indexing="ij")
    inner = np.zeros((n, n, 1))
    inner[1:-1, 1:-1] = 1
    sides = []
    for z in (0.0, thickness):
        plane = np.stack([x, y], axis=-1) + inner * rng.uniform(-spacing / 4, spacing / 4, (n, n, 2))
        sides.append(np.column_stack([plane.reshape(-1, 2), np.full(n * n, z)]))
    points = np.concatenate(sides)
    index = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    bottom = np.concatenate([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)])
    ring = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])
    after = np.roll(ring, -1)
    wall = np.concatenate([np.stack([ring, after, ring + n * n], axis=1), np.stack([after, after + n * n, ring + n * n], axis=1)])
    sign = np.where(points[:, 2] > thickness / 2, 1.0, -1.0)
    waves = sign * np.sin(points[:, 0] / 9) * np.cos(points[:, 1] / 13)
    signal = np.stack([waves, sign * rng.standard_normal(len(points)), points[:, 0]], axis=1)
    return mesh("thin sheet", points, np.concatenate([bottom, bottom[:, ::-1] + n * n, wall]), signal)


def hills(vertices: int, strips: int = 6) -> np.ndarray:
    """Points on hilly terrain: one in a unit of area in every other strip, a tenth of that between them."""
    rng = np.random.default_rng(1)
    width = np.sqrt(vertices / 0.55)
    plane = rng.uniform(0, width, (round(width**2), 2))
    dense = np.floor(plane[:, 0] / width * strips) % 2 == 0
    plane = plane[rng.random(len(plane)) < np.where(dense, 1.0, 0.1)]
    height = np.zeros(len(plane))
    for wavelength in np.geomspace(15, 120, 8):
        angle, phase = rng.uniform(0, 2 * np.pi, 2)
        height += 0.03 * wavelength * np.sin(2 * np.pi / wavelength * plane @ [np.cos(angle), np.sin(angle)] + phase)
    return np.column_stack([plane, height])


def geometric(vertices: int) -> Walk:
    """A random geometric graph in the unit square of mean degree 7, without its coordinates; signals: noise, waves, a slope."""
    rng = np.random.default_rng(0)
    points = rng.random((vertices, 2))
    edges = cKDTree(points).query_pairs(np.sqrt(7 / (np.pi * vertices)), output_type="ndarray")
    waves = np.sin(40 * points[:, 0]) * np.sin(30 * points[:, 1])
    return graph("random geometric graph", edges, np.stack([rng.standard_normal(vertices), waves, points[:, 0]], axis=1))


def roads(vertices: int) -> Walk:
    """A grid with a third of its streets missing and about every other street cut in two; signals: noise and its running sum."""
    rng = np.random.default_rng(0)
    n = max(3, round(np.sqrt(vertices / 1.66)))
    index = np.arange(n * n).reshape(n, n)
    along = np.stack([index[:-1].ravel(), index[1:].ravel()], axis=1)
    across = np.stack([index[:, :-1].ravel(), index[:, 1:].ravel()], axis=1)
    streets = np.concatenate([along, across])
    streets = streets[rng.random(len(streets)) < 0.66]
    edges, size = [], n * n
    for start, end in streets[rng.permutation(len(streets))].tolist():
        if rng.integers(0, 2):
            edges += [(start, size), (size, end)]
            size += 1
        else:
            edges.append((start, end))
    noise, steps = rng.standard_normal(size), rng.standard_normal(size)
    return graph("graph like roads", np.array(edges), np.stack([noise, steps.cumsum() / 100], axis=1))


SHAPES: dict[str, Callable[[int], Walk]] = {
    "sheet": sheet,
    "terrain": lambda vertices: cloud("terrain, strips 10:1, plain walk", hills(vertices), invariant=False),
    "terrain-invariant": lambda vertices: cloud("terrain, strips 10:1, α = 1", hills(vertices), invariant=True),
    "geometric": geometric,
    "roads": roads,
}


def grown(length: sp.csr_matrix, radius: float) -> np.ndarray:
    """A label for each vertex: that of the nearest seed along edges, seeds being farther than the radius from all seeds before."""
    starts, ends, lengths = length.indptr.tolist(), length.indices.tolist(), length.data.tolist()
    nearest = [np.inf] * length.shape[0]
    seeds = []
    for seed in range(length.shape[0]):
        if nearest[seed] <= radius:
            continue
        seeds.append(seed)
        nearest[seed] = 0.0
        heap = [(0.0, seed)]
        while heap:
            distance, vertex = heapq.heappop(heap)
            if distance > nearest[vertex]:
                continue
            for k in range(starts[vertex], starts[vertex + 1]):
                farther = distance + lengths[k]
                if farther <= radius and farther < nearest[ends[k]]:
                    nearest[ends[k]] = farther
                    heapq.heappush(heap, (farther, ends[k]))
    source = dijkstra(length, indices=seeds, min_only=True, return_predecessors=True)[2]
    return np.searchsorted(seeds, source)


def voxels(points: np.ndarray, side: float) -> np.ndarray:
    """A label for each vertex: that of the cube it lies in."""
    cells = np.floor((points - points.min(axis=0)) / side).astype(np.int64)
    return np.unique(cells, axis=0, return_inverse=True)[1].ravel()


def clusters(walk: Walk, kind: str) -> np.ndarray:
    """Labels of clusters about as wide as SMOOTHING steps of the walk, in lengths or in hops."""
    length = walk.length
    if kind == "hops":
        length = length.copy()
        length.data = np.ones_like(length.data)
    width = walk.step(length) * np.sqrt(SMOOTHING)
    if kind == "voxels":
        assert walk.points is not None
        return voxels(walk.points, width)
    return grown(length, RADIUS * width)


def coefficients(steps: int, tail: float = 1e-12) -> np.ndarray:
    """c_k of λⁿ = Σ c_k T_k(2λ - 1), cut where what is left out adds up to less than `tail`."""
    k = np.arange(steps)
    first = gammaln(2 * steps + 1) - 2 * gammaln(steps + 1) - 2 * steps * np.log(2)
    found = 2 * np.exp(np.concatenate([[first], np.log(steps - k) - np.log(steps + k + 1)]).cumsum())
    found[0] /= 2
    rest = found[::-1].cumsum()[::-1]
    found = found[: max(2, int(np.searchsorted(-rest, -tail)) + 1)]
    return found / found.sum()


def powers(phi: sp.csr_matrix, values: np.ndarray, steps: list[int]) -> list[np.ndarray]:
    """Φⁿ·values for all n of `steps` by one Chebyshev recurrence."""
    series = [coefficients(n) for n in steps]
    found = [np.zeros_like(values) for _ in steps]
    shifted = (2 * phi - sp.identity(phi.shape[0])).tocsr()
    now, following = values, shifted @ values
    for k in range(max(map(len, series))):
        for sums, weights in zip(found, series, strict=True):
            if k < len(weights):
                sums += weights[k] * now
        now, following = following, 2 * (shifted @ following) - now
    return found


class Ritz:
    """The walk restricted to the columns of B, by all its Ritz pairs."""

    def __init__(self, walk: Walk, basis: np.ndarray) -> None:
        self.walk, self.basis = walk, basis
        root = np.sqrt(walk.pi)[:, None]
        moved = root * (walk.phi @ basis)
        scaled = root * basis
        mass, stiffness, squares = scaled.T @ scaled, scaled.T @ moved, moved.T @ moved
        # Functions where the walk is practically never get scale 0 and are dropped with what is linearly dependent.
        diagonal = np.diag(mass)
        scale = np.where(diagonal > 1e-200, 1 / np.sqrt(np.maximum(diagonal, 1e-300)), 0)
        values, vectors = np.linalg.eigh(mass * scale[:, None] * scale)
        keep = values > 1e-12 * values[-1]
        self.condition = values[-1] / max(values[0], 1e-300)
        orthonormal = scale[:, None] * vectors[:, keep] / np.sqrt(values[keep])
        self.values, rotation = np.linalg.eigh(orthonormal.T @ ((stiffness + stiffness.T) / 2) @ orthonormal)
        self.vectors = orthonormal @ rotation
        self.squares = self.vectors.T @ squares @ self.vectors

    def project(self, values: np.ndarray) -> np.ndarray:
        """Coordinates of Π_B·values."""
        return self.vectors.T @ (self.basis.T @ (self.walk.pi[:, None] * values))

    def lift(self, coordinates: np.ndarray) -> np.ndarray:
        """Values at the vertices."""
        return self.basis @ (self.vectors @ coordinates)

    def steps(self, coordinates: np.ndarray, count: int) -> np.ndarray:
        """Coordinates after `count` coarse steps."""
        return np.clip(self.values, 0, 1)[:, None] ** count * coordinates

    def residuals(self, coordinates: np.ndarray, count: int) -> float:
        """Σ ‖(I - Π_B)Φu_k‖ over the first `count` coarse steps u_k, from a sample, as the terms fall."""
        if count <= 0:
            return 0.0
        sample = np.unique(np.concatenate([np.arange(min(count, 8)), np.rint(np.geomspace(1, count, 40)).astype(int) - 1]))
        terms = []
        for k in sample:
            now = self.steps(coordinates, int(k))
            square = np.sum(now * (self.squares @ now)) - np.sum((self.values[:, None] * now) ** 2)
            terms.append(np.sqrt(max(0.0, float(square))))
        return float(trapezoid(terms, sample)) + terms[0]


def errors(ritz: Ritz, exact: dict[int, np.ndarray], p: int) -> Iterator[tuple[float, float]]:
    """Error and bound of each band, relative to it; `exact` holds S_n by the band that it ends."""
    walk = ritz.walk
    start = powers(walk.phi, walk.signal, [p])[0] if p else walk.signal
    coordinates = ritz.project(start)
    outside = walk.norm(start - ritz.lift(coordinates))
    found, bound = {}, {}
    for j in exact:
        count = 2 ** (j - 1) - 2 * p
        if count < 0:  # too shallow for p steps twice: taken exactly
            found[j], bound[j] = exact[j], 0.0
            continue
        coarse = ritz.lift(ritz.steps(coordinates, count))
        found[j] = powers(walk.phi, coarse, [p])[0] if p else coarse
        bound[j] = outside + ritz.residuals(coordinates, count)
    for j in BANDS:
        band = exact[j - 1] - exact[j]
        yield walk.norm(found[j - 1] - found[j] - band) / walk.norm(band), (bound[j - 1] + bound[j]) / walk.norm(band)


def rows(walk: Walk, kinds: list[str]) -> Iterator[str]:
    """The rows of the table for one shape."""
    levels = range(min(BANDS) - 1, max(BANDS) + 1)
    exact = dict(zip(levels, powers(walk.phi, walk.signal, [2 ** (j - 1) for j in levels]), strict=True))
    for kind in kinds:
        begin = time.perf_counter()
        labels = clusters(walk, kind)
        basis = np.zeros((walk.size, labels.max() + 1))
        basis[np.arange(walk.size), labels] = 1
        for _ in range(SMOOTHING):
            basis = walk.phi @ basis
        # Rows of B sum to 1, as those of the indicator functions do.
        entries = " / ".join(f"{np.count_nonzero(basis >= least) / walk.size:.0f}" for least in (1e-4, 1e-3))
        ritz = Ritz(walk, basis)
        for p in EXACT_STEPS:
            cells = [f"{error:.1e} ({bound:.0e})" for error, bound in errors(ritz, exact, p)]
            words = [f"{walk.name}, {walk.size} vertices", kind, str(basis.shape[1]), entries, str(p), *cells]
            yield f"| {' | '.join(words)} |"
        seconds = time.perf_counter() - begin
        print(f"{walk.name}, {kind}: condition of BᵀΠB {ritz.condition:.1e}, {seconds:.0f} s", file=sys.stderr)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vertices", type=int, default=12_000, help="about as many in each generated shape")
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES), metavar="NAME", help=", ".join(SHAPES))
    parser.add_argument("--clusters", nargs="+", choices=KINDS, default=list(KINDS), metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--obj", type=Path, metavar="FILE", help="this mesh in the place of the generated shapes")
    args = parser.parse_args()
    print("| shape | clusters | functions | entries a row of B above 1e-4 / 1e-3 | p |", *(f"W_{j} |" for j in BANDS))
    print("|" + "---|" * (5 + len(BANDS)), flush=True)
    for walk in [read_obj(args.obj)] if args.obj else (SHAPES[name](args.vertices) for name in args.shapes):
        # Without coordinates lengths are hops, and there is no space for voxels.
        kinds = args.clusters if walk.points is not None else ["hops"]
        for row in rows(walk, kinds):
            print(row, flush=True)


if __name__ == "__main__":
    main()
