//! Random tracks whose truth is known, with noise that may differ between the axes, and the best windows for them.

use super::exact::root_mean_square;
use super::random::Random;
use super::surfaces::{dot, minus};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

/// Kind of track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackShape {
    /// Straight line.
    Straight,
    /// Ellipse, walked once.
    Ellipse,
    /// Sum of waves.
    Spline,
    /// Straight legs between half circles with radii of 3 to 6 spacings.
    Hairpins,
    /// Straight legs between corners.
    Streets,
    /// Sum of waves with 10 to 40 vertices at each of some places.
    Stops,
    /// Sum of waves with a spacing that changes slowly between 0.3 and 2.1.
    UnevenSpacing,
    /// Sum of waves with a spacing between 0.5 and 1.5, drawn for each edge.
    RandomSpacing,
}

/// Noise of the axes of a track relative to each other. The height is along z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisNoise {
    /// Equal noise along all axes.
    Equal,
    /// Heights with 2.7 times the noise of the positions.
    Heights,
    /// Heights without noise.
    ExactHeights,
    /// Heights with 2.7 times the noise of the positions, then rounded to half a spacing.
    RoundedHeights,
}

/// Step of rounded heights, in spacings.
const ROUNDING: f64 = 0.5;

impl AxisNoise {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Self); 4] = [
        ("equal", Self::Equal),
        ("heights 2.7 times", Self::Heights),
        ("heights exact", Self::ExactHeights),
        ("heights 2.7 times, rounded", Self::RoundedHeights),
    ];

    /// Standard deviations for the noise `s` of the positions, without rounding.
    fn deviations(self, s: f64) -> [f64; 3] {
        match self {
            Self::Equal => [s; 3],
            Self::ExactHeights => [s, s, 0.0],
            Self::Heights | Self::RoundedHeights => [s, s, 2.7 * s],
        }
    }
}

/// Track with and without noise. The mean distance of consecutive vertices at different places is 1.
pub struct NoisyTrack {
    /// The vertices without noise.
    pub clean: Vec<[f64; 3]>,
    /// The vertices with noise.
    pub noisy: Vec<[f64; 3]>,
    /// Standard deviation along each axis, rounding included.
    pub deviations: [f64; 3],
}

