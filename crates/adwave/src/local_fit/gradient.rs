//! Gradients of a field along the edges of a diffusion operator.
//!
//! Around each vertex the gradient a minimizes `Σ_z φ(x,z) Σ_y Φ₁(z,y)·(f_y − f_z − a·(p_y − p_z))²`, where φ is
//! [`STEPS`] steps: the differences along all edges that diffusion passes. The normal equations `M a = v` of each
//! vertex, with `M = Σ_y Φ₁(z,y)(p_y − p_z)(p_y − p_z)ᵀ` and `v = Σ_y Φ₁(z,y)(p_y − p_z)(f_y − f_z)`, are smoothed by
//! these steps and then solved. On a surface a is a tangent vector.

use super::FitDomain;
use crate::operator::Diffusion;
use crate::sparse::try_apply;
use crate::{Cancelled, Progress, parallel};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Number of steps that smooth the normal equations. More of them leave less noise in the gradient, which is at
/// most a tenth of the noise of the field times the drift from here on.
const STEPS: usize = 4;

/// Number of rings around a vertex that its gradient depends on.
pub(super) const FIT_REACH: usize = STEPS + 1;

/// Spread of the neighbors in a direction, relative to their largest spread (both squared), below which they are
/// taken to lie on a line or plane: above rounding at any coordinates.
const LEAST_SPREAD: f64 = 1e-10;

/// Median ratio of the smallest to the middle squared spread above which points fill a volume. It is near 1 for
/// points in a ball, and a surface reaches it only with noise of half the spacing.
const VOLUME_SPREAD: f64 = 0.5;

/// Number of vertices that decide whether points fill a volume.
const SAMPLED: usize = 4096;

/// Least-squares gradients of any field on the vertices of a diffusion operator.
#[derive(Clone, Debug)]
pub(super) struct GradientFit {
    /// Positions in some unit; the coordinate that is the field is 0.
    pub(super) positions: Vec<[f64; 3]>,
    /// Unit normals, along which there is no gradient; zero without one.
    pub(super) normals: Vec<[f64; 3]>,
    /// Weight of the gradient at each vertex, in [0, 1]: the ratio of the spreads of the neighbors across and along.
    pub(super) confidence: Vec<f64>,
    /// Pseudo-inverse of M: its diagonal, and its entries (x,y), (x,z), (y,z).
    inverse: Vec<[[f64; 3]; 2]>,
    /// Mean square over the vertices of `(I − Φ₁)p`.
    pub(super) drift_square: f64,
}

impl GradientFit {
    /// Number of values of a vertex.
    pub(super) const N_VALUES: usize = 3 + 3 + 1 + 6;

    /// Prepares the fit. `points` are in a unit in which squares of lengths neither overflow nor underflow.
    /// O(entries).
    pub(super) fn new(
        diffusion: &Diffusion,
        points: &[[f64; 3]],
        domain: FitDomain,
        is_surface: bool,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = points.len();
        let positions = parallel::try_collect(n, progress, |x| {
            let mut p = [0.0; 3];
            domain.axes().iter().for_each(|&axis| p[axis] = points[x][axis]);
            p
        })?;
        let drift_square = mean_square_drift(diffusion, &positions, progress)?;
        let moments = Moments::new(diffusion, &positions, domain, progress)?;
        let solved = match domain {
            FitDomain::Plane { .. } => {
                let frame = PlaneFrame::from_axes(domain.axes());
                parallel::try_collect(n, progress, |x| frame.solve(&moments.matrix(x)))?
            }
            FitDomain::Surface => {
                let eigen = |x: usize| Spread::new(&moments.matrix(x));
                let dimension = if !is_surface && fills_volume(n, eigen) { 3 } else { 2 };
                parallel::try_collect(n, progress, |x| eigen(x).solve(dimension))?
            }
        };
        Self::from_solved(positions, &solved, drift_square, progress)
    }

    /// The fit for another operator on the same vertices, with the same normals. O(entries).
    pub(super) fn refit(
        &self,
        diffusion: &Diffusion,
        domain: FitDomain,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let positions = self.positions.clone();
        let has_normal = |x: usize| self.normals[x] != [0.0; 3];
        let moments = Moments::new(diffusion, &positions, domain, progress)?;
        let frame = match domain {
            FitDomain::Plane { .. } => Some(PlaneFrame::from_axes(domain.axes())),
            FitDomain::Surface => None,
        };
        let solved = parallel::try_collect(positions.len(), progress, |x| match &frame {
            Some(frame) => frame.solve(&moments.matrix(x)),
            None if has_normal(x) => PlaneFrame::from_normal(&self.normals[x]).solve(&moments.matrix(x)),
            None => Spread::new(&moments.matrix(x)).solve(3),
        })?;
        let drift_square = mean_square_drift(diffusion, &positions, progress)?;
        Self::from_solved(positions, &solved, drift_square, progress)
    }

