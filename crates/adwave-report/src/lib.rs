//! Pages of pictures and numbers: the report of one shape, the comparison of two versions, and the figures and tables of the paper.

mod analysis;
pub mod demo;
mod detail;
pub mod difference_report;
pub mod page;
pub mod reproduce;
pub mod shape_report;
mod table;

pub use detail::{DetailLoss, detail_loss, widest_within};
pub use table::{NONE, Table, column, digits};
