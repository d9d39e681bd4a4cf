//! Sums over millions of terms that give the same bits on any number of threads.

use rayon::prelude::*;

/// Terms that one thread sums before partial sums are added in order.
const TERMS_AT_A_TIME: usize = 8192;

/// Σ term(i) for i in `0..n`, the same bits on any number of threads.
pub(crate) fn sum(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    (0..n.div_ceil(TERMS_AT_A_TIME))
        .into_par_iter()
        .map(|chunk| {
            (chunk * TERMS_AT_A_TIME..((chunk + 1) * TERMS_AT_A_TIME).min(n)).map(&term).sum::<f64>()
        })
        .collect::<Vec<f64>>()
        .into_iter()
        .sum()
}

/// The largest term(i) for i in `0..n`, or `floor` where no term is larger.
pub(crate) fn max(n: usize, floor: f64, term: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    (0..n).into_par_iter().with_min_len(TERMS_AT_A_TIME).map(term).reduce(|| floor, f64::max)
}
