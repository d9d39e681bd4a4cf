//! The walk cut into tiles: blocks of consecutive vertices with the rings of neighbours around them.
//!
//! A tile carries several steps of a recurrence on its own: for `depth` steps of its own vertices it needs the values
//! of `depth` rings around them, and step i recomputes what `depth − i` rings need. So the vectors between the steps
//! stay in the processor's cache, and memory is read and written once in `depth` steps (the matrix-powers kernel).
//!
//! Source: `demmel2008`.

use crate::operator::Diffusion;
use rayon::prelude::*;

/// Numbers vertices of a tile.
pub(crate) trait Index: Copy + Send + Sync + TryFrom<u32> + std::fmt::Debug {
    fn get(self) -> usize;
}

impl Index for u16 {
    #[inline]
    fn get(self) -> usize {
        self as usize
    }
}

impl Index for u32 {
    #[inline]
    fn get(self) -> usize {
        self as usize
    }
}

/// Consecutive rows of a tile with the same number of neighbours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) degree: usize,
    pub(super) n_rows: usize,
}

/// A block of vertices and the rings around it. Vertices are numbered with the own ones first, in their order, then ring
/// by ring.
#[derive(Debug)]
pub(super) struct Tile<I> {
    /// The first of its own vertices; the others follow.
    first: usize,
    /// Vertices within r rings, r = 0 … depth.
    within: Vec<usize>,
    /// The vertices of rings 1 … depth.
    halo: Vec<u32>,
    /// Runs of the rows of rings 0 … depth − 1, by ring and then by degree.
    runs: Vec<Run>,
    /// Runs within r rings, r = 0 … depth − 1.
    runs_within: Vec<usize>,
    /// The vertex of each row, in the order of the runs.
    rows: Vec<I>,
    /// The neighbours of each row.
    columns: Vec<I>,
    /// `4Φ₁(x,y)`, that is twice the entries of `Y = 2Φ₁ − I`.
    weights: Vec<f64>,
}

impl<I: Index> Tile<I> {
    pub(super) fn first(&self) -> usize {
        self.first
    }

    pub(super) fn n_own(&self) -> usize {
        self.within[0]
    }

    pub(super) fn n_within(&self, rings: usize) -> usize {
        self.within[rings]
    }

    pub(super) fn halo(&self) -> &[u32] {
        &self.halo
    }

    pub(super) fn runs_within(&self, rings: usize) -> &[Run] {
        &self.runs[..self.runs_within[rings]]
    }

    pub(super) fn rows(&self) -> &[I] {
        &self.rows
    }

    pub(super) fn columns(&self) -> &[I] {
        &self.columns
    }

    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of::<I>() * (self.rows.len() + self.columns.len())
            + 8 * (self.weights.len() + self.within.len() + self.runs_within.len())
            + 4 * self.halo.len()
            + size_of::<Run>() * self.runs.len()
    }

    /// Asserts what the kernels rely on: every row and column is a vertex of the tile, and the lists are as long as the
    /// runs say.
    fn assert_consistent(&self) {
        let depth = self.runs_within.len();
        assert_eq!(self.within.len(), depth + 1);
        assert_eq!(self.within[depth], self.within[0] + self.halo.len());
        let (mut n_rows, mut n_entries, mut n_runs) = (0, 0, 0);
        for ring in 0..depth {
            for run in &self.runs[n_runs..self.runs_within[ring]] {
                let rows = &self.rows[n_rows..n_rows + run.n_rows];
                assert!(rows.iter().all(|row| row.get() < self.within[ring]));
                let n = run.n_rows * run.degree;
                let columns = &self.columns[n_entries..n_entries + n];
                assert!(columns.iter().all(|column| column.get() < self.within[ring + 1]));
                n_rows += run.n_rows;
                n_entries += n;
            }
            n_runs = self.runs_within[ring];
            assert_eq!(n_rows, self.within[ring]);
        }
        assert_eq!((n_rows, n_entries), (self.rows.len(), self.columns.len()));
        assert_eq!(n_entries, self.weights.len());
    }
}

/// All tiles of a walk, with the narrowest numbers that name their vertices.
#[derive(Debug)]
pub(super) enum Tiles {
    Narrow(Vec<Tile<u16>>),
    Wide(Vec<Tile<u32>>),
}

impl Tiles {
    /// Cuts the walk into tiles of `own` vertices and `depth` rings.
    pub(super) fn new(diffusion: &Diffusion, own: usize, depth: usize) -> Self {
        build(diffusion, own, depth)
            .map_or_else(|| Self::Wide(Self::wide(diffusion, own, depth)), Self::Narrow)
    }

    pub(super) fn wide(diffusion: &Diffusion, own: usize, depth: usize) -> Vec<Tile<u32>> {
        build(diffusion, own, depth).expect("32 bits name every vertex")
    }

    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Narrow(tiles) => tiles.iter().map(Tile::bytes).sum::<usize>() as u64,
            Self::Wide(tiles) => tiles.iter().map(Tile::bytes).sum::<usize>() as u64,
        }
    }
}

/// What building a tile needs for every vertex of the walk: no vertex is in the tile at first.
struct Scratch {
    local: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

impl Scratch {
    fn new(n: usize) -> Self {
        Self { local: vec![ABSENT; n] }
    }

