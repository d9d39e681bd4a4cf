//! Factorization `A − σI = L D Lᵀ` of a symmetric sparse matrix, solves with several right-hand sides at once, and
//! inertia.

// All code of the sweeps has to be compiled for the processor features that they are dispatched to.
#![allow(clippy::inline_always)]

use super::{LinalgError, SymmetricMatrix};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};
use rayon::prelude::*;
use std::sync::Arc;

/// Number of right-hand sides per sweep through the factor.
pub(crate) const LANES: usize = 8;

/// Row of right-hand sides.
type Lanes = [f64; LANES];

/// Sparsity pattern of a matrix's factor, which is valid for all shifts of the matrix.
#[derive(Clone, Debug)]
pub(crate) struct FactorPattern {
    symbolic: Arc<SymbolicCholesky<usize>>,
    offsets: Arc<Vec<usize>>,
    columns: Arc<Vec<usize>>,
}

impl FactorPattern {
    /// Orders `matrix` by approximate minimum degree and finds the entries of its factor.
    pub(crate) fn new(matrix: &SymmetricMatrix) -> Result<Self, LinalgError> {
        let n = matrix.n();
        let mut offsets = vec![0];
        let mut columns = Vec::with_capacity(matrix.nnz());
        for x in 0..n {
            columns.extend(matrix.row(x).0.iter().map(|&y| y as usize));
            offsets.push(columns.len());
        }
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::new_checked(n, n, &offsets, None, &columns),
            Side::Lower,
            SymmetricOrdering::Amd,
            params,
        )
        .map_err(|e| LinalgError::Factorize { shift: 0.0, what: format!("{e:?}") })?;
        Ok(Self { symbolic: Arc::new(symbolic), offsets: Arc::new(offsets), columns: Arc::new(columns) })
    }
}

/// Factorization `A − σI = L D Lᵀ` in a fill-reducing order, ready to solve.
///
/// D is diagonal. This is stable for definite matrices. Indefinite matrices would need pivoting, so a solve must be
/// checked by its residual.
#[derive(Debug)]
pub struct Ldlt {
    pattern: FactorPattern,
    values: Vec<f64>,
    shift: f64,
}

impl Ldlt {
    /// Factorizes `matrix − shift·I`. The cost depends on the fill-in: about O(n^1.5) on surfaces.
    ///
    /// # Errors
    /// [`LinalgError::Factorize`] if a pivot is zero or not finite, or if memory runs out.
    ///
    /// ```
    /// use adwave_baselines::linalg::{Ldlt, SymmetricMatrix};
    /// let a = SymmetricMatrix::from_halves(2, &[(0, 0, 2.0), (1, 1, 2.0), (0, 1, 1.0)])?;
    /// let x = Ldlt::new(&a, 0.0)?.solve(&[4.0, 5.0])?;
    /// assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15);
    /// # Ok::<(), adwave_baselines::linalg::LinalgError>(())
    /// ```
    pub fn new(matrix: &SymmetricMatrix, shift: f64) -> Result<Self, LinalgError> {
        Self::with_pattern(&FactorPattern::new(matrix)?, matrix, shift)
    }

