//! Smallest eigenpairs of a symmetric positive semi-definite sparse matrix, computed component by component; small
//! components are solved densely.

use super::panel::{Panel, gram};
use super::slices::smallest_connected;
use super::{LinalgError, SymmetricMatrix, symmetric_eigen};
use adwave::Progress;
use rayon::prelude::*;

/// Largest number of rows of a component that is solved densely.
const DENSE: usize = 500;
/// Largest number of rows of a component that is solved densely if at least a quarter of its spectrum is requested.
const DENSE_FOR_MANY: usize = 3000;
/// Norm of the product with the matrix, relative to the matrix, below which a vector counts as a null vector.
const NULL: f64 = 1e-11;

/// Parameters of the eigensolver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EigenParams {
    /// Largest relative residual `‖(A−σI)⁻¹x − θx‖ / |θ|` in the inverse.
    pub tolerance: f64,
    /// Largest number of eigenpairs per band, the part of the spectrum that one factorization covers.
    pub band: usize,
    /// Largest number of solves per requested eigenpair; 1,000 more are always allowed.
    pub max_solves_per_pair: usize,
}

impl Default for EigenParams {
    fn default() -> Self {
        Self { tolerance: 1e-11, band: 320, max_solves_per_pair: 40 }
    }
}

impl EigenParams {
    /// Sets the largest relative residual.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// Sets the largest number of eigenpairs per band; 0 is taken as 1.
    #[must_use]
    pub fn with_band(self, band: usize) -> Self {
        Self { band: band.max(1), ..self }
    }
}

/// Cost and accuracy of the eigenpairs.
#[derive(Clone, Debug, PartialEq)]
pub struct EigenInfo {
    /// Number of solves of `(A − σI)x = b`.
    pub solves: usize,
    /// Number of restarts of the Lanczos process.
    pub restarts: usize,
    /// Number of factorizations, including those for counting eigenvalues.
    pub factorizations: usize,
    /// Number of connected components of the matrix.
    pub n_components: usize,
    /// Number of components solved by a dense method.
    pub n_dense: usize,
    /// Largest relative residual `‖A x − λ x‖ / ‖A‖_∞`.
    pub residual: f64,
}

/// Eigenpairs in ascending order of the eigenvalue.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpairs {
    /// Length of an eigenvector.
    pub n: usize,
    /// Eigenvalues, ascending.
    pub values: Vec<f64>,
    /// Orthonormal eigenvectors, one after another.
    pub vectors: Vec<f64>,
    /// Cost and accuracy of the eigenpairs.
    pub info: EigenInfo,
}

impl Eigenpairs {
    /// Returns eigenvector `k`.
    pub fn vector(&self, k: usize) -> &[f64] {
        &self.vectors[k * self.n..][..self.n]
    }
}

/// Eigenpairs of one connected component.
struct ComponentPairs {
    rows: Vec<u32>,
    values: Vec<f64>,
    vectors: Panel,
}

/// Computes the `k` smallest eigenpairs, or all of them if there are fewer, of a symmetric positive semi-definite
/// `matrix`.
///
/// `null` is an optional vector whose restriction to a component spans the null space of the component, if there is
/// one. This is checked, and the eigenvalue is then exactly 0. No eigenvalue is missed: the inertia of a factorization
/// counts those below the last. Each component is solved separately, so that a thousand equal components do not form a
/// multiple eigenvalue.
///
/// The result does not depend on the number of threads. Cost on a surface: about 2k solves, 8·n·k² operations and three
/// factorizations per band.
///
/// # Errors
/// [`LinalgError`] if the matrix has negative eigenvalues or cannot be factorized, if the pairs do not converge within
/// the largest number of solves, and on cancellation.
///
/// ```
/// use adwave::Progress;
/// use adwave_baselines::linalg::{EigenParams, SymmetricMatrix, smallest_eigenpairs};
/// let a = SymmetricMatrix::from_halves(3, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0), (2, 2, 5.0)])?;
/// let pairs = smallest_eigenpairs(&a, None, 10, &EigenParams::default(), Progress::none())?;
/// assert_eq!(pairs.values.len(), 3);
/// assert!(pairs.values[0].abs() < 1e-15 && (pairs.values[1] - 2.0).abs() < 1e-15 && pairs.values[2] == 5.0);
/// # Ok::<(), adwave_baselines::linalg::LinalgError>(())
/// ```
pub fn smallest_eigenpairs(
    matrix: &SymmetricMatrix,
    null: Option<&[f64]>,
    k: usize,
    params: &EigenParams,
    progress: Progress<'_>,
) -> Result<Eigenpairs, LinalgError> {
    let n = matrix.n();
    if let Some(null) = null.filter(|v| v.len() != n) {
        return Err(LinalgError::Length { expected: n, got: null.len() });
    }
    let k = k.min(n);
    let (label, n_components) = matrix.components();
    let mut rows = vec![Vec::new(); n_components];
    for (x, &c) in label.iter().enumerate() {
        rows[c as usize].push(x as u32);
    }
    let solver = ComponentSolver { matrix, null, params, progress };
    let mut info =
        EigenInfo { solves: 0, restarts: 0, factorizations: 0, n_components, n_dense: 0, residual: 0.0 };
    // By Weyl's law a component's share of the spectrum is its share of the surface; if that is too few, more are
    // requested.
    let mut asked: Vec<usize> =
        rows.iter().map(|r| if n_components == 1 { k } else { (k * r.len()).div_ceil(n) + 8 }).collect();
    let mut parts: Vec<Option<ComponentPairs>> = rows.iter().map(|_| None).collect();
    loop {
        for (c, part) in parts.iter_mut().enumerate() {
            if part.is_none() {
                *part = Some(solver.solve(&rows[c], asked[c].min(k), &mut info)?);
            }
        }
        let mut values: Vec<f64> = parts.iter().flatten().flat_map(|p| p.values.iter().copied()).collect();
        values.sort_by(f64::total_cmp);
        let kth = if k == 0 || values.len() < k { f64::INFINITY } else { values[k - 1] };
        let mut complete = true;
        for (c, part) in parts.iter_mut().enumerate() {
            let Some(p) = part else { continue };
            let has_all = p.values.len() == p.rows.len() || p.values.len() >= k;
            if !has_all && p.values.last().is_none_or(|&top| top < kth) {
                asked[c] *= 2;
                *part = None;
                complete = false;
            }
        }
        if complete {
            break;
        }
    }
    let parts: Vec<ComponentPairs> = parts.into_iter().flatten().collect();
    let mut order: Vec<(f64, usize, usize)> = parts
        .iter()
        .enumerate()
        .flat_map(|(c, p)| p.values.iter().enumerate().map(move |(i, &v)| (v, c, i)))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    order.truncate(k);
    let mut vectors = vec![0.0; n * k];
    for (&(_, c, i), vector) in order.iter().zip(vectors.chunks_exact_mut(n.max(1))) {
        for (&row, &value) in parts[c].rows.iter().zip(parts[c].vectors.column(i)) {
            vector[row as usize] = value;
        }
    }
    let values: Vec<f64> = order.into_iter().map(|e| e.0).collect();
    info.residual = largest_residual(matrix, &values, &vectors);
    Ok(Eigenpairs { n, values, vectors, info })
}

