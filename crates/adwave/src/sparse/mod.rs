//! The products that everything runs on.

mod product;

pub use product::apply;
