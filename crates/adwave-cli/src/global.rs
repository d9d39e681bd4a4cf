//! What every command is told: how to print, and when to stop.

use crate::args::GlobalArgs;
use crate::provenance::Inputs;
use adwave::Progress;
use adwave_io::ReadLimits;
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
    /// How much a file may ask for.
    pub(crate) limits: ReadLimits,
    /// Whether the result goes to the standard output, so that what is said goes beside it.
    pub(crate) is_piped: bool,
    /// What has been read so far.
    pub(crate) inputs: &'a Inputs,
    cancel: &'a AtomicBool,
}

impl<'a> Global<'a> {
    pub(crate) fn new(
        args: &GlobalArgs,
        arguments: &'a [OsString],
        inputs: &'a Inputs,
        cancel: &'a AtomicBool,
    ) -> Self {
        let mut limits = ReadLimits::default();
        limits.max_bytes = args.max_input.unwrap_or(limits.max_bytes);
        Self {
            json: args.json,
            quiet: args.quiet,
            arguments,
            limits,
            is_piped: is_piped(arguments),
            inputs,
            cancel,
        }
    }

    /// A handle that stops a call when the run is to stop.
    pub(crate) fn progress(&self) -> Progress<'a> {
        Progress::none().with_cancel(self.cancel)
    }
}

/// Whether a command line says `-o -`.
fn is_piped(arguments: &[OsString]) -> bool {
    let words = || arguments.iter().filter_map(|word| word.to_str());
    let apart =
        words().zip(words().skip(1)).any(|(flag, value)| matches!(flag, "-o" | "--output") && value == "-");
    apart || words().any(|word| matches!(word, "-o-" | "-o=-" | "--output=-"))
}
