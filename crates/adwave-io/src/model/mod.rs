//! Content of a file in memory, and helpers that formats share.

pub(crate) mod binary_rows;
pub(crate) mod cells;
pub(crate) mod f32_limits;
pub(crate) mod field;
pub(crate) mod grouping;
pub(crate) mod instances;
pub(crate) mod numbers;
pub(crate) mod original;
pub(crate) mod shape;
pub(crate) mod shape_file;
pub(crate) mod subset;
pub(crate) mod volume;
