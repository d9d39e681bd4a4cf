//! Normals and tangents that a shape stores, after its vertices have moved.

use super::FIT_NEIGHBORS;
use super::cloud_normals::{POINTS_AT_A_TIME, plane_normal};
use crate::parallel;
use crate::shape::{GivenNormals, NormalSigns, Polygons, try_nearest_neighbors};
use crate::vector::{Vector, add_scaled, cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress};

/// Largest difference between components of two stored normals at one position that count as one normal: rounding to
/// 32 bits, with some operations after it. Adjacent faces of a finely tessellated sphere differ by more up to 10¹⁰
/// faces.
const SAME_NORMAL: f64 = 1e-5;

/// Number of different normals at one position up to which nearly equal ones are united, which compares all pairs.
const FEW_NORMALS: usize = 64;

/// Fewest neighbors on the same side that determine the tangent plane of a point.
const PLANE_NEIGHBORS: usize = 3;

/// Positions of the same vertices before and after a motion.
#[derive(Clone, Copy, Debug)]
pub struct MovedPoints<'a> {
    /// Old positions.
    pub before: &'a [[f64; 3]],
    /// New positions, in the same number.
    pub after: &'a [[f64; 3]],
}

/// Normals that the corners of faces refer to.
#[derive(Clone, Copy, Debug)]
pub struct StoredNormals<'a> {
    /// Faces of the mesh.
    pub faces: &'a Polygons,
    /// Stored normals, of any length.
    pub normals: &'a [[f64; 3]],
    /// Index of the normal of each corner, in the order of [`Polygons::corners`]; larger than any index for a corner
    /// without normal.
    pub of_corner: &'a [u32],
    /// Faces that are shaded flat whatever their neighbors are; empty if there are none, else one entry per face.
    pub is_flat: &'a [bool],
}

/// Normals at the corners of faces after the vertices have moved, one per corner; NaN at corners without normal.
/// O(n log n).
///
/// Corners at one position that shared one normal share one afterwards: the mean of the normals of their faces,
/// weighted by area. Corners whose normals differed, as at a crease or between flat faces, are computed from their own
/// faces. Normals point to the same side of their faces as before. Where none of these faces moved, and where the faces
/// have no area, the old normal is returned bit for bit.
///
/// ```
/// use adwave::{Progress, shape::Polygons};
/// use adwave::signal::{StoredNormals, MovedPoints, moved_corner_normals};
/// let faces = Polygons::from_triangles(&[[0, 1, 2]]);
/// let (normals, of_corner) = ([[0.0, 0.0, 1.0]], [0; 3]);
/// let corners = StoredNormals { faces: &faces, normals: &normals, of_corner: &of_corner, is_flat: &[] };
/// let before = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let after = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// let moved_points = MovedPoints { before: &before, after: &after };
/// assert_eq!(moved_corner_normals(&moved_points, &corners, Progress::none())?, [[0.0, -1.0, 0.0]; 3]);
/// # Ok::<(), adwave::Cancelled>(())
/// ```
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// If the numbers of positions or corners differ, or a corner names a vertex that does not exist.
pub fn moved_corner_normals(
    points: &MovedPoints<'_>,
    corners: &StoredNormals<'_>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let StoredNormals { faces, normals, of_corner, is_flat } = *corners;
    let n_corners = faces.corners().len();
    assert_eq!(of_corner.len(), n_corners, "an index for each corner");
    assert_eq!(points.before.len(), points.after.len(), "positions of the same vertices");
    let mut result = vec![[f64::NAN; 3]; n_corners];
    let (before, after) =
        (face_areas(points.before, faces, progress)?, face_areas(points.after, faces, progress)?);
    let moved_faces: Vec<bool> =
        faces.iter().map(|face| face.iter().any(|&v| has_moved(points, v as usize))).collect();
    let face_of: Vec<u32> =
        faces.iter().enumerate().flat_map(|(f, face)| std::iter::repeat_n(f as u32, face.len())).collect();
    // Corners with a normal, grouped by position, by normal, and by face where that is flat.
    let key = |c: u32| {
        let point = points.before[faces.corners()[c as usize] as usize];
        let normal = normals[of_corner[c as usize] as usize];
        let face = face_of[c as usize];
        let flat = if is_flat.get(face as usize).copied().unwrap_or(false) { face + 1 } else { 0 };
        // −0 and 0 are the same number.
        (point.map(|x| (x + 0.0).to_bits()), flat, normal.map(|x| (x + 0.0).to_bits()))
    };
    let with_normal = (0..n_corners as u32).filter(|&c| (of_corner[c as usize] as usize) < normals.len());
    let mut order: Vec<u32> = with_normal.collect();
    parallel::sort_unstable_by(&mut order, progress, |&a, &b| key(a).cmp(&key(b)).then(a.cmp(&b)))?;
    progress.check()?;
    let mut start = 0;
    while start < order.len() {
        if start % POINTS_AT_A_TIME == 0 {
            progress.check()?;
        }
        let place = key(order[start]).0;
        let end = start + order[start..].iter().take_while(|&&c| key(c).0 == place).count();
        for group in
            groups_of_one_normal(&order[start..end], &key, |c| normals[of_corner[c as usize] as usize])
        {
            let old = normals[of_corner[group[0] as usize] as usize];
            let of_faces =
                |areas: &[Vector]| {
                    unit(&group.iter().fold([0.0; 3], |sum, &c| {
                        add_scaled(&sum, 1.0, &areas[face_of[c as usize] as usize])
                    }))
                };
            let new = if group.iter().any(|&c| moved_faces[face_of[c as usize] as usize]) {
                of_faces(&after)
            } else {
                None
            };
            let is_inward = of_faces(&before).is_some_and(|outward| dot(&outward, &old) < 0.0);
            for &c in &group {
                result[c as usize] = match new {
                    Some(new) if is_inward => new.map(|x| -x),
                    Some(new) => new,
                    None => normals[of_corner[c as usize] as usize],
                };
            }
        }
        start = end;
    }
    Ok(result)
}

