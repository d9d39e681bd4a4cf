//! Two shapes side by side, with lines between their pairs.

use super::{MatchArgs, Matching, Side};
use crate::error::CliError;
use crate::global::Global;
use crate::output::write_file;
use crate::resolve::up::UpAxis;
use adwave::shape::{Shape, triangulate};
use adwave_register::{Motion, Pair};
use adwave_render::{Ball, Paint, RenderParams, Surface, render};
use std::path::Path;

/// Half the thickness of a line, as a share of the diagonal.
const THICKNESS: f64 = 0.001;
/// Most lines that are drawn: those of the highest confidence.
const MAX_LINES: usize = 120;
/// Most boxes of equal motions that are drawn.
const MAX_BOXES: usize = 9;
/// Pairs of corners of a box that differ in one axis.
const BOX_EDGES: [(usize, usize); 12] =
    [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)];
/// Empty space between the shapes, as a share of their width.
const GAP: f64 = 0.15;

/// Draws SHAPE after the motion to the left of OTHER, and the lines. If several motions fit equally well, the box of
/// SHAPE is drawn where each of them puts it on OTHER.
pub(super) fn write(
    path: &Path,
    args: &MatchArgs,
    sides: [&Side; 2],
    found: &Matching,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let [first, second] = sides;
    let motion = found.motion().map_or_else(Motion::default, |found| found.motion);
    let moved: Vec<[f64; 3]> =
        first.input.shape.points().unwrap_or_default().iter().map(|p| motion.apply(p)).collect();
    let others = second.input.shape.points().unwrap_or_default();
    let up = UpAxis::choose(args.up, &second.input).up;
    let params = RenderParams::default().with_size(1600, 900).with_view(args.view).with_up(up);
    let offset = offset_to_left(&moved, others, args.view.right(up));
    let left: Vec<[f64; 3]> = moved.iter().map(|p| std::array::from_fn(|k| p[k] + offset[k])).collect();
    let points = [&left[..], others].concat();
    let mut triangles = triangles(&first.input.shape);
    let n_left = left.len() as u32;
    let n_triangles = [triangles.len(), self::triangles(&second.input.shape).len()];
    triangles.extend(self::triangles(&second.input.shape).into_iter().map(|t| t.map(|v| v + n_left)));
    // Discs are drawn only if there are no triangles, so a mesh beside a cloud loses its triangles.
    if n_triangles.contains(&0) {
        triangles.clear();
    }
    let mut by_confidence: Vec<&Pair> = found.pairs.iter().collect();
    by_confidence.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    let radius = THICKNESS * adwave::shape::diagonal(&points);
    let line = |(k, pair): (usize, &&Pair)| {
        let from = motion.apply(&first.features().features[pair.first].position?);
        let to = second.features().features[pair.second].position?;
        let from = std::array::from_fn(|c| from[c] + offset[c]);
        Some(beads(&from, &to, radius, color((k as f64 * GOLDEN).fract())))
    };
    let mut lines: Vec<Ball> =
        by_confidence.iter().take(MAX_LINES).enumerate().filter_map(line).flatten().collect();
    if !found.equal().is_empty() {
        let corners = box_corners(first.input.shape.points().unwrap_or_default());
        for (k, other) in found.motion().into_iter().chain(found.equal()).take(MAX_BOXES).enumerate() {
            let corners = corners.map(|p| other.motion.apply(&p));
            let edge = |&(a, b): &(usize, usize)| beads(&corners[a], &corners[b], 2.0 * radius, box_color(k));
            lines.extend(BOX_EDGES.iter().flat_map(edge));
        }
    }
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::CLAY };
    let picture = render(&surface, &lines, &params, global.progress())?;
    let png = picture.png()?;
    write_file(global, path, &png)
}

/// Corners of the bounding box; corner k is at the end of axis c if bit c of k is set.
fn box_corners(points: &[[f64; 3]]) -> [[f64; 3]; 8] {
    let ends = points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [std::array::from_fn(|c| low[c].min(p[c])), std::array::from_fn(|c| high[c].max(p[c]))]
    });
    std::array::from_fn(|k| std::array::from_fn(|c| ends[(k >> c) & 1][c]))
}

/// Color of the box of a motion: dark for the first, else one of its own.
fn box_color(k: usize) -> [u8; 3] {
    if k == 0 { [30, 30, 30] } else { color((k as f64 * GOLDEN).fract()) }
}

fn triangles(shape: &Shape) -> Vec<[u32; 3]> {
    match shape {
        Shape::Mesh(mesh) => triangulate(mesh.points(), mesh.faces()),
        _ => Vec::new(),
    }
}

/// Offset that moves `points` to the left of `others`, against the direction `right`.
fn offset_to_left(points: &[[f64; 3]], others: &[[f64; 3]], right: [f64; 3]) -> [f64; 3] {
    let along = |p: &[f64; 3]| p.iter().zip(right).map(|(c, r)| c * r).sum::<f64>();
    let last = points.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let (first, end) = others
        .iter()
        .map(along)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let by = first - last - GAP * (end - first);
    right.map(|r| by * r)
}

/// A line as balls that touch.
fn beads(from: &[f64; 3], to: &[f64; 3], radius: f64, color: [u8; 3]) -> Vec<Ball> {
    let length = from.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let n = (length / radius).ceil().clamp(1.0, 4000.0) as usize;
    let at = |k: usize| -> [f64; 3] {
        let t = k as f64 / n as f64;
        std::array::from_fn(|c| (1.0 - t) * from[c] + t * to[c])
    };
    let end = |center: &[f64; 3]| Ball { center: *center, radius: 3.0 * radius, color };
    let between = (0..=n).map(|k| Ball { center: at(k), radius, color });
    between.chain([end(from), end(to)]).collect()
}

/// The golden section: hues that many steps apart never come near each other.
const GOLDEN: f64 = 0.618_034;

/// A saturated color of that hue in [0, 1).
fn color(hue: f64) -> [u8; 3] {
    [0.0, 2.0, 4.0].map(|shift| {
        let k = (6.0 * hue + shift) % 6.0;
        let level = (2.0 - (k - 3.0).abs()).clamp(0.0, 1.0);
        (255.0 * (1.0 - 0.85 * level)) as u8
    })
}
