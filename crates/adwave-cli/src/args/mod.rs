//! The flags that several commands have, each defined once. Those of one command stand with it.

mod analysis;
mod named;
mod part;
mod shape;

pub(crate) use analysis::{BorderArgs, DetectArgs, FieldArgs, MapArgs, ResponseArg, signal_names};
pub(crate) use named::named;
pub(crate) use part::PartArgs;
pub(crate) use shape::{Kind, LevelArgs, ShapeArgs, any_length, at_least_one};

use clap::Args;
use std::num::NonZeroUsize;

/// Flags of every command.
#[derive(Debug, Args)]
pub(crate) struct GlobalArgs {
    /// Print one JSON object for machines in place of text for people
    #[arg(long, global = true, help_heading = "General")]
    pub(crate) json: bool,
    /// Print nothing but errors and, with --json, the result
    #[arg(long, short, global = true, help_heading = "General")]
    pub(crate) quiet: bool,
    /// Number of threads [default: one for each core]; the result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = at_least_one, help_heading = "General")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Largest input after decompression, in bytes or with K, M, G [default: a quarter of the free memory]
    #[arg(long, global = true, value_name = "SIZE", value_parser = size, help_heading = "General")]
    pub(crate) max_input: Option<u64>,
    /// Write version, command and hashes of the inputs into PLY and OBJ too, as a comment; GLB, VTP, VTU, LAS and NPZ have them anyway
    #[arg(long, global = true, help_heading = "General")]
    pub(crate) provenance: bool,
}

/// A number of bytes: `4000000`, `500M`, `1.5G`, with or without `iB` or `B` after the letter, which counts by 1024.
pub(crate) fn size(text: &str) -> Result<u64, String> {
    let plain = text.trim().trim_end_matches(['b', 'B']).trim_end_matches(['i', 'I']);
    let (digits, factor) = match plain.as_bytes().last().map(u8::to_ascii_uppercase) {
        Some(b'K') => (&plain[..plain.len() - 1], 1_u64 << 10),
        Some(b'M') => (&plain[..plain.len() - 1], 1 << 20),
        Some(b'G') => (&plain[..plain.len() - 1], 1 << 30),
        Some(b'T') => (&plain[..plain.len() - 1], 1 << 40),
        _ => (plain, 1),
    };
    match digits.trim().parse::<f64>() {
        Ok(n) if n > 0.0 && n.is_finite() => Ok((n * factor as f64) as u64),
        _ => Err("give a size such as 500M or 8G".into()),
    }
}
