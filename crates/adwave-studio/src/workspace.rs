//! Part of a session that does not depend on what is open: names, files, stored edits, and the order of requests.

use crate::autosave::Autosave;
use crate::document::Document;
use crate::response::ApiError;
use adwave::{LevelSpec, Progress};
use axum::http::StatusCode;
use serde_json::json;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Longest time for which the bands wait for a page that asks for the first picture.
const PATIENCE: Duration = Duration::from_secs(2);
/// Interval at which it is looked for.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Place at which something is opened: its number, its folder and the flag that ends its work.
#[derive(Clone, Debug)]
pub(crate) struct OpenedAt {
    pub(crate) id: u64,
    /// Folder in which files are saved.
    pub(crate) folder: PathBuf,
    /// Folder of stored edits.
    pub(crate) autosave_folder: Option<PathBuf>,
    /// Flag that is set at shutdown to cancel computations.
    pub(crate) stop: Arc<AtomicBool>,
}

/// Names and files of an open shape or grid, and the turn of its requests.
pub(crate) struct Workspace {
    pub(crate) id: u64,
    pub(crate) name: String,
    /// Path of the opened file.
    pub(crate) path: Option<PathBuf>,
    /// Folder in which files are saved.
    pub(crate) folder: PathBuf,
    pub(crate) autosave: Option<Autosave>,
    pub(crate) was_resumed: OnceLock<bool>,
    /// Files written by this session, which may be overwritten.
    pub(crate) written: Mutex<HashSet<PathBuf>>,
    turn: Mutex<()>,
    /// True once a page got the description of what is open, with which it shows a first picture.
    pub(crate) is_described: AtomicBool,
    stop: Arc<AtomicBool>,
}

impl Workspace {
    pub(crate) fn new(at: OpenedAt, name: String, path: Option<PathBuf>, autosave: Option<Autosave>) -> Self {
        Self {
            id: at.id,
            name,
            path,
            folder: at.folder,
            autosave,
            was_resumed: OnceLock::new(),
            written: Mutex::default(),
            turn: Mutex::default(),
            is_described: AtomicBool::new(false),
            stop: at.stop,
        }
    }

    /// Returns a handle that is cancelled at shutdown.
    pub(crate) fn progress(&self) -> Progress<'_> {
        Progress::none().with_cancel(&self.stop)
    }

    /// Waits until no other request of this session is handled.
    ///
    /// Must be called outside the compute threads: a thread of the pool that waits takes over other work meanwhile, and
    /// could then wait for a lock that it holds itself.
    pub(crate) fn wait_turn(&self) -> MutexGuard<'_, ()> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until a page got the description, or for a while; a shutdown ends it.
    pub(crate) fn wait_until_described(&self) {
        let start = Instant::now();
        let is_over = || self.is_described.load(Ordering::Relaxed) || self.stop.load(Ordering::Relaxed);
        while !is_over() && start.elapsed() < PATIENCE {
            std::thread::sleep(POLL_INTERVAL);
        }
    }

    /// Panics in debug builds if a compute thread is about to lock state of this session while nobody has the turn.
    pub(crate) fn expect_turn(&self) {
        let is_outside = || rayon::current_thread_index().is_none();
        debug_assert!(is_outside() || self.turn.try_lock().is_err(), "a request locks the edit in its turn");
    }

    /// Stores the edit for the next session.
    pub(crate) fn store_edit(&self, levels: &LevelSpec, document: &Document) -> Result<(), ApiError> {
        match &self.autosave {
            Some(autosave) => autosave.write(levels, document),
            None => Ok(()),
        }
    }
}

/// Refuses an edit that is not newer than the present one, unless both are equal.
pub(crate) fn check_revision(present: &Document, next: &Document) -> Result<(), ApiError> {
    if next.revision > present.revision || next == present {
        return Ok(());
    }
    let message = format!(
        "the edit must be newer than revision {}, got revision {}; the shape was edited in another tab",
        present.revision, next.revision
    );
    Err(ApiError::new(StatusCode::CONFLICT, message).with_fields(json!({"edit": present})))
}
