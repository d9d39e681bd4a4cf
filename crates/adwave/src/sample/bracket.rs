//! The bracket: a machined part with sharp edges, a drilled hole, a rounded edge, a fillet, a thick and a thin
//! part.
//!
//! Its outline is drawn in a plane and extruded through the depth. Both faces and all walls are cut into four-sided
//! patches ([`Weave`]), so that every sharp edge is a line of mesh edges and all triangles have about the same
//! size.

use super::implicit::V3;
use super::weave::{Turn, Weave, count_rows, count_segments};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Right end of the flange; the thick block is a unit square. Model units.
const LENGTH: f64 = 2.2;
/// Depth of the part, model units.
const DEPTH: f64 = 0.8;
/// Thickness of the flange, model units.
pub(super) const FLANGE: f64 = 0.12;
/// Radii of the fillet between block and flange, of the block's rounded edge, of the hole; model units.
const FILLET: f64 = 0.25;
const ROUNDING: f64 = 0.3;
const HOLE: f64 = 0.25;
/// Position at which the cut between block and flange meets the bottom, model units. The cut is slanted, because
/// the fillet leaves the block along its side, and a straight cut would give slivers.
const FOOT: f64 = 0.7;
/// Center of the hole, model units.
const MIDDLE: [f64; 2] = [0.5, 0.5];
/// Smallest number of vertices for which the hole is round.
pub(super) const MIN_VERTICES: usize = 300;
/// Number of vertices times the squared edge, model units: area · 2/√3, with some allowance for row ends. Only a
/// first guess.
const FIRST_GUESS: f64 = 9.2;
/// Maximal number of edge lengths tried to meet the count, and the required accuracy.
const MAX_TRIES: usize = 36;
const STEERED: usize = 6;
/// Step of the edge length once it is no longer steered.
const STEP: f64 = 0.004;
const COUNT_TOLERANCE: f64 = 0.005;

/// Volume of the exact solid, model units³: area of the outline times the depth.
#[cfg(test)]
pub(super) fn volume() -> f64 {
    let corner = 1.0 - 0.25 * PI;
    let block = 1.0 - corner * ROUNDING * ROUNDING - PI * HOLE * HOLE;
    DEPTH * (block + corner * FILLET * FILLET + (LENGTH - 1.0) * FLANGE)
}

/// A piece of the outline from one point of the plane to another, straight or around a center.
#[derive(Clone, Copy, Debug)]
enum OutlinePiece {
    Line([f64; 2], [f64; 2]),
    /// Center, radius, angles at both ends.
    Arc([f64; 2], f64, [f64; 2]),
}

impl OutlinePiece {
    /// Length in model units.
    fn length(&self) -> f64 {
        match *self {
            Self::Line(a, b) => (b[0] - a[0]).hypot(b[1] - a[1]),
            Self::Arc(_, radius, [from, to]) => radius * (to - from).abs(),
        }
    }

    /// Point at the fraction t ∈ [0, 1] of the length.
    fn point(&self, t: f64) -> [f64; 2] {
        match *self {
            Self::Line(a, b) => interpolate(a, b, t),
            Self::Arc(center, radius, [from, to]) => {
                let (sin, cos) = (from * (1.0 - t) + to * t).sin_cos();
                [center[0] + radius * cos, center[1] + radius * sin]
            }
        }
    }
}

/// Outline of the block, counter-clockwise from the lower left, and the piece of the hole inside each.
fn block() -> Vec<(OutlinePiece, OutlinePiece)> {
    let (top, left) = (FLANGE + FILLET, 1.0 - ROUNDING);
    let corners = [[0.0, 0.0], [FOOT, 0.0], [1.0, top], [1.0, 1.0], [ROUNDING, 1.0], [0.0, left]];
    let mut angles = corners.map(|p| (p[1] - MIDDLE[1]).atan2(p[0] - MIDDLE[0]));
    for k in 1..angles.len() {
        if angles[k] < angles[k - 1] {
            angles[k] += TAU;
        }
    }
    (0..corners.len())
        .map(|k| {
            let next = (k + 1) % corners.len();
            let outer = if k == 4 {
                OutlinePiece::Arc([ROUNDING, left], ROUNDING, [FRAC_PI_2, PI])
            } else {
                OutlinePiece::Line(corners[k], corners[next])
            };
            let end = if next == 0 { angles[0] + TAU } else { angles[next] };
            (outer, OutlinePiece::Arc(MIDDLE, HOLE, [angles[k], end]))
        })
        .collect()
}

/// Fillet and flange, to the right of the block, each as a lower and an upper piece from left to right.
fn flange() -> [(OutlinePiece, OutlinePiece); 2] {
    let start = 1.0 + FILLET;
    let fillet = OutlinePiece::Arc([start, FLANGE + FILLET], FILLET, [PI, 1.5 * PI]);
    let bottom = |from, to| OutlinePiece::Line([from, 0.0], [to, 0.0]);
    [
        (bottom(FOOT, start), fillet),
        (bottom(start, LENGTH), OutlinePiece::Line([start, FLANGE], [LENGTH, FLANGE])),
    ]
}

/// A piece of the outline with its vertices on one of the flat faces, and the side on which the solid is.
struct Wall {
    piece: OutlinePiece,
    line: Vec<u32>,
    turn: Turn,
}

