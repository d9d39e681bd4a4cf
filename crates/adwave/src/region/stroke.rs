//! Course of a line drawn over a surface.

use super::SurfaceMetric;
use crate::parallel;
use crate::shape::{Adjacency, distance, squared_distance};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;

/// Vertices next to a polyline with their distances from it, as the start of a search along the surface.
///
/// The line between two points is straight. Where the surface curves away from it, the line is moved onto the
/// surface along the normal at the nearest vertex, segment by segment, so that the sagitta does not count as
/// distance.
pub(super) fn sources(
    metric: &SurfaceMetric,
    neighbors: &Adjacency,
    spacing: f64,
    path: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<(usize, f64)>, Cancelled> {
    let (points, normals) = (metric.geometry().points(), metric.normals(progress)?);
    let on_surface = |p: &[f64; 3]| -> (usize, [f64; 3]) {
        let vertex = metric.nearest(p).expect("a line is drawn over positions");
        let (p, normal) =
            (Vector3::from(*p), normals.get(vertex).map_or_else(Vector3::zeros, |n| (*n).into()));
        let lift = normal.dot(&(Vector3::from(points[vertex]) - p));
        (vertex, (p + lift * normal).into())
    };
    let mut places: Vec<[f64; 3]> = path.first().copied().into_iter().collect();
    for ends in path.windows(2) {
        let segments = (distance(&ends[0], &ends[1]) / spacing.max(f64::MIN_POSITIVE)).ceil();
        let segments = segments.clamp(1.0, MAX_SEGMENTS) as usize;
        let place = |t: f64| std::array::from_fn(|c| ends[0][c] + t * (ends[1][c] - ends[0][c]));
        places.extend((1..=segments).map(|k| place(k as f64 / segments as f64)));
    }
    // A point off the surface has many nearest locations at about the same distance; each costs about 20 µs.
    let line = parallel::map_items(points.len(), places.len(), |k| {
        progress.check().map(|()| on_surface(&places[k]))
    });
    let line = line.into_iter().collect::<Result<Vec<_>, _>>()?;
    if let [(vertex, place)] = line[..] {
        return Ok(ball(points, neighbors, vertex, &place));
    }
    let mut sources = Vec::new();
    for (k, &(vertex, _)) in line.iter().enumerate() {
        let around = &line[k.saturating_sub(1)..(k + 2).min(line.len())];
        for y in std::iter::once(vertex).chain(neighbors.row(vertex).iter().map(|&y| y as usize)) {
            let away = match around {
                [(_, only)] => squared_distance(&points[y], only),
                _ => around
                    .windows(2)
                    .map(|s| squared_distance_to_segment(&points[y], &s[0].1, &s[1].1))
                    .fold(f64::INFINITY, f64::min),
            };
            sources.push((y, away.sqrt()));
        }
    }
    Ok(sources)
}

/// Vertices around one location, as far as straight lines over two edges reach: those within one edge of the vertex
/// nearest to it, and, if the location is that vertex, those within two edges, as in a search from the vertex.
fn ball(points: &[[f64; 3]], neighbors: &Adjacency, vertex: usize, place: &[f64; 3]) -> Vec<(usize, f64)> {
    if points[vertex] == *place {
        return vec![(vertex, 0.0)];
    }
    let around = std::iter::once(vertex).chain(neighbors.row(vertex).iter().map(|&y| y as usize));
    let mut near: Vec<usize> =
        around.clone().chain(around.flat_map(|y| neighbors.row(y).iter().map(|&z| z as usize))).collect();
    near.sort_unstable();
    near.dedup();
    near.into_iter().map(|y| (y, distance(&points[y], place))).collect()
}

/// Largest number of segments into which a straight part of a stroke is cut.
const MAX_SEGMENTS: f64 = 100_000.0;

fn squared_distance_to_segment(p: &[f64; 3], a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let along = squared_distance(a, b);
    let t = if along > 0.0 {
        ((0..3).map(|c| (p[c] - a[c]) * (b[c] - a[c])).sum::<f64>() / along).clamp(0.0, 1.0)
    } else {
        0.0
    };
    squared_distance(p, &std::array::from_fn(|c| a[c] + t * (b[c] - a[c])))
}
