//! How local a function is, and whether it has a mean.

/// Measures of a function on vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locality {
    /// The fewest vertices that hold 99 % of `Σ|f|`.
    pub support: usize,
    /// `|Σ f| / Σ |f|`: 0 for an admissible wavelet, 1 for a function of one sign.
    pub mean: f64,
}

/// How local `f` is.
///
/// ```
/// let spike = adwave_baselines::multiscale::locality(&[0.0, 2.0, -1.0, 0.0]);
/// assert_eq!((spike.support, spike.mean), (2, 1.0 / 3.0));
/// ```
pub fn locality(f: &[f64]) -> Locality {
    const PART: f64 = 0.99;
    let mut sizes: Vec<f64> = f.iter().map(|v| v.abs()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let total: f64 = sizes.iter().sum();
    if total == 0.0 {
        return Locality { support: 0, mean: 0.0 };
    }
    let (mut support, mut sum) = (0, 0.0);
    while sum < PART * total && support < sizes.len() {
        sum += sizes[support];
        support += 1;
    }
    Locality { support, mean: (f.iter().sum::<f64>() / total).abs() }
}
