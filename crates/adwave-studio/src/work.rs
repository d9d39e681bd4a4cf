//! Where requests are worked on: beside the threads that answer, with the studio's own threads, one after the other for each shape.

use crate::answer::{Answer, Refused};
use crate::server::Studio;
use crate::session::Session;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

/// Work that takes its time, beside the threads that answer.
pub(crate) async fn working(
    studio: Arc<Studio>,
    work: impl FnOnce(&Studio) -> Answer + Send + 'static,
) -> Response {
    let done = tokio::task::spawn_blocking(move || work(&studio)).await;
    let broken = || {
        let told = "the studio broke one of its own rules; please report it, with the shape and what you did";
        Err(Refused::new(StatusCode::INTERNAL_SERVER_ERROR, told))
    };
    done.unwrap_or_else(|_| broken()).into_response()
}

/// The same of one of the shapes, in its turn, with the studio's own threads.
pub(crate) async fn of_shape(
    studio: Arc<Studio>,
    id: u64,
    work: impl FnOnce(&Arc<Session>) -> Answer + Send + 'static,
) -> Response {
    working(studio, move |studio| {
        let session = studio.session(id)?;
        let _turn = session.turn();
        studio.pool.install(|| work(&session))
    })
    .await
}

/// What needs no bands does not wait for them.
pub(crate) async fn at_once(
    studio: Arc<Studio>,
    id: u64,
    work: impl FnOnce(&Session) -> Answer + Send + 'static,
) -> Response {
    working(studio, move |studio| {
        let session = studio.session(id)?;
        studio.pool.install(|| work(&session))
    })
    .await
}

/// Work that takes long: `take` is done in the shape's turn, `work` with what it gave beside all others.
pub(crate) async fn beside<T: Send>(
    studio: Arc<Studio>,
    id: u64,
    take: impl FnOnce(&Session) -> Result<T, Refused> + Send + 'static,
    work: impl FnOnce(&Studio, &Session, T) -> Answer + Send + 'static,
) -> Response {
    working(studio, move |studio| {
        let session = studio.session(id)?;
        let turn = session.turn();
        let taken = studio.pool.install(|| take(&session))?;
        drop(turn);
        studio.pool.install(|| work(studio, &session, taken))
    })
    .await
}
