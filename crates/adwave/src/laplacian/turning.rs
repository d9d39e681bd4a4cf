//! Angles by which a direction turns on its way from a vertex to its neighbor, on triangles given by side lengths.
//!
//! The directions at a vertex are angles in its tangent plane: those of the sides that leave it follow each other by
//! the angles of its corners, scaled to a full turn. A flip gives the new edge its angle by the triangle that it then
//! belongs to (`sharp2019signpost`), so the angles stay those of the surface, whatever edges it has.

use super::triangulation::{NONE, Triangulation, next, previous};
use crate::parallel;
use crate::rows::Pattern;
use crate::vector::{Vector, add_scaled, cross, dot, subtract, unit};
use crate::{Cancelled, Progress};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Number of vertices whose sides a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 11;

/// Largest angle of a turn that counts as rounding.
const ROUNDING: f64 = 1e-12;

/// A turn as a complex number `e^{iρ}`, or a mean of several, of absolute value at most 1.
pub(crate) type TangentTurn = [f64; 2];

/// Plane that touches the surface at a vertex: two orthogonal unit vectors in it, and its unit normal, so that the three
/// are right-handed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TangentPlane {
    /// Direction of the angle 0.
    pub first: Vector,
    /// Direction of the angle π/2.
    pub second: Vector,
    /// Unit normal; 0 at a vertex without a plane, whose directions are 0 as well.
    pub normal: Vector,
}

impl TangentPlane {
    /// The plane across a unit normal. Its first direction is the x-axis projected into it, or the y-axis where that
    /// is steeper, so that parallel planes have the same directions.
    pub(crate) fn from_normal(normal: &Vector) -> Self {
        let axis = if normal[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        match unit(&add_scaled(&axis, -dot(&axis, normal), normal)) {
            Some(first) if dot(normal, normal) > 0.0 => {
                Self { first, second: cross(normal, &first), normal: *normal }
            }
            _ => Self::default(),
        }
    }

    /// Coordinates of a vector along the first and the second direction and the normal.
    pub fn coordinates(&self, v: &Vector) -> [f64; 3] {
        [dot(v, &self.first), dot(v, &self.second), dot(v, &self.normal)]
    }

    /// The tangent vector with two coordinates in the plane.
    pub fn vector(&self, coordinates: [f64; 2]) -> Vector {
        add_scaled(&self.first.map(|c| c * coordinates[0]), coordinates[1], &self.second)
    }

    fn angle(&self, v: &Vector) -> f64 {
        dot(v, &self.second).atan2(dot(v, &self.first))
    }
}

/// The turn `e^{isρ}` of an angle ρ.
fn turn(angle: f64, symmetry: u32) -> TangentTurn {
    let angle = (angle + PI).rem_euclid(TAU) - PI;
    if angle.abs() <= ROUNDING {
        return [1.0, 0.0]; // parallel planes: constants stay to the last bit
    }
    let (sin, cos) = (f64::from(symmetry) * angle).sin_cos();
    [cos, sin]
}

/// The turn from the plane `there` to the plane `here` by the smallest rotation that joins their normals. `None` where
/// one of them has no normal.
pub(crate) fn turn_between(here: &TangentPlane, there: &TangentPlane, symmetry: u32) -> Option<TangentTurn> {
    let (to, from) = (&here.normal, &there.normal);
    let along = 1.0 + dot(to, from);
    if dot(to, to) == 0.0 || dot(from, from) == 0.0 || along < 1e-6 {
        return None;
    }
    let sum = [0, 1, 2].map(|c| to[c] + from[c]);
    // Vectors of the plane `there` are orthogonal to `from`, which leaves this of the rotation.
    let rotated = add_scaled(&there.first, -dot(&sum, &there.first) / along, &sum);
    Some(turn(here.angle(&rotated), symmetry))
}

/// Angles of the sides of a triangulation at the corners that they leave, relative to the tangent planes.
#[derive(Clone, Debug, Default)]
pub(super) struct SideAngles {
    /// Angle of each side at its first corner.
    pub(super) angle: Vec<f64>,
    /// Factor of the corner angles of each vertex: 2π divided by their sum, and 1 on the border.
    pub(super) scale: Vec<f64>,
    /// True at the vertices whose triangles form one fan with one orientation.
    pub(super) is_regular: Vec<bool>,
}

impl Triangulation {
    /// Angle of the corner at which side `h` starts.
    fn corner_angle(&self, h: usize) -> f64 {
        let (a, b, c) = (self.length[next(h)], self.length[h], self.length[previous(h)]);
        (4.0 * self.area(h)).atan2(b * b + c * c - a * a)
    }

