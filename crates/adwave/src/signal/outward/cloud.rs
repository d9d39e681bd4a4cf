//! Outside of a point cloud.

use super::vote::Vote;
use super::{OutwardInfo, OutwardNormals};
use crate::shape::{Adjacency, GivenNormals, Neighborhoods, NormalSigns, PreparedGeometry};
use crate::signal::try_cloud_normals;
use crate::{Cancelled, Progress};

/// Given normals where neighbors agree on the side, else normals propagated from point to point.
pub(super) fn normals(
    points: &[[f64; 3]],
    near: &Neighborhoods,
    geometry: &PreparedGeometry,
    given: Option<&GivenNormals>,
    progress: Progress<'_>,
) -> Result<OutwardNormals, Cancelled> {
    let mut normals = match given {
        Some(given) => given.normals.clone(),
        None => try_cloud_normals(points, near, progress)?,
    };
    let is_by_file = given.is_some_and(|given| given.check.signs != NormalSigns::Unoriented);
    let parts = parts(&near.adjacency.union_with_transpose(progress)?, progress)?;
    let mut info = OutwardInfo {
        n_parts: parts.len(),
        n_closed: 0,
        n_by_file: 0,
        n_by_majority: 0,
        n_as_given: 0,
        n_without: 0,
        n_turned: 0,
        without: 0.0,
        given: given.map(|given| given.check),
    };
    for part in &parts {
        if is_by_file {
            info.n_by_file += 1;
            continue;
        }
        let center = center(points, part);
        let mut vote = Vote::default();
        for &x in part {
            vote.add(&points[x as usize], &normals[x as usize], &center);
        }
        if vote.open_sign().is_some() {
            info.n_by_majority += 1;
        } else {
            info.n_without += 1;
            for &x in part {
                normals[x as usize] = [0.0; 3];
            }
        }
    }
    let members = (0..points.len()).filter(|&x| geometry.participation().is_member(x));
    let (n_members, n_without) =
        members.fold((0_usize, 0), |(n, without), x| (n + 1, without + usize::from(normals[x] == [0.0; 3])));
    info.without = f64::from(n_without as u32) / n_members.max(1) as f64;
    Ok(OutwardNormals { normals, info })
}

fn center(points: &[[f64; 3]], part: &[u32]) -> [f64; 3] {
    let n = part.len() as f64;
    std::array::from_fn(|c| part.iter().map(|&x| points[x as usize][c] / n).sum())
}

/// The points of each part in ascending order; parts are ordered by their first points.
fn parts(near: &Adjacency, progress: Progress<'_>) -> Result<Vec<Vec<u32>>, Cancelled> {
    let mut seen = vec![false; near.n_rows()];
    let mut parts = Vec::new();
    for start in 0..seen.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        progress.check()?;
        let mut part = vec![start as u32];
        let mut at = 0;
        while at < part.len() {
            for &y in near.row(part[at] as usize) {
                if !std::mem::replace(&mut seen[y as usize], true) {
                    part.push(y);
                }
            }
            at += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    Ok(parts)
}
