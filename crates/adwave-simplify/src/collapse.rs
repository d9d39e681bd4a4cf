//! Edge collapses in the order of the quadric error, which keep the topology.
//!
//! Libraries: meshoptimizer (C++) is faster, but it collapses across rings of three edges, so that manifold meshes
//! become non-manifold; it drops small parts, and cannot be asked about a collapse before it carries it out. Of the
//! Rust libraries, `meshopt-rs` is a port of an early version without a release since 2021; `baby_shark` and `alum`
//! collapse half-edges, and therefore reject or drop non-manifold parts and move vertices.
//!
//! A vertex is removed by moving it to a neighbor, so that a subset of the vertices remains. Its cost is the mean
//! squared distance of the neighbor from the planes around the vertex and around all vertices that were moved there.

use crate::certificate::Certificates;
use crate::colors::WedgeColors;
use crate::connectivity::{Collapse, Connectivity, Turning};
use crate::geometry::{dot, length, minus, nearest_weights, squared_distance};
use crate::quadric::Quadric;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cost per squared edge length, which orders the collapses of flat parts.
const LENGTH_COST: f64 = 1e-9;

/// Number of tried collapses between two checks for cancellation.
const TRIES_PER_CHECK: u64 = 1 << 12;

/// Largest number of times that the waiting time of a vertex without a collapse is doubled.
const MAX_DOUBLINGS: u32 = 6;

/// Next collapse of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Candidate {
    cost: f64,
    target: u32,
    stamp: u32,
    /// True if the cost includes the change of colors.
    is_exact: bool,
}

/// Entry of the heap: the cost in single precision, whose bits have the order of nonnegative numbers, and the vertex.
/// The smallest cost comes first; of equal costs, the smallest vertex.
fn entry(cost: f64, vertex: u32) -> Reverse<u64> {
    Reverse(u64::from((cost as f32).to_bits()) << 32 | u64::from(vertex))
}

/// Cost of an entry of the heap.
fn cost_of(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

/// Number of changes around a vertex after which a failed collapse is tried again.
#[derive(Clone, Copy, Debug, Default)]
struct Retry {
    n_failures: u32,
    stamp: u32,
}

/// State of the collapses of a mesh.
pub(crate) struct Collapser<'a> {
    pub(crate) connectivity: Connectivity,
    pub(crate) quadrics: Vec<Quadric>,
    colors: Option<&'a WedgeColors>,
    pub(crate) certificates: Option<Certificates<'a>>,
    turning: Turning,
    /// Number of changes of the faces around each vertex.
    stamps: Vec<u32>,
    /// True for vertices with a candidate in the heap; an outdated candidate is ranked again when it comes first.
    is_queued: Vec<bool>,
    retries: Vec<Retry>,
    /// Candidates of the vertices in the heap.
    candidates: Vec<Candidate>,
    heap: BinaryHeap<Reverse<u64>>,
    plan: Collapse,
    neighbors: Vec<u32>,
    changed: Vec<u32>,
}

impl<'a> Collapser<'a> {
    /// Collapses of a mesh, whose positions have the given quadrics.
    pub(crate) fn new(
        connectivity: Connectivity,
        quadrics: Vec<Quadric>,
        colors: Option<&'a WedgeColors>,
        certificates: Option<Certificates<'a>>,
    ) -> Self {
        let n = connectivity.n_positions();
        Self {
            connectivity,
            quadrics,
            colors,
            certificates,
            turning: Turning::Limited,
            stamps: vec![0; n],
            is_queued: vec![false; n],
            retries: vec![Retry::default(); n],
            candidates: vec![Candidate::default(); n],
            heap: BinaryHeap::new(),
            plan: Collapse::default(),
            neighbors: Vec::new(),
            changed: Vec::new(),
        }
    }

    /// Lists the collapses of all positions that turn faces by at most the given angle. O(positions).
    pub(crate) fn start(&mut self, turning: Turning, progress: Progress<'_>) -> Result<(), Cancelled> {
        self.turning = turning;
        self.fill_heap(progress)
    }

