//! Laplacian of a point cloud, from the Voronoi cell of each point in its tangent plane.
//!
//! In a plane the cotangent weight of a Delaunay edge is the length of its dual Voronoi edge divided by its own,
//! and that edge is known from the neighbors of one end alone. So each point has its own weights, and the two
//! weights of a pair are averaged. Four points on a circle, as on every grid, have a Voronoi edge of length 0
//! between opposite points, however the tie is broken; triangulations of the neighborhoods (`sharp2020`) have the
//! same weights but would have to agree on ties.

use super::{Laplacian, LaplacianInfo};
use crate::parallel;
use crate::rows::{CompressedRows, rows_at_a_time};
use crate::shape::{Neighborhoods, tangent_plane};
use crate::vector::{dot, norm, subtract};
use crate::{Cancelled, Progress};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering};

/// Largest extent of a cell relative to the distance of the last neighbor. Emptier space is a hole or lies beyond
/// the border.
const FILLED: f64 = 0.75;

/// Number of corners of the polygon that represents the disc around a point before bisectors cut it.
const DISC_CORNERS: usize = 24;

/// Marks a side of a cell that lies on the disc instead of a bisector.
const DISC: u32 = u32::MAX;

/// Height above the tangent plane, relative to the distance, beyond which a neighbor is on another sheet.
const STEEP: f64 = 0.8;

/// A corner of a cell, and the neighbor whose bisector contains the side from here to the next corner.
#[derive(Clone, Copy, Debug)]
struct CellCorner {
    at: [f64; 2],
    side: u32,
}

/// Weights and masses of a cloud, in units of `points`; `near` must hold enough neighbors to close a cell.
pub(super) fn laplacian(
    points: &[[f64; 3]],
    near: &Neighborhoods,
    progress: Progress<'_>,
) -> Result<Laplacian, Cancelled> {
    let n = points.len();
    let masses: Vec<AtomicU64> = (0..n).map(|_| AtomicU64::new(0)).collect();
    let row = |scratch: &mut CellScratch, x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
        let area = scratch.cell(points, near.adjacency.row(x), x, FILLED * near.radius[x]);
        masses[x].store(area.to_bits(), Ordering::Relaxed);
        scratch.weights.sort_unstable_by_key(|w| w.0);
        columns.extend(scratch.weights.iter().map(|w| w.0));
        weights.extend(scratch.weights.iter().map(|w| w.1));
    };
    let one_sided = CompressedRows::from_rows(n, rows_at_a_time(n), progress, CellScratch::default, row)?;
    let mass = masses.into_iter().map(|m| f64::from_bits(m.into_inner())).collect();
    let pattern = one_sided.pattern().union_with_transpose(progress)?;
    let row = |(): &mut (), x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
        for &y in pattern.row(x) {
            // The smaller end first, so that both rows have the same bits.
            let (low, high) = (x.min(y as usize), x.max(y as usize));
            columns.push(y);
            weights.push(0.5 * (one_sided.get(low, high) + one_sided.get(high, low)));
        }
    };
    let weights = CompressedRows::from_rows(n, rows_at_a_time(n), progress, || (), row)?;
    let total = parallel::try_sum(n, progress, |x| {
        weights.row(x).0.iter().map(|&y| norm(&subtract(&points[x], &points[y as usize]))).sum()
    })?;
    let mean_length = total / weights.nnz().max(1) as f64;
    Ok(Laplacian { weights, mass, unit: 1.0, mean_length, area_unit: 1.0, info: LaplacianInfo::default() })
}

/// Memory that a thread reuses for every point.
#[derive(Default)]
struct CellScratch {
    offsets: Vec<(f64, [f64; 2], u32)>,
    cell: Vec<CellCorner>,
    clipped: Vec<CellCorner>,
    weights: Vec<(u32, f64)>,
}

