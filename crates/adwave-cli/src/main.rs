//! The program `adwave`: the command line, the answer to Ctrl-C, and the settings of the allocator.

use adwave_cli::{HeapUse, Program};
use std::io::Write as _;
use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::Duration;

/// Becomes true when the user wants to stop.
static STOP: AtomicBool = AtomicBool::new(false);

/// Exit code of a run that a signal stopped, as shells have it: 128 and the number of the signal.
static STOP_CODE: AtomicU8 = AtomicU8::new(CANCELLED);

/// Exit code of a run that Ctrl-C stopped.
const CANCELLED: u8 = 130;

/// Time in which a computation has to notice that it is to stop.
const PATIENCE: Duration = Duration::from_millis(1500);

fn main() -> ExitCode {
    report_exhausted_memory();
    // Without a handler the default one ends the program at once, which is safe: files are replaced atomically.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            end();
        }
        // In a thread of its own: the handler waits for a second Ctrl-C.
        std::thread::spawn(|| {
            std::thread::sleep(PATIENCE);
            end();
        });
    });
    remember_signals();
    let code = adwave_cli::run_for(Program::default().with_heap(tune_heap), std::env::args_os(), &STOP);
    // A server that was asked to end by another signal than Ctrl-C says so too.
    let is_stopped = code == CANCELLED || (code == 0 && STOP.load(Ordering::SeqCst));
    let stop_code = STOP_CODE.load(Ordering::SeqCst);
    ExitCode::from(if is_stopped && (code == CANCELLED || stop_code != CANCELLED) { stop_code } else { code })
}

/// Keeps the numbers of the signals that end a program, and handles all of them as Ctrl-C.
#[cfg(unix)]
#[allow(unsafe_code)]
fn remember_signals() {
    extern "C" fn stop(signal: libc::c_int) {
        STOP_CODE.store(u8::try_from(128 + signal).unwrap_or(CANCELLED), Ordering::SeqCst);
        // SAFETY: raise is among the calls that a handler may make.
        unsafe {
            libc::raise(libc::SIGINT);
        }
    }
    let handler: extern "C" fn(libc::c_int) = stop;
    for signal in [libc::SIGTERM, libc::SIGHUP] {
        // SAFETY: the handler stores a number and raises another signal.
        unsafe {
            libc::signal(signal, handler as libc::sighandler_t);
        }
    }
}

#[cfg(not(unix))]
fn remember_signals() {}

/// Sets the thresholds of the C library's allocator. By default it keeps freed vectors of up to 32 MiB, which most
/// commands never ask for again: an eighth of the peak of a mesh of a million vertices. Where vectors of one size come
/// again and again, keeping them saves the time in which the system clears their pages: about a tenth of that of
/// `denoise`, `features`, `filter` and `saliency`, for 3 to 12 % more memory.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code)]
fn tune_heap(heap_use: HeapUse) {
    /// The greatest threshold that glibc takes.
    const LARGEST_THRESHOLD: libc::c_int = 32 << 20;
    let settings: Vec<(libc::c_int, libc::c_int)> = match heap_use {
        HeapUse::ReturnVectors => vec![(libc::M_MMAP_THRESHOLD, 1 << 20)],
        HeapUse::ReuseVectors => vec![
            (libc::M_MMAP_THRESHOLD, 1 << 30),
            (libc::M_TRIM_THRESHOLD, libc::c_int::MAX),
            (libc::M_TOP_PAD, 1 << 26),
            // One heap for all threads, so that a vector freed by one serves another: a quarter less memory.
            (libc::M_ARENA_MAX, 1),
        ],
        HeapUse::ReuseAll => vec![(libc::M_MMAP_MAX, 0), (libc::M_TRIM_THRESHOLD, libc::c_int::MAX)],
        HeapUse::ReuseUpTo(bytes) => {
            let most = libc::c_int::try_from(bytes).unwrap_or(libc::c_int::MAX);
            vec![(libc::M_MMAP_THRESHOLD, LARGEST_THRESHOLD), (libc::M_TRIM_THRESHOLD, most)]
        }
    };
    for (parameter, value) in settings {
        // SAFETY: mallopt sets a number of the allocator, under its lock; if it is refused nothing changes.
        unsafe {
            libc::mallopt(parameter, value);
        }
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn tune_heap(_: HeapUse) {}

/// Prints a line and exits with the code of a failed machine if the system refuses memory. Without this the standard
/// library reports the number of bytes and aborts with a dump of the process.
#[cfg(unix)]
#[allow(unsafe_code)]
fn report_exhausted_memory() {
    extern "C" fn end_without_memory(_: libc::c_int) {
        const MESSAGE: &[u8] =
            b"adwave: the system has no more memory; no file was left half-written. Ask for less \
              (fewer levels, a simplified or thinned shape), or close other programs\n";
        adwave_io::remove_temporaries();
        // SAFETY: the bytes are a constant; both calls are among those that a handler may make.
        unsafe {
            libc::write(libc::STDERR_FILENO, MESSAGE.as_ptr().cast(), MESSAGE.len());
            libc::_exit(1);
        }
    }
    let handler: extern "C" fn(libc::c_int) = end_without_memory;
    // SAFETY: the handler runs in the thread that aborts, between no other instructions of this program.
    unsafe {
        libc::signal(libc::SIGABRT, handler as libc::sighandler_t);
    }
}

#[cfg(not(unix))]
fn report_exhausted_memory() {}

/// Removes files that are half-written and ends; every old file stays as it was.
fn end() -> ! {
    adwave_io::remove_temporaries();
    let _ = writeln!(std::io::stderr(), "adwave: stopped; no file was left half-written");
    exit(STOP_CODE.load(Ordering::SeqCst).into())
}