    fn from_solved(
        positions: Vec<[f64; 3]>,
        solved: &[Solved],
        drift_square: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = positions.len();
        Ok(Self {
            positions,
            normals: parallel::try_collect(n, progress, |x| solved[x].normal)?,
            confidence: parallel::try_collect(n, progress, |x| solved[x].confidence)?,
            inverse: parallel::try_collect(n, progress, |x| solved[x].inverse)?,
            drift_square,
        })
    }

    /// Gradients of a field, one value per vertex, in its unit per unit of the positions. O(entries).
    pub(super) fn gradients(
        &self,
        diffusion: &Diffusion,
        field: &[f64],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let sides = parallel::try_collect(field.len(), progress, |x| {
            edges(diffusion, &self.positions, x).fold([0.0; 3], |sum, (w, d, y)| {
                let rise = w * (field[y] - field[x]);
                std::array::from_fn(|k| sum[k] + rise * d[k])
            })
        })?;
        let sides = smooth(diffusion, sides, progress)?;
        parallel::try_collect(field.len(), progress, |x| {
            let ([a, b, c], [[xx, yy, zz], [xy, xz, yz]]) = (sides[x], self.inverse[x]);
            [xx * a + xy * b + xz * c, xy * a + yy * b + yz * c, xz * a + yz * b + zz * c]
        })
    }

    /// The part of a vector at vertex `x` along which a field has a gradient.
    pub(super) fn tangential(&self, x: usize, d: [f64; 3]) -> [f64; 3] {
        let n = &self.normals[x];
        let along = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
        std::array::from_fn(|k| d[k] - along * n[k])
    }
}

/// Weight, offset and end of each step from vertex `x`.
pub(super) fn edges<'a>(
    diffusion: &'a Diffusion,
    positions: &'a [[f64; 3]],
    x: usize,
) -> impl Iterator<Item = (f64, [f64; 3], usize)> + 'a {
    let (columns, weights) = diffusion.row(x);
    columns.iter().zip(weights).map(move |(&y, &w)| {
        let (p, q) = (&positions[x], &positions[y as usize]);
        (w, std::array::from_fn(|k| q[k] - p[k]), y as usize)
    })
}

/// Mean square over the vertices of `(I − Φ₁)p`.
fn mean_square_drift(
    diffusion: &Diffusion,
    positions: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let n = positions.len();
    let sum = parallel::try_sum(n, progress, |x| {
        let drift = edges(diffusion, positions, x)
            .fold([0.0; 3], |sum, (w, d, _)| std::array::from_fn(|k| sum[k] + w * d[k]));
        drift.iter().map(|c| c * c).sum()
    })?;
    Ok(sum / n.max(1) as f64)
}

/// The matrix M of the normal equations at each vertex.
struct Moments {
    domain: FitDomain,
    /// Entries (x,x), (y,y), (z,z); for a plane of two axes i, j the entries (i,i), (j,j), (i,j).
    squares: Vec<[f64; 3]>,
    /// Entries (x,y), (x,z), (y,z); none for a plane.
    products: Vec<[f64; 3]>,
}

impl Moments {
    fn new(
        diffusion: &Diffusion,
        positions: &[[f64; 3]],
        domain: FitDomain,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let sums = |entries: &(dyn Fn(&[f64; 3]) -> [f64; 3] + Sync)| {
            let rows = parallel::try_collect(positions.len(), progress, |x| {
                edges(diffusion, positions, x).fold([0.0; 3], |sum, (w, d, _)| {
                    let entries = entries(&d);
                    std::array::from_fn(|k| sum[k] + w * entries[k])
                })
            })?;
            smooth(diffusion, rows, progress)
        };
        let (squares, products) = match *domain.axes() {
            [i, j] => (sums(&|d| [d[i] * d[i], d[j] * d[j], d[i] * d[j]])?, Vec::new()),
            _ => (sums(&|d| d.map(|c| c * c))?, sums(&|d| [d[0] * d[1], d[0] * d[2], d[1] * d[2]])?),
        };
        Ok(Self { domain, squares, products })
    }

    fn matrix(&self, x: usize) -> Matrix3<f64> {
        let [a, b, c] = self.squares[x];
        if let [i, j] = *self.domain.axes() {
            let mut m = Matrix3::zeros();
            (m[(i, i)], m[(j, j)], m[(i, j)], m[(j, i)]) = (a, b, c, c);
            return m;
        }
        let [xy, xz, yz] = self.products[x];
        Matrix3::new(a, xy, xz, xy, b, yz, xz, yz, c)
    }
}

