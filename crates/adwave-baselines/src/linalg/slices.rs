//! Smallest eigenpairs of one connected matrix, computed band by band; a count certifies each band.
//!
//! By Sylvester's law the factorization of `A − σI` yields the number of eigenvalues below σ, so that none is missed
//! (spectrum slicing; `vallet2008` also goes band by band, but without the count).

use super::lanczos::{EigenRequest, nearest_eigenpairs};
use super::ldlt::{FactorPattern, Ldlt};
use super::panel::Panel;
use super::{EigenParams, LinalgError, SymmetricMatrix};
use adwave::Progress;

/// Largest relative residual of an accurate solve with an indefinite factor.
const GOOD_SOLVE: f64 = 1e-7;
/// Largest number of shifts tried for one band.
const MAX_TRIES: usize = 12;

/// Known part of the spectrum: the eigenpairs computed so far, in ascending order.
pub(super) struct KnownSpectrum {
    pub(super) values: Vec<f64>,
    pub(super) vectors: Panel,
    pub(super) solves: usize,
    pub(super) restarts: usize,
    pub(super) factorizations: usize,
}

impl KnownSpectrum {
    /// Inserts eigenpairs into the known ones, in ascending order of the eigenvalue.
    fn insert(&mut self, values: &[f64], vectors: &Panel) {
        let mut all: Vec<(f64, bool, usize)> =
            self.values.iter().enumerate().map(|(i, &v)| (v, false, i)).collect();
        all.extend(values.iter().enumerate().map(|(i, &v)| (v, true, i)));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut merged = Panel::new(self.vectors.n);
        merged.values.reserve(all.len() * merged.n);
        for &(_, is_new, i) in &all {
            merged.values.extend_from_slice(if is_new { vectors.column(i) } else { self.vectors.column(i) });
        }
        self.vectors = merged;
        self.values = all.into_iter().map(|e| e.0).collect();
    }

    fn count_below(&self, shift: f64) -> usize {
        self.values.partition_point(|&v| v < shift)
    }
}

/// Computes the `k` smallest eigenpairs of a positive semi-definite `matrix`; `null` is a unit null vector, if one is
/// known.
pub(super) fn smallest_connected(
    matrix: &SymmetricMatrix,
    null: Option<&[f64]>,
    k: usize,
    params: &EigenParams,
    progress: Progress<'_>,
) -> Result<KnownSpectrum, LinalgError> {
    let n = matrix.n();
    let pattern = FactorPattern::new(matrix)?;
    let mut known = KnownSpectrum {
        values: Vec::new(),
        vectors: Panel::new(n),
        solves: 0,
        restarts: 0,
        factorizations: 0,
    };
    if let Some(null) = null {
        known.values.push(0.0);
        known.vectors.values.extend_from_slice(null);
    }
    let mean_diagonal = matrix.diagonal().iter().sum::<f64>() / n as f64;
    // Far below the first eigenvalue of a two-dimensional shape, far above rounding.
    let bottom = -0.1 * mean_diagonal / n as f64;
    let max_solves = params.max_solves_per_pair.saturating_mul(k).saturating_add(1000);
    let max_slices = 8 + 8 * k / params.band.max(1);
    let mut density = 0.0; // eigenvalues per unit of λ in the newest band
    for slice in 0..max_slices {
        let certifying = known.values.len() >= k;
        let (factor, missing) = if slice == 0 {
            let factor = Ldlt::with_pattern(&pattern, matrix, bottom)?;
            known.factorizations += 1;
            let negative = factor.n_below();
            if negative > 0 {
                return Err(LinalgError::Factorize {
                    shift: bottom,
                    what: format!("the matrix has {negative} negative eigenvalues, expected none"),
                });
            }
            (factor, 0)
        } else {
            let target =
                if certifying { gap_above(&known.values, k) } else { next_shift(&known, k, density, params) };
            factor_at(matrix, &pattern, &mut known, target, params)?
        };
        if certifying && missing == 0 {
            known.values.truncate(k);
            known.vectors.truncate(k);
            return Ok(known);
        }
        let top = known.values.last().copied().unwrap_or(0.0);
        let still = k.saturating_sub(known.values.len() + missing);
        let wanted = EigenRequest {
            below: missing,
            above: if certifying {
                0
            } else {
                (still + 2).min(params.band).min(n - known.values.len() - missing)
            },
            tolerance: params.tolerance,
            max_solves: max_solves.saturating_sub(known.solves),
        };
        let found = nearest_eigenpairs(&factor, &known.vectors, wanted, progress)?;
        known.solves += found.solves;
        known.restarts += found.restarts;
        known.insert(&found.values, &found.vectors);
        let new_top = known.values.last().copied().unwrap_or(0.0);
        if new_top > top {
            density = found.values.len() as f64 / (new_top - top);
        }
        if known.values.len() == n {
            known.values.truncate(k);
            known.vectors.truncate(k);
            return Ok(known);
        }
    }
    Err(LinalgError::NotConverged { found: known.values.len(), wanted: k, solves: known.solves })
}