    /// Costs of the collapses that are listed, in any order. Some of them may have changed since.
    pub(crate) fn costs(&self) -> impl Iterator<Item = f32> + '_ {
        self.heap.iter().map(|&Reverse(entry)| cost_of(entry))
    }

    /// Collapses edges, cheapest first, until at most `n_left` of `n` vertices remain, no collapse is possible, or each
    /// costs more than `highest`, and returns the number of remaining vertices. `vertex` has the vertex of each wedge.
    /// O(n log n) for vertices of bounded degree.
    pub(crate) fn run(
        &mut self,
        n: usize,
        n_left: usize,
        highest: f32,
        vertex: &[u32],
        progress: Progress<'_>,
    ) -> Result<usize, Cancelled> {
        let (mut remaining, mut n_tries) = (n, 0_u64);
        while remaining > n_left {
            progress.check()?;
            let Some(Reverse(first)) = self.heap.pop() else { break };
            if cost_of(first) > highest {
                self.heap.push(Reverse(first));
                break;
            }
            let u = first as u32;
            if self.candidates[u as usize].stamp != self.stamps[u as usize] {
                let Some(best) = self.best_candidate(u) else {
                    self.is_queued[u as usize] = false;
                    continue;
                };
                self.candidates[u as usize] = best;
                let entry = entry(best.cost, u);
                if self.heap.peek().is_some_and(|next| *next > entry) {
                    self.heap.push(entry);
                    continue;
                }
            }
            n_tries += 1;
            if n_tries.is_multiple_of(TRIES_PER_CHECK) {
                progress.step((n - remaining) as u64, (n - n_left) as u64)?;
            }
            if self.try_candidate(u) {
                remaining -= self.n_removed(vertex);
                self.update();
            }
        }
        Ok(remaining)
    }

    /// Number of vertices that the last collapse removed; `vertex` has the vertex of each wedge.
    fn n_removed(&self, vertex: &[u32]) -> usize {
        let wedges = &self.plan.wedges;
        let is_first = |k: usize| {
            let name = |j: usize| vertex[wedges[j].0 as usize];
            (0..k).all(|j| name(j) != name(k))
        };
        (0..wedges.len()).filter(|&k| is_first(k)).count()
    }

    fn fill_heap(&mut self, progress: Progress<'_>) -> Result<(), Cancelled> {
        progress.check()?;
        let n = self.connectivity.n_positions() as u32;
        let candidate = |neighbors: &mut Vec<u32>, u: u32| {
            if progress.is_cancelled() {
                return None;
            }
            let best = next_target(&self.connectivity, &self.quadrics[u as usize], u, None, neighbors);
            best.map(|best| Candidate { stamp: self.stamps[u as usize], ..best })
        };
        let candidates: Vec<Option<Candidate>> =
            (0..n).into_par_iter().map_init(Vec::new, candidate).collect();
        progress.check()?;
        self.is_queued = candidates.iter().map(Option::is_some).collect();
        self.retries.fill(Retry::default());
        let entries = (0..n).zip(&candidates);
        self.heap = entries.filter_map(|(u, best)| best.map(|best| entry(best.cost, u))).collect();
        self.candidates = candidates.into_iter().map(Option::unwrap_or_default).collect();
        Ok(())
    }

    /// Finds the cheapest collapse of a vertex.
    fn best_candidate(&mut self, u: u32) -> Option<Candidate> {
        self.next_candidate(u, None)
    }

    /// Finds the cheapest collapse of a vertex, or the next one after the collapse to the target `last`.
    fn next_candidate(&mut self, u: u32, last: Option<u32>) -> Option<Candidate> {
        let quadric = &self.quadrics[u as usize];
        let next = next_target(&self.connectivity, quadric, u, last, &mut self.neighbors);
        next.map(|next| Candidate { stamp: self.stamps[u as usize], ..next })
    }

    /// Carries out the candidate collapse of a vertex if it is possible, and returns `true`; otherwise queues the next
    /// one.
    fn try_candidate(&mut self, u: u32) -> bool {
        let candidate = self.candidates[u as usize];
        let is_planned = self.connectivity.plan(u, candidate.target, self.turning, &mut self.plan);
        let color_cost = if is_planned && !candidate.is_exact { self.color_cost() } else { 0.0 };
        if color_cost > 0.0 {
            self.queue(u, Candidate { cost: candidate.cost + color_cost, is_exact: true, ..candidate });
        } else if is_planned && self.is_allowed() {
            self.carry_out();
            return true;
        } else if let Some(next) = self.next_candidate(u, Some(candidate.target)) {
            self.queue(u, Candidate { cost: next.cost.max(candidate.cost), ..next });
        } else {
            self.postpone(u);
        }
        false
    }

    fn queue(&mut self, u: u32, candidate: Candidate) {
        self.candidates[u as usize] = candidate;
        self.heap.push(entry(candidate.cost, u));
        self.is_queued[u as usize] = true;
    }

    /// Postpones a vertex that has no collapse until the next change around it. If every try needs a proof, the vertex
    /// waits for twice as many changes as before.
    fn postpone(&mut self, u: u32) {
        let (retry, stamp) = (&mut self.retries[u as usize], self.stamps[u as usize]);
        let wait = if self.certificates.is_some() { 1 << retry.n_failures.min(MAX_DOUBLINGS) } else { 1 };
        *retry = Retry { n_failures: retry.n_failures + 1, stamp: stamp + wait };
        self.is_queued[u as usize] = false;
    }

    fn is_allowed(&mut self) -> bool {
        let (connectivity, plan) = (&self.connectivity, &self.plan);
        self.certificates.as_mut().is_none_or(|certificates| certificates.allows(connectivity, plan))
    }

    fn carry_out(&mut self) {
        if let Some(certificates) = &mut self.certificates {
            certificates.commit(&self.plan);
        }
        self.connectivity.apply(&self.plan);
        let removed = std::mem::take(&mut self.quadrics[self.plan.from as usize]);
        self.quadrics[self.plan.to as usize].add(&removed);
        self.stamps[self.plan.from as usize] += 1;
    }

    /// Marks the candidates of the vertices around the last collapse as outdated, and finds new ones for vertices
    /// without a candidate.
    fn update(&mut self) {
        // The faces around other neighbors of the target are as before, and so are their costs.
        let moved = self.plan.moved.iter().map(|(_, wedges)| *wedges).chain(self.plan.gone.iter().copied());
        let mut changed = std::mem::take(&mut self.changed);
        changed.clear();
        changed.extend(moved.flatten().map(|wedge| self.connectivity.position(wedge)));
        changed.sort_unstable();
        changed.dedup();
        changed.retain(|&u| u != self.plan.from);
        for &u in &changed {
            let stamp = &mut self.stamps[u as usize];
            *stamp += 1;
            let stamp = *stamp;
            if self.is_queued[u as usize] || stamp < self.retries[u as usize].stamp {
                continue;
            }
            if let Some(candidate) = self.best_candidate(u) {
                self.queue(u, candidate);
            }
        }
        self.changed = changed;
    }

    /// Squared length by which the planned collapse moves colors: the square of the change at the removed vertex times
    /// the edge length.
    fn color_cost(&self) -> f64 {
        let Some(colors) = self.colors else { return 0.0 };
        let p = self.connectivity.point(self.plan.from);
        let edge = length(minus(self.connectivity.point(self.plan.to), p));
        let change = |&(from, to): &(u32, u32)| {
            let faces = self.plan.moved.iter().filter(|(_, wedges)| wedges.contains(&to));
            let nearest = faces
                .map(|&(_, wedges)| (squared_distance(p, &self.connectivity.corners(wedges)), wedges))
                .fold((f64::INFINITY, [to; 3]), |best, at| if at.0 < best.0 { at } else { best })
                .1;
            let weights = nearest_weights(p, &self.connectivity.corners(nearest));
            colors.difference(from, nearest, weights)
        };
        let greatest = self.plan.wedges.iter().map(change).fold(0.0, f64::max);
        (greatest * edge) * (greatest * edge)
    }
}

/// Finds the cheapest collapse of a vertex, or the next one after the collapse to the target `last`; of equal costs,
/// the collapse to the smallest target. `neighbors` is scratch space.
fn next_target(
    connectivity: &Connectivity,
    quadric: &Quadric,
    u: u32,
    last: Option<u32>,
    neighbors: &mut Vec<u32>,
) -> Option<Candidate> {
    connectivity.targets(u, neighbors);
    let p = connectivity.point(u);
    let cost = |v: u32| {
        let q = connectivity.point(v);
        let edge = minus(q, p);
        quadric.mean(q) + LENGTH_COST * dot(edge, edge)
    };
    let is_before = |a: (f64, u32), b: (f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).is_lt();
    let last = last.map(|v| (cost(v), v));
    let mut best: Option<(f64, u32)> = None;
    for &v in neighbors.iter() {
        let next = (cost(v), v);
        if last.is_none_or(|last| is_before(last, next)) && best.is_none_or(|best| is_before(next, best)) {
            best = Some(next);
        }
    }
    best.map(|(cost, target)| Candidate { cost, target, ..Candidate::default() })
}
