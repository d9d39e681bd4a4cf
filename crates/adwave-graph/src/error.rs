//! Errors of the crate.

use adwave::bands::{BandsError, ScheduleError};
use adwave::operator::DiffusionError;
use adwave::rows::RowsError;
use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Error of building or using a walk.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GraphWalkError {
    /// The number of values is not points × dimensions.
    #[error(
        "points are n × d values with d of at least 1, got {n_values} values for {n_dimensions} dimensions"
    )]
    PointsLength {
        /// Number of values.
        n_values: usize,
        /// Number of dimensions.
        n_dimensions: usize,
    },
    /// A coordinate is NaN, infinite or beyond 1e100.
    #[error(
        "coordinate {dimension} of point {point} is {value:?}; coordinates are finite and at most 1e100 in size"
    )]
    BadCoordinate {
        /// The point, from 0.
        point: usize,
        /// The coordinate, from 0.
        dimension: usize,
        /// Value of the coordinate.
        value: f64,
    },
    /// Lists of neighbors of the wrong size.
    #[error(
        "neighbors are n × k indices with as many distances, got {n_indices} indices and {n_distances} distances for {n_points} points"
    )]
    ListsLength {
        /// Number of indices.
        n_indices: usize,
        /// Number of distances.
        n_distances: usize,
        /// Number of points.
        n_points: usize,
    },
    /// A neighbor outside the cloud.
    #[error("point {point} names neighbor {neighbor}, and there are {n_points} points; use 0 to {}, or -1 for none", n_points.saturating_sub(1))]
    NoNeighbor {
        /// The point, from 0.
        point: usize,
        /// The index given.
        neighbor: i64,
        /// Number of points.
        n_points: usize,
    },
    /// A distance is negative or NaN.
    #[error(
        "the distance from point {point} to its neighbor {neighbor} is {distance}; distances are finite and at least 0"
    )]
    BadDistance {
        /// The point.
        point: usize,
        /// The neighbor.
        neighbor: usize,
        /// The distance.
        distance: f64,
    },
    /// The exponent of the adaptive kernel is out of range.
    #[error("the decay of the kernel must be greater than 0 and finite, got {0:?}")]
    BadDecay(f64),
    /// A weight is negative or not finite.
    #[error("the weight of the edge ({row}, {column}) is {value:?}; weights are finite and at least 0")]
    BadWeight {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The weight.
        value: f64,
    },
    /// The matrix is not square.
    #[error("the matrix of a graph is square, got {n_rows} rows and a column {column}")]
    NotSquare {
        /// Number of rows.
        n_rows: usize,
        /// A column that is too large.
        column: usize,
    },
    /// Weights that are not symmetric, for a method that needs them to be.
    #[error(
        "edge ({row}, {column}) has the weight {value:?} and its reverse {reverse:?}; {purpose} needs symmetric weights: choose a symmetrization"
    )]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The weight.
        value: f64,
        /// Weight of the reverse edge.
        reverse: f64,
        /// Method that needs it.
        purpose: &'static str,
    },
    /// A column or symmetric normalization where rows must sum to 1.
    #[error(
        "bands need a walk whose rows sum to 1, and this one is normalized by {0}; use row normalization"
    )]
    NotRowStochastic(&'static str),
    /// The signal has the wrong length.
    #[error("the signal has {n_values} values for {n_nodes} nodes; it needs one row per node{}", transposed_hint(*.n_columns, *.n_nodes))]
    SignalLength {
        /// Number of values.
        n_values: usize,
        /// Number of nodes.
        n_nodes: usize,
        /// Number of columns, if known.
        n_columns: usize,
    },
    /// A value of the signal is not finite.
    #[error(
        "value {channel} of node {node} is {value:?}; values are finite: leave out such nodes or channels"
    )]
    BadValue {
        /// The node.
        node: usize,
        /// The channel.
        channel: usize,
        /// The value.
        value: f64,
    },
    /// A value is no count, for cross-validation.
    #[error(
        "value {channel} of node {node} is {value:?}, and cross-validation splits counts: give whole numbers of at least 0 (raw counts), or a number of steps"
    )]
    NotCount {
        /// The node.
        node: usize,
        /// The channel.
        channel: usize,
        /// The value.
        value: f64,
    },
    /// A square root of negative values.
    #[error(
        "value {channel} of node {node} is {value:?}, and its square root was asked for; use values of at least 0"
    )]
    NegativeValue {
        /// The node.
        node: usize,
        /// The channel.
        channel: usize,
        /// The value.
        value: f64,
    },
    /// A negative or infinite value where principal components are taken.
    #[error(
        "value {channel} of node {node} is {value:?}, and a graph is made of finite values of at least 0; give raw counts, or a graph"
    )]
    NoComponents {
        /// The node.
        node: usize,
        /// The channel.
        channel: usize,
        /// The value.
        value: f64,
    },
    /// The number of steps is out of range.
    #[error("the number of steps must be between 0 and {most}, got {steps:?}")]
    BadSteps {
        /// The number of steps.
        steps: f64,
        /// Largest number.
        most: u32,
    },
    /// Fractional steps of a walk that takes whole steps only.
    #[error(
        "{steps} steps were asked for, and this walk takes whole steps only, because it {reason}; ask for whole steps, or make it lazy and its weights symmetric"
    )]
    WholeSteps {
        /// The number of steps.
        steps: f64,
        /// The property that the walk lacks.
        reason: &'static str,
    },
    /// Scales that do not increase from at least 1.
    #[error("scales are whole numbers of steps that increase from at least 1, got {0:?}")]
    BadScales(Vec<u32>),
    /// An order of scattering that does not exist.
    #[error("orders of scattering are 0, 1 and 2, got {0}")]
    BadOrder(u32),
    /// A parameter of cross-validation is out of range.
    #[error("{name} must be {range}, got {value:?}")]
    BadParameter {
        /// Name of the parameter.
        name: &'static str,
        /// Range of the parameter.
        range: &'static str,
        /// The value.
        value: f64,
    },
    /// Labels of components of the wrong length.
    #[error("there must be one label of a graph per node, got {n_labels} for {n_nodes} nodes")]
    LabelsLength {
        /// Number of labels.
        n_labels: usize,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// The result does not fit the limit on memory.
    #[error("this needs {needed} bytes of memory, more than the limit of {limit}; {advice}")]
    TooLarge {
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
        /// A way to need less.
        advice: &'static str,
    },
    /// The matrix is inconsistent.
    #[error(transparent)]
    Rows(#[from] RowsError),
    /// The matrix is no walk.
    #[error(transparent)]
    Diffusion(#[from] DiffusionError),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The steps are no schedule.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Advice on a matrix that has as many columns as the graph has nodes.
fn transposed_hint(n_columns: usize, n_nodes: usize) -> &'static str {
    if n_columns == n_nodes && n_nodes > 0 {
        "; it has one column per node, so it seems to be transposed (genes × cells): transpose it"
    } else {
        ""
    }
}

impl ClassifiedError for GraphWalkError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } => ErrorKind::Memory,
            Self::Cancelled(_) => ErrorKind::Cancelled,
            Self::Rows(error) => error.kind(),
            Self::Diffusion(error) => error.kind(),
            Self::Bands(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
