//! One HTML file with the shape, its bands, and sliders that work without a server.

use crate::answer::{Answer, Refused, bytes};
use crate::prepared::Prepared;
use crate::session::Session;
use adwave::shape::Shape;
use adwave_simplify::{MeshParams, MeshTarget, simplify_mesh};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::json;
use std::io::Write;

/// Vertices up to which a shape is in the file as it is; of larger ones so many.
const MOST: usize = 200_000;
/// Script and style of the file.
const SCRIPT: &str = include_str!("../web/dist/viewer.js");
const STYLE: &str = include_str!("../web/dist/viewer.css");
/// The file may do nothing but show what it has within itself.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:";

/// Which vertices are in the file, and the triangles between them.
struct Part {
    kept: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// The file, for the edit that is kept.
pub(crate) fn page(session: &Session) -> Answer {
    let part = part(session)?;
    let prepared = session.prepared()?;
    let content = content(session, &prepared, &part);
    drop(prepared);
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(&content).map_err(|e| Refused::wrong(e.to_string()))?;
    let packed = STANDARD.encode(packed.finish().map_err(|e| Refused::wrong(e.to_string()))?);
    let name = escaped(&session.opened.name);
    let page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{name}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <div id=\"viewer\"></div>\n<script id=\"shape\" type=\"text/plain\">{packed}</script>\n<script>{SCRIPT}</script>\n</body>\n</html>\n"
    );
    Ok(bytes(page))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// All of the shape, or as many of its own vertices as the file holds.
fn part(session: &Session) -> Result<Part, Refused> {
    let n = session.points().len();
    if n <= MOST {
        return Ok(Part { kept: (0..n as u32).collect(), triangles: session.triangles.clone() });
    }
    let Shape::Mesh(mesh) = &session.opened.shape else {
        let step = n.div_ceil(MOST);
        return Ok(Part { kept: (0..n as u32).step_by(step).collect(), triangles: Vec::new() });
    };
    let params = MeshParams::new(MeshTarget::Vertices(MOST));
    let simplified = simplify_mesh(mesh, None, &params, session.progress()).map_err(|e| Refused::of(&e))?;
    Ok(Part { kept: simplified.kept, triangles: simplified.triangles })
}

/// A head in JSON, its length before it, then positions `f32 × 3 × n`, triangles `u32 × 3 × m`, bands fine to coarse `i16 × 3 × n`, and
/// the masks of the layers `u8 × n`. Each begins at a multiple of 4.
fn content(session: &Session, prepared: &Prepared, part: &Part) -> Vec<u8> {
    let (points, map) = (session.points(), prepared.decomposer.geometry().vertex_map());
    let n_levels = prepared.n_levels();
    let bands: Vec<(f32, Vec<u8>)> = (1..=n_levels).map(|level| prepared.band(level)).collect();
    let mut masks = Vec::new();
    let on = prepared.document.layers.iter().filter(|layer| layer.on);
    let layers: Vec<_> = on
        .zip(prepared.layer_weights())
        .map(|(layer, weights)| {
            let mask = layer.region.is_some().then(|| {
                let weights = weights.to_vertices(map);
                masks.push(
                    part.kept
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
        "name": session.opened.name,
        "n_vertices": part.kept.len(),
        "n_triangles": part.triangles.len(),
        "n_vertices_before": points.len(),
        "levels": prepared.level_list(),
        "scales": bands.iter().map(|band| band.0).collect::<Vec<_>>(),
        "layers": layers,
        "n_masks": masks.len(),
        "rules": prepared.document.has_rules(session.triangles.is_empty()),
    });
    let head = head.to_string();
    let mut out = (head.len() as u32).to_le_bytes().to_vec();
    out.extend(head.bytes());
    let align = |out: &mut Vec<u8>| out.resize(out.len().next_multiple_of(4), 0);
    align(&mut out);
    for &x in &part.kept {
        for (c, center) in points[x as usize].iter().zip(session.center) {
            out.extend(((c - center) as f32).to_le_bytes());
        }
    }
    out.extend(part.triangles.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    for (_, values) in &bands {
        let rows: &[[u8; 8]] = values.as_chunks().0;
        out.extend(part.kept.iter().flat_map(|&x| &rows[x as usize][..6]));
        align(&mut out);
    }
    for mask in masks {
        out.extend(mask);
        align(&mut out);
    }
    out
}
