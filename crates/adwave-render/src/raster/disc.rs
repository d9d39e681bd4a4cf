//! Discs in space, for clouds, and balls.

use super::{PixelBox, TileSamples};
use crate::vector::Direction;

/// A disc seen at a slant, or a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    /// The center in samples.
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) near: f32,
    /// The radius in samples.
    pub(crate) radius: f32,
    /// How much nearer a point one radius toward the viewer is.
    pub(crate) near_per_radius: f32,
    /// The disc's normal in the viewer's axes, or nothing for a ball.
    pub(crate) normal: Option<Direction>,
}

/// A disc seen from the side is drawn as if seen at this slant at most, lest it vanishes.
const MIN_FACING: f32 = 0.35;

impl Disc {
    /// The pixels that it may touch.
    pub(crate) fn pixel_box(&self, samples: i32) -> PixelBox {
        let reach = self.reach();
        let low = [self.x - reach, self.y - reach].map(|c| c.floor() as i32);
        let high = [self.x + reach, self.y + reach].map(|c| c.ceil() as i32);
        PixelBox([low[0], low[1], high[0], high[1]].map(|c| c.div_euclid(samples)))
    }

    /// At least a sample wide, so that no point is lost.
    fn reach(&self) -> f32 {
        self.radius.max(0.75)
    }

    /// How far toward the viewer the surface lies at an offset from the center in radii; nothing outside.
    fn height(&self, u: f32, v: f32) -> Option<f32> {
        let flat = u * u + v * v;
        match self.normal {
            None => (flat <= 1.0).then(|| (1.0 - flat).sqrt()),
            Some(n) => {
                let facing = n[2].max(MIN_FACING);
                // y is down in the picture and up for the normal.
                let height = -(n[0] * u - n[1] * v) / facing;
                (flat + height * height <= 1.0).then_some(height)
            }
        }
    }

    /// Offers the samples inside to the tile.
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

    /// The normal at a point in samples, in the viewer's axes.
    pub(crate) fn normal_at(&self, x: f32, y: f32) -> Direction {
        self.normal.unwrap_or_else(|| {
            let (u, v) = ((x - self.x) / self.reach(), (y - self.y) / self.reach());
            [u, -v, (1.0 - u * u - v * v).max(0.0).sqrt()]
        })
    }
}
