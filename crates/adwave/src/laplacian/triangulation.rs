//! Triangles given by side lengths and glued side to side, without positions, for intrinsic geometry.

use super::turning::SideAngles;
use crate::parallel;
use crate::rows::{Pattern, incidence};
use crate::vector::{norm, subtract};
use crate::{Cancelled, Progress};
use std::ops::Range;

/// Twin of a side that is not glued.
pub(super) const NONE: u32 = u32::MAX;

/// Margin of each triangle inequality relative to the mean side, a million times larger than rounding.
const MARGIN: f64 = 1e-10;

/// Cotangent sums above this value count as Delaunay.
const ROUNDING: f64 = -1e-10;

/// Cap on the number of flips per side: a handful is usual, and the known bound is quadratic.
const MAX_FLIPS_PER_SIDE: usize = 100;

/// Number of sides, triangles or flips between two checks for cancellation.
const AT_A_TIME: usize = 1 << 13;

/// Triangles; side `s` of triangle `t` has number `3t + s` and runs from corner `s` to corner `s + 1`.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangulation {
    pub(super) corner: Vec<u32>,
    pub(super) length: Vec<f64>,
    /// Twin of each side, which runs in the opposite direction.
    pub(super) twin: Vec<u32>,
    /// Angles of the sides in the tangent planes, if directions are wanted; flips keep them up to date.
    pub(super) angles: Option<SideAngles>,
}

