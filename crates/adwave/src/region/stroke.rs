//! Course of a line drawn over a surface.

use super::SurfaceMetric;
use super::front::{FrontSource, SourceExtent};
use super::place::{SurfacePlace, nearest_on_side};
use crate::parallel;
use crate::shape::{distance, squared_distance};
use crate::{Cancelled, Progress};

/// Vertices next to a polyline with its points nearest to them, as the start of a search along the surface.
///
/// The line between two points is straight. Where the surface curves away from it, the line is moved to the nearest
/// locations on the surface, segment by segment, so that the sagitta does not count as distance.
pub(super) fn sources(
    metric: &SurfaceMetric,
    spacing: f64,
    path: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<FrontSource>, Cancelled> {
    let (points, neighbors) = (metric.positions(), metric.neighbors());
    metric.corners(progress)?;
    let mut places: Vec<[f64; 3]> = path.first().copied().into_iter().collect();
    // Straight part that each place ends.
    let mut parts = vec![0; places.len()];
    for (part, ends) in (0..).zip(path.windows(2)) {
        let segments = (distance(&ends[0], &ends[1]) / spacing.max(f64::MIN_POSITIVE)).ceil();
        let segments = segments.clamp(1.0, MAX_SEGMENTS) as usize;
        let place = |t: f64| std::array::from_fn(|c| ends[0][c] + t * (ends[1][c] - ends[0][c]));
        places.extend((1..=segments).map(|k| place(k as f64 / segments as f64)));
        parts.resize(places.len(), part);
    }
    // A point off the surface has many nearest locations at about the same distance; each costs about 20 µs.
    let line =
        parallel::map_items(points.len(), places.len(), |k| metric.nearest_place(&places[k], progress));
    let line: Vec<SurfacePlace> = line.into_iter().collect::<Result<_, _>>()?;
    if let [place] = &line[..] {
        return Ok(point_sources(metric, place));
    }
    let mut sources = Vec::new();
    for (k, place) in line.iter().enumerate() {
        let first = k.saturating_sub(1);
        let last = (k + 1).min(line.len() - 1);
        let ring = neighbors.row(place.vertex).iter().map(|&y| y as usize);
        let corners = place.corners.into_iter().flatten().map(|y| y as usize);
        let mut around: Vec<usize> = ring.chain(corners).chain([place.vertex]).collect();
        around.sort_unstable();
        around.dedup();
        for vertex in around {
            let foot =
                |s: usize| (nearest_on_side(&points[vertex], &line[s].point, &line[s + 1].point), s + 1);
            let away = |(point, _): &([f64; 3], usize)| squared_distance(&points[vertex], point);
            let nearest = (first..last).map(foot).min_by(|a, b| away(a).total_cmp(&away(b)));
            if let Some((point, end)) = nearest {
                let (extent, number) = (SourceExtent::Line, parts[end]);
                sources.push(FrontSource { vertex, point, start: 0.0, extent, number });
            }
        }
    }
    Ok(sources)
}

/// Vertices around one location. On a mesh they are the corners of its triangle; elsewhere, as far as straight lines
/// over two edges reach: those within one edge of the nearest vertex, and if the location is that vertex, those within
/// two edges, as in a search from the vertex.
fn point_sources(metric: &SurfaceMetric, place: &SurfacePlace) -> Vec<FrontSource> {
    let (points, neighbors, vertex) = (metric.positions(), metric.neighbors(), place.vertex);
    let source = |vertex: usize| {
        let (point, extent) = (place.point, SourceExtent::Point);
        FrontSource { vertex, point, start: 0.0, extent, number: 0 }
    };
    if points[vertex] == place.point {
        return vec![source(vertex)];
    }
    if let Some(corners) = place.corners {
        return corners.map(|v| source(v as usize)).to_vec();
    }
    let around = std::iter::once(vertex).chain(neighbors.row(vertex).iter().map(|&y| y as usize));
    let mut near: Vec<usize> =
        around.clone().chain(around.flat_map(|y| neighbors.row(y).iter().map(|&z| z as usize))).collect();
    near.sort_unstable();
    near.dedup();
    near.into_iter().map(source).collect()
}

/// Largest number of segments into which a straight part of a stroke is cut.
const MAX_SEGMENTS: f64 = 100_000.0;
