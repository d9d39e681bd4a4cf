//! Distance along a mesh by straight lines over unfolded triangles.
//!
//! A front starts at points, runs straight over triangles, and bends at vertices only. Each vertex knows its origin:
//! the source or the last bend, in the plane of the triangle through which the front came. To enter the next triangle
//! through an edge, both are unfolded into one plane; the distance of the third corner is that of the straight line
//! from the origin if this line crosses the edge. On a plane that is the exact distance, whatever the shapes of the
//! triangles. On a curved surface the error comes from the angles between neighboring triangles.

use crate::shape::Adjacency;
use crate::vector::{add_scaled, dot, norm, subtract};
use crate::{Cancelled, Progress};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Relative difference below which distances are equal.
const EQUAL: f64 = 1e-12;

/// Share of an edge by which a line may miss it and still count as crossing it, as lines through vertices do.
const TOUCHING: f64 = 1e-9;

/// Height of a triangle, as a share of its side, below which it has no area.
const FLAT: f64 = 1e-12;

/// Largest difference of the directions from which a front of one origin reaches the two ends of an edge, as a share of
/// its distance; beyond it the front came around both sides of something.
const ONE_WAY: f64 = 0.5;

/// Largest distance between the points of a line nearest to two vertices, relative to the distance of the vertices. It
/// is 1 for a straight line in a plane.
const STRAIGHT: f64 = 1.5;

/// Squared cosine of an angle beyond 90° up to which it counts as a right one.
const OBTUSE: f64 = 4e-4;

/// Number of times that a vertex may get a shorter distance after it has passed the front on.
const MOST_VISITS: u32 = 30;

/// Number of vertices taken from the queue between two checks for cancellation.
const VERTICES_AT_A_TIME: u32 = 1 << 12;

/// The other two corners of the triangles at each vertex, in an order that does not depend on that of the triangles.
#[derive(Clone, Debug)]
pub(crate) struct Corners {
    offsets: Vec<usize>,
    pairs: Vec<[u32; 2]>,
}

impl Corners {
    /// Corners of those `triangles` among `n_vertices` whose corners all have `neighbors`: vertices that are masked
    /// have none. O(triangles).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    ///
    /// # Panics
    /// If a triangle names a vertex that does not exist.
    pub(super) fn new(
        triangles: &[[u32; 3]],
        neighbors: &Adjacency,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n_vertices = neighbors.n_rows();
        let is_known = |t: &&[u32; 3]| t.iter().all(|&v| !neighbors.row(v as usize).is_empty());
        let mut offsets = vec![0_usize; n_vertices + 1];
        for &v in triangles.iter().filter(is_known).flatten() {
            offsets[v as usize + 1] += 1;
        }
        progress.check()?;
        for v in 0..n_vertices {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets[..n_vertices].to_vec();
        let mut pairs = vec![[0; 2]; offsets[n_vertices]];
        for t in triangles.iter().filter(is_known) {
            for k in 0..3 {
                let (p, q) = (t[(k + 1) % 3], t[(k + 2) % 3]);
                let place = &mut next[t[k] as usize];
                pairs[*place] = [p.min(q), p.max(q)];
                *place += 1;
            }
        }
        progress.check()?;
        for v in 0..n_vertices {
            pairs[offsets[v]..offsets[v + 1]].sort_unstable();
        }
        Ok(Self { offsets, pairs })
    }

    /// The pairs of other corners of the triangles at a vertex.
    pub(super) fn pairs_of(&self, v: u32) -> &[[u32; 2]] {
        &self.pairs[self.offsets[v as usize]..self.offsets[v as usize + 1]]
    }
}

/// Extent of the place from which distances are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SourceExtent {
    /// A point.
    Point,
    /// The straight line between the points of all sources of the same number.
    Line,
}

/// A point from which distances are measured, seen from a vertex nearby.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrontSource {
    /// The vertex.
    pub(crate) vertex: usize,
    /// The point, in the units of the vertices.
    pub(crate) point: [f64; 3],
    /// Distance at the point.
    pub(crate) start: f64,
    /// Extent of the source.
    pub(crate) extent: SourceExtent,
    /// Number of the source, the same at all vertices that see it.
    pub(crate) number: u32,
}

/// Place that a front runs straight from.
#[derive(Clone, Copy, Debug)]
struct Origin {
    /// Position in the plane of the triangle through which the front came.
    point: [f64; 3],
    /// Distance at the origin.
    start: f64,
    /// Number: twice that of the vertex, or above all of these and odd for a line.
    number: u64,
}

impl Origin {
    fn is_line(&self) -> bool {
        self.number % 2 == 1
    }
}

