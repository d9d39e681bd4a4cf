//! Steps in which a new LAS stores coordinates: powers of ten that keep the digits of the data.

use adwave::shape::nearest_neighbors;

use crate::{CoordinatePrecision, ShapeFile, WriteReport};

/// Largest coordinate in steps from the offset, a little below 2³¹.
const MOST_STEPS: f64 = 2e9;
/// Usual step, and the largest one, in model units.
const USUAL: f64 = 1e-3;
/// Largest step relative to the smallest distance between points, so that rounding moves a point by 0.1 % of it.
const SHARE_OF_SPACING: f64 = 2e-3;
/// Largest step relative to the extent along the axis.
const SHARE_OF_EXTENT: f64 = 1e-5;
/// Points closer than this share of the median distance are copies of each other.
const SHARE_OF_MEDIAN: f64 = 1e-3;
/// Largest uncertainty of coordinates, in steps, at which their decimal digits can be counted.
const UNCERTAINTY: f64 = 0.01;

/// Steps and offsets of the axes, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoordinateSteps {
    pub(crate) scale: [f64; 3],
    pub(crate) offset: [f64; 3],
    /// Largest step that is small enough for the data; a larger one loses digits that matter.
    wanted: [f64; 3],
}

/// Smallest and largest coordinate along an axis.
#[derive(Clone, Copy)]
struct AxisRange {
    low: f64,
    high: f64,
}

impl CoordinateSteps {
    /// Chooses the steps for the points of a shape. O(n) for decimal numbers, else O(n log n).
    ///
    /// Along each axis it is the largest power of ten up to 0.001 of which all coordinates are multiples. If there is
    /// none, it is at most 0.2 % of the smallest distance between points and 1e-5 of the extent. It is larger only
    /// where 32-bit integers would not reach.
    pub(crate) fn choose(shape: &ShapeFile) -> Self {
        let mut steps = Self { scale: [USUAL; 3], offset: [0.0; 3], wanted: [USUAL; 3] };
        let mut smallest_distance = None;
        for axis in 0..3 {
            let Some(range) = range(&shape.points, axis) else { continue };
            let extent = (range.high - range.low).max(f64::EPSILON * range.high.abs().max(range.low.abs()));
            let finest = power_at_least(extent / MOST_STEPS);
            let wanted = if range.low == range.high {
                USUAL
            } else if let Some(step) = decimal_step(shape, axis, finest) {
                step
            } else {
                let distance = *smallest_distance.get_or_insert_with(|| nearest_distance(&shape.points));
                let limit = (SHARE_OF_SPACING * distance).min(SHARE_OF_EXTENT * extent).min(USUAL);
                power_at_most(limit)
            };
            let scale = wanted.max(finest);
            steps.wanted[axis] = wanted;
            steps.scale[axis] = scale;
            steps.offset[axis] = offset(range, scale);
        }
        steps
    }

    /// Reports the steps, and digits that they lose.
    pub(crate) fn report(&self, shape: &ShapeFile, report: &mut WriteReport) {
        let [x, y, z] = self.scale;
        let steps = if x == y && y == z { format!("{x:?}") } else { format!("{x:?}, {y:?} and {z:?}") };
        let mut error = 0.0_f64;
        for axis in 0..3 {
            let (scale, offset) = (self.scale[axis], self.offset[axis]);
            let stored = |c: f64| ((c - offset) / scale).round() * scale + offset;
            let off = |c: f64| (stored(c) - c).abs() - uncertainty(c, shape.precision);
            error = shape.points.iter().map(|p| off(p[axis])).fold(error, f64::max);
        }
        let rounding = if error > 0.0 { format!(", rounded by up to {error:.1e}") } else { String::new() };
        report.add_note(format!("coordinates are stored in steps of {steps}{rounding}"));
        if (0..3).any(|axis| self.scale[axis] > self.wanted[axis]) {
            report.report_dropped(format!(
                "digits of coordinates finer than steps of {steps} (32-bit integers reach no further)"
            ));
        }
    }
}

fn range(points: &[[f64; 3]], axis: usize) -> Option<AxisRange> {
    let all = || points.iter().map(|p| p[axis]);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    (low.is_finite() && high.is_finite()).then_some(AxisRange { low, high })
}

/// Power of ten; negative ones are the nearest numbers to the decimal fraction.
fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

fn power_at_least(x: f64) -> f64 {
    power_of_ten(x.max(f64::MIN_POSITIVE).log10().ceil())
}

fn power_at_most(x: f64) -> f64 {
    power_of_ten(x.max(f64::MIN_POSITIVE).log10().floor())
}

/// Half the distance to the next number of that type, and the rounding of a computed decimal.
fn uncertainty(c: f64, precision: CoordinatePrecision) -> f64 {
    let relative = match precision {
        CoordinatePrecision::F32 => f64::from(f32::EPSILON) / 2.0,
        CoordinatePrecision::F64 => 2.0 * f64::EPSILON,
    };
    relative * c.abs()
}

/// Largest power of ten from 0.001 down to `finest` of which all coordinates are multiples.
fn decimal_step(shape: &ShapeFile, axis: usize, finest: f64) -> Option<f64> {
    let most = shape.points.iter().map(|p| p[axis].abs()).fold(0.0, f64::max);
    let least = finest.max(uncertainty(most, shape.precision) / UNCERTAINTY);
    let mut exponent = USUAL.log10().round();
    loop {
        let step = power_of_ten(exponent);
        if step < least {
            return None;
        }
        let is_multiple = |c: f64| {
            let nearest = (c / step).round() * step;
            (nearest - c).abs() <= uncertainty(c, shape.precision)
        };
        if shape.points.iter().all(|p| is_multiple(p[axis])) {
            return Some(step);
        }
        exponent -= 1.0;
    }
}

