//! Saliency section: places where the signal stands out over all levels.

use super::Subject;
use super::drawing::{FieldLook, PictureSpec, Scale, Studio};
use super::place::{Patch, Places, patches, vertex_of};
use crate::analysis::{SignedMap, signed_saliency};
use crate::page::{Block, Section};
use crate::table::{NONE, Table};
use adwave::signal::OutwardInfo;
use adwave_render::value_range;
use std::time::Instant;

/// Share of the vertices that count as salient.
const TOP: f64 = 0.05;
/// Largest value of a map, in means of a level, below which the map consists of rounding errors.
const NOTHING: f64 = 1e-9;
/// Largest number of patches in the table.
const MAX_PATCHES: usize = 8;

/// Statistics of the saliency map.
#[derive(Clone, Debug, PartialEq)]
pub struct SaliencySummary {
    /// Vertex with the largest value; `None` for a constant map.
    pub vertex: Option<usize>,
    /// Largest value of the map.
    pub largest: f64,
    /// Number of patches that the most salient 5 % of the vertices form.
    pub n_patches: usize,
    /// Share of the sum of the map that lies in these patches.
    pub top_share: f64,
    /// Seconds spent on the computation.
    pub seconds: f64,
}

pub(crate) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> (Section, Option<SaliencySummary>) {
    let mut section = Section::new("saliency", "Saliency");
    let start = Instant::now();
    let found = signed_saliency(subject.decomposer, subject.bands, subject.is_geometry(), subject.normals);
    let SignedMap { map, is_signed, outward } = match found {
        Ok(found) => found,
        Err(why) => {
            section.note(format!("No map: {why}."));
            return (section, None);
        }
    };
    let map = subject.without_missing(map);
    let seconds = start.elapsed().as_secs_f64();
    describe_map(&mut section, outward.as_ref(), is_signed);
    let by_class = subject.decomposer.vertex_map().mean(&map, 1);
    let sum: f64 = by_class.iter().filter(|v| v.is_finite()).map(|v| v.max(0.0)).sum();
    let threshold = value_range(&by_class, 0.0, 1.0 - TOP).1;
    let found = patches(subject, &by_class, threshold);
    // The rounding errors of a signal without details are not salient.
    let largest = by_class.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest <= NOTHING || found.is_empty() {
        section.note("The map is constant: nothing stands out.");
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
    let position = |class: usize| subject.decomposer.positions().get(class).copied();
    let at = match (&places, position(peak)) {
        (Some(places), Some(p)) => {
            format!(", at ({}), {} of the shape", subject.position(p), places.words(&p))
        }
        _ => String::new(),
    };
    section.say(format!(
        "The map is largest at {} {}{at}. The most salient {:.0} % of the {} have {:.0} % of the sum of all positive values; they form {}.",
        subject.vertex(),
        subject.place(vertex),
        100.0 * TOP,
        subject.vertices(),
        100.0 * top / sum,
        if found.len() == 1 { "one patch".to_owned() } else { format!("{} patches", found.len()) }
    ));
    section.gallery(pictures(subject, studio, &map, is_signed));
    section.push(Block::Table(patch_table(subject, places.as_ref(), &found, sum)));
    let summary = SaliencySummary {
        vertex: Some(vertex),
        largest: by_class[peak],
        n_patches: found.len(),
        top_share: top / sum,
        seconds,
    };
    (section, Some(summary))
}

/// Adds the definition of the map, and the orientation of the normals.
fn describe_map(section: &mut Section, outward: Option<&OutwardInfo>, is_signed: bool) {
    section.say(format!(
        "The sum of {} over the levels. Each level is divided by the mean of |W_j| and weighted by its unevenness, so that a level on \
         which nothing stands out does not count.",
        match (outward, is_signed) {
            (Some(_), true) =>
                "W_j along the outward normal (positive where the shape is convex at the size of the level, negative where it is concave)",
            (_, true) => "W_j (positive where the signal is above its surroundings, negative where it is below)",
            _ => "|W_j|",
        }
    ));
    if let Some(outward) = outward {
        let words = outward.to_string();
        section.say(if is_signed {
            format!("Orientation: {words}.")
        } else {
            format!("The map is unsigned, since {words}.")
        });
    }
}

fn patch_table(subject: &Subject<'_>, places: Option<&Places>, patches: &[Patch], sum: f64) -> Table {
    let mut table = Table::new(
        "saliency.csv",
        &format!(
            "The strongest patches of the most salient {}, and the {} with the largest value of each{}.",
            subject.vertices(),
            subject.vertex(),
            if places.is_some() {
                ", with its position in the bounding box as seen from the front"
            } else {
                ""
            }
        ),
        &[
            &format!("largest at {}", subject.vertex()),
            "where",
            subject.vertices(),
            "% of the sum",
            "x, y, z",
        ],
    );
    for patch in patches.iter().take(MAX_PATCHES) {
        let p = subject.decomposer.positions().get(patch.peak).copied();
        let none = || NONE.to_owned();
        table.push([
            subject.place(vertex_of(subject, patch.peak)),
            p.zip(places).map_or_else(none, |(p, places)| places.words(&p)),
            patch.n_vertices.to_string(),
            format!("{:.2}", 100.0 * patch.sum / sum),
            p.map_or_else(none, |p| subject.position(p)),
        ]);
    }
    table.drop_empty_columns()
}

fn pictures(
    subject: &Subject<'_>,
    studio: &mut Studio<'_>,
    map: &[f64],
    is_signed: bool,
) -> Result<Vec<crate::page::Figure>, String> {
    let scale = if is_signed { Scale::about_zero(map, 1.0 - TOP) } else { Scale::from_zero(map, 1.0 - TOP) };
    let look = || FieldLook::new(map.to_vec(), "saliency", scale);
    let front = PictureSpec::plain(
        format!("Saliency of {}", subject.name),
        format!(
            "Saliency{}. The most salient {:.0} % of the {} have the last color{}.",
            if is_signed { ", positive in red and negative in blue" } else { "" },
            100.0 * TOP,
            subject.vertices(),
            if is_signed { " of their sign" } else { "" }
        ),
    );
    let back = PictureSpec::plain(
        format!("Saliency of {} from the opposite side", subject.name),
        "The same from the opposite side.",
    );
    studio.draw_both(vec![front.field(look())], vec![back.field(look())])
}
