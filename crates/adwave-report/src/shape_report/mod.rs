//! Report of one shape: its health, bands, saliency, features, presets and timings.
//!
//! Every shape with a diffusion operator has a report. A section that does not apply to a shape explains why.

mod bands;
pub(crate) mod drawing;
pub(crate) mod features;
mod grid;
mod health;
mod place;
pub(crate) mod presets;
pub(crate) mod saliency;
mod scene;
mod timings;

pub(crate) use bands::section as band_section;
pub use bands::{BandSummary, band_summaries};
pub use features::FeatureSummary;
pub use grid::{FlatMesh, SubjectGrid, grid_index};
pub use presets::PresetSummary;
pub use saliency::SaliencySummary;

use crate::page::Page;
use crate::table::digits;
use adwave::bands::Bands;
use adwave::shape::{Health, Shape};
use adwave::{Cancelled, Decomposer, Progress};
use adwave_render::{Up, View};
use drawing::Studio;

/// Name of the signal that consists of the coordinates.
pub const COORDS: &str = "coords";

/// Name of the signal that is the difference between two versions of a shape.
pub const DIFFERENCE: &str = "difference";

/// Number of sections that count for progress.
const N_SECTIONS: u64 = 6;

/// Subject of a report: a shape with a signal that is decomposed into bands.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Name of the shape, usually of its file.
    pub name: &'a str,
    /// Format of the file, or another origin.
    pub format: &'a str,
    /// Names of the fields in the file.
    pub fields: &'a [String],
    /// Shape itself; of an image or a volume the graph of its places.
    pub shape: &'a Shape,
    /// Axes of an image or a volume; `None` for a shape.
    pub grid: Option<SubjectGrid<'a>>,
    /// Prepared geometry and diffusion operator. Vertices where the signal is NaN are masked.
    pub decomposer: &'a Decomposer,
    /// Name of the signal: [`COORDS`], or the name of a field.
    pub signal: &'a str,
    /// Values of the signal, n_vertices × n_channels, in the order of the shape.
    pub values: &'a [f64],
    /// Normals of the file, three numbers per vertex, if it has any.
    pub normals: Option<&'a [f64]>,
    /// Bands of the signal.
    pub bands: &'a Bands,
    /// Explanation of the number of levels.
    pub levels_reason: &'a str,
    /// Command that makes the report.
    pub command: &'a str,
    /// Names and seconds of the steps before the report.
    pub seconds: &'a [(&'a str, f64)],
}

impl Subject<'_> {
    /// True if the signal consists of the positions of the vertices.
    fn is_geometry(&self) -> bool {
        self.signal == COORDS && self.shape.points().is_some() && self.bands.n_channels == 3
    }

    /// Unit of the signal, in words.
    pub(crate) fn unit(&self) -> String {
        if let Some(grid) = &self.grid
            && self.signal == DIFFERENCE
        {
            format!("units of the {}", grid.kind)
        } else if self.is_geometry() || self.signal == DIFFERENCE {
            "model units".to_owned()
        } else {
            format!("units of {}", self.signal)
        }
    }

    /// Unit of the widths σ, in words.
    fn width_unit(&self) -> &str {
        match &self.grid {
            Some(grid) => grid.unit,
            None if self.shape.points().is_some() => "model units",
            None => "hops",
        }
    }

    /// Number of a vertex, or the index of a place.
    fn place(&self, vertex: usize) -> String {
        self.grid.as_ref().map_or_else(|| vertex.to_string(), |grid| grid.index(vertex))
    }

    /// Word for a vertex of this shape.
    fn vertex(&self) -> &'static str {
        match &self.grid {
            Some(grid) => grid.words[0],
            None if self.shape.is_graph() => "node",
            None => "vertex",
        }
    }

    /// Word for several vertices of this shape.
    fn vertices(&self) -> &'static str {
        match &self.grid {
            Some(grid) => grid.words[1],
            None if self.shape.is_graph() => "nodes",
            None => "vertices",
        }
    }

    /// Formats a point, with a precision of a ten-thousandth of the size of the shape.
    fn position(&self, point: [f64; 3]) -> String {
        // For a shape without extent this is infinite; the cast saturates.
        let decimals = 4_i32.saturating_sub(self.decomposer.extent().log10().floor() as i32);
        let far = point.iter().any(|c| c.abs() >= 1e9);
        let cell = |c: f64| match decimals {
            0..=9 if !far => format!("{c:.*}", decimals as usize).replace('-', "−"),
            decimals if decimals < 0 && !far => format!("{c:.0}").replace('-', "−"),
            _ => digits(c),
        };
        point.map(cell).join(", ")
    }

    /// Converts a width in model units to % of the diagonal; NaN if the diagonal is 0.
    fn percent(&self, width: f64) -> f64 {
        let diagonal = self.decomposer.extent();
        if diagonal > 0.0 { 100.0 * width / diagonal } else { f64::NAN }
    }

    /// A map that is NaN where the signal has no value.
    fn without_missing(&self, mut map: Vec<f64>) -> Vec<f64> {
        if self.grid.is_some()
            && let Some(masked) = self.decomposer.mask_flags()
        {
            map.iter_mut().zip(masked).filter(|(_, masked)| **masked).for_each(|(v, _)| *v = f64::NAN);
        }
        map
    }

    /// Norm of the signal at each vertex; for a single channel the value itself.
    pub(crate) fn scalar(&self, signal: &[f64]) -> Vec<f64> {
        match self.bands.n_channels {
            1 => signal.to_vec(),
            n => signal.chunks_exact(n).map(|row| row.iter().map(|v| v * v).sum::<f64>().sqrt()).collect(),
        }
    }

    /// Name of the signal, between bars if its norm is shown.
    pub(crate) fn scalar_name(&self) -> String {
        if self.bands.n_channels == 1 { self.signal.to_owned() } else { format!("|{}|", self.signal) }
    }
}

