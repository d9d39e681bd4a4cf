//! Surfaces of a cloud that are closer to each other than neighbors are apart, found by the heights of neighborhoods.

use super::cloud_normals::plane_normal;
use super::quadric::{TangentFrame, fit_quadric};
use crate::shape::{Adjacency, PreparedGeometry, STRAY_NEIGHBORS};
use crate::{Cancelled, Progress, parallel};
use nalgebra::{Vector2, Vector3};

/// Number of points whose neighborhoods are examined.
const SAMPLE: usize = 2000;

/// Fewest points of a neighborhood that are examined.
const FEWEST: usize = 16;

/// Smallest share of a neighborhood that each of two sheets has.
const LEAST_SHARE: f64 = 0.25;

/// Smallest distance of two sheets, in standard deviations of the heights within them. Evenly distributed heights, as
/// at a crease, have 3.5.
const LEAST_GAP: f64 = 5.0;

/// Largest distance between the middles of two sheets along the plane, in standard deviations of the neighborhood. The
/// two sides of a step lie beside each other and are farther apart.
const MOST_SHIFT: f64 = 0.5;

/// Smallest distance of two sheets, in standard deviations of the neighborhood along the plane; smaller distances are
/// roughness.
const LEAST_DISTANCE: f64 = 0.05;

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

/// Finds sheets of a cloud that are closer to each other than its points; `None` if fewer than 1 % of the points have
/// neighbors on two sheets. At each point of a sample a quadric is fitted to the neighbors of its neighbors. They lie
/// on two sheets if their heights over the quadric form two groups that are five standard deviations apart and lie over
/// each other. O(2000·k²).
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

/// [`close_sheets`] of a cloud whose given normals do not separate its sheets; `None` for any other shape. The
/// neighbors are those of the cloud; `moved` are the positions of its vertices after an edit, n × 3 in the order of the
/// shape, if they are to be used instead of its own.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// If there are not as many moved positions as vertices.
pub fn find_close_sheets(
    geometry: &PreparedGeometry,
    moved: Option<&[[f64; 3]]>,
    progress: Progress<'_>,
) -> Result<Option<CloseSheets>, Cancelled> {
    if !geometry.shape().is_cloud() || geometry.has_separate_sheets() {
        return Ok(None);
    }
    let near = geometry.nearest(geometry.points(), STRAY_NEIGHBORS, progress)?;
    let found = match moved {
        None => close_sheets(geometry.points(), &near.adjacency, progress)?,
        Some(moved) => close_sheets(&geometry.vertex_map().positions(moved), &near.adjacency, progress)?,
    };
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
    if normal == Vector3::zeros() {
        return None;
    }
    around.push(x as u32);
    let frame = TangentFrame::new(points[x], normal);
    let local: Vec<Vector3<f64>> = around.iter().map(|&y| frame.local(&points[y as usize])).collect();
    let reach = local.iter().map(|p| p.x.hypot(p.y)).fold(0.0, f64::max);
    let quadric = fit_quadric(local.iter().map(|p| [p.x / reach, p.y / reach, p.z / reach]))?;
    // Heights over the surface that runs between both sheets, however it is bent.
    let mut lines: Vec<SampleLine> = local
        .iter()
        .map(|p| {
            let (u, v) = (p.x / reach, p.y / reach);
            let [a, b, c, d, e, f] = quadric;
            let middle = a + b * u + c * v + 0.5 * (d * u * u + 2.0 * e * u * v + f * v * v);
            SampleLine { height: p.z - middle * reach, along: Vector2::new(p.x, p.y) }
        })
        .collect();
    lines.sort_unstable_by(|a, b| a.height.total_cmp(&b.height));
    let n = lines.len() as f64;
    let least = (LEAST_SHARE * n).ceil() as usize;
    let gap = |k: &usize| lines[*k].height - lines[*k - 1].height;
    let split = (least..=lines.len() - least).max_by(|a, b| gap(a).total_cmp(&gap(b)))?;
    let (lower, upper) = lines.split_at(split);
    let (low, high) = (SheetSide::new(lower), SheetSide::new(upper));
    let distance = high.mean - low.mean;
    let within = ((lower.len() as f64 * low.variance + upper.len() as f64 * high.variance) / n).sqrt();
    let spread = (lines.iter().map(|line| line.along.norm_squared()).sum::<f64>() / n).sqrt();
    let are_two = distance > LEAST_GAP * within
        && distance > LEAST_DISTANCE * spread
        && (high.middle - low.middle).norm() < MOST_SHIFT * spread;
    are_two.then_some(distance)
}

/// Line from a point to another one.
struct SampleLine {
    /// Height over the quadric that fits the neighborhood.
    height: f64,
    /// Part along the plane.
    along: Vector2<f64>,
}

/// Points of a neighborhood on one side of a gap.
struct SheetSide {
    /// Mean of the heights.
    mean: f64,
    /// Variance of the heights.
    variance: f64,
    /// Mean place along the plane.
    middle: Vector2<f64>,
}

impl SheetSide {
    fn new(lines: &[SampleLine]) -> Self {
        let n = lines.len() as f64;
        let mean = lines.iter().map(|line| line.height).sum::<f64>() / n;
        let variance = lines.iter().map(|line| (line.height - mean).powi(2)).sum::<f64>() / n;
        let middle = lines.iter().map(|line| line.along).sum::<Vector2<f64>>() / n;
        Self { mean, variance, middle }
    }
}
