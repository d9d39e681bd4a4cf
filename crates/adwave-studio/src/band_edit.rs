//! Bands of a signal and the edit of their gains, for positions of shapes and for values of grids.

use crate::StudioError;
use crate::document::Document;
use crate::response::ApiError;
use adwave::bands::{DEFAULT_EXTENT, Schedule};
use adwave::filter::Preset;
use adwave::region::Length;
use adwave::{Decomposer, Editor, LevelSpec, Progress};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Default number of levels; small shapes have fewer, large shapes as many as are needed to reach
/// [`MIN_RELATIVE_WIDTH`].
const DEFAULT_LEVELS: usize = 8;
/// Largest default number of levels: the number of bands that a shader can sum in addition to the masks of four layers.
const MAX_DEFAULT_LEVELS: usize = 12;
/// Largest width σ of a default level, relative to the diagonal.
const MAX_RELATIVE_WIDTH: f64 = 0.25;
/// Width σ, relative to the diagonal, that the coarsest default level of a large shape reaches.
const MIN_RELATIVE_WIDTH: f64 = 0.02;

/// Body of `PUT levels`: a count, a count with voices per octave, steps, or widths; if empty, the default levels.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LevelsRequest {
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    voices: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lengths: Option<Vec<Length>>,
}

impl LevelsRequest {
    /// Converts to the levels of a recipe.
    pub(crate) fn to_levels(&self, walk_decomposer: &Decomposer) -> Result<LevelSpec, ApiError> {
        Ok(match self {
            Self { lengths: Some(lengths), levels: None, voices: None, steps: None } => {
                LevelSpec::Widths(lengths.clone())
            }
            Self { steps: Some(steps), levels: None, voices: None, lengths: None } => {
                LevelSpec::Steps(steps.clone())
            }
            Self { lengths: Some(_), .. } | Self { steps: Some(_), .. } => {
                let message = "either levels, steps or lengths can be given, got several; give one";
                return Err(ApiError::bad_request(message));
            }
            Self { voices: Some(voices), levels, .. } => {
                let n = levels.unwrap_or(DEFAULT_LEVELS);
                let schedule = Schedule::voices(n, *voices).map_err(|e| ApiError::from_classified(&e))?;
                LevelSpec::Steps(schedule.steps().to_vec())
            }
            Self { levels: Some(levels), .. } => LevelSpec::Dyadic(*levels),
            Self { .. } => default_levels(walk_decomposer),
        })
    }

    /// Converts the levels of a prepared shape to a request.
    fn from_levels(levels: &LevelSpec, schedule: &Schedule) -> Self {
        match levels {
            LevelSpec::Dyadic(n) => Self { levels: Some(*n), ..Self::default() },
            LevelSpec::Widths(widths) => Self { lengths: Some(widths.clone()), ..Self::default() },
            _ => Self { steps: Some(schedule.steps().to_vec()), ..Self::default() },
        }
    }
}

/// Default levels: eight dyadic levels, fewer if the widest would exceed a quarter of the diagonal, and more if it
/// would stay below 2 % of it.
pub(crate) fn default_levels(decomposer: &Decomposer) -> LevelSpec {
    let most = decomposer.levels_reaching(MAX_RELATIVE_WIDTH).0;
    let least = decomposer.levels_reaching(MIN_RELATIVE_WIDTH).0;
    spread_levels(DEFAULT_LEVELS.max(least).min(most).max(3))
}

/// Returns the dyadic levels 1 … n; if n exceeds [`MAX_DEFAULT_LEVELS`], this number of them, spread evenly from first
/// to last.
fn spread_levels(n: usize) -> LevelSpec {
    if n <= MAX_DEFAULT_LEVELS {
        return LevelSpec::Dyadic(n);
    }
    let doublings = |j: usize| (j * (n - 1)) as f64 / (MAX_DEFAULT_LEVELS - 1) as f64;
    LevelSpec::Steps((0..MAX_DEFAULT_LEVELS).map(|j| doublings(j).round().exp2()).collect())
}

/// Description of a level for the page.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct LevelInfo {
    level: usize,
    steps: f64,
    sigma: f64,
    fwhm: f64,
}

