//! Systematic tests of the command line against its own documentation. The commands and options come from the definition of the
//! command line, so a new option is covered, or a test says which entry it needs.
//!
//! By default each test runs a sample of its cases. `cargo xtask command-check` runs all of them.

mod cells_file;
mod documented;
mod equal_inputs;
mod fixtures;
mod harness;
mod independent_numbers;
mod numbers;
mod option_cases;
mod option_effects;
mod outputs;
mod pages;
mod reported_numbers;
mod signature;
mod streams;
mod suggestions;
mod wording;
