//! Detail cloned from one place of a shape to another, in local frames.

use crate::DeformError;
use crate::coarse_base::{smooth_positions, smooth_rise};
use crate::rotation::{Matrix, image, to_matrix};
use crate::surface_frames::{base_normals, smallest_turn};
use adwave::bands::Schedule;
use adwave::vector::{Vector, add_scaled, cross, dot, norm, subtract, unit};
use adwave::{Decomposer, Progress};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet};
use std::ops::RangeInclusive;

/// Share of the radius from which the cloned detail fades into the present one.
const FULL_SHARE: f64 = 0.5;

/// Source vertices that a cloned value is fitted to.
const FITTED: usize = 8;

/// Distance from the fitted vertices, in their mean distance, beyond which the source has no detail to give.
const OUTSIDE: f64 = 3.0;

/// A clone of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct Transplant {
    /// Vertex in the middle of the detail, from 0.
    pub source: u32,
    /// Vertex to which the detail goes.
    pub target: u32,
    /// Distance on the coarse shape, in model units, at which the clone has faded out.
    pub radius: f64,
    /// Turn of the detail about the normal, counterclockwise seen from outside, in radians.
    pub angle: f64,
    /// Levels that are cloned, from 1; the others keep their detail.
    pub levels: RangeInclusive<usize>,
}

/// Result of a clone.
#[derive(Clone, Debug, PartialEq)]
pub struct Transplanted {
    /// New positions in the order of the shape.
    pub points: Vec<[f64; 3]>,
    /// Number of vertices that received detail.
    pub n_changed: usize,
    /// Number of vertices within the radius for which the source has no detail, as beyond its border.
    pub n_without_source: usize,
    /// Largest stretch between the two neighborhoods: distances on the coarse shape between neighbors at the target
    /// over those in its map. 1 where both are flat, more on a tip.
    pub distortion: f64,
}

/// Clones the detail of some levels from one place to another. Around both places the coarse shape is unrolled onto its
/// tangent plane (the discrete exponential map, `schmidt2006`). At equal places of the two maps the target takes the
/// detail of the source, turned from frame to frame. The axes of the two maps differ by the smallest rotation between
/// the normals and `angle`. The detail of the source fades into the present one from half the radius on. O(n) for the
/// bands.
///
/// # Errors
/// [`DeformError`] if a vertex does not exist or takes no part, the radius is no length, the levels are none, or the
/// call is cancelled.
pub fn transplant(
    decomposer: &Decomposer,
    schedule: &Schedule,
    clone: &Transplant,
    progress: Progress<'_>,
) -> Result<Transplanted, DeformError> {
    let geometry = decomposer.geometry_for("a clone of detail")?;
    let Some(points) = geometry.shape().points() else { return Err(DeformError::NoPositions) };
    let (map, n_levels) = (geometry.vertex_map(), schedule.n_levels());
    let (first, last) = (*clone.levels.start(), *clone.levels.end());
    if first == 0 || first > last || last > n_levels {
        return Err(DeformError::BadShare(format!(
            "levels of a clone must lie in 1..={n_levels}, ascending, got {first}..={last}"
        )));
    }
    let cloner = DetailCloner::new(decomposer, schedule, clone.levels.clone(), progress)?;
    let stamp = Stamp {
        source: clone.source,
        target: clone.target,
        radius: clone.radius,
        angle: clone.angle,
        strength: 1.0,
    };
    let mut details = cloner.details().to_vec();
    let mut stamped = cloner.stamp(&stamp, &mut details, progress)?;
    stamped.vertices.sort_unstable();
    let mut points = points.to_vec();
    let mut n_changed = 0;
    for (v, p) in points.iter_mut().enumerate() {
        let x = map.as_slice()[v];
        if stamped.vertices.binary_search(&x).is_ok() {
            let (old, new) = (&cloner.details()[x as usize], &details[x as usize]);
            *p = add_scaled(p, 1.0, &subtract(new, old));
            n_changed += 1;
        }
    }
    let Stamped { n_without_source, distortion, .. } = stamped;
    Ok(Transplanted { points, n_changed, n_without_source, distortion })
}

/// One place to which detail is cloned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    /// Vertex in the middle of the detail, from 0.
    pub source: u32,
    /// Vertex to which the detail goes.
    pub target: u32,
    /// Distance on the coarse shape, in model units, at which the clone has faded out.
    pub radius: f64,
    /// Turn of the detail about the normal, counterclockwise seen from outside, in radians.
    pub angle: f64,
    /// Share of the present detail that is replaced in the middle, in [0, 1].
    pub strength: f64,
}

