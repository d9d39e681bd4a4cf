//! How long calls say how far they are, and how they are told to stop.

use crate::{ClassifiedError, ErrorKind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use thiserror::Error;

/// A call was told to stop and did; nothing of its result exists.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("stopped on request")]
pub struct Cancelled;

impl ClassifiedError for Cancelled {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Cancelled
    }
}

/// How far a call is, for another thread to look at whenever it likes.
///
/// A program that must not be called from the library's threads (an interpreter, a window) polls this in place of taking
/// reports.
#[derive(Debug, Default)]
pub struct ProgressCounter {
    done: AtomicU64,
    total: AtomicU64,
}

impl ProgressCounter {
    /// Parts done and parts in total; the total is 0 before the first report, and both start anew with each stage of a call.
    pub fn get(&self) -> (u64, u64) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }
}

/// Handle that a long call reports to and asks whether to go on. The library itself prints nothing.
///
/// ```
/// use adwave::{Cancelled, Progress, ProgressCounter};
/// use std::sync::atomic::AtomicBool;
/// let (stop, counter) = (AtomicBool::new(true), ProgressCounter::default());
/// assert_eq!(Progress::none().step(0, 10), Ok(()));
/// let progress = Progress::none().with_cancel(&stop).with_counter(&counter);
/// assert_eq!(progress.step(3, 10), Err(Cancelled));
/// assert_eq!(counter.get(), (3, 10));
/// ```
#[derive(Clone, Copy, Default)]
pub struct Progress<'a> {
    report: Option<&'a (dyn Fn(u64, u64) + Sync)>,
    counter: Option<&'a ProgressCounter>,
    cancel: Option<&'a AtomicBool>,
}

impl<'a> Progress<'a> {
    /// Reports nowhere and is never cancelled.
    pub fn none() -> Self {
        Self::default()
    }

    /// Calls `report(done, total)` now and then, from the thread that runs the call.
    #[must_use]
    pub fn with_report(self, report: &'a (dyn Fn(u64, u64) + Sync)) -> Self {
        Self { report: Some(report), ..self }
    }

    /// Keeps `counter` up to date with what is reported, for another thread to poll.
    #[must_use]
    pub fn with_counter(self, counter: &'a ProgressCounter) -> Self {
        Self { counter: Some(counter), ..self }
    }

    /// Stops the call soon after `cancel` becomes true: within some milliseconds, whatever the size of the shape.
    #[must_use]
    pub fn with_cancel(self, cancel: &'a AtomicBool) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// The same handle without reports: for a stage inside a call that reports its own.
    #[must_use]
    pub fn quiet(self) -> Self {
        Self { report: None, counter: None, ..self }
    }

    /// Whether the call is to stop; for threads that do not report.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed))
    }

    /// Asks whether to go on, without a report.
    ///
    /// # Errors
    /// [`Cancelled`] when the call is to stop.
    #[inline]
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Reports that `done` of `total` parts are done.
    ///
    /// # Errors
    /// [`Cancelled`] when the call is to stop.
    pub fn step(&self, done: u64, total: u64) -> Result<(), Cancelled> {
        if let Some(report) = self.report {
            report(done, total);
        }
        if let Some(counter) = self.counter {
            counter.total.store(total, Ordering::Relaxed);
            counter.done.store(done, Ordering::Relaxed);
        }
        self.check()
    }
}

impl std::fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress")
            .field("report", &self.report.is_some())
            .field("counter", &self.counter)
            .field("cancel", &self.cancel)
            .finish()
    }
}
