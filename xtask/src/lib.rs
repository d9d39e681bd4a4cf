//! Parts of `cargo xtask` that its tests use too.

pub mod outputs;
pub mod style;

/// The examples of the README, which are run as tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
