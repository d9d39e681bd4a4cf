//! Handlers of the requests, which `PROTOCOL.md` describes.

use crate::band_edit::LevelsRequest;
use crate::document::Document;
use crate::grid_planes::PlaneRequest;
use crate::grid_session::{GridBands, stand_in_shape};
use crate::opened::Opened;
use crate::pose::{Follow, ReshapedBy, encode_carried};
use crate::prepared_shape::PreparedShape;
use crate::response::{ApiError, ApiResult, bytes_response, encode_points, encode_rows, json_response};
use crate::save::SaveRequest;
use crate::server::Studio;
use crate::session::{Session, StudioInput};
use crate::tasks::{run_blocking, run_cancellable, run_inline, with_opened, with_shape};
use crate::tool_routes::{compare_methods, create_report, denoise_shape, measure_deviation, show_report};
use crate::workspace::{Workspace, check_revision};
use crate::{assets, export_page, field_bands, fields, recipes, save};
use adwave::Progress;
use adwave::region::Region;
use adwave_io::{Format, ReadError, ReadLimits, Selection, read_bytes, recipe_to_text};
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, Path, Query, State};
use axum::http::{StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use axum::routing::{delete, get, post, put};
use serde::de::DeserializeOwned;
use serde_json::json;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Largest body of an edit or a region, in bytes; it holds thousands of strokes.
const MAX_BODY: usize = 64 << 20;
/// Largest uploaded file, in bytes.
const MAX_UPLOAD: usize = 2 << 30;

pub(crate) type StudioState = State<Arc<Studio>>;
type QueryParams = Query<HashMap<String, String>>;

pub(crate) fn router(studio: Arc<Studio>) -> Router {
    let shape = Router::new()
        .route("/", get(describe_shape).merge(delete(close_shape)))
        .route("/positions", get(send_positions))
        .route("/triangles", get(send_triangles))
        .route("/edges", get(send_edges))
        .route("/name", get(send_name))
        .route("/surface", get(send_surface))
        .route("/parts", get(send_parts))
        .route("/levels", put(set_levels))
        .route("/bands", get(stream_bands))
        .route("/edit", get(send_edit).merge(put(apply_edit)))
        .route("/exact", get(send_edited_positions))
        .route("/pose", post(follow_pose))
        .route("/drawn", put(set_drawn))
        .route("/weights", post(compute_weights))
        .route("/field", get(send_field))
        .route("/field-bands", get(send_field_bands))
        .route("/edited-field", get(send_edited_field))
        .route("/fields", post(add_fields).layer(DefaultBodyLimit::max(MAX_UPLOAD)))
        .route("/features", get(send_features))
        .route("/recipe", get(send_recipe).merge(put(apply_recipe)))
        .route("/save", post(save_file))
        .route("/download", get(download_file))
        .route("/page", get(download_page))
        .route("/report", post(create_report))
        .route("/compare", post(compare_methods))
        .route("/denoise", post(denoise_shape))
        .route("/deviation", post(measure_deviation))
        .route("/plane", get(send_plane));
    let upload = post(upload_shape).layer(DefaultBodyLimit::max(MAX_UPLOAD));
    Router::new()
        .route("/api/shapes", get(list_shapes).merge(upload))
        .nest("/api/shapes/{id}", shape)
        .route("/api/done", post(end_studio))
        .route("/report/{token}", get(show_report))
        .fallback(send_asset)
        .layer(DefaultBodyLimit::max(MAX_BODY))
        .with_state(studio)
}

/// Parses the JSON body of a request; `what` names its content in the error.
pub(crate) fn parse_body<T: DeserializeOwned>(body: &[u8], what: &str) -> Result<T, ApiError> {
    serde_json::from_slice(body).map_err(|e| ApiError::bad_request(format!("invalid {what}: {e}")))
}

async fn send_asset(uri: Uri) -> Response {
    if uri.path().starts_with("/api") {
        return ApiError::new(StatusCode::NOT_FOUND, format!("not found: {}", uri.path())).into_response();
    }
    assets::asset_response(uri.path())
}

async fn list_shapes(State(studio): StudioState) -> Response {
    let describe = |opened: &Opened| {
        let workspace = opened.workspace();
        json!({"id": workspace.id, "name": workspace.name, "domain": opened.domain()})
    };
    let list: Vec<_> = studio.all_opened().iter().map(describe).collect();
    json_response(&json!({"version": env!("CARGO_PKG_VERSION"), "shapes": list})).into_response()
}

async fn upload_shape(State(studio): StudioState, Query(query): QueryParams, body: Bytes) -> Response {
    let read = move |studio: &Studio| {
        let name = query.get("name").map_or("shape", |name| name.rsplit(['/', '\\']).next().unwrap_or(name));
        let file = read_bytes(body.into(), Some(name), &ReadLimits::default())
            .map_err(|e| upload_error(name, &e))?;
        let selected = Selection::default().apply(file);
        let file = selected.map_err(|e| ApiError::bad_request(format!("{name}: {e}")))?.file;
        let shape = if file.grid().is_some() {
            stand_in_shape()?
        } else {
            file.to_shape().map_err(|e| ApiError::bad_request(format!("{name}: {e}")))?
        };
        let opened = studio.open_made(StudioInput { name: name.to_owned(), path: None, file, shape })?;
        let Workspace { id, name, .. } = opened.workspace();
        json_response(&json!({"id": id, "name": name, "domain": opened.domain()}))
    };
    run_blocking(studio, move |studio| studio.pool.install(|| read(studio))).await
}

/// Converts the error of an uploaded file. For an unknown format it includes the list of readable formats.
fn upload_error(name: &str, error: &ReadError) -> ApiError {
    if !matches!(error, ReadError::UnknownFormat { .. }) {
        return ApiError::bad_request(format!("{name}: {error}"));
    }
    let describe = |format: Format| {
        let extensions: Vec<String> = format.endings().iter().map(|e| format!(".{e}")).collect();
        json!({"title": format.title(), "extensions": extensions})
    };
    let formats: Vec<_> = Format::all().filter(|format| format.can_read()).map(describe).collect();
    ApiError::bad_request(format!("{name} is not a shape adwave can read"))
        .with_fields(json!({"readable_formats": formats}))
}

async fn close_shape(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    run_blocking(studio, move |studio| {
        studio.opened(id)?;
        studio.close(id);
        json_response(&json!({}))
    })
    .await
}

async fn describe_shape(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    with_opened(studio, id, |opened| {
        let described = opened.describe()?;
        opened.workspace().is_described.store(true, Ordering::Relaxed);
        json_response(&described)
    })
    .await
}

async fn send_positions(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    run_inline(studio, id, |session| Ok(bytes_response(encode_points(session.points(), session.center))))
        .await
}

async fn send_triangles(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    run_inline(studio, id, |session| {
        let triangles = &session.triangles;
        Ok(bytes_response(encode_rows(triangles.len(), 12, |t, row| {
            for c in 0..3 {
                row[4 * c..][..4].copy_from_slice(&triangles[t][c].to_le_bytes());
            }
        })))
    })
    .await
}

/// Sends the edges of a graph or a curve, `u32 × 2` each.
async fn send_edges(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    run_inline(studio, id, |session| {
        let edges = session.edges();
        Ok(bytes_response(encode_rows(edges.len(), 8, |e, row| {
            for (bytes, node) in row.chunks_exact_mut(4).zip(edges[e]) {
                bytes.copy_from_slice(&node.to_le_bytes());
            }
        })))
    })
    .await
}

/// Sends the name that the file has for a node.
async fn send_name(State(studio): StudioState, Path(id): Path<u64>, Query(query): QueryParams) -> Response {
    run_inline(studio, id, move |session| {
        let node: Option<usize> = query.get("vertex").and_then(|vertex| vertex.parse().ok());
        let file = session.file();
        let name = file.vertex_names().zip(node).and_then(|(names, node)| names.get(node));
        json_response(name.ok_or_else(|| ApiError::bad_request("?vertex= must be a node with a name"))?)
    })
    .await
}

/// Sends the input for distances along the surface: positions in double precision, and the index of the welded point of
/// each vertex.
async fn send_surface(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    with_shape(studio, id, |session| {
        let points = session.points();
        let welded = session.walk_decomposer()?.vertex_map().as_slice();
        let mut content = encode_rows(points.len(), 24, |x, row| {
            for c in 0..3 {
                row[8 * c..][..8].copy_from_slice(&points[x][c].to_le_bytes());
            }
        });
        content.extend(encode_rows(welded.len(), 4, |x, row| row.copy_from_slice(&welded[x].to_le_bytes())));
        Ok(bytes_response(content))
    })
    .await
}

/// Sends the first vertex of the connected part of each vertex, `u32 × n`.
async fn send_parts(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    with_shape(studio, id, |session| {
        let prepared = session.lock_unsplit()?;
        let parts = prepared.parts()?;
        let first = |part: u32| parts.parts.get(part as usize).map_or(u32::MAX, |part| part.first_vertex);
        Ok(bytes_response(encode_rows(parts.of_vertex.len(), 4, |v, row| {
            row.copy_from_slice(&first(parts.of_vertex[v]).to_le_bytes());
        })))
    })
    .await
}

async fn set_levels(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    enum Levels {
        Shape(Box<PreparedShape>),
        Grid(Box<GridBands>),
    }
    let compute = move |opened: &Opened, (), progress: Progress<'_>| {
        let request: LevelsRequest = parse_body(&body, "choice of bands")?;
        Ok(match opened {
            Opened::Shape(session) => {
                let walk = session.walk_decomposer()?;
                Levels::Shape(Box::new(session.prepare(walk, request.to_levels(walk)?, progress)?))
            }
            Opened::Grid(session) => Levels::Grid(Box::new(session.bands_of_request(&request, progress)?)),
        })
    };
    run_cancellable(studio, id, Opened::prepare_levels, compute, |opened, levels| match (opened, levels) {
        (Opened::Shape(session), Levels::Shape(next)) => replace_levels(session, *next),
        (Opened::Grid(session), Levels::Grid(next)) => session.replace_levels(*next),
        _ => unreachable!("what is open stays what it is"),
    })
    .await
}

