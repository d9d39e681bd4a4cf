//! Page that compares two versions of a shape by place and scale.

use crate::page::{Block, Fact, Page, Section};
use crate::shape_report::drawing::{FieldLook, PictureSpec, Scale, SignalPictures, Studio};
use crate::shape_report::{BandSummary, Subject, Viewpoint, band_section};
use adwave::shape::Shape;
use adwave::{Cancelled, Progress};

/// Other version of the shape, and the method of comparison.
#[derive(Clone, Debug)]
pub struct Versions<'a> {
    /// Name of the other shape.
    pub other: &'a str,
    /// Other shape, in the position in which it was compared.
    pub shape: &'a Shape,
    /// Statistics of the difference.
    pub facts: Vec<Fact>,
    /// Values of both images or volumes on the same places; `None` for shapes.
    pub values: Option<[&'a [f64]; 2]>,
    /// Description of the comparison, in sentences.
    pub how: Vec<String>,
}

/// Page of a comparison, and its numbers.
#[derive(Clone, Debug)]
pub struct DifferenceReport {
    /// HTML page.
    pub page: Page,
    /// Statistics of the bands, one entry per level.
    pub bands: Vec<BandSummary>,
    /// Number of pictures of the shapes on the page.
    pub n_pictures: usize,
}

/// Makes the page of `subject`, whose signal is the difference between two versions of its shape. O(vertices × levels),
/// and O(vertices + pixels) for each of about ten pictures.
///
/// # Errors
/// [`Cancelled`].
pub fn difference_report(
    subject: &Subject<'_>,
    versions: &Versions<'_>,
    viewpoint: Viewpoint,
    progress: Progress<'_>,
) -> Result<DifferenceReport, Cancelled> {
    let mut studio = Studio::new_for_subject(subject, viewpoint, progress)?;
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
        let look = FieldLook::new(values, format!("{name}, {}", subject.unit()), scale);
        let map = PictureSpec::plain(
            format!("The difference on {}", subject.name),
            "The difference, up to its 99th percentile. Gray: no difference.",
        )
        .field(look);
        let plain = |name: &str| PictureSpec::plain(name, format!("{name}."));
        let drawn = if let Some([first, second]) = versions.values {
            let both = Subject { values: first, signal: "values", ..*subject };
            let signal = SignalPictures::new(&both);
            let shown = |name: &str, values| signal.picture(values, name.to_owned(), format!("{name}."));
            studio.draw(&[shown(subject.name, first), map, shown(versions.other, second)])
        } else {
            studio.draw(&[plain(subject.name), map]).and_then(|mut figures| {
                figures.extend(other.draw(&[plain(versions.other)])?);
                Ok(figures)
            })
        };
        section.gallery(drawn);
    }
    progress.check()?;
    let (bands_section, bands) = band_section(subject, &mut studio);
    let page = Page {
        title: format!("{} compared with {}", versions.other, subject.name),
        introduction: vec![format!(
            "Where {} differs from {}, and at which scale. The difference is decomposed into bands W_j, its parts of width about σ_j, \
             and the rest S_J, which is wider; their sum is the difference.",
            versions.other, subject.name
        )],
        sections: vec![section, bands_section],
        footer: format!("Made by adwave {} with `{}`.", env!("CARGO_PKG_VERSION"), subject.command),
    };
    let n_pictures = studio.n_pictures() + other.n_pictures();
    Ok(DifferenceReport { page, bands, n_pictures })
}
