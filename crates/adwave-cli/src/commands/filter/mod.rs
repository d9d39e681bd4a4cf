//! `adwave filter`: change bands, and write the shape back. [`resolve`] turns flags and recipe into a job, [`compute`] runs it, and
//! [`write`] writes the result and reports it.

mod args;
mod compute;
mod resolve;
mod write;

use crate::error::CliError;
use crate::global::Global;
pub(crate) use args::FilterArgs;
use compute::compute;
use resolve::resolve;
use write::write;

pub(crate) fn run(args: &FilterArgs, global: &Global<'_>) -> Result<(), CliError> {
    let job = resolve(args, global)?;
    let result = compute(&job, global)?;
    write(job, result, global)
}
