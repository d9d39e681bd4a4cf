//! Bounding volume hierarchy of triangles, for the triangle nearest to a point.

use crate::geometry::{Point, nearest_weights, squared_distance};
use adwave::{BackgroundWork, Cancelled, Progress};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

/// Triangles among which the nearest to a point can be found.
pub(crate) trait TriangleSearch {
    /// Returns the squared distance of the nearest triangle, and its index; `None` if the distance is not below
    /// `squared_limit`.
    fn nearest_within(&self, p: Point, squared_limit: f64) -> Option<(f64, u32)>;

    /// Returns the squared distance of the nearest triangle, and its index.
    fn nearest(&self, p: Point) -> (f64, u32) {
        self.nearest_within(p, f64::INFINITY).unwrap_or((f64::INFINITY, 0))
    }

    /// Returns the corners of a triangle.
    fn corners(&self, triangle: u32) -> &[Point; 3];

    /// Returns the triangle beyond the edge from corner `k` to the next one, if there is one and if neighbors are
    /// known.
    fn neighbor_across(&self, triangle: u32, k: usize) -> Option<u32>;

    /// Returns the squared distance of a triangle near a point, and its index, found from `start` by moving to nearer
    /// and nearer neighbors. Another triangle may be nearer.
    fn descend(&self, p: Point, start: u32) -> (f64, u32) {
        let mut best = (squared_distance(p, self.corners(start)), start);
        for _ in 0..MAX_STEPS {
            let weights = nearest_weights(p, self.corners(best.1));
            let from = best.1;
            // The nearest point lies on the edges opposite to the corners without weight.
            for k in (0..3).filter(|&k| weights[(k + 2) % 3] <= 0.0) {
                if let Some(next) = self.neighbor_across(from, k) {
                    let distance = squared_distance(p, self.corners(next));
                    if distance < best.0 {
                        best = (distance, next);
                    }
                }
            }
            if best.1 == from {
                break;
            }
        }
        best
    }

    /// Returns the squared distance of the nearest triangle, and its index; `start` is a triangle that is probably
    /// near.
    fn nearest_from(&self, p: Point, start: u32) -> (f64, u32) {
        let near = self.descend(p, start);
        self.nearest_within(p, near.0).unwrap_or(near)
    }
}

/// Largest number of steps to a nearer neighbor.
const MAX_STEPS: usize = 32;

/// Marker of an edge without a neighbor.
const NONE: u32 = u32::MAX;

/// Triangles in a bounding volume hierarchy.
pub(crate) struct TriangleSurface {
    corners: Vec<[Point; 3]>,
    /// Triangle beyond the edge from each corner to the next one, or `NONE`.
    neighbors: Vec<[u32; 3]>,
    bvh: Bvh,
}

/// Surface whose hierarchy is being built by a thread of its own. The library cannot be stopped; a caller that stops
/// drops this and leaves the thread behind, which ends when the hierarchy is done.
pub(crate) struct StartedSurface(BackgroundWork<(Vec<[Point; 3]>, Bvh)>);

impl StartedSurface {
    /// Starts to build the hierarchy; `None` without triangles, or without a thread.
    pub(crate) fn new(points: &[Point], triangles: &[[u32; 3]]) -> Option<Self> {
        let corners = corners_of(points, triangles);
        let build = move || {
            let bvh = build_hierarchy(&corners);
            (corners, bvh)
        };
        (!triangles.is_empty()).then(|| BackgroundWork::start(build).map(Self)).flatten()
    }

    /// Waits for the surface, of the same points and triangles; `None` if the thread panicked.
    pub(crate) fn finish(
        self,
        points: &[Point],
        triangles: &[[u32; 3]],
        progress: Progress<'_>,
    ) -> Result<Option<TriangleSurface>, Cancelled> {
        progress.check()?;
        let neighbors = neighbors_of(points.len(), triangles);
        let built = self.0.finish(progress)?;
        Ok(built.map(|(corners, bvh)| TriangleSurface { corners, neighbors, bvh }))
    }
}

fn corners_of(points: &[Point], triangles: &[[u32; 3]]) -> Vec<[Point; 3]> {
    triangles.iter().map(|t| t.map(|x| points[x as usize])).collect()
}

fn build_hierarchy(corners: &[[Point; 3]]) -> Bvh {
    let bounds = |triangle: &[Point; 3]| {
        let fold = |pick: fn(f64, f64) -> f64| -> Point {
            std::array::from_fn(|c| pick(pick(triangle[0][c], triangle[1][c]), triangle[2][c]))
        };
        Aabb::new(Vector::from(fold(f64::min)), Vector::from(fold(f64::max)))
    };
    Bvh::from_iter(BvhBuildStrategy::Binned, corners.iter().map(bounds).enumerate())
}

