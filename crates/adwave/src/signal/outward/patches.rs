//! Outside of a mesh, patch by patch.

use super::vote::Vote;
use super::{OutwardInfo, OutwardNormals};
use crate::shape::{
    FaceIncidence, MeshArea, Polygons, PreparedGeometry, triangles_at_vertices, try_vertex_normals,
};
use crate::vector::{cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress, parallel};

/// Number of triangles between two checks for cancellation.
const AT_A_TIME: usize = 1 << 13;

/// Largest cancellation, relative to the area, for which a vertex normal counts as known.
const CANCELLED: f64 = 1e-9;

/// Relation of a triangle to the one across an edge: none, the same orientation, or the opposite.
#[derive(Clone, Copy, Default, PartialEq)]
enum EdgeNeighbor {
    #[default]
    Nothing,
    Alike(u32),
    Reversed(u32),
}

/// Outward normals of the vertices.
pub(super) fn normals(
    points: &[[f64; 3]],
    geometry: &PreparedGeometry,
    file: Option<&[[f64; 3]]>,
    progress: Progress<'_>,
) -> Result<OutwardNormals, Cancelled> {
    let triangles = geometry.triangles();
    let across = neighbors(triangles, progress)?;
    let mut turned = vec![false; triangles.len()];
    let patches = spread(&across, triangles, &mut turned, progress)?;
    let mut info = OutwardInfo {
        n_parts: patches.len(),
        n_closed: 0,
        n_by_file: 0,
        n_by_majority: 0,
        n_as_given: 0,
        n_without: 0,
        n_turned: 0,
        without: 0.0,
        given: None,
    };
    let mut has_side = vec![true; triangles.len()];
    for patch in &patches {
        progress.check()?;
        let mesh = OrientedFaces { points, triangles, turned: &turned };
        let sign = mesh.side(patch, file, &mut info);
        for &f in &patch.triangles {
            let f = f as usize;
            turned[f] ^= sign == Some(-1.0);
            has_side[f] = sign.is_some();
        }
    }
    let of_sided = |f: usize| if has_side[f] { turned[f] } else { false };
    info.n_turned = (0..triangles.len()).filter(|&f| of_sided(f)).count();
    if geometry.faces().triangles().is_none() {
        let side = |f: usize| has_side[f].then_some(turned[f]);
        return polygon_normals(points, geometry, side, info, progress);
    }
    let outward: Vec<[u32; 3]> = parallel::try_collect(triangles.len(), progress, |f| {
        let [a, b, c] = triangles[f];
        match (has_side[f], turned[f]) {
            (false, _) => [a; 3], // without area, so without a say
            (true, false) => [a, b, c],
            (true, true) => [a, c, b],
        }
    })?;
    let at_vertex = triangles_at_vertices(points.len(), &outward, progress)?;
    let mut normals = try_vertex_normals(points, &outward, &at_vertex, progress)?;
    let area = |f: usize| norm(&doubled_normal(points, triangles[f]));
    let (mut total, mut without) = (0.0, 0.0);
    let around = triangles_at_vertices(points.len(), triangles, progress)?;
    for (x, normal) in normals.iter_mut().enumerate() {
        let all: f64 = around.row(x).iter().map(|&f| area(f as usize)).sum();
        let sum = at_vertex.row(x).iter().fold([0.0; 3], |s, &f| {
            crate::vector::add_scaled(&s, 1.0, &doubled_normal(points, outward[f as usize]))
        });
        if norm(&sum) <= CANCELLED * all {
            *normal = [0.0; 3];
            without += all;
        }
        total += all;
    }
    info.without = if total > 0.0 { without / total } else { 1.0 };
    Ok(OutwardNormals { normals, info })
}

/// Normals of a mesh of polygons; `side` is true for a triangle that is turned, and `None` for one without an outside.
fn polygon_normals(
    points: &[[f64; 3]],
    geometry: &PreparedGeometry,
    side: impl Fn(usize) -> Option<bool>,
    mut info: OutwardInfo,
    progress: Progress<'_>,
) -> Result<OutwardNormals, Cancelled> {
    let triangles = geometry.triangles();
    // A face of n corners has n − 2 triangles, which lie in one patch.
    let mut first = 0;
    let mut outward = Polygons::new();
    let mut corners = Vec::new();
    for face in geometry.faces().iter() {
        let own = first..first + face.len() - 2;
        first = own.end;
        let Some(is_turned) = side(own.clone().find(|&f| is_proper(&triangles[f])).unwrap_or(own.start))
        else {
            continue; // without an outside, so without a say
        };
        corners.clear();
        corners.extend(face);
        if is_turned {
            corners.reverse();
        }
        outward.push(&corners);
    }
    let sums = FaceIncidence::new(points.len(), &outward, progress)?.normal_sums(points, progress)?;
    let areas = geometry.incidence(progress)?.areas(points, MeshArea::Barycentric, progress)?;
    let (mut total, mut without) = (0.0, 0.0);
    let mut normals = Vec::with_capacity(sums.len());
    for (sum, area) in sums.iter().zip(&areas) {
        let is_known = norm(sum) > CANCELLED * 6.0 * area;
        normals.push(unit(sum).filter(|_| is_known).unwrap_or_default());
        total += area;
        without += if is_known { 0.0 } else { *area };
    }
    info.without = if total > 0.0 { without / total } else { 1.0 };
    Ok(OutwardNormals { normals, info })
}

