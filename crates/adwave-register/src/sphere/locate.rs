//! The triangle of a sphere in a direction, found by a grid of cells on the faces of a cube around it.
//!
//! The central projection onto a face of the cube maps great circles to lines, so a triangle lies within the box of its
//! projected corners, and its barycentric weights are ratios of volumes: w_a ∝ p·(b × c).

use super::{Sphere, SphereError};
use adwave::vector::{cross, dot};
use std::ops::Range;

/// Weight below which a corner is left out: a direction at a vertex has that vertex alone.
const NO_WEIGHT: f64 = 1e-10;
/// Cosine of the length of an edge up to which a triangle is short: 20°.
const SHORT: f64 = 0.939;
/// Least coordinate along the axis of a face with which a corner is projected onto it: 84° from the axis. A short
/// triangle with a corner beyond does not reach the face, whose corners are 55° from the axis.
const IN_FRONT: f64 = 0.1;
/// Most entries of the cells, per triangle and in addition.
const MOST_ENTRIES: [usize; 2] = [64, 1 << 17];

/// Corners with positive weights, which sum to 1; unused ones have weight 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PlaceOnSphere {
    pub(super) corners: [u32; 3],
    pub(super) weights: [f64; 3],
}

impl PlaceOnSphere {
    /// Corners that have a weight.
    pub(super) fn entries(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.corners.iter().copied().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}

/// Cells with the triangles that they may meet.
pub(super) struct SphereCells<'a> {
    sphere: &'a Sphere,
    /// Cells along an edge of the cube.
    n_side: usize,
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// Cells of a face that a triangle may meet: rows and columns, ends included.
struct CellBox {
    triangle: u32,
    face: u32,
    rows: [u32; 2],
    columns: [u32; 2],
}

impl CellBox {
    fn n_cells(&self) -> usize {
        (self.rows[1] - self.rows[0] + 1) as usize * (self.columns[1] - self.columns[0] + 1) as usize
    }

