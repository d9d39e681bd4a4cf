//! Locality and mean of a function on vertices.

/// Measures of a function on vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locality {
    /// Number of vertices at which |f| is above 1e-6 of its largest value.
    pub support: usize,
    /// Smallest number of vertices that hold 99 % of `Σ|f|`.
    pub core: usize,
    /// Relative mean `|Σ f| / Σ |f|`: 0 for an admissible wavelet, 1 for a function of one sign.
    pub mean: f64,
}

/// Measures the locality and the mean of `f`.
///
/// ```
/// let spike = adwave_baselines::multiscale::locality(&[0.0, 2.0, -1.0, 1e-3]);
/// assert_eq!((spike.support, spike.core), (3, 2));
/// assert_eq!(adwave_baselines::multiscale::locality(&[0.0, 2.0, -1.0]).mean, 1.0 / 3.0);
/// ```
pub fn locality(f: &[f64]) -> Locality {
    const PART: f64 = 0.99;
    const NOTHING: f64 = 1e-6;
    let mut sizes: Vec<f64> = f.iter().map(|v| v.abs()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let total: f64 = sizes.iter().sum();
    if total == 0.0 {
        return Locality { support: 0, core: 0, mean: 0.0 };
    }
    let support = sizes.partition_point(|&v| v > NOTHING * sizes[0]);
    let (mut core, mut sum) = (0, 0.0);
    while sum < PART * total && core < sizes.len() {
        sum += sizes[core];
        core += 1;
    }
    Locality { support, core, mean: (f.iter().sum::<f64>() / total).abs() }
}
