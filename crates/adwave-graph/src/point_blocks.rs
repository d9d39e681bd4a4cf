//! Points in blocks of neighbors, with bounds of the distances between blocks.

use crate::nearest::DimensionedPoints;
use crate::point_products::{NearVisit, TILE};
use adwave::{Cancelled, Progress};
use pulp::Arch;

/// Points that search together, and points of a block that they are compared with: both stay in the cache.
pub(crate) const QUERIES: usize = 96;
const BLOCK: usize = 192;

/// Half of the squared norm of a place without a point, above all thresholds.
const NOWHERE: f32 = f32::MAX;

/// Points in the order of blocks, and their coordinates in single precision.
pub(crate) struct PointBlocks<'a> {
    points: DimensionedPoints<'a>,
    /// Point at each place of the order.
    order: Vec<u32>,
    /// Coordinates minus their mean, divided by a power of two, and then the halves of the squared norms: per block
    /// (n_dimensions + 1) × [`BLOCK`].
    single: Vec<f32>,
    /// Norm of each place after this scaling, and the largest norm of each block.
    norms: Vec<f64>,
    largest_norms: Vec<f64>,
    extents: Vec<Extent>,
    balls: Balls,
    inverse_unit: f64,
    unit: f64,
}

/// Box around some points, in the units of the input.
#[derive(Clone, Debug)]
struct Extent {
    low: Vec<f64>,
    high: Vec<f64>,
}

/// Balls around the points of each block. Their centers lie in memory like the points of blocks.
struct Balls {
    centers: Vec<f32>,
    largest_norm: f64,
    radii: Vec<f64>,
}

/// Blocks that the points of some places may have neighbors in.
pub(crate) struct NearBlocks {
    /// Blocks from near to far, with a lower bound of the squared distance, in units of `unit`².
    pub(crate) blocks: Vec<(f64, usize)>,
    /// Lower bounds of the squared distances of the centers from each query, [`QUERIES`] × n_places of centers.
    squares: Vec<f32>,
}

impl<'a> PointBlocks<'a> {
    /// Sorts points into blocks. O(n·d·log n).
    pub(crate) fn new(points: DimensionedPoints<'a>, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let (n, d) = (points.n_points(), points.n_dimensions);
        let mut mean = vec![0.0; d];
        for row in points.values.chunks_exact(d) {
            for (sum, v) in mean.iter_mut().zip(row) {
                *sum += v / n as f64;
            }
        }
        let deviations =
            points.values.chunks_exact(d).flat_map(|row| row.iter().zip(&mean).map(|(v, m)| v - m));
        let largest = deviations.fold(0.0, |most: f64, v| most.max(v.abs()));
        let unit = if largest > 0.0 { largest.log2().floor().exp2().max(SMALLEST_UNIT) } else { 1.0 };
        let inverse_unit = unit.recip();
        let mut order: Vec<u32> = (0..n as u32).collect();
        sort_into_blocks(CloudFrame { points, mean: &mean, inverse_unit }, &mut order, progress)?;
        let n_blocks = n.div_ceil(BLOCK);
        let mut single = vec![0.0_f32; n_blocks * BLOCK * (d + 1)];
        let mut norms = Vec::with_capacity(n);
        for (places, block) in order.chunks(BLOCK).zip(single.chunks_exact_mut(BLOCK * (d + 1))) {
            block[d * BLOCK..].fill(NOWHERE);
            for (i, &x) in places.iter().enumerate() {
                let mut square = 0.0;
                for (c, (v, m)) in points.values[x as usize * d..][..d].iter().zip(&mean).enumerate() {
                    let v = ((v - m) * inverse_unit) as f32;
                    square += f64::from(v) * f64::from(v);
                    block[c * BLOCK + i] = v;
                }
                block[d * BLOCK + i] = (0.5 * square) as f32;
                norms.push(square.sqrt());
            }
        }
        let largest_norms =
            norms.chunks(BLOCK).map(|norms| norms.iter().copied().fold(0.0, f64::max)).collect();
        let extents = order.chunks(BLOCK).map(|places| Extent::new(points, places)).collect();
        let frame = CloudFrame { points, mean: &mean, inverse_unit };
        let balls = Balls::new(frame, &order);
        Ok(Self { points, order, single, norms, largest_norms, extents, balls, inverse_unit, unit })
    }