/// Shortest way to a vertex so far.
#[derive(Clone, Copy, Debug)]
struct FrontLabel {
    vertex: u32,
    /// Number of times that the vertex has passed the front on.
    n_visits: u32,
    distance: f64,
    /// True if the present distance has not been passed on.
    is_waiting: bool,
    origin: Origin,
}

/// Mark of a vertex that has no label.
const NONE: u32 = u32::MAX;

/// Distances along a mesh from a few sources, with memory that is reused between searches: a search costs what it
/// finds, independent of the size of the shape.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrontSearch {
    /// Index of the label of each vertex.
    places: Vec<u32>,
    labels: Vec<FrontLabel>,
    /// Labels to pass on: the upper half of the bits of their distances, which have the order of the distances to 1e-6,
    /// and their indices. A vertex that comes a little too early is corrected like any other.
    queue: BinaryHeap<Reverse<u64>>,
    reached: Vec<u32>,
    radius: f64,
}

/// Place in the plane of a triangle: along its edge, and across it.
type Planar = [f64; 2];

/// A triangle whose edge from `a` to `b` a front crosses, in its plane: `a` at the origin, `b` at (length, 0).
struct Crossing<'a> {
    a: &'a FrontLabel,
    b: &'a FrontLabel,
    length: f64,
    /// The corner behind the edge.
    corner: Planar,
    /// Places of the origins along the edge, seen from either end.
    along: [f64; 2],
}

