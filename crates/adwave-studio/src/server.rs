//! The server: from a shape to an address, until it is told to end.

use crate::StudioError;
use crate::answer::Refused;
use crate::guard::{Guard, guarded};
use crate::report::Reports;
use crate::routes::router;
use crate::session::{Opened, Session};
use adwave::Progress;
use adwave_io::{Recipe, recipe_to_text};
use axum::http::StatusCode;
use axum::middleware;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

/// How the studio is served.
#[derive(Clone, Debug, Default)]
pub struct StudioParams {
    /// The port; 0 for any that is free.
    pub port: u16,
    /// An address other than the loopback, which others on the network reach.
    pub host: Option<IpAddr>,
    /// The folder in which edits are kept between visits; the user's own place for such things where none is given.
    pub kept_in: Option<PathBuf>,
    /// Threads that compute; those of the caller's pool where none are given.
    pub n_threads: Option<usize>,
}

/// A studio that answers.
#[derive(Clone, Debug)]
pub struct Served {
    /// Its address with the token: who has it can read and write what the studio can.
    pub address: String,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The edit as a recipe.
    pub recipe: String,
    /// The positions after it.
    pub points: Vec<[f64; 3]>,
    /// Whether the page said that it is done; else the server was stopped.
    pub done: bool,
}

/// The shapes that are open.
pub(crate) struct Studio {
    sessions: RwLock<Vec<Arc<Session>>>,
    next_id: AtomicU64,
    kept_in: Option<PathBuf>,
    /// Beside the first shape: what is dropped on the page comes from nowhere that the server knows.
    folder: PathBuf,
    /// Its own, so that it has as many threads as were asked for, and works in a forked process.
    pub(crate) pool: Arc<rayon::ThreadPool>,
    pub(crate) reports: Reports,
    is_done: AtomicBool,
    stop: Arc<AtomicBool>,
}

/// Between two looks at whether to end.
const LOOK: Duration = Duration::from_millis(20);
/// How long answers that are under way may take when the server ends.
const PATIENCE: Duration = Duration::from_millis(500);

impl Studio {
    pub(crate) fn sessions(&self) -> Vec<Arc<Session>> {
        self.sessions.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(crate) fn session(&self, id: u64) -> Result<Arc<Session>, Refused> {
        let found = self.sessions().into_iter().find(|session| session.id == id);
        found.ok_or_else(|| Refused::new(StatusCode::NOT_FOUND, format!("shape {id} is not open")))
    }

    /// Opens a shape; its bands are made at once, by the pool.
    pub(crate) fn open(&self, opened: Opened) -> Result<Arc<Session>, StudioError> {
        let id = self.next_id.fetch_add(1, Ordering::Relaxed);
        let session = Arc::new(Session::new(
            id,
            opened,
            self.folder.clone(),
            self.kept_in.as_deref(),
            Arc::clone(&self.stop),
        )?);
        self.sessions.write().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&session));
        let (early, pool) = (Arc::clone(&session), Arc::clone(&self.pool));
        std::thread::spawn(move || {
            let _turn = early.turn();
            pool.install(|| drop(early.prepared().map(|_| ())));
        });
        Ok(session)
    }

    pub(crate) fn close(&self, id: u64) {
        self.sessions.write().unwrap_or_else(PoisonError::into_inner).retain(|session| session.id != id);
    }

    pub(crate) fn finish(&self) {
        self.is_done.store(true, Ordering::Relaxed);
    }
}

/// Serves the studio on a shape until the page is done or `progress` is cancelled; `ready` is called with the address.
///
/// # Errors
/// [`StudioError`] for a shape without positions or too large, and when there is no port.
pub fn serve(
    opened: Opened,
    params: &StudioParams,
    progress: Progress<'_>,
    ready: impl FnOnce(&Served),
) -> Result<Finished, StudioError> {
    let host = params.host.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
    let listener = std::net::TcpListener::bind(SocketAddr::new(host, params.port))?;
    listener.set_nonblocking(true)?;
    let address = listener.local_addr()?;
    let name = match params.host {
        Some(IpAddr::V6(host)) => Some(format!("[{host}]")),
        Some(host) => Some(host.to_string()),
        None => None,
    };
    let guard = Arc::new(Guard::new(address.port(), name.as_deref())?);
    let n_threads = params.n_threads.unwrap_or_else(rayon::current_num_threads);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build();
    let studio = Arc::new(Studio {
        sessions: RwLock::new(Vec::new()),
        next_id: AtomicU64::new(1),
        kept_in: params.kept_in.clone().or_else(crate::autosave::folder),
        folder: opened.path.as_deref().and_then(Path::parent).map_or_else(PathBuf::new, Path::to_path_buf),
        pool: Arc::new(pool.map_err(std::io::Error::other)?),
        reports: Reports::default(),
        is_done: AtomicBool::new(false),
        stop: Arc::default(),
    });
    let first = studio.open(opened)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let app = router(Arc::clone(&studio)).layer(middleware::from_fn_with_state(Arc::clone(&guard), guarded));
    let outcome = runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let shown = name.as_deref().unwrap_or("127.0.0.1");
        ready(&Served { address: format!("http://{shown}:{}/#{}", address.port(), guard.token()) });
        tokio::select! {
            served = axum::serve(listener, app) => served,
            () = ended(&studio, progress) => Ok(()),
        }
    });
    // What is being made is not waited for.
    let is_done = studio.is_done.load(Ordering::Relaxed);
    studio.stop.store(!is_done, Ordering::Relaxed);
    runtime.shutdown_timeout(PATIENCE);
    outcome?;
    Ok(finished(&first, is_done))
}

async fn ended(studio: &Studio, progress: Progress<'_>) {
    while !progress.is_cancelled() {
        tokio::time::sleep(LOOK).await;
        if studio.is_done.load(Ordering::Relaxed) {
            // The answer that says so is still to be sent.
            tokio::time::sleep(LOOK).await;
            return;
        }
    }
}

/// The edit and what it gives; nothing edited where the bands were not there yet.
fn finished(session: &Session, done: bool) -> Finished {
    if let Ok(prepared) = session.prepared() {
        let recipe = prepared.document.recipe(&prepared.levels, prepared.decomposer.operator_kind());
        Finished { recipe: recipe_to_text(&recipe), points: prepared.points.to_vec(), done }
    } else {
        let recipe = recipe_to_text(&Recipe::default());
        Finished { recipe, points: session.points().to_vec(), done }
    }
}