/// Next side of the triangle of `h`.
pub(super) fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// Previous side of the triangle of `h`.
pub(super) fn previous(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Triangulation {
    /// Builds the triangles with three different corners, without gluing.
    pub(super) fn new(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let proper = |t: &&[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        let corner: Vec<u32> = triangles.iter().filter(proper).flatten().copied().collect();
        let length = parallel::try_collect(corner.len(), progress, |h| {
            norm(&subtract(&points[corner[next(h)] as usize], &points[corner[h] as usize]))
        })?;
        let twin = vec![NONE; corner.len()];
        Ok(Self { corner, length, twin, angles: None })
    }

    pub(super) fn n_sides(&self) -> usize {
        self.corner.len()
    }

    /// The triangles at each vertex.
    pub(super) fn triangles_at_vertices(
        &self,
        n: usize,
        progress: Progress<'_>,
    ) -> Result<Pattern, Cancelled> {
        incidence(n, self.n_sides() / 3, progress, |t| &self.corner[3 * t..3 * t + 3])
    }

    /// Lengthens all sides by the smallest amount that gives every triangle inequality its margin, and returns that
    /// amount (`sharp2020`).
    pub(super) fn mollify(&mut self, progress: Progress<'_>) -> Result<f64, Cancelled> {
        let n = self.n_sides();
        if n == 0 {
            return Ok(0.0);
        }
        let length = &self.length;
        let margin = MARGIN * parallel::try_sum(n, progress, |h| length[h])? / n as f64;
        let lacking = |h: usize| margin + length[h] - length[next(h)] - length[previous(h)];
        let add = parallel::max(n, 0.0, lacking);
        if add > 0.0 {
            parallel::try_visit_rows(&mut self.length, 1, AT_A_TIME, progress, |_, lengths| {
                for l in lengths {
                    *l += add;
                }
            })?;
        }
        Ok(add)
    }

    /// Area of the triangle of side `h`, by Kahan's stable form of Heron's formula.
    pub(super) fn area(&self, h: usize) -> f64 {
        let t = h - h % 3;
        let [l0, l1, l2] = [self.length[t], self.length[t + 1], self.length[t + 2]];
        let (longer, shorter) = (l0.max(l1), l0.min(l1));
        let (a, b, c) = (longer.max(l2), longer.min(l2).max(shorter), shorter.min(l2));
        0.25 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).max(0.0).sqrt()
    }

    /// Cotangent of the angle opposite side `h`; 0 if the triangle has no area.
    pub(super) fn cotangent(&self, h: usize) -> f64 {
        let (a, b, c) = (self.length[h], self.length[next(h)], self.length[previous(h)]);
        let area = self.area(h);
        if area > 0.0 { (b * b + c * c - a * a) / (4.0 * area) } else { 0.0 }
    }

    /// True if the edge of side `h` must be flipped: its two opposite angles sum to more than π.
    fn is_to_flip(&self, h: usize) -> bool {
        let g = self.twin[h];
        // An edge between a triangle and itself cannot be flipped; it is opposite two angles of one triangle.
        g != NONE && g as usize / 3 != h / 3 && self.cotangent(h) + self.cotangent(g as usize) < ROUNDING
    }

    /// Flips edges until every glued edge is Delaunay (`bobenko2007`); returns the number of flips.
    pub(super) fn flip_to_delaunay(&mut self, progress: Progress<'_>) -> Result<usize, Cancelled> {
        let this = &*self;
        let found = parallel::try_map_chunks(
            self.n_sides(),
            AT_A_TIME,
            progress,
            || (),
            |(), range: Range<usize>| {
                let first_of_edge = |&h: &usize| (h as u32) < this.twin[h] && this.is_to_flip(h);
                range.filter(first_of_edge).map(|h| h as u32).collect::<Vec<u32>>()
            },
        )?;
        let mut waiting = found.concat();
        waiting.reverse();
        let mut is_waiting = vec![false; self.n_sides()];
        for &h in &waiting {
            is_waiting[h as usize] = true;
        }
        let most = MAX_FLIPS_PER_SIDE.saturating_mul(self.n_sides());
        let mut flips = 0_usize;
        while let Some(h) = waiting.pop() {
            let h = h as usize;
            is_waiting[h] = false;
            if !self.is_to_flip(h) || flips == most || !self.flip(h) {
                continue;
            }
            flips += 1;
            if flips.is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            let t = h - h % 3;
            let u = self.twin[t + 2] as usize - 1; // the new edge is side 1 of the other triangle
            for side in [t, u].into_iter().flat_map(|first| first..first + 3) {
                let edge = side.min(self.twin[side] as usize);
                if edge < self.n_sides() && !std::mem::replace(&mut is_waiting[edge], true) {
                    waiting.push(edge as u32);
                }
            }
        }
        Ok(flips)
    }

    /// Replaces the edge of side `h` by the other diagonal of its two triangles; returns false if that has no
    /// length. The new edge is side 2 of the triangle of `h` and side 1 of the other.
    fn flip(&mut self, h: usize) -> bool {
        let g = self.twin[h] as usize;
        let (h1, h2, g1, g2) = (next(h), previous(h), next(g), previous(g));
        let (i, j, k, m) = (self.corner[h], self.corner[h1], self.corner[h2], self.corner[g2]);
        // Both triangles in the plane, the edge from (0, 0) to (l, 0), k above and m below.
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
        // The triangle of h becomes (m, j, k), that of g becomes (i, m, k).
        let (jk, ki, im, mj) = (h1, h2, g1, g2);
        let angle = |s: usize| self.angles.as_ref().map_or(0.0, |angles| angles.angle[s]);
        let old = [jk, ki, im, mj].map(|s| (s, self.length[s], self.twin[s], angle(s)));
        let (t, u) = (h - h % 3, g - g % 3);
        self.corner[t..t + 3].copy_from_slice(&[m, j, k]);
        self.corner[u..u + 3].copy_from_slice(&[i, m, k]);
        let place = |side: usize| match side {
            s if s == mj => t,
            s if s == jk => t + 1,
            s if s == im => u,
            _ => u + 2,
        };
        for &(side, length, twin, angle) in &old {
            let now = place(side);
            self.length[now] = length;
            if let Some(angles) = &mut self.angles {
                angles.angle[now] = angle;
            }
            // A twin may be one of the four sides that move.
            let moves_too = old.iter().any(|o| o.0 as u32 == twin);
            let twin = if moves_too { place(twin as usize) as u32 } else { twin };
            self.twin[now] = twin;
            if twin != NONE {
                self.twin[twin as usize] = now as u32;
            }
        }
        self.length[t + 2] = diagonal;
        self.length[u + 1] = diagonal;
        self.twin[t + 2] = (u + 1) as u32;
        self.twin[u + 1] = (t + 2) as u32;
        self.turn_flipped(t, u);
        true
    }
}

impl Triangulation {
    /// True if a free side is opposite an obtuse angle.
    pub(super) fn has_obtuse_border(&self, progress: Progress<'_>) -> Result<bool, Cancelled> {
        let is_obtuse = |h: usize| self.twin[h] == NONE && 2.0 * self.cotangent(h) < ROUNDING;
        let found = parallel::try_map_chunks(
            self.n_sides(),
            AT_A_TIME,
            progress,
            || (),
            |(), mut range| range.any(is_obtuse),
        )?;
        Ok(found.contains(&true))
    }
}