/// Replaces the levels of a shape; the gains of the edit follow their widths.
fn replace_levels(session: &Session, mut next: PreparedShape) -> ApiResult {
    let mut prepared = session.lock_prepared()?;
    let mut document = prepared.bands.document.clone();
    document.map_levels(&prepared.bands.sigmas(), &next.bands.sigmas());
    next.poser = Arc::clone(&prepared.poser);
    next.apply_edit(document, &session.file())?;
    *prepared = next;
    session.store_edit(&prepared)?;
    json_response(&prepared.bands.describe_levels())
}

/// Streams the bands from coarse to fine.
async fn stream_bands(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    let session = match studio.session(id) {
        Ok(session) => session,
        Err(error) => return error.into_response(),
    };
    let (send, mut receive) = tokio::sync::mpsc::channel::<Result<Bytes, std::io::Error>>(2);
    let (shape, server) = (Arc::clone(&session), Arc::clone(&studio));
    let ready = tokio::task::spawn_blocking(move || {
        let _turn = shape.workspace.wait_turn();
        server.pool.install(|| {
            shape.lock_prepared().map(|prepared| (prepared.bands.levels.clone(), prepared.bands.n_levels()))
        })
    });
    let (levels, n_levels) = match ready.await {
        Ok(Ok(levels)) => levels,
        Ok(Err(error)) => return error.into_response(),
        Err(_) => {
            return ApiError::new(
                StatusCode::INTERNAL_SERVER_ERROR,
                "internal error: the bands could not be computed; please report it",
            )
            .into_response();
        }
    };
    tokio::task::spawn_blocking(move || {
        for level in (1..=n_levels).rev() {
            let turn = session.workspace.wait_turn();
            let Ok(prepared) = session.lock_prepared() else { return };
            if prepared.bands.levels != levels {
                return; // the levels were replaced meanwhile
            }
            let (scale, values) = studio.pool.install(|| prepared.encode_band(level));
            drop(prepared);
            drop(turn);
            let head = [(level as u32).to_le_bytes(), scale.to_le_bytes()].concat();
            let sent = send.blocking_send(Ok(Bytes::from(head)));
            if sent.is_err() || send.blocking_send(Ok(Bytes::from(values))).is_err() {
                return; // the page was closed
            }
        }
    });
    bytes_response(Body::from_stream(futures_util::stream::poll_fn(move |context| {
        receive.poll_recv(context)
    })))
}

