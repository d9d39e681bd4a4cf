//! Numbers in fields that stand for unknown values: HEALPix's UNSEEN, NetCDF's fill values, −9999.

/// Values that rasters, tables and integers of 16 and 32 bits have where nothing is known.
const SMALL: [f64; 6] = [-9999.0, -99_999.0, -999_999.0, -32_767.0, -32_768.0, -2_147_483_648.0];

/// Magnitudes that are no measurements: CMIP, HEALPix, NetCDF, GrADS, Surfer, and the largest 32-bit float.
const LARGE: [f64; 8] =
    [1e20, 1e30, 1.6375e30, 1e34, 1e35, 9.969_209_968_386_869e36, 1.701_41e38, 3.402_823_466_385_288_6e38];

/// Relative difference of a number from the one above that it was rounded from, by 32-bit floats or in text.
const ROUNDING: f64 = 1e-5;

/// Smallest number of known values that show which values are far outside of them.
const MIN_KNOWN: usize = 16;

/// Numbers that are looked at together.
const AT_A_TIME: usize = 1 << 12;

/// Number of a field that stands for an unknown one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownValue {
    /// Index of the number among all values of the field.
    pub index: usize,
    /// The number.
    pub value: f64,
}

/// True for a number in the range of those above.
fn is_extreme(x: f64) -> bool {
    x <= SMALL[0] || x > 1e19
}

fn may_be_unknown(x: f64) -> bool {
    let is_large = |large: &f64| (x.abs() - large).abs() <= ROUNDING * large;
    is_extreme(x) && (SMALL.contains(&x) || LARGE.iter().any(is_large))
}

/// Replaces the numbers that stand for unknown values by NaN, and returns them in their order. Such a number is one
/// that files write where nothing is known (−9999, −32768, 1e20, −1.6375e30, 9.96921e36 …), farther from all other
/// values of its channel than these are from each other. O(values).
///
/// ```
/// use adwave_io::mark_unknown;
/// let mut depths: Vec<f64> = (0..20).map(f64::from).collect();
/// depths[3] = -9999.0;
/// let found = mark_unknown(&mut depths, 1);
/// assert_eq!((found.len(), found[0].index, found[0].value), (1, 3, -9999.0));
/// assert!(depths[3].is_nan() && depths[4] == 4.0);
/// // Beside numbers of the same size it is one of them.
/// let mut heights: Vec<f64> = (-10..10).map(|k| 1000.0 * f64::from(k)).collect();
/// heights[0] = -9999.0;
/// assert!(mark_unknown(&mut heights, 1).is_empty());
/// ```
///
/// # Panics
/// If `n_channels` is 0.
pub fn mark_unknown(values: &mut [f64], n_channels: usize) -> Vec<UnknownValue> {
    let mut suspects = Vec::new();
    for (chunk, part) in values.chunks(AT_A_TIME).enumerate() {
        // A chunk at once: an early end would compare value by value. Nearly all numbers are told by this comparison.
        if part.iter().fold(false, |any, x| any | is_extreme(*x)) {
            let first = chunk * AT_A_TIME;
            suspects.extend((first..first + part.len()).filter(|&k| may_be_unknown(values[k])));
        }
    }
    let mut is_asked = vec![false; n_channels];
    for k in &suspects {
        is_asked[k % n_channels] = true;
    }
    let range = |c: usize| {
        let known =
            values.iter().skip(c).step_by(n_channels).filter(|x| x.is_finite() && !may_be_unknown(**x));
        let empty = (0, f64::INFINITY, f64::NEG_INFINITY);
        known.fold(empty, |(n, low, high), &x| (n + 1, low.min(x), high.max(x)))
    };
    let ranges: Vec<_> = is_asked.iter().enumerate().map(|(c, asked)| asked.then(|| range(c))).collect();
    let is_far = |k: &usize| {
        let Some((n_known, low, high)) = ranges[k % n_channels] else { return false };
        let gap = (low - values[*k]).max(values[*k] - high);
        n_known >= MIN_KNOWN && gap > high - low
    };
    let at: Vec<usize> = suspects.into_iter().filter(is_far).collect();
    at.into_iter()
        .map(|index| UnknownValue { index, value: std::mem::replace(&mut values[index], f64::NAN) })
        .collect()
}

/// Clause that says how many values of the field `name` were taken for unknown; `None` if none were.
pub fn describe_unknown(name: &str, unknown: &[UnknownValue]) -> Option<String> {
    let mut numbers: Vec<f64> = Vec::new();
    for UnknownValue { value, .. } in unknown {
        if !numbers.contains(value) {
            numbers.push(*value);
        }
    }
    let shown: Vec<String> = numbers.iter().take(3).map(|x| format!("{x:?}")).collect();
    let (n, is_one) = (unknown.len(), unknown.len() == 1);
    let values = if is_one { "value" } else { "values" };
    let are = if is_one { "is" } else { "are" };
    let count = if is_one { "counts" } else { "count" };
    (n > 0).then(|| {
        format!(
            "{n} {values} of {name} {are} {}, far from all others, and {count} as unknown",
            shown.join(" or ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of n vertices and c channels in (−a, a), with a sentinel at every fifth vertex of the last channel.
    fn field(n: usize, c: usize, a: f64, sentinel: f64) -> Vec<f64> {
        let value = |k: usize| {
            if k % c == c - 1 && (k / c).is_multiple_of(5) { sentinel } else { a * (k as f64).sin() }
        };
        (0..n * c).map(value).collect()
    }

    #[test]
    fn known_sentinels_far_outside_are_unknown() {
        for sentinel in [
            -1.6375e30,
            f64::from(-1.6375e30_f32),
            1e20,
            f64::from(1e20_f32),
            9.96921e36,
            -9999.0,
            -32768.0,
            -3.402_823_5e38,
        ] {
            for (n, c, a) in [(40, 1, 1.0), (100, 3, 300.0), (25, 2, 1e-9)] {
                let before = field(n, c, a, sentinel);
                let mut values = before.clone();
                let found = mark_unknown(&mut values, c);
                let expected: Vec<usize> = (0..n * c).filter(|k| before[*k] == sentinel).collect();
                assert_eq!(found.iter().map(|u| u.index).collect::<Vec<_>>(), expected, "{sentinel}");
                for k in 0..n * c {
                    assert_eq!(values[k].is_nan(), expected.contains(&k));
                    assert!(values[k].is_nan() || values[k] == before[k]);
                }
            }
        }
    }

    #[test]
    fn numbers_are_left_alone() {
        // Values of that size, an unusual number, and too few values to tell.
        for (n, a, sentinel) in
            [(100, 8000.0, -9999.0), (100, 1.0, -9998.0), (100, 1.0, 2e20), (15, 1.0, -9999.0)]
        {
            let before = field(n, 1, a, sentinel);
            let mut values = before.clone();
            assert!(mark_unknown(&mut values, 1).is_empty(), "{sentinel}");
            assert_eq!(values, before);
        }
        assert!(mark_unknown(&mut [], 2).is_empty());
    }

    #[test]
    fn two_sentinels_do_not_hide_each_other() {
        let mut values = field(60, 1, 1.0, -9999.0);
        values[1] = 1e20;
        let found = mark_unknown(&mut values, 1);
        assert_eq!(found.len(), 13);
        assert_eq!(
            describe_unknown("f", &found).unwrap(),
            "13 values of f are -9999.0 or 1e20, far from all others, and count as unknown"
        );
        assert_eq!(describe_unknown("f", &[]), None);
    }
}
