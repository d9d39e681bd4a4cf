//! Conditions on the values of a field: `classification=2,6` or `height=1..20`.

use std::fmt;
use std::str::FromStr;

/// Condition on the values of a scalar field: `classification=2,6` or `height=1..20`.
///
/// ```
/// use adwave_io::FieldCondition;
/// let ground: FieldCondition = "classification=2,8..9".parse()?;
/// assert!(ground.holds(2.0) && ground.holds(9.0) && !ground.holds(3.0));
/// let low: FieldCondition = "height=..0.5".parse()?;
/// assert!(low.holds(0.5) && low.holds(-1.0) && !low.holds(f64::NAN));
/// assert_eq!(low.to_string(), "height=..0.5");
/// # Ok::<(), adwave_io::FieldConditionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FieldCondition {
    /// Name of the field.
    pub field: String,
    /// Intervals, one of which must contain the value.
    pub intervals: Vec<ClosedInterval>,
}

/// Numbers from `low` to `high`, both included; NaN is none of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedInterval {
    /// Least number; −∞ if there is none.
    pub low: f64,
    /// Greatest number; ∞ if there is none.
    pub high: f64,
}

/// Reasons for which a text is no condition on a field.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldConditionError {
    /// The text has no field or no numbers.
    #[error("a condition must be FIELD=VALUE,VALUE,… or FIELD=LOW..HIGH with numbers, got '{0}'")]
    Form(String),
    /// An interval has no numbers.
    #[error("LOW must not be above HIGH in FIELD=LOW..HIGH, got '{0}'; exchange them")]
    Reversed(String),
}

impl FromStr for FieldCondition {
    type Err = FieldConditionError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || FieldConditionError::Form(text.to_owned());
        let number = |word: &str| word.trim().parse::<f64>().ok().filter(|x| !x.is_nan()).ok_or_else(wrong);
        let end = |word: &str, open: f64| if word.trim().is_empty() { Ok(open) } else { number(word) };
        let interval = |word: &str| match word.split_once("..") {
            None => number(word).map(|value| ClosedInterval { low: value, high: value }),
            Some((low, high)) => {
                let (low, high) = (end(low, f64::NEG_INFINITY)?, end(high, f64::INFINITY)?);
                if low > high {
                    return Err(FieldConditionError::Reversed(text.to_owned()));
                }
                Ok(ClosedInterval { low, high })
            }
        };
        let (field, values) = text.rsplit_once('=').ok_or_else(wrong)?;
        if field.trim().is_empty() {
            return Err(wrong());
        }
        let intervals = values.split(',').map(interval).collect::<Result<_, _>>()?;
        Ok(Self { field: field.trim().to_owned(), intervals })
    }
}

impl fmt::Display for FieldCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<String> = self.intervals.iter().map(ToString::to_string).collect();
        write!(f, "{}={}", self.field, words.join(","))
    }
}

impl fmt::Display for ClosedInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.low == self.high {
            return write!(f, "{}", self.low);
        }
        let end = |x: f64| if x.is_finite() { x.to_string() } else { String::new() };
        write!(f, "{}..{}", end(self.low), end(self.high))
    }
}

impl FieldCondition {
    /// Returns true if one of the intervals contains the value.
    pub fn holds(&self, value: f64) -> bool {
        self.intervals.iter().any(|interval| interval.low <= value && value <= interval.high)
    }

    /// Condition for a field of 32-bit floats, whose 0.1 is not that of 64-bit floats.
    #[must_use]
    pub fn in_single_precision(&self) -> Self {
        let round = |x: f64| f64::from(x as f32);
        let rounded = |i: &ClosedInterval| ClosedInterval { low: round(i.low), high: round(i.high) };
        Self { field: self.field.clone(), intervals: self.intervals.iter().map(rounded).collect() }
    }
}