/// One of the two flat faces, at height z, and the outline from which its walls start.
fn face(weave: &mut Weave, z: f64, turn: Turn, edge: f64) -> Vec<Wall> {
    let lift = |p: [f64; 2]| V3::new(p[0], p[1], z);
    let (pieces, mut walls) = (block(), Vec::new());
    let spoke = |k: usize| OutlinePiece::Line(pieces[k].0.point(0.0), pieces[k].1.point(0.0));
    let mean = (0..6).map(|k| spoke(k).length()).sum::<f64>() / 6.0;
    let n_rows = count_rows(mean, edge);
    let spokes: Vec<Vec<u32>> = (0..6).map(|k| weave.new_line(n_rows, |t| lift(spoke(k).point(t)))).collect();
    let mut side = Vec::new();
    for (k, &(outer, hole)) in pieces.iter().enumerate() {
        let (left, right) = (&spokes[k], &spokes[(k + 1) % 6]);
        let segments = |piece: OutlinePiece| count_segments(piece.length(), edge);
        let lower = weave.line(left[0], right[0], segments(outer), |t| lift(outer.point(t)));
        let upper = weave.line(left[n_rows], right[n_rows], segments(hole), |t| lift(hole.point(t)));
        let place = |t: f64, s: f64| lift(interpolate(outer.point(t), hole.point(t), s));
        weave.patch([&lower, right, &upper, left], edge, turn, place);
        walls.push(Wall { piece: hole, line: upper, turn: Turn::Left });
        if k == 1 {
            side = lower;
        } else {
            walls.push(Wall { piece: outer, line: lower, turn: Turn::Right });
        }
    }
    // From left to right, each from the upward line at which the previous one ended.
    for (below, above) in flange() {
        let n_rows = count_rows(0.5 * (below.length() + above.length()), edge);
        let end = OutlinePiece::Line(below.point(1.0), above.point(1.0));
        let next = weave.new_line(count_segments(end.length(), edge), |t| lift(end.point(t)));
        let (first, last) = (side[0], side[side.len() - 1]);
        let lower = weave.line(first, next[0], n_rows, |t| lift(below.point(t)));
        let upper = weave.line(last, next[next.len() - 1], n_rows, |t| lift(above.point(t)));
        let place = |t: f64, s: f64| lift(interpolate(below.point(s), above.point(s), t));
        weave.patch([&side, &upper, &next, &lower], edge, turn.other(), place);
        walls.push(Wall { piece: below, line: lower, turn: Turn::Right });
        walls.push(Wall { piece: above, line: upper, turn: Turn::Left });
        side = next;
    }
    let end = OutlinePiece::Line([LENGTH, 0.0], [LENGTH, FLANGE]);
    walls.push(Wall { piece: end, line: side, turn: Turn::Right });
    walls
}

fn interpolate(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    std::array::from_fn(|k| a[k] * (1.0 - t) + b[k] * t)
}

/// The bracket with edges of about this length, model units.
fn with_edge(edge: f64) -> Weave {
    let mut weave = Weave::default();
    let half = 0.5 * DEPTH;
    let front = face(&mut weave, half, Turn::Left, edge);
    let back = face(&mut weave, -half, Turn::Right, edge);
    let n_rows = count_rows(DEPTH, edge);
    let mut through = BTreeMap::new();
    for (front, back) in front.iter().zip(&back) {
        let last = front.line.len() - 1;
        for (k, t) in [(0, 0.0), (last, 1.0)] {
            let [x, y] = front.piece.point(t);
            let place = |s: f64| V3::new(x, y, half * (1.0 - 2.0 * s));
            let (a, b) = (front.line[k], back.line[k]);
            through.entry(a).or_insert_with(|| weave.line(a, b, n_rows, place));
        }
        let sides = [&front.line, &through[&front.line[last]], &back.line, &through[&front.line[0]]];
        let place = |t: f64, s: f64| {
            let [x, y] = front.piece.point(t);
            V3::new(x, y, half * (1.0 - 2.0 * s))
        };
        weave.patch(sides, edge, front.turn, place);
    }
    weave
}

/// The bracket with about `n_vertices` vertices; the edge length is varied until the number matches. Closed, genus
/// 1.
pub(super) fn bracket(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    let target = n_vertices as f64;
    let mut per_squared_edge = FIRST_GUESS;
    let mut best = Weave::default();
    for k in 0..MAX_TRIES {
        // The count jumps when a row is added or removed: first approach it by half the difference, then search
        // around it in small steps.
        let aside = if k < STEERED { 0 } else { k as i64 - (MAX_TRIES + STEERED) as i64 / 2 };
        let edge = (per_squared_edge / target).sqrt() * (1.0 + STEP * aside as f64);
        let found = with_edge(edge);
        let count = found.points.len();
        if best.points.is_empty() || count.abs_diff(n_vertices) < best.points.len().abs_diff(n_vertices) {
            best = found;
        }
        if best.points.len().abs_diff(n_vertices) as f64 <= COUNT_TOLERANCE * target {
            break;
        }
        if k < STEERED {
            per_squared_edge = 0.5 * (per_squared_edge + count as f64 * edge * edge);
        }
    }
    (best.points, best.triangles)
}