impl TrackShape {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Self); 8] = [
        ("straight", Self::Straight),
        ("ellipse", Self::Ellipse),
        ("smooth spline", Self::Spline),
        ("hairpins", Self::Hairpins),
        ("streets", Self::Streets),
        ("stops", Self::Stops),
        ("uneven spacing", Self::UnevenSpacing),
        ("random spacing", Self::RandomSpacing),
    ];

    /// The track of a seed, of 250 to 700 vertices, with noise `s` of the positions in spacings.
    pub fn track(self, axes: AxisNoise, s: f64, seed: u64) -> NoisyTrack {
        let mut random = Random::new(seed ^ ((self as u64 + 192) << 40));
        let steps = self.steps(&mut random);
        let length = steps.iter().sum();
        let clean = points_along(&self.way(length, &mut random), &steps);
        let mut deviations = axes.deviations(s);
        let mut draw = Random::new(seed.wrapping_add(0x00c0_ffee));
        let mut noisy: Vec<[f64; 3]> = clean
            .iter()
            .map(|p| {
                let v = draw.normals();
                std::array::from_fn(|k| p[k] + deviations[k] * v[k])
            })
            .collect();
        if axes == AxisNoise::RoundedHeights {
            for p in &mut noisy {
                p[2] = (p[2] / ROUNDING).round() * ROUNDING;
            }
            deviations[2] = deviations[2].hypot(ROUNDING / 12.0_f64.sqrt());
        }
        NoisyTrack { clean, noisy, deviations }
    }

    /// Distances of consecutive vertices along the way.
    fn steps(self, random: &mut Random) -> Vec<f64> {
        let n = 250 + random.index(451);
        let mut steps = vec![1.0; n - 1];
        match self {
            Self::Stops => {
                for _ in 0..3 + random.index(4) {
                    let stop = 10 + random.index(31);
                    let first = random.index(n - 1 - stop);
                    steps[first..first + stop].fill(0.0);
                }
            }
            Self::UnevenSpacing => {
                let (waves, phase) = (random.uniform_in(2.0, 5.0), random.uniform_in(0.0, TAU));
                for (k, step) in steps.iter_mut().enumerate() {
                    *step = (TAU * waves * k as f64 / n as f64 + phase).sin().exp();
                }
                let mean = steps.iter().sum::<f64>() / steps.len() as f64;
                for step in &mut steps {
                    *step /= mean;
                }
            }
            Self::RandomSpacing => steps.fill_with(|| random.uniform_in(0.5, 1.5)),
            _ => {}
        }
        steps
    }

    /// Dense points of a way of at least this length.
    fn way(self, length: f64, random: &mut Random) -> Vec<[f64; 3]> {
        let heading = random.uniform_in(0.0, TAU);
        match self {
            Self::Straight => {
                let rise = random.uniform_in(-0.3, 0.3);
                vec![[0.0; 3], [length * heading.cos(), length * heading.sin(), length * rise]]
            }
            Self::Ellipse => {
                let (ratio, tilt) = (random.uniform_in(0.3, 1.0), random.uniform_in(0.1, 0.5));
                let (sin, cos) = heading.sin_cos();
                let round = |t: f64| {
                    let (x, y) = ((TAU * t).cos(), ratio * (TAU * t).sin());
                    [cos * x - sin * y, sin * x + cos * y, tilt * x]
                };
                polyline(length, round)
            }
            Self::Hairpins | Self::Streets => self.legs(length, heading, random),
            _ => {
                let waves: Vec<([f64; 3], [f64; 3])> = (1..=4)
                    .map(|k| {
                        let size = f64::from(k).powf(-1.5);
                        let phases = [(); 3].map(|()| random.uniform_in(0.0, TAU));
                        ([size, size, 0.3 * size].map(|s| s * random.normal()), phases)
                    })
                    .collect();
                let sum = |t: f64| {
                    std::array::from_fn(|c| {
                        let wave = |(k, (size, phase)): (usize, &([f64; 3], [f64; 3]))| {
                            size[c] * (TAU * (k + 1) as f64 * t + phase[c]).sin()
                        };
                        waves.iter().enumerate().map(wave).sum()
                    })
                };
                polyline(length, sum)
            }
        }
    }

    /// Straight legs between half circles or corners.
    fn legs(self, length: f64, mut heading: f64, random: &mut Random) -> Vec<[f64; 3]> {
        let mut way = vec![[0.0; 3]];
        let mut left = length;
        let mut side = 1.0;
        while left > 0.0 {
            let (mut run, rise) = (random.uniform_in(10.0, 60.0), random.uniform_in(-0.15, 0.15));
            let mut ahead = |run: f64, heading: f64| {
                let p = way[way.len() - 1];
                way.push([p[0] + run * heading.cos(), p[1] + run * heading.sin(), p[2] + run * rise]);
                left -= run;
            };
            if self == Self::Hairpins {
                run = 0.25 * run + 15.0;
            }
            ahead(run, heading);
            side = -side;
            if self == Self::Hairpins {
                let radius = random.uniform_in(3.0, 6.0);
                for _ in 0..40 {
                    ahead(radius * PI / 40.0, heading + side * PI / 80.0);
                    heading += side * PI / 40.0;
                }
            } else {
                heading += [-1.0, 1.0][random.index(2)] * random.uniform_in(40.0, 120.0).to_radians();
            }
        }
        way
    }
}

/// Dense points of a curve over 0..=1, scaled to a length.
fn polyline(length: f64, curve: impl Fn(f64) -> [f64; 3]) -> Vec<[f64; 3]> {
    let points: Vec<[f64; 3]> = (0..=20_000).map(|k| curve(f64::from(k) / 20_000.0)).collect();
    let own: f64 = points.windows(2).map(|w| distance(w[0], w[1])).sum();
    // A little longer, so that the last point is not lost by rounding.
    points.into_iter().map(|p| p.map(|c| c * (1.0 + 1e-9) * length / own)).collect()
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    dot(minus(p, q), minus(p, q)).sqrt()
}

/// Points on a polyline at the sums of the steps.
fn points_along(way: &[[f64; 3]], steps: &[f64]) -> Vec<[f64; 3]> {
    let (mut points, mut k, mut passed) = (vec![way[0]], 0, 0.0);
    let mut at = 0.0;
    for step in steps {
        at += step;
        while k + 2 < way.len() && passed + distance(way[k], way[k + 1]) < at {
            passed += distance(way[k], way[k + 1]);
            k += 1;
        }
        let t = (at - passed) / distance(way[k], way[k + 1]);
        points.push(std::array::from_fn(|c| way[k][c] + t * (way[k + 1][c] - way[k][c])));
    }
    points
}

