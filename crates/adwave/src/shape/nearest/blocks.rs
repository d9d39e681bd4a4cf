//! Positions along a space-filling curve, in blocks with bounding boxes: a search visits the few blocks near a
//! point, and compares all positions of a block at once.

// Code compiled for several instruction sets must be inlined into the function that selects one.
#![allow(clippy::inline_always)]

use crate::shape::squared_distance;
use crate::{Cancelled, Progress, parallel};
use pulp::{Arch, NullaryFnOnce};

/// Number of positions per block: whole registers of any processor, and about the number that a search needs.
pub(super) const BLOCK: usize = 32;

/// Number of boxes per box of the next level.
const FAN: usize = 8;

/// Number of blocks that a thread builds at a time.
const BLOCKS_AT_A_TIME: usize = 1 << 10;

/// Relative rounding of squares in comparisons of boxes or lengths.
const ROUNDING: f64 = 1e-14;

#[derive(Clone, Copy, Default)]
pub(super) struct BlockBounds {
    lo: [f64; 3],
    hi: [f64; 3],
}

impl BlockBounds {
    const NONE: Self = Self { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    fn union(self, other: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|c| self.lo[c].min(other.lo[c])),
            hi: std::array::from_fn(|c| self.hi[c].max(other.hi[c])),
        }
    }

    /// Lower bound of the squared distance between any two points of two boxes, however it is rounded.
    #[inline(always)]
    fn squared_distance(&self, other: &Self) -> f64 {
        let apart = |c: usize| (self.lo[c] - other.hi[c]).max(other.lo[c] - self.hi[c]).max(0.0);
        let [x, y, z] = [apart(0), apart(1), apart(2)];
        (x * x + y * y + z * z) * (1.0 - ROUNDING)
    }
}

/// The positions of a block, by coordinate; NaN at unused slots of the last block.
#[derive(Clone)]
struct PointBlock([[f64; BLOCK]; 3]);

impl Default for PointBlock {
    fn default() -> Self {
        Self([[f64::NAN; BLOCK]; 3])
    }
}

/// Positions in blocks of [`BLOCK`], and a hierarchy of boxes.
pub(super) struct Blocks {
    n_positions: usize,
    held: Vec<PointBlock>,
    /// Boxes of the blocks, then of each group of [`FAN`] boxes of the level before.
    levels: Vec<Vec<BlockBounds>>,
}

impl Blocks {
    /// Builds the blocks in O(n). The search is fast if successive positions are close to each other.
    pub(super) fn new(positions: &[[f64; 3]], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let n = positions.len();
        let made = parallel::try_map_chunks(
            n,
            BLOCKS_AT_A_TIME * BLOCK,
            progress,
            || (),
            |(), range| {
                let block = |some: &[[f64; 3]]| {
                    let (mut block, mut bounds) = (PointBlock::default(), BlockBounds::NONE);
                    for (i, p) in some.iter().enumerate() {
                        for (coordinates, &value) in block.0.iter_mut().zip(p) {
                            coordinates[i] = value;
                        }
                        bounds = bounds.union(&BlockBounds { lo: *p, hi: *p });
                    }
                    (block, bounds)
                };
                positions[range].chunks(BLOCK).map(block).unzip::<_, _, Vec<_>, Vec<_>>()
            },
        )?;
        let (mut blocks, mut bounds) = (Vec::new(), Vec::new());
        for (some, boxes) in made {
            blocks.extend(some);
            bounds.extend(boxes);
        }
        let mut levels = vec![bounds];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let around = |some: &[BlockBounds]| some.iter().fold(BlockBounds::NONE, BlockBounds::union);
            levels.push(last.chunks(FAN).map(around).collect());
        }
        Ok(Self { n_positions: n, held: blocks, levels })
    }

    fn position(&self, i: usize) -> [f64; 3] {
        let block = &self.held[i / BLOCK].0;
        std::array::from_fn(|c| block[c][i % BLOCK])
    }

    /// Finds the blocks whose boxes are at most √`square` away from `bounds`.
    fn find_within(
        &self,
        bounds: &BlockBounds,
        square: f64,
        stack: &mut Vec<(usize, usize)>,
        found: &mut Vec<u32>,
    ) {
        found.clear();
        stack.clear();
        stack.push((self.levels.len() - 1, 0));
        while let Some((level, first)) = stack.pop() {
            for (i, inside) in self.levels[level].iter().enumerate().skip(first).take(FAN) {
                if inside.squared_distance(bounds) > square {
                    continue;
                }
                if level == 0 {
                    found.push(i as u32);
                } else {
                    stack.push((level - 1, i * FAN));
                }
            }
        }
    }
}

