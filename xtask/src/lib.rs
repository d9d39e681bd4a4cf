//! Parts of `cargo xtask` that its tests use as well.

pub mod claims;
pub mod outputs;
pub mod style;

/// Examples of `docs/RUST.md`, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../../docs/RUST.md")]
struct Readme;
