//! Greatest distance from one shape to another.

use super::distances::{fact, surface};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, number};
use adwave::shape::PreparedGeometry;
use adwave::vector::{add_scaled, cross, norm, subtract};
use adwave_register::{Signs, signed_distances};
use adwave_report::page::Fact;
use adwave_simplify::{Triangles, surface_distance};
use serde_json::{Value, json};

/// Most samples of triangles whose distance to a cloud is measured.
const MOST_SAMPLES: f64 = 200_000.0;

/// Places whose distances count.
enum Places {
    /// All points of all triangles; the distance is within a hundredth of this upper bound.
    Surface {
        bound: f64,
    },
    /// Vertices and samples between them.
    Samples(usize),
    Vertices,
}

/// Greatest distance from one shape to another, beyond borders too.
pub(super) struct Reach {
    /// Greatest distance in model units; NaN if all places are beyond the limit.
    pub(super) greatest: f64,
    /// Greatest distance of the vertices that are not beyond a border; NaN without any.
    within_borders: f64,
    places: Places,
    n_vertices: usize,
    n_beyond_border: usize,
    n_too_far: usize,
}

impl Reach {
    /// Measures the distance from the first of two shapes to the second, which has a name. A finite limit leaves out
    /// vertices that are farther, and all places between vertices.
    pub(super) fn measure(
        [from, to]: [&PreparedGeometry; 2],
        name: &str,
        limit: f64,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        let target = surface(to, name, global)?;
        let points = from.points();
        let found = with_progress(global, "measuring", |progress| {
            signed_distances(points, &Signs::Nothing, &target, limit, progress)
        })
        .map_err(|_| CliError::Cancelled)?;
        let at_vertices = points.iter().zip(&found.closest).map(|(p, c)| norm(&subtract(p, &c.point)));
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NAN, f64::max);
        let mut reach = Self {
            greatest: largest(&mut at_vertices.filter(|d| *d <= limit)),
            within_borders: largest(&mut found.values.iter().copied()),
            places: Places::Vertices,
            n_vertices: points.len(),
            n_beyond_border: found.n_beyond_border,
            n_too_far: found.n_too_far,
        };
        if limit.is_finite() || from.triangles().is_empty() {
            return Ok(reach);
        }
        if to.triangles().is_empty() {
            let samples = samples(from, to.points().len());
            for p in &samples {
                reach.greatest = reach.greatest.max(norm(&subtract(p, &target.closest(p).point)));
            }
            reach.places = Places::Samples(samples.len());
            return Ok(reach);
        }
        let [a, b] = [from, to].map(|g| Triangles { points: g.points(), triangles: g.triangles() });
        let between = with_progress(global, "measuring", |progress| surface_distance(a, b, progress))
            .map_err(|_| CliError::Cancelled)?;
        if let Some(between) = between {
            // The distance at a vertex was measured without rounding to a common box.
            if between.at_least > reach.greatest * (1.0 + 1e-9) {
                reach.greatest = between.at_least;
            }
            let rounding = 1e-12 * from.shape().diagonal().max(to.shape().diagonal());
            let bound = if between.greatest <= rounding { reach.greatest } else { between.greatest };
            reach.places = Places::Surface { bound: bound.max(reach.greatest) };
        }
        Ok(reach)
    }

    /// Facts on the distance from the first of two shapes to the second.
    pub(super) fn facts(&self, names: [&str; 2], name: &str) -> Vec<Fact> {
        let mut facts = vec![fact(name, number(self.greatest), &self.meaning(names))];
        let [from, to] = names;
        if self.n_beyond_border > 0 {
            let of = count(self.n_vertices, "vertex", "vertices");
            let others = if self.within_borders.is_nan() {
                String::new()
            } else {
                format!("; the others are at most {} away", number(self.within_borders))
            };
            let meaning = format!("of {from} lie beyond a border of {to}{others}");
            facts.push(fact("beyond", format!("{} of {of}", self.n_beyond_border), &meaning));
        }
        facts
    }

    /// Words for the greatest distance.
    pub(super) fn meaning(&self, [from, to]: [&str; 2]) -> String {
        match self.places {
            Places::Surface { bound } if bound > self.greatest => {
                format!(
                    "greatest distance from {from} to {to}, between vertices too (nowhere above {})",
                    number(bound)
                )
            }
            Places::Surface { .. } => format!("greatest distance from {from} to {to}, between vertices too"),
            Places::Samples(n) => format!(
                "greatest distance from {from} to {to}, at its vertices and {} between them",
                count(n, "sample", "samples")
            ),
            Places::Vertices if self.n_too_far > 0 => format!(
                "greatest distance from {from} to {to} within the limit; {} of {from} are farther",
                count(self.n_too_far, "vertex", "vertices")
            ),
            Places::Vertices => format!("greatest distance from {from} to {to}, at its vertices"),
        }
    }

    pub(super) fn json(&self) -> Value {
        let bound = if let Places::Surface { bound } = self.places { Some(bound) } else { None };
        let within = Some(self.within_borders).filter(|d| !d.is_nan());
        let mut json = json!({
            "greatest": self.greatest, "vertices": self.n_vertices, "beyond_border": self.n_beyond_border,
            "too_far": self.n_too_far,
        });
        if let Some(within) = within {
            json["greatest_within_borders"] = json!(within);
        }
        if let Some(bound) = bound {
            json["bound"] = json!(bound);
        }
        json
    }
}

/// Places inside of triangles, as dense as the points of a cloud would be on their area.
fn samples(mesh: &PreparedGeometry, n_points: usize) -> Vec<[f64; 3]> {
    let corners = |t: &[u32; 3]| t.map(|x| mesh.points()[x as usize]);
    let area = |[a, b, c]: [[f64; 3]; 3]| 0.5 * norm(&cross(&subtract(&b, &a), &subtract(&c, &a)));
    let total: f64 = mesh.triangles().iter().map(|t| area(corners(t))).sum();
    let n = (n_points as f64).max(3.0 * mesh.triangles().len() as f64).min(MOST_SAMPLES);
    let mut samples = Vec::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = corners(triangle);
        // A grid of k steps has (k + 1)(k + 2)/2 places.
        let k = (2.0 * n * area([a, b, c]) / total).sqrt().ceil().max(1.0) as usize;
        for i in 0..=k {
            for j in 0..=(k - i) {
                let (s, t) = (i as f64 / k as f64, j as f64 / k as f64);
                samples.push(add_scaled(&add_scaled(&a, s, &subtract(&b, &a)), t, &subtract(&c, &a)));
            }
        }
    }
    samples
}
