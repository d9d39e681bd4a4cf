//! Where the signal stands out over all levels.

use super::Subject;
use super::drawing::{FieldLook, Frame, Scale, Studio};
use super::place::{Places, patches, vertex_of};
use crate::analysis::{SignedMap, signed_saliency};
use crate::page::{Block, Section};
use crate::table::{NONE, Table};
use adwave_render::value_range;
use std::time::Instant;

/// The part of the vertices that is called salient.
const TOP: f64 = 0.05;
/// A map that nowhere is larger than this, in means of a level, is rounding.
const NOTHING: f64 = 1e-9;
/// Patches that are listed.
const MAX_PATCHES: usize = 8;

/// The saliency map in short.
#[derive(Clone, Debug, PartialEq)]
pub struct SaliencySummary {
    /// The vertex where it is largest; none where it is the same everywhere.
    pub vertex: Option<usize>,
    /// Its value there.
    pub largest: f64,
    /// Patches that the most salient twentieth of the vertices forms.
    pub n_patches: usize,
    /// Their share of the map's sum.
    pub top_share: f64,
    /// What the map took.
    pub seconds: f64,
}

pub(crate) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> (Section, Option<SaliencySummary>) {
    let mut section = Section::new("saliency", "Saliency");
    let start = Instant::now();
    let found = signed_saliency(subject.decomposer, subject.bands, subject.is_geometry(), subject.normals);
    let SignedMap { map, is_signed, outward } = match found {
        Ok(found) => found,
        Err(why) => {
            section.note(format!("There is no map: {why}."));
            return (section, None);
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    section.say(format!(
        "The sum of {} over the levels, each in means of |W_j| and weighed by how unevenly it is spread, so that a level on which \
         nothing stands out says nothing.",
        match (&outward, is_signed) {
            (Some(_), true) =>
                "W_j along the outward normal: above 0 where the shape is convex at the size of the level, below where it is concave,",
            (_, true) => "W_j: above 0 where the signal is above its surroundings, below where it is below,",
            _ => "|W_j|",
        }
    ));
    if let Some(outward) = &outward {
        let words = outward.to_string();
        section.say(if is_signed {
            format!("How the outside was found: {words}.")
        } else {
            format!("The map has no sign, as {words}.")
        });
    }
    let by_class = subject.decomposer.geometry().vertex_map().mean(&map, 1);
    let sum: f64 = by_class.iter().filter(|v| v.is_finite()).map(|v| v.max(0.0)).sum();
    let threshold = value_range(&by_class, 0.0, 1.0 - TOP).1;
    let found = patches(subject, &by_class, threshold);
    // What rounding leaves of a signal without details is no place that stands out.
    let largest = by_class.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest <= NOTHING || found.is_empty() {
        section.note("The map is the same everywhere: nothing stands out.");
        return (
            section,
            Some(SaliencySummary { vertex: None, largest: 0.0, n_patches: 0, top_share: 0.0, seconds }),
        );
    }
    let top: f64 = found.iter().map(|p| p.sum).sum();
    let peak =
        found.iter().map(|p| p.peak).max_by(|&a, &b| by_class[a].total_cmp(&by_class[b])).expect("a patch");
    let vertex = vertex_of(subject, peak);
    let places = Places::new(subject, studio.up());
    let position = |class: usize| subject.decomposer.geometry().points().get(class).copied();
    let at = match (&places, position(peak)) {
        (Some(places), Some(p)) => {
            format!(", at ({}), {} of the shape", subject.position(p), places.words(&p))
        }
        _ => String::new(),
    };
    section.say(format!(
        "It is largest at {} {vertex}{at}. The most salient {:.0} % of the {} hold {:.0} % of the sum of what is above 0; they form {}.",
        subject.vertex(),
        100.0 * TOP,
        subject.vertices(),
        100.0 * top / sum,
        if found.len() == 1 { "one patch".to_owned() } else { format!("{} patches", found.len()) }
    ));
    section.gallery(pictures(subject, studio, &map, is_signed));
    let mut table = Table::new(
        "saliency.csv",
        &format!(
            "The strongest patches of the most salient {}, and the {} where each is largest{}.",
            subject.vertices(),
            subject.vertex(),
            if places.is_some() { ", with its place in the bounding box as seen from the front" } else { "" }
        ),
        &[
            &format!("largest at {}", subject.vertex()),
            "where",
            subject.vertices(),
            "% of the sum",
            "x, y, z",
        ],
    );
    for patch in found.iter().take(MAX_PATCHES) {
        let p = position(patch.peak);
        let none = || NONE.to_owned();
        table.push([
            vertex_of(subject, patch.peak).to_string(),
            p.zip(places.as_ref()).map_or_else(none, |(p, places)| places.words(&p)),
            patch.n_vertices.to_string(),
            format!("{:.2}", 100.0 * patch.sum / sum),
            p.map_or_else(none, |p| subject.position(p)),
        ]);
    }
    section.push(Block::Table(table.without_empty_columns()));
    let summary = SaliencySummary {
        vertex: Some(vertex),
        largest: by_class[peak],
        n_patches: found.len(),
        top_share: top / sum,
        seconds,
    };
    (section, Some(summary))
}

fn pictures(
    subject: &Subject<'_>,
    studio: &mut Studio<'_>,
    map: &[f64],
    is_signed: bool,
) -> Result<Vec<crate::page::Figure>, String> {
    let scale = if is_signed { Scale::about_zero(map, 1.0 - TOP) } else { Scale::from_zero(map, 1.0 - TOP) };
    let look = || FieldLook::new(map.to_vec(), "saliency", scale);
    let front = Frame::plain(
        format!("Saliency of {}", subject.name),
        format!(
            "Saliency{}; the most salient {:.0} % of the vertices all have the last color{}.",
            if is_signed { ", red above 0 and blue below" } else { "" },
            100.0 * TOP,
            if is_signed { " of their side" } else { "" }
        ),
    );
    let back = Frame::plain(
        format!("Saliency of {} from the opposite side", subject.name),
        "The same from the opposite side.",
    );
    studio.draw_both(vec![front.field(look())], vec![back.field(look())])
}
