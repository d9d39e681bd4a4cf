//! Steps of 32-bit floats at large coordinates, compared with the distance between neighbors.

use adwave::Progress;

use crate::progress::report_row;
use crate::{CoordinatePrecision, ShapeFile};

/// Steps of a file above this share of the distance between neighbors are reported: they tilt the edges between
/// neighbors by more than a degree.
const READ_SHARE: f64 = 0.1;
/// Rounding of a written file above this share of the distance between neighbors is reported, since it can be avoided.
const WRITE_SHARE: f64 = 0.01;
/// Share of the coordinates that are odd multiples of the step. It is 1/2 if finer numbers were rounded to the step,
/// and 0 for coordinates on a coarser grid, which lost nothing.
const ODD_SHARE: f64 = 0.05;
/// Largest number of edges and points that an estimate takes into account.
const MOST_SAMPLES: usize = 20_000;
/// Number of points whose nearest neighbor is found.
const N_NEAREST: usize = 32;
/// Bits of the fraction of a 32-bit float.
const FRACTION_BITS: i32 = 23;

/// Remark on a shape whose coordinates were rounded to 32-bit floats before it was read; `None` if the steps of these
/// do not matter.
pub(crate) fn note_on_reading(shape: &ShapeFile) -> Option<String> {
    if shape.precision != CoordinatePrecision::F32 || shape.points.is_empty() {
        return None;
    }
    let steps: Vec<(f64, f64)> = (0..3).filter_map(|axis| rounded_step(&shape.points, axis)).collect();
    let &(step, most) = steps.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let spacing = spacing_below(shape, step / READ_SHARE)?;
    Some(format!(
        "coordinates are 32-bit floats of up to {most:.3e}, which are multiples of {}, while neighbors are {} apart: \
         finer digits are lost; export the file again with 64-bit coordinates or relative to an offset",
        rounded_text(step),
        rounded_text(spacing)
    ))
}

/// Remark on coordinates that writing as 32-bit floats rounds; `None` if the change does not matter.
///
/// # Errors
/// The call was cancelled.
pub(crate) fn note_on_writing(
    shape: &ShapeFile,
    progress: Progress<'_>,
) -> Result<Option<String>, adwave::Cancelled> {
    let mut error = 0.0_f64;
    let n = shape.points.len() as u64;
    for (row, point) in shape.points.iter().enumerate() {
        report_row(progress, row as u64, n)?;
        for &c in point.iter().filter(|c| c.is_finite()) {
            error = error.max((f64::from(c as f32) - c).abs());
        }
    }
    if error == 0.0 {
        return Ok(None);
    }
    Ok(spacing_below(shape, 2.0 * error / WRITE_SHARE).map(|spacing| {
        format!(
            "coordinates are rounded to 32-bit floats, by up to {}, while neighbors are {} apart; write 64-bit \
             coordinates (OBJ, LAS and CSV have them), or move the shape to the origin before",
            rounded_text(error),
            rounded_text(spacing)
        )
    }))
}

/// Number with three digits.
fn rounded_text(x: f64) -> String {
    format!("{x:.3e}").parse::<f64>().map_or_else(|_| x.to_string(), |x| x.to_string())
}

/// Step of 32-bit floats at the largest coordinates of an axis, with their size, if finer numbers were rounded to it.
fn rounded_step(points: &[[f64; 3]], axis: usize) -> Option<(f64, f64)> {
    let most = points.iter().map(|p| p[axis].abs()).filter(|c| c.is_finite()).fold(0.0, f64::max);
    if most < f64::from(f32::MIN_POSITIVE) {
        return None;
    }
    let binade = most.log2().floor().exp2();
    let step = binade * f64::from(-FRACTION_BITS).exp2();
    let (mut n, mut n_odd) = (0_usize, 0_usize);
    for c in points.iter().map(|p| p[axis].abs()).filter(|c| (binade..2.0 * binade).contains(c)) {
        n += 1;
        n_odd += usize::from((c / step).rem_euclid(2.0) == 1.0);
    }
    (n_odd as f64 > ODD_SHARE * n as f64).then_some((step, most))
}