/// Sort key of a corner: position, flat face or 0, and normal.
type CornerKey = ([u64; 3], u32, [u64; 3]);

/// Splits the corners at one position, sorted by their keys, into those that share one normal.
fn groups_of_one_normal(
    corners: &[u32],
    key: &impl Fn(u32) -> CornerKey,
    normal: impl Fn(u32) -> [f64; 3],
) -> Vec<Vec<u32>> {
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for same in corners.chunk_by(|&a, &b| key(a) == key(b)) {
        let (flat, own) = (key(same[0]).1, normal(same[0]));
        let is_near = |group: &Vec<u32>| {
            let other = normal(group[0]);
            key(group[0]).1 == flat && (0..3).all(|k| (own[k] - other[k]).abs() <= SAME_NORMAL)
        };
        let near = if groups.len() <= FEW_NORMALS { groups.iter().position(is_near) } else { None };
        match near {
            Some(k) => groups[k].extend_from_slice(same),
            None => groups.push(same.to_vec()),
        }
    }
    groups
}

/// True if a vertex has another position than before.
fn has_moved(points: &MovedPoints<'_>, v: usize) -> bool {
    points.before[v].map(f64::to_bits) != points.after[v].map(f64::to_bits)
}

/// Normal of each face with the length of its area, scaled by a power of two against overflow; independent of its first
/// corner up to rounding. Zero for faces with a corner that is not finite.
fn face_areas(
    points: &[[f64; 3]],
    faces: &Polygons,
    progress: Progress<'_>,
) -> Result<Vec<Vector>, Cancelled> {
    let (low, high) = points.iter().filter(|p| p.iter().all(|x| x.is_finite())).fold(
        ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]),
        |(low, high), p| {
            (std::array::from_fn(|c| p[c].min(low[c])), std::array::from_fn(|c| p[c].max(high[c])))
        },
    );
    let extent = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    let scale = if extent > 0.0 && extent.is_finite() {
        (-extent.log2().floor()).clamp(-1000.0, 1000.0).exp2()
    } else {
        1.0
    };
    let mut areas = vec![[0.0; 3]; faces.len()];
    parallel::try_visit_rows(&mut areas, 1, POINTS_AT_A_TIME, progress, |first, areas: &mut [Vector]| {
        for (f, area) in (first..).zip(areas) {
            let face = faces.get(f);
            let Some((&origin, others)) = face.split_first() else { continue };
            let side = |v: u32| subtract(&points[v as usize], &points[origin as usize]).map(|x| x * scale);
            let sum = others
                .windows(2)
                .fold([0.0; 3], |sum, pair| add_scaled(&sum, 1.0, &cross(&side(pair[0]), &side(pair[1]))));
            if sum.iter().all(|x| x.is_finite()) {
                *area = sum;
            }
        }
    })?;
    Ok(areas)
}