    /// Angles at all corners of a sheet with the given tangent planes, whose orientation is that of its triangles.
    pub(super) fn side_angles(
        &self,
        points: &[[f64; 3]],
        planes: &[TangentPlane],
        at_vertex: &Pattern,
        progress: Progress<'_>,
    ) -> Result<SideAngles, Cancelled> {
        let n = at_vertex.n_rows();
        let chunks = parallel::try_map_chunks(
            n,
            VERTICES_AT_A_TIME,
            progress,
            Vec::new,
            |fan: &mut Vec<(usize, f64)>, range: Range<usize>| {
                let mut found = Vec::with_capacity(7 * range.len());
                let mut vertices = Vec::with_capacity(range.len());
                for x in range {
                    let (scale, is_regular) = self.fan(x, at_vertex.row(x), fan);
                    let offset =
                        if is_regular { self.offset(points, &planes[x], x, scale, fan) } else { 0.0 };
                    found.extend(fan.iter().map(|&(h, angle)| (h as u32, scale * angle + offset)));
                    vertices.push((scale, is_regular));
                }
                (found, vertices)
            },
        )?;
        let mut angles =
            SideAngles { angle: vec![0.0; self.n_sides()], scale: Vec::new(), is_regular: Vec::new() };
        for (found, vertices) in chunks {
            for (h, angle) in found {
                angles.angle[h as usize] = angle;
            }
            angles.scale.extend(vertices.iter().map(|v| v.0));
            angles.is_regular.extend(vertices.iter().map(|v| v.1));
        }
        Ok(angles)
    }

    /// Sides that leave `x`, counterclockwise, with the sums of the angles before them. Returns the scale of the
    /// angles, and true if all triangles `around` are in the fan.
    fn fan(&self, x: usize, around: &[u32], fan: &mut Vec<(usize, f64)>) -> (f64, bool) {
        fan.clear();
        let sides = around.iter().flat_map(|&t| 3 * t as usize..3 * t as usize + 3);
        let leaving = sides.filter(|&h| self.corner[h] as usize == x);
        let (mut n_corners, mut first, mut start) = (0, usize::MAX, None);
        for h in leaving {
            n_corners += 1;
            first = first.min(h);
            if self.twin[h] == NONE {
                start = Some(h);
            }
        }
        if n_corners == 0 {
            return (1.0, false);
        }
        let (start, mut sum) = (start.unwrap_or(first), 0.0);
        let mut h = start;
        let is_closed = loop {
            fan.push((h, sum));
            sum += self.corner_angle(h);
            match self.twin[previous(h)] {
                NONE => break false,
                twin if twin as usize == start => break true,
                twin => h = twin as usize,
            }
            if fan.len() > n_corners {
                break false;
            }
        };
        let scale = if is_closed && sum > 0.0 { TAU / sum } else { 1.0 };
        (scale, fan.len() == n_corners)
    }

    /// Angle in the plane of the direction from which the angles of a fan count: the mean over its sides.
    fn offset(
        &self,
        points: &[[f64; 3]],
        plane: &TangentPlane,
        x: usize,
        scale: f64,
        fan: &[(usize, f64)],
    ) -> f64 {
        let mut sum = [0.0; 2];
        let mut add = |other: u32, angle: f64| {
            let along = plane.coordinates(&subtract(&points[other as usize], &points[x]));
            let length = along[0].hypot(along[1]);
            if length > 0.0 {
                let (sin, cos) = angle.sin_cos();
                let [c, s] = [along[0] / length, along[1] / length];
                sum[0] += c * cos + s * sin;
                sum[1] += s * cos - c * sin;
            }
        };
        for &(h, angle) in fan {
            add(self.corner[next(h)], scale * angle);
            if self.twin[previous(h)] == NONE {
                add(self.corner[previous(h)], scale * (angle + self.corner_angle(h)));
            }
        }
        sum[1].atan2(sum[0])
    }

    /// Angle at its last corner of side `h`, seen from there.
    fn angle_back(&self, h: usize, angles: &SideAngles) -> f64 {
        match self.twin[h] {
            NONE => {
                let after = next(h);
                let y = self.corner[after] as usize;
                angles.angle[after] + angles.scale[y] * self.corner_angle(after)
            }
            twin => angles.angle[twin as usize],
        }
    }

