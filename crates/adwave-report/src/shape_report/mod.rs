//! The report of one shape: its health, its bands, where it stands out, what the presets do to it, and how long each took.
//!
//! A section that a shape has no room for says why; a report is made of every shape that has a diffusion operator.

mod bands;
pub(crate) mod drawing;
pub(crate) mod features;
mod health;
mod place;
pub(crate) mod presets;
pub(crate) mod saliency;
mod scene;
mod timings;

pub(crate) use bands::section as band_section;
pub use bands::{BandSummary, band_summaries};
pub use features::FeatureSummary;
pub use presets::PresetSummary;
pub use saliency::SaliencySummary;

use crate::page::Page;
use crate::table::digits;
use adwave::bands::Bands;
use adwave::shape::{Health, Shape};
use adwave::{Cancelled, Decomposer, Progress};
use adwave_render::{Up, View};
use drawing::Studio;

/// The name of the coordinates as a signal.
pub const COORDS: &str = "coords";

/// The name of the difference between two versions of a shape as a signal.
pub const DIFFERENCE: &str = "difference";

/// Sections, for progress.
const N_SECTIONS: u64 = 6;

/// What a report is about: a shape that is split into bands.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// What it is called: a file's name.
    pub name: &'a str,
    /// The file's format, or what else it comes from.
    pub format: &'a str,
    /// The names of the fields that the file has.
    pub fields: &'a [String],
    /// The shape.
    pub shape: &'a Shape,
    /// Its diffusion operator, with the vertices masked where the signal is NaN.
    pub decomposer: &'a Decomposer,
    /// The name of the signal: [`COORDS`], or that of a field.
    pub signal: &'a str,
    /// The signal: n_vertices × n_channels, in the order of the shape.
    pub values: &'a [f64],
    /// The normals of the file, three numbers for each vertex, where it has some.
    pub normals: Option<&'a [f64]>,
    /// The signal's bands.
    pub bands: &'a Bands,
    /// Why there are so many levels.
    pub levels_reason: &'a str,
    /// The command that makes the report.
    pub command: &'a str,
    /// What took how many seconds before.
    pub seconds: &'a [(&'a str, f64)],
}

impl Subject<'_> {
    /// Whether the signal is the shape itself.
    fn is_geometry(&self) -> bool {
        self.signal == COORDS && self.shape.points().is_some() && self.bands.n_channels == 3
    }

    /// The unit of the signal, in words.
    fn unit(&self) -> String {
        if self.is_geometry() || self.signal == DIFFERENCE {
            "model units".to_owned()
        } else {
            format!("units of {}", self.signal)
        }
    }

    /// The unit of the widths σ, in words.
    fn width_unit(&self) -> &'static str {
        if self.shape.points().is_some() { "model units" } else { "hops" }
    }

    /// The word for a vertex.
    fn vertex(&self) -> &'static str {
        if let Shape::Graph(_) = self.shape { "node" } else { "vertex" }
    }

    /// The word for several.
    fn vertices(&self) -> &'static str {
        if let Shape::Graph(_) = self.shape { "nodes" } else { "vertices" }
    }

    /// A point with decimals of a ten-thousandth of the shape.
    fn position(&self, point: [f64; 3]) -> String {
        // Of a shape without extent this is infinite, which the cast saturates.
        let decimals = 4_i32.saturating_sub(self.decomposer.diagonal().log10().floor() as i32);
        let far = point.iter().any(|c| c.abs() >= 1e9);
        let cell = |c: f64| match decimals {
            0..=9 if !far => format!("{c:.*}", decimals as usize).replace('-', "−"),
            decimals if decimals < 0 && !far => format!("{c:.0}").replace('-', "−"),
            _ => digits(c),
        };
        point.map(cell).join(", ")
    }

    /// A width in % of the diagonal.
    fn percent(&self, width: f64) -> f64 {
        let diagonal = self.decomposer.diagonal();
        if diagonal > 0.0 { 100.0 * width / diagonal } else { f64::NAN }
    }

    /// The length of the signal's row at each vertex; of a single channel the value itself.
    pub(crate) fn scalar(&self, signal: &[f64]) -> Vec<f64> {
        match self.bands.n_channels {
            1 => signal.to_vec(),
            n => signal.chunks_exact(n).map(|row| row.iter().map(|v| v * v).sum::<f64>().sqrt()).collect(),
        }
    }

    /// The signal's name, between bars where its length is meant.
    pub(crate) fn scalar_name(&self) -> String {
        if self.bands.n_channels == 1 { self.signal.to_owned() } else { format!("|{}|", self.signal) }
    }
}

