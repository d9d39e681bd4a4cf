//! Exact coverage of samples by a triangle.

use super::{PixelBox, TileSamples};

/// Number of steps of the grid for corners per sample. Integer coordinates make the edge tests of two adjacent
/// triangles exact, so that no sample between them is missed.
const STEPS: i64 = 256;

/// Corner on the subsample grid.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Corner {
    x: i32,
    y: i32,
    near: f32,
}

impl Corner {
    /// Rounds the position `x`, `y` (in samples) to the grid.
    pub(crate) fn new(x: f64, y: f64, near: f64) -> Self {
        let part = |c: f64| (c * STEPS as f64).round().clamp(-1e9, 1e9) as i32;
        Self { x: part(x), y: part(y), near: near as f32 }
    }

    fn position(self) -> [f32; 2] {
        [self.x, self.y].map(|c| c as f32 / STEPS as f32)
    }
}

/// Triangle in the picture.
#[derive(Clone, Copy)]
pub(crate) struct Triangle(pub(crate) [Corner; 3]);

impl Triangle {
    /// Twice the signed area in squared grid units; positive if the corners run clockwise in the picture (y down).
    fn doubled_area(&self) -> i64 {
        edge(self.0[0], self.0[1], i64::from(self.0[2].x), i64::from(self.0[2].y))
    }

    /// True if the corners run counterclockwise for the viewer, as on a front side.
    pub(crate) fn faces_viewer(&self) -> bool {
        self.doubled_area() < 0
    }

    /// First and last sample centers inside the bounding box, as columns and rows.
    fn sample_box(&self) -> [[i32; 2]; 2] {
        let range = |c: [i32; 3]| {
            let (low, high) = (c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2]));
            let (steps, half) = (STEPS as i32, STEPS as i32 / 2);
            // Centers lie at halves: the first at or after `low`, the last at or before `high`.
            [(low - half + steps - 1).div_euclid(steps), (high - half).div_euclid(steps)]
        };
        [range(self.0.map(|c| c.x)), range(self.0.map(|c| c.y))]
    }

    /// Pixels that the triangle may touch; empty if it covers no sample.
    pub(crate) fn pixel_box(&self, samples: i32) -> PixelBox {
        let [x, y] = self.sample_box();
        if x[0] > x[1] || y[0] > y[1] || self.doubled_area() == 0 {
            return PixelBox::EMPTY;
        }
        PixelBox([x[0], y[0], x[1], y[1]].map(|c| c.div_euclid(samples)))
    }

    /// Draws the covered samples of the tile.
    pub(crate) fn draw(&self, id: u32, tile: &mut TileSamples) {
        let area = self.doubled_area();
        if area == 0 {
            return;
        }
        let [a, mut b, mut c] = self.0;
        if area < 0 {
            std::mem::swap(&mut b, &mut c);
        }
        let [x, y] = self.sample_box();
        let Some([x, y]) = tile.clip([x[0], y[0]], [x[1], y[1]]) else { return };
        let center = |k: i32| i64::from(k) * STEPS + STEPS / 2;
        let (px, py) = (center(tile.left + x[0]), center(tile.top + y[0]));
        let edges = [(b, c), (c, a), (a, b)];
        let mut row = edges.map(|(p, q)| edge(p, q, px, py));
        let right = edges.map(|(p, q)| -i64::from(q.y - p.y) * STEPS);
        let down = edges.map(|(p, q)| i64::from(q.x - p.x) * STEPS);
        let inverse = 1.0 / area.abs() as f32;
        let slopes = [(b.near - a.near) * inverse, (c.near - a.near) * inverse];
        for sample_y in y[0]..=y[1] {
            let mut e = row;
            let start = sample_y as usize * tile.side;
            for sample_x in x[0]..=x[1] {
                if e[0] | e[1] | e[2] >= 0 {
                    let near = a.near + e[1] as f32 * slopes[0] + e[2] as f32 * slopes[1];
                    tile.offer(start + sample_x as usize, near, id);
                }
                for k in 0..3 {
                    e[k] += right[k];
                }
            }
            for k in 0..3 {
                row[k] += down[k];
            }
        }
    }

    /// Barycentric weights at a sample position, in [0, 1], on the triangle in space. With perspective, nearer corners
    /// weigh more than in the picture.
    pub(crate) fn weights(&self, x: f32, y: f32, perspective: bool) -> [f32; 3] {
        let [a, b, c] = self.0.map(Corner::position);
        let cross = |p: [f32; 2], q: [f32; 2]| (p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x);
        let w = [cross(b, c), cross(c, a), cross(a, b)];
        let total = w[0] + w[1] + w[2];
        if total == 0.0 {
            return [1.0 / 3.0; 3];
        }
        let mut w = w.map(|e| (e / total).clamp(0.0, 1.0));
        if perspective {
            for (weight, corner) in w.iter_mut().zip(&self.0) {
                *weight *= corner.near;
            }
        }
        let sum = w[0] + w[1] + w[2];
        w.map(|e| e / sum)
    }
}

/// Twice the signed area of the triangle p, q, (x, y), in squared grid units.
fn edge(p: Corner, q: Corner, x: i64, y: i64) -> i64 {
    let (px, py) = (i64::from(p.x), i64::from(p.y));
    (i64::from(q.x) - px) * (y - py) - (i64::from(q.y) - py) * (x - px)
}