/// Positions near a position.
pub(super) struct NearestHeap<'a> {
    /// Squared distance of the last requested position.
    pub(super) farthest: f64,
    /// Squared distances of all positions within that distance or tied with it, in no order.
    pub(super) squares: &'a [f64],
    pub(super) names: &'a [u32],
}

impl NearestHeap<'_> {
    /// Sorts the positions by distance, then by name.
    pub(super) fn sort_by_distance(&self, sorted: &mut Vec<(f64, u32)>) {
        sorted.clear();
        sorted.extend(self.squares.iter().copied().zip(self.names.iter().copied()));
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
}

/// Search for the nearest positions of one position after another; data kept from the previous search only saves
/// time.
pub(super) struct NearestSearch<'a> {
    blocks: &'a Blocks,
    arch: Arch,
    /// Number of requested positions, including the position itself, each counted `weight` times.
    count: usize,
    /// Factor below which squared distances count as equal.
    tie: f64,
    /// The previous position, and an upper bound of the distance of the last of its `count`.
    last: Option<([f64; 3], f64)>,
    /// The block to which `near` and `own` belong.
    block: usize,
    /// Upper bounds of the squared distances of the last requested position, for each position of the block.
    own: [f64; BLOCK],
    /// Blocks that may hold neighbors of its positions; empty if there are too many or they are unknown.
    near: Vec<u32>,
    stack: Vec<(usize, usize)>,
    /// Boxes still to be visited: level, number, lower bound of the squared distance.
    boxes: Vec<(usize, usize, f64)>,
    /// Results; the first `n_found` of each are valid.
    squares: Vec<f64>,
    names: Vec<u32>,
    n_found: usize,
    sorted: Vec<f64>,
}

/// Largest number of blocks that the positions of a block search together; beyond it each position searches alone.
const MAX_SHARED: usize = 64;

impl<'a> NearestSearch<'a> {
    pub(super) fn new(blocks: &'a Blocks, count: usize, tie: f64) -> Self {
        Self {
            blocks,
            arch: Arch::new(),
            count,
            tie,
            last: None,
            block: usize::MAX,
            own: [f64::INFINITY; BLOCK],
            near: Vec::new(),
            stack: Vec::new(),
            boxes: Vec::new(),
            squares: vec![0.0; 4 * BLOCK],
            names: vec![0; 4 * BLOCK],
            n_found: 0,
            sorted: Vec::new(),
        }
    }

