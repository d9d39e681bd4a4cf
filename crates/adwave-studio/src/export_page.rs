//! Export of a self-contained HTML file with the shape, its bands and working sliders.

use crate::prepared_shape::PreparedShape;
use crate::response::{ApiError, ApiResult, bytes_response};
use crate::session::Session;
use adwave_simplify::{MeshParams, MeshTarget, simplify_mesh};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::json;
use std::io::Write;

/// Largest number of vertices in the file; larger shapes are reduced to this number.
const MAX_VERTICES: usize = 200_000;
/// Script of the file.
const SCRIPT: &str = include_str!("../web/dist/viewer.js");
/// Style sheet of the file.
const STYLE: &str = include_str!("../web/dist/viewer.css");
/// Content security policy, by which the file loads nothing.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:";

/// Vertices of the shape that are in the file, and the triangles between them.
struct ExportedShape {
    /// Indices of vertices of the original shape, increasing.
    vertices: Vec<u32>,
    /// Triangles as indices into `vertices`.
    triangles: Vec<[u32; 3]>,
}

impl ExportedShape {
    /// Turns over the triangles of the parts that the edit turns.
    fn with_turned_parts(self, prepared: &PreparedShape) -> Result<Self, ApiError> {
        if prepared.bands.document.turned.is_empty() {
            return Ok(self);
        }
        let Self { vertices, mut triangles } = self;
        let of_shape = |triangle: &[u32; 3]| triangle.map(|v| vertices[v as usize]);
        let before: Vec<[u32; 3]> = triangles.iter().map(of_shape).collect();
        let after = prepared.turned_triangles(&before)?;
        for (triangle, (before, after)) in triangles.iter_mut().zip(before.iter().zip(&after)) {
            if before != after {
                triangle.swap(1, 2);
            }
        }
        Ok(Self { vertices, triangles })
    }
}

/// Responds with the HTML file of the current edit.
pub(crate) fn export_page(session: &Session) -> ApiResult {
    if session.shape.is_graph() {
        let name = &session.workspace.name;
        return Err(ApiError::bad_request(format!(
            "the page with sliders shows surfaces and clouds, and {name} is a graph; save it, or download a picture"
        )));
    }
    let exported = select_vertices(session)?;
    let prepared = session.lock_prepared()?;
    let exported = exported.with_turned_parts(&prepared)?;
    let content = encode_content(session, &prepared, &exported);
    drop(prepared);
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(&content).map_err(|e| ApiError::bad_request(e.to_string()))?;
    let packed = STANDARD.encode(packed.finish().map_err(|e| ApiError::bad_request(e.to_string()))?);
    let name = escape_html(&session.workspace.name);
    let html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{name}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <div id=\"viewer\"></div>\n<script id=\"shape\" type=\"text/plain\">{packed}</script>\n<script>{SCRIPT}</script>\n</body>\n</html>\n"
    );
    Ok(bytes_response(html))
}

fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Selects all vertices of a small shape, or a subset of [`MAX_VERTICES`] of a large one.
fn select_vertices(session: &Session) -> Result<ExportedShape, ApiError> {
    let n = session.points().len();
    if n <= MAX_VERTICES {
        return Ok(ExportedShape { vertices: (0..n as u32).collect(), triangles: session.triangles.clone() });
    }
    let Some(mesh) = session.shape.as_mesh() else {
        let step = n.div_ceil(MAX_VERTICES);
        return Ok(ExportedShape { vertices: (0..n as u32).step_by(step).collect(), triangles: Vec::new() });
    };
    let params = MeshParams::new(MeshTarget::Vertices(MAX_VERTICES));
    let params = params.with_measure(false).with_nearest_faces(false);
    let simplified =
        simplify_mesh(mesh, None, &params, session.progress()).map_err(|e| ApiError::from_classified(&e))?;
    Ok(ExportedShape { vertices: simplified.kept, triangles: simplified.triangles })
}

/// Encodes the content: the length of a JSON header (`u32`), the header, positions `f32 × 3 × n`, triangles
/// `u32 × 3 × m`, bands `i16 × 3 × n` from fine to coarse, and masks of the layers `u8 × n`. Each array begins at a
/// multiple of 4 bytes.
fn encode_content(session: &Session, prepared: &PreparedShape, exported: &ExportedShape) -> Vec<u8> {
    let (points, map) = (session.points(), prepared.bands.decomposer.vertex_map());
    let n_levels = prepared.bands.n_levels();
    let bands: Vec<(f32, Vec<u8>)> = (1..=n_levels).map(|level| prepared.encode_band(level)).collect();
    let mut masks = Vec::new();
    let active = prepared.bands.document.layers.iter().filter(|layer| layer.on);
    let layers: Vec<_> = active
        .zip(prepared.layer_weights())
        .map(|(layer, weights)| {
            let mask = layer.region.is_some().then(|| {
                let weights = weights.to_vertices(map);
                masks.push(
                    exported
                        .vertices
                        .iter()
                        .map(|&x| (255.0 * weights[x as usize]).round() as u8)
                        .collect::<Vec<_>>(),
                );
                masks.len() - 1
            });
            json!({"name": layer.name, "opacity": layer.opacity, "gains": layer.gains, "mask": mask})
        })
        .collect();
    let head = json!({
        "name": session.workspace.name,
        "n_vertices": exported.vertices.len(),
        "n_triangles": exported.triangles.len(),
        "n_vertices_before": points.len(),
        "levels": prepared.bands.level_infos(),
        "scales": bands.iter().map(|band| band.0).collect::<Vec<_>>(),
        "layers": layers,
        "n_masks": masks.len(),
        "rules": prepared.bands.document.has_constraints(session.triangles.is_empty())
            || !prepared.bands.document.reshaped_by().is_neutral(),
    });
    let head = head.to_string();
    let mut out = (head.len() as u32).to_le_bytes().to_vec();
    out.extend(head.bytes());
    let align = |out: &mut Vec<u8>| out.resize(out.len().next_multiple_of(4), 0);
    align(&mut out);
    for &x in &exported.vertices {
        for (c, center) in points[x as usize].iter().zip(session.center) {
            out.extend(((c - center) as f32).to_le_bytes());
        }
    }
    out.extend(exported.triangles.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    for (_, values) in &bands {
        let rows: &[[u8; 8]] = values.as_chunks().0;
        out.extend(exported.vertices.iter().flat_map(|&x| &rows[x as usize][..6]));
        align(&mut out);
    }
    for mask in masks {
        out.extend(mask);
        align(&mut out);
    }
    out
}
