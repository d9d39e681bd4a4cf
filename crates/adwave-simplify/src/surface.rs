//! Triangles in a bounding volume hierarchy, and the nearest one to a point.

use crate::geometry::{Point, squared_distance};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

/// Triangles among which the nearest to a point can be found.
pub(crate) trait TriangleSearch {
    /// Returns the squared distance of the nearest triangle, and its index; `None` if it is not below a squared distance.
    fn nearest_within(&self, p: Point, squared_limit: f64) -> Option<(f64, u32)>;

    /// Returns the squared distance of the nearest triangle, and its index.
    fn nearest(&self, p: Point) -> (f64, u32) {
        self.nearest_within(p, f64::INFINITY).unwrap_or((f64::INFINITY, 0))
    }

    /// Returns the corners of a triangle.
    fn corners(&self, triangle: u32) -> &[Point; 3];
}

/// Triangles in a bounding volume hierarchy.
pub(crate) struct TriangleSurface {
    corners: Vec<[Point; 3]>,
    bvh: Bvh,
}

impl TriangleSurface {
    /// Builds the hierarchy in O(triangles log triangles); `None` without triangles.
    pub(crate) fn new(points: &[Point], triangles: &[[u32; 3]]) -> Option<Self> {
        if triangles.is_empty() {
            return None;
        }
        let corners: Vec<[Point; 3]> = triangles.iter().map(|t| t.map(|x| points[x as usize])).collect();
        let bounds = |triangle: &[Point; 3]| {
            let fold = |pick: fn(f64, f64) -> f64| -> Point {
                std::array::from_fn(|c| pick(pick(triangle[0][c], triangle[1][c]), triangle[2][c]))
            };
            Aabb::new(Vector::from(fold(f64::min)), Vector::from(fold(f64::max)))
        };
        let bvh = Bvh::from_iter(BvhBuildStrategy::Binned, corners.iter().map(bounds).enumerate());
        Some(Self { corners, bvh })
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
}

/// A few triangles, searched one by one.
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
}
