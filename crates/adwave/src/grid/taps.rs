//! Heat on lines of places at equal distances as a weighted sum of the places around each, for short times.
//!
//! `exp(−sD)` with the second differences D of a line without ends has the weights `w_k = exp(−2s)·I_k(2s)` of the places k
//! steps away, with the modified Bessel functions I (`lindeberg1990`). Beyond the ends a line goes on as its reflection, or
//! as the ring that it is. The weights are cut where the rest is below the accuracy, and what is cut goes to the place
//! itself: they are positive and sum to 1. The sums are those of the differences from a number near the mean of the line,
//! so that constants are kept to the last bit.
//!
//! Lines side by side are read in rows of up to [`COLUMNS`] values into a buffer that stays in a cache, one segment of rows
//! after the other, each with the rows around it.

// Functions that are compiled for the vectors of the machine must be inlined into the place that chooses these.
#![allow(clippy::inline_always)]

use pulp::Simd;

/// Most lines side by side whose rows are read together: pieces of memory that arrive fast.
pub(super) const COLUMNS: usize = 96;

/// Rows that are diffused between two moves of the buffer, or four times those on one side if these are more.
const SEGMENT: usize = 256;

/// Values of a line whose mean is subtracted. If one of them stands out, the differences lose up to √(n/16) roundings of
/// the norm.
const SAMPLES: usize = 16;

/// Number of vectors whose sums are computed together: enough that none waits for the one before.
const SUMS: usize = 8;

/// Places beyond the last weight that may be needed at which the recurrence starts: weights there are too small beside it
/// for the start to matter.
const AHEAD: usize = 64;

/// Accuracy of the weights relative to the one asked. Three digits more need few more places, and spare bands that are small
/// beside their signal a second pass.
const BEYOND: f64 = 1e-3;

/// Weights of the places around a place after a time.
pub(super) struct Taps {
    /// Weight of the place itself, and of those 1, 2, … steps away on each side.
    weights: Vec<f64>,
    is_ring: bool,
    error: f64,
}

/// Lines side by side, by their rows: of one place of all lines.
pub(super) trait LineRows {
    /// Row `at` of the values that are diffused.
    fn row(&self, at: usize) -> &[f64];

    /// Row `at` of the result, which may take the place of the values.
    fn row_mut(&mut self, at: usize) -> &mut [f64];
}

/// Buffers of a thread.
#[derive(Default)]
pub(super) struct TapBuffers {
    /// Rows less `base`, with those around them.
    places: Vec<f64>,
    /// First rows of rings.
    first: Vec<f64>,
    base: Vec<f64>,
}

impl Taps {
    /// The fewest weights that keep well within `accuracy` relative to the norm of the input after the time s, in squared
    /// spacings, on lines of n places; at most those up to `most` steps away, or `None`.
    pub(super) fn new(time: f64, accuracy: f64, most: usize, n: usize, is_ring: bool) -> Option<Self> {
        let most = most.min(n);
        let mut weights = bessel_weights(time, most + AHEAD);
        let rounding = |m: usize| (m as f64 + 4.0 + (n as f64 / SAMPLES as f64).sqrt()) * f64::EPSILON;
        // What is cut is missing at its places and added to the place itself.
        let cut = |m: usize| 4.0 * weights[m + 1..].iter().rev().sum::<f64>();
        let m = (0..=most).find(|&m| cut(m) <= (BEYOND * accuracy).max(f64::EPSILON))?;
        let error = cut(m) + rounding(m);
        weights.truncate(m + 1);
        weights[0] = 1.0 - 2.0 * weights[1..].iter().rev().sum::<f64>();
        Some(Self { weights, is_ring, error })
    }

    /// Bound of the error relative to the norm of the input.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// Places that the weights reach on each side.
    pub(super) fn reach(&self) -> usize {
        self.weights.len() - 1
    }