async fn send_edit(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    with_opened(studio, id, |opened| match opened {
        Opened::Shape(session) => json_response(&session.lock_unsplit()?.bands.document),
        Opened::Grid(session) => json_response(session.lock_bands()?.document()),
    })
    .await
}

async fn apply_edit(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    with_opened(studio, id, move |opened| {
        let document: Document = parse_body(&body, "edit")?;
        match opened {
            Opened::Shape(session) => {
                let mut prepared = session.lock_prepared()?;
                check_revision(&prepared.bands.document, &document)?;
                let summary = prepared.apply_edit(document, &session.file())?;
                session.store_edit(&prepared)?;
                json_response(&summary)
            }
            Opened::Grid(session) => json_response(&session.apply_edit(document)?),
        }
    })
    .await
}

async fn send_edited_positions(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    with_shape(studio, id, |session| {
        let points = Arc::clone(&session.lock_prepared()?.points);
        Ok(bytes_response(encode_points(&points, session.center)))
    })
    .await
}

/// Sets the vertices that the page draws while the shape moves, `u32 × m`.
async fn set_drawn(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    run_inline(studio, id, move |session| {
        let vertices: Vec<u32> = body.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
        let n = session.points().len();
        if let Some(vertex) = vertices.iter().find(|v| **v as usize >= n) {
            let message = format!("drawn vertices must be below {n}, got {vertex}");
            return Err(ApiError::bad_request(message));
        }
        session.set_drawn(vertices);
        json_response(&json!({}))
    })
    .await
}

