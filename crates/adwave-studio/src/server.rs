//! Start, state and shutdown of the server.

use crate::StudioError;
use crate::band_edit::BandEdit;
use crate::guard::{Guard, check_request};
use crate::opened::Opened;
use crate::report::Reports;
use crate::response::ApiError;
use crate::routes::router;
use crate::session::{Session, StudioInput};
use crate::workspace::OpenedAt;
use adwave::Progress;
use adwave_io::{Recipe, ShapeFile, recipe_to_text};
use axum::http::StatusCode;
use axum::middleware;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

/// Options of the server.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct StudioParams {
    /// Port to listen on; 0 chooses a free port.
    pub port: u16,
    /// Address to listen on instead of the loopback interface; other machines may then reach the server.
    pub host: Option<IpAddr>,
    /// Folder that stores edits between sessions; if `None`, the state folder of the user.
    pub autosave_folder: Option<PathBuf>,
    /// Number of compute threads; if `None`, that of the caller's thread pool.
    pub n_threads: Option<usize>,
}

impl StudioParams {
    /// Sets [`port`](Self::port).
    #[must_use]
    pub fn with_port(self, port: u16) -> Self {
        Self { port, ..self }
    }

    /// Sets [`host`](Self::host).
    #[must_use]
    pub fn with_host(self, host: Option<IpAddr>) -> Self {
        Self { host, ..self }
    }

    /// Sets [`autosave_folder`](Self::autosave_folder).
    #[must_use]
    pub fn with_autosave_folder(self, autosave_folder: Option<PathBuf>) -> Self {
        Self { autosave_folder, ..self }
    }

    /// Sets [`n_threads`](Self::n_threads).
    #[must_use]
    pub fn with_n_threads(self, n_threads: Option<usize>) -> Self {
        Self { n_threads, ..self }
    }
}

/// Address of a running studio.
#[derive(Clone, Debug)]
pub struct StudioAddress {
    /// Link with the access token. Anyone who has the link can use the studio.
    pub url: String,
    /// Link that leads to [`url`](Self::url) once, to open a browser with: it may show in the list of processes.
    pub url_for_browser: String,
}

/// Result of a studio session.
#[derive(Clone, Debug)]
pub struct StudioOutcome {
    /// Edit of the positions, or of the values of an image or a volume, as a recipe in TOML.
    pub recipe: String,
    /// Names of the edited fields, each with its edit as a recipe in TOML.
    pub field_recipes: Vec<(String, String)>,
    /// True if the user ended the studio in the page, false if it was cancelled.
    pub is_done: bool,
    first: Opened,
}

impl StudioOutcome {
    fn new(first: Opened, is_done: bool) -> Self {
        let mut field_recipes = Vec::new();
        let turn = first.workspace().wait_turn();
        let recipe = match &first {
            Opened::Shape(session) => session.lock_unsplit().map_or_else(
                |_| Recipe::default(),
                |prepared| {
                    let BandEdit { document, levels, decomposer, .. } = &prepared.bands;
                    let operator = decomposer.operator_kind();
                    field_recipes.extend(document.changed_fields().into_iter().map(|name| {
                        let recipe = recipe_to_text(&document.to_field_recipe(&name, levels, operator));
                        (name, recipe)
                    }));
                    document.to_recipe(levels, operator)
                },
            ),
            Opened::Grid(session) => {
                session.lock_bands().map_or_else(|_| Recipe::default(), |bands| bands.to_recipe())
            }
        };
        drop(turn);
        Self { recipe: recipe_to_text(&recipe), field_recipes, is_done, first }
    }

    /// File of the shape after the edit: with its new positions and fields, turned parts, and the fields that were added;
    /// as it was opened if its bands were not computed yet. `None` of an image or a volume. Costs as much as saving in the
    /// page: a copy, and for each edited field its bands.
    ///
    /// # Errors
    /// Returns a [`StudioError`] if bands of an edited field cannot be computed again, or for want of memory.
    pub fn edited_file(&self) -> Result<Option<ShapeFile>, StudioError> {
        let Opened::Shape(session) = &self.first else { return Ok(None) };
        let _turn = session.workspace.wait_turn();
        let Ok(mut prepared) = session.lock_prepared() else { return Ok(Some(session.unedited_file())) };
        session.saved_file(&mut prepared).map(Some).map_err(StudioError::from)
    }
}

/// State of the server: what is open, and its compute threads.
pub(crate) struct Studio {
    opened: RwLock<Vec<Opened>>,
    next_id: AtomicU64,
    autosave_folder: Option<PathBuf>,
    /// Folder of the first shape, in which uploaded shapes are saved too.
    folder: PathBuf,
    /// Separate thread pool with the requested number of threads; it also works in a forked process.
    pub(crate) pool: Arc<rayon::ThreadPool>,
    pub(crate) reports: Reports,
    is_done: AtomicBool,
    stop: Arc<AtomicBool>,
}

/// Interval at which the end of the studio is checked.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// Time for pending responses at shutdown.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_millis(500);

