//! Scaling functions and wavelets as matrices Φ_j and Ψ_j, and single rows of them.
//!
//! `Φ_j = Φ₁^{n_j}` (eq. 6), `Ψ_j = Φ_{j−1} − Φ_j` (eq. 8), with `n_j = 2^(j−1)` on the dyadic levels of the paper.
//! Row x of Φ_j is the scaling function φ_{j,x}, row x of Ψ_j the wavelet ψ_{j,x}. Entries below a tolerance are
//! dropped and the rest of each row of Φ_j is divided by its sum, so rows of Φ_j still sum to 1 (eq. 7) and rows of
//! Ψ_j to 0 (eq. 9).
//!
//! * [`basis`]: all levels at once, in single precision, by walks from 32 neighboring vertices at a time
//!   (`local_columns.rs`: powers, `pack.rs`: dropping and packing, `sweep.rs`: growth of the active set).
//! * [`basis_by_squaring`]: the literal Algorithm 1 of the paper, in double precision; the reference.
//! * [`one_vertex`]: φ and ψ of one vertex at any level, without a matrix.
//!
//! Vertices are numbered as in [`Diffusion`], that is as in the
//! [`PreparedGeometry`](crate::shape::PreparedGeometry). [`Basis::to_shape_order`] renumbers them if that is a
//! permutation of the shape's vertices.

// Code compiled for several instruction sets must be inlined into the function that selects one.
#![allow(clippy::inline_always)]

mod binomial;
mod deep;
mod fast;
mod forecast;
mod local_columns;
mod one_vertex;
mod pack;
mod sparse_accumulator;
mod squaring;
mod sweep;
mod transpose;

pub use crate::rows::{CompressedRows, Value};
pub use fast::basis;
pub use one_vertex::{ScalingAndWavelet, SparseRow, one_vertex};
pub use squaring::basis_by_squaring;

use crate::bands::Schedule;
use crate::operator::{Diffusion, NoRows, Semigroup};
use crate::parallel::expect_not_cancelled;
use crate::rows::subtract;
use crate::shape::VertexMap;
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress};
use thiserror::Error;

/// Levels, drop tolerance and memory limit of a basis.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BasisParams {
    /// The levels.
    pub schedule: Schedule,
    /// Drop tolerance ε in [0, 1): entries below it are dropped. With 0 every positive entry is kept.
    pub drop_tolerance: f64,
    /// Largest number of bytes that the result and the computation may take, by the forecast.
    pub memory_limit: u64,
}

impl BasisParams {
    /// The paper's drop tolerance ε.
    pub const DROP_TOLERANCE: f64 = 1e-6;
    /// Default memory limit: 8 GiB.
    pub const MEMORY_LIMIT: u64 = 8 << 30;

    /// Parameters for the levels of `schedule`, with ε = 1e-6 and at most 8 GiB.
    pub fn new(schedule: Schedule) -> Self {
        Self { schedule, drop_tolerance: Self::DROP_TOLERANCE, memory_limit: Self::MEMORY_LIMIT }
    }

    /// Sets the drop tolerance ε.
    #[must_use]
    pub fn with_drop_tolerance(self, drop_tolerance: f64) -> Self {
        Self { drop_tolerance, ..self }
    }

    /// Sets the memory limit in bytes.
    #[must_use]
    pub fn with_memory_limit(self, memory_limit: u64) -> Self {
        Self { memory_limit, ..self }
    }

    fn check(&self) -> Result<(), BasisError> {
        check_tolerance(self.drop_tolerance)?;
        check_whole(&self.schedule)
    }

    /// Steps of the levels, which [`check`](Self::check) has found to be whole.
    fn steps(&self) -> Vec<u64> {
        self.schedule.whole_steps().expect("checked")
    }
}

/// Checks that all steps are whole. The functions are computed step by step, and half a step has no sparse row: the
/// square root of Φ₁ reaches every vertex.
pub(crate) fn check_whole(schedule: &Schedule) -> Result<(), BasisError> {
    match schedule.first_real() {
        Some(level) => Err(BasisError::NotWhole { level, steps: schedule.steps()[level - 1] }),
        None => Ok(()),
    }
}