/// Applies the clones and the pose in the body to the shape as it was opened, without changing the edit.
async fn follow_pose(
    State(studio): StudioState,
    Path(id): Path<u64>,
    Query(query): QueryParams,
    body: Bytes,
) -> Response {
    with_shape(studio, id, move |session| {
        let by: ReshapedBy = parse_body(&body, "pose")?;
        by.check()?;
        if session.shape.points().is_none() {
            let message = "a graph without positions has no pose; edit its fields";
            return Err(ApiError::bad_request(message));
        }
        let is_drag = query.get("follow").is_some_and(|follow| follow == "step");
        let follow = if is_drag { Follow::Step } else { Follow::Rest };
        let drawn = session.drawn_vertices();
        let vertices = match query.get("of").map(String::as_str) {
            Some("drawn") => Some(drawn.as_slice()),
            _ => None,
        };
        let poser = Arc::clone(&session.lock_unsplit()?.poser);
        let carried = poser.carried_vertices(&by, &session.file(), follow, vertices)?;
        Ok(bytes_response(encode_carried(&carried, session.center)))
    })
    .await
}

async fn compute_weights(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    with_shape(studio, id, move |session| {
        let region: Region = parse_body(&body, "region")?;
        let mut prepared = session.lock_prepared()?;
        let weights =
            prepared.region_weights(&region, &session.file()).map_err(|e| ApiError::from_classified(&e))?;
        let weights = weights.to_vertices(prepared.bands.decomposer.vertex_map());
        Ok(bytes_response(encode_rows(weights.len(), 1, |x, byte| {
            byte[0] = (255.0 * weights[x]).round() as u8;
        })))
    })
    .await
}

async fn send_field(State(studio): StudioState, Path(id): Path<u64>, Query(query): QueryParams) -> Response {
    with_shape(studio, id, move |session| {
        let name = query
            .get("name")
            .ok_or_else(|| ApiError::bad_request("the name of a field is missing; add ?name=NAME"))?;
        match query.get("of").map(String::as_str) {
            Some("region") => fields::region_field_response(session, name),
            Some("series") => fields::series_response(session, name),
            _ => fields::field_response(session, name),
        }
    })
    .await
}

/// Adds the values of the file in the body as fields.
async fn add_fields(
    State(studio): StudioState,
    Path(id): Path<u64>,
    Query(query): QueryParams,
    body: Bytes,
) -> Response {
    with_shape(studio, id, move |session| {
        let name = query.get("name").map_or("values", |name| name.rsplit(['/', '\\']).next().unwrap_or(name));
        if name.is_empty() || name.starts_with('.') || name.contains([':', '\0']) {
            let message = "the name of the file must be a plain file name";
            return Err(ApiError::bad_request(format!("{message}, got '{name}'; rename it")));
        }
        json_response(&json!({"fields": session.add_fields(name, &body)?}))
    })
    .await
}

