//! Scaling function φ and wavelet ψ of one vertex, without a matrix.
//!
//! Row x of Φ₁ⁿ is `e_xᵀΦ₁ⁿ`. For a reversible operator it follows from the symmetric matrix `S = D^½ Φ₁ D^{−½}`, D
//! = diag π, as `φ(y) = (Sⁿe_x)(y)·√(π(y)/π(x))`. One Chebyshev recurrence in `2S − I` gives both powers that a
//! wavelet needs; its terms of degree k reach k rings. For other operators Φ₁ is applied step by step.

use super::binomial::chebyshev_of_power;
use super::{BasisError, check_steps, check_tolerance};
use crate::Progress;
use crate::bands::MAX_STEPS;
use crate::operator::Diffusion;

/// Truncation error of a Chebyshev sum allowed in a function, before the factor √(π(y)/π(x)).
const TAIL: f64 = 1e-11;

/// Number of steps between two progress reports.
const STEPS_A_REPORT: usize = 16;

/// A function over the vertices that is 0 at most of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseRow {
    /// Vertices, in ascending order.
    pub columns: Vec<u32>,
    /// Value at each vertex of `columns`.
    pub values: Vec<f64>,
}

impl SparseRow {
    /// Value at vertex `y`; 0 if none is stored.
    pub fn get(&self, y: usize) -> f64 {
        self.columns.binary_search(&(y as u32)).map_or(0.0, |at| self.values[at])
    }

    /// Values at all `n_vertices` vertices.
    ///
    /// # Panics
    /// If the row names a vertex outside `0..n_vertices`.
    pub fn to_dense(&self, n_vertices: usize) -> Vec<f64> {
        let mut dense = vec![0.0; n_vertices];
        for (&y, &value) in self.columns.iter().zip(&self.values) {
            dense[y as usize] = value;
        }
        dense
    }

    fn as_slices(&self) -> (&[u32], &[f64]) {
        (&self.columns, &self.values)
    }
}

/// One scaling function and one wavelet.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalingAndWavelet {
    /// Row x of Φ_j, φ_{j,x}: entries ≥ 0 that sum to 1.
    pub scaling: SparseRow,
    /// The wavelet ψ_{j,x} = φ_{j−1,x} − φ_{j,x}; its entries sum to 0.
    pub wavelet: SparseRow,
    /// Number of products with Φ₁.
    pub n_products: u64,
}

/// Scaling function φ and wavelet ψ of `vertex` for a level of `steps` steps, where the level before has
/// `steps_before` steps (0 before the first level).
///
/// `φ_j = e_xᵀΦ₁^steps`, `ψ_j = e_xᵀΦ₁^steps_before − φ_j`. Values of φ below `drop_tolerance` are dropped and the
/// others divided by their sum, as in the matrices; with tolerance 0 every positive value is kept. The error of a
/// value is at most 1e-10 on a reversible operator (times √(π(y)/π(x))), and rounding otherwise. Cost: about
/// `5√steps` products over the vertices within that many rings if the operator is reversible, else `steps`
/// products. Memory: O(vertices reached) and 4 bytes per vertex.
///
/// # Errors
/// [`BasisError`] if the vertex does not exist, the steps do not increase, the tolerance is invalid or drops
/// everything, or the call is cancelled.
///
/// ```
/// use adwave::basis::one_vertex;
/// use adwave::{Progress, operator::Diffusion};
/// let diffusion = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.75, 0.25, 0.25, 0.75])?;
/// let at = one_vertex(&diffusion, 0, 1, 2, 0.0, Progress::none())?;
/// assert_eq!(at.scaling.values, [0.625, 0.375]);
/// assert_eq!(at.wavelet.values, [0.125, -0.125]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn one_vertex(
    diffusion: &Diffusion,
    vertex: usize,
    steps_before: u64,
    steps: u64,
    drop_tolerance: f64,
    progress: Progress<'_>,
) -> Result<ScalingAndWavelet, BasisError> {
    let n_vertices = diffusion.n_vertices();
    if vertex >= n_vertices {
        return Err(BasisError::NoVertex { vertex, n_vertices });
    }
    if steps_before >= steps || steps > MAX_STEPS {
        return Err(BasisError::BadSteps { fine: steps_before, coarse: steps });
    }
    check_tolerance(drop_tolerance)?;
    check_steps(diffusion)?;
    progress.step(0, steps)?;
    let ([fine, coarse], reached, n_products) =
        match chebyshev_functions(diffusion, vertex, [steps_before, steps], progress)? {
            Some(found) => found,
            None => power_functions(diffusion, vertex, [steps_before, steps], progress)?,
        };
    progress.step(steps, steps)?;
    let mut order: Vec<(u32, u32)> = reached.iter().copied().zip(0..).collect();
    order.sort_unstable();
    let row = |values: &[f64], steps| {
        let empty = BasisError::EmptyRow { row: vertex, steps, tolerance: drop_tolerance };
        sparse_row(&order, values, drop_tolerance).ok_or(empty)
    };
    let (fine, scaling) = (row(&fine, steps_before)?, row(&coarse, steps)?);
    let mut wavelet = SparseRow::default();
    crate::rows::subtract(
        fine.as_slices().into(),
        scaling.as_slices().into(),
        &mut wavelet.columns,
        &mut wavelet.values,
    );
    Ok(ScalingAndWavelet { scaling, wavelet, n_products })
}

