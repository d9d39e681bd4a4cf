//! Bands along time.

use super::parse::{number, parse_named};
use adwave::bands::FWHM;
use adwave::time::TimeEnds;
use clap::Args;

/// Bands along time, for a signal whose channels are frames.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Time")]
pub(crate) struct TimeArgs {
    /// Bands along time with these full widths at half maximum, increasing: 3s, 500ms, 2min, 1h, 30d; a number alone is
    /// in seconds. The channels of the signal are its frames
    #[arg(long, value_name = "T,T,…", value_delimiter = ',', value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) time_fwhm: Option<Vec<f64>>,
    /// Bands along time with these widths σ: --time-fwhm of 1.665 σ
    #[arg(
        long,
        value_name = "T,T,…",
        value_delimiter = ',',
        value_parser = seconds,
        allow_negative_numbers = true,
        conflicts_with = "time_fwhm"
    )]
    pub(crate) time_lengths: Option<Vec<f64>>,
    #[command(flatten)]
    pub(crate) axis: TimeAxisArgs,
}

/// Frames along time.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Time")]
pub(crate) struct TimeAxisArgs {
    /// Time from frame to frame [default: as the file says]
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) time_step: Option<f64>,
    /// Treatment of the ends [default: reflect]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<TimeEnds>())]
    pub(crate) time_ends: Option<TimeEnds>,
}

/// Gains of bands in space for each band along time: a row for each band along time, fine to coarse, and one for the
/// rest.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GainRows(pub(crate) Vec<Vec<f64>>);

/// Reads rows of gains, `1,1,0;1,0,0`.
pub(crate) fn gain_rows(text: &str) -> Result<GainRows, String> {
    let row = |row: &str| row.split(',').map(|gain| number(gain.trim())).collect::<Result<Vec<f64>, _>>();
    let rows = text.split(';').map(row).collect::<Result<Vec<_>, _>>()?;
    match rows.iter().find(|row| row.len() != rows[0].len()) {
        Some(other) => Err(format!(
            "every row must have a gain for each band in space, got {} and {}",
            rows[0].len(),
            other.len()
        )),
        None => Ok(GainRows(rows)),
    }
}

impl TimeArgs {
    /// Widths σ in seconds, if bands along time are asked for.
    pub(crate) fn widths(&self) -> Option<Vec<f64>> {
        let from_fwhm = |fwhm: &Vec<f64>| fwhm.iter().map(|width| width / FWHM).collect();
        self.time_fwhm.as_ref().map(from_fwhm).or_else(|| self.time_lengths.clone())
    }
}

/// Reads a time in seconds.
fn seconds(text: &str) -> Result<f64, String> {
    const UNITS: [(&str, f64); 7] =
        [("ms", 1e-3), ("us", 1e-6), ("min", 60.0), ("s", 1.0), ("h", 3600.0), ("d", 86400.0), ("", 1.0)];
    let text = text.trim();
    let parsed = UNITS.iter().find_map(|(unit, factor)| {
        let value: f64 = text.strip_suffix(unit)?.trim_end().parse().ok()?;
        Some(value * factor)
    });
    parsed.ok_or_else(|| "must be a time such as 3s, 500ms, 2min, 1h or 30d".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_come_in_rows() {
        assert_eq!(gain_rows("1, 0;-2,3"), Ok(GainRows(vec![vec![1.0, 0.0], vec![-2.0, 3.0]])));
        let uneven = gain_rows("1;1,2").unwrap_err();
        assert!(uneven.contains("got 1 and 2"), "{uneven}");
        assert!(["", "1;", "1,x"].map(gain_rows).iter().all(Result::is_err));
    }

    #[test]
    fn times_have_units() {
        let found = ["3s", "2", "500 ms", "2min", "1.5h", "1d", "20us", "-1s"].map(seconds);
        let expected = [3.0, 2.0, 0.5, 120.0, 5400.0, 86400.0, 20e-6, -1.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a.as_ref().unwrap() - b).abs() < 1e-12));
        assert!(["", "s", "3 parsecs", "3m"].map(seconds).iter().all(Result::is_err));
    }
}
