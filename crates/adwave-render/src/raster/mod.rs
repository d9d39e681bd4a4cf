//! Which primitive each sample of the picture shows: a z-buffer over tiles.

mod bins;
mod disc;
mod triangle;

pub(crate) use bins::{Bins, PixelBox};
pub(crate) use disc::Disc;
pub(crate) use triangle::{Corner, Triangle};

/// Pixels of a tile's side: its samples fit into the processor's cache.
pub(crate) const TILE: usize = 32;

/// No primitive.
pub(crate) const NOTHING: u32 = u32::MAX;

/// The samples of one tile, rows of `side`.
pub(crate) struct TileSamples {
    /// Samples of a side.
    pub(crate) side: usize,
    /// The corner's place in samples.
    pub(crate) left: i32,
    /// The corner's place in samples.
    pub(crate) top: i32,
    /// How near the nearest primitive is; 0 is infinitely far.
    pub(crate) near: Vec<f32>,
    /// Which primitive it is.
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

    /// The rows and columns of samples within `low..=high` (in samples of the picture), as ranges of this tile.
    fn clip(&self, low: [i32; 2], high: [i32; 2]) -> Option<[[i32; 2]; 2]> {
        let last = self.side as i32 - 1;
        let x = [(low[0] - self.left).max(0), (high[0] - self.left).min(last)];
        let y = [(low[1] - self.top).max(0), (high[1] - self.top).min(last)];
        (x[0] <= x[1] && y[0] <= y[1]).then_some([x, y])
    }

    /// Takes the sample for `id` if it is nearer than what is there; of equally near ones the first stays.
    fn offer(&mut self, at: usize, near: f32, id: u32) {
        if near > self.near[at] {
            self.near[at] = near;
            self.id[at] = id;
        }
    }
}