/// Typical distance between neighbors, if it is below `limit`: the median length of edges, or the median distance to
/// the nearest other position of a cloud.
fn spacing_below(shape: &ShapeFile, limit: f64) -> Option<f64> {
    let points = &shape.points;
    let distance = |a: u32, b: u32| {
        let (p, q) = (points.get(a as usize)?, points.get(b as usize)?);
        let square: f64 = p.iter().zip(q).map(|(a, b)| (a - b).powi(2)).sum();
        Some(square.sqrt())
    };
    let is_length = |length: &f64| length.is_finite() && *length > 0.0;
    let mut lengths: Vec<f64> = if !shape.faces.is_empty() {
        let rows = strided(shape.faces.len(), MOST_SAMPLES);
        let edge = |row: usize| {
            let face = shape.faces.get(row);
            distance(*face.first()?, *face.get(1)?)
        };
        rows.filter_map(edge).filter(is_length).collect()
    } else if !shape.edges.pairs.is_empty() {
        let rows = strided(shape.edges.pairs.len(), MOST_SAMPLES);
        let edge = |row: usize| distance(shape.edges.pairs[row][0], shape.edges.pairs[row][1]);
        rows.filter_map(edge).filter(is_length).collect()
    } else {
        // Points that fill the two longest sides of their box are farther apart than this; the exact search takes
        // longer.
        if even_spacing(points).is_none_or(|spacing| spacing > 10.0 * limit) {
            return None;
        }
        let nearest = |row: usize| {
            let others = (0..points.len() as u32).filter_map(|other| distance(row as u32, other));
            others.filter(is_length).fold(f64::INFINITY, f64::min)
        };
        strided(points.len(), N_NEAREST).map(nearest).filter(is_length).collect()
    };
    if lengths.is_empty() {
        return None;
    }
    let middle = lengths.len() / 2;
    let spacing = *lengths.select_nth_unstable_by(middle, f64::total_cmp).1;
    (spacing < limit).then_some(spacing)
}

/// Distance between points that fill the two longest sides of their box evenly, without strays.
fn even_spacing(points: &[[f64; 3]]) -> Option<f64> {
    let mut sides = [0.0; 3];
    for (axis, side) in sides.iter_mut().enumerate() {
        let mut sample: Vec<f64> = strided(points.len(), MOST_SAMPLES)
            .map(|row| points[row][axis])
            .filter(|c| c.is_finite())
            .collect();
        sample.sort_unstable_by(f64::total_cmp);
        let outer = sample.len() / 100;
        *side = sample.get(sample.len().checked_sub(1 + outer)?)? - sample.get(outer)?;
    }
    sides.sort_unstable_by(f64::total_cmp);
    let n = points.len() as f64;
    let spacing = (sides[2] * sides[1] / n).sqrt().max(sides[2] / n);
    (spacing > 0.0).then_some(spacing)
}

/// Up to `most` rows of `n`, evenly distributed.
fn strided(n: usize, most: usize) -> impl Iterator<Item = usize> {
    (0..n).step_by(n.div_ceil(most).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Terrain of points about 1 apart, northings at `north`.
    fn terrain(north: f64) -> Vec<[f64; 3]> {
        let point = |k: u32| {
            let (x, y) = (f64::from(k % 50), f64::from(k / 50));
            [x + 0.3 * (7.0 * y).sin(), north + y + 0.3 * (5.0 * x).cos(), (0.1 * x).sin()]
        };
        (0..2500).map(point).collect()
    }

    fn single(points: &[[f64; 3]]) -> ShapeFile {
        let points = points.iter().map(|p| p.map(|c| f64::from(c as f32))).collect();
        ShapeFile { precision: CoordinatePrecision::F32, ..ShapeFile::from_cloud(points) }
    }

    #[test]
    fn steps_count_relative_to_the_spacing_of_points() {
        let note = note_on_reading(&single(&terrain(5.4e6))).unwrap();
        assert!(note.contains("multiples of 0.5, while neighbors are"), "{note}");
        for north in [0.0, 1e3, 1e5, 5e5] {
            assert_eq!(note_on_reading(&single(&terrain(north))), None, "{north}");
        }
        // Points that are farther apart lose nothing that matters, and finer ones lose more.
        let scaled =
            |scale: f64| terrain(5.4e6 / scale).iter().map(|p| p.map(|c| c * scale)).collect::<Vec<_>>();
        assert_eq!(note_on_reading(&single(&scaled(10.0))), None);
        assert!(note_on_reading(&single(&scaled(0.01))).is_some());
    }

    #[test]
    fn coordinates_on_a_coarse_grid_lose_nothing() {
        let grid: Vec<_> = (0..900).map(|k| [f64::from(k % 30), 5.4e6 + f64::from(k / 30), 0.25]).collect();
        assert_eq!(note_on_reading(&single(&grid)), None);
        assert_eq!(note_on_writing(&ShapeFile::from_cloud(grid), Progress::none()), Ok(None));
    }

    #[test]
    fn writing_is_measured_by_the_rounding_itself() {
        let written =
            |north: f64| note_on_writing(&ShapeFile::from_cloud(terrain(north)), Progress::none()).unwrap();
        let note = written(5.4e6).unwrap();
        assert!(note.contains("by up to 0.2483, while neighbors are"), "{note}");
        assert!(written(5e5).is_some());
        assert_eq!(written(1e3), None);
        // A cloud that was rounded before is not rounded again.
        assert_eq!(note_on_writing(&single(&terrain(5.4e6)), Progress::none()), Ok(None));
    }

    #[test]
    fn degenerate_shapes_have_no_remark() {
        for points in [vec![], vec![[5.4e6 + 0.1; 3]], vec![[5.4e6 + 0.1; 3]; 40], vec![[f64::NAN; 3]; 9]] {
            let file = ShapeFile { precision: CoordinatePrecision::F32, ..ShapeFile::from_cloud(points) };
            assert_eq!(note_on_reading(&file), None);
            assert_eq!(note_on_writing(&file, Progress::none()), Ok(None));
        }
    }
}
