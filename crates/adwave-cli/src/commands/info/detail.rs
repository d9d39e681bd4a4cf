//! `adwave info --detail` and `--error`: loss of detail if fine bands are dropped, and the bands that can be dropped
//! within an error.

use super::InfoArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{command_line, fwhm_text, number, percent_of, table};
use crate::resolve::shape::Input;
use adwave::Decomposer;
use adwave::bands::{BandsParams, FWHM, Schedule};
use adwave::region::Length;
use adwave::shape::{Health, Shape};
use adwave_report::{DetailLoss, detail_loss, widest_within};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::fmt::Write;

/// Loss of detail by level, and the answer to an error that was asked for.
pub(super) struct Detail {
    losses: Vec<DetailLoss>,
    /// Shares of the bands and of the rest in the variance of the coordinates.
    shares: Vec<f64>,
    diagonal: f64,
    question: Option<ErrorQuestion>,
}

/// An allowed error, and the command that would drop bands.
struct ErrorQuestion {
    /// The error in model units.
    error: f64,
    /// The error as it was typed.
    typed: String,
    /// Command that drops the n finest bands.
    drop_command: Box<dyn Fn(usize) -> String>,
}

/// Refuses values of `--error` that no shape can have.
pub(super) fn check(args: &InfoArgs) -> Result<(), CliError> {
    match args.error {
        Some(Length::Units(error) | Length::PercentOfDiagonal(error))
            if !(error.is_finite() && error >= 0.0) =>
        {
            Err(CliError::Input(format!("--error must be finite and not negative, got {error}")))
        }
        _ => Ok(()),
    }
}

/// Splits the coordinates and measures the loss at each level.
pub(super) fn measure(
    input: &Input,
    decomposer: &Decomposer,
    schedule: &Schedule,
    params: &BandsParams,
    global: &Global<'_>,
) -> Result<Detail, CliError> {
    let Some(points) = input.shape.points() else {
        return Err(CliError::Input(format!(
            "{}: a graph has no positions, so there is no detail to measure; leave out --detail and --error",
            input.name
        )));
    };
    let bands = with_progress(global, "splitting", |progress| {
        decomposer.request(points.as_flattened(), 3, schedule).params(params).progress(progress).bands()
    })?;
    let losses = detail_loss(&bands, &decomposer.areas());
    let shares = bands.shares(&decomposer.stationary())?;
    Ok(Detail { losses, shares, diagonal: decomposer.extent(), question: None })
}

/// A length as it is typed.
fn typed(length: Length) -> String {
    match length {
        Length::Units(units) => units.to_string(),
        Length::PercentOfDiagonal(percent) => format!("{percent} % of the diagonal"),
        Length::Degrees(angle) => format!("{angle}°"),
    }
}

/// A name for the result in a format that is written.
fn output_name(input: &Input) -> String {
    let format = input.file.format();
    format!("OUT.{}", format.and_then(|f| f.extensions().first().copied()).unwrap_or("ply"))
}

/// The command that drops the `n` finest of the levels, from the words of this one.
fn filter_command(words: &[OsString], output: &str, n: usize, n_levels: usize, positions: &[&str]) -> String {
    let mut filter: Vec<OsString> = vec!["filter".into()];
    let (mut skips_value, mut skips_command) = (false, true);
    for word in words.iter().skip(1) {
        let text = word.to_string_lossy();
        if std::mem::take(&mut skips_value) {
            continue;
        }
        match text.as_ref() {
            "info" if skips_command => skips_command = false,
            "--detail" | "--json" | "--quiet" | "-q" => {}
            "--error" => skips_value = true,
            text if text.starts_with("--error=") => {}
            _ => filter.push(word.clone()),
        }
    }
    let gains: Vec<&str> = (1..=n_levels).map(|j| if j <= n { "0" } else { "1" }).collect();
    filter.extend(["-o", output, "--gains", &gains.join(",")].map(OsString::from));
    filter.extend(positions.iter().map(OsString::from));
    command_line(filter.iter())
}

impl Detail {
    /// This loss of detail with the requested error, if there is one, and the command that would drop bands.
    pub(super) fn with_question(
        self,
        args: &InfoArgs,
        input: &Input,
        health: Option<&Health>,
        global: &Global<'_>,
    ) -> Self {
        let (words, n_levels) = (global.arguments.to_vec(), self.losses.len());
        // The loss is measured on the bands; by default filter keeps the outline of open shapes from shrinking, and
        // points of a cloud on their normals.
        let positions: &[&str] = match &input.shape {
            Shape::Mesh(_) if health.is_some_and(Health::is_closed) => &[],
            Shape::Mesh(_) => &["--border", "free"],
            Shape::Cloud(_) => &["--border", "free", "--along", "free"],
            // The ends of a curve stay in its bands too.
            Shape::Graph(_) => &[],
        };
        let output = output_name(input);
        let question = args.error.map(|error| ErrorQuestion {
            error: error.to_model_units(self.diagonal),
            typed: typed(error),
            drop_command: Box::new(move |n| filter_command(&words, &output, n, n_levels, positions)),
        });
        Self { question, ..self }
    }