/// Smallest distance between points that are no copies of each other.
fn nearest_distance(points: &[[f64; 3]]) -> f64 {
    if !points.as_flattened().iter().all(|c| c.is_finite()) {
        return f64::INFINITY;
    }
    let mut distances = nearest_neighbors(points, 1).radius;
    distances.retain(|distance| *distance > 0.0);
    if distances.is_empty() {
        return f64::INFINITY;
    }
    let middle = distances.len() / 2;
    let median = *distances.select_nth_unstable_by(middle, f64::total_cmp).1;
    let is_apart = |distance: &f64| *distance > SHARE_OF_MEDIAN * median;
    distances.into_iter().filter(is_apart).fold(f64::INFINITY, f64::min)
}

/// Offset: 0 if the coordinates are small enough, else a whole number below them, or the smallest coordinate.
fn offset(range: AxisRange, scale: f64) -> f64 {
    let reaches =
        |offset: f64| [range.low, range.high].iter().all(|c| ((c - offset) / scale).abs() <= MOST_STEPS);
    let candidates = [0.0, range.low.floor(), range.low];
    candidates.into_iter().find(|&offset| reaches(offset)).unwrap_or(range.low)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(points: Vec<[f64; 3]>) -> CoordinateSteps {
        CoordinateSteps::choose(&ShapeFile::from_cloud(points))
    }

    /// Points about `spacing` apart around `center`, rounded to `digits`.
    fn cloud(center: f64, spacing: f64, digits: Option<i32>) -> Vec<[f64; 3]> {
        let round = |x: f64| match digits {
            Some(digits) => {
                let text = format!("{x:.*}", digits as usize);
                text.parse().unwrap()
            }
            None => x,
        };
        let point = |k: u32| {
            let (x, y) = (f64::from(k % 40), f64::from(k / 40));
            [
                center + spacing * (x + 0.2 * y.sin()),
                center + spacing * (y + 0.2 * x.cos()),
                spacing * (x * y).sin(),
            ]
            .map(round)
        };
        (0..1600).map(point).collect()
    }

    #[test]
    fn decimal_numbers_keep_their_digits() {
        assert_eq!(steps(cloud(5.4e6, 1.0, Some(2))).scale, [0.001; 3]);
        assert_eq!(steps(cloud(5.4e6, 1.0, Some(3))).scale, [0.001; 3]);
        assert_eq!(steps(cloud(5.4e5, 1.0, Some(4))).scale, [1e-4; 3]);
        // Degrees with seven digits.
        assert_eq!(steps(cloud(13.4, 1e-5, Some(7))).scale, [1e-7; 3]);
    }

    #[test]
    fn other_numbers_are_rounded_by_a_small_share_of_their_distance() {
        for (center, spacing) in
            [(0.0, 1.0), (5.4e6, 0.05), (0.0, 1e-6), (13.4, 1e-5), (0.0, 1e4), (-700.0, 0.3)]
        {
            let points = cloud(center, spacing, None);
            let smallest = nearest_distance(&points);
            let CoordinateSteps { scale, offset, .. } = steps(points.clone());
            for p in &points {
                for axis in 0..3 {
                    let k = ((p[axis] - offset[axis]) / scale[axis]).round();
                    assert!(k.abs() < 2_147_483_647.0, "{center} {spacing}");
                    let error = (k * scale[axis] + offset[axis] - p[axis]).abs();
                    assert!(
                        error <= 1.1e-3 * smallest + 4.0 * f64::EPSILON * p[axis].abs(),
                        "{center} {spacing}: {error}"
                    );
                }
            }
            assert!(scale.iter().all(|s| (s.log10() - s.log10().round()).abs() < 1e-12 && *s <= 0.001));
        }
    }

    #[test]
    fn single_numbers_count_with_the_digits_they_have() {
        let points = cloud(100.0, 0.5, Some(3)).iter().map(|p| p.map(|c| f64::from(c as f32))).collect();
        let file = ShapeFile { precision: CoordinatePrecision::F32, ..ShapeFile::from_cloud(points) };
        assert_eq!(CoordinateSteps::choose(&file).scale, [0.001; 3]);
    }

    #[test]
    fn extents_beyond_the_integers_are_reported() {
        let mut points = cloud(0.0, 1e-3, None);
        points.push([1e9; 3]);
        let file = ShapeFile::from_cloud(points);
        let steps = CoordinateSteps::choose(&file);
        assert_eq!(steps.scale, [1.0; 3]);
        let mut report = WriteReport::default();
        steps.report(&file, &mut report);
        assert!(
            report.not_written[0].starts_with("digits of coordinates finer than steps of 1.0"),
            "{report:?}"
        );
    }

    #[test]
    fn degenerate_clouds_have_steps() {
        for points in [
            vec![[0.0; 3]],
            vec![[5.4e6 + 0.123_456_7; 3]; 3],
            vec![[1e-300; 3], [2e-300; 3]],
            vec![[1e99; 3], [-1e99; 3]],
        ] {
            let steps = steps(points);
            assert!(steps.scale.iter().all(|s| *s > 0.0 && s.is_finite()), "{steps:?}");
        }
    }
}