    /// Diffuses lines of n places side by side.
    pub(super) fn diffuse_rows(&self, buffers: &mut TapBuffers, n: usize, rows: &mut impl LineRows) {
        pulp::Arch::new().dispatch(DiffuseRows { taps: self, buffers, n, rows });
    }

    /// Diffuses lines of n places that lie one after another, `given` or `lines` itself.
    pub(super) fn diffuse_lines(
        &self,
        buffers: &mut TapBuffers,
        n: usize,
        given: Option<&[f64]>,
        lines: &mut [f64],
    ) {
        pulp::Arch::new().dispatch(DiffuseLines { taps: self, buffers, n, given, lines });
    }
}

/// `exp(−2s)·I_k(2s)` for k up to `last`, by the recurrence `I_{k−1} = I_{k+1} + (2k/x)·I_k` from above and
/// `I_0 + 2·Σ I_k = exp(x)`.
fn bessel_weights(time: f64, last: usize) -> Vec<f64> {
    /// Where the numbers are made smaller.
    const LARGE: f64 = 1e200;
    let mut weights = vec![0.0; last + 1];
    let x = 2.0 * time;
    if x <= f64::MIN_POSITIVE {
        weights[0] = 1.0;
        return weights;
    }
    let (mut above, mut here) = (0.0, 1e-200);
    weights[last] = here;
    for k in (1..=last).rev() {
        (above, here) = (here, 2.0 * k as f64 / x * here + above);
        if here > LARGE {
            let scale = 1.0 / here;
            (above, here) = (above * scale, 1.0);
            weights[k..].iter_mut().for_each(|weight| *weight *= scale);
        }
        weights[k - 1] = here;
    }
    let total = weights[0] + 2.0 * weights[1..].iter().rev().sum::<f64>();
    for weight in &mut weights {
        *weight /= total;
    }
    weights
}

/// [`Taps::diffuse_rows`] with the vectors of this machine.
struct DiffuseRows<'a, R> {
    taps: &'a Taps,
    buffers: &'a mut TapBuffers,
    n: usize,
    rows: &'a mut R,
}

impl<R: LineRows> pulp::WithSimd for DiffuseRows<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { taps, buffers, n, rows } = self;
        let TapBuffers { places, first, base } = buffers;
        let (m, width, segment) = (taps.reach(), rows.row(0).len(), SEGMENT.max(4 * taps.reach()));
        base.clear();
        base.extend_from_slice(rows.row(0));
        let share = 1.0 / SAMPLES.min(n) as f64;
        for sample in 1..SAMPLES.min(n) {
            let row = rows.row(sample * n / SAMPLES.min(n));
            base.iter_mut()
                .zip(rows.row(0))
                .zip(row)
                .for_each(|((base, start), x)| *base += share * (x - start));
        }
        places.resize((segment.min(n) + 2 * m) * width, 0.0);
        let fill = |place: &mut [f64], row: &[f64]| {
            place.iter_mut().zip(row).zip(base.iter()).for_each(|((place, x), base)| *place = x - base);
        };
        for k in 0..m {
            let row = rows.row(if taps.is_ring { n - 1 - k } else { k });
            fill(&mut places[(m - 1 - k) * width..][..width], row);
        }
        first.resize(if taps.is_ring { m * width } else { 0 }, 0.0);
        first.chunks_exact_mut(width).enumerate().for_each(|(at, place)| fill(place, rows.row(at)));
        // Row r of the buffer is row start + r − m of the lines.
        let (mut start, mut next) = (0, 0);
        loop {
            let end = (start + segment).min(n);
            for at in next..end + m {
                let place = (at + m - start) * width;
                if at < n {
                    fill(&mut places[place..place + width], rows.row(at));
                } else if taps.is_ring {
                    places[place..place + width].copy_from_slice(&first[(at - n) * width..][..width]);
                } else {
                    let mirrored = (2 * n - 1 - at + m - start) * width;
                    places.copy_within(mirrored..mirrored + width, place);
                }
            }
            next = end + m;
            let sums = Sums { simd, weights: &taps.weights, places, step: width };
            let mut column = 0;
            while column < width {
                let len = Sums::<S>::piece(width - column);
                let base = &base[column..column + len];
                for at in start..end {
                    let middle = (at + m - start) * width + column;
                    sums.write(middle, base, &mut rows.row_mut(at)[column..column + len]);
                }
                column += len;
            }
            if end == n {
                break;
            }
            places.copy_within((end - start) * width..(end - start + 2 * m) * width, 0);
            start = end;
        }
    }
}