    /// The vertices of rings 1 … `depth` around `own`, and how many are within r rings. Leaves the vertices numbered.
    fn rings(
        &mut self,
        diffusion: &Diffusion,
        own: std::ops::Range<usize>,
        depth: usize,
    ) -> (Vec<u32>, Vec<usize>) {
        let n_own = own.len();
        for (local, x) in own.clone().enumerate() {
            self.local[x] = local as u32;
        }
        let mut halo: Vec<u32> = Vec::new();
        let mut within = vec![n_own];
        let mut scanned = 0;
        for ring in 0..depth {
            let end = halo.len();
            let mut visit = |x: usize, halo: &mut Vec<u32>| {
                for &y in diffusion.row(x).0 {
                    let local = &mut self.local[y as usize];
                    if *local == ABSENT {
                        *local = (n_own + halo.len()) as u32;
                        halo.push(y);
                    }
                }
            };
            if ring == 0 {
                own.clone().for_each(|x| visit(x, &mut halo));
            } else {
                for k in scanned..end {
                    visit(halo[k] as usize, &mut halo);
                }
                scanned = end;
            }
            within.push(n_own + halo.len());
        }
        (halo, within)
    }

    fn forget(&mut self, own: std::ops::Range<usize>, halo: &[u32]) {
        self.local[own].fill(ABSENT);
        for &x in halo {
            self.local[x as usize] = ABSENT;
        }
    }
}

/// Vertices of rings 1 … `depth` around each of a few blocks of `own` vertices spread over the walk, in parts of the block:
/// `shares[r]` is how much larger a block with r rings is.
pub(super) fn halo_shares(diffusion: &Diffusion, own: usize, depth: usize) -> Vec<f64> {
    const SAMPLES: usize = 8;
    let n = diffusion.n_vertices();
    let n_blocks = n.div_ceil(own).max(1);
    let mut scratch = Scratch::new(n);
    let mut sums = vec![0_usize; depth + 1];
    for sample in 0..SAMPLES.min(n_blocks) {
        let block = sample * n_blocks / SAMPLES.min(n_blocks);
        let range = block * own..((block + 1) * own).min(n);
        let (halo, within) = scratch.rings(diffusion, range.clone(), depth);
        scratch.forget(range, &halo);
        sums.iter_mut().zip(&within).for_each(|(sum, w)| *sum += w);
    }
    let base = sums[0].max(1) as f64;
    sums.into_iter().map(|sum| sum as f64 / base).collect()
}

/// `None` when `I` cannot number the vertices of some tile.
fn build<I: Index>(diffusion: &Diffusion, own: usize, depth: usize) -> Option<Vec<Tile<I>>> {
    assert!(own > 0 && depth > 0, "a tile has vertices and rings");
    let n = diffusion.n_vertices();
    (0..n.div_ceil(own))
        .into_par_iter()
        .with_min_len(n.div_ceil(own).div_ceil(4 * rayon::current_num_threads()))
        .map_init(
            || Scratch::new(n),
            |scratch, block| {
                let range = block * own..((block + 1) * own).min(n);
                let (halo, within) = scratch.rings(diffusion, range.clone(), depth);
                let tile = number(diffusion, scratch, range.clone(), &halo, within);
                scratch.forget(range, &halo);
                tile.map(|tile| Tile { halo, ..tile }.checked())
            },
        )
        .collect()
}

fn number<I: Index>(
    diffusion: &Diffusion,
    scratch: &Scratch,
    own: std::ops::Range<usize>,
    halo: &[u32],
    within: Vec<usize>,
) -> Option<Tile<I>> {
    let depth = within.len() - 1;
    I::try_from(within[depth].saturating_sub(1) as u32).ok()?;
    let index = |local: usize| I::try_from(local as u32).ok();
    let n_own = within[0];
    let global = |local: usize| if local < n_own { own.start + local } else { halo[local - n_own] as usize };
    let n_rows = within[depth - 1];
    let mut tile = Tile {
        first: own.start,
        within,
        halo: Vec::new(),
        runs: Vec::new(),
        runs_within: Vec::with_capacity(depth),
        rows: Vec::with_capacity(n_rows),
        columns: Vec::new(),
        weights: Vec::new(),
    };
    let n_entries = (0..n_rows).map(|local| diffusion.row(global(local)).0.len()).sum();
    tile.columns.reserve_exact(n_entries);
    tile.weights.reserve_exact(n_entries);
    let mut order: Vec<(u32, u32)> = Vec::new();
    for ring in 0..depth {
        let start = if ring == 0 { 0 } else { tile.within[ring - 1] };
        order.clear();
        order.extend(
            (start..tile.within[ring])
                .map(|local| (diffusion.row(global(local)).0.len() as u32, local as u32)),
        );
        order.sort_unstable();
        for same in order.chunk_by(|a, b| a.0 == b.0) {
            tile.runs.push(Run { degree: same[0].0 as usize, n_rows: same.len() });
        }
        for &(_, local) in &order {
            tile.rows.push(index(local as usize)?);
            let (columns, weights) = diffusion.row(global(local as usize));
            for (&y, w) in columns.iter().zip(weights) {
                tile.columns.push(index(scratch.local[y as usize] as usize)?);
                tile.weights.push(4.0 * w);
            }
        }
        tile.runs_within.push(tile.runs.len());
    }
    let halo_len = halo.len();
    debug_assert_eq!(tile.within[depth], n_own + halo_len);
    Some(tile)
}

impl<I: Index> Tile<I> {
    /// Checks every tile once, after it is complete.
    pub(super) fn checked(self) -> Self {
        self.assert_consistent();
        self
    }
}