/// Result of a stamp.
#[derive(Clone, Debug, PartialEq)]
pub struct Stamped {
    /// Welded vertices whose detail was changed, each once.
    pub vertices: Vec<u32>,
    /// Number of vertices within the radius for which the source has no detail, as in [`Transplanted`].
    pub n_without_source: usize,
    /// Largest stretch between the two neighborhoods, as in [`Transplanted`].
    pub distortion: f64,
}

/// A shape prepared for clones of detail: its coarse shape, the detail, and normals.
pub struct DetailCloner {
    decomposer: Decomposer,
    base: Vec<Vector>,
    normals: Vec<Vector>,
    details: Vec<Vector>,
}

impl DetailCloner {
    /// Prepares a shape for clones of the detail of some levels. O(n).
    ///
    /// # Errors
    /// [`DeformError`] if the shape has no positions, the levels do not exist, or the call is cancelled.
    pub fn new(
        decomposer: &Decomposer,
        schedule: &Schedule,
        levels: RangeInclusive<usize>,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        let geometry = decomposer.geometry_for("a clone of detail")?;
        let Some(points) = geometry.shape().points() else { return Err(DeformError::NoPositions) };
        let base = smooth_positions(decomposer, schedule, progress)?;
        let share = |j: usize| f64::from(u8::from(levels.contains(&j)));
        let factors: Vec<f64> = (1..=schedule.n_levels()).map(share).collect();
        let request = decomposer.request(points.as_flattened(), 3, schedule).progress(progress);
        let (details, _) = request.weighted(&factors)?;
        let details = geometry.vertex_map().mean(&details, 3).as_chunks().0.to_vec();
        let normals = base_normals(decomposer, &base, progress)?;
        Ok(Self { decomposer: decomposer.clone(), base, normals, details })
    }

    /// Detail of each welded vertex, in model units.
    pub fn details(&self) -> &[[f64; 3]] {
        &self.details
    }

