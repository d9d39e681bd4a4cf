//! The program `adwave`: the command line, and the answer to Ctrl-C.

use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Becomes true when the user wants to stop.
static STOP: AtomicBool = AtomicBool::new(false);

/// How long a computation may take to notice that it is to stop.
const PATIENCE: Duration = Duration::from_millis(1500);

fn main() -> ExitCode {
    return_large_vectors();
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
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code)]
fn return_large_vectors() {
    const LARGE: libc::c_int = 1 << 20;
    // SAFETY: it sets a number of the allocator, before there is a second thread; where it is refused nothing changes.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn return_large_vectors() {}

/// Removes what is half written and ends; every old file stays as it was.
fn end() -> ! {
    adwave_io::remove_temporaries();
    eprintln!("adwave: stopped; no file is half written");
    exit(130)
}
