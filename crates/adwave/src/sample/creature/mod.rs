//! The creature: a standing figure with shell, ears, snout, claws and tail, instead of the scanned armadillo of
//! shape-processing papers.
//!
//! It is an implicit surface in model units, so every number of vertices samples the same shape: parts made of
//! round cones ([`body`]), joined with fillets, with carved skin ([`skin`]). y is up, it faces +z, and it is about
//! 2 units high.

mod body;
mod part;
mod skin;

use super::SampleError;
use super::implicit::{Implicit, Side, V3, smooth_carve, smooth_union, smoothstep};
use super::polygonize::{CrossedGrid, SampledSurface};
use super::relax::{opposite_corners, relax};
use part::BodyPart;

/// Smallest number of vertices that resolves fingers and ears.
pub(super) const MIN_VERTICES: usize = 2_000;
/// Largest relative deviation from the requested number of vertices.
pub(super) const COUNT_TOLERANCE: f64 = 0.018;
/// Number of vertices of the finer trial grid, which shows how the count grows.
const TRIAL_VERTICES: usize = 150_000;
/// Maximal number of grids tried until count and genus match.
const MAX_TRIES: usize = 12;
/// Number of vertices times cell area, model units squared: about 3/2 of the surface area. Only a first guess.
const FIRST_GUESS: f64 = 7.6;
/// Distance from the nearest part within which parts share their skin, model units.
const SKIN_BLEND: f64 = 0.03;
/// Largest depth of a fillet below the nearest part, model units.
const FILLET_DEPTH: f64 = 0.03;
/// Margin around the bones for fillets and skin, model units.
const MARGIN: f64 = 0.03;
/// Upper bound of the number of parts.
const MAX_PARTS: usize = 32;
/// Rounding with which the soles are cut flat at y = 0, model units.
const SOLE_ROUNDING: f64 = 0.02;

/// The creature as an implicit function.
#[derive(Debug)]
pub(super) struct Creature {
    parts: Vec<BodyPart>,
    low: V3,
    high: V3,
}

impl Creature {
    pub(super) fn new() -> Self {
        let parts = body::parts();
        assert!(parts.len() <= MAX_PARTS);
        let mut low = V3::repeat(f64::INFINITY);
        let mut high = V3::repeat(f64::NEG_INFINITY);
        for (center, radius) in parts.iter().flat_map(BodyPart::balls) {
            let reach = V3::repeat(radius + MARGIN);
            low = low.inf(&(center - reach));
            high = high.sup(&(center + reach));
        }
        Self { parts, low, high }
    }

    /// Distance to the joined parts without skin. `note` is called for the parts, each with its own distance, that
    /// come within [`SKIN_BLEND`] of the nearest one anywhere in the ball of radius `reach` around `p`.
    fn union_distance(&self, p: V3, reach: f64, mut note: impl FnMut(usize, f64)) -> f64 {
        let mut total = f64::INFINITY;
        for (i, part) in self.parts.iter().enumerate() {
            // Beyond the width of the fillet the union equals the smaller value exactly, so skipping changes
            // nothing.
            if part.is_farther_than(p, total + part.blend.max(SKIN_BLEND + FILLET_DEPTH) + 2.0 * reach) {
                continue;
            }
            let distance = part.distance(p);
            note(i, distance);
            total = if total.is_finite() { smooth_union(total, distance, part.blend) } else { distance };
        }
        smooth_carve(total, p.y, SOLE_ROUNDING)
    }
}

impl Implicit for Creature {
    fn value(&self, p: V3) -> f64 {
        let mut near = [(0, 0.0); MAX_PARTS];
        let (mut n_near, mut highest) = (0, 0.0_f64);
        let total = self.union_distance(p, 0.0, |i, distance| {
            near[n_near] = (i, distance);
            n_near += 1;
            highest = highest.max(self.parts[i].highest_skin());
        });
        if total.abs() > highest {
            return total;
        }
        let near = &near[..n_near];
        let nearest = near.iter().map(|n| n.1).fold(f64::INFINITY, f64::min);
        let (mut height, mut weights) = (0.0, 0.0);
        for &(i, distance) in near {
            let weight = smoothstep(SKIN_BLEND, 0.0, distance - nearest);
            if weight > 0.0 {
                height += weight * self.parts[i].skin_height(p);
                weights += weight;
            }
        }
        // The soles stay flat.
        total - height / weights * smoothstep(0.0, 0.05, p.y)
    }