/// Normals of the points of a cloud after they have moved: those of the planes that fit the neighbors of each point
/// best, on the side of the old normal. O(n k log n).
///
/// A neighbor whose old normal points to the opposite side lies on another sheet and is left out; if the old normals
/// are not oriented ([`GivenNormals`]), sides are those after orienting them. Where neither a point nor one of its
/// neighbors moved, where its old normal is zero or NaN, and where fewer than three neighbors remain, the old normal is
/// returned bit for bit.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// If the numbers of positions and normals differ.
pub fn moved_cloud_normals(
    points: &MovedPoints<'_>,
    normals: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    assert_eq!(points.before.len(), points.after.len(), "positions of the same vertices");
    assert_eq!(points.after.len(), normals.len(), "a normal for each point");
    let finite: Vec<u32> = (0..normals.len())
        .filter(|&v| points.after[v].iter().all(|x| x.is_finite()))
        .map(|v| v as u32)
        .collect();
    let after: Vec<[f64; 3]> = finite.iter().map(|&v| points.after[v as usize]).collect();
    let near = try_nearest_neighbors(&after, FIT_NEIGHBORS, progress)?;
    let own: Vec<[f64; 3]> = finite.iter().map(|&v| normals[v as usize]).collect();
    // Arbitrary signs do not tell sheets apart.
    let sides = match GivenNormals::new(&after, &near, &own, progress)? {
        Some(given) if given.check.signs != NormalSigns::AsGiven => given.normals,
        _ => own,
    };
    let mut fitted = vec![[0.0; 3]; after.len()];
    parallel::try_visit_rows(&mut fitted, 1, POINTS_AT_A_TIME, progress, |first, fitted: &mut [Vector]| {
        let mut same_side = Vec::new();
        for (x, fitted) in (first..).zip(fitted) {
            let old = normals[finite[x] as usize];
            let row = near.adjacency.row(x);
            *fitted = old;
            let is_moved = |k: u32| has_moved(points, finite[k as usize] as usize);
            if !is_moved(x as u32) && !row.iter().any(|&y| is_moved(y)) {
                continue;
            }
            same_side.clear();
            same_side.extend(row.iter().filter(|&&y| dot(&sides[y as usize], &sides[x]) > 0.0));
            if same_side.len() < PLANE_NEIGHBORS {
                continue;
            }
            let new: [f64; 3] = plane_normal(&after, &same_side, x).into();
            if norm(&new) > 0.5 && norm(&new).is_finite() {
                *fitted = if dot(&new, &old) < 0.0 { new.map(|x| -x) } else { new };
            }
        }
    })?;
    let mut result = normals.to_vec();
    for (&v, new) in finite.iter().zip(fitted) {
        result[v as usize] = new;
    }
    Ok(result)
}

/// Tangent at a vertex whose normal has changed: t − n(n·t), scaled to length 1; the old one if nothing remains.
///
/// ```
/// let tangent = adwave::signal::moved_tangent([0.0, 0.6, 0.8], [0.0, 0.0, 2.0]);
/// assert_eq!(tangent, [0.0, 1.0, 0.0]);
/// ```
pub fn moved_tangent(tangent: [f64; 3], normal: [f64; 3]) -> [f64; 3] {
    let Some(n) = unit(&normal) else { return tangent };
    unit(&add_scaled(&tangent, -dot(&n, &tangent), &n)).unwrap_or(tangent)
}
