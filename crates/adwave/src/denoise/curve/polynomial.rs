//! Values of least-squares polynomials.

/// Part of the norm of a power that is left beside lower powers, below which the nodes do not determine it.
const DEPENDENT: f64 = 1e-9;

/// Weights c of the value at 0 of the polynomial of `degree` that fits values f at `nodes` best: `Σ_j c_j·f_j`. Their
/// squares sum to the variance of that value for noise of variance 1. `None` if the nodes do not determine the
/// polynomial. O(nodes × degree).
///
/// The polynomials q_k are orthonormal over the nodes (three-term recurrence), and `c_j = Σ_k q_k(0)·q_k(u_j)`.
pub(super) fn fit_weights(nodes: &[f64], degree: usize) -> Option<Vec<f64>> {
    let scale = nodes.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    if nodes.len() <= degree || !scale.is_finite() {
        return None;
    }
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let norm = (nodes.len() as f64).sqrt();
    let mut q: Vec<f64> = vec![1.0 / norm; nodes.len()];
    let mut before: Vec<f64> = vec![0.0; nodes.len()];
    let (mut at_zero, mut before_at_zero) = (1.0 / norm, 0.0);
    let mut weights: Vec<f64> = q.iter().map(|q| q * at_zero).collect();
    let mut last_norm = 0.0;
    for _ in 0..degree {
        let mean: f64 = q.iter().zip(nodes).map(|(q, u)| q * q * u / scale).sum();
        let step = |u: f64, q: f64, before: f64| (u - mean) * q - last_norm * before;
        let next: Vec<f64> =
            nodes.iter().zip(&q).zip(&before).map(|((u, q), b)| step(u / scale, *q, *b)).collect();
        let next_at_zero = step(0.0, at_zero, before_at_zero);
        let norm = next.iter().map(|v| v * v).sum::<f64>().sqrt();
        if norm.is_nan() || norm < DEPENDENT {
            return None;
        }
        (before, before_at_zero) = (q, at_zero);
        q = next.iter().map(|v| v / norm).collect();
        at_zero = next_at_zero / norm;
        last_norm = norm;
        weights.iter_mut().zip(&q).for_each(|(w, q)| *w += q * at_zero);
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_the_degree_are_reproduced() {
        let nodes = [-2.0, -0.7, 0.1, 0.9, 1.5, 3.0, 3.2];
        for degree in 0..=4 {
            let weights = fit_weights(&nodes, degree).unwrap();
            for power in 0..=degree as i32 {
                let value: f64 =
                    weights.iter().zip(&nodes).map(|(w, u): (&f64, &f64)| w * u.powi(power)).sum();
                let expected = if power == 0 { 1.0 } else { 0.0 };
                assert!((value - expected).abs() < 1e-12, "degree {degree}, power {power}: {value}");
            }
        }
    }

    #[test]
    fn nodes_that_coincide_determine_no_slope() {
        assert_eq!(fit_weights(&[1.0, 1.0, 1.0], 1), None);
        assert_eq!(fit_weights(&[0.0, 1.0], 2), None);
        assert!(fit_weights(&[0.0], 0).is_some());
    }
}
