//! The page of two versions of a shape: where and at which scale they differ.

use crate::page::{Block, Fact, Page, Section};
use crate::shape_report::drawing::{FieldLook, Frame, Scale, Studio};
use crate::shape_report::{BandSummary, Subject, Viewpoint, band_section};
use adwave::shape::Shape;
use adwave::{Cancelled, Progress};

/// What is beside the difference.
#[derive(Clone, Debug)]
pub struct Versions<'a> {
    /// The name of the other shape.
    pub other: &'a str,
    /// The other shape, moved as it was compared.
    pub shape: &'a Shape,
    /// What is known of the difference: name, value, meaning.
    pub facts: Vec<Fact>,
    /// How the two were compared, in sentences.
    pub how: Vec<String>,
}

/// A page.
#[derive(Clone, Debug)]
pub struct DifferenceReport {
    /// The page.
    pub page: Page,
    /// One a level.
    pub bands: Vec<BandSummary>,
    /// How many pictures of the shapes are on the page.
    pub n_pictures: usize,
}

/// The page of `subject`, whose signal is the difference between two versions of its shape. O(vertices × levels), and for each of about
/// ten pictures O(vertices + pixels).
///
/// # Errors
/// [`Cancelled`].
pub fn difference_report(
    subject: &Subject<'_>,
    versions: &Versions<'_>,
    viewpoint: Viewpoint,
    progress: Progress<'_>,
) -> Result<DifferenceReport, Cancelled> {
    let mut studio = Studio::new(subject.shape, viewpoint, progress)?;
    let mut other = Studio::new(versions.shape, viewpoint, progress)?;
    let mut section = Section::new("difference", "Difference");
    versions.how.iter().for_each(|text| section.say(text.clone()));
    section.push(Block::Facts(versions.facts.clone()));
    if studio.can_draw() {
        let name = subject.scalar_name();
        let values = subject.scalar(subject.values);
        let scale = if subject.bands.n_channels == 1 {
            Scale::about_zero(&values, 0.99)
        } else {
            Scale::from_zero(&values, 0.99)
        };
        let look = FieldLook::new(values, format!("{name}, model units"), scale);
        let first = Frame::plain(subject.name, format!("{}.", subject.name));
        let map = Frame::plain(
            format!("The difference on {}", subject.name),
            "The difference, up to its 99th percentile; gray where there is none.",
        )
        .field(look);
        let second = Frame::plain(versions.other, format!("{}.", versions.other));
        let drawn = studio.draw(&[first, map]).and_then(|mut figures| {
            figures.extend(other.draw(&[second])?);
            Ok(figures)
        });
        section.gallery(drawn);
    }
    progress.check()?;
    let (bands_section, bands) = band_section(subject, &mut studio);
    let page = Page {
        title: format!("{} against {}", versions.other, subject.name),
        introduction: vec![format!(
            "How {} differs from {}, and at which scale: the difference is split into bands W_j, the parts of it that are about σ_j wide, \
             and the rest S_J that is wider; together they are the difference.",
            versions.other, subject.name
        )],
        sections: vec![section, bands_section],
        footer: format!("Made by adwave {} with `{}`.", env!("CARGO_PKG_VERSION"), subject.command),
    };
    let n_pictures = studio.n_pictures() + other.n_pictures();
    Ok(DifferenceReport { page, bands, n_pictures })
}