    /// Finds the positions near position `i`, each counted `weight` times.
    ///
    /// # Panics
    /// If there are fewer positions than requested.
    pub(super) fn nearest(&mut self, i: usize, weight: impl Fn(u32) -> usize) -> NearestHeap<'_> {
        let p = self.blocks.position(i);
        if i / BLOCK != self.block {
            self.enter(i / BLOCK);
        }
        let by_last = self.last.map_or(f64::INFINITY, |(q, radius)| {
            let reach = radius + squared_distance(&p, &q).sqrt();
            reach * reach * (1.0 + ROUNDING) + f64::MIN_POSITIVE
        });
        let bound = by_last.min(self.own[i % BLOCK]) * self.tie;
        if self.near.is_empty() {
            self.descend(&p, bound);
        } else {
            self.n_found = 0;
            let near = std::mem::take(&mut self.near);
            self.scan(&near, &p, bound);
            self.near = near;
        }
        let farthest = self.kth(&weight).expect("as many positions as are wanted");
        self.last = Some((p, farthest.sqrt() * (1.0 + ROUNDING)));
        self.retain_within(farthest * self.tie);
        NearestHeap { farthest, squares: &self.squares[..self.n_found], names: &self.names[..self.n_found] }
    }

    /// Removes results beyond the limit.
    fn retain_within(&mut self, limit: f64) {
        let mut kept = 0;
        for k in 0..self.n_found {
            let (square, name) = (self.squares[k], self.names[k]);
            (self.squares[kept], self.names[kept]) = (square, name);
            kept += usize::from(square <= limit);
        }
        self.n_found = kept;
    }

    /// Finds the blocks that may hold neighbors of the positions of a block, from the distances within the block
    /// itself.
    fn enter(&mut self, block: usize) {
        self.block = block;
        self.near.clear();
        self.own = [f64::INFINITY; BLOCK];
        let n = BLOCK.min(self.blocks.n_positions - block * BLOCK);
        if self.count > n {
            return;
        }
        let mut farthest = 0.0_f64;
        let PointBlock([x, y, z]) = &self.blocks.held[block];
        for i in 0..n {
            let mut squares = [0.0; BLOCK];
            for k in 0..BLOCK {
                let (x, y, z) = (x[i] - x[k], y[i] - y[k], z[i] - z[k]);
                squares[k] = x * x + y * y + z * z;
            }
            self.own[i] = *squares[..n].select_nth_unstable_by(self.count - 1, f64::total_cmp).1;
            farthest = farthest.max(self.own[i]);
        }
        let square = farthest * (1.0 + ROUNDING) * self.tie;
        self.blocks.find_within(&self.blocks.levels[0][block], square, &mut self.stack, &mut self.near);
        if self.near.len() > MAX_SHARED {
            self.near.clear();
        }
    }

    /// Finds all positions whose squared distance from `p` is at most `bound` or that of the last requested one.
    /// The nearest boxes come first, so the bound decreases quickly however the positions lie along the curve.
    fn descend(&mut self, p: &[f64; 3], mut bound: f64) {
        let blocks = self.blocks;
        let own = BlockBounds { lo: *p, hi: *p };
        self.n_found = 0;
        let mut many = 4 * (self.count + BLOCK);
        self.boxes.clear();
        self.boxes.push((blocks.levels.len() - 1, 0, 0.0));
        while let Some((level, i, square)) = self.boxes.pop() {
            if square > bound {
                continue;
            }
            if level > 0 {
                let first = self.boxes.len();
                let inside = blocks.levels[level - 1].iter().enumerate().skip(i * FAN).take(FAN);
                let inside = inside.map(|(i, bounds)| (level - 1, i, bounds.squared_distance(&own)));
                self.boxes.extend(inside.filter(|&(_, _, square)| square <= bound));
                self.boxes[first..].sort_unstable_by(|a, b| b.2.total_cmp(&a.2));
                continue;
            }
            self.scan(&[i as u32], p, bound);
            if self.n_found > many {
                let farthest = self.kth(&|_| 1).map_or(f64::INFINITY, |farthest| farthest * self.tie);
                bound = bound.min(farthest);
                self.retain_within(bound);
                many = many.max(2 * self.n_found);
            }
        }
    }

    /// Adds all positions of some blocks whose squared distance from `p` is at most `bound`.
    fn scan(&mut self, near: &[u32], p: &[f64; 3], bound: f64) {
        let Self { blocks, squares, names, n_found, .. } = self;
        *n_found =
            self.arch.dispatch(BlockScan { blocks, near, p, bound, squares, names, n_found: *n_found });
    }

    /// Squared distance of the last requested position among those seen.
    fn kth(&mut self, weight: &impl Fn(u32) -> usize) -> Option<f64> {
        let (squares, names) = (&self.squares[..self.n_found], &self.names[..self.n_found]);
        if squares.len() >= self.count && names.iter().all(|&name| weight(name) == 1) {
            self.sorted.clear();
            self.sorted.extend_from_slice(squares);
            return Some(*self.sorted.select_nth_unstable_by(self.count - 1, f64::total_cmp).1);
        }
        let mut by_distance: Vec<(f64, u32)> = squares.iter().copied().zip(names.iter().copied()).collect();
        by_distance.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut seen = 0;
        by_distance.into_iter().find_map(|(square, name)| {
            seen += weight(name);
            (seen >= self.count).then_some(square)
        })
    }
}

/// The loop over blocks, compiled for several processors.
struct BlockScan<'a> {
    blocks: &'a Blocks,
    near: &'a [u32],
    p: &'a [f64; 3],
    bound: f64,
    squares: &'a mut Vec<f64>,
    names: &'a mut Vec<u32>,
    /// Number of results before.
    n_found: usize,
}

impl NullaryFnOnce for BlockScan<'_> {
    /// Number of results after.
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self { blocks, near, p, bound, squares, names, n_found: mut n } = self;
        let own = BlockBounds { lo: *p, hi: *p };
        for &block in near {
            if blocks.levels[0][block as usize].squared_distance(&own) > bound {
                continue;
            }
            let PointBlock([x, y, z]) = &blocks.held[block as usize];
            let mut found = [0.0; BLOCK];
            for i in 0..BLOCK {
                let (x, y, z) = (p[0] - x[i], p[1] - y[i], p[2] - z[i]);
                found[i] = x * x + y * y + z * z;
            }
            if n + BLOCK > squares.len() {
                squares.resize(2 * squares.len(), 0.0);
                names.resize(squares.len(), 0);
            }
            // The store is unconditional and the count conditional, which avoids an unpredictable branch.
            let (squares, names) = (&mut squares[..n + BLOCK], &mut names[..n + BLOCK]);
            for (i, square) in found.into_iter().enumerate() {
                squares[n] = square;
                names[n] = block * BLOCK as u32 + i as u32;
                n += usize::from(square <= bound);
            }
        }
        n
    }
}