impl FrontSearch {
    /// Finds the vertices within `radius` of the nearest of `sources`, and the [`distance`](Self::distance) of each, in
    /// the units of `points`. O(m log m) for m vertices within the radius.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled; then no distances are known until the next search.
    pub(super) fn run(
        &mut self,
        corners: &Corners,
        points: &[[f64; 3]],
        sources: &[FrontSource],
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<&[u32], Cancelled> {
        for label in self.labels.drain(..) {
            self.places[label.vertex as usize] = NONE;
        }
        self.reached.clear();
        self.queue.clear();
        self.radius = radius;
        self.places.resize(points.len(), NONE);
        for source in sources {
            let place = &points[source.vertex];
            // Adding 0 turns −0 into +0, as the order of the bit patterns requires.
            let distance = source.start + norm(&subtract(&source.point, place)) + 0.0;
            if distance <= radius {
                let number = match source.extent {
                    SourceExtent::Point if source.point == *place => 2 * source.vertex as u64,
                    extent => 2 * (points.len() as u64 + u64::from(source.number)) + extent as u64,
                };
                let origin = Origin { point: source.point, start: source.start, number };
                self.offer(source.vertex as u32, distance, origin);
            }
        }
        let mut n_looked_at = 0_u32;
        while let Some(Reverse(entry)) = self.queue.pop() {
            n_looked_at = n_looked_at.wrapping_add(1);
            if n_looked_at.is_multiple_of(VERTICES_AT_A_TIME) {
                progress.check()?;
            }
            let label = &mut self.labels[entry as u32 as usize];
            if label.is_waiting && entry >> 32 == label.distance.to_bits() >> 32 {
                label.is_waiting = false;
                label.n_visits += 1;
                let label = *label;
                self.pass_on(&label, corners, points, radius);
            }
        }
        let inside = self.labels.iter().filter(|label| label.distance <= radius);
        self.reached.extend(inside.map(|label| label.vertex));
        Ok(&self.reached)
    }

    /// Distance of a vertex from the nearest source of the last search; infinite beyond its radius.
    pub(super) fn distance(&self, x: usize) -> f64 {
        let label = self.places.get(x).filter(|place| **place != NONE);
        let distance = label.map_or(f64::INFINITY, |&place| self.labels[place as usize].distance);
        if distance <= self.radius { distance } else { f64::INFINITY }
    }

    /// Passes the front on to the vertices around `x`: across the opposite edges first, since most ways are straight.
    fn pass_on(&mut self, x: &FrontLabel, corners: &Corners, points: &[[f64; 3]], radius: f64) {
        let around = corners.pairs_of(x.vertex);
        for &[p, q] in around {
            let (at_p, at_q) = (self.places[p as usize], self.places[q as usize]);
            let has_passed = |place: u32| place != NONE && self.labels[place as usize].n_visits > 0;
            let (from_p, from_q) = (has_passed(at_p), has_passed(at_q));
            if from_p && from_q && self.is_settled(x, [at_p, at_q], points) {
                continue;
            }
            for (from, side, behind) in [(from_p, at_p, q), (from_q, at_q, p)] {
                if from && let Some((distance, origin)) = self.cross(x, side, behind, points) {
                    // Lines within the radius may pass between vertices beyond it, as far as a triangle reaches.
                    if distance <= radius || distance <= radius + longest_side(points, x.vertex, p, q) {
                        self.offer(behind, distance, origin);
                    }
                }
            }
        }
        let here = &points[x.vertex as usize];
        let bend = Origin { point: *here, start: x.distance, number: 2 * u64::from(x.vertex) };
        // Each edge belongs to two triangles.
        let is_bend_of_x = |known: &FrontLabel| {
            known.origin.number == bend.number && known.origin.start.to_bits() == bend.start.to_bits()
        };
        for &[p, q] in around {
            for y in [p, q] {
                let place = self.places[y as usize];
                if place != NONE {
                    let known = &self.labels[place as usize];
                    if known.distance <= x.distance || is_bend_of_x(known) {
                        continue;
                    }
                }
                let distance = x.distance + norm(&subtract(&points[y as usize], here));
                if distance <= radius
                    || (y != x.vertex && distance <= radius + longest_side(points, x.vertex, p, q))
                {
                    self.offer(y, distance, bend);
                }
            }
        }
    }

    /// True if the front passed over a triangle before it came to `x`: all corners have one origin, `x` is the
    /// farthest, and the others have no obtuse angles, so that no line across an edge at `x` leads to a nearer corner.
    fn is_settled(&self, x: &FrontLabel, others: [u32; 2], points: &[[f64; 3]]) -> bool {
        let [p, q] = others.map(|place| &self.labels[place as usize]);
        let is_before =
            |label: &FrontLabel| label.origin.number == x.origin.number && label.distance <= x.distance;
        let [px, pp, pq] = [x, p, q].map(|label| &points[label.vertex as usize]);
        let side = subtract(pp, pq);
        let is_acute_or_right = |to_x: &[f64; 3], cosine: f64| {
            cosine > 0.0 || cosine * cosine < OBTUSE * dot(to_x, to_x) * dot(&side, &side)
        };
        let (from_p, from_q) = (subtract(px, pp), subtract(px, pq));
        is_before(p)
            && is_before(q)
            && is_acute_or_right(&from_p, -dot(&from_p, &side))
            && is_acute_or_right(&from_q, dot(&from_q, &side))
    }

    /// Distance and origin of the vertex `behind` the edge from `x` to the vertex of the label `side`, if a straight
    /// line crosses this edge.
    fn cross(&self, x: &FrontLabel, side: u32, behind: u32, points: &[[f64; 3]]) -> Option<(f64, Origin)> {
        let y = &self.labels[side as usize];
        let (a, b) = if x.vertex < y.vertex { (x, y) } else { (y, x) };
        let [pa, pb, pc] = [a.vertex, b.vertex, behind].map(|v| &points[v as usize]);
        let edge = subtract(pb, pa);
        let length = norm(&edge);
        let along = edge.map(|c| c / length);
        let to_corner = subtract(pc, pa);
        let corner_along = dot(&to_corner, &along);
        let across = add_scaled(&to_corner, -corner_along, &along);
        let height = norm(&across);
        if !(length > 0.0 && height > FLAT * length) {
            return None;
        }
        let seen_along =
            |label: &FrontLabel, end: &[f64; 3]| dot(&subtract(&label.origin.point, end), &along);
        let crossing = Crossing {
            a,
            b,
            length,
            corner: [corner_along, height],
            along: [seen_along(a, pa), seen_along(b, pb)],
        };
        let (distance, place, origin) = crossing.shortest()?;
        let flat = add_scaled(pa, place[0], &along);
        let point = add_scaled(&flat, place[1] / height, &across);
        Some((distance, Origin { point, ..origin }))
    }

    /// Records a way to a vertex if it is shorter than the known one, or as long and straight over a longer part.
    fn offer(&mut self, vertex: u32, distance: f64, origin: Origin) {
        let place = self.places[vertex as usize];
        let place = if place == NONE {
            self.places[vertex as usize] = self.labels.len() as u32;
            self.labels.push(FrontLabel { vertex, n_visits: 0, distance, is_waiting: true, origin });
            self.labels.len() - 1
        } else {
            let known = &mut self.labels[place as usize];
            let is_shorter = distance < known.distance * (1.0 - EQUAL);
            let is_straighter = distance <= known.distance * (1.0 + EQUAL)
                && origin.start < known.origin.start - EQUAL * distance;
            if !(is_shorter || is_straighter) || known.n_visits > MOST_VISITS {
                return;
            }
            (known.distance, known.origin, known.is_waiting) = (distance, origin, true);
            place as usize
        };
        self.queue.push(Reverse(distance.to_bits() >> 32 << 32 | place as u64));
    }
}

impl Crossing<'_> {
    /// Distance of the corner along the shortest line across the edge, with its origin.
    fn shortest(&self) -> Option<(f64, Planar, Origin)> {
        let (a, b) = (&self.a.origin, &self.b.origin);
        if a.number == b.number && !a.is_line() {
            let (ra, rb) = (self.a.distance - a.start, self.b.distance - b.start);
            // The point at these distances from both ends.
            let along = 0.5 * ((ra - rb) * (ra + rb) / self.length + self.length);
            if (along - self.along[0]).abs() <= ONE_WAY * ra {
                let across = ((ra - along) * (ra + along)).max(0.0).sqrt();
                return self.line_from([along, -across], a);
            }
        }
        let [from_a, from_b] = self.unfolded_origins();
        if a.number == b.number && a.is_line() && self.is_one_piece(&from_a, &from_b) {
            return self.line_from(nearest_on_segment(&self.corner, &from_a, &from_b), a);
        }
        let first = self.line_from(from_a, a).filter(|_| self.is_seen([from_a, from_b], 0));
        let second = self.line_from(from_b, b).filter(|_| self.is_seen([from_a, from_b], 1));
        match (first, second) {
            (Some(first), Some(second)) => Some(if second.0 < first.0 { second } else { first }),
            (first, second) => first.or(second),
        }
    }