/// Message of a fault of this program: bands are used before they are computed.
const NOT_SPLIT: &str = "the signal is split before its bands are used";

/// Bands of a signal, and the edit of their gains.
pub(crate) struct BandEdit {
    pub(crate) decomposer: Decomposer,
    pub(crate) levels: LevelSpec,
    pub(crate) schedule: Schedule,
    pub(crate) document: Document,
    split: Split,
}

/// A signal, before and after it is split into bands.
enum Split {
    No { values: Vec<f64>, n_channels: usize },
    Yes(Box<Editor>),
}

/// Signal to split, n × `n_channels` values, and its levels.
pub(crate) struct BandEditRequest<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) n_channels: usize,
    pub(crate) levels: LevelSpec,
}

impl BandEdit {
    /// Chooses the levels of a signal; the edit is empty. [`split`](Self::split) computes the bands.
    pub(crate) fn new(decomposer: Decomposer, request: BandEditRequest<'_>) -> Result<Self, StudioError> {
        let BandEditRequest { values, n_channels, levels } = request;
        let resolved =
            levels.resolve(&decomposer, DEFAULT_EXTENT).map_err(|e| StudioError::from_classified(&e))?;
        let split = Split::No { values: values.to_vec(), n_channels };
        Ok(Self { decomposer, levels, schedule: resolved.schedule, document: Document::default(), split })
    }

    /// Computes the bands unless that was done. On an error nothing changes.
    pub(crate) fn split(&mut self, progress: Progress<'_>) -> Result<(), StudioError> {
        if let Split::No { values, n_channels } = &self.split {
            let request = self.decomposer.request(values, *n_channels, &self.schedule);
            let editor = request.progress(progress).editor().map_err(|e| StudioError::from_classified(&e))?;
            self.split = Split::Yes(Box::new(editor));
        }
        Ok(())
    }

    /// The bands, after [`split`](Self::split).
    pub(crate) fn editor(&self) -> &Editor {
        let Split::Yes(editor) = &self.split else { panic!("{NOT_SPLIT}") };
        editor
    }

    /// The bands for edits, after [`split`](Self::split).
    pub(crate) fn editor_mut(&mut self) -> &mut Editor {
        let Split::Yes(editor) = &mut self.split else { panic!("{NOT_SPLIT}") };
        editor
    }

    pub(crate) fn n_levels(&self) -> usize {
        self.schedule.n_levels()
    }

    /// Returns the request that leads to the current levels.
    pub(crate) fn levels_request(&self) -> LevelsRequest {
        LevelsRequest::from_levels(&self.levels, &self.schedule)
    }

    /// Widths σ of the levels in model units, fine to coarse.
    pub(crate) fn sigmas(&self) -> Vec<f64> {
        self.schedule.sigma(self.decomposer.operator().step_length())[1..].to_vec()
    }

    /// Describes the levels for the page, fine to coarse.
    pub(crate) fn level_infos(&self) -> Vec<LevelInfo> {
        let sigma = self.sigmas();
        let one = |(j, (&steps, &sigma)): (usize, (&f64, &f64))| LevelInfo {
            level: j + 1,
            steps,
            sigma,
            fwhm: adwave::bands::FWHM * sigma,
        };
        self.schedule.steps().iter().zip(&sigma).enumerate().map(one).collect()
    }

    /// Describes the levels, and the edit with the gains for these levels.
    pub(crate) fn describe_levels(&self) -> Value {
        json!({"levels": self.level_infos(), "choice": self.levels_request(), "edit": self.document})
    }

    /// Lists the presets with their gains for these levels.
    pub(crate) fn presets(&self) -> Vec<Value> {
        let describe =
            |preset: &Preset| json!({"name": preset.name(), "gains": preset.gains(self.n_levels())});
        Preset::ALL.iter().map(describe).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_levels_are_spread_over_the_same_widths() {
        assert_eq!(spread_levels(9), LevelSpec::Dyadic(9));
        let LevelSpec::Steps(steps) = spread_levels(16) else { panic!("no steps") };
        assert_eq!((steps.len(), steps[0], steps[11]), (12, 1.0, 32768.0));
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
    }
}
