//! Loss of detail when the fine bands of a shape are dropped.

use adwave::bands::Bands;

/// Loss when the bands up to a level are dropped: ‖f − S_f(j)‖ over the vertices, in units of the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetailLoss {
    /// Level j, from 1: the bands 1 … j are dropped.
    pub level: usize,
    /// Width σ_j in model units.
    pub sigma: f64,
    /// Largest loss at a vertex.
    pub greatest: f64,
    /// Root mean square `√(Σ_x μ(x)‖f(x) − S_f(j, x)‖² / Σ_x μ(x))` with the weights μ.
    pub rms: f64,
}

/// Computes the loss for each level j = 1 … J of bands, fine to coarse: `f − S_f(j) = W_f(1) + … + W_f(j)` (eq. 15).
/// `weights` are the areas of the vertices; if all are 0, the vertices have equal weights. Vertices without a value
/// (NaN) are ignored. O(J·n).
///
/// ```
/// use adwave::bands::Schedule;
/// use adwave::shape::{Graph, Shape};
/// use adwave::Decomposer;
/// use adwave_report::detail_loss;
/// let pair = Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?);
/// let bands = Decomposer::new(&pair).decompose(&[1.0, 3.0], 1, &Schedule::dyadic(2)?)?;
/// let loss = detail_loss(&bands, &[1.0, 1.0]); // both become 2 in the first step
/// assert_eq!((loss[0].greatest, loss[0].rms), (1.0, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If the number of weights differs from the number of vertices.
pub fn detail_loss(bands: &Bands, weights: &[f64]) -> Vec<DetailLoss> {
    assert_eq!(weights.len(), bands.n_vertices, "one weight per vertex");
    let all_alike = weights.iter().sum::<f64>() <= 0.0;
    let weight = |x: usize| if all_alike { 1.0 } else { weights[x] };
    let mut lost = vec![0.0; bands.n_vertices * bands.n_channels];
    (1..=bands.n_levels())
        .map(|level| {
            lost.iter_mut().zip(bands.wavelet(level)).for_each(|(sum, w)| *sum += w);
            let (mut greatest, mut squares, mut total) = (0.0_f64, 0.0, 0.0);
            for (x, row) in lost.chunks_exact(bands.n_channels).enumerate() {
                let length = norm(row);
                if length.is_finite() {
                    greatest = greatest.max(length);
                    squares += weight(x) * length * length;
                    total += weight(x);
                }
            }
            let rms = if total > 0.0 { f64::sqrt(squares / total) } else { 0.0 };
            DetailLoss { level, sigma: bands.sigma[level], greatest, rms }
        })
        .collect()
}

/// Finds the widest level such that its loss and the losses of all finer levels are at most `error` by `measure`;
/// `None` if the finest level loses more.
pub fn widest_within(
    losses: &[DetailLoss],
    error: f64,
    measure: impl Fn(&DetailLoss) -> f64,
) -> Option<&DetailLoss> {
    losses.iter().take_while(|loss| measure(loss) <= error).last()
}

/// Euclidean norm, scaled so that squares neither underflow nor overflow.
fn norm(row: &[f64]) -> f64 {
    let largest = row.iter().fold(0.0_f64, |m, v| if v.is_nan() { f64::NAN } else { m.max(v.abs()) });
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * row.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::Decomposer;
    use adwave::bands::Schedule;
    use adwave::sample::Sample;

    #[test]
    fn the_loss_is_the_distance_to_the_scaling_coefficients() {
        let sample = Sample::from_name("creature", Some(2000)).unwrap();
        let shape = adwave::shape::Shape::Mesh(
            adwave::shape::Mesh::new(sample.points.clone(), sample.faces).unwrap(),
        );
        let decomposer = Decomposer::new(&shape);
        let values = sample.points.as_flattened();
        let bands = decomposer.decompose(values, 3, &Schedule::dyadic(5).unwrap()).unwrap();
        let areas = decomposer.areas();
        let losses = detail_loss(&bands, &areas);
        for loss in &losses {
            let smooth = bands.scaling(loss.level);
            let squares: Vec<f64> = values
                .chunks_exact(3)
                .zip(smooth.chunks_exact(3))
                .map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum())
                .collect();
            let greatest = squares.iter().copied().fold(0.0, f64::max).sqrt();
            let rms = squares.iter().zip(&areas).map(|(s, a)| s * a).sum::<f64>() / areas.iter().sum::<f64>();
            assert!((loss.greatest - greatest).abs() < 1e-12 * greatest, "{loss:?}");
            assert!((loss.rms - rms.sqrt()).abs() < 1e-12 * greatest, "{loss:?}");
        }
        let between = 0.5 * (losses[2].greatest + losses[3].greatest);
        assert_eq!(widest_within(&losses, between, |l| l.greatest).unwrap().level, 3);
        assert!(widest_within(&losses, 0.0, |l| l.greatest).is_none());
    }
}