    pub(crate) fn with_pattern(
        pattern: &FactorPattern,
        matrix: &SymmetricMatrix,
        shift: f64,
    ) -> Result<Self, LinalgError> {
        let fail = |what: String| LinalgError::Factorize { shift, what };
        let n = matrix.n();
        let symbolic = &pattern.symbolic;
        let mut entries = Vec::with_capacity(matrix.nnz());
        for x in 0..n {
            let (columns, values) = matrix.row(x);
            entries.extend(
                columns.iter().zip(values).map(|(&y, &a)| if y as usize == x { a - shift } else { a }),
            );
        }
        let mut values = Vec::new();
        values.try_reserve_exact(symbolic.len_val()).map_err(|e| fail(e.to_string()))?;
        values.resize(symbolic.len_val(), 0.0);
        let scratch = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, faer::Spec::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| fail("out of memory".to_owned()))?;
        symbolic
            .factorize_numeric_ldlt(
                &mut values,
                SparseColMatRef::new(
                    SymbolicSparseColMatRef::new_checked(n, n, &pattern.offsets, None, &pattern.columns),
                    &entries,
                ),
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                faer::Spec::default(),
            )
            .map_err(|e| fail(format!("{e:?}")))?;
        let factor = Self { pattern: pattern.clone(), values, shift };
        if factor.pivots().any(|d| !(d.is_finite() && d != 0.0)) {
            return Err(fail("a pivot is zero or not finite".to_owned()));
        }
        Ok(factor)
    }

    /// Number of rows.
    pub fn n(&self) -> usize {
        self.pattern.symbolic.nrows()
    }

    /// Shift σ of the factorization.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Number of stored entries of L.
    pub fn nnz(&self) -> usize {
        self.values.len()
    }

    fn n_nodes(&self) -> usize {
        match self.pattern.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic.n_supernodes(),
            SymbolicCholeskyRaw::Simplicial(symbolic) => symbolic.ncols(),
        }
    }

    /// Returns group `s` of columns with equal rows; a single column if faer does not group, as for matrices that are
    /// too small.
    #[inline(always)]
    fn node(&self, s: usize) -> ColumnGroup<'_> {
        match self.pattern.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let start = symbolic.supernode_begin()[s];
                let rows =
                    &symbolic.row_idx()[symbolic.col_ptr_for_row_idx()[s]..][..symbolic.nnz_per_super()[s]];
                let values = &self.values[symbolic.col_ptr_for_val()[s]..symbolic.col_ptr_for_val()[s + 1]];
                ColumnGroup { start, size: symbolic.supernode_end()[s] - start, rows, values }
            }
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let range = symbolic.col_ptr()[s]..symbolic.col_ptr()[s + 1];
                let rows = &symbolic.row_idx()[range.start + 1..range.end];
                ColumnGroup { start: s, size: 1, rows, values: &self.values[range] }
            }
        }
    }

    fn pivots(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.n_nodes())
            .map(|s| self.node(s))
            .flat_map(|node| (0..node.size).map(move |j| node.column(j).0[j]))
    }

    /// Number of eigenvalues of A below σ, which by Sylvester's law of inertia is the number of negative pivots.
    pub fn n_below(&self) -> usize {
        self.pivots().filter(|&d| d < 0.0).count()
    }

    /// Solves `(A − σI) x = b`. O(entries of L).
    ///
    /// # Errors
    /// [`LinalgError::Length`].
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>, LinalgError> {
        if b.len() != self.n() {
            return Err(LinalgError::Length { expected: self.n(), got: b.len() });
        }
        let mut x = b.to_vec();
        self.solve_columns(&mut x);
        Ok(x)
    }

    /// Solves in place for any number of right-hand sides, column-major. Groups of eight run on separate threads.
    ///
    /// # Panics
    /// Unless the length is a multiple of the number of rows.
    pub fn solve_columns(&self, columns: &mut [f64]) {
        let n = self.n();
        if n == 0 {
            return;
        }
        assert!(columns.len().is_multiple_of(n), "whole columns of {n} rows");
        let forward = self.pattern.symbolic.perm().map(|p| p.arrays().0);
        columns.par_chunks_mut(n * LANES).for_each(|group| {
            let mut x = vec![[0.0; LANES]; n];
            for (c, column) in group.chunks_exact(n).enumerate() {
                for (i, row) in x.iter_mut().enumerate() {
                    row[c] = column[forward.map_or(i, |f| f[i])];
                }
            }
            pulp::Arch::new().dispatch(Sweep { factor: self, x: &mut x });
            for (c, column) in group.chunks_exact_mut(n).enumerate() {
                for (i, row) in x.iter().enumerate() {
                    column[forward.map_or(i, |f| f[i])] = row[c];
                }
            }
        });
    }

    #[inline(always)]
    fn solve_lanes(&self, x: &mut [Lanes]) {
        let n_nodes = self.n_nodes();
        let mut gathered: Vec<Lanes> = Vec::new();
        for s in 0..n_nodes {
            let node = self.node(s);
            let ColumnGroup { start, size, rows, .. } = node;
            gathered.clear();
            gathered.resize(rows.len(), [0.0; LANES]);
            for j in 0..size {
                let (top, below) = node.column(j);
                let xj = x[start + j];
                for (row, &l) in x[start + j + 1..start + size].iter_mut().zip(&top[j + 1..]) {
                    subtract(row, l, &xj);
                }
                for (row, &l) in gathered.iter_mut().zip(below) {
                    subtract(row, l, &xj);
                }
            }
            for (&i, change) in rows.iter().zip(&gathered) {
                for (x, c) in x[i].iter_mut().zip(change) {
                    *x += c;
                }
            }
        }
        for s in (0..n_nodes).rev() {
            let node = self.node(s);
            let ColumnGroup { start, size, rows, .. } = node;
            gathered.clear();
            gathered.extend(rows.iter().map(|&i| x[i]));
            for j in (0..size).rev() {
                let (top, below) = node.column(j);
                let mut xj = x[start + j];
                for v in &mut xj {
                    *v /= top[j];
                }
                for (row, &l) in x[start + j + 1..start + size].iter().zip(&top[j + 1..]) {
                    subtract(&mut xj, l, row);
                }
                for (row, &l) in gathered.iter().zip(below) {
                    subtract(&mut xj, l, row);
                }
                x[start + j] = xj;
            }
        }
    }
}

/// Columns `start..start + size` of L, which share their rows below the block on the diagonal.
#[derive(Clone, Copy)]
struct ColumnGroup<'a> {
    start: usize,
    size: usize,
    rows: &'a [usize],
    /// Columns one after another: the diagonal block, with D instead of its unit diagonal, then the rows below.
    values: &'a [f64],
}

impl<'a> ColumnGroup<'a> {
    #[inline(always)]
    fn column(&self, j: usize) -> (&'a [f64], &'a [f64]) {
        let length = self.size + self.rows.len();
        self.values[j * length..][..length].split_at(self.size)
    }
}

/// Both triangular sweeps, compiled once for each set of processor features.
struct Sweep<'a> {
    factor: &'a Ldlt,
    x: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.factor.solve_lanes(self.x);
    }
}

#[inline(always)]
fn subtract(row: &mut Lanes, l: f64, x: &Lanes) {
    for c in 0..LANES {
        row[c] -= l * x[c];
    }
}
