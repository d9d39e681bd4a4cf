//! Energy of positions that keep the lengths of edges.
//!
//! `E(x) = t [(1 − α) Σ_e w_e (|x_e| − |f_e|)² + α A(x) + κ B(x)] + (1 − t) Σ_e w_e |x_e − d_e|² + C(x)`, all halved.
//!
//! `w_e = 1/|f_e|²` for an edge `f_e` of the shape; `d_e` is the edge in the detail mode. A is the as-rigid-as-possible
//! energy of `sorkine2007` with these weights and B the sum of `D_v |δ_v(x) − R_v δ_v(f)|²` with `δ = D⁻¹ L x`, the
//! difference between a vertex and the weighted mean of its neighbors; both have the same rotations R_v, which are the
//! best ones. C pushes vertices apart that were farther apart at rest.

use super::contacts::Contacts;
use crate::coarse_base::ROWS_AT_A_TIME;
use crate::rotation::{Matrix, add_outer, compose, determinant, exponential, image, normalized, to_matrix};
use adwave::shape::Adjacency;
use adwave::vector::{Vector, cross, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Share α of the as-rigid-as-possible energy, which lets edges shear less than springs alone.
const RIGID_SHARE: f64 = 0.1;

/// Weight κ of the differences between vertices and the means of their neighbors.
const BENDING: f64 = 0.5;

/// Least length of an edge in the weights, in mean lengths: a shorter one would dominate.
const LEAST_LENGTH: f64 = 0.1;

/// Newton steps of a best rotation at most; the last one is near.
const MAX_TURNS: usize = 6;

/// Squared rotation at which the best one is found: the next step would be its square.
const TURN_FOUND: f64 = 1e-10;

/// Least curvature along an axis, relative to the largest possible one, with which a Newton step turns about it.
const LEAST_CURVATURE: f64 = 0.02;

/// Edges of the shape with their weights, and the share t of lengths.
#[derive(Debug)]
pub(super) struct LengthEnergy {
    pub(super) neighbors: Adjacency,
    /// Weight w of each entry of the neighbors.
    weights: Vec<f64>,
    /// Sum D of the weights of each vertex.
    pub(super) sums: Vec<f64>,
    /// Positions at rest.
    rest: Vec<Vector>,
    /// `δ` of the positions at rest.
    rest_offsets: Vec<Vector>,
    pub(super) is_free: Vec<bool>,
    /// Free vertices.
    pub(super) free: Vec<u32>,
    /// Free vertices and their neighbors, ascending.
    active: Vec<u32>,
    /// Number of each vertex in `active`; `u32::MAX` of others.
    active_number: Vec<u32>,
    /// Share t.
    pub(super) share: f64,
    /// Mean length of the edges.
    pub(super) unit: f64,
}

/// Values of the last evaluation.
#[derive(Clone, Debug)]
pub(super) struct LengthState {
    /// Positions.
    pub(super) points: Vec<Vector>,
    /// Rotations R_v as quaternions.
    pub(super) turns: Vec<[f64; 4]>,
    pub(super) gradient: Vec<Vector>,
    pub(super) value: f64,
}

/// Values of a vertex that its neighbors' gradients need.
#[derive(Clone, Copy)]
struct VertexFrame {
    turn: [f64; 4],
    rotation: Matrix,
    /// `δ(x) − R δ(f)`.
    residual: Vector,
    energy: f64,
}

impl LengthEnergy {
    pub(super) fn new(neighbors: &Adjacency, rest: &[Vector], is_free: Vec<bool>, share: f64) -> Self {
        let n = rest.len();
        let lengths =
            |x: usize| neighbors.row(x).iter().map(move |&y| norm(&subtract(&rest[y as usize], &rest[x])));
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for x in 0..n {
            for length in lengths(x) {
                (sum, count) = (sum + length, count + 1.0);
            }
        }
        let unit = if sum > 0.0 { sum / count } else { 1.0 };
        let weight = |length: f64| 1.0 / length.max(LEAST_LENGTH * unit).powi(2);
        let weights: Vec<f64> = (0..n).flat_map(|x| lengths(x).map(weight)).collect();
        let mut is_active = is_free.clone();
        for x in (0..n).filter(|&x| is_free[x]) {
            for &y in neighbors.row(x) {
                is_active[y as usize] = true;
            }
        }
        let numbered = |is: &[bool]| -> Vec<u32> { (0..n as u32).filter(|&x| is[x as usize]).collect() };
        let (free, active) = (numbered(&is_free), numbered(&is_active));
        let mut active_number = vec![u32::MAX; n];
        for (k, &x) in (0..).zip(&active) {
            active_number[x as usize] = k;
        }
        let mut own = Self {
            neighbors: neighbors.clone(),
            weights,
            sums: Vec::new(),
            rest: rest.to_vec(),
            rest_offsets: Vec::new(),
            is_free,
            free,
            active,
            active_number,
            share,
            unit,
        };
        own.sums = (0..n).map(|x| own.edges(x).map(|(_, w)| w).sum()).collect();
        own.rest_offsets = (0..n).map(|x| own.offset(&own.rest, x)).collect();
        own
    }

    /// Neighbors of a vertex and the weights of the edges to them.
    pub(super) fn edges(&self, x: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let start = self.neighbors.offsets()[x];
        let weights = &self.weights[start..start + self.neighbors.row(x).len()];
        self.neighbors.row(x).iter().map(|&y| y as usize).zip(weights.iter().copied())
    }

    /// Factor by which the energy's second derivative exceeds that of `Σ_e w_e |x_e|²`, about.
    pub(super) fn curvature(&self) -> f64 {
        1.0 + self.share * BENDING
    }

    /// Difference δ between a vertex and the weighted mean of its neighbors.
    fn offset(&self, points: &[Vector], x: usize) -> Vector {
        let mut sum = [0.0; 3];
        for (y, w) in self.edges(x) {
            for c in 0..3 {
                sum[c] += w * (points[x][c] - points[y][c]);
            }
        }
        if self.sums[x] > 0.0 { sum.map(|c| c / self.sums[x]) } else { sum }
    }

    /// Best rotation of a vertex, and its share of A and B.
    fn frame(&self, points: &[Vector], turn: &[f64; 4], x: usize) -> VertexFrame {
        let mut turn = *turn;
        let mut fit = [[0.0; 3]; 3];
        let offset = self.offset(points, x);
        let rest_offset = &self.rest_offsets[x];
        let weight = BENDING * self.sums[x];
        add_outer(&mut fit, weight, &offset, rest_offset);
        let mut sizes = weight * (dot(&offset, &offset) + dot(rest_offset, rest_offset));
        for (y, w) in self.edges(x) {
            let (now, before) = (subtract(&points[x], &points[y]), subtract(&self.rest[x], &self.rest[y]));
            add_outer(&mut fit, 0.5 * RIGID_SHARE * w, &now, &before);
            sizes += 0.5 * RIGID_SHARE * w * (dot(&now, &now) + dot(&before, &before));
        }
        let mut rotation = to_matrix(&turn);
        for _ in 0..MAX_TURNS {
            let step = turn_toward(&rotation, &fit);
            turn = normalized(&compose(&exponential(&step), &turn));
            rotation = to_matrix(&turn);
            if dot(&step, &step) < TURN_FOUND {
                break;
            }
        }
        let turned = image(&rotation, rest_offset);
        let residual = subtract(&offset, &turned);
        // Σ w |a − R b|² = Σ w (|a|² + |b|²) − 2 ⟨R, Σ w a bᵀ⟩.
        let fitted: f64 = (0..3).map(|i| dot(&rotation[i], &fit[i])).sum();
        let energy = sizes - 2.0 * fitted;
        VertexFrame { turn, rotation, residual, energy }
    }

    /// Gradient at a free vertex and its share of the energy of edges.
    fn gradient(
        &self,
        frames: &[VertexFrame],
        points: &[Vector],
        detail: &[Vector],
        x: usize,
    ) -> (Vector, f64) {
        let (t, springs) = (self.share, 1.0 - RIGID_SHARE);
        let (mut sum, mut energy) = ([0.0; 3], 0.0);
        let at = &frames[self.active_number[x] as usize];
        for (y, w) in self.edges(x) {
            let of_neighbor = &frames[self.active_number[y] as usize];
            let (now, before) = (subtract(&points[x], &points[y]), subtract(&self.rest[x], &self.rest[y]));
            let (long, was) = (norm(&now), norm(&before));
            let pull = if long > 0.0 { 1.0 - was / long } else { 0.0 };
            let apart = subtract(&now, &subtract(&detail[x], &detail[y]));
            let (r, s) = (image(&at.rotation, &before), image(&of_neighbor.rotation, &before));
            let (b, c) = (&at.residual, &of_neighbor.residual);
            for k in 0..3 {
                let rigid = now[k] - 0.5 * (r[k] + s[k]);
                let lengths = springs * pull * now[k] + RIGID_SHARE * rigid + BENDING * (b[k] - c[k]);
                sum[k] += w * (t * lengths + (1.0 - t) * apart[k]);
            }
            // An edge between free vertices counts at both.
            let count = if self.is_free[y] { 0.5 } else { 1.0 };
            let stretch = long - was;
            energy += count * w * (t * springs * stretch * stretch + (1.0 - t) * dot(&apart, &apart));
        }
        (sum, energy)
    }

    /// Energy, gradient and rotations at the positions of a state.
    pub(super) fn evaluate(
        &self,
        state: &mut LengthState,
        detail: &[Vector],
        contacts: &Contacts,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let points = &state.points;
        let frames = map_vertices(&self.active, progress, |x| self.frame(points, &state.turns[x], x))?;
        let of_edges = map_vertices(&self.free, progress, |x| self.gradient(&frames, points, detail, x))?;
        // One after the other, so that the sums have the same bits on any number of threads.
        let mut value = 0.0;
        for (&x, (gradient, energy)) in self.free.iter().zip(&of_edges) {
            value += 0.5 * energy;
            state.gradient[x as usize] = *gradient;
        }
        for (&x, frame) in self.active.iter().zip(&frames) {
            value += 0.5 * self.share * frame.energy;
            state.turns[x as usize] = frame.turn;
        }
        state.value = value + contacts.add_to(points, &self.is_free, &mut state.gradient);
        Ok(())
    }
}

/// Values of `f` at the vertices of a list, computed in parallel.
fn map_vertices<T: Send>(
    vertices: &[u32],
    progress: Progress<'_>,
    f: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Cancelled> {
    let checked = |(k, &x): (usize, &u32)| {
        if k.is_multiple_of(ROWS_AT_A_TIME) {
            progress.check()?;
        }
        Ok(f(x as usize))
    };
    vertices.par_iter().enumerate().with_min_len(ROWS_AT_A_TIME / 8).map(checked).collect()
}

/// Newton step, as a rotation vector, from a rotation R toward the one with the largest `⟨R, m⟩`.
fn turn_toward(rotation: &Matrix, m: &Matrix) -> Vector {
    // N = m Rᵀ; the slope along ω is the axial vector of N, and the curvature is tr(N) I − sym(N).
    let n = [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot(&m[i], &rotation[j])));
    let slope = [n[2][1] - n[1][2], n[0][2] - n[2][0], n[1][0] - n[0][1]];
    let trace = n[0][0] + n[1][1] + n[2][2];
    let size = n.iter().flatten().map(|c| c * c).sum::<f64>().sqrt();
    if size == 0.0 {
        return [0.0; 3];
    }
    // A curvature that is not positive is raised, so that the step goes uphill.
    let raised = LEAST_CURVATURE * size;
    let mut d = [0, 1, 2].map(|i| [0, 1, 2].map(|j| -0.5 * (n[i][j] + n[j][i])));
    for (i, row) in d.iter_mut().enumerate() {
        row[i] += trace + raised;
    }
    let minors = [d[0][0], d[0][0] * d[1][1] - d[0][1] * d[0][1], determinant(&d)];
    if minors.iter().all(|minor| *minor > 0.0) && minors[2] > raised * raised * raised {
        let columns = [cross(&d[1], &d[2]), cross(&d[2], &d[0]), cross(&d[0], &d[1])];
        return [0, 1, 2].map(|i| (0..3).map(|k| columns[k][i] * slope[k]).sum::<f64>() / minors[2]);
    }
    slope.map(|c| c / (2.0 * size))
}
