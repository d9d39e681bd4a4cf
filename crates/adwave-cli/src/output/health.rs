//! Health of a shape as JSON.

use adwave::shape::{Health, NormalCheck, NormalSigns, Shape};
use serde_json::{Value, json};

/// `mesh`, `cloud` or `graph`.
pub(crate) fn kind_name(shape: &Shape) -> &'static str {
    match shape {
        Shape::Mesh(_) => "mesh",
        Shape::Cloud(_) => "cloud",
        Shape::Graph(_) => "graph",
    }
}

/// Check of the given normals of a cloud.
pub(crate) fn given_normals_json(check: &NormalCheck) -> Value {
    let signs = match check.signs {
        NormalSigns::AsGiven => "as given",
        NormalSigns::Repaired => "repaired",
        _ => "unoriented",
    };
    json!({
        "signs": signs, "agreement": check.agreement, "turned": check.n_turned, "parts": check.n_parts,
        "inward_parts": check.n_inward,
    })
}

/// All counts of a shape's health.
pub(crate) fn health_json(health: &Health) -> Value {
    json!({
        "vertices": health.n_vertices,
        "faces": health.n_faces,
        "polygons": health.n_polygons,
        "edges": health.n_edges,
        "components": health.n_components,
        "boundary_edges": health.n_boundary_edges,
        "non_manifold_edges": health.n_non_manifold_edges,
        "misoriented_edges": health.n_misoriented_edges,
        "zero_area_faces": health.n_zero_area_faces,
        "repeated_faces": health.n_repeated_faces,
        "welded_vertices": health.n_welded,
        "isolated_vertices": health.n_isolated,
        "unreferenced_vertices": health.n_unreferenced,
        "closed": health.is_closed(),
        "area": health.area,
        "volume": health.volume,
        "euler_characteristic": health.euler_characteristic,
    })
}
