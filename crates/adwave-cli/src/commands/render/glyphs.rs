//! Vectors, lines and crosses on a shape, drawn as rows of balls.

use crate::error::CliError;
use crate::global::Global;
use crate::output::count;
use crate::resolve::operator::build_decomposer;
use crate::resolve::shape::Input;
use crate::resolve::signal::load_signal;
use adwave::directions::{Directions, Symmetry};
use adwave::operator::OperatorParams;
use adwave::shape::{diagonal, picture_frame};
use adwave::vector::{Vector, add_scaled, cross, dot, norm};
use adwave_render::Ball;
use std::collections::HashMap;

/// Color of the glyphs.
const DARK: [u8; 3] = [38, 42, 56];

/// Distance of glyphs in diagonals of the part that the picture shows: some hundred glyphs on one side of a shape.
const DISTANCE: f64 = 0.035;

/// Share of the lengths above which all are drawn alike, so that a few long vectors do not shorten all others.
const LONGEST: f64 = 0.98;

/// Balls of one line, whose distances are smaller than their radii.
const BALLS_PER_LINE: usize = 40;

/// Radii relative to the distance of glyphs: of a line, and of a cone at both of its ends.
const LINE_RADIUS: f64 = 0.05;
const CONE_RADII: [f64; 2] = [0.13, 0.03];

/// Glyphs on a shape.
#[derive(Default)]
pub(super) struct Glyphs {
    pub(super) balls: Vec<Ball>,
    /// Number of vertices with a glyph.
    pub(super) count: usize,
}

/// Balls along the vectors of a field at vertices about equally far from each other: a cone in the direction of each
/// vector, a line for each line, two for each cross. The longest reach to the next glyph.
pub(super) fn draw_glyphs(
    input: &Input,
    name: &str,
    symmetry: Symmetry,
    global: &Global<'_>,
) -> Result<Glyphs, CliError> {
    let signal = load_signal(global, input, name, None)?;
    if signal.n_channels != 3 {
        return Err(CliError::Input(format!(
            "--glyphs takes vectors of three components, and {name} has {} at each vertex",
            count(signal.n_channels, "number", "numbers")
        )));
    }
    let progress = global.progress();
    let decomposer = build_decomposer(input, &OperatorParams::default(), progress)?;
    let directions = Directions::new(&decomposer, symmetry, progress)?;
    let (vectors, _): (&[Vector], _) = signal.values.as_chunks();
    let points = input.shape.points().unwrap_or_default();
    let size = picture_frame(points, None).map_or(0.0, |(low, high)| diagonal(&[low, high]));
    let distance = DISTANCE * if size > 0.0 { size } else { diagonal(points) };
    let is_drawn = |&v: &usize| {
        let length = norm(&vectors[v]);
        length > 0.0 && length.is_finite() && points[v].iter().all(|c| c.is_finite())
    };
    let chosen = spread_out(points, distance, (0..points.len()).filter(is_drawn));
    let mut lengths: Vec<f64> = chosen.iter().map(|&v| norm(&vectors[v])).collect();
    lengths.sort_by(f64::total_cmp);
    let Some(&longest) = lengths.get(((lengths.len() as f64 - 1.0) * LONGEST).max(0.0) as usize) else {
        return Ok(Glyphs::default());
    };
    let n_chosen = chosen.len();
    let mut balls = Vec::with_capacity(2 * BALLS_PER_LINE * n_chosen);
    for v in chosen {
        let length = norm(&vectors[v]);
        let share = (length / longest).min(1.0);
        let along = vectors[v].map(|c| distance * share / length * c);
        // Thinner where it is shorter, so that a short one still points somewhere.
        let width = distance * (0.4 + 0.6 * share);
        let line = |direction: &Vector, balls: &mut Vec<Ball>| {
            let start = add_scaled(&points[v], -0.5, direction);
            add_line(&start, direction, [LINE_RADIUS * width; 2], balls);
        };
        match symmetry {
            Symmetry::Vectors => add_line(&points[v], &along, CONE_RADII.map(|r| r * width), &mut balls),
            Symmetry::Lines => line(&along, &mut balls),
            Symmetry::Crosses => {
                let normal = directions.plane(v).normal;
                let flat = add_scaled(&along, -dot(&along, &normal), &normal);
                line(&flat, &mut balls);
                line(&cross(&normal, &flat), &mut balls);
            }
        }
    }
    Ok(Glyphs { balls, count: n_chosen })
}

/// Vertices in cells of a size, in each the one closest to its center.
fn spread_out(points: &[[f64; 3]], size: f64, vertices: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut closest: HashMap<[i64; 3], (f64, usize)> = HashMap::new();
    for v in vertices {
        let place = points[v].map(|c| if size > 0.0 { c / size } else { 0.0 });
        let cell = place.map(|c| c.floor() as i64);
        let off = [0, 1, 2].map(|c| place[c] - place[c].floor() - 0.5);
        let found = (dot(&off, &off), v);
        closest
            .entry(cell)
            .and_modify(|best| *best = if found < *best { found } else { *best })
            .or_insert(found);
    }
    let mut chosen: Vec<usize> = closest.into_values().map(|(_, v)| v).collect();
    chosen.sort_unstable();
    chosen
}

/// Balls from `start` along `direction`, whose radii change from the first to the last.
fn add_line(start: &Vector, direction: &Vector, [first, last]: [f64; 2], balls: &mut Vec<Ball>) {
    for k in 0..BALLS_PER_LINE {
        let t = k as f64 / (BALLS_PER_LINE - 1) as f64;
        let center = add_scaled(start, t, direction);
        balls.push(Ball { center, radius: first + t * (last - first), color: DARK });
    }
}
