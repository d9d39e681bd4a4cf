//! Health of a shape in lines for people.

use crate::output::{count, number};
use adwave::shape::{Health, Shape};
use std::fmt::Write;

/// Adds the counts that describe a shape, one per line.
pub(super) fn health_lines(text: &mut String, shape: &Shape, health: &Health) {
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<13} {value}");
    };
    line("vertices", health.n_vertices.to_string());
    if shape.is_mesh() {
        let polygons = if health.n_polygons > 0 {
            format!(", {} of them with more than three corners", health.n_polygons)
        } else {
            String::new()
        };
        line("faces", format!("{}{polygons}", health.n_faces));
        let surface = if health.is_closed() { "closed" } else { "open" };
        let volume = health.volume.map_or(String::new(), |v| format!(", volume {}", number(v)));
        let euler =
            health.euler_characteristic.map_or(String::new(), |e| format!(", Euler characteristic {e}"));
        line("surface", format!("{surface}, area {}{volume}{euler}", number(health.area)));
    }
    line("edges", health.n_edges.to_string());
    line("components", (health.n_components - health.n_isolated).to_string());
}

/// Adds a line for each kind of irregularity that the shape has.
pub(super) fn health_notes(text: &mut String, health: &Health) {
    for (n, one, many) in [
        (health.n_boundary_edges, "boundary edge", "boundary edges"),
        (health.n_non_manifold_edges, "edge of three or more faces", "edges of three or more faces"),
        (
            health.n_misoriented_edges,
            "edge whose two faces disagree on the orientation",
            "edges whose two faces disagree on the orientation",
        ),
        (health.n_zero_area_faces, "face without area", "faces without area"),
        (health.n_repeated_faces, "repeated face", "repeated faces"),
        (
            health.n_welded,
            "vertex at the position of another, welded",
            "vertices at the position of another, welded",
        ),
        (
            health.n_isolated,
            "vertex without neighbors, unchanged in every band",
            "vertices without neighbors, unchanged in every band",
        ),
        (health.n_unreferenced, "vertex of no face", "vertices of no face"),
    ] {
        if n > 0 {
            let _ = writeln!(text, "  note          {}", count(n, one, many));
        }
    }
}
