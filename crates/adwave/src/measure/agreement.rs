//! Agreement of a map with human fixations.

use crate::shape::distance;
use crate::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Measures of how well a map predicts fixations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Number of vertices with both a map value and a fixation time.
    pub n_vertices: usize,
    /// Number of those vertices that were looked at.
    pub n_positive: usize,
    /// Area under the ROC curve: the probability that a fixated vertex has a larger value than one that is not,
    /// with ties counting half. ½ is chance; NaN if all or none were fixated.
    pub auc: f64,
    /// Normalized scanpath saliency: mean of `(map − mean)/deviation` over the fixated vertices. 0 is chance; NaN
    /// for a constant map.
    pub nss: f64,
    /// Pearson's correlation of the map and the fixations, in [−1, 1]; NaN if one of them is constant.
    pub correlation: f64,
    /// Partial correlation of the map and the fixations given the control; NaN without a control.
    pub partial_correlation: f64,
}

/// Error of comparing maps.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum AgreementError {
    /// The map and the fixations have different lengths.
    #[error("the map and the fixations must have the same length, got {n_map} and {n_fixations}")]
    WrongLength {
        /// Number of map values.
        n_map: usize,
        /// Number of fixation times.
        n_fixations: usize,
    },
    /// No vertex has both values.
    #[error("no vertex has both a finite map value and a finite fixation time")]
    NothingShared,
}

impl ClassifiedError for AgreementError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Compares a map with fixation times (for example in seconds): a vertex is fixated if its time is above
/// `threshold`. Vertices where either value is not finite are skipped. `control` is another map, such as
/// [`center_distance`], whose share is removed in [`partial_correlation`](Agreement::partial_correlation). O(n log
/// n).
///
/// # Errors
/// [`AgreementError`] if the lengths differ or no vertex is left.
///
/// ```
/// use adwave::measure::agreement;
/// let fixations = [0.0, 0.0, 1.0, 3.0];
/// let a = agreement(&[0.1, 0.3, 0.2, 0.9], &fixations, 0.0, None)?;
/// assert_eq!(a.auc, 0.75); // of four pairs only (0.3, 0.2) is the wrong way round
/// assert_eq!(agreement(&fixations, &fixations, 0.0, None)?.auc, 1.0);
/// # Ok::<(), adwave::measure::AgreementError>(())
/// ```
pub fn agreement(
    map: &[f64],
    fixations: &[f64],
    threshold: f64,
    control: Option<&[f64]>,
) -> Result<Agreement, AgreementError> {
    for n_fixations in [Some(fixations.len()), control.map(<[f64]>::len)].into_iter().flatten() {
        if n_fixations != map.len() {
            return Err(AgreementError::WrongLength { n_map: map.len(), n_fixations });
        }
    }
    let known = |&x: &usize| {
        map[x].is_finite() && fixations[x].is_finite() && control.is_none_or(|c| c[x].is_finite())
    };
    let shared: Vec<usize> = (0..map.len()).filter(known).collect();
    if shared.is_empty() {
        return Err(AgreementError::NothingShared);
    }
    let pick = |values: &[f64]| shared.iter().map(|&x| values[x]).collect::<Vec<f64>>();
    let (map, fixations) = (pick(map), pick(fixations));
    let positive: Vec<bool> = fixations.iter().map(|&seconds| seconds > threshold).collect();
    let correlation = pearson(&map, &fixations);
    let partial_correlation = control.map_or(f64::NAN, |control| {
        let control = pick(control);
        let (rm, rl) = (pearson(&map, &control), pearson(&fixations, &control));
        (correlation - rm * rl) / ((1.0 - rm * rm) * (1.0 - rl * rl)).sqrt()
    });
    Ok(Agreement {
        n_vertices: map.len(),
        n_positive: positive.iter().filter(|&&p| p).count(),
        auc: auc(&map, &positive),
        nss: nss(&map, &positive),
        correlation,
        partial_correlation,
    })
}

/// Distance of every point from the mean of all points, in model units. People look at what sticks out, so this map
/// is a control that others should beat. O(n).
pub fn center_distance(points: &[[f64; 3]]) -> Vec<f64> {
    let n = points.len() as f64;
    let center: [f64; 3] = std::array::from_fn(|c| points.iter().map(|p| p[c] / n).sum());
    points.iter().map(|p| distance(p, &center)).collect()
}

/// Mann–Whitney statistic (`mann1947`) by ranks; equal values share their mean rank.
fn auc(map: &[f64], positive: &[bool]) -> f64 {
    let mut order: Vec<usize> = (0..map.len()).collect();
    order.sort_unstable_by(|&a, &b| map[a].total_cmp(&map[b]));
    let n_positive = positive.iter().filter(|&&p| p).count() as f64;
    let n_negative = map.len() as f64 - n_positive;
    let (mut ranks, mut below) = (0.0, 0.0);
    for equal in order.chunk_by(|&a, &b| map[a] == map[b]) {
        let rank = below + 0.5 * (equal.len() as f64 + 1.0);
        ranks += rank * equal.iter().filter(|&&x| positive[x]).count() as f64;
        below += equal.len() as f64;
    }
    (ranks - 0.5 * n_positive * (n_positive + 1.0)) / (n_positive * n_negative)
}

