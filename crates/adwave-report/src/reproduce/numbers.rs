//! Statistics that several figures need, and the bands of a model.

use super::{Context, FigureError, Model};
use adwave::bands::{Bands, Schedule};
use adwave::signal::{SurfaceSignal, surface_signal};
use adwave::{Decomposer, Progress};

/// The walk of a model as the paper has it.
pub(super) fn walk(model: &Model) -> Decomposer {
    Decomposer::new(&model.shape)
}

/// The bands of a signal on dyadic levels.
pub(super) fn bands(
    context: &Context<'_>,
    walk: &Decomposer,
    signal: &[f64],
    n_channels: usize,
    n_levels: usize,
) -> Result<Bands, FigureError> {
    let schedule = Schedule::dyadic(n_levels)?;
    Ok(walk.request(signal, n_channels, &schedule).progress(context.progress).bands()?)
}

/// The mean curvature of a mesh or cloud, in 1/model unit.
pub(super) fn mean_curvature(walk: &Decomposer) -> Result<Vec<f64>, FigureError> {
    Ok(surface_signal(walk.geometry(), SurfaceSignal::MeanCurvature, Progress::none())?)
}

/// Pearson's correlation; 0 where either is constant.
pub(super) fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().max(1) as f64;
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        ab += (x - mean_a) * (y - mean_b);
        aa += (x - mean_a).powi(2);
        bb += (y - mean_b).powi(2);
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// Spearman's correlation of ranks, ties sharing their mean rank.
pub(super) fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    correlation(&ranks(a), &ranks(b))
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&x, &y| values[x].total_cmp(&values[y]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|&x, &y| values[x] == values[y]) {
        for &x in equal {
            ranks[x] = first as f64 + 0.5 * (equal.len() - 1) as f64;
        }
        first += equal.len();
    }
    ranks
}

/// Which part of the largest `part` of both is the same.
pub(super) fn shared_top(a: &[f64], b: &[f64], part: f64) -> f64 {
    let count = ((a.len() as f64 * part).ceil() as usize).clamp(1, a.len().max(1));
    let top = |values: &[f64]| {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&x, &y| values[y].total_cmp(&values[x]));
        let mut is_top = vec![false; values.len()];
        order.iter().take(count).for_each(|&x| is_top[x] = true);
        is_top
    };
    let both = top(a).iter().zip(top(b)).filter(|&(&x, y)| x && y).count();
    both as f64 / count as f64
}

/// `√(Σ|a − b|²/n)` over vertices of `n_channels` values.
pub(super) fn rms(a: &[f64], b: &[f64], n_channels: usize) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
    (squares / (a.len() / n_channels).max(1) as f64).sqrt()
}

/// The Euclidean norm of each vertex's channels.
pub(super) fn norms(values: &[f64], n_channels: usize) -> Vec<f64> {
    values.chunks_exact(n_channels).map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt()).collect()
}

/// Largest and smallest of the finite values.
pub(super) fn extent(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// A signal of three channels as positions.
pub(super) fn positions(values: &[f64]) -> Vec<[f64; 3]> {
    values.as_chunks().0.to_vec()
}

/// Distance of two points.
pub(super) fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
}

/// `12 %`.
pub(super) fn percent(share: f64) -> String {
    if share.is_nan() { "–".to_owned() } else { format!("{:.0} %", 100.0 * share) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_are_those_known_by_hand() {
        let a = [1.0, 2.0, 3.0, 4.0];
        assert!((correlation(&a, &[2.0, 4.0, 6.0, 8.0]) - 1.0).abs() < 1e-15);
        assert!((rank_correlation(&a, &[9.0, 4.0, 1.0, 0.0]) + 1.0).abs() < 1e-15);
        assert_eq!(correlation(&a, &[5.0; 4]), 0.0);
        assert_eq!(shared_top(&a, &[0.0, 3.0, 1.0, 2.0], 0.5), 0.5);
        assert_eq!(rms(&[3.0, 4.0, 0.0, 0.0], &[0.0; 4], 2), (25.0_f64 / 2.0).sqrt());
    }
}