/// [`Taps::diffuse_lines`] with the vectors of this machine.
struct DiffuseLines<'a> {
    taps: &'a Taps,
    buffers: &'a mut TapBuffers,
    n: usize,
    given: Option<&'a [f64]>,
    lines: &'a mut [f64],
}

impl pulp::WithSimd for DiffuseLines<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { taps, buffers, n, given, lines } = self;
        let TapBuffers { places, base, .. } = buffers;
        let m = taps.reach();
        places.resize(n + 2 * m, 0.0);
        for (k, line) in lines.chunks_exact_mut(n).enumerate() {
            let given = given.map_or(&*line, |given| &given[k * n..][..n]);
            let (samples, start) = (SAMPLES.min(n), given[0]);
            let share = 1.0 / samples as f64;
            let mean = (1..samples).fold(start, |mean, s| mean + share * (given[s * n / samples] - start));
            base.clear();
            base.resize(SUMS * S::F64_LANES, mean);
            places[m..m + n].iter_mut().zip(given).for_each(|(place, x)| *place = x - mean);
            for k in 0..m {
                let [before, after] = if taps.is_ring { [n - 1 - k, k] } else { [k, n - 1 - k] };
                (places[m - 1 - k], places[m + n + k]) = (places[m + before], places[m + after]);
            }
            let sums = Sums { simd, weights: &taps.weights, places, step: 1 };
            let mut at = 0;
            while at < n {
                let len = Sums::<S>::piece(n - at);
                sums.write(m + at, &base[..len], &mut line[at..at + len]);
                at += len;
            }
        }
    }
}

/// Sums over the places around each.
struct Sums<'a, S: Simd> {
    simd: S,
    weights: &'a [f64],
    places: &'a [f64],
    /// Distance between the values of adjacent places.
    step: usize,
}

