//! Flags of every command.

use super::parse::{count_from_one, size};
use clap::Args;
use std::num::NonZeroUsize;

/// Flags of every command.
#[derive(Debug, Args)]
pub(crate) struct GlobalArgs {
    /// Print one JSON object instead of text
    #[arg(long, global = true, help_heading = "General")]
    pub(crate) json: bool,
    /// Print nothing but errors and, with --json, the result
    #[arg(long, short, global = true, help_heading = "General")]
    pub(crate) quiet: bool,
    /// Number of threads [default: one per core]; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = count_from_one, help_heading = "General")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Largest input after decompression, in bytes or with K, M, G [default: a quarter of the free memory]
    #[arg(long, global = true, value_name = "SIZE", value_parser = size, help_heading = "General")]
    pub(crate) max_input: Option<u64>,
    /// Record version, command and input hashes in PLY and OBJ files too, as comments; GLB, VTP, VTU, LAS and NPZ
    /// always have them
    #[arg(long, global = true, help_heading = "General")]
    pub(crate) provenance: bool,
}