/// Checks that the operator is a walk; heat has no sparse functions.
fn check_steps(diffusion: &Diffusion) -> Result<(), BasisError> {
    match diffusion.semigroup() {
        Semigroup::Steps => Ok(()),
        Semigroup::PlainSteps => Err(BasisError::Plain),
        Semigroup::Heat { .. } => Err(BasisError::Heat),
    }
}

fn check_tolerance(tolerance: f64) -> Result<(), BasisError> {
    if (0.0..1.0).contains(&tolerance) { Ok(()) } else { Err(BasisError::BadTolerance(tolerance)) }
}

/// Error of computing a basis.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BasisError {
    /// The tolerance is negative or NaN, or it drops everything.
    #[error("the drop tolerance must be at least 0 and below 1, got {0}; the default is 1e-6")]
    BadTolerance(f64),
    /// A schedule that squaring cannot reach: squaring gives powers of two only.
    #[error(
        "level {level} has {steps} steps; squaring needs the dyadic levels 1, 2, 4, …: choose them, or the fast method"
    )]
    NotDyadic {
        /// The level, from 1.
        level: usize,
        /// The number of steps.
        steps: u64,
    },
    /// A level with fractional steps, which the functions do not have.
    #[error(
        "level {level} has {steps} steps; the functions themselves take whole steps only, no fractional powers: round the schedule, or ask for the bands of a signal"
    )]
    NotWhole {
        /// The level, from 1.
        level: usize,
        /// The number of steps.
        steps: f64,
    },
    /// Heat diffusion, whose functions reach every vertex.
    #[error(
        "the functions of heat on a surface reach every vertex and have no sparse matrices; use the operator `walk`, or the functions of single vertices"
    )]
    Heat,
    /// An operator without stored rows.
    #[error(transparent)]
    NoRows(#[from] NoRows),
    /// A given walk that need not stay, whose powers are not those of Φ₁.
    #[error(
        "the functions are those of a walk that stays at least half of the time, and the given walk does not; use half of it and half of the identity, or the functions of single vertices"
    )]
    Plain,
    /// The matrices would exceed the memory limit.
    #[error(
        "level {n_levels} of {n_vertices} vertices needs about {needed} bytes with all levels before it, more than the limit of {limit}; ask for fewer levels, for single vertices, for bands of a signal instead of the functions, or raise the limit"
    )]
    TooLarge {
        /// Number of levels asked for.
        n_levels: usize,
        /// Number of vertices.
        n_vertices: usize,
        /// The forecast in bytes.
        needed: u64,
        /// The limit in bytes.
        limit: u64,
    },
    /// Every entry of a row is below the tolerance.
    #[error(
        "no entry of row {row} reaches the drop tolerance of {tolerance} after {steps} steps; lower it or ask for fewer levels"
    )]
    EmptyRow {
        /// The row, from 0.
        row: usize,
        /// Number of steps of the level.
        steps: u64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The vertex does not exist.
    #[error("there is no vertex {vertex}; the diffusion operator has {n_vertices}")]
    NoVertex {
        /// The vertex, from 0.
        vertex: usize,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The coarse scaling function does not have more steps than the fine one.
    #[error("a wavelet needs increasing steps up to 2^31, got {fine} and {coarse}")]
    BadSteps {
        /// Number of steps of the finer scaling function.
        fine: u64,
        /// Number of steps of the coarser scaling function.
        coarse: u64,
    },
    /// Vertices were welded; welded vertices share a row, so no permutation leads to the order of the shape.
    #[error(
        "{n_vertices} vertices of the shape are {n_welded} welded ones; row and column of vertex x are those of `vertex_map.welded(x)`"
    )]
    Welded {
        /// Number of vertices of the shape.
        n_vertices: usize,
        /// Number of welded vertices.
        n_welded: usize,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for BasisError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } => ErrorKind::Memory,
            Self::Cancelled(cancelled) => cancelled.kind(),
            _ => ErrorKind::Input,
        }
    }
}

/// Size and accuracy of a basis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BasisInfo {
    /// Number of entries of each of Φ_1 … Φ_J.
    pub nnz: Vec<u64>,
    /// Number of bytes of each of Φ_1 … Φ_J.
    pub bytes: Vec<u64>,
    /// Largest share of a row's sum that was dropped, for each of Φ_1 … Φ_J.
    pub largest_dropped: Vec<f64>,
    /// Bytes forecast before the computation, including working memory; 0 if no forecast was made.
    pub forecast: u64,
}

