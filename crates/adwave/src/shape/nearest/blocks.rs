//! Positions along a space-filling curve, in blocks with boxes: a search looks at the few blocks near a point, and at all
//! positions of a block at once.

// Code that is compiled for several instruction sets is only so where it is inlined into the place that picks one.
#![allow(clippy::inline_always)]

use crate::shape::squared_distance;
use crate::{Cancelled, Progress, parallel};
use pulp::{Arch, NullaryFnOnce};

/// Positions in a block: whole registers of any processor, and about as many as a search wants.
pub(super) const BLOCK: usize = 32;

/// Boxes that a box of the next level holds.
const FAN: usize = 8;

/// Blocks that a thread makes at a time.
const BLOCKS_AT_A_TIME: usize = 1 << 10;

/// What is at most lost by rounding where boxes or lengths are compared, as a part of a square.
const ROUNDING: f64 = 1e-14;

#[derive(Clone, Copy, Default)]
pub(super) struct Bounds {
    lo: [f64; 3],
    hi: [f64; 3],
}

impl Bounds {
    const NONE: Self = Self { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    fn with(self, other: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|c| self.lo[c].min(other.lo[c])),
            hi: std::array::from_fn(|c| self.hi[c].max(other.hi[c])),
        }
    }

    /// At most the squared distance between any two points of two boxes, however that is rounded.
    #[inline(always)]
    fn squared_distance(&self, other: &Self) -> f64 {
        let apart = |c: usize| (self.lo[c] - other.hi[c]).max(other.lo[c] - self.hi[c]).max(0.0);
        let [x, y, z] = [apart(0), apart(1), apart(2)];
        (x * x + y * y + z * z) * (1.0 - ROUNDING)
    }
}

/// The positions of a block, by coordinate; NaN where the last block has none.
#[derive(Clone)]
struct Block([[f64; BLOCK]; 3]);

impl Default for Block {
    fn default() -> Self {
        Self([[f64::NAN; BLOCK]; 3])
    }
}

/// Positions in blocks of [`BLOCK`], and boxes of boxes.
pub(super) struct Blocks {
    n_positions: usize,
    held: Vec<Block>,
    /// The boxes of the blocks, then of each [`FAN`] of those before.
    levels: Vec<Vec<Bounds>>,
}