/// Drops small values and divides the others by their sum; `None` if nothing is left.
fn sparse_row(order: &[(u32, u32)], values: &[f64], tolerance: f64) -> Option<SparseRow> {
    let mut row = SparseRow::default();
    for &(y, k) in order {
        let value = values[k as usize];
        if value >= tolerance && value > 0.0 {
            row.columns.push(y);
            row.values.push(value);
        }
    }
    let sum: f64 = row.values.iter().sum();
    for value in &mut row.values {
        *value /= sum;
    }
    (sum > 0.0).then_some(row)
}

/// Two functions over the reached vertices, those vertices, and the number of products.
type FunctionRows = ([Vec<f64>; 2], Vec<u32>, u64);

/// The vertices within some rings of one vertex, ordered by ring.
struct Rings {
    vertices: Vec<u32>,
    /// `ends[k]` is the number of vertices within k rings. The list ends early if there are no further rings.
    ends: Vec<usize>,
    /// One more than the position of each vertex of the shape in `vertices`; 0 for vertices that are not in it.
    place: Vec<u32>,
}

impl Rings {
    fn new(diffusion: &Diffusion, vertex: usize, n_rings: usize) -> Self {
        // Zeroed memory that is never touched costs nothing.
        let mut place = vec![0_u32; diffusion.n_vertices()];
        place[vertex] = 1;
        let mut vertices = vec![vertex as u32];
        let mut ends = vec![1];
        let mut first = 0;
        while ends.len() <= n_rings && first < vertices.len() {
            let end = vertices.len();
            for k in first..end {
                for &y in diffusion.row(vertices[k] as usize).0 {
                    if place[y as usize] == 0 {
                        vertices.push(y);
                        place[y as usize] = vertices.len() as u32;
                    }
                }
            }
            first = end;
            ends.push(vertices.len());
        }
        Self { vertices, ends, place }
    }

    fn n_within(&self, k: usize) -> usize {
        self.ends[k.min(self.ends.len() - 1)]
    }
}

/// Number of off-diagonal entries per group; the last group of a row is padded with zeros. Nearly all rows of a
/// mesh then have two groups, and a loop with two fixed rounds costs less than one with five to seven.
const GROUP: usize = 4;

