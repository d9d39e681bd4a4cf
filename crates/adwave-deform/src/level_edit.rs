//! Detail of finer levels of subdivision carried onto an edited level, as multiresolution modifiers do.

use crate::carried_detail::check_points;
use crate::frames::nearest_turn;
use crate::{DeformError, Turn};
use adwave::Progress;
use adwave::vector::{Vector, subtract};
use adwave_subdivision::{Hierarchy, LiftedWavelets, SubdivisionError};
use rayon::prelude::*;

/// Positions of all vertices of a level of subdivision, after an edit.
#[derive(Clone, Copy, Debug)]
pub struct EditedLevel<'a> {
    /// The level, from 1.
    pub level: usize,
    /// Positions in the order of [`Hierarchy::vertices`].
    pub points: &'a [[f64; 3]],
}

/// The mesh that belongs to an edited level, with the detail of all finer levels in local frames.
///
/// Let f_k be the positions of level k ([`LiftedWavelets::coarse_field`]) and S f_k one step of subdivision without
/// details. From the edited level to the mesh, `f′_{k−1} = S f′_k + R (f_{k−1} − S f_k)`, with R the rotation of the
/// edges at each vertex from S f_k to S f′_k ([`nearest_turn`]). Where no edge changes, positions stay bit for bit; a
/// level that is moved as a whole gives the mesh moved. Detail keeps its size where the level is scaled. `points` and
/// the result are in the order of the mesh. O(n).
///
/// # Errors
/// [`DeformError::WrongLevel`], [`DeformError::BadPoint`] or [`DeformError::Subdivision`].
pub fn with_level(
    hierarchy: &Hierarchy,
    wavelets: &LiftedWavelets,
    points: &[[f64; 3]],
    edited: &EditedLevel<'_>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, DeformError> {
    let (n_levels, top) = (wavelets.n_levels(), edited.level);
    if top == 0 || top > n_levels {
        return Err(SubdivisionError::Level { level: top, n_levels }.into());
    }
    let (expected, found) = (wavelets.n_vertices_at(top), edited.points.len());
    if found != expected {
        return Err(DeformError::WrongLevel { level: top, expected, found });
    }
    check_points(edited.points, expected)?;
    let positions = |level: usize| -> Result<Vec<Vector>, DeformError> {
        Ok(to_points(&wavelets.coarse_field(points.as_flattened(), 3, level, progress)?))
    };
    let step = |coarse: &[Vector], level: usize| -> Result<Vec<Vector>, DeformError> {
        Ok(to_points(&wavelets.next_field(coarse.as_flattened(), 3, level, progress)?))
    };
    let (mut old, mut new) = (positions(top)?, edited.points.to_vec());
    for level in (1..=top).rev() {
        let (base, moved) = (step(&old, level)?, step(&new, level)?);
        let fine = positions(level - 1)?;
        let turns = turns(hierarchy, level - 1, &base, &moved)?;
        let carried = |v: usize| {
            let change = subtract(&moved[v], &base[v]);
            let detail = subtract(&fine[v], &base[v]);
            let turned = turns[v].apply(&detail);
            [0, 1, 2].map(|c| fine[v][c] + (change[c] + (turned[c] - detail[c])))
        };
        new = (0..fine.len()).into_par_iter().map(carried).collect();
        old = fine;
        progress.check()?;
    }
    Ok(new)
}

/// Rotations of the edges at each vertex of a level between two positions.
fn turns(
    hierarchy: &Hierarchy,
    level: usize,
    base: &[Vector],
    moved: &[Vector],
) -> Result<Vec<Turn>, DeformError> {
    let faces = hierarchy.faces(level)?;
    let mut edges: Vec<[u32; 2]> = faces
        .iter()
        .flat_map(|corners| corners.iter().zip(corners.iter().cycle().skip(1)))
        .flat_map(|(&a, &b)| [[a, b], [b, a]])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut starts = vec![0; base.len() + 1];
    for edge in &edges {
        starts[edge[0] as usize + 1] += 1;
    }
    for v in 0..base.len() {
        starts[v + 1] += starts[v];
    }
    let turn = |v: usize| {
        let along = |points: &[Vector], w: u32| subtract(&points[w as usize], &points[v]);
        let ring = &edges[starts[v]..starts[v + 1]];
        nearest_turn(ring.iter().map(|&[_, w]| (along(base, w), along(moved, w))))
    };
    Ok((0..base.len()).into_par_iter().map(turn).collect())
}

