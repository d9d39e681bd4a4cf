"""Meshes and their operators, written from the formulas of docs/THEORY.md and sharing no line with the Rust code."""

import numpy as np
import scipy.sparse as sp


def read_obj(path):
    """Points and triangles of an OBJ file, without the vertices that no triangle uses."""
    points, triangles = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) - 1 for w in words[1:]]
            triangles += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    return used(np.array(points), np.array(triangles))


def used(points, triangles):
    kept, numbers = np.unique(triangles, return_inverse=True)
    return points[kept], numbers.reshape(triangles.shape)


def subdivided(points, triangles):
    """Every triangle cut into four at the middles of its edges."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides.sort(axis=1)
    keys, number = np.unique(sides[:, 0] * len(points) + sides[:, 1], return_inverse=True)
    ends = np.stack([keys // len(points), keys % len(points)], 1)
    ab, bc, ca = (len(points) + number).reshape(3, -1)
    a, b, c = triangles.T
    corners = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    middles = 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])
    return np.concatenate([points, middles]), np.concatenate([np.stack(t, 1) for t in corners])


def torus(n_vertices):
    """A torus with waves on it, of about `n_vertices` vertices."""
    around = max(3, round((n_vertices / 3) ** 0.5))
    along = max(3, round(n_vertices / around))
    i, k = (g.ravel() for g in np.meshgrid(np.arange(along), np.arange(around), indexing="ij"))
    u, v = 2 * np.pi * i / along, 2 * np.pi * (k + 0.5 * (i % 2)) / around
    radius = 1 / 3 + 0.02 * np.sin(7 * u) * np.cos(5 * v)
    ring = 1 + radius * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), radius * np.sin(v)], 1)
    at = lambda i, k: (i % along) * around + k % around
    right, above = at(i, k + 1), at(i + 1, k)
    triangles = [(at(i, k), above, right), (right, above, at(i + 1, k + 1))]
    return points, np.concatenate([np.stack(t, 1) for t in triangles])


def edges_of(triangles):
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0)


def areas_of(points, triangles):
    """A third of the area of the triangles at each vertex."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return sum(np.bincount(triangles[:, k], third, len(points)) for k in range(3))


def diffusion(points, triangles):
    """Φ₁ = [T]_r with `T(x,y) = A(y)·exp(−‖x−y‖²/4t)` over the one-ring, t = E²/2, and its stationary law."""
    n, areas, edges = len(points), areas_of(points, triangles), edges_of(triangles)
    squares = ((points[edges[:, 0]] - points[edges[:, 1]]) ** 2).sum(axis=1)
    kernel = np.exp(-squares / (2 * np.sqrt(squares).mean() ** 2))
    x, y = np.concatenate([edges, edges[:, ::-1]]).T
    both = np.concatenate([kernel, kernel])
    off = sp.csr_matrix((areas[y] * both, (x, y)), shape=(n, n))
    sums = np.asarray(off.sum(axis=1)).ravel()
    phi = (sp.diags(1 / (2 * sums)) @ (off + sp.diags(sums))).tocsr()
    phi.sort_indices()
    stationary = areas * sums
    return phi, stationary / stationary.sum()


def cotangent(points, triangles):
    """The positive cotangent Laplacian and the lumped masses of its generalized eigenvalue problem."""
    n, rows, columns, weights = len(points), [], [], []
    for k in range(3):
        i, j, o = triangles[:, (k + 1) % 3], triangles[:, (k + 2) % 3], triangles[:, k]
        u, v = points[i] - points[o], points[j] - points[o]
        doubled = np.linalg.norm(np.cross(u, v), axis=1)
        rows.append(i), columns.append(j), weights.append(0.5 * (u * v).sum(axis=1) / doubled)
    w = sp.csr_matrix((np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n))
    w = w + w.T
    stiffness = sp.diags(np.asarray(w.sum(axis=1)).ravel()) - w
    return stiffness.tocsc(), sp.diags(areas_of(points, triangles)).tocsc()