/// Sends the bands of a field; other requests are answered while the bands are computed.
async fn send_field_bands(
    State(studio): StudioState,
    Path(id): Path<u64>,
    Query(query): QueryParams,
) -> Response {
    let name = query.get("name").cloned().unwrap_or_default();
    let (wanted, computed) = (name.clone(), name.clone());
    let snapshot =
        move |opened: &Opened| field_bands::unstored_levels(&*opened.clone().into_shape()?, &wanted);
    let compute = move |opened: &Opened, levels, progress: Progress<'_>| {
        field_bands::compute_bands(&*opened.clone().into_shape()?, &computed, levels, progress)
    };
    run_cancellable(studio, id, snapshot, compute, move |opened, computed| {
        field_bands::bands_response(&*opened.clone().into_shape()?, &name, computed)
    })
    .await
}

async fn send_edited_field(
    State(studio): StudioState,
    Path(id): Path<u64>,
    Query(query): QueryParams,
) -> Response {
    with_shape(studio, id, move |session| {
        let name = query.get("name").map_or("", String::as_str);
        field_bands::edited_field_response(session, name, query.get("format").map(String::as_str))
    })
    .await
}

async fn send_features(
    State(studio): StudioState,
    Path(id): Path<u64>,
    Query(query): QueryParams,
) -> Response {
    with_shape(studio, id, move |session| {
        let theta = query.get("theta").map(|theta| theta.parse()).transpose();
        let theta = theta.map_err(|_| ApiError::bad_request("theta must be a number"))?;
        fields::feature_response(session, theta)
    })
    .await
}

async fn send_recipe(State(studio): StudioState, Path(id): Path<u64>, Query(query): QueryParams) -> Response {
    with_opened(studio, id, move |opened| match opened {
        Opened::Shape(session) => recipes::recipe_response(session, query.get("field").map(String::as_str)),
        Opened::Grid(session) => Ok(bytes_response(recipe_to_text(&session.lock_bands()?.to_recipe()))),
    })
    .await
}

async fn apply_recipe(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    with_opened(studio, id, move |opened| {
        let text =
            std::str::from_utf8(&body).map_err(|_| ApiError::bad_request("the recipe must be UTF-8 text"))?;
        match opened {
            Opened::Shape(session) => recipes::apply_recipe(session, text),
            Opened::Grid(session) => session.apply_recipe(text),
        }
    })
    .await
}

async fn save_file(State(studio): StudioState, Path(id): Path<u64>, body: Bytes) -> Response {
    with_opened(studio, id, move |opened| {
        let request: SaveRequest =
            if body.is_empty() { SaveRequest::default() } else { parse_body(&body, "file name")? };
        match opened {
            Opened::Shape(session) => save::save(session, &request),
            Opened::Grid(session) => session.save(&request),
        }
    })
    .await
}

async fn download_file(
    State(studio): StudioState,
    Path(id): Path<u64>,
    Query(query): QueryParams,
) -> Response {
    with_opened(studio, id, move |opened| {
        let format = query.get("format").map(String::as_str);
        match opened {
            Opened::Shape(session) => save::download(session, format.unwrap_or("ply")),
            Opened::Grid(session) => session.download(format, query.get("value_type").map(String::as_str)),
        }
    })
    .await
}

/// Sends the values and bands of a part of an image, or of a slice of a volume.
async fn send_plane(State(studio): StudioState, Path(id): Path<u64>, Query(query): QueryParams) -> Response {
    with_opened(studio, id, move |opened| {
        let session = opened.clone().into_grid()?;
        let plane = PlaneRequest::parse(&query, session.layout(), session.n_frames())?;
        Ok(bytes_response(session.lock_bands()?.encode_plane(&plane, session.layout())?))
    })
    .await
}

async fn download_page(State(studio): StudioState, Path(id): Path<u64>) -> Response {
    with_shape(studio, id, |session| export_page::export_page(session)).await
}

async fn end_studio(State(studio): StudioState) -> Response {
    studio.finish();
    json_response(&json!({})).into_response()
}