    pub(crate) fn n_points(&self) -> usize {
        self.order.len()
    }

    /// Power of two in which squared distances are measured.
    pub(crate) fn unit(&self) -> f64 {
        self.unit
    }

    /// Point at a place.
    pub(crate) fn index_at(&self, place: usize) -> u32 {
        self.order[place]
    }

    /// Place of each point.
    pub(crate) fn places(&self) -> Vec<usize> {
        let mut places = vec![0; self.order.len()];
        for (place, &x) in self.order.iter().enumerate() {
            places[x as usize] = place;
        }
        places
    }

    /// Negative coordinates of `n` queries from the place `first`, as tiles.
    pub(crate) fn queries(&self, first: usize, n: usize) -> Vec<f32> {
        let d = self.points.n_dimensions;
        let mut queries = vec![0.0; QUERIES * d];
        for q in 0..n {
            let (block, at) = ((first + q) / BLOCK, (first + q) % BLOCK);
            let coordinates = &self.single[block * BLOCK * (d + 1)..];
            for c in 0..d {
                queries[(q / TILE) * TILE * d + c * TILE + q % TILE] = -coordinates[c * BLOCK + at];
            }
        }
        queries
    }

    /// Blocks with bounds of their distances from the queries at `n` places.
    pub(crate) fn near_blocks(&self, first: usize, n: usize, queries: &[f32]) -> NearBlocks {
        let n_blocks = self.extents.len();
        let mut squares = vec![0.0; QUERIES * n_blocks];
        let length = BLOCK * (self.points.n_dimensions + 1);
        for (group, centers) in self.balls.centers.chunks_exact(length).enumerate() {
            let mut thresholds = vec![NOWHERE.next_down(); QUERIES];
            let each = |q: usize, i: usize, product: f32| {
                let norm = self.norms.get(first + q).copied().unwrap_or_default();
                let slack = self.slack(norm, self.balls.largest_norm);
                let square = 2.0 * (f64::from(product) - slack) + norm * norm;
                squares[q * n_blocks + group * BLOCK + i] = (square as f32).next_down();
                NOWHERE.next_down()
            };
            let thresholds = &mut thresholds[..];
            Arch::new().dispatch(NearVisit { queries, others: centers, n_others: BLOCK, thresholds, each });
        }
        let extent = Extent::new(self.points, &self.order[first..first + n]);
        // Sums of squares are rounded relatively to themselves.
        let safety = 1.0 - 8.0 * (self.points.n_dimensions as f64 + 8.0) * f64::EPSILON;
        let gap = |block: usize| extent.squared_gap(&self.extents[block], self.inverse_unit) * safety;
        let nearest = |block: usize| {
            let squares = (0..n).map(|q| squares[q * n_blocks + block]);
            f64::from(squares.fold(f32::INFINITY, f32::min)).max(0.0).sqrt() - self.balls.radii[block]
        };
        let mut order: Vec<(f64, usize)> = (0..n_blocks).map(|block| (nearest(block), block)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let blocks = order.into_iter().map(|(_, block)| (gap(block), block)).collect();
        NearBlocks { blocks, squares }
    }

    /// True if a block may have a point within the squared distance `limit` of a query.
    pub(crate) fn may_reach(&self, near: &NearBlocks, q: usize, block: usize, limit: f64) -> bool {
        let reach = limit.sqrt() + self.balls.radii[block];
        f64::from(near.squares[q * self.extents.len() + block]) <= reach * reach * (1.0 + 1e-12)
    }

    /// Bound of the rounding of `½‖y‖² − x·y` in single precision, and of the rounding of the coordinates to it, for a
    /// point of the norm `norm` and others of at most the norm `most`.
    fn slack(&self, norm: f64, most: f64) -> f64 {
        let terms = self.points.n_dimensions as f64 + 8.0;
        2.0 * terms * f64::from(f32::EPSILON) * (most * most + norm * most + norm * norm) + 1e-30
    }

    /// Largest product of the query at a place with a point of a block whose squared distance may be at most `limit`.
    pub(crate) fn threshold(&self, place: usize, block: usize, limit: f64) -> f32 {
        if limit == f64::INFINITY {
            return NOWHERE.next_down();
        }
        let norm = self.norms[place];
        let slack = self.slack(norm, self.largest_norms[block]);
        // Rounded up, so that no point within the limit is passed over.
        ((0.5 * limit - 0.5 * norm * norm + slack) as f32).next_up()
    }

    /// Calls `each(query, place)` for the places of a block whose product with a query is at most its threshold. `each`
    /// returns the new threshold.
    pub(crate) fn visit_near(
        &self,
        queries: &[f32],
        block: usize,
        thresholds: &mut [f32],
        mut each: impl FnMut(usize, usize) -> f32,
    ) {
        let length = BLOCK * (self.points.n_dimensions + 1);
        let others = &self.single[block * length..][..length];
        let each = |q: usize, i: usize, _: f32| each(q, block * BLOCK + i);
        Arch::new().dispatch(NearVisit { queries, others, n_others: BLOCK, thresholds, each });
    }

    /// Squared distance of the points at two places in units of `unit`².
    pub(crate) fn squared_distance(&self, a: usize, b: usize) -> f64 {
        let d = self.points.n_dimensions;
        let row = |place: usize| &self.points.values[self.order[place] as usize * d..][..d];
        let (a, b) = (row(a), row(b));
        let mut sums = [0.0; 4];
        let (fours_a, fours_b) = (a.as_chunks::<4>(), b.as_chunks::<4>());
        for (p, q) in fours_a.0.iter().zip(fours_b.0) {
            for c in 0..4 {
                let off = (p[c] - q[c]) * self.inverse_unit;
                sums[c] += off * off;
            }
        }
        let rest = fours_a.1.iter().zip(fours_b.1).map(|(p, q)| ((p - q) * self.inverse_unit).powi(2));
        (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest.sum::<f64>()
    }
}

/// Smallest power of two whose inverse is finite.
const SMALLEST_UNIT: f64 = f64::MIN_POSITIVE;

/// Points and the frame in which they are measured.
#[derive(Clone, Copy)]
struct CloudFrame<'a> {
    points: DimensionedPoints<'a>,
    mean: &'a [f64],
    inverse_unit: f64,
}

impl CloudFrame<'_> {
    /// Coordinates of a point minus the mean, in units.
    fn coordinates(&self, x: u32) -> impl Iterator<Item = f64> {
        let d = self.points.n_dimensions;
        let row = &self.points.values[x as usize * d..][..d];
        row.iter().zip(self.mean).map(|(v, m)| (v - m) * self.inverse_unit)
    }
}