impl CellScratch {
    /// Weights of `x` to its neighbors, `ℓ/d` for a side of length ℓ on the bisector with a neighbor at distance d,
    /// and the area of its cell within `radius`.
    fn cell(&mut self, points: &[[f64; 3]], near: &[u32], x: usize, radius: f64) -> f64 {
        self.weights.clear();
        if radius == 0.0 {
            return 0.0;
        }
        let (u, v) = tangent_plane(points, near, x, radius);
        self.offsets.clear();
        for &y in near {
            let d = subtract(&points[y as usize], &points[x]).map(|c| c / radius);
            let (flat, length) = ([dot(&d, &u), dot(&d, &v)], norm(&d));
            let across = flat[0].hypot(flat[1]);
            // The distance in space is used in the plane, because it is closer to the distance along the surface.
            if length > 0.0 && across > (1.0 - STEEP * STEEP).sqrt() * length {
                self.offsets.push((length, flat.map(|c| c * length / across), y));
            }
        }
        self.offsets.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        self.cell.clear();
        self.cell.extend((0..DISC_CORNERS).map(|k| {
            let angle = TAU * k as f64 / DISC_CORNERS as f64;
            CellCorner { at: [angle.cos(), angle.sin()], side: DISC }
        }));
        let mut outermost = 1.0_f64;
        for &(length, q, y) in &self.offsets {
            if 0.5 * length >= outermost {
                break;
            }
            clip(&self.cell, q, y, &mut self.clipped);
            std::mem::swap(&mut self.cell, &mut self.clipped);
            outermost = self.cell.iter().map(|c| c.at[0].hypot(c.at[1])).fold(0.0, f64::max);
        }
        let mut area = 0.0;
        for k in 0..self.cell.len() {
            let side = self.cell[k].side;
            let Some(&(length, q, _)) = self.offsets.iter().find(|o| o.2 == side && side != DISC) else {
                continue;
            };
            let n = self.cell.len();
            let before = self.cell[(k + n - 1) % n].side;
            let (from, to) = (self.cell[k].at, self.cell[(k + 1) % n].at);
            let after = self.cell[(k + 1) % n].side;
            // Along the bisector, from the midpoint of both points.
            let along = |p: [f64; 2]| (p[1] * q[0] - p[0] * q[1]) / length;
            let (mut start, mut end) = (along(from), along(to));
            // The triangle between the point and a side has height d/2; points on a line have sides open at both
            // ends, which give a rectangle.
            let mut share = 0.5;
            // On a border the cell is open; the side ends at the midpoint, as in the triangle on the inner side.
            match (before == DISC, after == DISC) {
                (true, false) => start = 0.0,
                (false, true) => end = 0.0,
                (true, true) => share = 1.0,
                (false, false) => {}
            }
            let weight = (end - start) / length;
            if weight > 0.0 {
                self.weights.push((side, weight));
                area += share * 0.5 * weight * length * length;
            }
        }
        area * radius * radius
    }
}

/// Part of a convex counter-clockwise polygon that is closer to 0 than to `q`.
fn clip(polygon: &[CellCorner], q: [f64; 2], y: u32, kept: &mut Vec<CellCorner>) {
    kept.clear();
    let half = 0.5 * (q[0] * q[0] + q[1] * q[1]);
    let beyond = |p: &[f64; 2]| p[0] * q[0] + p[1] * q[1] - half;
    for (k, corner) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        let (here, there) = (beyond(&corner.at), beyond(&next.at));
        let crossing = || {
            let t = here / (here - there);
            [0, 1].map(|c| corner.at[c] + t * (next.at[c] - corner.at[c]))
        };
        match (here <= 0.0, there <= 0.0) {
            (true, true) => kept.push(*corner),
            (true, false) => {
                kept.push(*corner);
                kept.push(CellCorner { at: crossing(), side: y });
            }
            (false, true) => kept.push(CellCorner { at: crossing(), side: corner.side }),
            (false, false) => {}
        }
    }
}
