//! Triangles that pierce each other after a deformation and did not before.

use crate::DeformError;
use crate::coarse_base::ROWS_AT_A_TIME;
use adwave::vector::{Vector, cross, dot, norm, subtract};
use adwave::{BackgroundWork, Decomposer, Progress};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;
use std::collections::HashMap;

/// Volume, relative to the cubed mean edge, below which four points count as lying in a plane: parts that move rigidly
/// stay flat up to rounding.
const FLAT: f64 = 1e-9;

/// Crossings of a deformed mesh that the mesh before did not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NewCrossings {
    /// Number of pairs of triangles that pierce each other without a common corner.
    pub n_pairs: usize,
    /// Connected places where triangles cross, those with the most pairs first.
    pub places: Vec<CrossingPlace>,
}

/// Place where a surface crosses itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingPlace {
    /// A vertex of the place, as a vertex of the shape.
    pub vertex: u32,
    /// Mean of the centers of the place's triangles in model units.
    pub point: [f64; 3],
    /// Number of pairs of triangles.
    pub n_pairs: usize,
}

/// Pairs of triangles of `after` that pierce each other and did not in the shape itself; `after` has a position for
/// each vertex of the shape. Triangles with a common corner are not compared. None in a cloud. O(n log n) and
/// O(pairs of overlapping boxes).
///
/// ```
/// use adwave::{Decomposer, Progress, shape::{Mesh, Polygons, Shape}};
/// use adwave_deform::new_crossings;
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.2, 1.0], [0.3, 0.2, 1.0], [0.2, 0.3, 2.0]];
/// let mesh = Mesh::new(points.clone(), Polygons::from_triangles(&[[0, 1, 2], [3, 4, 5]]))?;
/// let decomposer = Decomposer::new(&Shape::Mesh(mesh));
/// let mut after = points;
/// assert_eq!(new_crossings(&decomposer, &after, Progress::none())?.n_pairs, 0);
/// after[3][2] = -1.0;
/// let found = new_crossings(&decomposer, &after, Progress::none())?;
/// assert_eq!((found.n_pairs, found.places.len()), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DeformError::NoPositions`] for a graph without positions, [`DeformError::Cancelled`].
///
/// # Panics
/// Unless there is a position for each vertex.
pub fn new_crossings(
    decomposer: &Decomposer,
    after: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<NewCrossings, DeformError> {
    let map = decomposer.vertex_map();
    assert_eq!(after.len(), map.n_vertices(), "a position for each vertex");
    let pairs = crossing_pairs(decomposer, &map.positions(after), progress)?;
    let places = places(decomposer, after, &pairs);
    Ok(NewCrossings { n_pairs: pairs.len(), places })
}

/// New crossing pairs of triangles for welded positions, ascending.
pub(crate) fn crossing_pairs(
    decomposer: &Decomposer,
    after: &[Vector],
    progress: Progress<'_>,
) -> Result<Vec<(u32, u32)>, DeformError> {
    let geometry = decomposer.geometry_for("a search for crossings")?;
    let triangles = geometry.triangles();
    let surface = |points| PlacedTriangles { points, triangles };
    let (before, after) = (surface(geometry.points()), surface(after));
    if triangles.is_empty() {
        return Ok(Vec::new());
    }
    let flat = FLAT * after.mean_edge().powi(3);
    let bounds: Vec<Aabb> = (0..triangles.len()).into_par_iter().map(|f| after.bounds(f)).collect();
    let bvh = build_hierarchy(&bounds, progress)?;
    let chunks: Vec<Vec<(u32, u32)>> = (0..triangles.len().div_ceil(ROWS_AT_A_TIME))
        .into_par_iter()
        .map(|chunk| {
            let mut pairs = Vec::new();
            if progress.is_cancelled() {
                return pairs;
            }
            for f in chunk * ROWS_AT_A_TIME..triangles.len().min((chunk + 1) * ROWS_AT_A_TIME) {
                for g in bvh.intersect_aabb(&bounds[f]).filter(|&g| g as usize > f) {
                    let others = &triangles[g as usize];
                    let is_apart = !triangles[f].iter().any(|x| others.contains(x));
                    if is_apart && after.cross(f, g as usize, flat) && !before.cross(f, g as usize, flat) {
                        pairs.push((f as u32, g));
                    }
                }
            }
            pairs
        })
        .collect();
    progress.check()?;
    let mut pairs = chunks.concat();
    pairs.sort_unstable();
    Ok(pairs)
}

/// The hierarchy of some boxes. The library cannot be stopped, so that it works on a thread of its own.
fn build_hierarchy(bounds: &[Aabb], progress: Progress<'_>) -> Result<Bvh, DeformError> {
    let own = bounds.to_vec();
    let started = BackgroundWork::start(move || Bvh::from_leaves(BvhBuildStrategy::Binned, &own));
    let built = started.map(|started| started.finish(progress)).transpose()?.flatten();
    // Without a thread it is built here.
    Ok(built.unwrap_or_else(|| Bvh::from_leaves(BvhBuildStrategy::Binned, bounds)))
}

/// Triangles with positions of their corners.
struct PlacedTriangles<'a> {
    points: &'a [Vector],
    triangles: &'a [[u32; 3]],
}

