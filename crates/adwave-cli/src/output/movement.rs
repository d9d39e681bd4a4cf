//! Movement of a shape: how far its vertices moved, and how its length, area and volume changed.

use super::{note, number};
use crate::error::CliError;
use crate::global::Global;
use adwave::Progress;
use adwave::filter::{Displacement, displacement};
use adwave::shape::{PreparedGeometry, curve_length, encloses_volume};
use adwave_io::ShapeFile;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::fmt::Write;

/// Distance in widths of the widest level beyond which a note says that a vertex moved far.
const FAR: f64 = 3.0;

/// Relative change of the volume beyond which a note reports it.
const LARGE_CHANGE: f64 = 0.5;

/// Exponent range of sizes whose squares and cubes neither vanish nor overflow.
const MODERATE_EXPONENT: f64 = 32.0;

/// Positions in a unit; for unit 1 without a copy.
fn in_units(points: &[[f64; 3]], unit: f64) -> Cow<'_, [[f64; 3]]> {
    if unit == 1.0 {
        return Cow::Borrowed(points);
    }
    points.iter().map(|p| p.map(|c| c / unit)).collect()
}

/// Change between a shape and its new positions.
pub(crate) struct Movement {
    moved: Displacement,
    diagonal: f64,
    /// Total length of the edges before and after, of a curve or graph.
    lengths: Option<MeasureChange>,
    /// Area before and after, of a shape with faces.
    areas: Option<MeasureChange>,
    /// Volume before and after, if the surface encloses one.
    volumes: Option<MeasureChange>,
}

/// A size before and after in model units, and the change relative to the size before; none if that is 0.
#[derive(Clone, Copy)]
struct MeasureChange {
    before: f64,
    after: f64,
    share: Option<f64>,
}

impl MeasureChange {
    /// The change between sizes in a unit that is `unit` in model units. The sizes may underflow or overflow in model
    /// units; the share does not.
    fn new(before: f64, after: f64, unit: f64) -> Self {
        let share = Some((after - before) / before).filter(|share| share.is_finite());
        Self { before: before * unit, after: after * unit, share }
    }
}

impl Movement {
    /// Movement to new positions, in the order of the shape.
    ///
    /// # Errors
    /// A vertex moved farther than a number can represent, or the shape has no positions.
    pub(crate) fn measure(geometry: &PreparedGeometry, points: &[[f64; 3]]) -> Result<Self, CliError> {
        let shape = geometry.shape();
        let diagonal = geometry.extent();
        // Lengths in a unit of the size of the shape, so that squares neither vanish nor overflow; a power of two
        // rounds nothing.
        let exponent = if diagonal > 0.0 { diagonal.log2().floor() } else { 0.0 };
        let unit = if exponent.abs() <= MODERATE_EXPONENT { 1.0 } else { exponent.exp2() };
        let Some(before) = shape.points().filter(|before| before.len() == points.len()) else {
            return Err(CliError::Input(
                "the coordinates of a graph must be finite to be changed; repair them, or choose a --signal"
                    .to_owned(),
            ));
        };
        let moved = displacement(&in_units(before, unit), &in_units(points, unit));
        let moved = Displacement { rms: moved.rms * unit, max: moved.max * unit, ..moved };
        if !moved.max.is_finite() {
            return Err(CliError::Input(format!(
                "vertex {} would move beyond the range of numbers; check whether such large gains are meant",
                moved.furthest
            )));
        }
        let mut this = Self { moved, diagonal, lengths: None, areas: None, volumes: None };
        if let Some(graph) = shape.as_graph() {
            let length = |points: &[[f64; 3]]| curve_length(graph, &in_units(points, unit));
            this.lengths = Some(MeasureChange::new(length(before), length(points), unit));
        }
        if geometry.faces().is_empty() {
            return Ok(this);
        }
        let after = geometry.vertex_map().positions(points);
        let (before, after) = (in_units(geometry.points(), unit), in_units(&after, unit));
        let area = |points: &[[f64; 3]]| geometry.area_of(points);
        this.areas = Some(MeasureChange::new(area(&before), area(&after), unit.powi(2)));
        if encloses_volume(geometry, Progress::none()).is_ok_and(|encloses| encloses) {
            let volume = |points: &[[f64; 3]]| geometry.volume_of(points);
            this.volumes = Some(MeasureChange::new(volume(&before), volume(&after), unit.powi(3)));
        }
        Ok(this)
    }

    /// The movement with the row of the file of the vertex that moved furthest, instead of its number in the shape.
    pub(crate) fn in_file_rows(mut self, file: &ShapeFile) -> Self {
        if self.moved.furthest < file.n_vertices() {
            self.moved.furthest = file.file_row(self.moved.furthest);
        }
        self
    }

    /// Prints a note if an edit of bands changed the shape unusually much: vertices moved farther than a few times
    /// `sigma`, the width of the widest level, or half of the volume changed.
    pub(crate) fn note_unusual(&self, sigma: f64, global: &Global<'_>) {
        if sigma > 0.0 && self.moved.max > FAR * sigma {
            let said = format!(
                "vertex {} moved by {}, {:.0} times the widest σ; check whether the levels are meant for a shape in this unit",
                self.moved.furthest,
                number(self.moved.max),
                self.moved.max / sigma
            );
            note(global, &said);
        }
        if let Some(MeasureChange { before, after, share: Some(share) }) = self.volumes
            && share.abs() > LARGE_CHANGE
        {
            note(global, &format!("the volume changed from {} to {}", number(before), number(after)));
        }
    }

    /// Lines for people.
    pub(crate) fn describe(&self, text: &mut String) {
        let Self { moved, diagonal, .. } = self;
        let percent = |length: f64| number(if *diagonal > 0.0 { 100.0 * length / diagonal } else { 0.0 });
        if moved.max == 0.0 {
            text.push_str("no vertex moved\n");
        } else {
            let _ = writeln!(
                text,
                "vertices moved by {} (rms, {} % of the diagonal), at most {} ({} %) at vertex {}",
                number(moved.rms),
                percent(moved.rms),
                number(moved.max),
                percent(moved.max),
                moved.furthest,
            );
        }
        for (name, change) in [("length", self.lengths), ("area", self.areas), ("volume", self.volumes)] {
            let Some(MeasureChange { before, after, share }) = change else { continue };
            let share = share.map_or_else(String::new, |share| format!(" ({:+.3} %)", 100.0 * share));
            let _ = writeln!(text, "{name} {} → {}{share}", number(before), number(after));
        }
    }

    /// Adds `moved`, `area` and `volume` to a report, and `length` for a curve or graph.
    pub(crate) fn add_to(&self, report: &mut Value) {
        let Self { moved, diagonal, .. } = self;
        let diagonal = diagonal.max(f64::MIN_POSITIVE);
        report["moved"] = json!({
            "rms": moved.rms, "max": moved.max, "furthest_vertex": moved.furthest,
            "rms_percent": 100.0 * moved.rms / diagonal,
            "max_percent": 100.0 * moved.max / diagonal,
        });
        for (name, change) in [("area", self.areas), ("volume", self.volumes)] {
            report[name] = json!(
                change.map(|MeasureChange { before, after, .. }| json!({"before": before, "after": after}))
            );
        }
        if let Some(MeasureChange { before, after, .. }) = self.lengths {
            report["length"] = json!({"before": before, "after": after});
        }
    }
}
