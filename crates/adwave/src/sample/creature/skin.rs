//! Skin: small heights in model units over the smooth body, with a pattern and wavelength per kind.

use super::super::implicit::{V3, smoothstep};
use std::f64::consts::{PI, TAU};

/// Point of a part at which a height is evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) struct SkinPoint {
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
    /// Rows of overlapping scales on an upright ellipsoid.
    Scales { center: V3, radius: f64, half_height: f64, n_rows: f64, n_columns: f64, height: f64 },
    /// Pebbles where [`BellyPlates`](Self::BellyPlates) of the same extent are not.
    Flanks { size: f64, height: f64, half_width: f64, front: f64 },
    /// Broad plates across the belly, `size` apart in y, where |x| < `half_width` and z > `front`.
    BellyPlates { size: f64, height: f64, half_width: f64, front: f64 },
}

impl Skin {
    /// Bound of the magnitude of the height.
    pub(super) fn highest(&self) -> f64 {
        match *self {
            Self::Pebbles { height, .. }
            | Self::Rings { height, .. }
            | Self::Scales { height, .. }
            | Self::Flanks { height, .. }
            | Self::BellyPlates { height, .. } => height,
        }
    }

    /// Height at a point, positive outwards.
    pub(super) fn height(&self, place: &SkinPoint) -> f64 {
        let p = place.at;
        match *self {
            Self::Pebbles { size, height } => height * pebbles(p / size),
            Self::Rings { size, height, from, to } => {
                let mask =
                    smoothstep(from, from + size, place.along) * smoothstep(to, to - size, place.along);
                height * mask * ring(place.along / size)
            }
            Self::Scales { center, radius, half_height, n_rows, n_columns, height } => {
                let q = p - center;
                let latitude = (q.y / half_height).atan2(q.x.hypot(q.z) / radius);
                height * scales(latitude, q.x.atan2(-q.z), n_rows, n_columns)
            }
            Self::Flanks { size, height, half_width, front } => {
                height * (1.0 - belly(p, half_width, front)) * pebbles(p / size)
            }
            Self::BellyPlates { size, height, half_width, front } => {
                // The plates sag toward the middle.
                height * belly(p, half_width, front) * ring((p.y + 0.5 * p.x * p.x) / size)
            }
        }
    }
}

/// 1 on the belly, 0 elsewhere.
fn belly(p: V3, half_width: f64, front: f64) -> f64 {
    smoothstep(half_width, 0.8 * half_width, p.x.abs()) * smoothstep(front, front + 0.06, p.z)
}

/// A row of rounded ridges with narrow valleys, period 1, between −1 and 1.
fn ring(x: f64) -> f64 {
    // The sine tilts the ridge like a scale.
    let lean = x + 0.05 * (TAU * x).sin();
    let wave = (PI * lean).cos().powi(2);
    // Flat tops and narrow valleys.
    2.0 * wave * (1.0 + VALLEY) / (wave + VALLEY) - 1.0
}

/// Approximate share of a ring's width that its valley takes.
const VALLEY: f64 = 0.3;

/// Overlapping rounded scales in rows of latitude, every other row shifted by half a scale, each rising towards its
/// lower edge and covering the row below; between −1 and 1. Angles in radians.
fn scales(latitude: f64, longitude: f64, n_rows: f64, n_columns: f64) -> f64 {
    // Rows are counted downwards from the upper pole.
    let down = (0.5 - latitude / PI) * n_rows;
    let row = down.floor();
    let [above, own, below] = [-1.0, 0.0, 1.0].map(|d| scale(row + d, down, longitude, n_rows, n_columns));
    let own_covers = smoothstep(0.0, SCALE_EDGE, own.edge);
    let above_covers = smoothstep(0.0, SCALE_EDGE, above.edge);
    let height = below.height + (own.height - below.height) * own_covers;
    height + (above.height - height) * above_covers
}

/// Width of a scale's rounded edge in rows.
const SCALE_EDGE: f64 = 0.22;
/// Overhang of a scale over the next row at its middle, in rows.
const SCALE_OVERLAP: f64 = 0.62;

struct SkinScale {
    /// Height between −1 and 1.
    height: f64,
    /// Distance to the lower edge in rows, positive on the scale.
    edge: f64,
}

/// The scale of row `row` at this longitude.
fn scale(row: f64, down: f64, longitude: f64, n_rows: f64, n_columns: f64) -> SkinScale {
    let count = (n_columns * (PI * (0.5 - (row + 0.7) / n_rows)).cos()).round().max(3.0);
    let column = longitude / TAU * count + 0.5 * (row.rem_euclid(2.0));
    let u = 2.0 * (column - column.floor() - 0.5);
    let v = down - row;
    let rounding = 1.0 - u.abs().powi(3);
    let edge = 1.0 + SCALE_OVERLAP * rounding - SCALE_EDGE - v;
    let rise = v / (1.0 + SCALE_OVERLAP);
    SkinScale { height: (1.25 * rise + 0.75 * rounding - 1.0).clamp(-1.0, 1.0), edge }
}

/// Cells around randomly placed seeds, about 1 apart: high in the middle, creased between; between −1 and 1.
fn pebbles(p: V3) -> f64 {
    let base = p.map(f64::floor);
    let within = p - base;
    // Lower bound of the distance along an axis to the seeds of the cell `step` further.
    let gap = |axis: usize, step: i32| match step {
        0 => 0.0,
        1 => 1.0 + SEED_MARGIN - within[axis],
        _ => within[axis] + SEED_MARGIN,
    };
    let (mut nearest, mut second) = (f64::INFINITY, f64::INFINITY);
    // The cell itself comes first, because its result excludes most of the others.
    for k in [0, -1, 1] {
        for j in [0, -1, 1] {
            for i in [0, -1, 1] {
                if gap(0, i).powi(2) + gap(1, j).powi(2) + gap(2, k).powi(2) < second {
                    let cell = [base.x as i32 + i, base.y as i32 + j, base.z as i32 + k];
                    let d2 = (seed_point(cell) - p).norm_squared();
                    second = second.min(d2.max(nearest));
                    nearest = nearest.min(d2);
                }
            }
        }
    }
    // A wider crease keeps the slope across the surface below 1, so that no grain detaches.
    let crease = smoothstep(0.0, 0.5, second.sqrt() - nearest.sqrt());
    2.0 * crease * (1.0 - 0.45 * nearest) - 1.0
}

/// Distance of a seed from the walls of its cell, in cells.
const SEED_MARGIN: f64 = 0.12;

/// The seed of an integer cell: its center moved at random, but not past [`SEED_MARGIN`].
fn seed_point(cell: [i32; 3]) -> V3 {
    let mut h = 0x9e37_79b9_u32;
    for c in cell {
        h = (h ^ c as u32).wrapping_mul(0x85eb_ca6b);
        h ^= h >> 13;
        h = h.wrapping_mul(0xc2b2_ae35);
        h ^= h >> 16;
    }
    V3::from_fn(|a, _| {
        let fraction = f64::from(h >> (10 * a) & 1023) / 1023.0;
        f64::from(cell[a]) + 0.5 + (1.0 - 2.0 * SEED_MARGIN) * (fraction - 0.5)
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
            prop_assert!(scales((x * 0.17).clamp(-1.5, 1.5), y.clamp(-3.1, 3.1), 16.0, 21.0).abs() <= 1.0);
        }
    }
}
