//! Orientation of the normals of a cloud to one side of its surface, the outer one if there is one.

use super::Adjacency;
use crate::{Cancelled, Progress};
use nalgebra::Vector3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of points that join a tree between two checks for cancellation.
const POINTS_AT_A_TIME: usize = 1 << 10;

/// Cost of a step from or to a point without a normal; such steps come after all others.
const BLIND: f64 = 8.0;

/// Additional cost of a step to one of the further neighbors; such steps come after all steps to nearer ones.
const FAR: f64 = 3.0;

/// Enclosed share of the possible volume below which a part has no outside: a sphere reaches 1, a half sphere 0.5,
/// a terrain a few hundredths.
const ENCLOSED: f64 = 0.1;

/// Share of the area in the sum of the normals up to which a part counts as closed, and share of the possible volume
/// that it encloses at least.
const CLOSED: f64 = 0.1;

/// Orients the unit `normals` of `points` consistently along a spanning tree of each connected part of `near`, and
/// each part outwards. `radius` is the distance of each point's furthest neighbor, which gives the size of its
/// disc. O(edges · log points).
pub(crate) fn orient(
    points: &[[f64; 3]],
    near: &Adjacency,
    radius: &[f64],
    normals: &mut [Vector3<f64>],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let mut tree = SpanningTree {
        points,
        near,
        radius,
        cost: vec![f64::INFINITY; points.len()],
        queue: BinaryHeap::new(),
    };
    for start in 0..points.len() {
        if tree.cost[start] == f64::INFINITY {
            let part = tree.spread(start, normals, progress)?;
            turn_outwards(points, radius, &part, normals);
        }
    }
    Ok(())
}

/// Share of the furthest neighbor's distance within which half of the neighbors of a point on a surface lie.
const NEAR: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Relation of the normals at the two ends of an edge.
pub(super) struct EdgeOrientation {
    /// Cosine between the normal there and the reflection, in the half-way plane, of the normal here: ±1 if both
    /// are normals of one circle.
    pub(super) alike: f64,
    /// Mean squared cosine between the edge and the two normals: 0 along the surface, 1 across it.
    pub(super) across: f64,
    length: f64,
}

impl EdgeOrientation {
    pub(super) fn new([p, q]: [&[f64; 3]; 2], [n, m]: [&Vector3<f64>; 2]) -> Self {
        let way = Vector3::from(*q) - Vector3::from(*p);
        let along = way.try_normalize(0.0).unwrap_or_default();
        let (here, there) = (n.dot(&along), m.dot(&along));
        Self {
            alike: n.dot(m) - 2.0 * here * there,
            across: 0.5 * (here * here + there * there),
            length: way.norm(),
        }
    }

    /// Cost of a step, ≥ 0; the smaller, the more certain the side. `radius` is the larger of the two points'
    /// distances to their furthest neighbors.
    fn cost(&self, [n, m]: [&Vector3<f64>; 2], radius: f64) -> f64 {
        let is_blind = *n == Vector3::zeros() || *m == Vector3::zeros();
        // Across a thin part the reflection is reliable only if the normals are; along the surface it always is.
        let turn = (1.0 - self.alike.abs()).max(0.0) + self.across;
        let is_far = self.length > NEAR * radius;
        (if is_blind { BLIND } else { turn }) + if is_far { FAR } else { 0.0 }
    }
}

/// Propagation of the side of a surface from one point of a cloud to a neighbor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideStep {
    /// Cost ≥ 0, independent of the sides of the normals; a spanning tree takes the smallest first.
    pub cost: f64,
    /// True if the two normals are on different sides.
    pub turns: bool,
}

/// Point of a cloud with the normal of its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointWithNormal {
    /// Position in model units.
    pub position: [f64; 3],
    /// Unit normal, on either side; zero if there is none.
    pub normal: [f64; 3],
    /// Distance of the furthest neighbor, in model units.
    pub radius: f64,
}

/// Step of the spanning tree of `cloud_normals` between two points.
///
/// ```
/// use adwave::signal::{PointWithNormal, side_step};
/// let here = PointWithNormal { position: [0.0, 0.0, 0.0], normal: [0.0, 0.0, 1.0], radius: 1.0 };
/// let there = PointWithNormal { position: [0.5, 0.0, 0.0], normal: [0.0, 0.0, -1.0], radius: 1.0 };
/// let step = side_step(here, there);
/// assert!(step.turns && step.cost == 0.0); // one plane, seen from both sides
/// ```
pub fn side_step(here: PointWithNormal, there: PointWithNormal) -> SideStep {
    let (n, m) = (Vector3::from(here.normal), Vector3::from(there.normal));
    let way = EdgeOrientation::new([&here.position, &there.position], [&n, &m]);
    SideStep { cost: way.cost([&n, &m], here.radius.max(there.radius)), turns: way.alike < 0.0 }
}

