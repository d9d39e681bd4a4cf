//! Execution of requests on blocking threads, with the studio's own thread pool.
//!
//! Requests that need the bands of a shape are handled one after the other per shape.

use crate::response::{ApiError, ApiResult};
use crate::server::Studio;
use crate::session::Session;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

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

/// Runs `task` on one shape, in its turn and in the studio's thread pool.
pub(crate) async fn with_shape(
    studio: Arc<Studio>,
    id: u64,
    task: impl FnOnce(&Arc<Session>) -> ApiResult + Send + 'static,
) -> Response {
    run_blocking(studio, move |studio| {
        let session = studio.session(id)?;
        let _turn = session.wait_turn();
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

/// Runs a long task: `snapshot` copies its input in the shape's turn, `task` then runs without blocking other requests.
pub(crate) async fn spawn_blocking_task<T: Send>(
    studio: Arc<Studio>,
    id: u64,
    snapshot: impl FnOnce(&Session) -> Result<T, ApiError> + Send + 'static,
    task: impl FnOnce(&Studio, &Session, T) -> ApiResult + Send + 'static,
) -> Response {
    run_blocking(studio, move |studio| {
        let session = studio.session(id)?;
        let turn = session.wait_turn();
        let input = studio.pool.install(|| snapshot(&session))?;
        drop(turn);
        studio.pool.install(|| task(studio, &session, input))
    })
    .await
}
