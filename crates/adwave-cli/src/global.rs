//! What every command is told: how to print, and when to stop.

use crate::args::GlobalArgs;
use adwave::Progress;
use std::ffi::OsString;
use std::sync::atomic::AtomicBool;

/// What holds for the whole of one run.
#[derive(Clone, Copy)]
pub(crate) struct Global<'a> {
    /// Print one JSON object in place of text.
    pub(crate) json: bool,
    /// Print nothing but errors and the JSON object.
    pub(crate) quiet: bool,
    /// The command line, its program's name first.
    pub(crate) arguments: &'a [OsString],
    cancel: &'a AtomicBool,
}

impl<'a> Global<'a> {
    pub(crate) fn new(args: &GlobalArgs, arguments: &'a [OsString], cancel: &'a AtomicBool) -> Self {
        Self { json: args.json, quiet: args.quiet, arguments, cancel }
    }

    /// A handle that stops a call when the run is to stop.
    pub(crate) fn progress(&self) -> Progress<'a> {
        Progress::none().with_cancel(self.cancel)
    }
}
