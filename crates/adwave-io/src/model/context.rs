//! Arguments that travel together through readers and writers.

use std::io::Write;
use std::path::Path;

use adwave::Progress;

use crate::{Format, ReadLimits, WriteReport};

/// Circumstances of reading a file.
#[derive(Clone, Copy)]
pub(crate) struct ReadContext<'a> {
    pub(crate) limits: &'a ReadLimits,
    pub(crate) progress: Progress<'a>,
    /// Name of the file, if it has one.
    pub(crate) name: Option<&'a str>,
    /// Folder in which files are looked for that the file names.
    pub(crate) folder: Option<&'a Path>,
}

/// Destination of a shape, and the notes taken while it is written.
pub(crate) struct WriteContext<'a> {
    pub(crate) format: Format,
    pub(crate) out: &'a mut dyn Write,
    pub(crate) report: WriteReport,
    pub(crate) progress: Progress<'a>,
}