/// Points that choose a direction of a cut, and rounds of their means.
const SAMPLE: usize = 1024;
const ROUNDS: usize = 4;

/// Smallest share of the points on one side of a cut is one in this many.
const MOST_UNEVEN: usize = 8;

/// Sorts points so that blocks of [`BLOCK`] in that order are close together: cuts them between two means, again and
/// again. A cut at the median would slice clusters.
fn sort_into_blocks(
    frame: CloudFrame<'_>,
    order: &mut [u32],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let n = order.len();
    if n <= BLOCK {
        return Ok(());
    }
    progress.check()?;
    let Cut { direction, at } = frame.cut(order);
    let project = |x: u32| frame.coordinates(x).zip(&direction).map(|(v, d)| v * d).sum::<f64>();
    let mut projected: Vec<(f64, u32)> = order.iter().map(|&x| (project(x), x)).collect();
    let n_before =
        projected.iter().filter(|(v, _)| *v < at).count().clamp(n / MOST_UNEVEN, n - n / MOST_UNEVEN);
    // Whole blocks, at least one on each side.
    let n_blocks = n.div_ceil(BLOCK);
    let middle = ((n_before + BLOCK / 2) / BLOCK).clamp(1, n_blocks - 1) * BLOCK;
    projected.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.iter_mut().zip(projected).for_each(|(x, (_, sorted))| *x = sorted);
    let (left, right) = order.split_at_mut(middle);
    let sides =
        rayon::join(|| sort_into_blocks(frame, left, progress), || sort_into_blocks(frame, right, progress));
    sides.0.and(sides.1)
}

/// A plane between two means: points with a smaller product with the direction lie before it.
struct Cut {
    direction: Vec<f64>,
    at: f64,
}