/// Eigensolver for the connected components of one matrix.
struct ComponentSolver<'a> {
    matrix: &'a SymmetricMatrix,
    null: Option<&'a [f64]>,
    params: &'a EigenParams,
    progress: Progress<'a>,
}

impl ComponentSolver<'_> {
    /// Computes the `k` smallest eigenpairs of the component with the given rows, and adds the cost to `info`.
    fn solve(&self, rows: &[u32], k: usize, info: &mut EigenInfo) -> Result<ComponentPairs, LinalgError> {
        let component = self.matrix.submatrix(rows);
        let n = component.n();
        let k = k.min(n);
        let restrict = |z: &[f64]| rows.iter().map(|&x| z[x as usize]).collect();
        let null = self.null.and_then(|z| unit_null_vector(&component, restrict(z)));
        if n <= DENSE || (n <= DENSE_FOR_MANY && 4 * k > n) {
            info.n_dense += 1;
            let (mut values, mut vectors) = symmetric_eigen(&component.to_dense(), n)?;
            values.truncate(k);
            vectors.truncate(n * k);
            if let (Some(null), true) = (null, k > 0) {
                values[0] = 0.0;
                vectors[..n].copy_from_slice(&null);
            }
            return Ok(ComponentPairs { rows: rows.to_vec(), values, vectors: Panel { n, values: vectors } });
        }
        let known = smallest_connected(&component, null.as_deref(), k, self.params, self.progress)?;
        info.solves += known.solves;
        info.restarts += known.restarts;
        info.factorizations += known.factorizations;
        Ok(ComponentPairs { rows: rows.to_vec(), values: known.values, vectors: known.vectors })
    }
}

/// Scales `z` to length 1; `None` if it is not in the null space of the matrix.
fn unit_null_vector(matrix: &SymmetricMatrix, mut z: Vec<f64>) -> Option<Vec<f64>> {
    let length = gram(z.len(), &z, &z).first()?.sqrt();
    if !(length.is_finite() && length > 0.0) {
        return None;
    }
    for v in &mut z {
        *v /= length;
    }
    let product = matrix.product(&z);
    let size = row_norm(matrix);
    (product.iter().all(|v| v.abs() <= NULL * size)).then_some(z)
}

/// Norm `‖A‖_∞`, the largest sum of absolute values in a row.
fn row_norm(matrix: &SymmetricMatrix) -> f64 {
    (0..matrix.n()).map(|x| matrix.row(x).1.iter().map(|a| a.abs()).sum()).fold(0.0, f64::max)
}

fn largest_residual(matrix: &SymmetricMatrix, values: &[f64], vectors: &[f64]) -> f64 {
    let size = row_norm(matrix);
    if size == 0.0 {
        return 0.0;
    }
    let norms = vectors.par_chunks_exact(matrix.n().max(1)).zip(values).map(|(x, &value)| {
        let ax = matrix.product(x);
        ax.iter().zip(x).map(|(a, x)| (a - value * x).powi(2)).sum::<f64>().sqrt()
    });
    norms.reduce(|| 0.0, f64::max) / size
}