impl TriangleSurface {
    /// Builds the hierarchy in O(triangles log triangles); `None` without triangles.
    pub(crate) fn new(points: &[Point], triangles: &[[u32; 3]]) -> Option<Self> {
        if triangles.is_empty() {
            return None;
        }
        let corners = corners_of(points, triangles);
        let build = || build_hierarchy(&corners);
        let (bvh, neighbors) = rayon::join(build, || neighbors_of(points.len(), triangles));
        Some(Self { corners, neighbors, bvh })
    }

    /// Number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }
}

impl TriangleSearch for TriangleSurface {
    fn nearest_within(&self, p: Point, squared_limit: f64) -> Option<(f64, u32)> {
        let to_box = |node: &BvhNode, _: f64| {
            let (low, high) = (node.mins(), node.maxs());
            let outside = |x: f64, low: f64, high: f64| (low - x).max(x - high).max(0.0);
            let (x, y, z) =
                (outside(p[0], low.x, high.x), outside(p[1], low.y, high.y), outside(p[2], low.z, high.z));
            x * x + y * y + z * z
        };
        let to_triangle = |t: u32, _: f64| Some(squared_distance(p, &self.corners[t as usize]));
        let found = self.bvh.find_best(squared_limit, to_box, to_triangle);
        found.map(|(triangle, distance)| (distance, triangle))
    }

    fn corners(&self, triangle: u32) -> &[Point; 3] {
        &self.corners[triangle as usize]
    }

    fn neighbor_across(&self, triangle: u32, k: usize) -> Option<u32> {
        Some(self.neighbors[triangle as usize][k]).filter(|&other| other != NONE)
    }
}

/// Finds the triangle beyond the edge from each corner to the next one; three or more triangles at one edge follow each
/// other in a cycle. O(triangles) for vertices of bounded degree.
fn neighbors_of(n_points: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let ends = |t: &[u32; 3], k: usize| (t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3]));
    let mut starts = vec![0_u32; n_points + 1];
    for t in triangles {
        for k in 0..3 {
            starts[ends(t, k).0 as usize + 1] += 1;
        }
    }
    for x in 0..n_points {
        starts[x + 1] += starts[x];
    }
    // The other end of the edges at each point, with the triangle and the corner.
    let mut edges = vec![(0_u32, 0_u32, 0_u8); 3 * triangles.len()];
    let mut next = starts.clone();
    for (i, t) in (0..).zip(triangles) {
        for k in 0..3 {
            let (low, high) = ends(t, k);
            edges[next[low as usize] as usize] = (high, i, k as u8);
            next[low as usize] += 1;
        }
    }
    let mut neighbors = vec![[NONE; 3]; triangles.len()];
    for x in 0..n_points {
        let at_point = &mut edges[starts[x] as usize..starts[x + 1] as usize];
        at_point.sort_unstable();
        for same in at_point.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            for (j, &(_, t, k)) in same.iter().enumerate() {
                neighbors[t as usize][usize::from(k)] = same[(j + 1) % same.len()].1;
            }
        }
    }
    neighbors
}

/// List of a few triangles, which are searched one by one.
#[derive(Default)]
pub(crate) struct TriangleList {
    pub(crate) ids: Vec<u32>,
    pub(crate) wedges: Vec<[u32; 3]>,
    pub(crate) corners: Vec<[Point; 3]>,
}

impl TriangleList {
    pub(crate) fn clear(&mut self) {
        self.ids.clear();
        self.wedges.clear();
        self.corners.clear();
    }

    pub(crate) fn push(&mut self, id: u32, wedges: [u32; 3], corners: [Point; 3]) {
        self.ids.push(id);
        self.wedges.push(wedges);
        self.corners.push(corners);
    }
}

impl TriangleSearch for TriangleList {
    fn nearest_within(&self, p: Point, squared_limit: f64) -> Option<(f64, u32)> {
        let distances = self.corners.iter().map(|corners| squared_distance(p, corners));
        let nearer = |best: (f64, u32), (k, d): (usize, f64)| if d < best.0 { (d, k as u32) } else { best };
        let (distance, near) = distances.enumerate().fold((f64::INFINITY, 0), nearer);
        (distance < squared_limit).then_some((distance, near))
    }

    fn corners(&self, triangle: u32) -> &[Point; 3] {
        &self.corners[triangle as usize]
    }

    fn neighbor_across(&self, _: u32, _: usize) -> Option<u32> {
        None
    }
}
