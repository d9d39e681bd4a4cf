//! As many of given functions as their rank, and their duals.

use super::dense::{Dense, dual, rank_revealing};
use super::{MAX_VERTICES, MultiscaleError, check_length};

/// What is left of functions when as many are kept as their rank.
#[derive(Clone, Debug, PartialEq)]
pub struct Downsampled {
    /// Which are kept.
    pub kept: Vec<usize>,
    /// Largest `|⟨φ_i, φ̃_k⟩ − δ_ik|` of those, at unit length, and their duals.
    pub defect: f64,
    /// The largest length of a dual: by how much an error of a coefficient can grow.
    pub longest_dual: f64,
}

/// Keeps as many of `functions` as their rank and makes the duals of these. What has a length below `precision` of the longest
/// counts as nothing, and so does what is left below `precision` of a function of unit length by those kept before it.
/// O(n³). Source: the footnote to Table 1 of `houqin2013`.
///
/// # Errors
/// [`MultiscaleError`] for functions of different lengths, too many of them, or such that are not finite.
///
/// ```
/// use adwave_baselines::multiscale::downsampled;
/// let functions = [vec![1.0, 0.0], vec![1.0, 1.0], vec![2.0, 2.0]];
/// let found = downsampled(&functions, 1e-6)?;
/// assert_eq!(found.kept.len(), 2);
/// assert!(found.defect < 1e-12);
/// # Ok::<(), adwave_baselines::multiscale::MultiscaleError>(())
/// ```
pub fn downsampled(functions: &[Vec<f64>], precision: f64) -> Result<Downsampled, MultiscaleError> {
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