/// Numbers of vertices on either side of a vertex in the windows that the truth chooses from.
const WINDOWS: [usize; 14] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 192, usize::MAX];

impl NoisyTrack {
    /// Root mean square error of moved vertices along the noisy axes, in units of the noise of each.
    pub fn error(&self, points: &[[f64; 3]]) -> f64 {
        self.joint_error([0, 1, 2].map(|axis| self.axis_error(axis, points)))
    }

    /// [`error`](Self::error) of the quadratics over windows of one size for each axis, by order or by the true length,
    /// whichever **the truth chooses**.
    pub fn best_window_error(&self) -> f64 {
        let order: Vec<f64> = (0..self.noisy.len()).map(|k| k as f64).collect();
        let mut way = vec![0.0];
        for w in self.clean.windows(2) {
            way.push(way[way.len() - 1] + distance(w[0], w[1]));
        }
        let mut least = [f64::INFINITY; 3];
        for parameter in [&order, &way] {
            for size in WINDOWS {
                let fits: Vec<[f64; 3]> =
                    (0..order.len()).map(|x| quadratic(parameter, &self.noisy, x, size)).collect();
                for (axis, least) in least.iter_mut().enumerate() {
                    *least = least.min(self.axis_error(axis, &fits));
                }
            }
        }
        self.joint_error(least)
    }

    fn axis_error(&self, axis: usize, points: &[[f64; 3]]) -> f64 {
        root_mean_square(points.iter().zip(&self.clean).map(|(p, q)| p[axis] - q[axis]))
    }

    fn joint_error(&self, errors: [f64; 3]) -> f64 {
        let noisy: Vec<usize> = (0..3).filter(|&axis| self.deviations[axis] > 0.0).collect();
        root_mean_square(noisy.iter().map(|&axis| errors[axis] / self.deviations[axis]))
    }
}

/// Quadratics in the parameter over up to `size` vertices on either side of `x`, at `x`; the mean
/// where the parameters determine no quadratic.
fn quadratic(parameter: &[f64], points: &[[f64; 3]], x: usize, size: usize) -> [f64; 3] {
    let window = x.saturating_sub(size)..x.saturating_add(size).saturating_add(1).min(points.len());
    let (mut matrix, mut right) = (Matrix3::zeros(), Matrix3::zeros());
    let reach = parameter[window.end - 1] - parameter[window.start];
    for y in window.clone() {
        let t = if reach > 0.0 { (parameter[y] - parameter[x]) / reach } else { 0.0 };
        let m = Vector3::new(1.0, t, t * t);
        matrix += m * m.transpose();
        right += m * Vector3::from(points[y]).transpose();
    }
    let solved = matrix.cholesky().filter(|factor| factor.l().diagonal().min() > 1e-6);
    let values = solved.map_or_else(|| right.row(0) / window.len() as f64, |f| f.solve(&right).row(0).into());
    [values[0], values[1], values[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracks_have_unit_steps_and_the_stated_noise() {
        for (name, shape) in TrackShape::ALL {
            let track = shape.track(AxisNoise::RoundedHeights, 0.2, 3);
            assert!((250..=700).contains(&track.clean.len()), "{name}");
            let steps: Vec<f64> = track.clean.windows(2).map(|w| distance(w[0], w[1])).collect();
            let moving: Vec<f64> = steps.iter().copied().filter(|s| *s > 0.0).collect();
            let mean = moving.iter().sum::<f64>() / moving.len() as f64;
            // Corners and bends shorten the chords.
            assert!(
                (0.95..1.001 + 0.05 * f64::from(shape == TrackShape::RandomSpacing)).contains(&mean),
                "{name}: {mean}"
            );
            let error = track.error(&track.noisy);
            assert!((0.8..1.2).contains(&error), "{name}: {error}");
            assert_eq!(track.error(&track.clean), 0.0);
        }
    }

    #[test]
    fn a_quadratic_over_a_straight_line_leaves_the_root_of_the_degrees_of_freedom() {
        let track = TrackShape::Straight.track(AxisNoise::Equal, 0.3, 2);
        let left = track.best_window_error() * (track.clean.len() as f64 / 3.0).sqrt();
        assert!((0.4..1.8).contains(&left), "{left}");
    }
}
