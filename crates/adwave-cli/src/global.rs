//! Context of one run: form of the output, inputs so far, files of the result, and cancellation.

use crate::args::GlobalArgs;
use crate::given::GivenOptions;
use crate::inputs::Inputs;
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, Transaction};
use std::ffi::OsString;
use std::sync::atomic::AtomicBool;

/// Use of the heap that a program can tune its allocator for. The library never tunes it: it may run inside another
/// program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeapUse {
    /// Vectors of a mebibyte and more go back to the system as soon as they are freed.
    ReturnVectors,
    /// Many vectors of one size are made and dropped, and those that are freed are kept for the next.
    ReuseVectors,
    /// The program needs the same amount of memory again and again, and all that is freed is kept.
    ReuseAll,
    /// Requests of one size come again and again, and up to this many bytes of freed memory are kept.
    ReuseUpTo(usize),
}

/// A domain that a program adds to the command: `NAME:TEXT` stands for it wherever a shape is expected.
#[derive(Clone, Copy, Debug)]
pub struct OwnDomain {
    /// The word before the colon.
    pub name: &'static str,
    /// Function that makes the domain with its operator from the text after the colon; its error is one line of text.
    pub open: fn(&str) -> Result<Decomposer, String>,
}

/// Allocator and domains of the program that runs the command.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Program<'a> {
    /// Function that gets the use that the command makes of the heap, before the work begins.
    pub tune_heap: fn(HeapUse),
    /// Domains of its own.
    pub domains: &'a [OwnDomain],
}

impl Default for Program<'_> {
    fn default() -> Self {
        Self { tune_heap: |_| {}, domains: &[] }
    }
}

impl<'a> Program<'a> {
    /// A program whose allocator is tuned by a function.
    #[must_use]
    pub fn with_heap(self, tune_heap: fn(HeapUse)) -> Self {
        Self { tune_heap, ..self }
    }

    /// A program with domains of its own.
    #[must_use]
    pub fn with_domains(self, domains: &'a [OwnDomain]) -> Self {
        Self { domains, ..self }
    }
}

/// Context of one run.
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
#[derive(Clone, Copy)]
pub(crate) struct Global<'a> {
    /// Print one JSON object instead of text.
    pub(crate) json: bool,
    /// Print nothing but errors and the JSON object.
    pub(crate) quiet: bool,
    /// The command line, its program's name first.
    pub(crate) arguments: &'a [OsString],
    /// The options of the command line.
    pub(crate) given: &'a GivenOptions,
    /// True if --max-input was given.
    pub(crate) has_max_input: bool,
    /// Limits on reading.
    pub(crate) limits: ReadLimits,
    /// True if the result goes to the standard output, so that reports go to the standard error.
    pub(crate) is_piped: bool,
    /// Files that have been read so far.
    pub(crate) inputs: &'a Inputs,
    /// Files of the result.
    pub(crate) files: &'a Transaction,
    cancel: &'a AtomicBool,
    /// The program that runs the command.
    pub(crate) program: Program<'a>,
}

/// Parts of the context that the caller of the command owns.
#[derive(Clone, Copy)]
pub(crate) struct RunContext<'a> {
    /// The command line, its program's name first.
    pub(crate) arguments: &'a [OsString],
    pub(crate) given: &'a GivenOptions,
    pub(crate) inputs: &'a Inputs,
    pub(crate) files: &'a Transaction,
    /// Becomes true when the run is to stop.
    pub(crate) cancel: &'a AtomicBool,
    pub(crate) program: Program<'a>,
}

impl<'a> Global<'a> {
    pub(crate) fn new(args: &GlobalArgs, context: RunContext<'a>) -> Self {
        let mut limits = ReadLimits::default();
        limits.max_bytes = args.max_input.unwrap_or(limits.max_bytes);
        let RunContext { arguments, given, inputs, files, cancel, program } = context;
        Self {
            json: args.json,
            quiet: args.quiet,
            arguments,
            given,
            has_max_input: args.max_input.is_some(),
            limits,
            is_piped: given.is_piped(),
            inputs,
            files,
            cancel,
            program,
        }
    }

    /// A handle that stops a call when the run is to stop.
    pub(crate) fn progress(&self) -> Progress<'a> {
        Progress::none().with_cancel(self.cancel)
    }

    /// Tells the program the future use of the heap.
    pub(crate) fn tune_heap(&self, heap_use: HeapUse) {
        (self.program.tune_heap)(heap_use);
    }
}
