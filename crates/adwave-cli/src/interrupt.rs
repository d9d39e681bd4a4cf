//! Ctrl-C: stop, remove what was half written, leave every old file as it was.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Becomes true when the user wants to stop.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// How long a computation may take to notice that it is to stop.
const PATIENCE: Duration = Duration::from_millis(1500);

/// Watches for Ctrl-C (and the request to end that a system sends before it kills).
pub(crate) fn install() {
    // Without a handler the default one ends the program at once, which is no harm: files are replaced atomically.
    let _ = ctrlc::set_handler(|| {
        if !STOP.swap(true, Ordering::SeqCst) {
            std::thread::sleep(PATIENCE);
        }
        adwave_io::remove_temporaries();
        eprintln!("adwave: stopped; no file is half written");
        std::process::exit(130);
    });
}
