//! Sheets of a cloud that are closer to each other than its points, told apart by the normals of the file.
//!
//! A wall scanned from both sides, a leaf or a page has two surfaces whose points are each other's nearest. With
//! normals that point away from the material, or into it, neighbors on the other surface have the opposite normal.

use super::{Neighborhoods, Participation, distance};
use crate::rows::Pattern;
use crate::vector::{dot, subtract};
use crate::{Cancelled, Progress, parallel};

/// Cosine of two normals below which they belong to different sheets: a turn of more than 120°, which the edges of
/// solids do not have.
pub(super) const OPPOSITE: f64 = -0.5;

/// Cosine of two normals above which they belong to one sheet.
const ALIKE: f64 = 0.5;

/// Ratio of the median slope of the lines to neighbors with opposite normals to that of the lines to neighbors with
/// similar normals, from which opposite normals mean another sheet. Where the signs of normals are arbitrary, both
/// slopes are equal.
const SLOPE_RATIO: f64 = 2.0;

/// Number of neighbors searched for each neighbor needed, because half of the nearest ones or more may lie on other
/// sheets.
const SEARCHED: usize = 4;

/// Relative difference of distances that counts as equal, as in [`nearest_neighbors`](super::nearest_neighbors).
const TIE: f64 = 1e-9;

/// True if neighbors with opposite normals lie on other sheets: lines to them are steeper against their planes than
/// lines to neighbors with similar normals, and the shorter ones are the steepest. On a curved sheet whose normals have
/// arbitrary signs the longer ones are the steepest. False if no neighbors are opposite, or if normals have arbitrary
/// signs.
pub(super) fn are_sheets_apart(points: &[[f64; 3]], normals: &[[f64; 3]], near: &Neighborhoods) -> bool {
    let (mut alike, mut opposite, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
    for x in 0..points.len() {
        for &y in near.adjacency.row(x) {
            let y = y as usize;
            let cosine = dot(&normals[x], &normals[y]);
            let is_alike = cosine > ALIKE;
            if !is_alike && cosine >= OPPOSITE {
                continue;
            }
            let line = subtract(&points[y], &points[x]);
            let length = distance(&points[x], &points[y]);
            if length > 0.0 {
                let slope = dot(&line, &normals[x]).abs().min(dot(&line, &normals[y]).abs()) / length;
                if is_alike {
                    alike.push(slope);
                } else {
                    opposite.push(slope);
                    lengths.push(length / near.radius[x]);
                }
            }
        }
    }
    let median = |slopes: &mut Vec<f64>| {
        let middle = slopes.len() / 2;
        *slopes.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    if opposite.is_empty() {
        return false;
    }
    let middle = median(&mut lengths.clone());
    let (mut short, mut long) = (Vec::new(), Vec::new());
    for (slope, length) in opposite.iter().zip(&lengths) {
        if *length <= middle { short.push(*slope) } else { long.push(*slope) }
    }
    let are_short_steeper = long.is_empty() || median(&mut short) >= median(&mut long);
    are_short_steeper && (alike.is_empty() || median(&mut opposite) > SLOPE_RATIO * median(&mut alike))
}

/// The `k` nearest neighbors of each point that is wanted among those whose normal is not opposite, of the nearest
/// points that take part; fewer if there are not enough. Points without an opposite normal nearby are searched once.
pub(super) fn nearest_on_sheet(
    points: &[[f64; 3]],
    normals: &[[f64; 3]],
    participation: &Participation,
    k: usize,
    is_wanted: impl Fn(usize) -> bool + Sync + Send,
    progress: Progress<'_>,
) -> Result<Neighborhoods, Cancelled> {
    let near = participation.nearest(points, k, is_wanted, progress)?;
    let is_on_sheet = |x: usize, y: u32| dot(&normals[x], &normals[y as usize]) >= OPPOSITE;
    let is_mixed = parallel::try_collect(points.len(), progress, |x| {
        near.adjacency.row(x).iter().any(|&y| !is_on_sheet(x, y))
    })?;
    if !is_mixed.contains(&true) {
        return Ok(near);
    }
    let wide = participation.nearest(points, SEARCHED.saturating_mul(k), |x| is_mixed[x], progress)?;
    let rows: Vec<(Vec<u32>, f64)> = parallel::try_collect(points.len(), progress, |x| {
        if !is_mixed[x] {
            return (near.adjacency.row(x).to_vec(), near.radius[x]);
        }
        let on_sheet = wide.adjacency.row(x).iter().copied().filter(|&y| is_on_sheet(x, y));
        let mut found: Vec<(f64, u32)> =
            on_sheet.map(|y| (distance(&points[x], &points[y as usize]), y)).collect();
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let Some(&(radius, _)) = found.get(k.min(found.len()).wrapping_sub(1)) else {
            return (Vec::new(), 0.0);
        };
        let n = found.partition_point(|(d, _)| *d <= radius * (1.0 + TIE));
        let mut row: Vec<u32> = found[..n].iter().map(|(_, y)| *y).collect();
        row.sort_unstable();
        (row, radius)
    })?;
    let mut offsets = vec![0; points.len() + 1];
    for (x, (row, _)) in rows.iter().enumerate() {
        offsets[x + 1] = offsets[x] + row.len();
    }
    let columns = rows.iter().flat_map(|(row, _)| row.iter().copied()).collect();
    let adjacency = Pattern::new(offsets, columns, points.len()).unwrap_or_else(|e| unreachable!("{e}"));
    let radius = rows.iter().map(|(_, radius)| *radius).collect();
    Ok(Neighborhoods { adjacency, radius, k: k.min(near.k) })
}
