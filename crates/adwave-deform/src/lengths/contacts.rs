//! Vertices that come near each other and were farther apart at rest.

use adwave::shape::{Adjacency, try_nearest_neighbors};
use adwave::vector::{Vector, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of neighbors through space among which contacts are sought.
const N_NEAREST: usize = 16;

/// Distance that pairs keep, in lengths of the edges at their vertices.
const KEPT: f64 = 1.0;

/// Largest distance of a vertex in lengths of its shortest edge, so that a long and thin triangle has few contacts.
const LONGEST: f64 = 2.0;

/// Distance beyond that which is kept, up to which pairs are listed, in mean edges.
pub(super) const MARGIN: f64 = 1.0;

/// Pairs of vertices that push each other apart: `½ μ Σ (d − |x_u − x_v|)²` where the distance is below d, the smaller
/// of the kept distance and the distance at rest.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    pairs: Vec<Contact>,
    /// Weight μ.
    weight: f64,
}

#[derive(Clone, Copy, Debug)]
struct Contact {
    first: u32,
    second: u32,
    kept: f64,
}

/// Distance that each vertex keeps from others.
pub(super) fn kept_distances(neighbors: &Adjacency, rest: &[Vector]) -> Vec<f64> {
    let kept = |x: usize| {
        let mut lengths: Vec<f64> =
            neighbors.row(x).iter().map(|&y| norm(&subtract(&rest[y as usize], &rest[x]))).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        let Some(&shortest) = lengths.first() else { return 0.0 };
        KEPT * lengths[lengths.len() / 2].min(LONGEST * shortest)
    };
    (0..rest.len()).into_par_iter().map(kept).collect()
}

impl Contacts {
    /// Pairs near each other at `points` of which at least one vertex is free. `weight` is μ, `margin` a distance in
    /// model units.
    pub(super) fn new(
        points: &[Vector],
        rest: &[Vector],
        kept: &[f64],
        is_free: &[bool],
        margin: f64,
        weight: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let places = near_free(points, is_free, margin + kept.iter().copied().fold(0.0, f64::max));
        let chosen: Vec<Vector> = places.iter().map(|&x| points[x as usize]).collect();
        let near = try_nearest_neighbors(&chosen, N_NEAREST, progress)?.adjacency;
        let rows: Vec<Vec<Contact>> = (0..places.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|k| {
                let x = places[k] as usize;
                let contact =
                    |&l: &u32| {
                        let y = places[l as usize] as usize;
                        let apart = norm(&subtract(&rest[x], &rest[y]));
                        let kept = kept[x].min(kept[y]).min(apart);
                        let is_near = norm(&subtract(&points[x], &points[y])) < kept + margin;
                        // A pair that each has among its nearest is listed at the smaller number.
                        let is_listed = y < x && near.row(l as usize).binary_search(&(k as u32)).is_ok();
                        (is_near && kept > 0.0 && !is_listed && (is_free[x] || is_free[y]))
                            .then_some(Contact { first: x as u32, second: y as u32, kept })
                    };
                near.row(k).iter().filter_map(contact).collect()
            })
            .collect();
        Ok(Self { pairs: rows.concat(), weight })
    }

    /// Adds the gradient at free vertices and returns the energy.
    pub(super) fn add_to(&self, points: &[Vector], is_free: &[bool], gradient: &mut [Vector]) -> f64 {
        let mut energy = 0.0;
        for &Contact { first, second, kept } in &self.pairs {
            let (x, y) = (first as usize, second as usize);
            let d = subtract(&points[x], &points[y]);
            let squared = dot(&d, &d);
            if squared >= kept * kept {
                continue;
            }
            let long = squared.sqrt();
            energy += 0.5 * self.weight * (kept - long) * (kept - long);
            let factor = if long > 0.0 { self.weight * (kept - long) / long } else { 0.0 };
            for (v, sign) in [(x, -1.0), (y, 1.0)] {
                if is_free[v] {
                    for c in 0..3 {
                        gradient[v][c] += sign * factor * d[c];
                    }
                }
            }
        }
        energy
    }
}

/// Free vertices, and the others in their box enlarged by a distance; ascending.
fn near_free(points: &[Vector], is_free: &[bool], distance: f64) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (p, _) in points.iter().zip(is_free).filter(|(_, free)| **free) {
        for c in 0..3 {
            low[c] = low[c].min(p[c] - distance);
            high[c] = high[c].max(p[c] + distance);
        }
    }
    let is_near = |x: &u32| {
        let p = &points[*x as usize];
        is_free[*x as usize] || (0..3).all(|c| low[c] <= p[c] && p[c] <= high[c])
    };
    (0..points.len() as u32).filter(is_near).collect()
}
