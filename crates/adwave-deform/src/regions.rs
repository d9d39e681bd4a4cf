//! Regions that are held or moved, and the share of each vertex that follows them.

use crate::DeformError;
use crate::coarse_base::{BlendRow, BlendRows, CoarseBase, normalize, smooth_rise};
use crate::front::{FrontLength, NO_SOURCE, PlacedGraph};
use adwave::vector::{Vector, norm, subtract};
use adwave::{Decomposer, Progress};

/// Reach of a handle's ramp in widths σ_J.
const RAMP: f64 = 1.5;

/// Share of its weight that the regions must leave to a node for it to be free.
const LEAST_FREE: f64 = 0.05;

/// Number of pairs of samples that are compared at most for a part without a handle.
const MAX_PAIRS: usize = 1 << 24;

/// Vertices that a deformation holds or moves, as vertices of the shape.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeformRegions {
    /// Vertices that stay where they are; may be empty, and the shape then follows its handles as a whole.
    pub fixed: Vec<u32>,
    /// Vertices of each handle, at least one.
    pub handles: Vec<Vec<u32>>,
}

/// A held or moved region: welded vertices.
#[derive(Clone, Debug)]
pub(crate) struct BoundRegion {
    pub(crate) vertices: Vec<u32>,
    /// Mean of its vertices on the base, in units of the nodes.
    pub(crate) center: Vector,
    /// A single point, whose rotation is free.
    pub(crate) is_point: bool,
}

/// A connected part without a handle, and the vertex of another part that it follows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FollowingPart {
    pub(crate) anchor: u32,
    pub(crate) n_vertices: usize,
}

/// Shares of nodes, regions and anchors at each vertex. Columns are nodes, then regions, then following parts.
#[derive(Clone, Debug)]
pub(crate) struct BoundRows {
    pub(crate) rows: BlendRows,
    pub(crate) regions: Vec<BoundRegion>,
    pub(crate) followers: Vec<FollowingPart>,
    /// Region of each welded vertex; [`NO_SOURCE`] outside.
    pub(crate) region_of: Vec<u32>,
}

impl BoundRows {
    pub(crate) fn new(
        decomposer: &Decomposer,
        base: &CoarseBase,
        regions: &DeformRegions,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        let (bound, region_of) = bind_regions(decomposer, base, regions)?;
        let ramps = ramps(decomposer, base, &bound);
        progress.check()?;
        let held = ShareOfRegions { region_of: &region_of, ramps: &ramps };
        let (followers, follower_of) = following_parts(base, &region_of);
        let (n_nodes, n_regions) = (base.nodes.len() as u32, bound.len() as u32);
        let is_free = free_nodes(base, &held);
        let rows = BlendRows::from_rows(base.points.len(), progress, |x, entries| {
            if !base.takes_part[x] {
                return;
            }
            if let Some(k) = follower_of[base.part[x] as usize] {
                entries.push((n_nodes + n_regions + k, 1.0));
                return;
            }
            let mut of_regions = Vec::new();
            let held = held.add_shares(x, &mut of_regions);
            let BlendRow { columns: nodes, weights } = base.rows.row(x);
            let free = |(k, _): &(&u32, &f64)| is_free[**k as usize];
            let total: f64 = nodes.iter().zip(weights).filter(free).map(|(_, w)| w).sum();
            if held < 1.0 && (total > 0.0 || of_regions.is_empty()) {
                let share = if total > 0.0 { (1.0 - held) / total } else { 1.0 };
                let all = |pair: &(&u32, &f64)| total <= 0.0 || free(pair);
                entries.extend(nodes.iter().zip(weights).filter(all).map(|(&k, w)| (k, w * share)));
            }
            entries.extend(of_regions.iter().map(|(region, share)| (n_nodes + region, *share)));
            normalize(entries);
        })?;
        Ok(Self { rows, regions: bound, followers, region_of })
    }
}

/// Nodes to which the regions leave at least a share of their weight. The other nodes would be determined by a few
/// samples, and would carry the vertices between these anywhere.
fn free_nodes(base: &CoarseBase, held: &ShareOfRegions<'_>) -> Vec<bool> {
    let (mut all, mut free) = (vec![0.0; base.nodes.len()], vec![0.0; base.nodes.len()]);
    for (&x, area) in base.samples.iter().zip(&base.sample_areas) {
        let held = held.add_shares(x as usize, &mut Vec::new());
        let BlendRow { columns: nodes, weights } = base.rows.row(x as usize);
        for (&k, w) in nodes.iter().zip(weights) {
            all[k as usize] += area * w;
            free[k as usize] += area * w * (1.0 - held);
        }
    }
    all.iter().zip(free).map(|(all, free)| free > LEAST_FREE * all).collect()
}

/// Ramps of the regions, and the region of each vertex.
struct ShareOfRegions<'a> {
    region_of: &'a [u32],
    ramps: &'a BlendRows,
}

impl ShareOfRegions<'_> {
    /// Appends the share of each region at `x` and returns their sum, which is 1 in a region and less elsewhere.
    fn add_shares(&self, x: usize, shares: &mut Vec<(u32, f64)>) -> f64 {
        if self.region_of[x] != NO_SOURCE {
            shares.push((self.region_of[x], 1.0));
            return 1.0;
        }
        // Where ramps overlap, the odds r/(1 − r) add up.
        let BlendRow { columns: regions, weights: ramps } = self.ramps.row(x);
        let odds = |r: f64| r / (1.0 - r).max(1e-12);
        let sum: f64 = ramps.iter().map(|&r| odds(r)).sum();
        shares.extend(regions.iter().zip(ramps).map(|(&k, &r)| (k, odds(r) / (1.0 + sum))));
        sum / (1.0 + sum)
    }
}