    /// True if the nearest points of a line are as close as those of a straight line; otherwise the line bends or has
    /// several parts.
    fn is_one_piece(&self, from_a: &Planar, from_b: &Planar) -> bool {
        let (dx, dy) = (from_b[0] - from_a[0], from_b[1] - from_a[1]);
        (dx * dx + dy * dy).sqrt() <= STRAIGHT * self.length
    }

    /// The origins that the ends see, in the plane of the triangle.
    fn unfolded_origins(&self) -> [Planar; 2] {
        let ends = [(self.a, 0.0), (self.b, self.length)];
        std::array::from_fn(|k| {
            let (label, offset) = ends[k];
            let reach = (label.distance - label.origin.start).max(0.0);
            let along = self.along[k].clamp(-reach, reach);
            [offset + along, -((reach - along) * (reach + along)).sqrt()]
        })
    }

    /// Line from a place to the corner, if it crosses the edge.
    fn line_from(&self, place: Planar, origin: &Origin) -> Option<(f64, Planar, Origin)> {
        let at = crossing_point(&place, &self.corner);
        let margin = TOUCHING * self.length;
        if !(-margin..=self.length + margin).contains(&at) {
            return None;
        }
        let [dx, dy] = [self.corner[0] - place[0], self.corner[1] - place[1]];
        Some((origin.start + (dx * dx + dy * dy).sqrt(), place, *origin))
    }

    /// False if the origin of one `end` is hidden from where its line to the corner crosses the edge: if the other end
    /// lies in a shadow, whose border is the line through the place at which the front to that end bends.
    fn is_seen(&self, origins: [Planar; 2], end: usize) -> bool {
        let (own, other, at_other) =
            if end == 0 { (self.a, self.b, self.length) } else { (self.b, self.a, 0.0) };
        let (place, bend) = (origins[end], origins[1 - end]);
        let along = at_other - place[0];
        let straight = own.origin.start + (along * along + place[1] * place[1]).sqrt();
        if straight >= other.distance * (1.0 - EQUAL) {
            return true;
        }
        if bend[1] <= place[1] {
            return false;
        }
        let border = crossing_point(&place, &bend);
        let at = crossing_point(&place, &self.corner);
        if end == 0 { at <= border } else { at >= border }
    }
}

/// Length of the longer of the sides from one corner of a triangle.
fn longest_side(points: &[[f64; 3]], x: u32, p: u32, q: u32) -> f64 {
    let length = |y: u32| norm(&subtract(&points[y as usize], &points[x as usize]));
    length(p).max(length(q))
}

/// Place along the edge at which the line from `below` through `above` crosses it.
fn crossing_point(below: &Planar, above: &Planar) -> f64 {
    let rise = above[1] - below[1];
    if rise > 0.0 { below[0] + (above[0] - below[0]) * (-below[1] / rise) } else { below[0] }
}

/// Nearest point of a segment.
fn nearest_on_segment(p: &Planar, a: &Planar, b: &Planar) -> Planar {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let squared = dx * dx + dy * dy;
    let t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / squared;
    let t = if squared > 0.0 { t.clamp(0.0, 1.0) } else { 0.0 };
    [a[0] + t * dx, a[1] + t * dy]
}
