//! Progress reports and cancellation of long calls.

use crate::{ClassifiedError, ErrorKind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;
use thiserror::Error;

/// The call was cancelled; it has no result.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("stopped on request")]
pub struct Cancelled;

impl ClassifiedError for Cancelled {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Cancelled
    }
}

/// Progress of a call, for another thread to poll.
///
/// A program that must not be called from the library's threads (an interpreter, a window) polls this instead of
/// receiving reports.
#[derive(Debug, Default)]
pub struct ProgressCounter {
    done: AtomicU64,
    total: AtomicU64,
}

impl ProgressCounter {
    /// Finished parts and total parts; the total is 0 before the first report, and both restart with each stage of
    /// a call.
    pub fn get(&self) -> (u64, u64) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }
}

/// Handle through which a long call reports progress and learns of cancellation. The library itself prints nothing.
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
    /// A handle that reports nowhere and is never cancelled.
    pub fn none() -> Self {
        Self::default()
    }

    /// Calls `report(done, total)` from time to time, on the thread that runs the call.
    #[must_use]
    pub fn with_report(self, report: &'a (dyn Fn(u64, u64) + Sync)) -> Self {
        Self { report: Some(report), ..self }
    }

    /// Updates `counter` with every report, for another thread to poll.
    #[must_use]
    pub fn with_counter(self, counter: &'a ProgressCounter) -> Self {
        Self { counter: Some(counter), ..self }
    }

    /// Cancels the call soon after `cancel` becomes true, within milliseconds whatever the size of the shape.
    #[must_use]
    pub fn with_cancel(self, cancel: &'a AtomicBool) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// This handle without reports, for a stage inside a call that reports its own progress.
    #[must_use]
    pub fn quiet(self) -> Self {
        Self { report: None, counter: None, ..self }
    }

    /// True if the call is cancelled; for threads that do not report.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed))
    }

    /// Checks for cancellation without a report.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    #[inline]
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Reports that `done` of `total` parts are finished.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
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

/// Time between two checks for cancellation during work on another thread.
const BETWEEN_CHECKS: Duration = Duration::from_millis(5);

/// Work on a thread of its own, for library calls that cannot be stopped: a caller that is cancelled leaves it behind, and
/// it ends when it is done.
///
/// ```
/// use adwave::{BackgroundWork, Cancelled, Progress};
/// use std::sync::atomic::AtomicBool;
/// let sum = BackgroundWork::start(|| (1..=10).sum::<i32>()).unwrap();
/// assert_eq!(sum.finish(Progress::none()), Ok(Some(55)));
/// let long = BackgroundWork::start(|| std::thread::sleep(std::time::Duration::from_secs(60))).unwrap();
/// let stop = AtomicBool::new(true);
/// assert_eq!(long.finish(Progress::none().with_cancel(&stop)), Err(Cancelled));
/// ```
#[derive(Debug)]
pub struct BackgroundWork<T>(Receiver<T>);

impl<T: Send + 'static> BackgroundWork<T> {
    /// Starts the work; `None` if the system has no thread for it.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Option<Self> {
        let (sender, receiver) = channel();
        // The caller may have left.
        let started = std::thread::Builder::new().spawn(move || drop(sender.send(work())));
        started.is_ok().then_some(Self(receiver))
    }

    /// Waits for the result; `None` if the work panicked.
    ///
    /// # Errors
    /// [`Cancelled`], within milliseconds.
    pub fn finish(self, progress: Progress<'_>) -> Result<Option<T>, Cancelled> {
        loop {
            progress.check()?;
            match self.0.recv_timeout(BETWEEN_CHECKS) {
                Ok(result) => return Ok(Some(result)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
            }
        }
    }
}