    /// The table of losses, and the answer to the error that is asked for.
    pub(super) fn text(&self) -> String {
        let percent = |length: f64| percent_of(length, self.diagonal);
        let mut text =
            "\nLoss if everything finer than S_j is dropped, |f − S_j| over the vertices:\n\n".to_owned();
        text += &table(
            [
                "bands dropped",
                "sigma",
                "greatest",
                "% of diagonal",
                "rms by area",
                "% of diagonal",
                "% of variance in W_j",
            ],
            self.losses.iter().zip(&self.shares).map(|(loss, share)| {
                [
                    dropped_bands(loss.level),
                    number(loss.sigma),
                    number(loss.greatest),
                    percent(loss.greatest),
                    number(loss.rms),
                    percent(loss.rms),
                    number(100.0 * share),
                ]
            }),
        );
        if let Some(rest) = self.shares.last() {
            let _ = writeln!(
                text,
                "\n{} % of the variance are left in S_{}",
                number(100.0 * rest),
                self.losses.len()
            );
        }
        if let Some(question) = &self.question {
            text += "\n";
            for (name, measure) in MEASURES {
                self.answer(&mut text, name, question, measure);
            }
        }
        text
    }

    fn answer(&self, text: &mut String, name: &str, question: &ErrorQuestion, measure: Measure) {
        let typed = &question.typed;
        let Some(loss) = widest_within(&self.losses, question.error, measure) else {
            let first = self.losses.first().map_or(0.0, measure);
            let _ = writeln!(
                text,
                "{name} within {typed}: no band can be dropped, S_1 is {} away; try finer levels (--steps or --lengths)",
                number(first)
            );
            return;
        };
        let bands = if loss.level == 1 { "band 1".to_owned() } else { format!("bands 1–{}", loss.level) };
        let widest = if loss.level == self.losses.len() { ", the widest level; -j adds more" } else { "" };
        let _ = writeln!(
            text,
            "{name} within {typed}: S_{} (σ = {}, FWHM = {}{widest}), so {bands} can be dropped:\n  {}",
            loss.level,
            number(loss.sigma),
            fwhm_text(loss.sigma, self.diagonal),
            (question.drop_command)(loss.level)
        );
    }

    /// Losses by level, and the answer to the error.
    pub(super) fn json(&self) -> Value {
        let percent = |length: f64| {
            if self.diagonal > 0.0 { json!(100.0 * length / self.diagonal) } else { Value::Null }
        };
        let levels: Vec<Value> = self
            .losses
            .iter()
            .zip(&self.shares)
            .map(|(loss, share)| {
                json!({
                    "share": share,
                    "level": loss.level, "sigma": loss.sigma,
                    "greatest": loss.greatest, "greatest_percent": percent(loss.greatest),
                    "rms": loss.rms, "rms_percent": percent(loss.rms),
                })
            })
            .collect();
        let within = self.question.as_ref().map(|question| {
            let error = question.error;
            let answer = |measure: Measure| {
                widest_within(&self.losses, error, measure).map(|loss| {
                    json!({
                        "level": loss.level, "sigma": loss.sigma, "fwhm": FWHM * loss.sigma,
                        "command": (question.drop_command)(loss.level),
                    })
                })
            };
            json!({"error": error, "greatest": answer(MEASURES[0].1), "rms": answer(MEASURES[1].1)})
        });
        json!({"levels": levels, "rest_share": self.shares.last(), "within": within})
    }
}

type Measure = fn(&DetailLoss) -> f64;

/// Measures of a loss with their names.
const MEASURES: [(&str, Measure); 2] = [("greatest", |loss| loss.greatest), ("rms", |loss| loss.rms)];

fn dropped_bands(level: usize) -> String {
    if level == 1 { "1".to_owned() } else { format!("1–{level}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_keeps_what_says_which_shape_and_levels() {
        let words: Vec<OsString> =
            ["adwave", "--json", "info", "my info.ply", "--lengths", "1,2,4", "--error", "1%", "--detail"]
                .map(OsString::from)
                .to_vec();
        assert_eq!(
            filter_command(&words, "OUT.ply", 2, 3, &["--border", "free"]),
            "adwave filter 'my info.ply' --lengths 1,2,4 -o OUT.ply --gains 0,0,1 --border free"
        );
        let words: Vec<OsString> =
            ["adwave", "info", "a.obj", "--error=1", "-j", "4"].map(OsString::from).to_vec();
        assert_eq!(
            filter_command(&words, "OUT.obj", 4, 4, &[]),
            "adwave filter a.obj -j 4 -o OUT.obj --gains 0,0,0,0"
        );
    }
}
