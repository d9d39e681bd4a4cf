//! Watchdog thread: saves an input that takes too long or too much memory, and ends the run.

use crate::save;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Largest time per input.
const PATIENCE: Duration = Duration::from_secs(2);
/// Largest growth of the process's memory during an input of at most 64 KiB, in bytes.
const MAX_MEMORY: u64 = 1 << 30;
/// Time between two checks.
const INTERVAL: Duration = Duration::from_millis(20);

struct Current {
    target: &'static str,
    input: Vec<u8>,
    since: Instant,
    memory: u64,
}

static CURRENT: Mutex<Option<Current>> = Mutex::new(None);

fn current() -> std::sync::MutexGuard<'static, Option<Current>> {
    CURRENT.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Registers the input that is checked now.
pub(crate) fn begin(target: &'static str, input: &[u8]) {
    *current() = Some(Current { target, input: input.to_vec(), since: Instant::now(), memory: 0 });
}

/// Registers that the check has ended.
pub(crate) fn end() {
    *current() = None;
}

/// Starts the thread.
pub(crate) fn start(folder: PathBuf) {
    std::thread::spawn(move || {
        let base = memory();
        loop {
            std::thread::sleep(INTERVAL);
            let mut now = current();
            let Some(now) = now.as_mut() else { continue };
            now.memory = now.memory.max(memory().saturating_sub(base));
            let is_slow = now.since.elapsed() > PATIENCE;
            if is_slow || now.memory > MAX_MEMORY {
                let path = save(now.target, &now.input);
                let why = if is_slow { "takes more than 2 s" } else { "takes more than 1 GiB" };
                println!("{}: {why}: {}", now.target, path.display());
                eprintln!("the run ends here; the input is saved below {}", folder.display());
                std::process::exit(1);
            }
        }
    });
}

/// Memory in use in bytes, from `/proc`; 0 on systems without it.
fn memory() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages: u64 = text.split(' ').nth(1).and_then(|n| n.parse().ok()).unwrap_or(0);
    pages * 4096
}