impl Studio {
    pub(crate) fn all_opened(&self) -> Vec<Opened> {
        self.opened.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(crate) fn opened(&self, id: u64) -> Result<Opened, ApiError> {
        let opened = self.all_opened().into_iter().find(|opened| opened.workspace().id == id);
        opened.ok_or_else(|| {
            ApiError::new(StatusCode::NOT_FOUND, format!("shape {id} is not open; reload the page"))
        })
    }

    /// Returns an open shape; images and volumes are refused.
    pub(crate) fn session(&self, id: u64) -> Result<Arc<Session>, ApiError> {
        self.opened(id)?.into_shape()
    }

    /// Opens a shape, an image or a volume, and starts computing its bands in the background.
    pub(crate) fn open(&self, input: StudioInput, progress: Progress<'_>) -> Result<Opened, StudioError> {
        let at = OpenedAt {
            id: self.next_id.fetch_add(1, Ordering::Relaxed),
            folder: self.folder.clone(),
            autosave_folder: self.autosave_folder.clone(),
            stop: Arc::clone(&self.stop),
        };
        let opened = Opened::new(input, at, progress)?;
        self.opened.write().unwrap_or_else(PoisonError::into_inner).push(opened.clone());
        let (background, pool) = (opened.clone(), Arc::clone(&self.pool));
        std::thread::spawn(move || {
            let workspace = background.workspace();
            let turn = workspace.wait_turn();
            pool.install(|| drop(background.describe()));
            drop(turn);
            // The bands would hold up the first picture.
            workspace.wait_until_described();
            let _turn = workspace.wait_turn();
            pool.install(|| drop(background.prepare()));
        });
        Ok(opened)
    }

    /// Opens what was uploaded or computed; a shutdown cancels it.
    pub(crate) fn open_made(&self, input: StudioInput) -> Result<Opened, StudioError> {
        self.open(input, Progress::none().with_cancel(&self.stop))
    }

    pub(crate) fn close(&self, id: u64) {
        let mut list = self.opened.write().unwrap_or_else(PoisonError::into_inner);
        list.retain(|opened| opened.workspace().id != id);
    }

    /// Returns a name `STEM-WORD.EXT` for a shape made from the shape `name`, with a number if an open shape has this
    /// name.
    pub(crate) fn unused_name(&self, name: &str, word: &str) -> String {
        let (stem, extension) = name.rsplit_once('.').unwrap_or((name, "ply"));
        let all = self.all_opened();
        let numbered = |k: usize| match k {
            1 => format!("{stem}-{word}.{extension}"),
            k => format!("{stem}-{word}-{k}.{extension}"),
        };
        let is_free = |name: &String| all.iter().all(|opened| opened.workspace().name != *name);
        (1..=all.len() + 1).map(numbered).find(is_free).unwrap_or_else(|| numbered(1))
    }

    pub(crate) fn finish(&self) {
        self.is_done.store(true, Ordering::Relaxed);
    }
}

/// Runs the studio on a shape, an image or a volume until the user ends it or `progress` is cancelled; `ready` is called
/// once with the address. `progress` reports while the nodes of a large graph are placed, before that.
///
/// # Errors
/// Returns a [`StudioError`] if the shape, the image or the volume is too large or is one that the studio does not show,
/// or if no port is available.
pub fn serve(
    input: StudioInput,
    params: &StudioParams,
    progress: Progress<'_>,
    ready: impl FnOnce(&StudioAddress),
) -> Result<StudioOutcome, StudioError> {
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
        opened: RwLock::new(Vec::new()),
        next_id: AtomicU64::new(1),
        autosave_folder: params.autosave_folder.clone().or_else(crate::autosave::default_folder),
        folder: input.path.as_deref().and_then(Path::parent).map_or_else(PathBuf::new, Path::to_path_buf),
        pool: Arc::new(pool.map_err(std::io::Error::other)?),
        reports: Reports::default(),
        is_done: AtomicBool::new(false),
        stop: Arc::default(),
    });
    let first = studio.open(input, progress)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let app =
        router(Arc::clone(&studio)).layer(middleware::from_fn_with_state(Arc::clone(&guard), check_request));
    let outcome = runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let host = name.as_deref().unwrap_or("127.0.0.1");
        let url = |path: String| format!("http://{host}:{}{path}", address.port());
        ready(&StudioAddress { url: url(guard.page()), url_for_browser: url(guard.path_for_browser()) });
        tokio::select! {
            served = axum::serve(listener, app) => served,
            () = wait_for_end(&studio, progress) => Ok(()),
        }
    });
    // Running computations are cancelled.
    let is_done = studio.is_done.load(Ordering::Relaxed);
    studio.stop.store(!is_done, Ordering::Relaxed);
    runtime.shutdown_timeout(SHUTDOWN_TIMEOUT);
    outcome?;
    let outcome = StudioOutcome::new(first, is_done);
    // The edited file may be asked for, which computes again.
    studio.stop.store(false, Ordering::Relaxed);
    Ok(outcome)
}

/// Returns when the user has ended the studio or `progress` is cancelled.
async fn wait_for_end(studio: &Studio, progress: Progress<'_>) {
    while !progress.is_cancelled() {
        tokio::time::sleep(POLL_INTERVAL).await;
        if studio.is_done.load(Ordering::Relaxed) {
            // Leaves time to send the response of the request that ended the studio.
            tokio::time::sleep(POLL_INTERVAL).await;
            return;
        }
    }
}
