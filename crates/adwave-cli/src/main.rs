//! The program `adwave`: the command line, and the answer to Ctrl-C.

use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Becomes true when the user wants to stop.
static STOP: AtomicBool = AtomicBool::new(false);

/// How long a computation may take to notice that it is to stop.
const PATIENCE: Duration = Duration::from_millis(1500);

fn main() -> ExitCode {
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

/// Removes what is half written and ends; every old file stays as it was.
fn end() -> ! {
    adwave_io::remove_temporaries();
    eprintln!("adwave: stopped; no file is half written");
    exit(130)
}
