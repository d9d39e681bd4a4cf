//! Random walks on graphs and on clouds of any dimension, and methods that use their powers.
//!
//! | step | type or function |
//! |---|---|
//! | exact nearest neighbors of points in any dimension | [`nearest_lists`] |
//! | weights of neighbors | [`kernel_weights`], [`Kernel`] |
//! | a walk from weights, or a walk as given | [`WalkMatrix`], [`WalkOptions`] |
//! | powers of the walk for many channels, and their adjoint | [`WalkPowers`] |
//! | imputation of counts, and its time by cross-validation | [`impute_into`], [`cross_validate`] |
//! | principal components of counts, choice of a graph for imputation | [`principal_components`], [`choose_graph`] |
//! | geometric scattering, and moments of its coefficients | [`scatter`], [`pool`] |
//!
//! With the feature `anndata`, an `.h5ad` file is read and edited by [`AnnDataFile`] and [`write_replaced`].
//!
//! The results have the same bits on any number of threads. Except for `.h5ad`, the crate opens no files.

mod accuracy;
#[cfg(feature = "anndata")]
mod anndata;
mod channel_keys;
mod components;
mod count_matrix;
mod cross_validation;
mod error;
mod graph_choice;
mod held_back;
mod impute;
mod kernel;
mod lane_block;
mod lane_rows;
mod lanes;
mod nearest;
mod node_order;
mod point_blocks;
mod point_products;
mod pooling;
mod powers;
mod scattering;
mod walk;

pub use accuracy::WalkAccuracy;
#[cfg(feature = "anndata")]
pub use anndata::{AnnDataError, AnnDataFile, AnnDataMatrix, ReplacedMatrix, write_replaced};
pub use components::{ComponentScaling, Components, principal_components};
pub use count_matrix::{CountMatrix, CountValues, Transformation};
pub use cross_validation::{CrossValidation, CrossValidationParams, cross_validate, split_counts};
pub use error::GraphWalkError;
pub use graph_choice::{ComparedGraph, GraphChoice, GraphChoiceParams, cell_walk, choose_graph};
pub use impute::{ImputationInput, impute_by_channel_into, impute_into};
pub use kernel::{Kernel, KernelName, kernel_weights};
pub use nearest::{DimensionedPoints, MAX_TIED, NearestLists, nearest_lists};
pub use pooling::{Pooling, pool};
pub use powers::WalkPowers;
pub use scattering::{Scattering, ScatteringParams, scatter};
pub use walk::{Normalization, SelfLoops, Symmetrization, WalkMatrix, WalkOptions};
