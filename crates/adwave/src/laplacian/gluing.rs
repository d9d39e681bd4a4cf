//! Which side of a triangle continues in which: on one sheet where the mesh is a surface, else on two.
//!
//! A mesh in which some edge has three triangles, or two of opposite orientation, is covered twice (`sharp2020`): each
//! triangle gets a front and a back, and around an edge the back of each is glued to the front of the next. The cover is a
//! closed oriented surface whatever the mesh, so its edges can be flipped until no weight is negative. On a border front is
//! glued to back, which is the natural border of a function: nothing flows through.

use super::triangulation::{NONE, Triangulation, next, previous};
use crate::parallel;
use crate::rows::Pattern;
use crate::vector::{Vector, add_scaled, cross, dot, norm, subtract};
use crate::{Cancelled, Progress};
use std::ops::Range;

/// Vertices whose edges a thread glues at a time.
const VERTICES_AT_A_TIME: usize = 1 << 11;

/// What the edges of a mesh are like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edges {
    /// Whether some edge has one triangle only.
    pub(super) has_border: bool,
    /// Whether no edge has three triangles or more, or two that run through it the same way.
    pub(super) is_manifold: bool,
    /// Mean length of the edges; 0 where there is none.
    pub(super) mean_length: f64,
}

/// A side and the far end of its edge, as seen from the lower end.
type SideAt = (u32, u32);

/// The sides of the edges whose lower end is `a`, by the far end; the same edge's side by side.
fn sides_above(surface: &Triangulation, at_vertex: &Pattern, a: usize, sides: &mut Vec<SideAt>) {
    sides.clear();
    for &t in at_vertex.of(a) {
        for h in 3 * t as usize..3 * t as usize + 3 {
            let (from, to) = (surface.corner[h], surface.corner[next(h)]);
            if from.min(to) as usize == a {
                sides.push((from.max(to), h as u32));
            }
        }
    }
    sides.sort_unstable();
}

/// Glues the sides of every edge of two triangles that run through it in opposite directions; the others stay free.
pub(super) fn glue_sheet(
    surface: &mut Triangulation,
    at_vertex: &Pattern,
    progress: Progress<'_>,
) -> Result<Edges, Cancelled> {
    let shared = &*surface;
    let chunks = parallel::try_map_chunks(
        at_vertex.n_rows(),
        VERTICES_AT_A_TIME,
        progress,
        Vec::new,
        |sides: &mut Vec<SideAt>, range: Range<usize>| {
            let (mut has_border, mut is_manifold) = (false, true);
            let (mut total, mut count) = (0.0, 0_usize);
            let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(3 * range.len());
            for a in range {
                sides_above(shared, at_vertex, a, sides);
                for edge in sides.chunk_by(|g, h| g.0 == h.0) {
                    total += shared.length[edge[0].1 as usize];
                    count += 1;
                    match *edge {
                        [_] => has_border = true,
                        [(_, g), (_, h)] if shared.corner[g as usize] != shared.corner[h as usize] => {
                            pairs.push((g, h));
                        }
                        _ => is_manifold = false,
                    }
                }
            }
            (pairs, Edges { has_border, is_manifold, mean_length: total }, count)
        },
    )?;
    let mut edges = Edges { has_border: false, is_manifold: true, mean_length: 0.0 };
    let mut n_edges = 0;
    for (pairs, seen, count) in chunks {
        edges.has_border |= seen.has_border;
        edges.is_manifold &= seen.is_manifold;
        edges.mean_length += seen.mean_length;
        n_edges += count;
        for (g, h) in pairs {
            surface.twin[g as usize] = h;
            surface.twin[h as usize] = g;
        }
    }
    edges.mean_length /= n_edges.max(1) as f64;
    Ok(edges)
}

impl Triangulation {
    /// The side of the back that lies under side `h` of the front, where the front has `n` sides.
    fn under(h: usize, n: usize) -> usize {
        n + h - h % 3 + (2 - h % 3)
    }

