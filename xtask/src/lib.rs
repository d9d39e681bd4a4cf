//! Parts of `cargo xtask` that its tests use too.

pub mod outputs;
pub mod style;

/// The examples of docs/RUST.md, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../../docs/RUST.md")]
struct Readme;
