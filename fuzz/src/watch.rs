//! A thread that looks on: an input that takes long, or very much memory, is saved and ends the run.

use crate::save;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// An input may take so long.
const PATIENCE: Duration = Duration::from_secs(2);
/// The process may take so many bytes more than at the beginning of an input of at most 64 KiB.
const MAX_MEMORY: u64 = 1 << 30;
/// Time between two looks.
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

/// Notes the input that is checked now.
pub(crate) fn begin(target: &'static str, input: &[u8]) {
    *current() = Some(Current { target, input: input.to_vec(), since: Instant::now(), memory: 0 });
}

/// Notes that the check is over.
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
                eprintln!("the run ends here; what breaks is below {}", folder.display());
                std::process::exit(1);
            }
        }
    });
}

/// Bytes of memory in use, where the system says so in `/proc`; 0 elsewhere.
fn memory() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages: u64 = text.split(' ').nth(1).and_then(|n| n.parse().ok()).unwrap_or(0);
    pages * 4096
}