    /// Gives the new edge of a flip its angles; it is side 2 of triangle `t` and side 1 of triangle `u`.
    pub(super) fn turn_flipped(&mut self, t: usize, u: usize) {
        let Some(angles) = &self.angles else { return };
        let after = |h: usize| angles.angle[h] + angles.scale[self.corner[h] as usize] * self.corner_angle(h);
        let (from_k, from_m) = (after(u + 2), after(t));
        let angles = self.angles.as_mut().expect("there are angles");
        angles.angle[t + 2] = from_k;
        angles.angle[u + 1] = from_m;
    }

    /// Turns of the entries of `pattern`, row by row: by the edges between two regular vertices, weighted by their
    /// cotangents if there are several; else by `across`.
    pub(super) fn turns(
        &self,
        at_vertex: &Pattern,
        symmetry: u32,
        pattern: &Pattern,
        across: impl Fn(usize, usize) -> TangentTurn + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Vec<TangentTurn>, Cancelled> {
        let angles = self.angles.as_ref().expect("the sheet has angles");
        let chunks = parallel::try_map_chunks(
            pattern.n_rows(),
            VERTICES_AT_A_TIME,
            progress,
            Vec::new,
            |edges: &mut Vec<(u32, f64, TangentTurn)>, range: Range<usize>| {
                let mut turns = Vec::with_capacity(7 * range.len());
                for x in range {
                    self.edges_of(x, at_vertex.row(x), angles, symmetry, edges);
                    for &y in pattern.row(x) {
                        let (mut total, mut sum) = (0.0, [0.0; 2]);
                        for (_, weight, turn) in edges.iter().filter(|e| e.0 == y && e.1 > 0.0) {
                            total += weight;
                            sum = [sum[0] + weight * turn[0], sum[1] + weight * turn[1]];
                        }
                        let is_single = edges.iter().filter(|e| e.0 == y).count() == 1;
                        turns.push(match edges.iter().find(|e| e.0 == y) {
                            Some((_, _, turn)) if is_single => *turn,
                            Some(_) if total > 0.0 => sum.map(|c| c / total),
                            _ => across(x, y as usize),
                        });
                    }
                }
                turns
            },
        )?;
        Ok(chunks.concat())
    }

    /// Edges between `x` and other regular vertices: the other end, the cotangent weight and the turn to x.
    fn edges_of(
        &self,
        x: usize,
        around: &[u32],
        angles: &SideAngles,
        symmetry: u32,
        edges: &mut Vec<(u32, f64, TangentTurn)>,
    ) {
        edges.clear();
        if !angles.is_regular[x] {
            return;
        }
        let mut before = None;
        for &t in around {
            // A triangle with two corners at x appears twice.
            if before.replace(t) == Some(t) {
                continue;
            }
            for h in 3 * t as usize..3 * t as usize + 3 {
                let (from, to) = (self.corner[h], self.corner[next(h)]);
                let twin = self.twin[h];
                let is_last = to as usize == x && twin == NONE;
                if from == to || from as usize != x && !is_last {
                    continue;
                }
                let y = if is_last { from } else { to };
                if !angles.is_regular[y as usize] {
                    continue;
                }
                let weight =
                    self.cotangent(h) + if twin == NONE { 0.0 } else { self.cotangent(twin as usize) };
                let [start, end] = [angles.angle[h], self.angle_back(h, angles)];
                let (here, there) = if is_last { (end, start) } else { (start, end) };
                edges.push((y, weight, turn(here - there - PI, symmetry)));
            }
        }
    }

    /// Curvature of triangle `t`, the sum of its scaled angles less π, and the turns from its corners 1, 2 and 0 to its
    /// corners 0, 1 and 2. `None` at a vertex whose triangles are no fan.
    pub(super) fn triangle_turns(&self, t: usize, symmetry: u32) -> Option<(f64, [TangentTurn; 3])> {
        let angles = self.angles.as_ref().expect("the sheet has angles");
        let corners = [0, 1, 2].map(|k| self.corner[3 * t + k] as usize);
        if corners.iter().any(|&x| !angles.is_regular[x]) {
            return None;
        }
        let sides = [3 * t, 3 * t + 1, 3 * t + 2];
        let sum: f64 = sides.iter().zip(corners).map(|(&h, x)| angles.scale[x] * self.corner_angle(h)).sum();
        let turns = sides.map(|h| turn(angles.angle[h] - self.angle_back(h, angles) - PI, symmetry));
        Some((sum - PI, turns))
    }
}
