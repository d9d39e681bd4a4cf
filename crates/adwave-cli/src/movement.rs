//! How far a shape moved, and what became of its area and volume.

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
    areas: Option<(f64, f64)>,
    /// Volume before and after, where the surface encloses one.
    volumes: Option<(f64, f64)>,
}

impl Movement {
    /// Of positions in the order of the shape.
    pub(crate) fn new(geometry: &PreparedGeometry, points: &[[f64; 3]]) -> Self {
        let triangles = geometry.triangles();
        let shape = geometry.shape();
        let moved = displacement(shape.points().unwrap_or_default(), points);
        let mut this = Self { moved, diagonal: shape.diagonal(), areas: None, volumes: None };
        if triangles.is_empty() {
            return this;
        }
        let after = geometry.vertex_map().positions(points);
        this.areas = Some((surface_area(geometry.points(), triangles), surface_area(&after, triangles)));
        let counted = health(geometry, &one_ring(geometry.n_vertices(), triangles), Progress::none());
        let volume = counted.ok().and_then(|health| health.volume);
        this.volumes = volume.map(|before| (before, enclosed_volume(&after, triangles)));
        this
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
        if let Some((before, after)) = self.volumes
            && (after - before).abs() > MUCH * before.abs()
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
            "vertices moved by {} (rms, {} % of the diagonal), vertex {} furthest: {} ({} %)",
            number(moved.rms),
            percent(moved.rms),
            moved.furthest,
            number(moved.max),
            percent(moved.max),
        );
        for (name, pair) in [("area", self.areas), ("volume", self.volumes)] {
            if let Some((before, after)) = pair {
                let change = 100.0 * (after - before) / before;
                let _ = writeln!(text, "{name} {} → {} ({change:+.3} %)", number(before), number(after));
            }
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
        for (name, pair) in [("area", self.areas), ("volume", self.volumes)] {
            report[name] = json!(pair.map(|(before, after)| json!({"before": before, "after": after})));
        }
    }
}
