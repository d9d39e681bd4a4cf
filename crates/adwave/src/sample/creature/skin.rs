//! Skin: small heights in model units over the smooth body, each kind with its own pattern and wavelength.

use super::super::implicit::{V3, smoothstep};
use std::f64::consts::TAU;

/// No skin is higher or deeper than this, model units.
pub(super) const MAX_HEIGHT: f64 = 0.022;

/// Where on a part a height is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) at: V3,
    /// Distance along the part's chain of bones, model units.
    pub(super) along: f64,
}

/// A layer of skin. Heights and sizes in model units.
#[derive(Clone, Debug)]
pub(super) enum Skin {
    /// Rounded grains of varied size with creases between, `size` apart.
    Pebbles { size: f64, height: f64 },
    /// Rings round the chain, `size` apart, between `from` and `to` along it.
    Rings { size: f64, height: f64, from: f64, to: f64 },
    /// Rows of domed plates like tiles on an upright ellipsoid.
    Scutes { centre: V3, radius: f64, half_height: f64, n_rows: f64, n_columns: f64, height: f64 },
    /// Broad plates across the belly, `size` apart in y, where |x| < `half_width` and z > `front`.
    BellyPlates { size: f64, height: f64, half_width: f64, front: f64 },
}

impl Skin {
    /// Height at a place, positive outwards.
    pub(super) fn height(&self, place: &Place) -> f64 {
        let p = place.at;
        match *self {
            Self::Pebbles { size, height } => height * pebbles(p / size),
            Self::Rings { size, height, from, to } => {
                let mask =
                    smoothstep(from, from + size, place.along) * smoothstep(to, to - size, place.along);
                height * mask * ring(place.along / size)
            }
            Self::Scutes { centre, radius, half_height, n_rows, n_columns, height } => {
                let q = p - centre;
                let latitude = (q.y / half_height).atan2(q.x.hypot(q.z) / radius);
                height * scute(latitude, q.x.atan2(-q.z), n_rows, n_columns)
            }
            Self::BellyPlates { size, height, half_width, front } => {
                let mask = smoothstep(half_width, 0.8 * half_width, p.x.abs())
                    * smoothstep(front, front + 0.06, p.z);
                // The plates sag towards the middle.
                height * mask * ring((p.y + 0.5 * p.x * p.x) / size)
            }
        }
    }
}

/// A row of rounded ridges with narrow valleys, period 1, between −1 and 1.
fn ring(x: f64) -> f64 {
    // |cos| has sharp valleys; a quarter of a sine leans the ridge over like a scale.
    let lean = x + 0.08 * (TAU * x).sin();
    2.0 * (TAU * 0.5 * lean).cos().abs().sqrt() - 1.0
}

/// Domed plates in rows of latitude, every other row shifted by half a plate, between −1 and 1. Angles in radians.
fn scute(latitude: f64, longitude: f64, n_rows: f64, n_columns: f64) -> f64 {
    let row = (latitude / TAU * 2.0 + 0.5) * n_rows;
    let row_middle = row.floor() + 0.5;
    let count = (n_columns * ((row_middle / n_rows - 0.5) * TAU * 0.5).cos()).round().max(3.0);
    let shift = 0.5 * (row.floor() % 2.0);
    let column = longitude / TAU * count + shift;
    let (u, v) = (column - column.floor() - 0.5, row - row_middle);
    let edge = (0.5 - u.abs()).min(0.5 - v.abs());
    let plate = smoothstep(0.0, 0.2, edge);
    // Each plate rises towards its lower edge, as roof tiles do.
    plate * (1.3 - 0.7 * (u * u + v * v) * 2.0 - 0.35 * v) - 0.6
}

/// Cells round randomly placed seeds, about 1 apart: high in the middle, creased between; between −1 and 1.
fn pebbles(p: V3) -> f64 {
    let base = p.map(f64::floor);
    let (mut nearest, mut second) = (f64::INFINITY, f64::INFINITY);
    for k in -1..=1 {
        for j in -1..=1 {
            for i in -1..=1 {
                let cell = [base.x as i32 + i, base.y as i32 + j, base.z as i32 + k];
                let d2 = (seed_point(cell) - p).norm_squared();
                second = second.min(d2.max(nearest));
                nearest = nearest.min(d2);
            }
        }
    }
    let crease = smoothstep(0.0, 0.4, second.sqrt() - nearest.sqrt());
    2.0 * crease * (1.0 - 0.45 * nearest) - 1.0
}

/// The seed of an integer cell: its middle moved by up to 0.38 along each axis.
fn seed_point(cell: [i32; 3]) -> V3 {
    let mut h = 0x9e37_79b9_u32;
    for c in cell {
        h = (h ^ c as u32).wrapping_mul(0x85eb_ca6b);
        h ^= h >> 13;
        h = h.wrapping_mul(0xc2b2_ae35);
        h ^= h >> 16;
    }
    V3::from_fn(|a, _| {
        let tenth = f64::from(h >> (10 * a) & 1023) / 1023.0;
        f64::from(cell[a]) + 0.5 + 0.76 * (tenth - 0.5)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn patterns_stay_between_minus_one_and_one(x in -9.0..9.0_f64, y in -9.0..9.0_f64, z in -9.0..9.0_f64) {
            prop_assert!(pebbles(V3::new(x, y, z)).abs() <= 1.0);
            prop_assert!(ring(x).abs() <= 1.0);
            prop_assert!(scute((x * 0.17).clamp(-1.5, 1.5), y.clamp(-3.1, 3.1), 16.0, 21.0).abs() <= 1.0);
        }
    }
}