fn nss(map: &[f64], positive: &[bool]) -> f64 {
    let n = map.len() as f64;
    let mean = map.iter().sum::<f64>() / n;
    let deviation = (map.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt();
    let looked_at = map.iter().zip(positive).filter(|(_, p)| **p);
    let (sum, count) = looked_at.fold((0.0, 0.0), |(sum, count), (v, _)| (sum + (v - mean), count + 1.0));
    sum / count / deviation
}

fn pearson(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let (ma, mb) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let sums = a.iter().zip(b).fold([0.0; 3], |[ab, aa, bb], (x, y)| {
        let (x, y) = (x - ma, y - mb);
        [ab + x * y, aa + x * x, bb + y * y]
    });
    (sums[0] / (sums[1] * sums[2]).sqrt()).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Sums of a few hundred terms.
    const ROUNDING: f64 = 1e-10;

    proptest! {
        #[test]
        fn auc_is_the_share_of_pairs_that_are_the_right_way_round(
            values in prop::collection::vec((0_u8..8, any::<bool>()), 2..60),
        ) {
            let map: Vec<f64> = values.iter().map(|v| f64::from(v.0)).collect();
            let fixations: Vec<f64> = values.iter().map(|v| f64::from(u8::from(v.1))).collect();
            let (mut right, mut pairs) = (0.0, 0.0);
            for (a, _) in map.iter().zip(&fixations).filter(|(_, l)| **l > 0.5) {
                for (b, _) in map.iter().zip(&fixations).filter(|(_, l)| **l < 0.5) {
                    pairs += 1.0;
                    right += if a > b { 1.0 } else if a == b { 0.5 } else { 0.0 };
                }
            }
            let found = agreement(&map, &fixations, 0.0, None).unwrap().auc;
            let agrees = if pairs == 0.0 { found.is_nan() } else { (found - right / pairs).abs() < ROUNDING };
            prop_assert!(agrees, "{}", found);
        }

        #[test]
        fn scaling_a_map_changes_nothing_and_turning_it_over_turns_it_round(
            values in prop::collection::vec((-100.0..100.0, 0.0..10.0), 3..60), factor in 0.1..50.0, shift in -9.0..9.0,
        ) {
            let (map, fixations): (Vec<f64>, Vec<f64>) = values.into_iter().unzip();
            let same = agreement(&map, &fixations, 5.0, None).unwrap();
            let scaled: Vec<f64> = map.iter().map(|v| factor * v + shift).collect();
            let turned: Vec<f64> = map.iter().map(|v| -v).collect();
            let scaled = agreement(&scaled, &fixations, 5.0, None).unwrap();
            let turned = agreement(&turned, &fixations, 5.0, None).unwrap();
            prop_assert!((same.correlation - scaled.correlation).abs() < 1e-6);
            prop_assert!((same.correlation + turned.correlation).abs() < ROUNDING);
            if same.n_positive > 0 && same.n_positive < fixations.len() {
                prop_assert!((same.auc + turned.auc - 1.0).abs() < ROUNDING);
                prop_assert!((same.nss + turned.nss).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn what_is_only_the_control_has_no_partial_correlation() {
        // Fixations are the control plus something that the map does not know.
        let control: Vec<f64> = (0..400).map(|i| f64::from(i % 20)).collect();
        let own: Vec<f64> = (0..400).map(|i| f64::from(i / 20 % 4)).collect();
        let fixations: Vec<f64> = control.iter().zip(&own).map(|(c, o)| c + o).collect();
        let other: Vec<f64> = (0..400).map(|i| f64::from(i / 80)).collect();
        let map: Vec<f64> = control.iter().zip(&other).map(|(c, o)| 2.0 * c + o).collect();
        let a = agreement(&map, &fixations, 10.0, Some(&control)).unwrap();
        assert!(a.correlation > 0.8 && a.partial_correlation.abs() < ROUNDING, "{a:?}");
        let b = agreement(&own, &fixations, 10.0, Some(&control)).unwrap();
        assert!((b.partial_correlation - 1.0).abs() < ROUNDING, "{b:?}");
    }

    #[test]
    fn missing_values_are_left_out_and_lengths_are_named() {
        let a = agreement(&[1.0, f64::NAN, 2.0, 5.0], &[0.0, 9.0, 1.0, f64::NAN], 0.0, None).unwrap();
        assert_eq!((a.n_vertices, a.n_positive, a.auc), (2, 1, 1.0));
        let error = agreement(&[1.0], &[1.0, 2.0], 0.0, None).unwrap_err().to_string();
        assert!(error.contains('1') && error.contains('2'));
        assert_eq!(agreement(&[f64::NAN], &[1.0], 0.0, None), Err(AgreementError::NothingShared));
    }
}
