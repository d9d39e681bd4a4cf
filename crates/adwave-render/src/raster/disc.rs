//! Discs in space, for clouds, and balls.

use super::{PixelBox, TileSamples};
use crate::vector::Direction;

/// Disc seen at a slant, or a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    /// Center, in samples; x to the right, y down.
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) near: f32,
    /// Radius in samples.
    pub(crate) radius: f32,
    /// Increase of nearness per radius toward the viewer.
    pub(crate) near_per_radius: f32,
    /// Normal of the disc in the viewer's axes; `None` for a ball.
    pub(crate) normal: Option<Direction>,
}

/// Smallest cosine between a disc's normal and the direction toward the viewer, so that a disc seen from the side stays
/// visible.
const MIN_FACING: f32 = 0.35;

impl Disc {
    /// Pixels that the disc may touch.
    pub(crate) fn pixel_box(&self, samples: i32) -> PixelBox {
        let reach = self.reach();
        let low = [self.x - reach, self.y - reach].map(|c| c.floor() as i32);
        let high = [self.x + reach, self.y + reach].map(|c| c.ceil() as i32);
        PixelBox([low[0], low[1], high[0], high[1]].map(|c| c.div_euclid(samples)))
    }

    /// Drawn radius in samples, large enough that no point is lost.
    fn reach(&self) -> f32 {
        self.radius.max(0.75)
    }

    /// Height of the surface toward the viewer at an offset (u, v) from the center, all in radii; `None` outside.
    fn height(&self, u: f32, v: f32) -> Option<f32> {
        let flat = u * u + v * v;
        match self.normal {
            None => (flat <= 1.0).then(|| (1.0 - flat).sqrt()),
            Some(n) => {
                let facing = n[2].max(MIN_FACING);
                // y points down in the picture and up for the normal.
                let height = -(n[0] * u - n[1] * v) / facing;
                (flat + height * height <= 1.0).then_some(height)
            }
        }
    }

    /// Draws the covered samples of the tile.
    pub(crate) fn draw(&self, id: u32, tile: &mut TileSamples) {
        let reach = self.reach();
        let low = [self.x - reach, self.y - reach].map(|c| c.floor() as i32);
        let high = [self.x + reach, self.y + reach].map(|c| c.ceil() as i32);
        let Some([x, y]) = tile.clip(low, high) else { return };
        for row in y[0]..=y[1] {
            let v = ((tile.top + row) as f32 + 0.5 - self.y) / reach;
            for column in x[0]..=x[1] {
                let u = ((tile.left + column) as f32 + 0.5 - self.x) / reach;
                if let Some(height) = self.height(u, v) {
                    let near = (self.near + height * self.near_per_radius).max(1e-7);
                    tile.offer(row as usize * tile.side + column as usize, near, id);
                }
            }
        }
    }

    /// Normal at a sample position, in the viewer's axes.
    pub(crate) fn normal_at(&self, x: f32, y: f32) -> Direction {
        self.normal.unwrap_or_else(|| {
            let (u, v) = ((x - self.x) / self.reach(), (y - self.y) / self.reach());
            [u, -v, (1.0 - u * u - v * v).max(0.0).sqrt()]
        })
    }
}
