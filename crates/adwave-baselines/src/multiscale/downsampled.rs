//! Selection of as many functions as their rank, with their duals.

use super::dense::{Dense, dual, rank_revealing};
use super::{MAX_VERTICES, MultiscaleError, check_length};

/// Selection of as many functions as their rank.
#[derive(Clone, Debug, PartialEq)]
pub struct Downsampled {
    /// Indices of the selected functions.
    pub kept: Vec<usize>,
    /// Largest `|⟨φ_i, φ̃_k⟩ − δ_ik|` of the selected functions, scaled to unit length, and their duals.
    pub defect: f64,
    /// Largest length of a dual, which is the factor by which an error of a coefficient can grow.
    pub longest_dual: f64,
}

/// Selects as many of `functions` as their rank and computes their duals. A function is dropped if it is shorter than
/// `precision` times the longest, or if, scaled to unit length, less than `precision` of it is independent of the
/// functions selected before. O(n³). Source: the footnote to Table 1 of `houqin2013`.
///
/// # Errors
/// [`MultiscaleError`] if functions differ in length, are too many, or are not finite.
///
/// ```
/// use adwave_baselines::multiscale::downsample;
/// let functions = [vec![1.0, 0.0], vec![1.0, 1.0], vec![2.0, 2.0]];
/// let found = downsample(&functions, 1e-6)?;
/// assert_eq!(found.kept.len(), 2);
/// assert!(found.defect < 1e-12);
/// # Ok::<(), adwave_baselines::multiscale::MultiscaleError>(())
/// ```
pub fn downsample(functions: &[Vec<f64>], precision: f64) -> Result<Downsampled, MultiscaleError> {
    let n = functions.first().map_or(0, Vec::len);
    if n.max(functions.len()) > MAX_VERTICES {
        return Err(MultiscaleError::TooLarge { n: n.max(functions.len()) });
    }
    functions.iter().try_for_each(|f| check_length(n, f.len()))?;
    let length = |f: &[f64]| f.iter().map(|v| v * v).sum::<f64>().sqrt();
    let longest = functions.iter().map(|f| length(f)).fold(0.0, f64::max);
    let some: Vec<usize> =
        (0..functions.len()).filter(|&k| length(&functions[k]) > precision * longest).collect();
    if some.is_empty() {
        return Ok(Downsampled { kept: Vec::new(), defect: 0.0, longest_dual: 0.0 });
    }
    let unit = |k: usize| functions[k].iter().map(move |v| v / length(&functions[k]));
    let matrix = |of: &[usize]| Dense {
        rows: n,
        columns: of.len(),
        values: of.iter().flat_map(|&k| unit(k)).collect(),
    };
    let parts = rank_revealing(&matrix(&some), precision)?;
    let kept: Vec<usize> = parts.chosen.iter().map(|&k| some[k]).collect();
    let duals = dual(&parts.q, &parts.r);
    let longest_dual = duals.values.chunks_exact(n).map(length).fold(0.0, f64::max);
    Ok(Downsampled { defect: duals.defect(&matrix(&kept)), longest_dual, kept })
}