    /// A back for every triangle, run through the other way; backs are glued as their fronts are, and a free side to its own
    /// back.
    pub(super) fn doubled(self) -> Self {
        let n = self.n_sides();
        let Self { mut corner, mut length, mut twin } = self;
        for t in (0..n).step_by(3) {
            corner.extend([corner[t], corner[t + 2], corner[t + 1]]);
            length.extend([length[t + 2], length[t + 1], length[t]]);
        }
        twin.resize(2 * n, NONE);
        for h in 0..n {
            let under = Self::under(h, n);
            match twin[h] {
                NONE => {
                    twin[h] = under as u32;
                    twin[under] = h as u32;
                }
                other => twin[under] = Self::under(other as usize, n) as u32,
            }
        }
        Self { corner, length, twin }
    }
}

/// The closed double cover of triangles that are glued in any way; `surface` is glued to nothing.
pub(super) fn cover(
    surface: Triangulation,
    points: &[[f64; 3]],
    at_vertex: &Pattern,
    progress: Progress<'_>,
) -> Result<Triangulation, Cancelled> {
    let n = surface.n_sides();
    let shared = &surface;
    let chunks = parallel::try_map_chunks(
        at_vertex.n_rows(),
        VERTICES_AT_A_TIME,
        progress,
        Vec::new,
        |sides: &mut Vec<SideAt>, range: Range<usize>| {
            let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(6 * range.len());
            for a in range {
                sides_above(shared, at_vertex, a, sides);
                for edge in sides.chunk_by_mut(|g, h| g.0 == h.0) {
                    if edge.len() > 2 {
                        around(shared, points, a, edge);
                    }
                    for (k, &(_, h)) in edge.iter().enumerate() {
                        let g = edge[(k + 1) % edge.len()].1;
                        // The copy that runs up, from a, with the next triangle's copy that runs down.
                        let (up, _) = copies(shared, a, h as usize, n);
                        let (_, down) = copies(shared, a, g as usize, n);
                        pairs.push((up, down));
                    }
                }
            }
            pairs
        },
    )?;
    let mut cover = surface.doubled();
    for (up, down) in chunks.into_iter().flatten() {
        cover.twin[up as usize] = down;
        cover.twin[down as usize] = up;
    }
    Ok(cover)
}

/// Of the two copies of side `h` in the cover, the one that runs from `a` and the one that runs to it.
fn copies(surface: &Triangulation, a: usize, h: usize, n: usize) -> (u32, u32) {
    let (front, back) = (h as u32, Triangulation::under(h, n) as u32);
    if surface.corner[h] as usize == a { (front, back) } else { (back, front) }
}

/// Sorts the sides of one edge by the direction in which their triangles lie around it, so that neighboring sheets are glued.
fn around(surface: &Triangulation, points: &[[f64; 3]], a: usize, edge: &mut [SideAt]) {
    let axis = subtract(&points[edge[0].0 as usize], &points[a]);
    let apex = |h: u32| -> Vector {
        let apex = surface.corner[previous(h as usize)];
        let d = subtract(&points[apex as usize], &points[a]);
        let along = dot(&axis, &axis);
        if along > 0.0 { add_scaled(&d, -dot(&d, &axis) / along, &axis) } else { d }
    };
    let first = apex(edge[0].1);
    let across = cross(&axis, &first);
    let scale = norm(&axis);
    let angle = |h: u32| {
        let d = apex(h);
        let angle = dot(&d, &across).atan2(dot(&d, &first) * scale);
        if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
    };
    let mut by_angle: Vec<(f64, u32, SideAt)> =
        edge.iter().map(|&side| (angle(side.1), surface.corner[previous(side.1 as usize)], side)).collect();
    by_angle.sort_by(|g, h| g.0.total_cmp(&h.0).then((g.1, g.2).cmp(&(h.1, h.2))));
    for (slot, (_, _, side)) in edge.iter_mut().zip(by_angle) {
        *slot = side;
    }
}