impl PlacedTriangles<'_> {
    fn corners(&self, f: usize) -> [&Vector; 3] {
        self.triangles[f].map(|x| &self.points[x as usize])
    }

    fn mean_edge(&self) -> f64 {
        let share = 1.0 / self.triangles.len() as f64;
        let first = |f: usize| norm(&subtract(self.corners(f)[1], self.corners(f)[0]));
        (0..self.triangles.len()).map(|f| share * first(f)).sum()
    }

    fn bounds(&self, f: usize) -> Aabb {
        let corners = self.corners(f);
        let fold = |pick: fn(f64, f64) -> f64| -> [f64; 3] {
            [0, 1, 2].map(|c| pick(pick(corners[0][c], corners[1][c]), corners[2][c]))
        };
        Aabb::new(ParryVector::from(fold(f64::min)), ParryVector::from(fold(f64::max)))
    }

    /// True if an edge of one triangle pierces the other.
    fn cross(&self, f: usize, g: usize, flat: f64) -> bool {
        let cuts = |f: usize, g: usize| {
            let (edge, face) = (self.corners(f), self.corners(g));
            (0..3).any(|k| pierces(edge[k], edge[(k + 1) % 3], face, flat))
        };
        cuts(f, g) || cuts(g, f)
    }
}

/// True if a segment goes through a triangle.
fn pierces(a: &Vector, b: &Vector, t: [&Vector; 3], flat: f64) -> bool {
    let volume = |p: &Vector, q: &Vector, r: &Vector, s: &Vector| {
        dot(&subtract(q, p), &cross(&subtract(r, p), &subtract(s, p)))
    };
    let (u, v) = (volume(a, t[0], t[1], t[2]), volume(b, t[0], t[1], t[2]));
    if u * v >= 0.0 || u.abs().min(v.abs()) < flat {
        return false;
    }
    let s = [0, 1, 2].map(|k| volume(a, b, t[k], t[(k + 1) % 3]));
    s.iter().all(|c| *c > 0.0) || s.iter().all(|c| *c < 0.0)
}

/// Connected places of crossing pairs: triangles of a pair and triangles with a common corner belong together.
fn places(decomposer: &Decomposer, after: &[[f64; 3]], pairs: &[(u32, u32)]) -> Vec<CrossingPlace> {
    let Some(geometry) = decomposer.geometry().filter(|_| !pairs.is_empty()) else { return Vec::new() };
    let triangles = geometry.triangles();
    let mut root: HashMap<u32, u32> = HashMap::new();
    let find = |root: &mut HashMap<u32, u32>, mut x: u32| {
        loop {
            let up = *root.entry(x).or_insert(x);
            if up == x {
                return x;
            }
            let next = *root.get(&up).unwrap_or(&up);
            root.insert(x, next);
            x = next;
        }
    };
    for &(f, g) in pairs {
        let corners = triangles[f as usize].iter().chain(&triangles[g as usize]);
        let first = find(&mut root, triangles[f as usize][0]);
        for &x in corners {
            let other = find(&mut root, x);
            let (low, high) = (first.min(other), first.max(other));
            let (low, high) = (find(&mut root, low), find(&mut root, high));
            root.insert(low.max(high), low.min(high));
        }
    }
    let positions = decomposer.vertex_map().positions(after);
    let mut first_vertex = vec![u32::MAX; geometry.n_vertices()];
    for (v, &x) in (0..).zip(decomposer.vertex_map().as_slice()) {
        first_vertex[x as usize] = first_vertex[x as usize].min(v);
    }
    let mut found: HashMap<u32, CrossingPlace> = HashMap::new();
    for &(f, g) in pairs {
        let own = find(&mut root, triangles[f as usize][0]);
        let vertex = first_vertex[triangles[f as usize][0] as usize];
        let place = found.entry(own).or_insert(CrossingPlace { vertex, point: [0.0; 3], n_pairs: 0 });
        place.n_pairs += 1;
        for &x in triangles[f as usize].iter().chain(&triangles[g as usize]) {
            for (sum, c) in place.point.iter_mut().zip(&positions[x as usize]) {
                *sum += c / 6.0;
            }
        }
    }
    let mut places: Vec<CrossingPlace> = found.into_values().collect();
    for place in &mut places {
        place.point = place.point.map(|c| c / place.n_pairs as f64);
    }
    places.sort_by_key(|place| (std::cmp::Reverse(place.n_pairs), place.vertex));
    places
}
