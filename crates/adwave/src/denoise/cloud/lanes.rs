//! Sums over neighbors, several at a time, with the same bits on every processor.

// Code compiled for several instruction sets must be inlined into the function that selects one.
#![allow(clippy::inline_always)]

use std::f64::consts::LOG2_E;
use std::ops::{Add, Mul, Sub};

/// Number of values that are computed side by side.
pub(super) const LANES: usize = 4;

/// Values that are computed side by side.
#[derive(Clone, Copy)]
pub(super) struct FourValues(pub(super) [f64; LANES]);

impl Add for FourValues {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
    }
}

impl Sub for FourValues {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
    }
}

impl Mul for FourValues {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]])
    }
}

impl Mul<f64> for FourValues {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self([factor; LANES])
    }
}

/// Four values from `k` on. Panics if there are fewer.
#[inline(always)]
pub(super) fn load(values: &[f64], k: usize) -> FourValues {
    let values = &values[k..k + LANES];
    FourValues([values[0], values[1], values[2], values[3]])
}

#[inline(always)]
pub(super) fn sum(FourValues([a, b, c, d]): FourValues) -> f64 {
    (a + b) + (c + d)
}

/// Exponent below which e^x counts as e^LEAST: far below every weight that has a part in a fit.
const LEAST: f64 = -700.0;

/// Adding it to a number rounds that to an integer, which the low bits of the sum hold.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// ln 2 in two parts: the first times a small integer is exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// e^x for x ≤ 0, to 1e-15 of it: 2^k·e^r with |r| ≤ ln 2 / 2, and e^r by its series.
#[inline(always)]
pub(super) fn exps(x: FourValues) -> FourValues {
    let x = FourValues(x.0.map(|x| if x > LEAST { x } else { LEAST }));
    let rounded = x * LOG2_E + FourValues([ROUNDER; LANES]);
    let k = rounded - FourValues([ROUNDER; LANES]);
    let r = x - k * LN_2[0] - k * LN_2[1];
    let mut series = FourValues([SERIES[SERIES.len() - 1]; LANES]);
    for coefficient in SERIES[..SERIES.len() - 1].iter().rev() {
        series = series * r + FourValues([*coefficient; LANES]);
    }
    let power = rounded.0.map(|t| f64::from_bits((t.to_bits() << 52).wrapping_add(1.0_f64.to_bits())));
    series * FourValues(power)
}

/// 1/n! for n = 0, 1, … 12.
const SERIES: [f64; 13] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
];

/// Degrees of the functions 1, u, v, u², uv, v² along u and v.
const DEGREES: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Sums for a fit of N = 3 (a plane) or 6 (a quadric) functions of u and v.
pub(super) struct FitSums<const N: usize> {
    /// Of the weights times u^i·v^j, by the degree i + j ≤ 4 (of a plane 2) and then by j.
    moments: [FourValues; 15],
    /// Of the weights times heights and each function.
    right: [FourValues; N],
}

impl<const N: usize> Default for FitSums<N> {
    #[inline(always)]
    fn default() -> Self {
        Self { moments: [FourValues([0.0; LANES]); 15], right: [FourValues([0.0; LANES]); N] }
    }
}

impl<const N: usize> FitSums<N> {
    /// Adds neighbors at [u, v].
    #[inline(always)]
    pub(super) fn add(&mut self, w: FourValues, [u, v]: [FourValues; 2], heights: FourValues) {
        let (wu, wv) = (w * u, w * v);
        let all = [w, wu, wv, wu * u, wu * v, wv * v];
        self.add_at(0, all);
        for (sum, product) in self.right.iter_mut().zip(all) {
            *sum = *sum + product * heights;
        }
        if N == 6 {
            let [uuu, uuv, uvv, vvv] = [all[3] * u, all[3] * v, all[5] * u, all[5] * v];
            self.add_at(6, [uuu, uuv, uvv, vvv]);
            self.add_at(10, [uuu * u, uuu * v, uuv * v, vvv * u, vvv * v]);
        }
    }

    #[inline(always)]
    fn add_at<const M: usize>(&mut self, first: usize, products: [FourValues; M]) {
        for (sum, product) in self.moments[first..first + M].iter_mut().zip(products) {
            *sum = *sum + product;
        }
    }

    /// The lower triangle of the matrix of the normal equations, and their right side.
    #[inline(always)]
    pub(super) fn equations(&self) -> ([[f64; N]; N], [f64; N]) {
        let moments = self.moments.map(sum);
        let mut matrix = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..=i {
                let along_v = DEGREES[i][1] + DEGREES[j][1];
                let degree = DEGREES[i][0] + DEGREES[j][0] + along_v;
                matrix[i][j] = moments[degree * (degree + 1) / 2 + along_v];
            }
        }
        (matrix, self.right.map(sum))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_those_of_the_library() {
        for i in 0..70_000 {
            let x = -0.01 * f64::from(i);
            let own = exps(FourValues([x, 0.5 * x, 0.001 * x, 1e-9 * x])).0;
            for (own, x) in own.into_iter().zip([x, 0.5 * x, 0.001 * x, 1e-9 * x]) {
                assert!((own / x.exp() - 1.0).abs() < 1e-15 * (1.0 + x.abs()), "{x}: {own}");
            }
        }
        assert_eq!(
            exps(FourValues([0.0, f64::NEG_INFINITY, -1e300, f64::NAN])).0.map(|e| e < 1e-300),
            [false, true, true, true]
        );
    }

    #[test]
    fn sums_are_the_normal_equations() {
        let place = |k: usize| [0.3 * k as f64 - 1.0, (1.7 * k as f64).sin()];
        let mut sums = FitSums::<6>::default();
        let (mut matrix, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
        for part in 0..3 {
            let at = |lane: usize| LANES * part + lane;
            let along = |axis: usize| FourValues(std::array::from_fn(|lane| place(at(lane))[axis]));
            let weight = |k: usize| 1.0 / (k + 1) as f64;
            let height = |k: usize| (k * k) as f64;
            let values = |f: &dyn Fn(usize) -> f64| FourValues(std::array::from_fn(|lane| f(at(lane))));
            sums.add(values(&weight), [along(0), along(1)], values(&height));
            for k in (0..LANES).map(at) {
                let f = super::super::fit::basis::<6>(place(k));
                for i in 0..6 {
                    for j in 0..=i {
                        matrix[i][j] += weight(k) * f[i] * f[j];
                    }
                    right[i] += weight(k) * f[i] * height(k);
                }
            }
        }
        let (own, own_right) = sums.equations();
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + b.abs());
        assert!(own.as_flattened().iter().zip(matrix.as_flattened()).all(|(a, b)| close(*a, *b)));
        assert!(own_right.iter().zip(right).all(|(a, b)| close(*a, b)));
    }
}
