//! Matching of the features of two shapes.

use super::Descriptor;
use crate::parallel;

/// A pair of features with similar descriptors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Index into the first list of features.
    pub first: usize,
    /// Index into the second list of features.
    pub second: usize,
    /// Euclidean distance of their descriptors, in [0, 2].
    pub distance: f64,
}

/// Matches pairs of features that are mutually nearest and nearer than `ratio` times the second nearest, in
/// ascending order of the first index. A `ratio` of 1 requires no margin; 0.8 is usual. O(first × second).
///
/// Source: `lowe2004` (the ratio test).
///
/// ```
/// use adwave::features::{DESCRIPTOR_LENGTH, match_features};
/// let unit = |k: usize| { let mut d = [0.0; DESCRIPTOR_LENGTH]; d[k] = 1.0; d };
/// let matches = match_features(&[unit(0), unit(1)], &[unit(2), unit(1)], 0.8);
/// assert_eq!(matches.len(), 1);
/// assert_eq!((matches[0].first, matches[0].second), (1, 1));
/// ```
pub fn match_features(first: &[Descriptor], second: &[Descriptor], ratio: f64) -> Vec<Match> {
    let forward = nearest(first, second);
    let backward = nearest(second, first);
    let pair = |(i, best): (usize, &Option<NearestDescriptors>)| {
        let best = best.as_ref()?;
        let mutual = backward[best.index].as_ref().is_some_and(|back| back.index == i);
        let clear = best.distance < ratio * best.second;
        (mutual && clear).then_some(Match { first: i, second: best.index, distance: best.distance })
    };
    forward.iter().enumerate().filter_map(pair).collect()
}

struct NearestDescriptors {
    index: usize,
    distance: f64,
    /// Distance of the second nearest; infinite if there is none.
    second: f64,
}

fn nearest(from: &[Descriptor], to: &[Descriptor]) -> Vec<Option<NearestDescriptors>> {
    let distance =
        |a: &Descriptor, b: &Descriptor| a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
    parallel::map_items(from.len().max(to.len()), from.len(), |k| {
        let a = &from[k];
        to.iter().enumerate().fold(None, |best: Option<NearestDescriptors>, (index, b)| {
            let d = distance(a, b);
            Some(match best {
                None => NearestDescriptors { index, distance: d, second: f64::INFINITY },
                Some(old) if d < old.distance => {
                    NearestDescriptors { index, distance: d, second: old.distance }
                }
                Some(old) => NearestDescriptors { second: old.second.min(d), ..old },
            })
        })
    })
}
