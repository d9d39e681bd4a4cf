//! A walk that does not see how densely a shape was sampled: neighborhoods by length, and the kernel divided by the density
//! that it finds (α = 1 of `coifmanlafon2006`).

use super::guided::sharpness;
use crate::shape::{Adjacency, squared_distance};
use crate::{Cancelled, Progress, parallel};

/// The share of vertices that have all their neighbors within reach.
const REACHING: f64 = 0.95;

/// The reach in standard deviations of the kernel.
const REACH: f64 = 2.0;

/// As many neighbors at most has a vertex on average.
const MEAN_NEIGHBORS: usize = 128;

/// As many vertices are looked at to know how many neighbors there will be.
const SAMPLED_VERTICES: usize = 1 << 10;

/// What the reach is multiplied by until there are few enough.
const SHORTER: f64 = 0.8;

/// How often the density is divided by.
const ROUNDS: usize = 4;

/// Distances that differ by less than this part are equal: on a grid many vertices lie at the very reach.
const TIE: f64 = 1e-9;

/// Neighborhoods by length.
pub(super) struct ByLength {
    /// Symmetric.
    pub(super) neighbors: Adjacency,
    /// The standard deviation of the kernel, in units of the points.
    pub(super) width: f64,
}

/// The vertices within one length of each that lead to it over others within it, and `next`; `farthest(x)` is how far the farthest of
/// the vertices lies that x itself names in `next`.
///
/// The length is such that 19 of 20 vertices have all that they name within it, or shorter, where that would be more than 128
/// vertices on average. O(entries found).
pub(super) fn by_length(
    points: &[[f64; 3]],
    next: &Adjacency,
    farthest: &[f64],
    progress: Progress<'_>,
) -> Result<ByLength, Cancelled> {
    let n = points.len();
    let mut far: Vec<f64> = farthest.to_vec();
    if far.is_empty() {
        return Ok(ByLength { neighbors: next.clone(), width: 0.0 });
    }
    let at = ((REACHING * n as f64) as usize).min(n - 1);
    let mut reach = *far.select_nth_unstable_by(at, f64::total_cmp).1;
    while reach > 0.0 && count(points, next, reach, progress)? > MEAN_NEIGHBORS {
        reach *= SHORTER;
    }
    let inside = Adjacency::from_neighbors(
        n,
        progress,
        || Search::new(n),
        |search, x, out| {
            if reach > 0.0 {
                search.run(points, next, x, reach, usize::MAX);
                out.extend_from_slice(&search.found);
            }
            out.extend_from_slice(next.of(x));
        },
    )?;
    // A way may lie within reach of one of its ends alone.
    Ok(ByLength { neighbors: inside.union_with_transpose(progress)?, width: reach / REACH })
}

/// How many neighbors a vertex has within `reach`, on average; more than [`MEAN_NEIGHBORS`] is not told apart.
fn count(
    points: &[[f64; 3]],
    next: &Adjacency,
    reach: f64,
    progress: Progress<'_>,
) -> Result<usize, Cancelled> {
    let mut search = Search::new(points.len());
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

/// A search outwards from one vertex.
struct Search {
    /// From which vertex each was found last.
    seen_from: Vec<u32>,
    found: Vec<u32>,
}

impl Search {
    fn new(n: usize) -> Self {
        Self { seen_from: vec![u32::MAX; n], found: Vec::new() }
    }

    /// Finds the vertices within `reach` of x that ways within it lead to, until there are `most`.
    fn run(&mut self, points: &[[f64; 3]], next: &Adjacency, x: usize, reach: f64, most: usize) {
        let square = reach * reach * (1.0 + TIE) * (1.0 + TIE);
        self.found.clear();
        self.seen_from[x] = x as u32;
        let (mut from, mut done) = (x, 0);
        loop {
            for &y in next.of(from) {
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

/// What counts in place of areas: `m ← m(x)/q(x)`, `q(x) = m(x) + Σ_y m(y)·exp(−‖x − y‖²/2w²)`, from the areas on, [`ROUNDS`] times. O(entries).
///
/// Once is α = 1 of `coifmanlafon2006`; each round divides by the density that the one before left, where that jumps or areas are wrong.
pub(super) fn measure(
    points: &[[f64; 3]],
    areas: &[f64],
    within: &ByLength,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let n = points.len();
    let sharpness = sharpness(within.width * within.width);
    let mut measure = areas.to_vec();
    for _ in 0..ROUNDS {
        let q = parallel::try_collect(n, progress, |x| {
            let near = within.neighbors.of(x).iter().map(|&y| y as usize);
            let kernel =
                |y: usize| measure[y] * (-squared_distance(&points[x], &points[y]) * sharpness).exp();
            measure[x] + near.map(kernel).sum::<f64>()
        })?;
        // In units of the mean, so that areas of any size stay as far from under- and overflow as they are.
        let mean = parallel::try_sum(n, progress, |x| q[x])? / n.max(1) as f64;
        let share = |x: usize| if q[x] > 0.0 { mean / q[x] } else { 0.0 };
        measure = parallel::try_collect(n, progress, |x| measure[x] * share(x))?;
    }
    Ok(measure)
}