    fn side_of_ball(&self, center: V3, radius: f64) -> Option<Side> {
        // The joined parts are 1-Lipschitz; the skin adds at most its height.
        let mut highest = 0.0_f64;
        let total =
            self.union_distance(center, radius, |i, _| highest = highest.max(self.parts[i].highest_skin()));
        (total.abs() > radius + highest).then_some(if total < 0.0 { Side::Inside } else { Side::Outside })
    }

    fn bounds(&self) -> (V3, V3) {
        (self.low, self.high)
    }
}

/// The creature as a closed triangle mesh of genus 0 with `n_vertices` vertices within [`COUNT_TOLERANCE`].
///
/// The spacing h of the grid controls the count, which grows like 1/h². A grid on which thin parts break off or
/// touch (Euler characteristic other than 2, or several components) is replaced by a slightly finer one.
///
/// # Errors
/// [`SampleError::NotReached`] if no grid tried gives that count and the topology of a sphere.
pub(super) fn creature(n_vertices: usize) -> Result<SampledSurface, SampleError> {
    let field = Creature::new();
    let target = n_vertices as f64;
    let mut per_cell_area = FIRST_GUESS;
    let mut nudge = 1.0;
    if n_vertices > 2 * TRIAL_VERTICES {
        // Finer grids resolve more of the skin: vertices times cell area, c(h), grows about linearly as h
        // decreases.
        let h = (FIRST_GUESS / TRIAL_VERTICES as f64).sqrt();
        let c = [2.0 * h, h].map(|h| CrossedGrid::new(&field, h).n_vertices() as f64 * h * h);
        let finer = (c[1] / target).sqrt();
        per_cell_area = c[1] + (c[1] - c[0]) * (h - finer) / h;
    }
    for _ in 0..MAX_TRIES {
        let spacing = (per_cell_area / (target * nudge)).sqrt();
        let mut surface = CrossedGrid::new(&field, spacing).into_surface();
        keep_largest_component(&mut surface);
        let count = surface.points.len() as f64;
        if (count - target).abs() > COUNT_TOLERANCE * target {
            per_cell_area = count * spacing * spacing;
            continue;
        }
        if euler_characteristic(&surface) == 2 {
            relax(&field, &mut surface);
            return Ok(surface);
        }
        // Other grids within the tolerance, alternately finer and coarser.
        nudge = if nudge > 1.0 { 2.0 - nudge } else { 2.0 - nudge + 0.15 * COUNT_TOLERANCE };
    }
    Err(SampleError::NotReached { name: "creature", n_vertices, tries: MAX_TRIES })
}

/// Vertices − edges + faces of a closed triangle mesh.
fn euler_characteristic(surface: &SampledSurface) -> i64 {
    surface.points.len() as i64 - surface.triangles.len() as i64 / 2
}

/// Removes all but the component with the most vertices: tips of claws may break off on coarse grids, and a crest
/// of the skin on fine ones.
fn keep_largest_component(surface: &mut SampledSurface) {
    let opposite = opposite_corners(&surface.triangles);
    let mut component = vec![u32::MAX; surface.triangles.len()];
    let mut sizes = Vec::new();
    let mut open = Vec::new();
    for start in 0..component.len() {
        if component[start] != u32::MAX {
            continue;
        }
        let name = sizes.len() as u32;
        let mut size = 0_usize;
        component[start] = name;
        open.push(start);
        while let Some(face) = open.pop() {
            size += 1;
            for k in 0..3 {
                let next = opposite[3 * face + k] as usize / 3;
                if component[next] == u32::MAX {
                    component[next] = name;
                    open.push(next);
                }
            }
        }
        sizes.push(size);
    }
    if sizes.len() < 2 {
        return;
    }
    // The first of the largest components.
    let largest = (0..sizes.len()).rev().max_by_key(|&c| sizes[c]).expect("two or more") as u32;
    let mut faces = component.iter();
    surface.triangles.retain(|_| faces.next() == Some(&largest));
    let mut new_index = vec![u32::MAX; surface.points.len()];
    for &v in surface.triangles.as_flattened() {
        new_index[v as usize] = 0;
    }
    for (kept, index) in (0..).zip(new_index.iter_mut().filter(|i| **i == 0)) {
        *index = kept;
    }
    let mut index = new_index.iter();
    surface.points.retain(|_| index.next() != Some(&u32::MAX));
    for v in surface.triangles.as_flattened_mut() {
        *v = new_index[*v as usize];
    }
}
