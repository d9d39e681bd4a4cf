//! The program `adwave`: the command line, and the answer to Ctrl-C.

use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Becomes true when the user wants to stop.
static STOP: AtomicBool = AtomicBool::new(false);

/// How long a computation may take to notice that it is to stop.
const PATIENCE: Duration = Duration::from_millis(1500);

fn main() -> ExitCode {
    how_large_vectors_are_kept();
    say_that_memory_ran_out();
    // Without a handler the default one ends the program at once, which is no harm: files are replaced atomically.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            end();
        }
        // Beside the handler, which waits for a second Ctrl-C.
        std::thread::spawn(|| {
            std::thread::sleep(PATIENCE);
            end();
        });
    });
    ExitCode::from(adwave_cli::run(std::env::args_os(), &STOP))
}

/// Makes the C library give vectors of a mebibyte and more back to the system as soon as they are freed. By itself it keeps
/// those of up to 32 MiB for later, which nothing here asks for: an eighth of the peak of a mesh of a million vertices.
///
/// But `denoise` makes and drops many vectors of one size: there it keeps them all, which takes a fifth off the time for a tenth more
/// memory.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code)]
fn how_large_vectors_are_kept() {
    const RETURNED: libc::c_int = 1 << 20;
    const KEPT: libc::c_int = 1 << 30;
    let keeps = std::env::args_os().skip(1).any(|word| word == "denoise");
    // SAFETY: it sets numbers of the allocator, before there is a second thread; where it is refused nothing changes.
    unsafe {
        if keeps {
            libc::mallopt(libc::M_MMAP_THRESHOLD, KEPT);
            libc::mallopt(libc::M_TRIM_THRESHOLD, libc::c_int::MAX);
            libc::mallopt(libc::M_TOP_PAD, 1 << 26);
        } else {
            libc::mallopt(libc::M_MMAP_THRESHOLD, RETURNED);
        }
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn how_large_vectors_are_kept() {}

/// Where the system refuses memory, the standard library says how many bytes it was asked for and aborts. That becomes a line
/// more and the exit code of trouble with the machine, in place of a dump of the process.
#[cfg(unix)]
#[allow(unsafe_code)]
fn say_that_memory_ran_out() {
    extern "C" fn end_without_memory(_: libc::c_int) {
        const SAID: &[u8] =
            b"adwave: the system has no more memory for this; no file is half written. Ask for less \
              (fewer levels, a simplified or thinned shape), or end other programs\n";
        adwave_io::remove_temporaries();
        // SAFETY: the bytes are a constant; both calls are among those that a handler may make.
        unsafe {
            libc::write(libc::STDERR_FILENO, SAID.as_ptr().cast(), SAID.len());
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
fn say_that_memory_ran_out() {}

/// Removes what is half written and ends; every old file stays as it was.
fn end() -> ! {
    adwave_io::remove_temporaries();
    eprintln!("adwave: stopped; no file is half written");
    exit(130)
}
