//! The diffusion operator cut into tiles: blocks of consecutive vertices with the rings of neighbors around them.
//!
//! A tile takes several steps of a recurrence independently: `depth` steps of its interior need the values of
//! `depth` rings around it, and step i recomputes the values that `depth − i` rings need. The vectors between the
//! steps stay in the processor's cache, and memory is read and written once in `depth` steps (the matrix-powers
//! kernel). A pass reads the weights of a tile once, from the operator.
//!
//! Source: `demmel2008`.

use crate::operator::Diffusion;
use crate::{Cancelled, Progress};
use std::sync::Arc;

/// Index of a vertex within a tile.
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

/// Rows of a tile with the same number of neighbors.
#[derive(Clone, Copy, Debug)]
pub(super) struct DegreeRun {
    pub(super) degree: u32,
    pub(super) n_rows: u32,
}

/// Number of interior rows that are sorted by degree together; their weights and values, stored in vertex order,
/// are still in the first-level cache.
const ROWS_SORTED: usize = 128;

/// A block of vertices and the rings around it. The interior is numbered first, in vertex order, then ring by ring;
/// within each ring except the outermost by ascending degree.
#[derive(Debug)]
pub(super) struct Tile<I> {
    /// First interior vertex; the others follow.
    first: usize,
    /// Number of vertices within r rings, r = 0 … depth.
    within: Vec<usize>,
    /// Vertices of rings 1 … depth.
    halo: Vec<u32>,
    /// Runs of the rows of rings 0 … depth − 1.
    runs: Vec<DegreeRun>,
    /// Number of runs within r rings, r = 0 … depth − 1.
    runs_within: Vec<usize>,
    /// Vertex of each interior row, in the order of the runs. The rows of the rings are in the order of their
    /// vertices.
    rows: Vec<I>,
    /// Neighbors of each row.
    columns: Vec<I>,
}

/// A tile and its operator, as read by the loops.
#[derive(Debug)]
pub(super) struct TileView<'a, I> {
    tile: &'a Tile<I>,
    offsets: &'a [usize],
}

impl<I> Clone for TileView<'_, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<I> Copy for TileView<'_, I> {}

impl<'a, I: Index> TileView<'a, I> {
    pub(super) fn first(self) -> usize {
        self.tile.first
    }

    pub(super) fn n_own(self) -> usize {
        self.tile.within[0]
    }

    /// Number of rings of a full pass.
    pub(super) fn depth(self) -> usize {
        self.tile.runs_within.len()
    }

    pub(super) fn n_within(self, rings: usize) -> usize {
        self.tile.within[rings]
    }

    pub(super) fn halo(self) -> &'a [u32] {
        &self.tile.halo
    }

    /// Number of values around it that a full pass needs per channel: `T_k` in all rings, `T_{k−1}` in all but the
    /// outermost.
    pub(super) fn n_around(self) -> usize {
        self.tile.n_around()
    }

    /// Runs of the interior rows.
    pub(super) fn own_runs(self) -> &'a [DegreeRun] {
        &self.tile.runs[..self.tile.runs_within[0]]
    }

    /// Runs of the rows of rings 1 … `rings`.
    pub(super) fn ring_runs(self, rings: usize) -> &'a [DegreeRun] {
        &self.tile.runs[self.tile.runs_within[0]..self.tile.runs_within[rings]]
    }

    pub(super) fn rows(self) -> &'a [I] {
        &self.tile.rows
    }

    pub(super) fn columns(self) -> &'a [I] {
        &self.tile.columns
    }

    /// Start of the entries of each vertex of the operator, and the end of the last.
    pub(super) fn offsets(self) -> &'a [usize] {
        self.offsets
    }
}

impl<I: Index> Tile<I> {
    fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of::<I>() * (self.rows.len() + self.columns.len())
            + 8 * (self.within.len() + self.runs_within.len())
            + 4 * self.halo.len()
            + size_of::<DegreeRun>() * self.runs.len()
    }

    fn n_around(&self) -> usize {
        let depth = self.runs_within.len();
        self.within[depth] + self.within[depth - 1] - 2 * self.within[0]
    }

    /// Checks the assumptions of the kernels: every row and column is a vertex of the tile, the lists have the
    /// lengths of the runs, and each row has as many entries in the operator as its run states.
    fn assert_consistent(&self, diffusion: &Diffusion) {
        let depth = self.runs_within.len();
        assert_eq!(self.within.len(), depth + 1);
        assert_eq!(self.within[depth], self.within[0] + self.halo.len());
        assert_eq!(self.rows.len(), self.within[0]);
        let degree = |x: usize| diffusion.row(x).0.len();
        let (mut n_rows, mut n_entries, mut n_runs) = (0, 0, 0);
        for ring in 0..depth {
            for run in &self.runs[n_runs..self.runs_within[ring]] {
                let rows = n_rows..n_rows + run.n_rows as usize;
                let has_degree = |x: usize| degree(x) == run.degree as usize;
                if ring == 0 {
                    let own = |row: &I| row.get() < self.within[0] && has_degree(self.first + row.get());
                    assert!(self.rows[rows.clone()].iter().all(own));
                } else {
                    let halo = rows.start - self.within[0]..rows.end - self.within[0];
                    assert!(self.halo[halo].iter().all(|&x| has_degree(x as usize)));
                }
                let n = rows.len() * run.degree as usize;
                let columns = &self.columns[n_entries..n_entries + n];
                assert!(columns.iter().all(|column| column.get() < self.within[ring + 1]));
                n_rows = rows.end;
                n_entries += n;
            }
            n_runs = self.runs_within[ring];
            assert_eq!(n_rows, self.within[ring]);
        }
        assert_eq!(n_entries, self.columns.len());
        assert!(self.first + self.within[0] <= diffusion.n_vertices());
        assert!(self.halo.iter().all(|&x| (x as usize) < diffusion.n_vertices()));
    }
}

