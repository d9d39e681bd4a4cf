//! Execution of requests on blocking threads, with the studio's own thread pool.
//!
//! Requests that need the bands of a shape are handled one after another for each shape.

use crate::opened::Opened;
use crate::response::{ApiError, ApiResult};
use crate::server::Studio;
use crate::session::Session;
use adwave::Progress;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs `task` on a blocking thread, so that other requests are answered meanwhile.
pub(crate) async fn run_blocking(
    studio: Arc<Studio>,
    task: impl FnOnce(&Studio) -> ApiResult + Send + 'static,
) -> Response {
    let result = tokio::task::spawn_blocking(move || task(&studio)).await;
    let panicked = || {
        let message =
            "internal error in the studio; please report it with the shape and the steps that led to it";
        Err(ApiError::new(StatusCode::INTERNAL_SERVER_ERROR, message))
    };
    result.unwrap_or_else(|_| panicked()).into_response()
}

/// Runs `task` on what is open, after waiting for its turn, in the studio's thread pool.
pub(crate) async fn with_opened(
    studio: Arc<Studio>,
    id: u64,
    task: impl FnOnce(&Opened) -> ApiResult + Send + 'static,
) -> Response {
    run_blocking(studio, move |studio| {
        let opened = studio.opened(id)?;
        let _turn = opened.workspace().wait_turn();
        studio.pool.install(|| task(&opened))
    })
    .await
}

/// Runs `task` on one shape, after waiting for the shape's turn, in the studio's thread pool.
pub(crate) async fn with_shape(
    studio: Arc<Studio>,
    id: u64,
    task: impl FnOnce(&Arc<Session>) -> ApiResult + Send + 'static,
) -> Response {
    run_blocking(studio, move |studio| {
        let session = studio.session(id)?;
        let _turn = session.workspace.wait_turn();
        studio.pool.install(|| task(&session))
    })
    .await
}

/// Runs a short `task` that needs no bands, without waiting for other requests of the shape.
pub(crate) async fn run_inline(
    studio: Arc<Studio>,
    id: u64,
    task: impl FnOnce(&Session) -> ApiResult + Send + 'static,
) -> Response {
    run_blocking(studio, move |studio| {
        let session = studio.session(id)?;
        studio.pool.install(|| task(&session))
    })
    .await
}

/// Flag that cancels a computation when it is dropped, because the request was cancelled or is finished.
pub(crate) struct CancelOnDrop(pub(crate) Arc<AtomicBool>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Computes bands without blocking other requests of the shape, then installs them in the shape's turn: `snapshot` copies
/// the input in a turn before, and `compute` must lock nothing. The computation is cancelled if the page is closed or
/// drops the request.
pub(crate) async fn run_cancellable<S: Send, T: Send>(
    studio: Arc<Studio>,
    id: u64,
    snapshot: impl FnOnce(&Opened) -> Result<S, ApiError> + Send + 'static,
    compute: impl FnOnce(&Opened, S, Progress<'_>) -> Result<T, ApiError> + Send + 'static,
    install: impl FnOnce(&Opened, T) -> ApiResult + Send + 'static,
) -> Response {
    let cancel = Arc::new(AtomicBool::new(false));
    let _guard = CancelOnDrop(Arc::clone(&cancel));
    run_blocking(studio, move |studio| {
        let opened = studio.opened(id)?;
        let first_turn = opened.workspace().wait_turn();
        let input = studio.pool.install(|| snapshot(&opened))?;
        drop(first_turn);
        // A shutdown cancels too.
        let pass_on = |_: u64, _: u64| {
            if opened.workspace().progress().is_cancelled() {
                cancel.store(true, Ordering::Relaxed);
            }
        };
        let progress = Progress::none().with_cancel(&cancel).with_report(&pass_on);
        let result = studio.pool.install(|| compute(&opened, input, progress))?;
        let _turn = opened.workspace().wait_turn();
        if cancel.load(Ordering::Relaxed) {
            return Err(ApiError::new(
                StatusCode::SERVICE_UNAVAILABLE,
                "the computation of the bands was cancelled",
            ));
        }
        studio.pool.install(|| install(&opened, result))
    })
    .await
}

/// Runs a long task: `snapshot` copies its input in the shape's turn, then `task` runs without blocking other requests.
pub(crate) async fn spawn_blocking_task<T: Send>(
    studio: Arc<Studio>,
    id: u64,
    snapshot: impl FnOnce(&Session) -> Result<T, ApiError> + Send + 'static,
    task: impl FnOnce(&Studio, &Session, T) -> ApiResult + Send + 'static,
) -> Response {
    run_blocking(studio, move |studio| {
        let session = studio.session(id)?;
        let turn = session.workspace.wait_turn();
        let input = studio.pool.install(|| snapshot(&session))?;
        drop(turn);
        studio.pool.install(|| task(studio, &session, input))
    })
    .await
}