/// Name of a region in messages: 0 is the fixed part if there is one.
fn name(region: usize, has_fixed: bool) -> String {
    match (region, has_fixed) {
        (0, true) => "the fixed part".to_owned(),
        (k, true) => format!("handle {k}"),
        (k, false) => format!("handle {}", k + 1),
    }
}

/// Welded vertices of the regions, without strays, and the region of each welded vertex.
fn bind_regions(
    decomposer: &Decomposer,
    base: &CoarseBase,
    regions: &DeformRegions,
) -> Result<(Vec<BoundRegion>, Vec<u32>), DeformError> {
    if regions.handles.is_empty() {
        return Err(DeformError::NoHandles);
    }
    let (map, n_vertices) = (decomposer.vertex_map(), decomposer.n_vertices());
    let has_fixed = !regions.fixed.is_empty();
    let mut region_of = vec![NO_SOURCE; map.n_welded()];
    let mut bound = Vec::new();
    for vertices in has_fixed.then_some(&regions.fixed).into_iter().chain(&regions.handles) {
        let k = bound.len();
        let mut welded = Vec::with_capacity(vertices.len());
        for &vertex in vertices {
            if vertex as usize >= n_vertices {
                return Err(DeformError::NoSuchVertex { region: name(k, has_fixed), vertex, n_vertices });
            }
            let x = map.welded(vertex as usize);
            let other = region_of[x];
            if other != NO_SOURCE && other != k as u32 {
                let (first, second) = (name(other as usize, has_fixed), name(k, has_fixed));
                return Err(DeformError::TwoRegions { vertex, first, second });
            }
            region_of[x] = k as u32;
            welded.push(x as u32);
        }
        welded.sort_unstable();
        welded.dedup();
        let members: Vec<u32> = welded.iter().copied().filter(|&x| base.takes_part[x as usize]).collect();
        if members.is_empty() {
            return Err(DeformError::EmptyRegion { region: name(k, has_fixed) });
        }
        let mut center = [0.0; 3];
        for &x in &members {
            let p = &base.points[x as usize];
            for c in 0..3 {
                center[c] += p[c] / members.len() as f64;
            }
        }
        let is_point = members.len() == 1 && !(has_fixed && k == 0);
        if is_point {
            center = base.points[members[0] as usize];
        }
        bound.push(BoundRegion { vertices: members, center, is_point });
    }
    Ok((bound, region_of))
}

/// For each vertex the ramp of each region in reach, in (0, 1).
fn ramps(decomposer: &Decomposer, base: &CoarseBase, regions: &[BoundRegion]) -> BlendRows {
    let graph = PlacedGraph { neighbors: decomposer.neighbors(), points: &base.points };
    let reach = RAMP * base.sigma.max(0.0) / base.unit;
    let mut found: Vec<(u32, u32, f64)> = Vec::new();
    for (k, region) in (0..).zip(regions) {
        let reached = graph.nearest(&region.vertices, reach, FrontLength::Straight);
        let ramp = |d: f64| smooth_rise(1.0 - d / reach);
        let inside = reached.distance.iter().enumerate().filter(|(_, d)| d.is_finite() && **d > 0.0);
        found.extend(inside.map(|(x, &d)| (x as u32, k, ramp(d))).filter(|(_, _, r)| *r > 0.0));
    }
    found.sort_unstable_by_key(|(x, k, _)| (*x, *k));
    let n = base.points.len();
    let mut rows = BlendRows { offsets: vec![0; n + 1], ..BlendRows::default() };
    for (x, k, r) in found {
        rows.offsets[x as usize + 1] += 1;
        rows.columns.push(k);
        rows.weights.push(r);
    }
    for x in 0..n {
        rows.offsets[x + 1] += rows.offsets[x];
    }
    rows
}

/// Parts without a region, each with the nearest vertex of a part that has one, and the number of each such part.
fn following_parts(base: &CoarseBase, region_of: &[u32]) -> (Vec<FollowingPart>, Vec<Option<u32>>) {
    let n_parts = base.part.iter().max().map_or(0, |last| *last as usize + 1);
    let mut is_held = vec![false; n_parts];
    for (x, _) in region_of.iter().enumerate().filter(|(x, k)| **k != NO_SOURCE && base.takes_part[*x]) {
        is_held[base.part[x] as usize] = true;
    }
    let mut samples_of: Vec<Vec<u32>> = vec![Vec::new(); n_parts];
    let mut held = Vec::new();
    for &x in &base.samples {
        let part = base.part[x as usize] as usize;
        if is_held[part] { held.push(x) } else { samples_of[part].push(x) }
    }
    let n_free: usize = samples_of.iter().map(Vec::len).sum();
    let stride = (n_free.saturating_mul(held.len()) / MAX_PAIRS).max(1);
    let (mut followers, mut follower_of) = (Vec::new(), vec![None; n_parts]);
    let mut n_vertices = vec![0; n_parts];
    for (&part, _) in base.part.iter().zip(&base.takes_part).filter(|(_, takes)| **takes) {
        n_vertices[part as usize] += 1;
    }
    for (part, samples) in samples_of.iter().enumerate().filter(|(_, samples)| !samples.is_empty()) {
        let (mut best, mut anchor) = (f64::INFINITY, held[0]);
        for &y in held.iter().step_by(stride) {
            for &x in samples {
                let d = norm(&subtract(&base.points[x as usize], &base.points[y as usize]));
                if d < best {
                    (best, anchor) = (d, y);
                }
            }
        }
        follower_of[part] = Some(followers.len() as u32);
        followers.push(FollowingPart { anchor, n_vertices: n_vertices[part] });
    }
    (followers, follower_of)
}
