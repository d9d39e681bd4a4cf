//! Calls with the interpreter released: a pool of threads for each process, Ctrl-C, progress, panics.

use crate::error::{self, InternalError};
use adwave::{Cancelled, ClassifiedError, ErrorKind, Progress, ProgressCounter};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::any::Any;
use std::cell::RefCell;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Number of vertices up to which the calling thread does the work: `adwave` starts no threads for such shapes.
const SMALL: usize = 4096;
/// Time between two checks of signals and progress.
const LOOK: Duration = Duration::from_millis(20);

/// Thread pools of one process, by their number of threads.
struct Pools {
    process: u32,
    pools: Mutex<HashMap<usize, Arc<ThreadPool>>>,
}

/// Pools of this process. A forked child has none of its parent's threads, and a lock may be held forever: it gets its
/// own pools.
static POOLS: AtomicPtr<Pools> = AtomicPtr::new(ptr::null_mut());
/// Number of threads that was requested; 0 for the default.
static N_THREADS: AtomicUsize = AtomicUsize::new(0);

#[allow(unsafe_code)]
fn pools() -> &'static Pools {
    let process = std::process::id();
    loop {
        let current = POOLS.load(Ordering::Acquire);
        // SAFETY: the pointer is null, or comes from `Box::into_raw` below and is never freed.
        if let Some(found) = unsafe { current.as_ref() }
            && found.process == process
        {
            return found;
        }
        let new = Box::into_raw(Box::new(Pools { process, pools: Mutex::default() }));
        if POOLS.compare_exchange(current, new, Ordering::AcqRel, Ordering::Acquire).is_err() {
            // SAFETY: no other thread has this pointer.
            drop(unsafe { Box::from_raw(new) });
        }
    }
}

fn default_threads() -> usize {
    let requested = std::env::var("ADWAVE_NUM_THREADS").ok().and_then(|n| n.trim().parse().ok());
    // This respects the affinity and the quota of a container.
    requested.filter(|&n| n > 0).unwrap_or_else(|| std::thread::available_parallelism().map_or(1, Into::into))
}

/// Number of threads that a call uses.
#[pyfunction]
pub(crate) fn threads() -> usize {
    match N_THREADS.load(Ordering::Relaxed) {
        0 => default_threads(),
        n => n,
    }
}

/// Number of threads that was requested; 0 for as many as there are.
#[pyfunction]
pub(crate) fn requested_threads() -> usize {
    N_THREADS.load(Ordering::Relaxed)
}

/// Sets the number of threads of later calls; 0 for as many as there are.
#[pyfunction]
pub(crate) fn set_threads(n: usize) {
    N_THREADS.store(n, Ordering::Relaxed);
}

fn pool() -> PyResult<Arc<ThreadPool>> {
    let n = threads();
    let mut pools = pools().pools.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = pools.get(&n) {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new().num_threads(n).thread_name(|k| format!("adwave-{k}")).build();
    let pool = Arc::new(
        built.map_err(|e| pyo3::exceptions::PyOSError::new_err(format!("cannot start {n} threads: {e}")))?,
    );
    pools.insert(n, Arc::clone(&pool));
    Ok(pool)
}

thread_local! {
    /// Place and message of the last panic of this thread.
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Silences the message of panics, which become exceptions. The hook is that of this extension only.
pub(crate) fn keep_panics_quiet() {
    std::panic::set_hook(Box::new(|info| {
        LAST_PANIC.with(|last| *last.borrow_mut() = info.to_string().replace('\n', " "));
    }));
}

/// Exception of a Python function that the work called, for the call that the work belongs to.
static RAISED: Mutex<Option<PyErr>> = Mutex::new(None);

/// Keeps an exception of a function that the work called. The work is to stop with the error that this returns.
pub(crate) fn keep_raised(raised: PyErr) -> Cancelled {
    *RAISED.lock().unwrap_or_else(PoisonError::into_inner) = Some(raised);
    Cancelled
}

type CallOutcome<T, E> = Result<Result<T, E>, String>;

fn guarded<T, E>(
    work: impl FnOnce(Progress<'_>) -> Result<T, E>,
    progress: Progress<'_>,
) -> CallOutcome<T, E> {
    catch_unwind(AssertUnwindSafe(|| work(progress))).map_err(|panic: Box<dyn Any + Send>| {
        let message = LAST_PANIC.with(|last| std::mem::take(&mut *last.borrow_mut()));
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|&s| s.to_owned()));
        if message.is_empty() {
            text.unwrap_or_else(|| "a panic without a message".to_owned())
        } else {
            message
        }
    })
}

/// Runs `work` on a shape of `n_vertices` vertices with the interpreter released.
///
/// Every 20 ms the calling thread calls `report(done, total)` and checks signals; if one raises, the work is stopped
/// and the exception passed on.
pub(crate) fn run<T: Send, E: ClassifiedError + Send>(
    py: Python<'_>,
    n_vertices: usize,
    report: Option<&Py<PyAny>>,
    work: impl FnOnce(Progress<'_>) -> Result<T, E> + Send,
) -> PyResult<T> {
    // A function that the work calls may call this package again: the pool may have no other thread for that.
    let is_inside = rayon::current_thread_index().is_some();
    let outcome = if is_inside || (n_vertices <= SMALL && report.is_none()) {
        py.detach(|| guarded(work, Progress::none()))
    } else {
        run_in_pool(py, report, work)?
    };
    match outcome {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => {
            // Other errors are not those of a function that raised.
            let is_stopped = error.kind() == ErrorKind::Cancelled;
            let raised = is_stopped.then(|| RAISED.lock().unwrap_or_else(PoisonError::into_inner).take());
            Err(raised.flatten().unwrap_or_else(|| error::to_exception(&error)))
        }
        Err(panic) => Err(InternalError::new_err(format!(
            "internal error of adwave ({panic}); please report it with the input"
        ))),
    }
}

fn run_in_pool<T: Send, E: Send>(
    py: Python<'_>,
    report: Option<&Py<PyAny>>,
    work: impl FnOnce(Progress<'_>) -> Result<T, E> + Send,
) -> PyResult<CallOutcome<T, E>> {
    let pool = pool()?;
    let (cancel, counter) = (AtomicBool::new(false), ProgressCounter::default());
    let (done, woken) = (Mutex::new(None), Condvar::new());
    let raised = py.detach(|| {
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                let progress = Progress::none().with_cancel(&cancel).with_counter(&counter);
                let outcome = guarded(work, progress);
                *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
                woken.notify_one();
            });
            let mut last = (0, 0);
            loop {
                let waiting = done.lock().unwrap_or_else(PoisonError::into_inner);
                let (waiting, _) = woken
                    .wait_timeout_while(waiting, LOOK, |done| done.is_none())
                    .unwrap_or_else(PoisonError::into_inner);
                if waiting.is_some() {
                    break None;
                }
                drop(waiting);
                let checked = Python::attach(|py| {
                    py.check_signals()?;
                    let now = counter.get();
                    if let Some(report) = report
                        && now.1 > 0
                        && now != last
                    {
                        last = now;
                        report.call1(py, now)?;
                    }
                    Ok::<(), PyErr>(())
                });
                if let Err(raised) = checked {
                    // The scope ends when the work has noticed this.
                    cancel.store(true, Ordering::Relaxed);
                    break Some(raised);
                }
            }
        })
    });
    match raised {
        Some(raised) => Err(raised),
        None => done
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
            .ok_or_else(|| InternalError::new_err("a call ended without a result")),
    }
}