/// Tiles of one operator with vertex indices of type `I`.
#[derive(Debug)]
pub(super) struct TileList<I> {
    tiles: Vec<Tile<I>>,
    diffusion: Arc<Diffusion>,
}

impl<I: Index> TileList<I> {
    pub(super) fn len(&self) -> usize {
        self.tiles.len()
    }

    /// The operator that the tiles belong to.
    #[cfg(test)]
    pub(super) fn diffusion(&self) -> &Diffusion {
        &self.diffusion
    }

    /// The tiles, each with the operator that it has been checked against.
    pub(super) fn iter(&self) -> impl Iterator<Item = TileView<'_, I>> {
        let offsets = self.diffusion.neighbors().offsets();
        self.tiles.iter().map(move |tile| TileView { tile, offsets })
    }

    /// Cuts the operator into tiles of `own` vertices and `depth` rings; `None` if `I` cannot number the vertices
    /// of some tile.
    fn new(
        diffusion: &Arc<Diffusion>,
        own: usize,
        depth: usize,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        assert!(own > 0 && depth > 0, "a tile has vertices and rings");
        let n = diffusion.n_vertices();
        let scratches = NumberingPool::new(n);
        let tiles = crate::parallel::try_map_chunks(
            n,
            own,
            progress,
            || (),
            |(), range| {
                scratches.use_free(|scratch| {
                    let (halo, within) = scratch.rings(diffusion, range.clone(), depth);
                    let tile = number(diffusion, scratch, range.clone(), &halo, within);
                    scratch.forget(range, &halo);
                    tile.map(|tile| Tile { halo, ..tile }.validate(diffusion))
                })
            },
        )?;
        let tiles: Option<Vec<Tile<I>>> = tiles.into_iter().collect();
        Ok(tiles.map(|tiles| Self { tiles, diffusion: Arc::clone(diffusion) }))
    }
}

/// All tiles of an operator, with the narrowest sufficient index type.
#[derive(Debug)]
pub(super) enum Tiles {
    Narrow(TileList<u16>),
    Wide(TileList<u32>),
}

impl Tiles {
    /// Cuts the operator into tiles of `own` vertices and `depth` rings. Up to O(entries · size of a tile / own).
    pub(super) fn new(
        diffusion: &Arc<Diffusion>,
        own: usize,
        depth: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        Ok(match TileList::new(diffusion, own, depth, progress)? {
            Some(tiles) => Self::Narrow(tiles),
            None => Self::Wide(Self::wide(diffusion, own, depth, progress)?),
        })
    }

    pub(super) fn wide(
        diffusion: &Arc<Diffusion>,
        own: usize,
        depth: usize,
        progress: Progress<'_>,
    ) -> Result<TileList<u32>, Cancelled> {
        Ok(TileList::new(diffusion, own, depth, progress)?.expect("32 bits name every vertex"))
    }

    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Narrow(tiles) => tiles.tiles.iter().map(Tile::bytes).sum::<usize>() as u64,
            Self::Wide(tiles) => tiles.tiles.iter().map(Tile::bytes).sum::<usize>() as u64,
        }
    }

    /// Number of values around all tiles in a full pass.
    pub(super) fn n_around(&self) -> usize {
        match self {
            Self::Narrow(tiles) => tiles.tiles.iter().map(Tile::n_around).sum(),
            Self::Wide(tiles) => tiles.tiles.iter().map(Tile::n_around).sum(),
        }
    }
}

/// Numbering of the vertices of the operator while a tile is built.
struct TileNumbering {
    /// One more than the index of each vertex in the tile; 0 for vertices outside it.
    local: Vec<u32>,
}

/// One numbering for each thread that builds tiles at the same time.
struct NumberingPool {
    n: usize,
    free: std::sync::Mutex<Vec<TileNumbering>>,
}

impl NumberingPool {
    fn new(n: usize) -> Self {
        Self { n, free: std::sync::Mutex::default() }
    }

