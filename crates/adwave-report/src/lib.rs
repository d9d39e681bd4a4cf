//! Pages of pictures and numbers: the report of one shape and the comparison of two versions.

#[doc(hidden)]
pub mod analysis;
pub mod demo;
mod detail;
pub mod difference_report;
pub mod page;
pub mod shape_report;
mod table;

pub use detail::{DetailLoss, detail_loss, widest_within};
pub use table::{NONE, Table, column, digits};