/// A step of the tree, ordered by cost, then by the points' order. Costs are ≥ 0, so their bit patterns have the
/// same order.
type TreeStep = Reverse<(u64, u32, u32)>;

/// Prim's algorithm, part by part.
struct SpanningTree<'a> {
    points: &'a [[f64; 3]],
    near: &'a Adjacency,
    radius: &'a [f64],
    /// Smallest cost at which each point was reached so far; −∞ once it is in the tree.
    cost: Vec<f64>,
    queue: BinaryHeap<TreeStep>,
}

impl SpanningTree<'_> {
    /// The points connected to `start`, with their normals oriented like that of `start`.
    fn spread(
        &mut self,
        start: usize,
        normals: &mut [Vector3<f64>],
        progress: Progress<'_>,
    ) -> Result<Vec<u32>, Cancelled> {
        let mut part = vec![start as u32];
        self.cost[start] = f64::NEG_INFINITY;
        self.reach_from(start, normals);
        while let Some(Reverse((_, to, from))) = self.queue.pop() {
            let x = to as usize;
            if self.cost[x] == f64::NEG_INFINITY {
                continue;
            }
            self.cost[x] = f64::NEG_INFINITY;
            part.push(to);
            if part.len().is_multiple_of(POINTS_AT_A_TIME) {
                progress.check()?;
            }
            if self.way(normals, from as usize, x).alike < 0.0 {
                normals[x] = -normals[x];
            }
            self.reach_from(x, normals);
        }
        Ok(part)
    }

    fn way(&self, normals: &[Vector3<f64>], x: usize, y: usize) -> EdgeOrientation {
        EdgeOrientation::new([&self.points[x], &self.points[y]], [&normals[x], &normals[y]])
    }

    fn reach_from(&mut self, x: usize, normals: &[Vector3<f64>]) {
        for &y in self.near.row(x) {
            let known = self.cost[y as usize];
            if known == f64::NEG_INFINITY {
                continue;
            }
            let radius = self.radius[x].max(self.radius[y as usize]);
            let way = self.way(normals, x, y as usize);
            let cost = way.cost([&normals[x], &normals[y as usize]], radius);
            if cost < known {
                self.cost[y as usize] = cost;
                self.queue.push(Reverse((cost.to_bits(), y, x as u32)));
            }
        }
    }
}

/// Sums over the discs of a part with consistent normals, from which its outside follows.
pub(super) struct Enclosure {
    /// Volume of the cones from the center: Σ A n·(x − c).
    volume: f64,
    /// Largest volume that the discs may enclose: Σ A |x − c|.
    moment: f64,
    area: f64,
    /// Σ A n: 0 on a closed surface, and as long as `area` on a flat one.
    sum: Vector3<f64>,
}

impl Enclosure {
    /// Sums over the points of `part`; `normals` and `radius` are those of all points.
    pub(super) fn new(points: &[[f64; 3]], radius: &[f64], part: &[u32], normals: &[Vector3<f64>]) -> Self {
        let position = |x: usize| Vector3::from(points[x]);
        let center = part.iter().map(|&x| position(x as usize) / part.len() as f64).sum::<Vector3<f64>>();
        let mut this = Self { volume: 0.0, moment: 0.0, area: 0.0, sum: Vector3::zeros() };
        // Relative lengths, whose products neither overflow nor underflow.
        let positive = |size: f64| if size > 0.0 { size } else { 1.0 };
        let reach = positive(part.iter().map(|&x| radius[x as usize]).fold(0.0, f64::max));
        let size = positive(part.iter().map(|&x| (position(x as usize) - center).amax()).fold(0.0, f64::max));
        for x in part.iter().map(|&x| x as usize).filter(|&x| normals[x] != Vector3::zeros()) {
            let (disc, offset) = ((radius[x] / reach).powi(2), (position(x) - center) / size);
            this.volume += disc * normals[x].dot(&offset);
            this.moment += disc * offset.norm();
            this.area += disc;
            this.sum += disc * normals[x];
        }
        this
    }

    /// True if the normals point into the volume of a surface that is closed beyond doubt.
    pub(super) fn is_inward(&self) -> bool {
        self.sum.norm() <= CLOSED * self.area && self.volume < -CLOSED * self.moment
    }

    /// True if the normals point outwards, or, where no volume is enclosed, along the positive side of their dominant
    /// axis.
    fn is_outward(&self) -> bool {
        let encloses = self.volume.abs() * self.area > ENCLOSED * self.moment * self.sum.norm();
        (if encloses { self.volume } else { self.sum[self.sum.iamax()] }) >= 0.0
    }
}

/// Orients a part with consistent normals outwards.
fn turn_outwards(points: &[[f64; 3]], radius: &[f64], part: &[u32], normals: &mut [Vector3<f64>]) {
    if !Enclosure::new(points, radius, part, normals).is_outward() {
        for &x in part {
            normals[x as usize] = -normals[x as usize];
        }
    }
}
