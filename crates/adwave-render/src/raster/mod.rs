//! Z-buffer over tiles: finds the primitive shown by each sample.

mod bins;
mod disc;
mod triangle;

pub(crate) use bins::{Bins, PixelBox};
pub(crate) use disc::Disc;
pub(crate) use triangle::{Corner, Triangle};

/// Side of a tile in pixels; the samples of a tile fit into the processor's cache.
pub(crate) const TILE: usize = 32;

/// Index that represents no primitive.
pub(crate) const NOTHING: u32 = u32::MAX;

/// Samples of one tile, row by row.
pub(crate) struct TileSamples {
    /// Number of samples per side.
    pub(crate) side: usize,
    /// Left edge in samples.
    pub(crate) left: i32,
    /// Top edge in samples.
    pub(crate) top: i32,
    /// Nearness of the nearest primitive at each sample; 0 is infinitely far.
    pub(crate) near: Vec<f32>,
    /// Index of the nearest primitive at each sample.
    pub(crate) id: Vec<u32>,
}

impl TileSamples {
    pub(crate) fn new(tile_x: usize, tile_y: usize, samples: usize) -> Self {
        let side = TILE * samples;
        Self {
            side,
            left: (tile_x * side) as i32,
            top: (tile_y * side) as i32,
            near: vec![0.0; side * side],
            id: vec![NOTHING; side * side],
        }
    }

    /// Clips the box from `low` to `high` (column and row in samples of the picture, both included) to this tile, and
    /// returns the ranges of columns and rows of the tile; `None` if they are empty.
    fn clip(&self, low: [i32; 2], high: [i32; 2]) -> Option<[[i32; 2]; 2]> {
        let last = self.side as i32 - 1;
        let x = [(low[0] - self.left).max(0), (high[0] - self.left).min(last)];
        let y = [(low[1] - self.top).max(0), (high[1] - self.top).min(last)];
        (x[0] <= x[1] && y[0] <= y[1]).then_some([x, y])
    }

    /// Sets the sample to `id` if it is nearer than the present primitive; of equally near primitives the first stays.
    fn offer(&mut self, at: usize, near: f32, id: u32) {
        if near > self.near[at] {
            self.near[at] = near;
            self.id[at] = id;
        }
    }
}