impl Blocks {
    /// O(n). The search is fast where positions that follow each other are near each other.
    pub(super) fn new(positions: &[[f64; 3]], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let n = positions.len();
        let made = parallel::try_map_chunks(
            n,
            BLOCKS_AT_A_TIME * BLOCK,
            progress,
            || (),
            |(), range| {
                let block = |some: &[[f64; 3]]| {
                    let (mut block, mut bounds) = (Block::default(), Bounds::NONE);
                    for (i, p) in some.iter().enumerate() {
                        for (coordinates, &value) in block.0.iter_mut().zip(p) {
                            coordinates[i] = value;
                        }
                        bounds = bounds.with(&Bounds { lo: *p, hi: *p });
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
            let around = |some: &[Bounds]| some.iter().fold(Bounds::NONE, Bounds::with);
            levels.push(last.chunks(FAN).map(around).collect());
        }
        Ok(Self { n_positions: n, held: blocks, levels })
    }

    fn position(&self, i: usize) -> [f64; 3] {
        let block = &self.held[i / BLOCK].0;
        std::array::from_fn(|c| block[c][i % BLOCK])
    }

    /// The blocks whose boxes are at most as far from `bounds` as the root of `square`.
    fn within(&self, bounds: &Bounds, square: f64, stack: &mut Vec<(usize, usize)>, found: &mut Vec<u32>) {
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

/// What a position has near.
pub(super) struct Found<'a> {
    /// The square of the distance of the last that is wanted.
    pub(super) farthest: f64,
    /// The squares of the distances of all positions within that distance or a tie of it, in no order.
    pub(super) squares: &'a [f64],
    pub(super) names: &'a [u32],
}

impl Found<'_> {
    /// The positions by rising distance, then name.
    pub(super) fn by_distance(&self, sorted: &mut Vec<(f64, u32)>) {
        sorted.clear();
        sorted.extend(self.squares.iter().copied().zip(self.names.iter().copied()));
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
}

/// The nearest positions of one position after the other; what is kept from the last one only saves time.
pub(super) struct Search<'a> {
    blocks: &'a Blocks,
    arch: Arch,
    /// How many are wanted, the position itself included, each counted as often as `weight` says.
    count: usize,
    /// Squares of distances that differ by less than this factor are equal.
    tie: f64,
    /// The last position, and at least the distance of the last of its `count`.
    last: Option<([f64; 3], f64)>,
    /// The block that `near` and `own` are of.
    block: usize,
    /// At least the squares of the distances of the last that is wanted, for each position of the block.
    own: [f64; BLOCK],
    /// The blocks that its positions can have near; none where these are too many or not known.
    near: Vec<u32>,
    stack: Vec<(usize, usize)>,
    /// Boxes that are still to be looked into: level, number, at most the square of their distance.
    boxes: Vec<(usize, usize, f64)>,
    /// What was found: the first `n_found` of each.
    squares: Vec<f64>,
    names: Vec<u32>,
    n_found: usize,
    sorted: Vec<f64>,
}

/// So many blocks are looked through for each position of a block; beyond them each position searches for itself.
const MAX_SHARED: usize = 64;

impl<'a> Search<'a> {
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

    /// What position `i` has near, each position counted `weight` times.
    ///
    /// # Panics
    /// Where there are fewer than are wanted.
    pub(super) fn nearest(&mut self, i: usize, weight: impl Fn(u32) -> usize) -> Found<'_> {
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
            self.look(&near, &p, bound);
            self.near = near;
        }
        let farthest = self.kth(&weight).expect("as many positions as are wanted");
        self.last = Some((p, farthest.sqrt() * (1.0 + ROUNDING)));
        self.keep_within(farthest * self.tie);
        Found { farthest, squares: &self.squares[..self.n_found], names: &self.names[..self.n_found] }
    }

    /// Drops what was found farther away.
    fn keep_within(&mut self, limit: f64) {
        let mut kept = 0;
        for k in 0..self.n_found {
            let (square, name) = (self.squares[k], self.names[k]);
            (self.squares[kept], self.names[kept]) = (square, name);
            kept += usize::from(square <= limit);
        }
        self.n_found = kept;
    }

    /// Finds the blocks that the positions of a block can have near: within the distances that enough of their own block have.
    fn enter(&mut self, block: usize) {
        self.block = block;
        self.near.clear();
        self.own = [f64::INFINITY; BLOCK];
        let n = BLOCK.min(self.blocks.n_positions - block * BLOCK);
        if self.count > n {
            return;
        }
        let mut farthest = 0.0_f64;
        let Block([x, y, z]) = &self.blocks.held[block];
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
        self.blocks.within(&self.blocks.levels[0][block], square, &mut self.stack, &mut self.near);
        if self.near.len() > MAX_SHARED {
            self.near.clear();
        }
    }

    /// Finds all positions whose squared distance from `p` is at most `bound`, or as far as the last that is wanted: the nearest
    /// boxes first, so that the bound falls soon, however the positions lie along the curve.
    fn descend(&mut self, p: &[f64; 3], mut bound: f64) {
        let blocks = self.blocks;
        let own = Bounds { lo: *p, hi: *p };
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
            self.look(&[i as u32], p, bound);
            if self.n_found > many {
                let farthest = self.kth(&|_| 1).map_or(f64::INFINITY, |farthest| farthest * self.tie);
                bound = bound.min(farthest);
                self.keep_within(bound);
                many = many.max(2 * self.n_found);
            }
        }
    }

    /// Adds all positions of some blocks whose squared distance from `p` is at most `bound`.
    fn look(&mut self, near: &[u32], p: &[f64; 3], bound: f64) {
        let Self { blocks, squares, names, n_found, .. } = self;
        *n_found = self.arch.dispatch(Look { blocks, near, p, bound, squares, names, n_found: *n_found });
    }

    /// The square of the distance of the last that is wanted, of those that were seen.
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
struct Look<'a> {
    blocks: &'a Blocks,
    near: &'a [u32],
    p: &'a [f64; 3],
    bound: f64,
    squares: &'a mut Vec<f64>,
    names: &'a mut Vec<u32>,
    /// How many are there already.
    n_found: usize,
}

impl NullaryFnOnce for Look<'_> {
    /// How many are there now.
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self { blocks, near, p, bound, squares, names, n_found: mut n } = self;
        let own = Bounds { lo: *p, hi: *p };
        for &block in near {
            if blocks.levels[0][block as usize].squared_distance(&own) > bound {
                continue;
            }
            let Block([x, y, z]) = &blocks.held[block as usize];
            let mut found = [0.0; BLOCK];
            for i in 0..BLOCK {
                let (x, y, z) = (p[0] - x[i], p[1] - y[i], p[2] - z[i]);
                found[i] = x * x + y * y + z * z;
            }
            if n + BLOCK > squares.len() {
                squares.resize(2 * squares.len(), 0.0);
                names.resize(squares.len(), 0);
            }
            // Written always and counted where it is near: no branch that is guessed wrong.
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
