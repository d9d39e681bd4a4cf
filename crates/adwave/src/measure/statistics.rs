//! Similarity of two maps on the same vertices.

/// Root mean square difference of two signals, `√(Σ_x |a(x) − b(x)|² / n)` over n vertices of `n_channels` values
/// each, in the unit of the signals; 0 without vertices. O(values).
///
/// ```
/// assert_eq!(adwave::measure::rms(&[3.0, 4.0, 0.0, 0.0], &[0.0; 4], 2), 12.5_f64.sqrt());
/// ```
pub fn rms(a: &[f64], b: &[f64], n_channels: usize) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
    (squares / (a.len() / n_channels.max(1)).max(1) as f64).sqrt()
}

/// Pearson's correlation of two maps, in [−1, 1]; 0 if either is constant. O(n).
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
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

/// Spearman's ρ: the [`correlation`] of the ranks of two maps; equal values share their mean rank. O(n log n).
///
/// ```
/// use adwave::measure::rank_correlation;
/// assert_eq!(rank_correlation(&[1.0, 2.0, 9.0], &[2.0, 3.0, 4.0]), 1.0);
/// assert_eq!(rank_correlation(&[1.0, 1.0], &[3.0, 2.0]), 0.0);
/// ```
pub fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
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

/// Overlap, in [0, 1], of the vertices with the largest `part` of the values of two maps. At least one value of
/// each is used; ties go to the first vertex. O(n log n).
///
/// ```
/// assert_eq!(adwave::measure::shared_top(&[1.0, 2.0, 3.0, 4.0], &[4.0, 1.0, 2.0, 3.0], 0.5), 0.5);
/// ```
pub fn shared_top(a: &[f64], b: &[f64], part: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_are_those_known_by_hand() {
        let a = [1.0, 2.0, 3.0, 4.0];
        assert!((correlation(&a, &[2.0, 4.0, 6.0, 8.0]) - 1.0).abs() < 1e-15);
        assert!((rank_correlation(&a, &[9.0, 4.0, 1.0, 0.0]) + 1.0).abs() < 1e-15);
        assert_eq!(rank_correlation(&[1.0, 2.0, 9.0], &[3.0, 2.0, 1.0]), -1.0);
        assert_eq!(correlation(&a, &[5.0; 4]), 0.0);
        assert_eq!(shared_top(&a, &[0.0, 3.0, 1.0, 2.0], 0.5), 0.5);
        assert_eq!(shared_top(&[], &[], 0.5), 0.0);
        assert_eq!(rms(&[3.0, 4.0, 0.0, 0.0], &[0.0; 4], 2), (25.0_f64 / 2.0).sqrt());
    }
}
