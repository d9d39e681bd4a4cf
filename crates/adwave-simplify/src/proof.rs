//! Bounds of the largest distance from a triangle to a surface, by branch and bound.
//!
//! For a convex piece P of the triangle and any triangle b of the surface,
//!
//! ```text
//! max over the corners and the center x of P of d(x, surface)
//!     ≤  max over P of d(·, surface)  ≤  max over the corners x of P of d(x, b)
//! ```
//!
//! The right side holds because the distance to a convex set is a convex function. A piece whose bounds are too far
//! apart is cut by the plane through an edge of b that is perpendicular to b: on the inner side b is a good bound, on
//! the outer side a neighbor of b. Two coplanar triangulations are thus compared exactly, by their common refinement.
//! If no such plane cuts the piece, it is halved.

use crate::geometry::{
    Point, center, cross, dot, doubled_normal, interpolate, length, minus, squared_distance,
};
use crate::surface::TriangleSearch;

/// Relative difference of the bounds at which a piece is not cut again.
pub(crate) const PROOF_TOLERANCE: f64 = 0.005;

/// Distance in the unit box that rounding may cause.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Distance in the unit box below which a corner of a piece counts as on a cutting plane.
const ON_PLANE: f64 = 1e-13;

/// Largest number of corners of a piece; pieces with more are cut along a diagonal.
const MAX_CORNERS: usize = 10;

/// Number of corners that a piece has room for: a cut adds one, rounding another.
const ROOM: usize = MAX_CORNERS + 2;

/// Bounds of the largest distance from a triangle to a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DistanceBounds {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

/// Condition under which bounds are close enough.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Distance up to which the upper bound need not be close to the lower bound.
    pub(crate) accepted: f64,
    /// Distance that must not lie between the bounds, if it is finite.
    pub(crate) limit: f64,
    /// Largest number of pieces.
    pub(crate) max_pieces: usize,
    /// True to stop as soon as a point beyond the limit is known.
    pub(crate) stops_beyond_limit: bool,
}

impl Goal {
    /// Creates the goal of deciding if all distances are at most a limit.
    pub(crate) fn decision(limit: f64, max_pieces: usize) -> Self {
        Self { accepted: limit, limit, max_pieces, stops_beyond_limit: true }
    }

    /// Largest upper bound of a piece that is not cut again.
    fn sufficient_bound(&self, lower: f64) -> f64 {
        let close = self.accepted.max(lower * (1.0 + PROOF_TOLERANCE) + ROUNDING);
        if lower <= self.limit { close.min(self.limit) } else { close }
    }
}

/// Convex planar polygon, a part of a triangle.
#[derive(Clone)]
struct Piece {
    n: usize,
    corners: [Point; ROOM],
    /// Triangle of the surface that is probably near.
    hint: Option<u32>,
}

impl Piece {
    fn new(points: &[Point], hint: Option<u32>) -> Self {
        let mut corners = [[0.0; 3]; ROOM];
        corners[..points.len()].copy_from_slice(points);
        Self { n: points.len(), corners, hint }
    }

    fn corners(&self) -> &[Point] {
        &self.corners[..self.n]
    }

    fn push(&mut self, p: Point) {
        self.corners[self.n] = p;
        self.n += 1;
    }

    /// Largest squared distance of a corner from a triangle; if it exceeds the squared distance `limit`, that of the
    /// first such corner.
    fn distance_to(&self, triangle: &[Point; 3], limit: f64) -> f64 {
        let mut greatest = 0.0_f64;
        for &p in self.corners() {
            greatest = greatest.max(squared_distance(p, triangle));
            if greatest > limit {
                break;
            }
        }
        greatest
    }

    /// Cuts the piece along a plane through `origin`; the normal points from the first part to the second.
    fn cut(&self, origin: Point, normal: Point) -> [Piece; 2] {
        let side = |p: Point| {
            let s = dot(minus(p, origin), normal);
            if s.abs() <= ON_PLANE { 0.0 } else { s }
        };
        let mut parts = [Self::new(&[], None), Self::new(&[], None)];
        let corners = self.corners();
        for (k, &p) in corners.iter().enumerate() {
            let q = corners[(k + 1) % self.n];
            let (s, t) = (side(p), side(q));
            if s <= 0.0 {
                parts[0].push(p);
            }
            if s >= 0.0 {
                parts[1].push(p);
            }
            if s * t < 0.0 {
                let on = interpolate(p, q, s / (s - t));
                parts[0].push(on);
                parts[1].push(on);
            }
        }
        parts
    }