/// From where the pictures are seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// Where the viewer stands; the second picture of a shape is from the opposite side.
    pub view: Option<View>,
    /// Which axis points up.
    pub up: Up,
}

/// A report.
#[derive(Clone, Debug)]
pub struct ShapeReport {
    /// The page.
    pub page: Page,
    /// The numbers of its first section.
    pub health: Health,
    /// One a level.
    pub bands: Vec<BandSummary>,
    /// What stands out; none where there are too few levels.
    pub saliency: Option<SaliencySummary>,
    /// The features; none where there are too few levels.
    pub features: Option<FeatureSummary>,
    /// One a preset.
    pub presets: Vec<PresetSummary>,
    /// What took how many seconds, those of [`Subject::seconds`] first.
    pub seconds: Vec<(String, f64)>,
    /// How many pictures of the shape are on the page.
    pub n_pictures: usize,
}

/// Makes the report of a shape. O(vertices × levels), and for each of some 20 pictures O(vertices + pixels).
///
/// Whatever cannot be computed or drawn is said in its section.
///
/// # Errors
/// [`Cancelled`].
pub fn shape_report(
    subject: &Subject<'_>,
    viewpoint: Viewpoint,
    progress: Progress<'_>,
) -> Result<ShapeReport, Cancelled> {
    let mut seconds: Vec<(String, f64)> =
        subject.seconds.iter().map(|&(what, s)| (what.to_owned(), s)).collect();
    progress.step(0, N_SECTIONS)?;
    let mut studio = Studio::new(subject.shape, viewpoint, progress)?;
    let (health_section, health) = health::section(subject);
    let shape_section = scene::section(subject, &mut studio);
    progress.step(1, N_SECTIONS)?;
    let (bands_section, bands) = bands::section(subject, &mut studio);
    progress.step(2, N_SECTIONS)?;
    let (saliency_section, saliency) = saliency::section(subject, &mut studio);
    seconds.extend(saliency.iter().map(|s| ("saliency".to_owned(), s.seconds)));
    progress.step(3, N_SECTIONS)?;
    let (features_section, features) = features::section(subject, &mut studio);
    seconds.extend(features.iter().map(|f| ("features".to_owned(), f.seconds)));
    progress.step(4, N_SECTIONS)?;
    let (presets_section, presets) = presets::section(subject, &mut studio, health.volume);
    seconds.push(("presets".to_owned(), presets.iter().map(|p| p.seconds).sum()));
    progress.step(5, N_SECTIONS)?;
    if studio.n_pictures() > 0 {
        seconds.push(("pictures".to_owned(), studio.seconds()));
    }
    let sections = vec![
        health_section,
        shape_section,
        bands_section,
        saliency_section,
        features_section,
        presets_section,
        timings::section(subject, &seconds),
    ];
    let page = Page {
        title: title(subject),
        introduction: introduction(subject),
        sections: sections.into_iter().filter(|s| !s.blocks.is_empty()).collect(),
        footer: format!("Made by adwave {} with `{}`.", env!("CARGO_PKG_VERSION"), subject.command),
    };
    progress.step(N_SECTIONS, N_SECTIONS)?;
    Ok(ShapeReport {
        page,
        health,
        bands,
        saliency,
        features,
        presets,
        seconds,
        n_pictures: studio.n_pictures(),
    })
}

fn title(subject: &Subject<'_>) -> String {
    if subject.signal == COORDS {
        subject.name.to_owned()
    } else {
        format!("{} on {}", subject.signal, subject.name)
    }
}

fn introduction(subject: &Subject<'_>) -> Vec<String> {
    let signal = if subject.is_geometry() {
        "the positions of its vertices".to_owned()
    } else {
        format!("{}, in its own unit", subject.signal)
    };
    vec![
        format!(
            "A report of {}: what it is made of, and what its bands hold. The signal that is split into bands is {signal}.",
            subject.name
        ),
        format!(
            "S_j is the signal after n_j small steps of averaging between neighbors, which smooth away what is narrower than \
             about σ_j, in {}. Band j, W_j = S_(j−1) − S_j, is what goes from one to the next: the details of about that width. \
             The bands W_1 … W_J and the rest S_J add up to the signal; J is the number of levels.",
            subject.width_unit()
        ),
    ]
}