    fn use_free<R>(&self, work: impl FnOnce(&mut TileNumbering) -> R) -> R {
        let free = self.free.lock().expect("nobody panics with the lock").pop();
        let mut scratch = free.unwrap_or_else(|| TileNumbering { local: crate::pages::zeros(self.n) });
        let result = work(&mut scratch);
        self.free.lock().expect("nobody panics with the lock").push(scratch);
        result
    }
}

impl TileNumbering {
    /// The vertices of rings 1 … `depth` around `own`, and the number within r rings. Leaves the vertices numbered.
    fn rings(
        &mut self,
        diffusion: &Diffusion,
        own: std::ops::Range<usize>,
        depth: usize,
    ) -> (Vec<u32>, Vec<usize>) {
        let n_own = own.len();
        for (local, x) in own.clone().enumerate() {
            self.local[x] = local as u32 + 1;
        }
        let mut halo: Vec<u32> = Vec::new();
        let mut within = vec![n_own];
        let mut scanned = 0;
        for ring in 0..depth {
            let end = halo.len();
            let mut visit = |x: usize, halo: &mut Vec<u32>| {
                for &y in diffusion.row(x).0 {
                    let local = &mut self.local[y as usize];
                    if *local == 0 {
                        halo.push(y);
                        *local = (n_own + halo.len()) as u32;
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
            if ring + 1 < depth {
                // Groups rows of the same degree.
                halo[end..].sort_by_key(|&x| diffusion.row(x as usize).0.len());
                for (k, &x) in (end..).zip(&halo[end..]) {
                    self.local[x as usize] = (n_own + k) as u32 + 1;
                }
            }
            within.push(n_own + halo.len());
        }
        halo.shrink_to_fit();
        (halo, within)
    }

    fn forget(&mut self, own: std::ops::Range<usize>, halo: &[u32]) {
        self.local[own].fill(0);
        for &x in halo {
            self.local[x as usize] = 0;
        }
    }
}

/// Relative size of a block with rings: `shares[r]` for r rings around each of a few blocks of `own` vertices
/// spread over the operator.
pub(super) fn halo_shares(
    diffusion: &Diffusion,
    own: usize,
    depth: usize,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    const SAMPLES: usize = 8;
    let n = diffusion.n_vertices();
    let n_blocks = n.div_ceil(own).max(1);
    let mut scratch = TileNumbering { local: crate::pages::zeros(n) };
    let mut sums = vec![0_usize; depth + 1];
    for sample in 0..SAMPLES.min(n_blocks) {
        progress.check()?;
        let block = sample * n_blocks / SAMPLES.min(n_blocks);
        let range = block * own..((block + 1) * own).min(n);
        let (halo, within) = scratch.rings(diffusion, range.clone(), depth);
        scratch.forget(range, &halo);
        sums.iter_mut().zip(&within).for_each(|(sum, w)| *sum += w);
    }
    let base = sums[0].max(1) as f64;
    Ok(sums.into_iter().map(|sum| sum as f64 / base).collect())
}

fn number<I: Index>(
    diffusion: &Diffusion,
    scratch: &TileNumbering,
    own: std::ops::Range<usize>,
    halo: &[u32],
    within: Vec<usize>,
) -> Option<Tile<I>> {
    let depth = within.len() - 1;
    I::try_from(within[depth].saturating_sub(1) as u32).ok()?;
    let index = |local: usize| I::try_from(local as u32).ok();
    let degree = |x: usize| diffusion.row(x).0.len();
    let n_own = own.len();
    let mut order: Vec<usize> = own.clone().collect();
    for rows in order.chunks_mut(ROWS_SORTED) {
        rows.sort_by_key(|&x| degree(x));
    }
    let rows = order.iter().map(|&x| index(x - own.start)).collect::<Option<Vec<I>>>()?;
    // All rows in their order.
    order.extend(halo[..within[depth - 1] - n_own].iter().map(|&x| x as usize));
    let (mut runs, mut runs_within) = (Vec::new(), Vec::with_capacity(depth));
    let mut columns = Vec::with_capacity(order.iter().map(|&x| degree(x)).sum());
    for ring in 0..depth {
        let start = if ring == 0 { 0 } else { within[ring - 1] };
        let rows = &order[start..within[ring]];
        for same in rows.chunk_by(|&x, &y| degree(x) == degree(y)) {
            runs.push(DegreeRun { degree: degree(same[0]) as u32, n_rows: same.len() as u32 });
        }
        runs_within.push(runs.len());
        for &x in rows {
            for &y in diffusion.row(x).0 {
                columns.push(index(scratch.local[y as usize] as usize - 1)?);
            }
        }
    }
    runs.shrink_to_fit();
    Some(Tile { first: own.start, within, halo: Vec::new(), runs, runs_within, rows, columns })
}

impl<I: Index> Tile<I> {
    /// Checks a tile once it is complete.
    fn validate(self, diffusion: &Diffusion) -> Self {
        self.assert_consistent(diffusion);
        self
    }
}