    /// Cuts the piece by the perpendicular plane through the edge of a triangle beyond which the piece reaches
    /// farthest; `None` if no edge cuts it.
    fn cut_at_edges<T: TriangleSearch>(&self, near: u32, to: &T) -> Option<[Piece; 2]> {
        let triangle = to.corners(near);
        let normal = doubled_normal(*triangle);
        let mut best: Option<(f64, usize, Point)> = None;
        for k in 0..3 {
            let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
            let outward = cross(minus(to, from), normal);
            let norm = length(outward);
            if norm.is_nan() || norm <= 0.0 {
                continue;
            }
            let outward = outward.map(|x| x / norm);
            let (mut least, mut greatest) = (0.0_f64, 0.0_f64);
            for &p in self.corners() {
                let s = dot(minus(p, from), outward);
                least = least.min(s);
                greatest = greatest.max(s);
            }
            if least < -ON_PLANE && greatest > ON_PLANE && best.is_none_or(|b| greatest > b.0) {
                best = Some((greatest, k, outward));
            }
        }
        let (_, k, outward) = best?;
        let [mut inside, mut outside] = self.cut(triangle[k], outward);
        inside.hint = Some(near);
        outside.hint = to.neighbor_across(near, k);
        Some([outside, inside])
    }

    /// Cuts the piece across its longest diagonal or edge; `None` for a piece as small as rounding.
    fn halve(&self) -> Option<[Piece; 2]> {
        let corners = self.corners();
        let (mut longest, mut ends) = (ON_PLANE * 4.0, None);
        for (k, &p) in corners.iter().enumerate() {
            for &q in &corners[k + 1..] {
                let distance = length(minus(p, q));
                if distance > longest {
                    (longest, ends) = (distance, Some((p, q)));
                }
            }
        }
        let (p, q) = ends?;
        let along = minus(q, p).map(|x| x / longest);
        Some(self.cut(interpolate(p, q, 0.5), along))
    }

    /// Cuts the piece along a diagonal, without new corners.
    fn cut_at_diagonal(&self) -> [Piece; 2] {
        let middle = self.n / 2;
        let mut second = Self::new(&self.corners[middle..self.n], self.hint);
        second.push(self.corners[0]);
        [Self::new(&self.corners[..=middle], self.hint), second]
    }
}

/// Bounds the largest distance from a triangle to a surface. `use_triangle` is called with each triangle of the surface
/// that gives the upper bound of a piece; `hints` are triangles that are probably near.
///
/// Once `max_pieces` is reached, the upper bound is that of the remaining pieces: valid, but not close. Costs O(pieces
/// log triangles).
pub(crate) fn bound_distance<T: TriangleSearch>(
    triangle: [Point; 3],
    hints: &[u32],
    to: &T,
    goal: &Goal,
    use_triangle: &mut dyn FnMut(u32),
) -> DistanceBounds {
    let first = Piece::new(&triangle, hints.first().copied());
    let mut bounds = DistanceBounds { lower: 0.0, upper: 0.0 };
    let square = |x: f64| x * x;
    for &hint in hints {
        let sufficient = goal.sufficient_bound(0.0);
        let distance = first.distance_to(to.corners(hint), square(sufficient));
        if distance <= square(sufficient) {
            use_triangle(hint);
            return DistanceBounds { lower: 0.0, upper: distance.sqrt() };
        }
    }
    let mut n_pieces = 0;
    let mut pieces = vec![first];
    while let Some(piece) = pieces.pop() {
        n_pieces += 1;
        let middle = center(piece.corners());
        let (mut upper, mut by) = (f64::INFINITY, 0);
        let known = piece.hint.map(|hint| to.descend(middle, hint));
        if let Some((distance, near)) = known {
            let sufficient = goal.sufficient_bound(bounds.lower);
            (upper, by) = (piece.distance_to(to.corners(near), f64::INFINITY).sqrt(), near);
            if upper <= sufficient {
                bounds.upper = bounds.upper.max(upper);
                use_triangle(by);
                continue;
            }
            // A triangle near enough may cut the piece even if another one is nearer.
            let may_cut = distance <= square(sufficient) && piece.n < MAX_CORNERS;
            if may_cut
                && n_pieces + pieces.len() < goal.max_pieces
                && let Some(parts) = piece.cut_at_edges(near, to)
            {
                pieces.extend(parts.into_iter().filter(|part| part.n >= 3));
                continue;
            }
        }
        let cutoff = if goal.stops_beyond_limit { square(goal.limit) * (1.0 + 1e-9) } else { f64::INFINITY };
        let known = known.filter(|near| near.0 < cutoff);
        let nearer = to.nearest_within(middle, known.map_or(cutoff, |near| near.0));
        let Some((distance, near)) = nearer.or(known) else {
            return DistanceBounds { lower: goal.limit, upper: f64::INFINITY };
        };
        bounds.lower = bounds.lower.max(distance.sqrt());
        let by_near = piece.distance_to(to.corners(near), f64::INFINITY).sqrt();
        if by_near < upper {
            (upper, by) = (by_near, near);
        }
        let is_beyond = bounds.lower > goal.limit && goal.stops_beyond_limit;
        let is_close = upper <= goal.sufficient_bound(bounds.lower);
        let parts = if is_close || is_beyond || n_pieces + pieces.len() >= goal.max_pieces {
            None
        } else {
            divide(&piece, near, to, &mut bounds)
        };
        if let Some(parts) = parts {
            pieces.extend(parts.into_iter().filter(|part| part.n >= 3));
        } else {
            bounds.upper = bounds.upper.max(upper);
            use_triangle(by);
        }
        if is_beyond {
            bounds.upper = f64::INFINITY;
            break;
        }
    }
    bounds
}

