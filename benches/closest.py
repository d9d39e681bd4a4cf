"""Exact closest points of a triangle mesh, and values of its vertices there."""

import numpy as np
from scipy.spatial import cKDTree

# Number of nearest centers that are tried first, then four times as many.
FIRST_CANDIDATES = 8


def closest_barycentric(p, a, b, c):
    """Barycentric coordinates (k × 3) of the point of triangle abc closest to p, row by row (Ericson 2005, 5.1.5)."""
    ab, ac, ap, bp, cp = b - a, c - a, p - a, p - b, p - c
    dot = lambda u, v: np.einsum("ij,ij->i", u, v)
    d1, d2, d3, d4, d5, d6 = (dot(u, v) for v in (ap, bp, cp) for u in (ab, ac))
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    with np.errstate(divide="ignore", invalid="ignore"):
        along_ab, along_ac, along_bc = d1 / (d1 - d3), d2 / (d2 - d6), (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    zero = np.zeros(len(p))
    one = zero + 1
    cases = [
        ((d1 <= 0) & (d2 <= 0), (zero, zero)),
        ((d3 >= 0) & (d4 <= d3), (one, zero)),
        ((d6 >= 0) & (d5 <= d6), (zero, one)),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), (along_ab, zero)),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), (zero, along_ac)),
        ((va <= 0) & (d4 >= d3) & (d5 >= d6), (1 - along_bc, along_bc)),
    ]
    v, w = (np.select([case for case, _ in cases], [found[k] for _, found in cases], rest)
            for k, rest in enumerate((v, w)))
    weights = np.stack([1 - v - w, v, w], axis=1)
    return np.where(np.isfinite(weights).all(axis=1, keepdims=True), weights, [1.0, 0.0, 0.0])


class Surface:
    """A mesh prepared for queries: triangles by octaves of their size, each octave in a k-d tree of centers.

    A triangle reaches no farther from its center than `reach` of its octave, so a query is done if the farthest center
    that was tried is farther than the best distance plus `reach`.
    """

    def __init__(self, mesh):
        self.points, self.triangles = mesh.points, mesh.triangles
        self.vertices = cKDTree(self.points)
        corners = self.points[self.triangles]
        centers = corners.mean(axis=1)
        reaches = np.linalg.norm(corners - centers[:, None], axis=2).max(axis=1)
        octaves = np.floor(np.log2(np.maximum(reaches, 1e-300)))
        self.octaves = []
        for octave in np.unique(octaves):
            members = np.flatnonzero(octaves == octave)
            self.octaves.append((cKDTree(centers[members]), members, reaches[members].max()))

    def closest(self, queries):
        """The points of the mesh closest to the queries (k × 3), as `Places`."""
        n = len(queries)
        # The nearest vertex bounds the distance; a triangle replaces it as soon as it is found.
        best = self.vertices.query(queries, workers=-1)[0] * (1 + 1e-12) + 1e-300
        triangle, weights = np.full(n, -1), np.zeros((n, 3))
        for tree, members, reach in self.octaves:
            pending, k = np.arange(n), min(FIRST_CANDIDATES, len(members))
            while len(pending):
                distance, index = tree.query(queries[pending], k=np.arange(1, k + 1), workers=-1)
                row, column = np.nonzero(distance <= best[pending, None] + reach)
                self._update_closest(queries, pending[row], members[index[row, column]], best, triangle, weights)
                if k == len(members):
                    break
                pending = pending[distance[:, -1] < best[pending] + reach]
                k = min(4 * k, len(members))
        return Places(self.triangles[triangle], weights, best)

    def _update_closest(self, queries, row, candidate, best, triangle, weights):
        """Updates the closest point of each query by candidate triangles, pair by pair."""
        if not len(row):
            return
        corners = self.points[self.triangles[candidate]]
        w = closest_barycentric(queries[row], *corners.transpose(1, 0, 2))
        distance = np.linalg.norm(np.einsum("ik,ikd->id", w, corners) - queries[row], axis=1)
        order = np.lexsort((candidate, distance, row))
        first = order[np.unique(row[order], return_index=True)[1]]
        first = first[distance[first] <= best[row[first]]]
        at = row[first]
        best[at], triangle[at], weights[at] = distance[first], candidate[first], w[first]


class Places:
    """Points of a mesh: corners of their triangles (k × 3), barycentric coordinates (k × 3), distances from the queries (k)."""

    def __init__(self, corners, weights, distances):
        self.corners, self.weights, self.distances = corners, weights, distances

    def interpolated(self, values):
        """Values of the mesh's vertices, interpolated linearly at the places."""
        return np.einsum("ik,ik...->i...", self.weights, values[self.corners])

    def nearest(self, values):
        """The value of the corner with the largest weight at each place."""
        return values[self.corners[np.arange(len(self.corners)), self.weights.argmax(axis=1)]]
