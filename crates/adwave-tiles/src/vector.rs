//! Vectors in three dimensions.

/// Euclidean length.
pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}