impl CloudFrame<'_> {
    /// The plane between two means of some of the points, which begin at points far from each other.
    fn cut(&self, order: &[u32]) -> Cut {
        let step = order.len().div_ceil(SAMPLE);
        let sample: Vec<Vec<f64>> =
            order.iter().step_by(step).map(|&x| self.coordinates(x).collect()).collect();
        let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let farthest = |from: &[f64]| {
            let distances = sample.iter().map(|point| square(point, from));
            let far = distances.enumerate().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            sample[far.map_or(0, |(i, _)| i)].clone()
        };
        let mean = |is_in: &dyn Fn(&[f64]) -> bool| {
            let mut sum = vec![0.0; self.points.n_dimensions];
            let mut n = 0.0;
            for point in sample.iter().filter(|point| is_in(point)) {
                sum.iter_mut().zip(point).for_each(|(sum, v)| *sum += v);
                n += 1.0;
            }
            for sum in &mut sum {
                *sum /= f64::max(n, 1.0);
            }
            (n > 0.0).then_some(sum)
        };
        let mut a = farthest(&mean(&|_| true).unwrap_or_default());
        let mut b = farthest(&a);
        for _ in 0..ROUNDS {
            let is_first = |point: &[f64]| square(point, &a) < square(point, &b);
            let means = (mean(&is_first), mean(&|point: &[f64]| !is_first(point)));
            if let (Some(first), Some(second)) = means {
                (a, b) = (first, second);
            }
        }
        let direction: Vec<f64> = a.iter().zip(&b).map(|(a, b)| b - a).collect();
        let at = direction.iter().zip(a.iter().zip(&b)).map(|(d, (a, b))| d * 0.5 * (a + b)).sum();
        Cut { direction, at }
    }
}

impl Balls {
    fn new(frame: CloudFrame<'_>, order: &[u32]) -> Self {
        let d = frame.points.n_dimensions;
        let n_blocks = order.len().div_ceil(BLOCK);
        let mut centers = vec![0.0_f32; n_blocks.div_ceil(BLOCK) * BLOCK * (d + 1)];
        for group in centers.chunks_exact_mut(BLOCK * (d + 1)) {
            group[d * BLOCK..].fill(NOWHERE);
        }
        let (mut radii, mut largest_norm) = (Vec::with_capacity(n_blocks), 0.0_f64);
        for (block, places) in order.chunks(BLOCK).enumerate() {
            let mut center = vec![0.0; d];
            for &x in places {
                center.iter_mut().zip(frame.coordinates(x)).for_each(|(sum, v)| *sum += v);
            }
            // The center as it is stored, so that its rounding makes the radius larger.
            let center: Vec<f32> = center.iter().map(|sum| (sum / places.len() as f64) as f32).collect();
            let distance = |x: u32| {
                let offs = frame.coordinates(x).zip(&center).map(|(v, &c)| v - f64::from(c));
                offs.map(|off| off * off).sum::<f64>().sqrt()
            };
            let radius = places.iter().map(|&x| distance(x)).fold(0.0, f64::max);
            let square: f64 = center.iter().map(|&c| f64::from(c) * f64::from(c)).sum();
            let group = &mut centers[block / BLOCK * BLOCK * (d + 1)..][..BLOCK * (d + 1)];
            for (c, &v) in center.iter().enumerate() {
                group[c * BLOCK + block % BLOCK] = v;
            }
            group[d * BLOCK + block % BLOCK] = (0.5 * square) as f32;
            // Coordinates are rounded relatively to their distance from the mean, sums of squares relatively to
            // themselves.
            radii.push(radius * (1.0 + 1e-9) + 1e-12 * (square.sqrt() + radius));
            largest_norm = largest_norm.max(square.sqrt());
        }
        Self { centers, largest_norm, radii }
    }
}

impl Extent {
    fn new(points: DimensionedPoints<'_>, places: &[u32]) -> Self {
        let d = points.n_dimensions;
        let (mut low, mut high) = (vec![f64::INFINITY; d], vec![f64::NEG_INFINITY; d]);
        for &x in places {
            for (c, &v) in points.values[x as usize * d..][..d].iter().enumerate() {
                low[c] = low[c].min(v);
                high[c] = high[c].max(v);
            }
        }
        Self { low, high }
    }

    /// Lower bound of the squared distance of a point of one to a point of the other, but for rounding.
    fn squared_gap(&self, other: &Self, inverse_unit: f64) -> f64 {
        let mut square = 0.0;
        for c in 0..self.low.len() {
            let gap = (other.low[c] - self.high[c]).max(self.low[c] - other.high[c]).max(0.0) * inverse_unit;
            square += gap * gap;
        }
        square
    }
}
