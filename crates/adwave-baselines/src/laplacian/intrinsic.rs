//! The intrinsic Delaunay triangulation of a mesh: the same surface, other edges, no negative cotangents.
//!
//! Only the lengths of edges are used. Degenerate triangles are first made proper by lengthening every edge by the least
//! amount that does it (`sharp2020`); then every edge whose two opposite angles sum to more than π is flipped
//! (`bobenko2007`), which ends with all weights ≥ 0.

use super::LaplacianInfo;
use adwave::vector::{norm, subtract};

/// Each triangle inequality holds by at least this part of the mean edge.
const MARGIN: f64 = 1e-5;
/// Cotangent sums above this are not negative.
const ROUNDING: f64 = -1e-10;
/// Cap on the flips, for each edge: a handful is usual, the bound known is quadratic in the edges.
const MAX_FLIPS_PER_EDGE: usize = 200;

/// No triangle on the other side, or more than one, or one of the opposite orientation.
const NONE: usize = usize::MAX;

/// Triangles by the lengths of their sides; side `s` of triangle `t`, numbered `3t + s`, runs from corner `s` to `s + 1`.
struct Intrinsic {
    corner: Vec<u32>,
    length: Vec<f64>,
    twin: Vec<usize>,
}

/// Cotangent weights of the intrinsic edges and masses of the vertices.
pub(super) fn delaunay(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    unit: f64,
    info: &mut LaplacianInfo,
) -> (Vec<(u32, u32, f64)>, Vec<f64>) {
    let mut surface = Intrinsic::new(points, triangles);
    info.lengthened = surface.mollify() * unit;
    info.n_flips = surface.flip_all();
    let mut mass = vec![0.0; points.len()];
    let mut weights = Vec::with_capacity(surface.corner.len());
    for h in 0..surface.corner.len() {
        weights.push((surface.corner[h], surface.corner[next(h)], 0.5 * surface.cotangent(h)));
        mass[surface.corner[h] as usize] += surface.area(h) / 3.0;
    }
    (weights, mass)
}

fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

fn previous(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Intrinsic {
    fn new(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let proper = triangles.iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
        let corner: Vec<u32> = proper.flatten().copied().collect();
        let length = (0..corner.len())
            .map(|h| norm(&subtract(&points[corner[next(h)] as usize], &points[corner[h] as usize])))
            .collect();
        let mut sides: Vec<(u32, u32, usize)> = (0..corner.len())
            .map(|h| {
                let (a, b) = (corner[h], corner[next(h)]);
                (a.min(b), a.max(b), h)
            })
            .collect();
        sides.sort_unstable();
        let mut twin = vec![NONE; corner.len()];
        for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            if let [(_, _, g), (_, _, h)] = *edge
                && corner[g] == corner[next(h)]
            {
                twin[g] = h;
                twin[h] = g;
            }
        }
        Self { corner, length, twin }
    }

    /// Lengthens all edges by the least amount that gives every triangle inequality its margin; says by how much.
    fn mollify(&mut self) -> f64 {
        let n = self.length.len();
        if n == 0 {
            return 0.0;
        }
        let margin = MARGIN * self.length.iter().sum::<f64>() / n as f64;
        let lacking = |h: usize| margin + self.length[h] - self.length[next(h)] - self.length[previous(h)];
        let add = (0..n).map(lacking).fold(0.0, f64::max);
        self.length.iter_mut().for_each(|l| *l += add);
        add
    }

    /// Area of the triangle of side `h`, by Kahan's form of Heron's formula.
    fn area(&self, h: usize) -> f64 {
        let mut l = [self.length[h], self.length[next(h)], self.length[previous(h)]];
        l.sort_by(|x, y| y.total_cmp(x));
        let [a, b, c] = l;
        0.25 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).max(0.0).sqrt()
    }

    /// Cotangent of the angle opposite side `h`.
    fn cotangent(&self, h: usize) -> f64 {
        let (a, b, c) = (self.length[h], self.length[next(h)], self.length[previous(h)]);
        let area = self.area(h);
        if area > 0.0 { (b * b + c * c - a * a) / (4.0 * area) } else { 0.0 }
    }

    /// Flips until every edge that has two triangles is Delaunay; gives the number of flips.
    fn flip_all(&mut self) -> usize {
        let mut waiting: Vec<usize> = (0..self.corner.len()).collect();
        let mut is_waiting = vec![true; self.corner.len()];
        let most = MAX_FLIPS_PER_EDGE.saturating_mul(self.corner.len());
        let mut flips = 0;
        while let Some(h) = waiting.pop() {
            is_waiting[h] = false;
            let g = self.twin[h];
            if g == NONE || g / 3 == h / 3 || self.cotangent(h) + self.cotangent(g) >= ROUNDING {
                continue;
            }
            if flips == most || !self.flip(h, g) {
                continue;
            }
            flips += 1;
            let (t, u) = (h / 3 * 3, g / 3 * 3);
            for side in [t, t + 1, t + 2, u, u + 1, u + 2] {
                if !std::mem::replace(&mut is_waiting[side], true) {
                    waiting.push(side);
                }
            }
        }
        flips
    }

    /// Replaces the edge of sides `h` and `g` by the other diagonal of its two triangles; false where that has no length.
    fn flip(&mut self, h: usize, g: usize) -> bool {
        let (h1, h2, g1, g2) = (next(h), previous(h), next(g), previous(g));
        let (i, j, k, m) = (self.corner[h], self.corner[h1], self.corner[h2], self.corner[g2]);
        // Both triangles laid flat, the edge from (0, 0) to (l, 0), k above and m below.
        let l = self.length[h];
        let flat = |to_i: f64, to_j: f64| {
            let x = (to_i * to_i + l * l - to_j * to_j) / (2.0 * l);
            (x, (to_i * to_i - x * x).max(0.0).sqrt())
        };
        let (xk, yk) = flat(self.length[h2], self.length[h1]);
        let (xm, ym) = flat(self.length[g1], self.length[g2]);
        let diagonal = (xk - xm).hypot(yk + ym);
        if !(diagonal.is_finite() && diagonal > 0.0) {
            return false;
        }
        // Triangle of h becomes (m, j, k), triangle of g becomes (i, m, k).
        let (jk, ki, im, mj) = (h1, h2, g1, g2);
        let old = [jk, ki, im, mj].map(|s| (s, self.length[s], self.twin[s]));
        let (t, u) = (h / 3 * 3, g / 3 * 3);
        self.corner[t..t + 3].copy_from_slice(&[m, j, k]);
        self.corner[u..u + 3].copy_from_slice(&[i, m, k]);
        let place = |side: usize| match side {
            s if s == mj => t,
            s if s == jk => t + 1,
            s if s == im => u,
            _ => u + 2,
        };
        for &(side, length, _) in &old {
            self.length[place(side)] = length;
        }
        self.length[t + 2] = diagonal;
        self.length[u + 1] = diagonal;
        for &(side, _, twin) in &old {
            // A twin may be one of the four sides that have just moved.
            let twin = if old.iter().any(|o| o.0 == twin) { place(twin) } else { twin };
            self.twin[place(side)] = twin;
            if twin != NONE {
                self.twin[twin] = place(side);
            }
        }
        self.twin[t + 2] = u + 1;
        self.twin[u + 1] = t + 2;
        true
    }
}