/// Neighbor of each triangle across its edges ab, bc, ca.
fn neighbors(triangles: &[[u32; 3]], progress: Progress<'_>) -> Result<Vec<[EdgeNeighbor; 3]>, Cancelled> {
    let mut edges: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(3 * triangles.len());
    for (f, corners) in triangles.iter().enumerate().filter(|(_, corners)| is_proper(corners)) {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            edges.push((a.min(b), a.max(b), (3 * f + k) as u32, a < b));
        }
    }
    parallel::sort_unstable_by(&mut edges, progress, Ord::cmp)?;
    let mut across = vec![[EdgeNeighbor::Nothing; 3]; triangles.len()];
    for edge in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let [e, f] = edge else { continue };
        let meets = |other: &(u32, u32, u32, bool)| {
            if e.3 == f.3 { EdgeNeighbor::Reversed(other.2 / 3) } else { EdgeNeighbor::Alike(other.2 / 3) }
        };
        across[e.2 as usize / 3][e.2 as usize % 3] = meets(f);
        across[f.2 as usize / 3][f.2 as usize % 3] = meets(e);
    }
    Ok(across)
}

/// True if a triangle has three different corners.
fn is_proper(corners: &[u32; 3]) -> bool {
    corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]
}

/// Triangles connected by edges of two triangles.
struct Patch {
    triangles: Vec<u32>,
    is_closed: bool,
    /// True if all can be oriented consistently.
    is_two_sided: bool,
    /// True if all were oriented consistently.
    agrees: bool,
}

/// Orients the triangles of each patch like its first one.
fn spread(
    across: &[[EdgeNeighbor; 3]],
    triangles: &[[u32; 3]],
    turned: &mut [bool],
    progress: Progress<'_>,
) -> Result<Vec<Patch>, Cancelled> {
    let mut seen = vec![false; triangles.len()];
    let mut patches = Vec::new();
    for start in (0..triangles.len()).filter(|&f| is_proper(&triangles[f])) {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut patch =
            Patch { triangles: vec![start as u32], is_closed: true, is_two_sided: true, agrees: true };
        let mut at = 0;
        while at < patch.triangles.len() {
            let f = patch.triangles[at] as usize;
            for &side in &across[f] {
                let (g, differs) = match side {
                    EdgeNeighbor::Nothing => {
                        patch.is_closed = false;
                        continue;
                    }
                    EdgeNeighbor::Alike(g) => (g as usize, false),
                    EdgeNeighbor::Reversed(g) => (g as usize, true),
                };
                patch.agrees &= !differs;
                if std::mem::replace(&mut seen[g], true) {
                    patch.is_two_sided &= turned[g] == (turned[f] ^ differs);
                } else {
                    turned[g] = turned[f] ^ differs;
                    patch.triangles.push(g as u32);
                }
            }
            at += 1;
            if at.is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
        }
        patches.push(patch);
    }
    Ok(patches)
}

/// Unit normal of a triangle times twice its area.
fn doubled_normal(points: &[[f64; 3]], corners: [u32; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|v| &points[v as usize]);
    cross(&subtract(b, a), &subtract(c, a))
}

/// Triangles with their present orientation.
struct OrientedFaces<'a> {
    points: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    turned: &'a [bool],
}

impl OrientedFaces<'_> {
    fn doubled_normal(&self, f: u32) -> [f64; 3] {
        let sign = if self.turned[f as usize] { -1.0 } else { 1.0 };
        doubled_normal(self.points, self.triangles[f as usize]).map(|c| sign * c)
    }

    fn center(&self, f: u32) -> [f64; 3] {
        let [a, b, c] = self.triangles[f as usize].map(|v| self.points[v as usize]);
        std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
    }

    /// Side of the outside: 1 if the patch is oriented outwards, −1 if inwards; `None` if it has no outside. Counts
    /// the method in `info`.
    fn side(&self, patch: &Patch, file: Option<&[[f64; 3]]>, info: &mut OutwardInfo) -> Option<f64> {
        let vote = self.vote(patch);
        let by_file = || file.and_then(|normals| self.compare_with_file(patch, normals));
        let (count, sign) = if !patch.is_two_sided {
            (&mut info.n_without, None)
        } else if let Some(sign) = vote.closed_sign().filter(|_| patch.is_closed) {
            (&mut info.n_closed, Some(sign))
        } else if vote.is_flat() || patch.is_closed {
            (&mut info.n_without, None)
        } else if let Some(sign) = by_file() {
            (&mut info.n_by_file, Some(sign))
        } else if let Some(sign) = vote.open_sign() {
            (&mut info.n_by_majority, Some(sign))
        } else if patch.agrees {
            (&mut info.n_as_given, Some(1.0))
        } else {
            (&mut info.n_without, None)
        };
        *count += 1;
        sign
    }

    /// Vote on whether the patch turns its front or its back to its own center.
    fn vote(&self, patch: &Patch) -> Vote {
        let origin = self.center(patch.triangles[0]);
        let (mut moment, mut total) = ([0.0; 3], 0.0);
        for &f in &patch.triangles {
            let area = norm(&self.doubled_normal(f));
            let from = subtract(&self.center(f), &origin);
            moment = crate::vector::add_scaled(&moment, area, &from);
            total += area;
        }
        let mean = moment.map(|m| if total > 0.0 { m / total } else { 0.0 });
        let mut vote = Vote::default();
        for &f in &patch.triangles {
            vote.add(&subtract(&self.center(f), &origin), &self.doubled_normal(f), &mean);
        }
        vote
    }

    /// Side of the file's normals, weighted by area; `None` if there are none or they disagree.
    fn compare_with_file(&self, patch: &Patch, normals: &[[f64; 3]]) -> Option<f64> {
        let (mut signed, mut size) = (0.0, 0.0);
        for &f in &patch.triangles {
            let n = self.doubled_normal(f);
            for &v in &self.triangles[f as usize] {
                let along = dot(&n, &normals[v as usize]);
                signed += along;
                size += along.abs();
            }
        }
        (signed.abs() > 0.5 * size && size > 0.0).then(|| signed.signum())
    }
}