/// Finds a shift above the `k`-th eigenvalue, in the widest known gap.
fn gap_above(values: &[f64], k: usize) -> f64 {
    let last = values[values.len() - 1];
    let widest = (k..values.len())
        .max_by(|&a, &b| (values[a] - values[a - 1]).total_cmp(&(values[b] - values[b - 1])).then(b.cmp(&a)));
    match widest {
        Some(i) if values[i] > values[i - 1] * (1.0 + 1e-9) => 0.5 * (values[i - 1] + values[i]),
        _ => last + 1e-6 * last.abs().max(f64::MIN_POSITIVE),
    }
}

/// Finds a shift that leaves about half a band of eigenvalues between itself and the known ones.
fn next_shift(known: &KnownSpectrum, k: usize, density: f64, params: &EigenParams) -> f64 {
    let top = known.values.last().copied().unwrap_or(0.0);
    let half = 0.5 * (k - known.values.len()).min(params.band) as f64;
    if density > 0.0 { top + (half + 1.0) / density } else { 2.0 * top.max(f64::MIN_POSITIVE) }
}

/// Factorizes at about `target` and returns the number of unknown eigenvalues below the shift. The shift is moved if it
/// hits an eigenvalue, and lowered if the band below would be too large.
fn factor_at(
    matrix: &SymmetricMatrix,
    pattern: &FactorPattern,
    known: &mut KnownSpectrum,
    target: f64,
    params: &EigenParams,
) -> Result<(Ldlt, usize), LinalgError> {
    let top = known.values.last().copied().unwrap_or(0.0);
    let mut shift = target;
    let mut last_error = None;
    for attempt in 1..=MAX_TRIES {
        let nudge = 1.0 + 1e-5 * attempt as f64;
        known.factorizations += 1;
        let factor = match Ldlt::with_pattern(pattern, matrix, shift) {
            Ok(factor) => factor,
            Err(error) => {
                last_error = Some(error);
                shift *= nudge;
                continue;
            }
        };
        let (count, below) = (factor.n_below(), known.count_below(shift));
        if count < below || !solves_well(matrix, &factor) {
            shift *= nudge;
            continue;
        }
        if count - below > 2 * params.band && shift > top {
            shift = top + 0.5 * (shift - top);
            continue;
        }
        return Ok((factor, count - below));
    }
    Err(last_error.unwrap_or(LinalgError::Factorize {
        shift,
        what: format!("no nearby shift gave a stable factor in {MAX_TRIES} tries"),
    }))
}

/// True if a solve with an indefinite factor, which has no pivoting, is accurate.
fn solves_well(matrix: &SymmetricMatrix, factor: &Ldlt) -> bool {
    let n = matrix.n();
    // Any vector with a component in every direction is suitable.
    let b: Vec<f64> = (0..n).map(|i| 1.0 + ((i as f64) * 0.754_877_666).fract()).collect();
    let mut x = b.clone();
    factor.solve_columns(&mut x);
    let ax = matrix.product(&x);
    let (mut error, mut size) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        let r = ax[i] - factor.shift() * x[i] - b[i];
        error += r * r;
        size += ax[i] * ax[i] + b[i] * b[i];
    }
    error.is_finite() && error.sqrt() <= GOOD_SOLVE * size.sqrt()
}