impl<S: Simd> Sums<'_, S> {
    /// Number of values that are written at a time if so many are left.
    #[inline(always)]
    fn piece(n_left: usize) -> usize {
        [SUMS * S::F64_LANES, S::F64_LANES].into_iter().find(|len| *len <= n_left).unwrap_or(1)
    }

    /// Writes a [`piece`](Self::piece) of the sums whose own places begin at `middle`, on top of `base`.
    #[inline(always)]
    fn write(&self, middle: usize, base: &[f64], out: &mut [f64]) {
        if out.len() == SUMS * S::F64_LANES {
            self.write_vectors::<SUMS>(middle, base, out);
        } else if out.len() == S::F64_LANES {
            self.write_vectors::<1>(middle, base, out);
        } else {
            // To the bits that it has in a vector.
            let own = self.weights[0].mul_add(self.places[middle], base[0]);
            out[0] = (1..).zip(&self.weights[1..]).fold(own, |sum, (k, weight)| {
                weight.mul_add(self.places[middle - k * self.step] + self.places[middle + k * self.step], sum)
            });
        }
    }

    #[inline(always)]
    fn write_vectors<const N: usize>(&self, middle: usize, base: &[f64], out: &mut [f64]) {
        let &Self { simd, weights, places, step } = self;
        let vectors = |from: usize| -> &[S::f64s; N] {
            S::as_simd_f64s(&places[from..from + N * S::F64_LANES]).0.first_chunk().expect("N vectors")
        };
        let (base, own) = (S::as_simd_f64s(base).0, vectors(middle));
        let weight = simd.splat_f64s(weights[0]);
        let mut sums = [simd.splat_f64s(0.0); N];
        for k in 0..N {
            sums[k] = simd.mul_add_f64s(weight, own[k], base[k]);
        }
        for (steps, weight) in (1..).zip(&weights[1..]) {
            let weight = simd.splat_f64s(*weight);
            let (before, after) = (vectors(middle - steps * step), vectors(middle + steps * step));
            for k in 0..N {
                sums[k] = simd.mul_add_f64s(weight, simd.add_f64s(before[k], after[k]), sums[k]);
            }
        }
        S::as_mut_simd_f64s(out).0.copy_from_slice(&sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_a_walk_in_continuous_time() {
        // exp(−2s)·I_k(2s) by its series, Σ s^(2i+k)/(i!·(i+k)!).
        for time in [1e-300, 1e-9, 0.1, 0.25, 1.0, 3.7, 20.0] {
            let found = bessel_weights(time, 120);
            for (k, found) in found.iter().enumerate().take(60) {
                let log = |i: usize| (1..=i).map(|j| (j as f64).ln()).sum::<f64>();
                let term =
                    |i: usize| ((2 * i + k) as f64 * time.ln() - log(i) - log(i + k) - 2.0 * time).exp();
                let wanted = (0..150).map(term).sum::<f64>();
                assert!((found - wanted).abs() <= 1e-14 + 1e-11 * wanted, "{time} {k}: {found:e} {wanted:e}");
            }
        }
        assert_eq!(bessel_weights(0.0, 3), [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn the_error_of_the_cut_weights_is_bounded() {
        let n = 1000;
        let mut n_found = 0;
        for (time, most) in (0..80).flat_map(|k| [3, 28, 56].map(|most| (1e-4 * 1.21_f64.powi(k), most))) {
            let exact = bessel_weights(time, n);
            for accuracy in [3e-3, 1e-6, 1e-9, 1e-12] {
                let Some(taps) = Taps::new(time, accuracy, most, n, false) else { continue };
                n_found += 1;
                let weight = |k: usize| taps.weights.get(k).copied().unwrap_or(0.0);
                let off = |k: usize| (weight(k) - exact[k]).abs();
                let error = off(0) + 2.0 * (1..=n).map(off).sum::<f64>();
                assert!(error <= taps.error, "{time} {most} {accuracy:e}: {error:e} of {:e}", taps.error);
            }
        }
        assert!(n_found > 300, "{n_found} of the times have weights");
    }

    /// Rows of lines, in place.
    struct Block<'a>(&'a mut [f64], usize);

    impl LineRows for Block<'_> {
        fn row(&self, at: usize) -> &[f64] {
            &self.0[at * self.1..][..self.1]
        }

        fn row_mut(&mut self, at: usize) -> &mut [f64] {
            &mut self.0[at * self.1..][..self.1]
        }
    }

    #[test]
    fn lines_side_by_side_have_the_bits_of_lines_alone() {
        for (n, is_ring) in [(23, false), (40, true), (64, false), (900, false), (900, true)] {
            let taps = Taps::new(0.7, 1e-12, 20, n, is_ring).unwrap();
            for width in [1, 3, 8, 45, COLUMNS] {
                let value = |i: usize, lane: usize| ((i * 37 + lane * 11) % 29) as f64 / 7.0 - 1.3;
                let mut rows: Vec<f64> = (0..n * width).map(|at| value(at / width, at % width)).collect();
                let mut lines: Vec<f64> = (0..n * width).map(|at| value(at % n, at / n)).collect();
                let mut buffers = TapBuffers::default();
                taps.diffuse_rows(&mut buffers, n, &mut Block(&mut rows, width));
                taps.diffuse_lines(&mut buffers, n, None, &mut lines);
                for at in 0..n * width {
                    assert_eq!(rows[at], lines[at % width * n + at / width], "{n} {width} {at}");
                }
            }
        }
    }
}
