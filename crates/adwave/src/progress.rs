//! How long calls say how far they are, and how they are told to stop.

use std::sync::atomic::{AtomicBool, Ordering};
use thiserror::Error;

/// A call was told to stop and did; nothing of its result exists.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("stopped on request")]
pub struct Cancelled;

/// Handle that a long call reports to and asks whether to go on. The library itself prints nothing.
///
/// ```
/// use adwave::{Cancelled, Progress};
/// use std::sync::atomic::AtomicBool;
/// let stop = AtomicBool::new(true);
/// assert_eq!(Progress::none().step(0, 10), Ok(()));
/// assert_eq!(Progress::none().with_cancel(&stop).step(0, 10), Err(Cancelled));
/// ```
#[derive(Clone, Copy, Default)]
pub struct Progress<'a> {
    report: Option<&'a (dyn Fn(u64, u64) + Sync)>,
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

    /// Stops the call soon after `cancel` becomes true.
    #[must_use]
    pub fn with_cancel(self, cancel: &'a AtomicBool) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// Whether the call is to stop; for threads that do not report.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed))
    }

    /// Reports that `done` of `total` parts are done.
    ///
    /// # Errors
    /// [`Cancelled`] when the call is to stop.
    pub fn step(&self, done: u64, total: u64) -> Result<(), Cancelled> {
        if let Some(report) = self.report {
            report(done, total);
        }
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

impl std::fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress")
            .field("report", &self.report.is_some())
            .field("cancel", &self.cancel)
            .finish()
    }
}
