//! Assignment of primitives to the tiles that they may touch.

use super::TILE;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Rectangle of pixels that a primitive may touch, both ends included: left, top, right, bottom. Empty if left > right.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelBox(pub(crate) [i32; 4]);

impl PixelBox {
    pub(crate) const EMPTY: Self = Self([1, 1, 0, 0]);

    fn tiles(self, n_tiles: [usize; 2]) -> Option<[usize; 4]> {
        let [left, top, right, bottom] = self.0;
        let tile = |c: i32, n: usize| (c.max(0) as usize / TILE).min(n - 1);
        (left <= right && top <= bottom && right >= 0 && bottom >= 0).then(|| {
            [tile(left, n_tiles[0]), tile(top, n_tiles[1]), tile(right, n_tiles[0]), tile(bottom, n_tiles[1])]
        })
    }
}

/// Number of primitives processed between two checks of the progress handle.
const CHECK_INTERVAL: usize = 1 << 14;

/// Primitives of each tile in ascending order, so that the order of drawing is always the same.
pub(crate) struct Bins {
    first: Vec<usize>,
    primitives: Vec<u32>,
}

impl Bins {
    pub(crate) fn new(
        n: usize,
        n_tiles: [usize; 2],
        pixels: impl Fn(usize) -> PixelBox + Sync,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let touched: Vec<Option<[usize; 4]>> =
            (0..n).into_par_iter().with_min_len(4096).map(|k| pixels(k).tiles(n_tiles)).collect();
        let mut first = vec![0; n_tiles[0] * n_tiles[1] + 1];
        let each = |tiles: &[usize; 4], f: &mut dyn FnMut(usize)| {
            for y in tiles[1]..=tiles[3] {
                for x in tiles[0]..=tiles[2] {
                    f(y * n_tiles[0] + x);
                }
            }
        };
        for chunk in touched.chunks(CHECK_INTERVAL) {
            progress.check()?;
            for tiles in chunk.iter().flatten() {
                each(tiles, &mut |t| first[t + 1] += 1);
            }
        }
        for t in 1..first.len() {
            first[t] += first[t - 1];
        }
        let mut next = first.clone();
        let mut primitives = vec![0; *first.last().unwrap_or(&0)];
        for (k, tiles) in touched.iter().enumerate() {
            if k % CHECK_INTERVAL == 0 {
                progress.check()?;
            }
            if let Some(tiles) = tiles {
                each(tiles, &mut |t| {
                    primitives[next[t]] = k as u32;
                    next[t] += 1;
                });
            }
        }
        Ok(Self { first, primitives })
    }

    pub(crate) fn primitives(&self, tile: usize) -> &[u32] {
        &self.primitives[self.first[tile]..self.first[tile + 1]]
    }
}
