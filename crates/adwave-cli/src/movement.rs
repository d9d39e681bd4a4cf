//! How far a shape moved, and what became of its area and volume.

use crate::error::CliError;
use crate::global::Global;
use crate::output::{note, number};
use adwave::Progress;
use adwave::filter::{Displacement, displacement};
use adwave::shape::{PreparedGeometry, enclosed_volume, health, one_ring, surface_area};
use serde_json::{Value, json};
use std::fmt::Write;

/// Widths of the widest level beyond which a vertex is said to have moved far.
const FAR: f64 = 3.0;

/// The part of the volume whose change is said to be much.
const MUCH: f64 = 0.5;

/// What changed between a shape and its new positions.
pub(crate) struct Movement {
    moved: Displacement,
    diagonal: f64,
    /// Area before and after, of a shape with faces.
    areas: Option<Change>,
    /// Volume before and after, where the surface encloses one.
    volumes: Option<Change>,
}

/// A size before and after in model units, and the change as a share of the size before; none where that is 0.
#[derive(Clone, Copy)]
struct Change {
    before: f64,
    after: f64,
    share: Option<f64>,
}

impl Change {
    /// From sizes in other units: one of them is `unit` in model units. Those may be too small or large for these sizes,
    /// and the share still holds.
    fn new(before: f64, after: f64, unit: f64) -> Self {
        let share = Some((after - before) / before).filter(|share| share.is_finite());
        Self { before: before * unit, after: after * unit, share }
    }
}

impl Movement {
    /// Of positions in the order of the shape.
    pub(crate) fn new(geometry: &PreparedGeometry, points: &[[f64; 3]]) -> Self {
        let (triangles, shape) = (geometry.triangles(), geometry.shape());
        let diagonal = shape.diagonal();
        // Lengths in a unit of the size of the shape, so that squares neither vanish nor overflow; a power of two rounds nothing.
        let unit = if diagonal > 0.0 { diagonal.log2().floor().exp2() } else { 1.0 };
        let in_units =
            |points: &[[f64; 3]]| -> Vec<[f64; 3]> { points.iter().map(|p| p.map(|c| c / unit)).collect() };
        let moved = displacement(&in_units(shape.points().unwrap_or_default()), &in_units(points));
        let moved = Displacement { rms: moved.rms * unit, max: moved.max * unit, ..moved };
        let mut this = Self { moved, diagonal, areas: None, volumes: None };
        if triangles.is_empty() {
            return this;
        }
        let (before, after) =
            (in_units(geometry.points()), in_units(&geometry.vertex_map().positions(points)));
        let area = |points: &[[f64; 3]]| surface_area(points, triangles);
        this.areas = Some(Change::new(area(&before), area(&after), unit.powi(2)));
        let counted = health(geometry, &one_ring(geometry.n_vertices(), triangles), Progress::none());
        if counted.is_ok_and(|health| health.volume.is_some()) {
            let volume = |points: &[[f64; 3]]| enclosed_volume(points, triangles);
            this.volumes = Some(Change::new(volume(&before), volume(&after), unit.powi(3)));
        }
        this
    }

    /// Refuses positions so far off that no number says how far.
    pub(crate) fn check(&self) -> Result<(), CliError> {
        if self.moved.max.is_finite() {
            return Ok(());
        }
        let vertex = self.moved.furthest;
        Err(CliError::Input(format!(
            "vertex {vertex} would move farther than numbers reach; are gains that large meant?"
        )))
    }

    /// A note where this is hardly a change of bands any more: vertices moved farther than a few widths of the widest, or half of
    /// the volume changed.
    pub(crate) fn warn(&self, sigma: f64, global: &Global<'_>) {
        if sigma > 0.0 && self.moved.max > FAR * sigma {
            let said = format!(
                "vertex {} moved by {}, {:.0} times the widest σ; are the levels those of another shape or unit?",
                self.moved.furthest,
                number(self.moved.max),
                self.moved.max / sigma
            );
            note(global, &said);
        }
        if let Some(Change { before, after, share: Some(share) }) = self.volumes
            && share.abs() > MUCH
        {
            note(global, &format!("the volume changed from {} to {}", number(before), number(after)));
        }
    }

    /// For people, some lines.
    pub(crate) fn describe(&self, text: &mut String) {
        let Self { moved, diagonal, .. } = self;
        let percent = |length: f64| number(if *diagonal > 0.0 { 100.0 * length / diagonal } else { 0.0 });
        let _ = writeln!(
            text,
            "vertices moved by {} (rms over the vertices, {} % of the diagonal), vertex {} furthest: {} ({} %)",
            number(moved.rms),
            percent(moved.rms),
            moved.furthest,
            number(moved.max),
            percent(moved.max),
        );
        for (name, change) in [("area", self.areas), ("volume", self.volumes)] {
            let Some(Change { before, after, share }) = change else { continue };
            let share = share.map_or_else(String::new, |share| format!(" ({:+.3} %)", 100.0 * share));
            let _ = writeln!(text, "{name} {} → {}{share}", number(before), number(after));
        }
    }

    /// For machines: `moved`, `area` and `volume`.
    pub(crate) fn add_to(&self, report: &mut Value) {
        let Self { moved, diagonal, .. } = self;
        let diagonal = diagonal.max(f64::MIN_POSITIVE);
        report["moved"] = json!({
            "rms": moved.rms, "max": moved.max, "furthest_vertex": moved.furthest,
            "rms_percent": 100.0 * moved.rms / diagonal,
            "max_percent": 100.0 * moved.max / diagonal,
        });
        for (name, change) in [("area", self.areas), ("volume", self.volumes)] {
            report[name] =
                json!(change.map(|Change { before, after, .. }| json!({"before": before, "after": after})));
        }
    }
}