    /// Replaces the detail around the target, in `details`, by the original detail around the source; it fades into the
    /// present one from half the radius on. O(vertices within the radius).
    ///
    /// # Errors
    /// [`DeformError`] if a vertex does not exist or takes no part, a number is out of range, or the call is cancelled.
    ///
    /// # Panics
    /// Unless `details` has a row for each welded vertex.
    pub fn stamp(
        &self,
        stamp: &Stamp,
        details: &mut [[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Stamped, DeformError> {
        assert_eq!(details.len(), self.details.len(), "a row for each welded vertex");
        check_stamp(&self.decomposer, stamp)?;
        let map = self.decomposer.vertex_map();
        let unroller = Unroller { decomposer: &self.decomposer, base: &self.base, normals: &self.normals };
        let (source, target) = (map.welded(stamp.source as usize), map.welded(stamp.target as usize));
        let from = unroller.root(source, None, 0.0);
        let to = unroller.root(target, Some(&from), stamp.angle);
        // The source must surround each place of the target.
        let from = unroller.unroll(source, from, 1.5 * stamp.radius, progress)?;
        let to = unroller.unroll(target, to, stamp.radius, progress)?;
        let grid = PlaneGrid::new(&from, stamp.radius);
        let mut stamped = Stamped { vertices: Vec::new(), n_without_source: 0, distortion: 1.0 };
        let places: HashMap<u32, [f64; 2]> = to.iter().map(|place| (place.vertex, place.uv)).collect();
        for place in &to {
            stamped.distortion = stamped.distortion.max(unroller.stretch(place, &places));
            let share = (1.0 - place.distance / stamp.radius) / (1.0 - FULL_SHARE);
            let weight = stamp.strength * smooth_rise(share);
            if weight <= 0.0 {
                continue;
            }
            let value = grid.value(&from, &place.uv, |k| {
                let at = &from[k];
                image(&at.frame, &self.details[at.vertex as usize])
            });
            let Some(local) = value else {
                stamped.n_without_source += 1;
                continue;
            };
            let cloned = [0, 1, 2].map(|c| (0..3).map(|k| place.frame[k][c] * local[k]).sum::<f64>());
            let present = &mut details[place.vertex as usize];
            *present = add_scaled(present, weight, &subtract(&cloned, present));
            stamped.vertices.push(place.vertex);
        }
        Ok(stamped)
    }
}

/// Checks the vertices and numbers of a stamp.
fn check_stamp(decomposer: &Decomposer, stamp: &Stamp) -> Result<(), DeformError> {
    let n_vertices = decomposer.n_vertices();
    let map = decomposer.vertex_map();
    for vertex in [stamp.source, stamp.target] {
        if vertex as usize >= n_vertices {
            let region = "the clone".to_owned();
            return Err(DeformError::NoSuchVertex { region, vertex, n_vertices });
        }
        if decomposer.neighbors().row(map.welded(vertex as usize)).is_empty() {
            return Err(DeformError::EmptyRegion { region: format!("the neighborhood of vertex {vertex}") });
        }
    }
    if !(stamp.radius > 0.0 && stamp.radius.is_finite()) {
        return Err(DeformError::BadLength { what: "the radius of a clone", value: stamp.radius });
    }
    if !stamp.angle.is_finite() {
        return Err(DeformError::BadMotion(stamp.angle));
    }
    if !(0.0..=1.0).contains(&stamp.strength) {
        return Err(DeformError::BadShare(format!(
            "the strength of a clone must lie in [0, 1], got {}",
            stamp.strength
        )));
    }
    Ok(())
}

/// A vertex in the map about a root.
#[derive(Clone, Debug)]
struct UnrolledPlace {
    vertex: u32,
    uv: [f64; 2],
    distance: f64,
    /// Rows: two tangents and the normal.
    frame: Matrix,
}

/// Unrolls a coarse shape about one of its vertices.
struct Unroller<'a> {
    decomposer: &'a Decomposer,
    base: &'a [Vector],
    normals: &'a [Vector],
}

impl Unroller<'_> {
    /// Frame at a root: axes of another one turned to its normal and by an angle about it, or any.
    fn root(&self, x: usize, other: Option<&Matrix>, angle: f64) -> Matrix {
        let normal = unit(&self.normals[x]).unwrap_or([0.0, 0.0, 1.0]);
        let toward = if let Some([first, _, up]) = other {
            image(&to_matrix(&smallest_turn(up, &normal)), first)
        } else {
            let least = (1..3).fold(0, |k, c| if normal[c].abs() < normal[k].abs() { c } else { k });
            [0, 1, 2].map(|c| f64::from(u8::from(c == least)))
        };
        let tangent = unit(&add_scaled(&toward, -dot(&toward, &normal), &normal)).unwrap_or([1.0, 0.0, 0.0]);
        let across = cross(&normal, &tangent);
        let (s, c) = angle.sin_cos();
        let first = [0, 1, 2].map(|k| c * tangent[k] + s * across[k]);
        [first, cross(&normal, &first), normal]
    }

    /// Vertices within `radius` of `root` in the map, by paths along edges whose frames turn as little as possible.
    fn unroll(
        &self,
        root: usize,
        frame: Matrix,
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<UnrolledPlace>, DeformError> {
        let start = UnrolledPlace { vertex: root as u32, uv: [0.0; 2], distance: 0.0, frame };
        let mut best: HashMap<u32, UnrolledPlace> = HashMap::from([(root as u32, start)]);
        let mut done: Vec<UnrolledPlace> = Vec::new();
        let mut is_done: HashSet<u32> = HashSet::new();
        let mut heap = BinaryHeap::from([Reverse((0_u64, root as u32))]);
        while let Some(Reverse((_, x))) = heap.pop() {
            progress.check()?;
            if !is_done.insert(x) {
                continue;
            }
            let place = best[&x].clone();
            for &y in self.decomposer.neighbors().row(x as usize) {
                if is_done.contains(&y) {
                    continue;
                }
                let Some(next) = self.step(&place, y).filter(|next| next.distance <= radius) else {
                    continue;
                };
                if best.get(&y).is_none_or(|known| next.distance < known.distance) {
                    heap.push(Reverse((next.distance.to_bits(), y)));
                    best.insert(y, next);
                }
            }
            done.push(place);
        }
        Ok(done)
    }

    /// Place of a neighbor: its edge laid into the tangent plane at full length.
    fn step(&self, place: &UnrolledPlace, y: u32) -> Option<UnrolledPlace> {
        let e = subtract(&self.base[y as usize], &self.base[place.vertex as usize]);
        let normal = match unit(&self.normals[y as usize]) {
            Some(n) if dot(&n, &place.frame[2]) < 0.0 && self.is_cloud() => n.map(|c| -c),
            Some(n) => n,
            None => place.frame[2],
        };
        let turn = to_matrix(&smallest_turn(&place.frame[2], &normal));
        let tangent = image(&turn, &place.frame[0]);
        let tangent = unit(&add_scaled(&tangent, -dot(&tangent, &normal), &normal))?;
        let frame = [tangent, cross(&normal, &tangent), normal];
        // The edge lies between the two tangent planes.
        let mean = |k: usize| [0, 1, 2].map(|c| place.frame[k][c] + frame[k][c]);
        let flat = [dot(&e, &mean(0)), dot(&e, &mean(1))];
        let (length, along) = (norm(&e), flat[0].hypot(flat[1]));
        let scale = if along > 0.0 { length / along } else { 0.0 };
        let uv = [place.uv[0] + scale * flat[0], place.uv[1] + scale * flat[1]];
        Some(UnrolledPlace { vertex: y, uv, distance: uv[0].hypot(uv[1]), frame })
    }

    fn is_cloud(&self) -> bool {
        self.decomposer.geometry().is_none_or(|geometry| geometry.faces().is_empty())
    }

    /// Largest ratio of the distance to a neighbor on the shape and in the map.
    fn stretch(&self, place: &UnrolledPlace, places: &HashMap<u32, [f64; 2]>) -> f64 {
        let ratio = |y: &u32| {
            let uv = places.get(y)?;
            let mapped = (uv[0] - place.uv[0]).hypot(uv[1] - place.uv[1]);
            let length = norm(&subtract(&self.base[*y as usize], &self.base[place.vertex as usize]));
            (mapped > 0.0 && length > 0.0).then(|| (length / mapped).max(mapped / length))
        };
        let around = self.decomposer.neighbors().row(place.vertex as usize);
        around.iter().filter_map(ratio).fold(1.0, f64::max)
    }
}

/// Cells of the plane with the places in them.
struct PlaneGrid {
    cell: f64,
    places: HashMap<[i64; 2], Vec<usize>>,
}

impl PlaneGrid {
    fn new(from: &[UnrolledPlace], radius: f64) -> Self {
        let area = std::f64::consts::PI * radius * radius * 2.25;
        let cell = (area / from.len().max(1) as f64 * FITTED as f64).sqrt().max(1e-6 * radius);
        let mut places: HashMap<_, Vec<usize>> = HashMap::new();
        for (k, place) in from.iter().enumerate() {
            places.entry(Self::key(cell, &place.uv)).or_default().push(k);
        }
        Self { cell, places }
    }

    fn key(cell: f64, uv: &[f64; 2]) -> [i64; 2] {
        uv.map(|c| (c / cell).floor() as i64)
    }

    /// Linear fit to the nearest places at `uv`; the nearest value if they lie on a line. `None` outside.
    fn value(
        &self,
        from: &[UnrolledPlace],
        uv: &[f64; 2],
        value: impl Fn(usize) -> Vector,
    ) -> Option<Vector> {
        let [i, j] = Self::key(self.cell, uv);
        let mut near: Vec<(f64, usize)> = Vec::new();
        for a in i - 1..=i + 1 {
            for b in j - 1..=j + 1 {
                for &k in self.places.get(&[a, b]).into_iter().flatten() {
                    near.push(((from[k].uv[0] - uv[0]).hypot(from[k].uv[1] - uv[1]), k));
                }
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(FITTED);
        let &(nearest, first) = near.first()?;
        if nearest == 0.0 {
            return Some(value(first));
        }
        let spacing = near.last()?.0;
        let apart = near.iter().map(|(_, k)| from[*k].uv).fold(0.0_f64, |largest, other| {
            largest.max((other[0] - from[first].uv[0]).hypot(other[1] - from[first].uv[1]))
        });
        if nearest > OUTSIDE / 6.0 * apart.max(1e-300) {
            return None;
        }
        // Weighted linear fit about uv: the constant of the fit is the value.
        let (mut m, mut right) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        for &(d, k) in &near {
            let t = d / spacing;
            let w = (-4.0 * t * t).exp();
            let row = [1.0, (from[k].uv[0] - uv[0]) / spacing, (from[k].uv[1] - uv[1]) / spacing];
            let v = value(k);
            for a in 0..3 {
                for b in 0..3 {
                    m[a][b] += w * row[a] * row[b];
                    right[a][b] += w * row[a] * v[b];
                }
            }
        }
        let det = crate::rotation::determinant(&m);
        if det.is_nan() || det <= 1e-9 * m[0][0].powi(3) {
            return Some(value(first));
        }
        let cofactors = cross(&m[1], &m[2]);
        Some([0, 1, 2].map(|c| (0..3).map(|a| cofactors[a] * right[a][c]).sum::<f64>() / det))
    }
}
