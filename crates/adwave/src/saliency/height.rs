//! Combination of a saliency map with height.

/// Weight of height relative to saliency, both as ranks in [0, 1].
const HEIGHT_WEIGHT: f64 = 0.5;

/// Predicts fixations in [0, 1] from the rank of a saliency map and, with half its weight, the rank of the height.
/// O(n log n).
///
/// The value is `(r(Λ) + ½·r(h))/1.5`, where r is the share of the other vertices with a smaller value, equal ones
/// counting half. NaN if either is NaN.
///
/// People look at heads and tops. The weight ½ is not fitted; docs/EVALUATION.md has results for other weights.
///
/// ```
/// use adwave::saliency::with_height;
/// assert_eq!(with_height(&[3.0, -1.0, 0.5], &[0.0, 0.0, 7.0]), [2.25 / 3.0, 0.25 / 3.0, 2.0 / 3.0]);
/// ```
///
/// # Panics
/// Unless there is one height per value of the map.
pub fn with_height(map: &[f64], heights: &[f64]) -> Vec<f64> {
    assert_eq!(map.len(), heights.len(), "a height at each vertex");
    let known = |x: usize| !map[x].is_nan() && !heights[x].is_nan();
    let (map, heights) = (shares(map, known), shares(heights, known));
    let mean = |(m, h): (&f64, &f64)| (m + HEIGHT_WEIGHT * h) / (1.0 + HEIGHT_WEIGHT);
    map.iter().zip(&heights).map(mean).collect()
}

/// Share of the other known values that are smaller, equal ones counting half; NaN for unknown values.
fn shares(values: &[f64], known: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).filter(|&x| known(x)).collect();
    // −0 equals 0.
    order.sort_by(|&a, &b| (values[a] + 0.0).total_cmp(&(values[b] + 0.0)));
    let others = order.len().saturating_sub(1).max(1) as f64;
    let mut shares = vec![f64::NAN; values.len()];
    let mut smaller = 0;
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        for &x in equal {
            shares[x] = (smaller as f64 + 0.5 * (equal.len() - 1) as f64) / others;
        }
        smaller += equal.len();
    }
    shares
}
