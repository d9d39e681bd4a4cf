//! Round values along a range, with labels that have as many digits as the range needs.

/// Approximate number of labels along a range.
const TICKS: f64 = 5.0;

/// Magnitude of the values, in steps, above which labels count from an offset: five digits before the digit that
/// changes.
const FAR: f64 = 1e5;

/// Magnitude below which an offset is written without a power of ten.
const PLAIN: f64 = 1e15;

/// Round values along a range.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    /// Values with their labels.
    pub(crate) marks: Vec<(f64, String)>,
    /// Number to add to each label, such as `+ 1000000`, if the labels would have many digits in common.
    pub(crate) offset: Option<String>,
}

impl Ticks {
    /// Computes the multiples of 1, 2 or 5 times a power of ten between `low` and `high`.
    pub(crate) fn new(low: f64, high: f64) -> Self {
        let span = high - low;
        let rough = span / TICKS;
        let power = 10.0_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= 0.999 * rough);
        let Some(step) = step.filter(|s| *s > 0.0 && s.is_finite()) else {
            let marks = vec![(low, format_tick(low, span)), (high, format_tick(high, span))];
            return Self { marks, offset: None };
        };
        let offset = round_offset(low, high, step);
        // A range far from 0 may be narrower than the spacing of floating-point numbers there.
        let first = ((low - offset) / step - 1e-9).ceil();
        let parts = (0..=10).map(|k| (first + f64::from(k)) * step);
        let mut marks: Vec<(f64, String)> = Vec::new();
        for part in parts.take_while(|part| *part <= high - offset + 1e-9 * span) {
            let part = if part.abs() < 1e-9 * span { 0.0 } else { part };
            let text = format_tick(part, step);
            if marks.iter().all(|(value, other)| *other != text && *value != offset + part) {
                marks.push((offset + part, text));
            }
        }
        Self { marks, offset: (offset != 0.0).then(|| format_offset(offset)) }
    }
}

/// Number from which labels count: the largest multiple of the power of ten above the width of the range that does not
/// exceed its lower end; 0 for a range whose labels are short enough.
fn round_offset(low: f64, high: f64, step: f64) -> f64 {
    if low.abs().max(high.abs()) < FAR * step {
        return 0.0;
    }
    let unit = 10.0_f64.powf(((high - low) * 0.999).log10().ceil());
    // The quotient of a round number may fall just short of a whole one.
    let offset = (low / unit + 1e-6).floor() * unit;
    if offset.is_finite() { offset } else { 0.0 }
}

/// Formats an offset with its sign and all its digits.
fn format_offset(offset: f64) -> String {
    let size = offset.abs();
    let number = if (1e-3..PLAIN).contains(&size) {
        // Twelve decimals of a number below 1000 and none of the largest: the digits that it has.
        let decimals = (14.0 - size.log10().floor()).clamp(0.0, 12.0) as usize;
        let text = format!("{size:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{size:.14e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{power}", mantissa.trim_end_matches('0').trim_end_matches('.'))
    };
    format!("{} {number}", if offset < 0.0 { '−' } else { '+' })
}

/// Formats a value with the precision needed for steps of `step`.
fn format_tick(value: f64, step: f64) -> String {
    let size = value.abs().max(step.abs());
    let text = if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 8.0) as usize;
        format!("{value:.decimals$}")
    } else {
        let digits = (value.abs().log10().floor() - (step * 1.001).log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$e}")
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64) -> Vec<String> {
        Ticks::new(low, high).marks.into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn numbers_are_round_and_inside() {
        assert_eq!(texts(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(-3.0, 3.0), ["−2", "0", "2"]);
        assert_eq!(texts(0.0, 2.3e-7), ["0", "5e−8", "1.0e−7", "1.5e−7", "2.0e−7"]);
        assert_eq!(texts(100.0, 104.0), ["100", "101", "102", "103", "104"]);
        for (low, high) in [(1e16, 1e16 + 4.0), (-1e300, 1e300), (0.0, 1e-300), (5.0, 5.000_001)] {
            let found = Ticks::new(low, high).marks;
            assert!(!found.is_empty() && found.len() <= 11, "{found:?}");
            assert!(
                found.iter().all(|t| t.0 >= low - (high - low) * 1e-6 && t.0 <= high + (high - low) * 1e-6)
            );
        }
    }

    #[test]
    fn far_from_zero_the_labels_count_from_an_offset() {
        let ticks = Ticks::new(1e6, 1e6 + 1.0);
        assert_eq!(ticks.offset.as_deref(), Some("+ 1000000"));
        assert_eq!(texts(1e6, 1e6 + 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let ticks = Ticks::new(-4_512_398.7, -4_512_345.2);
        assert_eq!(ticks.offset.as_deref(), Some("− 4512400"));
        assert_eq!(Ticks::new(0.0, 1e6).offset, None);
        assert_eq!(Ticks::new(1.25, 1.25 + 1e-9).offset.as_deref(), Some("+ 1.25"));
    }

    #[test]
    fn labels_with_their_offset_are_the_values_and_tell_them_apart() {
        let plain = |text: &str| text.replace('−', "-").replace([' ', '+'], "").parse::<f64>().unwrap();
        for size in [1e-12_f64, 3.7e-5, 0.9, 12.5, 4.1e3, 1e6, 7.3e8, 2.2e12] {
            for sign in [-1.0, 1.0] {
                for narrow in [1.0, 1e-2, 3e-4, 7e-6, 2e-8] {
                    let (a, b) = (sign * size, sign * size * (1.0 + narrow));
                    let (low, high) = (a.min(b), a.max(b));
                    let Ticks { marks, offset } = Ticks::new(low, high);
                    assert!(marks.len() >= 3, "{low:e} {high:e}: {marks:?}");
                    let start = offset.as_deref().map_or(0.0, plain);
                    for (value, text) in &marks {
                        let off = (start + plain(text) - value).abs();
                        assert!(off < 1e-2 * (high - low), "{low:e} {high:e}: {text} from {offset:?}");
                        assert!(text.chars().count() <= 12, "{text}");
                    }
                }
            }
        }
    }
}
