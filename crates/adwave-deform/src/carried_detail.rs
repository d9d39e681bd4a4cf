//! Detail carried onto a base that was edited elsewhere.

use crate::DeformError;
use crate::coarse_base::{ROWS_AT_A_TIME, smooth_positions};
use crate::frames::{Turn, nearest_turn};
use crate::rotation::{normalized, turn_change};
use adwave::bands::Schedule;
use adwave::vector::{Vector, norm, subtract};
use adwave::{Decomposer, Progress};
use rayon::prelude::*;

/// Factor between the lengths of edges on two bases, relative to their sizes, above which the vertices of one are in
/// another order.
const OTHER_ORDER: f64 = 8.0;

/// Rounds in which frames are averaged with those of their neighbors.
const FRAME_ROUNDS: usize = 2;

/// Smallest volume of a solid, as a share of the cube over its size, whose sign shows that a base is mirrored.
const LEAST_VOLUME: f64 = 1e-4;

/// Positions S_J of the last level, in the order of the shape: the base that other programs edit and
/// [`with_base`] reads back. Vertices that are welded share a position.
///
/// # Errors
/// [`DeformError::NoPositions`], or as for the bands.
pub fn base_points(
    decomposer: &Decomposer,
    schedule: &Schedule,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, DeformError> {
    let smooth = smooth_positions(decomposer, schedule, progress)?;
    Ok(decomposer.vertex_map().scatter(&smooth, 1))
}

/// The shape on an edited base: `f′ = S′ + R (f − S_J)`, with S′ the edited [`base_points`] and R the rotation of each
/// vertex's neighborhood from S_J to S′, averaged over a few edges.
///
/// The unchanged base gives the shape, a base moved as a whole gives the shape moved. Detail keeps its size where the
/// base is scaled. `base` holds a position per vertex in the order of the shape. O(n).
///
/// # Errors
/// [`DeformError`] if the base has another number of vertices, coordinates that are not finite, all points at one
/// place, the order or the shape of another, or mirrors the shape.
pub fn with_base(
    decomposer: &Decomposer,
    schedule: &Schedule,
    base: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, DeformError> {
    let Some(points) = decomposer.points() else { return Err(DeformError::NoPositions) };
    check_points(base, points.len())?;
    let smooth = smooth_positions(decomposer, schedule, progress)?;
    let map = decomposer.vertex_map();
    let edited = map.positions(base);
    check_base(decomposer, &smooth, &edited)?;
    let turns = turns_between(decomposer, &smooth, &edited, progress)?;
    let welded = map.as_slice();
    let carried = |v: usize| {
        let (x, p, s) = (welded[v] as usize, &points[v], &base[v]);
        let change = turn_change(&turns[x], &subtract(p, &smooth[x]));
        [0, 1, 2].map(|c| p[c] + ((s[c] - smooth[x][c]) + change[c]))
    };
    let carried: Vec<Vector> = (0..points.len()).into_par_iter().map(carried).collect();
    progress.check()?;
    Ok(carried)
}

/// Checks that there are as many finite positions as vertices.
pub(crate) fn check_points(points: &[[f64; 3]], n_vertices: usize) -> Result<(), DeformError> {
    if points.len() != n_vertices {
        return Err(DeformError::WrongBase { expected: n_vertices, found: points.len() });
    }
    for (vertex, p) in points.iter().enumerate() {
        if let Some(&value) = p.iter().find(|c| !c.is_finite() || c.abs() > 1e100) {
            return Err(DeformError::BadPoint { vertex, value });
        }
    }
    Ok(())
}

/// Refuses bases that cannot be an edited copy.
fn check_base(decomposer: &Decomposer, smooth: &[Vector], edited: &[Vector]) -> Result<(), DeformError> {
    let (size, edited_size) = (diagonal(smooth), diagonal(edited));
    if edited_size == 0.0 && size > 0.0 {
        return Err(DeformError::CollapsedBase);
    }
    let neighbors = decomposer.neighbors();
    let mean = |points: &[Vector], size: f64| {
        let (mut sum, mut n) = (0.0, 0_usize);
        for x in 0..points.len() {
            for &y in neighbors.row(x) {
                sum += norm(&subtract(&points[x], &points[y as usize])) / size;
                n += 1;
            }
        }
        sum / n.max(1) as f64
    };
    let ratio = mean(edited, edited_size) / mean(smooth, size);
    if ratio > OTHER_ORDER {
        return Err(DeformError::OtherBase { ratio });
    }
    let geometry = decomposer.geometry_for("a deformation")?;
    let volume = |points: &[Vector], size: f64| {
        // Near the origin and in units of the size, so that nothing overflows.
        let local: Vec<Vector> = points.iter().map(|p| subtract(p, &points[0]).map(|c| c / size)).collect();
        geometry.volume_of(&local)
    };
    let is_solid = decomposer.health().volume.is_some();
    if is_solid && size > 0.0 {
        let (before, after) = (volume(smooth, size), volume(edited, edited_size));
        if before.abs().min(after.abs()) > LEAST_VOLUME && before * after < 0.0 {
            return Err(DeformError::MirroredBase);
        }
    }
    Ok(())
}

/// Length of the diagonal of the bounding box.
fn diagonal(points: &[Vector]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        for c in 0..3 {
            (low[c], high[c]) = (low[c].min(p[c]), high[c].max(p[c]));
        }
    }
    if points.is_empty() { 0.0 } else { norm(&subtract(&high, &low)) }
}

/// Rotations of the neighborhoods of welded vertices from one base to another, averaged over a few edges.
pub(crate) fn turns_between(
    decomposer: &Decomposer,
    from: &[Vector],
    to: &[Vector],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 4]>, DeformError> {
    let neighbors = decomposer.neighbors();
    let turn = |x: usize| -> [f64; 4] {
        let edge = |y: &u32| (subtract(&from[*y as usize], &from[x]), subtract(&to[*y as usize], &to[x]));
        let turn: Turn = nearest_turn(neighbors.row(x).iter().map(edge));
        turn.quaternion()
    };
    let mut turns: Vec<[f64; 4]> =
        (0..from.len()).into_par_iter().with_min_len(ROWS_AT_A_TIME).map(turn).collect();
    for _ in 0..FRAME_ROUNDS {
        progress.check()?;
        let average = |x: usize| {
            let own = &turns[x];
            let around = neighbors.row(x);
            if around.iter().all(|&y| turns[y as usize] == *own) {
                return *own;
            }
            let share = 1.0 / around.len() as f64;
            let mut sum = *own;
            for &y in around {
                let other = &turns[y as usize];
                let cosine: f64 = own.iter().zip(other).map(|(a, b)| a * b).sum();
                let signed = if cosine < 0.0 { -share } else { share };
                sum.iter_mut().zip(other).for_each(|(s, c)| *s += signed * c);
            }
            normalized(&sum)
        };
        turns = (0..from.len()).into_par_iter().with_min_len(ROWS_AT_A_TIME).map(average).collect();
    }
    progress.check()?;
    Ok(turns)
}