fn to_points(values: &[f64]) -> Vec<Vector> {
    values.as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::shape::Polygons;
    use adwave_subdivision::{Family, QuadParams, subdivide_polygons};

    /// A cube cut four times onto the unit sphere, with bumps.
    fn bumpy_ball() -> (Vec<Vector>, Polygons) {
        let mut points: Vec<Vector> =
            (0..8_u8).map(|k| [0, 1, 2].map(|c| 2.0 * f64::from(k >> c & 1) - 1.0)).collect();
        let cube: [&[u32]; 6] =
            [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
        let mut faces: Polygons = cube.into_iter().collect();
        for _ in 0..4 {
            let finer = subdivide_polygons(points.len(), &faces);
            let sum = |corners: &[u32]| {
                corners.iter().fold([0.0; 3], |s, &v| [0, 1, 2].map(|c| s[c] + points[v as usize][c]))
            };
            let new = finer.edges.iter().map(|edge| sum(edge)).chain(faces.iter().map(sum));
            let new: Vec<Vector> = new.collect();
            points.extend(new);
            faces = finer.faces;
        }
        for p in &mut points {
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            let bump = 1.0 + 0.1 * (12.0 * p[0] / length).sin() * (10.0 * p[1] / length).cos();
            *p = p.map(|x| x / length * bump);
        }
        (points, faces)
    }

    fn prepare(points: &[Vector], faces: &Polygons) -> (Hierarchy, LiftedWavelets) {
        let params = QuadParams { points: Some(points), ..QuadParams::default() };
        let hierarchy = Hierarchy::from_faces(points.len(), faces, &params, Progress::none()).unwrap();
        let masses = vec![1.0; points.len()];
        let wavelets =
            LiftedWavelets::new(&hierarchy, Family::CatmullClark, &masses, Progress::none()).unwrap();
        (hierarchy, wavelets)
    }

    fn largest(a: &[Vector], b: &[Vector]) -> f64 {
        a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn detail_turns_with_its_level() {
        let (points, faces) = bumpy_ball();
        let (hierarchy, wavelets) = prepare(&points, &faces);
        let turn = Turn::from_quaternion(crate::rotation::normalized(&[0.7, 0.2, -0.5, 0.4]));
        let move_point = |p: &Vector| [0, 1, 2].map(|c| turn.apply(p)[c] + [3.0, -1.0, 2.0][c]);
        for level in 1..=4 {
            let coarse = wavelets.coarse_field(points.as_flattened(), 3, level, Progress::none()).unwrap();
            let coarse = to_points(&coarse);
            let carried = |points_of_level: &[Vector]| {
                let edited = EditedLevel { level, points: points_of_level };
                with_level(&hierarchy, &wavelets, &points, &edited, Progress::none()).unwrap()
            };
            assert_eq!(carried(&coarse), points, "level {level}");
            let moved: Vec<Vector> = coarse.iter().map(move_point).collect();
            let expected: Vec<Vector> = points.iter().map(move_point).collect();
            let error = largest(&carried(&moved), &expected);
            assert!(error < 1e-12, "level {level}: {error:e}");
        }
    }

    #[test]
    fn a_twisted_level_carries_its_bumps_along() {
        let (points, faces) = bumpy_ball();
        let (hierarchy, wavelets) = prepare(&points, &faces);
        // A twist about the z axis, applied to the first level, and to the whole mesh as the truth.
        let twist = |p: &Vector| {
            let (sin, cos) = (1.2 * p[2]).sin_cos();
            [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2]]
        };
        let level = 1;
        let coarse =
            to_points(&wavelets.coarse_field(points.as_flattened(), 3, level, Progress::none()).unwrap());
        let moved: Vec<Vector> = coarse.iter().map(twist).collect();
        let edited = EditedLevel { level, points: &moved };
        let local = with_level(&hierarchy, &wavelets, &points, &edited, Progress::none()).unwrap();
        // Without frames: the change of the level is subdivided and added.
        let change: Vec<Vector> = moved.iter().zip(&coarse).map(|(p, q)| subtract(p, q)).collect();
        let change = wavelets.fine_field(change.as_flattened(), 3, level, Progress::none()).unwrap();
        let fixed: Vec<Vector> = points
            .iter()
            .zip(to_points(&change))
            .map(|(p, change)| [0, 1, 2].map(|c| p[c] + change[c]))
            .collect();
        let truth: Vec<Vector> = points.iter().map(twist).collect();
        let rms = |a: &[Vector]| {
            let sum: f64 =
                a.as_flattened().iter().zip(truth.as_flattened()).map(|(x, y)| (x - y).powi(2)).sum();
            (sum / points.len() as f64).sqrt()
        };
        let (with_frames, without) = (rms(&local), rms(&fixed));
        assert!(with_frames < 0.8 * without, "{with_frames} {without}");
    }

    #[test]
    fn wrong_levels_are_refused() {
        let (points, faces) = bumpy_ball();
        let (hierarchy, wavelets) = prepare(&points, &faces);
        let refused = |level: usize, points_of_level: &[Vector]| {
            let edited = EditedLevel { level, points: points_of_level };
            with_level(&hierarchy, &wavelets, &points, &edited, Progress::none()).unwrap_err().to_string()
        };
        assert!(refused(0, &points).contains("0..=4"));
        assert!(refused(5, &points).contains("0..=4"));
        assert!(refused(3, &points[..9]).contains("level 3 has 26 vertices, and the edited one has 9"));
        assert!(refused(4, &[[f64::NAN; 3]; 8]).contains("finite"));
    }
}
