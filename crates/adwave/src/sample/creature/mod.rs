//! The creature: a standing figure with shell, ears, snout, claws and tail, a stand-in for the scanned armadillo that
//! shape-processing papers show.
//!
//! It is an implicit surface in model units, so every number of vertices samples one and the same shape: parts made
//! of round cones ([`body`]), joined with fillets, and skin carved in ([`skin`]). y is up, it faces +z, and it is
//! about 1.9 units high.

mod body;
mod part;
mod skin;

use super::SampleError;
use super::implicit::{Implicit, V3, smooth_carve, smooth_union, smoothstep};
use super::polygonise::{CrossedGrid, Surface};
use super::relax::{opposite_corners, relax};
use part::Part;

/// The fewest vertices at which fingers and ears are resolved enough to be what they are.
pub(super) const MIN_VERTICES: usize = 2_000;
/// The number of vertices is met within this part of the number asked for.
pub(super) const COUNT_TOLERANCE: f64 = 0.015;
/// Vertices of the trial grid that tells how the count grows, at most.
const TRIAL_VERTICES: usize = 60_000;
/// Grids tried until count and genus fit.
const MAX_TRIES: usize = 12;
/// Surface area in model units squared times vertices per cell area: first guess of the spacing only.
const FIRST_GUESS: f64 = 6.0;
/// Parts within this distance of the nearest one share their skin, model units.
const SKIN_BLEND: f64 = 0.03;
/// The soles are cut flat at y = 0 with this rounding, model units.
const SOLE_ROUNDING: f64 = 0.02;

/// The creature as a function of space.
#[derive(Debug)]
pub(super) struct Creature {
    parts: Vec<Part>,
    low: V3,
    high: V3,
}

impl Creature {
    pub(super) fn new() -> Self {
        let parts = body::parts();
        let mut low = V3::repeat(f64::INFINITY);
        let mut high = V3::repeat(f64::NEG_INFINITY);
        for (centre, radius) in parts.iter().flat_map(Part::balls) {
            let reach = V3::repeat(radius + skin::MAX_HEIGHT);
            low = low.inf(&(centre - reach));
            high = high.sup(&(centre + reach));
        }
        Self { parts, low, high }
    }

    /// Distance to the joined parts without skin, and each part's own distance where it matters.
    fn joined(&self, p: V3, mut note: impl FnMut(usize, f64)) -> f64 {
        let mut total = f64::INFINITY;
        for (i, part) in self.parts.iter().enumerate() {
            // Beyond the fillet's width the union is the smaller one to the last bit, so skipping changes nothing.
            if part.farther_than(p, total + part.blend.max(SKIN_BLEND)) {
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
        const MOST_PARTS: usize = 32;
        let mut near = [(0, 0.0); MOST_PARTS];
        let mut n_near = 0;
        let total = self.joined(p, |i, distance| {
            near[n_near] = (i, distance);
            n_near += 1;
        });
        if total.abs() > 2.0 * skin::MAX_HEIGHT {
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

    fn coarse(&self, p: V3) -> f64 {
        self.joined(p, |_, _| ())
    }

    fn slack(&self) -> f64 {
        skin::MAX_HEIGHT
    }

    fn bounds(&self) -> (V3, V3) {
        (self.low, self.high)
    }
}

/// The creature as a closed triangle mesh of genus 0 with `n_vertices` vertices within [`COUNT_TOLERANCE`].
///
/// The count is steered by the grid's spacing h, as it grows like 1/h². A grid on which thin parts break off or
/// touch (Euler characteristic other than 2, or several components) is left for one slightly finer.
///
/// # Errors
/// [`SampleError::NotReached`] when no grid tried gives that count and a sphere's topology.
pub(super) fn creature(n_vertices: usize) -> Result<Surface, SampleError> {
    let field = Creature::new();
    let target = n_vertices as f64;
    let trial = target.min(TRIAL_VERTICES as f64);
    let mut per_cell_area = FIRST_GUESS;
    if n_vertices > TRIAL_VERTICES {
        let spacing = (per_cell_area / trial).sqrt();
        per_cell_area = CrossedGrid::new(&field, spacing).n_vertices() as f64 * spacing * spacing;
    }
    let mut nudge = 1.0;
    for _ in 0..MAX_TRIES {
        let spacing = (per_cell_area / (target * nudge)).sqrt();
        let grid = CrossedGrid::new(&field, spacing);
        let count = grid.n_vertices() as f64;
        per_cell_area = count * spacing * spacing;
        if (count - target).abs() > COUNT_TOLERANCE * target {
            continue;
        }
        let mut surface = grid.into_surface();
        if is_sphere(&surface) {
            relax(&field, &mut surface);
            return Ok(surface);
        }
        // Another grid within the tolerance, above and below in turn.
        nudge = if nudge > 1.0 { 2.0 - nudge } else { 2.0 - nudge + 0.2 * COUNT_TOLERANCE };
    }
    Err(SampleError::NotReached { name: "creature", n_vertices, tries: MAX_TRIES })
}

/// One component and Euler characteristic 2.
fn is_sphere(surface: &Surface) -> bool {
    let n_faces = surface.triangles.len();
    if surface.points.len() + n_faces != 3 * n_faces / 2 + 2 {
        return false;
    }
    let opposite = opposite_corners(&surface.triangles);
    let mut seen = vec![false; n_faces];
    let mut open = vec![0];
    let mut n_seen = 0;
    while let Some(face) = open.pop() {
        if !std::mem::replace(&mut seen[face], true) {
            n_seen += 1;
            open.extend((0..3).map(|k| opposite[3 * face + k] as usize / 3));
        }
    }
    n_seen == n_faces
}