/// Cuts a piece whose bounds are too far apart; `None` if the piece is as small as rounding.
fn divide<T: TriangleSearch>(
    piece: &Piece,
    near: u32,
    to: &T,
    bounds: &mut DistanceBounds,
) -> Option<[Piece; 2]> {
    if piece.n >= MAX_CORNERS {
        return Some(piece.cut_at_diagonal());
    }
    if let Some(parts) = piece.cut_at_edges(near, to) {
        return Some(parts);
    }
    let triangle = to.corners(near);
    // The corner farthest from the triangle is beyond the distance at the center, or nearer to another triangle.
    let farthest = piece
        .corners()
        .iter()
        .map(|&p| (squared_distance(p, triangle), p))
        .fold((0.0, piece.corners[0]), |best, at| if at.0 > best.0 { at } else { best });
    bounds.lower = bounds.lower.max(to.nearest(farthest.1).0.sqrt());
    piece.halve().map(|parts| parts.map(|part| Piece { hint: Some(near), ..part }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::TriangleSurface;

    fn goal() -> Goal {
        Goal { accepted: 0.0, limit: f64::INFINITY, max_pieces: 100_000, stops_beyond_limit: false }
    }

    #[test]
    fn a_triangle_over_a_finer_coplanar_grid_is_at_distance_0_in_few_pieces() {
        let side = 41_u32;
        let points: Vec<Point> = (0..side * side)
            .map(|k| [f64::from(k % side) / 40.0, f64::from(k / side) / 40.0, 0.25])
            .collect();
        let cell = |k: u32| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]];
        let triangles: Vec<[u32; 3]> =
            (0..side * (side - 1)).filter(|k| k % side < side - 1).flat_map(cell).collect();
        let surface = TriangleSurface::new(&points, &triangles).unwrap();
        let mut n_pieces = 0;
        let triangle = [[0.013, 0.021, 0.25], [0.97, 0.11, 0.25], [0.31, 0.93, 0.25]];
        let bounds = bound_distance(triangle, &[], &surface, &goal(), &mut |_| n_pieces += 1);
        assert!(bounds.upper < 1e-12, "{bounds:?}");
        // The triangle covers about 1300 triangles of the grid.
        assert!(n_pieces < 8000, "{n_pieces}");
    }

    #[test]
    fn the_distance_in_the_middle_of_a_long_triangle_is_found() {
        // A long triangle over a gap between two plates: the middle is 0.5 from both.
        let plate = |x: f64| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 1.0, 1.0, 0.0], [x, 1.0, 0.0]];
        let points: Vec<Point> = [plate(0.0), plate(2.0)].concat();
        let surface = TriangleSurface::new(&points, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]).unwrap();
        let triangle = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0]];
        let bounds = bound_distance(triangle, &[], &surface, &goal(), &mut |_| {});
        assert!(bounds.lower <= 0.5 && bounds.upper >= 0.5 && bounds.upper < 0.5 * 1.01, "{bounds:?}");
        let decided = bound_distance(triangle, &[], &surface, &Goal::decision(0.4, 1000), &mut |_| {});
        assert!(decided.upper > 0.4, "{decided:?}");
        let decided = bound_distance(triangle, &[], &surface, &Goal::decision(0.51, 10_000), &mut |_| {});
        assert!(decided.upper <= 0.51, "{decided:?}");
    }
}
