//! Blends of two shapes with the same vertices and faces, band by band.

use crate::DeformError;
use crate::carried_detail::turns_between;
use crate::coarse_base::smooth_positions;
use crate::frames::Turn;
use adwave::bands::Schedule;
use adwave::shape::{PreparedGeometry, Shape, first_misplaced_vertex};
use adwave::{Decomposer, Progress};
use rayon::prelude::*;

/// Shape between `a` (shares 0) and `b` (shares 1): `f = S + Σ_j (1 − t_j) R_a W_a(j) + t_j R_b W_b(j)` on the base
/// `S = (1 − t_0) S_a + t_0 S_b`. R_a and R_b turn detail from its own base to this one.
///
/// `shares` holds t_1 … t_J, fine to coarse, and t_0 of the base last. Shares beyond \[0, 1\] exaggerate. Bases are
/// blended along straight lines, so that a limb that swings far gets shorter on the way; bend such shapes by a
/// [`Deformer`](crate::Deformer).
///
/// # Errors
/// [`DeformError::NotAlike`] if vertices or faces differ or are in another order ([`first_misplaced_vertex`]),
/// [`DeformError::BadShare`] for another number of shares or one that is not finite.
pub fn morph(
    a: &Decomposer,
    b: &Decomposer,
    schedule: &Schedule,
    shares: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, DeformError> {
    check_alike(a.geometry_for("a morph")?, b.geometry_for("a morph")?)?;
    let n_levels = schedule.n_levels();
    if shares.len() != n_levels + 1 {
        let found = shares.len();
        return Err(DeformError::BadShare(format!(
            "a morph needs {} shares, one per band and one for the base, got {found}",
            n_levels + 1
        )));
    }
    if let Some(share) = shares.iter().find(|share| !share.is_finite() || share.abs() > 1e6) {
        return Err(DeformError::BadShare(format!("shares of a morph must be in -1e6..=1e6, got {share:?}")));
    }
    let (bands, base) = shares.split_at(n_levels);
    let t = base[0];
    let from_b = |bases: &[Vec<[f64; 3]>; 2]| -> Vec<[f64; 3]> {
        let blend = |(p, q): (&[f64; 3], &[f64; 3])| {
            [0, 1, 2].map(|c| if t == 1.0 { q[c] } else { p[c] + t * (q[c] - p[c]) })
        };
        bases[0].iter().zip(&bases[1]).map(blend).collect()
    };
    let in_order = |d: &Decomposer| -> Result<Vec<[f64; 3]>, DeformError> {
        let smooth = smooth_positions(d, schedule, progress)?;
        Ok(d.vertex_map().scatter(&smooth, 1))
    };
    let bases = [in_order(a)?, in_order(b)?];
    let middle = from_b(&bases);
    let mut points = middle.clone();
    for (decomposer, smooth, is_second) in [(a, &bases[0], false), (b, &bases[1], true)] {
        let factors: Vec<f64> = bands.iter().map(|t| if is_second { *t } else { 1.0 - t }).collect();
        let shape = decomposer.points().unwrap_or_default();
        let request = decomposer.request(shape.as_flattened(), 3, schedule).progress(progress);
        let (detail, _) = request.weighted(&factors)?;
        let map = decomposer.vertex_map();
        let (from, to) = (map.positions(smooth), map.positions(&middle));
        let turns = turns_between(decomposer, &from, &to, progress)?;
        let welded = map.as_slice();
        points.par_iter_mut().enumerate().for_each(|(v, p)| {
            let d = &detail.as_chunks().0[v];
            let turned = Turn::from_quaternion(turns[welded[v] as usize]).apply(d);
            for c in 0..3 {
                p[c] += turned[c];
            }
        });
    }
    progress.check()?;
    Ok(points)
}

fn check_alike(first: &PreparedGeometry, second: &PreparedGeometry) -> Result<(), DeformError> {
    let (a, b) = (first.shape(), second.shape());
    if a.points().is_none() || b.points().is_none() {
        return Err(DeformError::NoPositions);
    }
    if a.n_vertices() != b.n_vertices() {
        let text = format!("the shapes have {} and {} vertices", a.n_vertices(), b.n_vertices());
        return Err(DeformError::NotAlike(text));
    }
    if let (Shape::Mesh(a), Shape::Mesh(b)) = (a, b) {
        let differs = a.faces().iter().zip(b.faces().iter()).position(|(f, g)| f != g);
        if a.faces().len() != b.faces().len() {
            let text = format!("the shapes have {} and {} faces", a.faces().len(), b.faces().len());
            return Err(DeformError::NotAlike(text));
        }
        if let Some(face) = differs {
            return Err(DeformError::NotAlike(format!(
                "face {face} (from 0) has other corners in the second"
            )));
        }
    }
    if let Some(vertex) = first_misplaced_vertex(first, second) {
        return Err(DeformError::NotAlike(format!(
            "faces have equal numbers, but vertex {vertex} (from 0) meets other vertices in the second: the faces or parts are \
             in another order"
        )));
    }
    Ok(())
}