/// Computes both functions by a Chebyshev recurrence; `None` if the operator is not reversible or π is too small to
/// divide by.
fn chebyshev_functions(
    diffusion: &Diffusion,
    vertex: usize,
    steps: [u64; 2],
    progress: Progress<'_>,
) -> Result<Option<FunctionRows>, BasisError> {
    if !diffusion.is_reversible() {
        return Ok(None);
    }
    let coefficients = steps.map(|n| chebyshev_of_power(n, TAIL));
    let degree = coefficients[1].len() - 1;
    let rings = Rings::new(diffusion, vertex, degree);
    let pi = diffusion.stationary();
    let root: Vec<f64> = rings.vertices.iter().map(|&y| pi[y as usize].sqrt()).collect();
    // Below this value squares and quotients would be subnormal.
    if root.iter().any(|&r| r < 1e-150) {
        return Ok(None);
    }
    let n = rings.vertices.len();
    let mut starts = Vec::with_capacity(n + 1);
    starts.push(0_u32);
    let mut diagonal = Vec::with_capacity(n);
    let mut groups: Vec<[(u32, f64); GROUP]> = Vec::with_capacity(2 * n);
    for (k, &y) in rings.vertices.iter().enumerate().take(rings.n_within(degree.saturating_sub(1))) {
        // Entries of 2S − I: 2Φ₁(y,z)·√(π(y)/π(z)), and 2Φ₁(y,y) − 1 on the diagonal.
        let (columns, weights) = diffusion.row(y as usize);
        let mut left = 1.0;
        for (some, some_weights) in columns.chunks(GROUP).zip(weights.chunks(GROUP)) {
            let mut group = [(k as u32, 0.0); GROUP];
            for (entry, (&z, &w)) in group.iter_mut().zip(some.iter().zip(some_weights)) {
                left -= w;
                let place = rings.place[z as usize] - 1;
                *entry = (place, 2.0 * w * root[k] / root[place as usize]);
            }
            groups.push(group);
        }
        diagonal.push(2.0 * left - 1.0);
        starts.push(groups.len() as u32);
    }
    let mut sums = [vec![0.0; n], vec![0.0; n]];
    let (mut before, mut now) = (vec![0.0; n], vec![0.0; n]);
    now[0] = 1.0;
    for degree_now in 0..=degree {
        if degree_now % STEPS_A_REPORT == 0 {
            let share = degree_now as f64 / (degree + 1) as f64;
            progress.step((share * steps[1] as f64) as u64, steps[1])?;
        }
        let within = rings.n_within(degree_now);
        for (sum, coefficients) in sums.iter_mut().zip(&coefficients) {
            if let Some(&c) = coefficients.get(degree_now) {
                for (s, &v) in sum[..within].iter_mut().zip(&now) {
                    *s += c * v;
                }
            }
        }
        if degree_now == degree {
            break;
        }
        // T_{k+1} = 2y·T_k − T_{k−1}, and T_1 = y·T_0. The next terms reach one ring further; terms that the sums
        // still need reach no further than the last.
        let (of_now, of_before) = if degree_now == 0 { (1.0, 0.0) } else { (2.0, 1.0) };
        let reach = rings.n_within(degree_now + 1).min(diagonal.len());
        let outer = rings.n_within(degree_now + 1);
        for k in 0..reach {
            let mut partial = [0.0; GROUP];
            for group in &groups[starts[k] as usize..starts[k + 1] as usize] {
                for (p, &(z, w)) in partial.iter_mut().zip(group) {
                    *p += w * now[z as usize];
                }
            }
            let product = diagonal[k] * now[k] + ((partial[0] + partial[1]) + (partial[2] + partial[3]));
            before[k] = of_now * product - of_before * before[k];
        }
        // Vertices of the last ring have neighbors outside it; only the last step computes their rows.
        for k in reach..outer {
            let y = rings.vertices[k] as usize;
            let mut product = 0.0;
            let (columns, weights) = diffusion.row(y);
            for (&z, &w) in columns.iter().zip(weights) {
                let place = rings.place[z as usize];
                if place != 0 {
                    product += 2.0 * w * root[k] / root[place as usize - 1] * now[place as usize - 1];
                }
            }
            before[k] = of_now * product - of_before * before[k];
        }
        std::mem::swap(&mut before, &mut now);
    }
    for sum in &mut sums {
        for (s, r) in sum.iter_mut().zip(&root) {
            *s *= r / root[0];
        }
    }
    Ok(Some((sums, rings.vertices, degree as u64)))
}

/// Computes both functions by applying Φ₁ step by step, over all vertices that they reach.
fn power_functions(
    diffusion: &Diffusion,
    vertex: usize,
    steps: [u64; 2],
    progress: Progress<'_>,
) -> Result<FunctionRows, BasisError> {
    let most = usize::try_from(steps[1]).unwrap_or(usize::MAX);
    let rings = Rings::new(diffusion, vertex, most);
    let n = rings.vertices.len();
    let diagonal: Vec<f64> = rings.vertices.iter().map(|&x| diffusion.diagonal(x as usize)).collect();
    let (mut now, mut next) = (vec![0.0; n], vec![0.0; n]);
    now[0] = 1.0;
    let mut fine = now.clone();
    for step in 0..most {
        if step % STEPS_A_REPORT == 0 {
            progress.step(step as u64, steps[1])?;
        }
        let outer = rings.n_within(step + 1);
        next[..outer].fill(0.0);
        for k in 0..rings.n_within(step) {
            let v = now[k];
            if v == 0.0 {
                continue;
            }
            next[k] += diagonal[k] * v;
            let (columns, weights) = diffusion.row(rings.vertices[k] as usize);
            for (&y, &w) in columns.iter().zip(weights) {
                next[rings.place[y as usize] as usize - 1] += w * v;
            }
        }
        std::mem::swap(&mut now, &mut next);
        if step as u64 + 1 == steps[0] {
            fine.clone_from(&now);
        }
    }
    Ok(([fine, now], rings.vertices, steps[1]))
}
