//! Surfaces of a cloud that are closer to each other than neighbors are apart, found by the heights of neighborhoods.

use super::cloud_normals::plane_normal;
use crate::shape::{Adjacency, PreparedGeometry, STRAY_NEIGHBORS, Shape};
use crate::{Cancelled, Progress, parallel};
use nalgebra::Vector3;

/// Number of points whose neighborhoods are examined.
const SAMPLE: usize = 2000;

/// Fewest points of a neighborhood that are examined.
const FEWEST: usize = 16;

/// Share of a neighborhood that each of two sheets has at least.
const LEAST_SHARE: f64 = 0.25;

/// Distance of two sheets, in standard deviations within them, from which they are two: a neighborhood of evenly
/// distributed heights, as at a crease, has 3.5.
const LEAST_GAP: f64 = 5.0;

/// Largest distance between the middles of two sheets along the plane, in standard deviations of the neighborhood: the two
/// sides of a step lie beside each other.
const MOST_SHIFT: f64 = 0.5;

/// Share of the examined points from which sheets are reported.
const LEAST_FOUND: f64 = 0.01;

/// Sheets of a cloud that are closer to each other than its points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CloseSheets {
    /// Share of the points whose neighbors lie on two sheets.
    pub share: f64,
    /// Median distance of the two sheets, in the units of the points.
    pub distance: f64,
}

/// Finds out whether points have neighbors on two sheets, from the heights of the neighbors of the neighbors of a sample of
/// points over the plane that fits them best: two groups that are five of their standard deviations apart and lie over each
/// other. `None` if fewer than 1 % of the points have. O(2000·k²).
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::nearest_neighbors;
/// use adwave::signal::close_sheets;
/// let plate = |z: f64| (0..400).map(move |i| [f64::from(i % 20) + 0.3 * z, f64::from(i / 20), z]);
/// let points: Vec<[f64; 3]> = plate(0.0).chain(plate(0.5)).collect();
/// let sheets = close_sheets(&points, &nearest_neighbors(&points, 10).adjacency, Progress::none())?.unwrap();
/// assert!(sheets.share > 0.9 && (sheets.distance - 0.5).abs() < 0.05);
/// # Ok::<(), adwave::Cancelled>(())
/// ```
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// If a neighbor is no point.
pub fn close_sheets(
    points: &[[f64; 3]],
    neighbors: &Adjacency,
    progress: Progress<'_>,
) -> Result<Option<CloseSheets>, Cancelled> {
    let n = points.len().min(SAMPLE);
    let found: Vec<Option<f64>> =
        parallel::try_collect(n, progress, |i| sheet_distance(points, neighbors, i * points.len() / n))?;
    let mut distances: Vec<f64> = found.into_iter().flatten().collect();
    if distances.is_empty() || (distances.len() as f64) < LEAST_FOUND * n as f64 {
        return Ok(None);
    }
    let middle = distances.len() / 2;
    let share = distances.len() as f64 / n as f64;
    let distance = *distances.select_nth_unstable_by(middle, f64::total_cmp).1;
    Ok(Some(CloseSheets { share, distance }))
}

/// [`close_sheets`] of a cloud whose given normals do not separate its sheets; `None` for any other shape.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub fn find_close_sheets(
    geometry: &PreparedGeometry,
    progress: Progress<'_>,
) -> Result<Option<CloseSheets>, Cancelled> {
    if !matches!(geometry.shape(), Shape::Cloud(_)) || geometry.has_separate_sheets() {
        return Ok(None);
    }
    let points = geometry.points();
    let near = geometry.nearest(points, STRAY_NEIGHBORS, progress)?;
    let found = close_sheets(points, &near.adjacency, progress)?;
    geometry.keep_nearest(near);
    Ok(found)
}

/// Distance of the two sheets around a point; `None` if there is one sheet.
fn sheet_distance(points: &[[f64; 3]], neighbors: &Adjacency, x: usize) -> Option<f64> {
    let mut around: Vec<u32> = neighbors.row(x).to_vec();
    around.extend(neighbors.row(x).iter().flat_map(|&y| neighbors.row(y as usize)));
    around.sort_unstable();
    around.dedup();
    around.retain(|&y| y as usize != x);
    if around.len() + 1 < FEWEST {
        return None;
    }
    let normal = plane_normal(points, &around, x);
    around.push(x as u32);
    let origin = Vector3::from(points[x]);
    let mut lines: Vec<(f64, Vector3<f64>)> = around
        .iter()
        .map(|&y| {
            let line = Vector3::from(points[y as usize]) - origin;
            let height = line.dot(&normal);
            (height, line - height * normal)
        })
        .collect();
    lines.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let least = (LEAST_SHARE * lines.len() as f64).ceil() as usize;
    let gap = |k: &usize| lines[*k].0 - lines[*k - 1].0;
    let split = (least..=lines.len() - least).max_by(|a, b| gap(a).total_cmp(&gap(b)))?;
    let (lower, upper) = lines.split_at(split);
    let (low, high) = (heights(lower), heights(upper));
    let distance = high.mean - low.mean;
    let within = ((lower.len() as f64 * low.variance + upper.len() as f64 * high.variance)
        / lines.len() as f64)
        .sqrt();
    let middle = |part: &[(f64, Vector3<f64>)]| {
        part.iter().map(|(_, along)| along).sum::<Vector3<f64>>() / part.len() as f64
    };
    let spread =
        (lines.iter().map(|(_, along)| along.norm_squared()).sum::<f64>() / lines.len() as f64).sqrt();
    let shift = (middle(upper) - middle(lower)).norm();
    (distance > LEAST_GAP * within && shift < MOST_SHIFT * spread).then_some(distance)
}

/// Mean and variance of heights.
struct Heights {
    mean: f64,
    variance: f64,
}

fn heights(part: &[(f64, Vector3<f64>)]) -> Heights {
    let n = part.len() as f64;
    let mean = part.iter().map(|(height, _)| height).sum::<f64>() / n;
    let variance = part.iter().map(|(height, _)| (height - mean).powi(2)).sum::<f64>() / n;
    Heights { mean, variance }
}
