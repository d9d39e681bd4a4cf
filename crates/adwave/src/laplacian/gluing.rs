//! Gluing of triangle sides: on one sheet if the mesh is a surface, else on two.
//!
//! A mesh with an edge of three triangles, or of two with opposite orientation, is covered twice (`sharp2020`):
//! each triangle gets a front and a back, and around an edge the back of each is glued to the front of the next.
//! The cover is a closed oriented surface whatever the mesh, so its edges can be flipped until no weight is
//! negative. On a border, front is glued to back, which gives the natural boundary condition: nothing flows
//! through.

use super::triangulation::{NONE, Triangulation, next, previous};
use crate::parallel;
use crate::rows::Pattern;
use crate::vector::{Vector, add_scaled, cross, dot, norm, subtract};
use crate::{Cancelled, Progress};
use std::ops::Range;

/// Number of vertices whose edges a thread glues at a time.
const VERTICES_AT_A_TIME: usize = 1 << 11;

/// Properties of the edges of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GluedEdges {
    /// True if some edge has one triangle only.
    pub(super) has_border: bool,
    /// True if no edge has three triangles or more, or two that traverse it in the same direction.
    pub(super) is_manifold: bool,
    /// Mean length of the edges; 0 if there are none.
    pub(super) mean_length: f64,
}

/// A side and the far end of its edge, as seen from the lower end.
type SideAt = (u32, u32);

/// Sides of the edges whose lower end is `a`, by the far end; sides of one edge are adjacent.
fn sides_above(surface: &Triangulation, at_vertex: &Pattern, a: usize, sides: &mut Vec<SideAt>) {
    sides.clear();
    for &t in at_vertex.row(a) {
        for h in 3 * t as usize..3 * t as usize + 3 {
            let (from, to) = (surface.corner[h], surface.corner[next(h)]);
            if from.min(to) as usize == a {
                sides.push((from.max(to), h as u32));
            }
        }
    }
    sides.sort_unstable();
}

/// Glues the sides of every edge of two triangles that traverse it in opposite directions; the others stay free.
pub(super) fn glue_sheet(
    surface: &mut Triangulation,
    at_vertex: &Pattern,
    progress: Progress<'_>,
) -> Result<GluedEdges, Cancelled> {
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
            (pairs, GluedEdges { has_border, is_manifold, mean_length: total }, count)
        },
    )?;
    let mut edges = GluedEdges { has_border: false, is_manifold: true, mean_length: 0.0 };
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
    /// Side of the back that belongs to side `h` of the front; the front has `n` sides.
    fn back_side(h: usize, n: usize) -> usize {
        n + h - h % 3 + (2 - h % 3)
    }

    /// Adds a back to every triangle, with reversed orientation. Backs are glued like their fronts, and a free side
    /// to its own back.
    pub(super) fn double(self) -> Self {
        let n = self.n_sides();
        let Self { mut corner, mut length, mut twin, .. } = self;
        for t in (0..n).step_by(3) {
            corner.extend([corner[t], corner[t + 2], corner[t + 1]]);
            length.extend([length[t + 2], length[t + 1], length[t]]);
        }
        twin.resize(2 * n, NONE);
        for h in 0..n {
            let under = Self::back_side(h, n);
            match twin[h] {
                NONE => {
                    twin[h] = under as u32;
                    twin[under] = h as u32;
                }
                other => twin[under] = Self::back_side(other as usize, n) as u32,
            }
        }
        Self { corner, length, twin, angles: None }
    }
}

/// Closed double cover of triangles that are glued in any way; `surface` has no gluing.
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
                        sort_around_edge(shared, points, a, edge);
                    }
                    for (k, &(_, h)) in edge.iter().enumerate() {
                        let g = edge[(k + 1) % edge.len()].1;
                        // Glues the copy that starts at a to the copy of the next triangle that ends there.
                        let (up, _) = copies(shared, a, h as usize, n);
                        let (_, down) = copies(shared, a, g as usize, n);
                        pairs.push((up, down));
                    }
                }
            }
            pairs
        },
    )?;
    let mut cover = surface.double();
    for (up, down) in chunks.into_iter().flatten() {
        cover.twin[up as usize] = down;
        cover.twin[down as usize] = up;
    }
    Ok(cover)
}

/// The two copies of side `h` in the cover: the one that starts at `a` and the one that ends there.
fn copies(surface: &Triangulation, a: usize, h: usize, n: usize) -> (u32, u32) {
    let (front, back) = (h as u32, Triangulation::back_side(h, n) as u32);
    if surface.corner[h] as usize == a { (front, back) } else { (back, front) }
}

/// Sorts the sides of one edge by the angle of their triangles around it, so that neighboring sheets are glued.
fn sort_around_edge(surface: &Triangulation, points: &[[f64; 3]], a: usize, edge: &mut [SideAt]) {
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
