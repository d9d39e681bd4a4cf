//! Handlers of the tools: report, comparison with other methods, denoising, and distances from another shape.

use crate::compare::{self, CompareRequest};
use crate::deviation::{DeviationRequest, deviation_response};
use crate::report;
use crate::response::{ApiError, json_response};
use crate::routes::{StudioState, parse_body};
use crate::session::{Session, StudioInput};
use crate::tasks::{run_blocking, spawn_blocking_task};
use crate::workspace::Workspace;
use adwave::denoise::{DenoiseParams, denoise};
use adwave::operator::OperatorParams;
use adwave::shape::PreparedGeometry;
use adwave_io::MovedNormals;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::response::Response;
use serde::Deserialize;
use serde_json::json;
use std::sync::Arc;

pub(crate) async fn create_report(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    spawn_blocking_task(
        studio,
        id,
        |session| session.edited_file(&*session.lock_prepared()?),
        |studio, session, file| report::build_report(studio, session, &file),
    )
    .await
}

pub(crate) async fn show_report(State(studio): StudioState, Path(token): Path<String>) -> Response {
    studio.reports.page_response(&token)
}

pub(crate) async fn compare_methods(
    State(studio): StudioState,
    Path(id): Path<u64>,
    body: Bytes,
) -> Response {
    let snapshot = move |session: &Session| {
        let request: CompareRequest = parse_body(&body, "comparison")?;
        let prepared = session.lock_prepared()?;
        Ok((request.method, Arc::clone(&prepared.unposed), prepared.bands.decomposer.clone()))
    };
    spawn_blocking_task(studio, id, snapshot, |_, session, (method, edited, decomposer)| {
        compare::compare(session, method, &edited, &decomposer)
    })
    .await
}

/// Body of `POST denoise`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DenoiseRequest {
    /// Factor for the estimated noise level; 1 by default.
    #[serde(default = "default_strength")]
    strength: f64,
}

fn default_strength() -> f64 {
    1.0
}

pub(crate) async fn denoise_shape(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    let snapshot = |session: &Session| session.edited_file(&*session.lock_prepared()?);
    spawn_blocking_task(studio, id, snapshot, move |studio, session, file| {
        let request: DenoiseRequest = parse_body(&body, "denoising strength")?;
        let shape = file.to_shape_as(file.kind()).map_err(|e| ApiError::bad_request(e.to_string()))?;
        let geometry = PreparedGeometry::new(&shape, OperatorParams::default().weld, session.progress())
            .map_err(|e| ApiError::from_classified(&e))?;
        let params = DenoiseParams::default().with_strength(request.strength);
        let clean =
            denoise(&geometry, &params, session.progress()).map_err(|e| ApiError::from_classified(&e))?;
        let mut file = file;
        file.move_points(clean.points, MovedNormals::Follow, session.progress())
            .map_err(|e| ApiError::from_classified(&e))?;
        let shape = file.to_shape_as(file.kind()).map_err(|e| ApiError::bad_request(e.to_string()))?;
        let name = studio.unused_name(&session.workspace.name, "denoised");
        // Saved in the same folder, with an edit of its own.
        let opened = studio.open_made(StudioInput { name, path: None, file, shape })?;
        let Workspace { id, name, .. } = opened.workspace();
        json_response(&json!({"id": id, "name": name, "noise": clean.info.noise}))
    })
    .await
}

/// Measures the distances of the edited shape from another open shape.
pub(crate) async fn measure_deviation(
    State(studio): StudioState,
    Path(id): Path<u64>,
    body: Bytes,
) -> Response {
    run_blocking(studio, move |studio| {
        let request: DeviationRequest = parse_body(&body, "other shape")?;
        let edited = |id: u64| {
            let session = studio.session(id)?;
            let turn = session.workspace.wait_turn();
            let file = studio.pool.install(|| session.edited_file(&*session.lock_prepared()?))?;
            drop(turn);
            Ok::<_, ApiError>((session, file))
        };
        let ((session, file), (_, other)) = (edited(id)?, edited(request.from)?);
        studio.pool.install(|| deviation_response(&file, &other, session.progress()))
    })
    .await
}
