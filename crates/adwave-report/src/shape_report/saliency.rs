//! Where the signal stands out over all levels.

use super::Subject;
use super::drawing::{FieldLook, Frame, Scale, Studio};
use super::place::{Places, patches, vertex_of};
use crate::analysis::saliency;
use crate::page::{Block, Section};
use crate::table::{NONE, Table};
use adwave::saliency::SaliencyParams;
use adwave_render::value_range;
use std::time::Instant;

/// The part of the vertices that is called salient.
const TOP: f64 = 0.05;
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
    let params = SaliencyParams::default();
    let start = Instant::now();
    let map = match saliency(subject.walk, subject.bands, &params) {
        Ok(saliency) => saliency.map,
        Err(why) => {
            section.note(format!("There is no map: {why}."));
            return (section, None);
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    section.say(format!(
        "The sum of |W_j| over the levels from {} on, each weighed by (max − mean)², so that levels with few strong places \
         count most. Only where it is large matters, not how large: its unit is that of the signal, cubed.",
        params.skip + 1
    ));
    let by_class = subject.walk.geometry().vertex_map().mean(&map, 1);
    let sum: f64 = by_class.iter().filter(|v| v.is_finite()).sum();
    let threshold = value_range(&by_class, 0.0, 1.0 - TOP).1;
    let found = patches(subject, &by_class, threshold);
    // What rounding leaves of a signal without details is no place that stands out.
    let size = subject.values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    if sum <= (1e-12 * size).powi(3) || found.is_empty() {
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
    let position = |class: usize| subject.walk.geometry().points().get(class).copied();
    let at = match (&places, position(peak)) {
        (Some(places), Some(p)) => {
            format!(", at ({}), {} of the shape", subject.position(p), places.words(&p))
        }
        _ => String::new(),
    };
    section.say(format!(
        "It is largest at {} {vertex}{at}. The most salient {:.0} % of the {} hold {:.0} % of the map's sum; they form {}.",
        subject.vertex(),
        100.0 * TOP,
        subject.vertices(),
        100.0 * top / sum,
        if found.len() == 1 { "one patch".to_owned() } else { format!("{} patches", found.len()) }
    ));
    section.gallery(pictures(subject, studio, &map));
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
            "% of the map's sum",
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
) -> Result<Vec<crate::page::Figure>, String> {
    let scale = Scale::from_zero(map, 1.0 - TOP);
    let look = || FieldLook::new(map.to_vec(), "saliency", scale);
    let front = Frame::plain(
        format!("Saliency of {}", subject.name),
        format!("Saliency; the most salient {:.0} % of the vertices all have the last colour.", 100.0 * TOP),
    );
    let back = Frame::plain(
        format!("Saliency of {} from the opposite side", subject.name),
        "The same from the opposite side.",
    );
    studio.draw_both(vec![front.field(look())], vec![back.field(look())])
}