/// Rows after [`STEPS`] steps.
fn smooth(
    diffusion: &Diffusion,
    mut rows: Vec<[f64; 3]>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let mut next: Vec<[f64; 3]> = crate::pages::zeros(rows.len());
    for _ in 0..STEPS {
        try_apply(diffusion, rows.as_flattened(), next.as_flattened_mut(), 3, progress)?;
        std::mem::swap(&mut rows, &mut next);
    }
    Ok(rows)
}

/// True if the points fill a volume rather than a surface.
fn fills_volume(n: usize, eigen: impl Fn(usize) -> Spread) -> bool {
    let mut ratios: Vec<f64> = (0..n)
        .step_by((n / SAMPLED).max(1))
        .map(eigen)
        .filter(|spread| spread.squares[1] > 0.0)
        .map(|spread| spread.squares[2] / spread.squares[1])
        .collect();
    if ratios.is_empty() {
        return false;
    }
    let middle = ratios.len() / 2;
    *ratios.select_nth_unstable_by(middle, f64::total_cmp).1 > VOLUME_SPREAD
}

/// Squared spreads of the neighbors of a vertex, largest first, with their directions.
struct Spread {
    squares: [f64; 3],
    directions: [Vector3<f64>; 3],
}

/// Two orthogonal unit vectors.
struct PlaneFrame {
    along: Vector3<f64>,
    across: Vector3<f64>,
}

impl PlaneFrame {
    /// The plane of the first two of some coordinates.
    fn from_axes(axes: &[usize]) -> Self {
        Self { along: Vector3::ith(axes[0], 1.0), across: Vector3::ith(axes[1], 1.0) }
    }

    /// The plane across a unit vector.
    fn from_normal(normal: &[f64; 3]) -> Self {
        let normal = Vector3::from(*normal);
        let along = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
        Self { along, across: normal.cross(&along) }
    }

    /// Pseudo-inverse in this plane, in closed form.
    fn solve(&self, m: &Matrix3<f64>) -> Solved {
        let Self { along, across } = self;
        let normal = along.cross(across).into();
        let (a, b, c) = (along.dot(&(m * along)), along.dot(&(m * across)), across.dot(&(m * across)));
        let size = a + c;
        if !(size > 0.0 && size.is_finite()) {
            return Solved { normal, ..Solved::default() };
        }
        let (a, b, c) = (a / size, b / size, c / size);
        let largest = 0.5 + (0.5 * (a - c)).hypot(b);
        let determinant = (a * c - b * b).max(0.0);
        let ratio = determinant / (largest * largest);
        // On a line the inverse is that along it, M/λ².
        let (p, q, r) = if ratio > LEAST_SPREAD {
            (c / determinant, -b / determinant, a / determinant)
        } else {
            (a / (largest * largest), b / (largest * largest), c / (largest * largest))
        };
        let cross = along * across.transpose();
        let inverse = (along * along.transpose() * p
            + (cross + cross.transpose()) * q
            + across * across.transpose() * r)
            / size;
        Solved { inverse: upper_entries(&inverse), normal, confidence: ratio.max(LEAST_SPREAD) }
    }
}

/// The diagonal of a symmetric matrix, and its entries (x,y), (x,z), (y,z).
fn upper_entries(m: &Matrix3<f64>) -> [[f64; 3]; 2] {
    [[m[(0, 0)], m[(1, 1)], m[(2, 2)]], [m[(0, 1)], m[(0, 2)], m[(1, 2)]]]
}

/// Solution of the normal equations of a vertex.
#[derive(Clone, Copy, Default)]
struct Solved {
    inverse: [[f64; 3]; 2],
    normal: [f64; 3],
    confidence: f64,
}

impl Spread {
    fn new(m: &Matrix3<f64>) -> Self {
        let size = m.trace();
        if !(size > 0.0 && size.is_finite()) {
            return Self { squares: [0.0; 3], directions: [Vector3::zeros(); 3] };
        }
        // Of size 1, so that the iteration's tolerance suits any unit.
        let eigen = SymmetricEigen::new(m / size);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        Self {
            squares: order.map(|k| size * eigen.eigenvalues[k].max(0.0)),
            directions: order.map(|k| eigen.eigenvectors.column(k).into_owned()),
        }
    }

    /// Pseudo-inverse over the `dimension` directions of largest spread.
    fn solve(&self, dimension: usize) -> Solved {
        let largest = self.squares[0];
        if largest == 0.0 {
            return Solved::default();
        }
        let spanned = (0..dimension).filter(|&k| self.squares[k] > LEAST_SPREAD * largest);
        let m = spanned.fold(Matrix3::zeros(), |m, k| {
            m + self.directions[k] * self.directions[k].transpose() / self.squares[k]
        });
        let normal = if dimension < 3 { self.directions[2].into() } else { [0.0; 3] };
        Solved {
            inverse: upper_entries(&m),
            normal,
            confidence: (self.squares[dimension - 1] / largest).max(LEAST_SPREAD),
        }
    }
}
