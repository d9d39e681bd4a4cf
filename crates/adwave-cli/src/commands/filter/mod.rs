//! `adwave filter`: change bands, and write the shape back. [`resolve`] turns flags and recipe into a job, [`compute`]
//! or, for an array of many channels, [`columns`] runs it, and [`write`] writes the result and reports it.

mod args;
mod columns;
mod compute;
mod resolve;
mod write;

use crate::error::CliError;
use crate::global::{Global, HeapUse};
use adwave::MANY_CHANNELS;
pub(crate) use args::FilterArgs;
use columns::compute_by_columns;
use compute::compute;
use resolve::resolve;
use write::write;

pub(crate) fn run(args: &FilterArgs, global: &Global<'_>) -> Result<(), CliError> {
    let job = resolve(args, global)?;
    if job.columns.is_some() || job.signal.n_channels >= MANY_CHANNELS {
        // Each group of channels needs as much memory as the one before.
        global.tune_heap(HeapUse::ReuseVectors);
    }
    let result = match &job.columns {
        Some(columns) => compute_by_columns(&job, columns, global)?,
        None => compute(&job, global)?,
    };
    write(job, result, global)
}