    /// Cells of each row.
    fn cells(&self, n_side: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        (self.rows[0]..=self.rows[1]).map(move |row| {
            let first = (self.face as usize * n_side + row as usize) * n_side;
            first + self.columns[0] as usize..first + self.columns[1] as usize + 1
        })
    }
}

impl<'a> SphereCells<'a> {
    /// Sorts the triangles into cells. O(n).
    pub(super) fn new(sphere: &'a Sphere) -> Result<Self, SphereError> {
        let n = sphere.triangles.len();
        let n_side = ((n as f64 / 6.0).sqrt().ceil() as usize).clamp(1, 4096);
        let most = MOST_ENTRIES[0].saturating_mul(n).saturating_add(MOST_ENTRIES[1]);
        let mut boxes = Vec::with_capacity(2 * n);
        let (mut starts, mut n_entries) = (vec![0_u32; 6 * n_side * n_side + 1], 0_usize);
        for t in 0..n as u32 {
            let first = boxes.len();
            add_boxes(sphere, t, n_side, &mut boxes);
            for cell_box in &boxes[first..] {
                n_entries += cell_box.n_cells();
                if n_entries > most {
                    return Err(SphereError::Overlap);
                }
                for cells in cell_box.cells(n_side) {
                    starts[cells.start + 1..=cells.end].iter_mut().for_each(|count| *count += 1);
                }
            }
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let (mut next, mut members) = (starts.clone(), vec![0_u32; n_entries]);
        for cell_box in &boxes {
            for cell in cell_box.cells(n_side).flatten() {
                members[next[cell] as usize] = cell_box.triangle;
                next[cell] += 1;
            }
        }
        Ok(Self { sphere, n_side, starts, members })
    }

    /// Place in a direction: in a fold that of the layer that has it farthest inside a triangle, of those that are not
    /// upside down; of equal ones in the first triangle. `None` if rounding leaves no triangle there.
    pub(super) fn locate(&self, p: &[f64; 3]) -> Option<PlaceOnSphere> {
        let face = face_of(p);
        let [u, v] = project(p, face);
        let cell = (face * self.n_side + cell_at(u, self.n_side)) * self.n_side + cell_at(v, self.n_side);
        let members = &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        let mut best: Option<(f64, PlaceOnSphere)> = None;
        for &t in members {
            let corners = self.sphere.triangles[t as usize];
            let [a, b, c] = corners.map(|v| self.sphere.directions[v as usize]);
            let parts = [dot(p, &cross(&b, &c)), dot(p, &cross(&c, &a)), dot(p, &cross(&a, &b))];
            let total: f64 = parts.iter().sum();
            // A triangle that is upside down, on the other side of the sphere, or without area.
            if dot(&a, &cross(&b, &c)) <= 0.0 || total <= 0.0 {
                continue;
            }
            let weights = parts.map(|part| part / total);
            let inside = weights.iter().copied().fold(f64::INFINITY, f64::min);
            if inside.is_finite() && best.is_none_or(|(most, _)| inside > most) {
                best = Some((inside, PlaceOnSphere { corners, weights }));
            }
        }
        best.map(|(_, place)| without_rounding(place))
    }
}

/// A place without weights that are rounding.
fn without_rounding(mut place: PlaceOnSphere) -> PlaceOnSphere {
    place.weights = place.weights.map(|weight| if weight > NO_WEIGHT { weight } else { 0.0 });
    let total: f64 = place.weights.iter().sum();
    place.weights = place.weights.map(|weight| weight / total);
    place
}

/// Face of the cube in a direction: twice its axis, plus 1 on the negative side.
fn face_of(p: &[f64; 3]) -> usize {
    let axis = (1..3).fold(0, |most, axis| if p[axis].abs() > p[most].abs() { axis } else { most });
    2 * axis + usize::from(p[axis] < 0.0)
}

/// Coordinate along the axis of a face.
fn height(p: &[f64; 3], face: usize) -> f64 {
    if face.is_multiple_of(2) { p[face / 2] } else { -p[face / 2] }
}

/// Central projection onto the plane of a face in front.
fn project(p: &[f64; 3], face: usize) -> [f64; 2] {
    let (axis, along) = (face / 2, height(p, face));
    [p[(axis + 1) % 3] / along, p[(axis + 2) % 3] / along]
}

/// Cell along an edge of a face at a coordinate in −1..1.
fn cell_at(u: f64, n_side: usize) -> usize {
    (((u + 1.0) * 0.5 * n_side as f64) as usize).min(n_side - 1)
}

/// Adds the cells of each face that a triangle may meet.
fn add_boxes(sphere: &Sphere, triangle: u32, n_side: usize, boxes: &mut Vec<CellBox>) {
    /// Slack for rounding, in the unit of the cube.
    const SLACK: f64 = 1e-9;
    let corners = sphere.triangles[triangle as usize].map(|v| sphere.directions[v as usize]);
    let [a, b, c] = &corners;
    let is_short = dot(a, b) > SHORT && dot(b, c) > SHORT && dot(c, a) > SHORT;
    for face in 0..6 {
        let whole = [0, n_side as u32 - 1];
        if corners.iter().any(|corner| height(corner, face) <= IN_FRONT) {
            if !is_short {
                boxes.push(CellBox { triangle, face: face as u32, rows: whole, columns: whole });
            }
            continue;
        }
        let [a, b, c] = corners.map(|corner| project(&corner, face));
        let ends = |k: usize| {
            let [low, high] = [a[k].min(b[k]).min(c[k]) - SLACK, a[k].max(b[k]).max(c[k]) + SLACK];
            (low <= 1.0 && high >= -1.0).then(|| [low, high].map(|u| cell_at(u, n_side) as u32))
        };
        if let (Some(rows), Some(columns)) = (ends(0), ends(1)) {
            boxes.push(CellBox { triangle, face: face as u32, rows, columns });
        }
    }
}