/// The scaling functions Φ_1 … Φ_J as sparse matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis<V = f32> {
    /// The steps n_1 … n_J of the levels.
    pub steps: Vec<u64>,
    /// `scaling[j − 1]` is Φ_j, n_vertices × n_vertices; its entries are ≥ 0 and each row sums to 1.
    pub scaling: Vec<CompressedRows<V>>,
    /// Size and accuracy.
    pub info: BasisInfo,
}

impl<V: Value> Basis<V> {
    /// Number of levels J.
    pub fn n_levels(&self) -> usize {
        self.scaling.len()
    }

    /// Number of rows of each matrix.
    pub fn n_vertices(&self) -> usize {
        self.scaling.first().map_or(0, CompressedRows::n_rows)
    }

    /// The wavelets `Ψ_j = Φ_{j−1} − Φ_j` (eq. 8) for `j` in `1..=n_levels()`, with `Φ_0 = I` (eq. 3). Rows sum to
    /// 0 (eq. 9). O(entries of both).
    ///
    /// # Panics
    /// If level `j` does not exist.
    ///
    /// ```
    /// use adwave::basis::{BasisParams, basis};
    /// use adwave::{Progress, bands::Schedule, operator::Diffusion};
    /// let diffusion = Diffusion::from_rows(&[0, 2, 4], &[0, 1, 0, 1], &[0.75, 0.25, 0.25, 0.75])?;
    /// let basis = basis(&diffusion, &BasisParams::new(Schedule::dyadic(2)?), Progress::none())?;
    /// assert_eq!(basis.scaling[1].row(0), ([0, 1].as_slice(), [0.625, 0.375].as_slice()));
    /// assert_eq!(basis.wavelet(2).row(0), ([0, 1].as_slice(), [0.125, -0.125].as_slice()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn wavelet(&self, j: usize) -> CompressedRows<V> {
        assert!((1..=self.n_levels()).contains(&j), "levels are 1 to {}, not {j}", self.n_levels());
        let coarse = &self.scaling[j - 1];
        let none = Progress::none();
        // Ψ_j = Φ_{j−1} − Φ_j (eq. 8), Φ_0 = I (eq. 3)
        expect_not_cancelled(match j {
            1 => CompressedRows::identity(coarse.n_rows()).minus(coarse, none),
            _ => self.scaling[j - 2].minus(coarse, none),
        })
    }

    /// The wavelet ψ_{j,x}: columns and values of row `x` of Ψ_j. O(entries of the row).
    ///
    /// # Panics
    /// If level `j` or vertex `x` does not exist.
    pub fn wavelet_row(&self, j: usize, x: usize) -> (Vec<u32>, Vec<V>) {
        let (mut columns, mut values) = (Vec::new(), Vec::new());
        let itself = ([x as u32], [V::from_f64(1.0)]);
        let fine = if j == 1 { (&itself.0[..], &itself.1[..]) } else { self.scaling[j - 2].row(x) };
        subtract(fine.into(), self.scaling[j - 1].row(x).into(), &mut columns, &mut values);
        (columns, values)
    }

    /// The basis with rows and columns in the order of the shape's vertices.
    ///
    /// Each row is a function and each column a welded vertex where it is evaluated. If several vertices of the
    /// shape were welded into one, a larger matrix with repeated columns would have rows that do not sum to 1, so
    /// it would not be a diffusion. Such a basis stays in the analysis order; `vertex_map.as_slice()` maps vertices
    /// to its columns.
    ///
    /// # Errors
    /// [`BasisError::Welded`] if vertices were welded.
    pub fn to_shape_order(&self, vertex_map: &VertexMap) -> Result<Self, BasisError> {
        let (n_vertices, n_welded) = (vertex_map.n_vertices(), vertex_map.n_welded());
        if n_vertices != n_welded {
            return Err(BasisError::Welded { n_vertices, n_welded });
        }
        let mut vertex_of = vec![0; n_welded];
        for (&class, x) in vertex_map.as_slice().iter().zip(0..) {
            vertex_of[class as usize] = x;
        }
        let scaling = self.scaling.iter().map(|level| level.permute(&vertex_of)).collect();
        Ok(Self { steps: self.steps.clone(), scaling, info: self.info.clone() })
    }
}
