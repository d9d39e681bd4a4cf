//! A walk that is independent of the sampling density: neighborhoods by length, and the kernel divided by its
//! density estimate (α = 1 of `coifmanlafon2006`).

use super::guided::sharpness;
use crate::shape::{Adjacency, squared_distance};
use crate::{Cancelled, Progress, parallel};

/// Share of vertices whose neighbors are all within reach.
const REACHING: f64 = 0.95;

/// Reach in standard deviations of the kernel.
const REACH: f64 = 2.0;

/// Largest mean number of neighbors.
const MEAN_NEIGHBORS: usize = 128;

/// Number of vertices sampled to estimate the number of neighbors.
const SAMPLED_VERTICES: usize = 1 << 10;

/// Factor that shortens the reach until there are few enough neighbors.
const SHORTER: f64 = 0.8;

/// Number of divisions by the density.
const ROUNDS: usize = 4;

/// Relative difference below which distances are equal: on a grid many vertices lie exactly at the reach.
const TIE: f64 = 1e-9;

/// Neighborhoods by length.
pub(super) struct LengthNeighbors {
    /// Symmetric neighbor lists.
    pub(super) neighbors: Adjacency,
    /// Standard deviation of the kernel, in units of the points.
    pub(super) width: f64,
}

/// Neighborhoods by length: the vertices within one length of each vertex that are connected to it through others
/// within that length, and the neighbors in `next`. `farthest(x)` is the distance to the farthest vertex in the list of
/// x in `next`.
///
/// The length is chosen so that 19 of 20 vertices have their whole list within it, or shorter if that would give
/// more than 128 vertices on average. O(entries found).
pub(super) fn neighbors_within_length(
    points: &[[f64; 3]],
    next: &Adjacency,
    farthest: &[f64],
    progress: Progress<'_>,
) -> Result<LengthNeighbors, Cancelled> {
    let n = points.len();
    let mut far: Vec<f64> = farthest.to_vec();
    if far.is_empty() {
        return Ok(LengthNeighbors { neighbors: next.clone(), width: 0.0 });
    }
    let at = ((REACHING * n as f64) as usize).min(n - 1);
    let mut reach = *far.select_nth_unstable_by(at, f64::total_cmp).1;
    while reach > 0.0 && count(points, next, reach, progress)? > MEAN_NEIGHBORS {
        reach *= SHORTER;
    }
    let inside = Adjacency::from_neighbors(
        n,
        progress,
        || LengthSearch::new(n),
        |search, x, out| {
            if reach > 0.0 {
                search.run(points, next, x, reach, usize::MAX);
                out.extend_from_slice(&search.found);
            }
            out.extend_from_slice(next.row(x));
        },
    )?;
    // A path may lie within reach of only one of its ends.
    Ok(LengthNeighbors { neighbors: inside.union_with_transpose(progress)?, width: reach / REACH })
}

/// Mean number of neighbors within `reach`; counting stops above [`MEAN_NEIGHBORS`].
fn count(
    points: &[[f64; 3]],
    next: &Adjacency,
    reach: f64,
    progress: Progress<'_>,
) -> Result<usize, Cancelled> {
    let mut search = LengthSearch::new(points.len());
    let apart = points.len().div_ceil(SAMPLED_VERTICES);
    let n_looked_at = points.len().div_ceil(apart);
    let enough = (MEAN_NEIGHBORS + 1) * n_looked_at;
    let mut found = 0;
    for x in (0..points.len()).step_by(apart) {
        progress.check()?;
        search.run(points, next, x, reach, enough);
        found += search.found.len();
        if found >= enough {
            break;
        }
    }
    Ok(found / n_looked_at)
}

/// Search outwards from one vertex.
struct LengthSearch {
    /// Vertex from which each vertex was last found.
    seen_from: Vec<u32>,
    found: Vec<u32>,
}

impl LengthSearch {
    fn new(n: usize) -> Self {
        Self { seen_from: vec![u32::MAX; n], found: Vec::new() }
    }

    /// Finds the vertices within `reach` of x along paths within it, up to `most` vertices.
    fn run(&mut self, points: &[[f64; 3]], next: &Adjacency, x: usize, reach: f64, most: usize) {
        let square = reach * reach * (1.0 + TIE) * (1.0 + TIE);
        self.found.clear();
        self.seen_from[x] = x as u32;
        let (mut from, mut done) = (x, 0);
        loop {
            for &y in next.row(from) {
                let seen = &mut self.seen_from[y as usize];
                if *seen != x as u32 && squared_distance(&points[x], &points[y as usize]) <= square {
                    *seen = x as u32;
                    self.found.push(y);
                }
            }
            if done == self.found.len() || self.found.len() >= most {
                return;
            }
            from = self.found[done] as usize;
            done += 1;
        }
    }
}

/// Measure that replaces areas: `m ← m(x)/q(x)`, `q(x) = m(x) + Σ_y m(y)·exp(−‖x − y‖²/2w²)`, starting from the
/// areas, [`ROUNDS`] times. O(entries).
///
/// One round is α = 1 of `coifmanlafon2006`; each further round divides by the remaining density, which matters
/// where the density jumps or areas are wrong.
pub(super) fn measure(
    points: &[[f64; 3]],
    areas: &[f64],
    within: &LengthNeighbors,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let n = points.len();
    let sharpness = sharpness(within.width * within.width);
    let mut measure = areas.to_vec();
    for _ in 0..ROUNDS {
        let q = parallel::try_collect(n, progress, |x| {
            let near = within.neighbors.row(x).iter().map(|&y| y as usize);
            let kernel =
                |y: usize| measure[y] * (-squared_distance(&points[x], &points[y]) * sharpness).exp();
            measure[x] + near.map(kernel).sum::<f64>()
        })?;
        // In units of the mean, so that areas of any size stay away from underflow and overflow.
        let mean = parallel::try_sum(n, progress, |x| q[x])? / n.max(1) as f64;
        let share = |x: usize| if q[x] > 0.0 { mean / q[x] } else { 0.0 };
        measure = parallel::try_collect(n, progress, |x| measure[x] * share(x))?;
    }
    Ok(measure)
}
