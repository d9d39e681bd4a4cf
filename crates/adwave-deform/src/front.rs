//! Fronts over the edges of a graph whose vertices have positions.

use adwave::shape::Adjacency;
use adwave::vector::{Vector, norm, subtract};
use adwave::{Cancelled, Progress};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of vertices between two checks for cancellation.
const AT_A_TIME: usize = 1 << 14;

/// Place that no front has reached.
pub(crate) const NO_SOURCE: u32 = u32::MAX;

/// Edges between numbered places in space.
#[derive(Clone, Copy)]
pub(crate) struct PlacedGraph<'a> {
    pub(crate) neighbors: &'a Adjacency,
    pub(crate) points: &'a [Vector],
}

/// Nearest source of each place, by paths along edges, and the distance from it; [`NO_SOURCE`] and ∞ beyond the reach.
pub(crate) struct Reached {
    pub(crate) owner: Vec<u32>,
    pub(crate) distance: Vec<f64>,
}

/// Sources at distances of at least a radius, so that each place is within the radius of one, and the source of each.
pub(crate) struct Cover {
    pub(crate) sources: Vec<u32>,
    /// Number of the nearest source in `sources`; [`NO_SOURCE`] outside.
    pub(crate) owner: Vec<u32>,
}

/// Distance of a front: by the path, or straight from the origin of the path.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum FrontLength {
    Path,
    Straight,
}

impl PlacedGraph<'_> {
    pub(crate) fn length(&self, x: usize, y: usize) -> f64 {
        norm(&subtract(&self.points[x], &self.points[y]))
    }

    /// Advances a front from the places and owners `start` up to `radius`. A place keeps its nearest owner.
    fn advance(&self, reached: &mut Reached, start: &[(u32, u32)], radius: f64, measure: FrontLength) {
        let mut heap = BinaryHeap::new();
        for &(x, owner) in start {
            (reached.owner[x as usize], reached.distance[x as usize]) = (owner, 0.0);
            heap.push(Reverse((0_u64, x, x)));
        }
        // Distances are not negative, so that their bits are in their order.
        while let Some(Reverse((bits, x, origin))) = heap.pop() {
            let (d, x) = (f64::from_bits(bits), x as usize);
            if d > reached.distance[x] {
                continue;
            }
            let owner = reached.owner[x];
            for &y in self.neighbors.row(x) {
                let far = match measure {
                    FrontLength::Path => d + self.length(x, y as usize),
                    FrontLength::Straight => self.length(origin as usize, y as usize),
                };
                if far <= radius && far < reached.distance[y as usize] {
                    (reached.owner[y as usize], reached.distance[y as usize]) = (owner, far);
                    heap.push(Reverse((far.to_bits(), y, origin)));
                }
            }
        }
    }

    /// Nearest of the flagged places within `radius`, as fronts see it.
    pub(crate) fn nearest(&self, sources: &[u32], radius: f64, measure: FrontLength) -> Reached {
        let n = self.points.len();
        let mut reached = Reached { owner: vec![NO_SOURCE; n], distance: vec![f64::INFINITY; n] };
        for &x in sources {
            (reached.owner[x as usize], reached.distance[x as usize]) = (x, 0.0);
        }
        // A front starts at the rim of the sources.
        let is_source = |x: u32| reached.distance[x as usize] == 0.0;
        let at_rim = |x: &&u32| !self.neighbors.row(**x as usize).iter().all(|&y| is_source(y));
        let start: Vec<(u32, u32)> = sources.iter().filter(at_rim).map(|&x| (x, x)).collect();
        self.advance(&mut reached, &start, radius, measure);
        reached
    }

    /// Greedy cover in an order of the places; each source brings its images along.
    pub(crate) fn cover(
        &self,
        sources_from: &impl SourceOrder,
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Cover, Cancelled> {
        let n = self.points.len();
        let mut reached = Reached { owner: vec![NO_SOURCE; n], distance: vec![f64::INFINITY; n] };
        let mut sources = Vec::new();
        for (k, x) in sources_from.order().into_iter().enumerate() {
            if k.is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            if reached.owner[x as usize] != NO_SOURCE {
                continue;
            }
            for y in std::iter::once(x).chain(sources_from.images(x)) {
                if reached.distance[y as usize] > 0.0 {
                    let number = sources.len() as u32;
                    sources.push(y);
                    self.advance(&mut reached, &[(y, number)], radius, FrontLength::Path);
                }
            }
        }
        Ok(Cover { sources, owner: reached.owner })
    }
}

/// Order in which places become sources of a cover.
pub(crate) trait SourceOrder {
    /// Places that take part.
    fn order(&self) -> Vec<u32>;

    /// Places that become sources together with `x`, such as its mirror images.
    fn images(&self, x: u32) -> Vec<u32>;
}

/// Fronts from one place after another over the same graph; each costs only the places that it covers.
pub(crate) struct RepeatedFront<'a> {
    graph: PlacedGraph<'a>,
    reached: Reached,
}

impl<'a> RepeatedFront<'a> {
    pub(crate) fn new(graph: PlacedGraph<'a>) -> Self {
        let n = graph.points.len();
        let reached = Reached { owner: vec![NO_SOURCE; n], distance: vec![f64::INFINITY; n] };
        Self { graph, reached }
    }

    /// Places within `radius` of `x` and their distances, ascending by place.
    pub(crate) fn run(&mut self, x: u32, radius: f64) -> Vec<(u32, f64)> {
        let (mut found, mut heap) = (Vec::new(), BinaryHeap::new());
        self.reached.distance[x as usize] = 0.0;
        heap.push(Reverse((0_u64, x)));
        while let Some(Reverse((bits, x))) = heap.pop() {
            let d = f64::from_bits(bits);
            if d > self.reached.distance[x as usize] {
                continue;
            }
            found.push((x, d));
            for &y in self.graph.neighbors.row(x as usize) {
                let far = d + self.graph.length(x as usize, y as usize);
                if far <= radius && far < self.reached.distance[y as usize] {
                    self.reached.distance[y as usize] = far;
                    heap.push(Reverse((far.to_bits(), y)));
                }
            }
        }
        found.sort_unstable_by_key(|(x, _)| *x);
        found.dedup_by_key(|(x, _)| *x);
        for (x, _) in &found {
            self.reached.distance[*x as usize] = f64::INFINITY;
        }
        found
    }
}