/// Viewpoint of the pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// Direction of the view, `None` for the default; the second picture of a shape is from the opposite side.
    pub view: Option<View>,
    /// Axis that points up.
    pub up: Up,
}

/// Report of a shape, and its numbers.
#[derive(Clone, Debug)]
pub struct ShapeReport {
    /// HTML page.
    pub page: Page,
    /// Numbers of the health section; `None` for an image or a volume.
    pub health: Option<Health>,
    /// Statistics of the bands, one entry per level.
    pub bands: Vec<BandSummary>,
    /// Statistics of the saliency map; `None` if it could not be computed.
    pub saliency: Option<SaliencySummary>,
    /// Features; `None` if they could not be computed.
    pub features: Option<FeatureSummary>,
    /// Effects of the presets, one entry per preset.
    pub presets: Vec<PresetSummary>,
    /// Names and seconds of the steps, those of [`Subject::seconds`] first.
    pub seconds: Vec<(String, f64)>,
    /// Number of pictures of the shape on the page.
    pub n_pictures: usize,
}

/// Makes the report of a shape. O(vertices × levels), and O(vertices + pixels) for each of about 20 pictures.
///
/// If something cannot be computed or drawn, its section explains why.
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
    let mut studio = Studio::new_for_subject(subject, viewpoint, progress)?;
    let (health_section, health, shape_section) = if let Some(axes) = &subject.grid {
        (grid::section(subject, axes), None, grid::scene(subject, axes, &mut studio))
    } else {
        let (section, health) = health::section(subject);
        (section, Some(health), scene::section(subject, &mut studio))
    };
    progress.step(1, N_SECTIONS)?;
    let (bands_section, bands) = bands::section(subject, &mut studio);
    progress.step(2, N_SECTIONS)?;
    let (saliency_section, saliency) = saliency::section(subject, &mut studio);
    seconds.extend(saliency.iter().map(|s| ("saliency".to_owned(), s.seconds)));
    progress.step(3, N_SECTIONS)?;
    let (features_section, features) = features::section(subject, &mut studio);
    seconds.extend(features.iter().map(|f| ("features".to_owned(), f.seconds)));
    progress.step(4, N_SECTIONS)?;
    let (presets_section, presets) =
        presets::section(subject, &mut studio, health.as_ref().and_then(|health| health.volume));
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
            "A report on {}: its {} and its bands. The signal that is decomposed into bands is {signal}.",
            subject.name,
            if subject.grid.is_some() { "values" } else { "geometry" }
        ),
        format!(
            "S_j is the signal after n_j small steps of averaging between neighbors, which remove details narrower than about \
             σ_j, in {}. Band W_j = S_(j−1) − S_j contains the details of about that width. The bands W_1 … W_J and the rest S_J \
             add up to the signal; J is the number of levels.",
            subject.width_unit()
        ),
    ]
}
