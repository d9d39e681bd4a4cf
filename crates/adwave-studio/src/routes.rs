//! What each request does; see `PROTOCOL.md`.

use crate::answer::{Refused, bytes, json, points_bytes, rows};
use crate::compare::CompareAsked;
use crate::document::Document;
use crate::prepared::{LevelsAsked, Prepared};
use crate::save::SaveAsked;
use crate::server::Studio;
use crate::session::{Opened, Session};
use crate::work::{at_once, beside, of_shape, working};
use crate::{assets, compare, fields, page, report, save};
use adwave::denoise::{DenoiseParams, denoise};
use adwave::operator::OperatorParams;
use adwave::region::Region;
use adwave::shape::PreparedGeometry;
use adwave_io::{ReadLimits, parse_recipe, read_bytes, recipe_to_text};
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, Path, Query, State};
use axum::http::{StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use axum::routing::{delete, get, post, put};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use std::collections::HashMap;
use std::sync::Arc;

/// Bytes of an edit or a region at the most: thousands of strokes.
const MAX_BODY: usize = 64 << 20;
/// Bytes of a shape that is dropped on the page at the most.
const MAX_UPLOAD: usize = 2 << 30;

type Shared = State<Arc<Studio>>;
type Asked = Query<HashMap<String, String>>;

pub(crate) fn router(studio: Arc<Studio>) -> Router {
    let shape = Router::new()
        .route("/", get(info).merge(delete(close)))
        .route("/positions", get(positions))
        .route("/triangles", get(triangles))
        .route("/surface", get(surface))
        .route("/levels", put(levels))
        .route("/bands", get(bands))
        .route("/edit", get(edit).merge(put(change)))
        .route("/exact", get(exact))
        .route("/weights", post(weights))
        .route("/field", get(field))
        .route("/features", get(features))
        .route("/recipe", get(recipe).merge(put(open_recipe)))
        .route("/save", post(save_as))
        .route("/download", get(download))
        .route("/page", get(page))
        .route("/report", post(make_report))
        .route("/compare", post(compared))
        .route("/denoise", post(denoised));
    let upload = post(upload).layer(DefaultBodyLimit::max(MAX_UPLOAD));
    Router::new()
        .route("/api/shapes", get(shapes).merge(upload))
        .nest("/api/shapes/{id}", shape)
        .route("/api/done", post(done))
        .route("/report/{word}", get(show_report))
        .fallback(own_page)
        .layer(DefaultBodyLimit::max(MAX_BODY))
        .with_state(studio)
}

fn parsed<T: DeserializeOwned>(body: &[u8], what: &str) -> Result<T, Refused> {
    serde_json::from_slice(body).map_err(|e| Refused::wrong(format!("this is no {what}: {e}")))
}

async fn own_page(uri: Uri) -> Response {
    if uri.path().starts_with("/api") {
        return Refused::new(StatusCode::NOT_FOUND, format!("there is no {}", uri.path())).into_response();
    }
    assets::file(uri.path())
}

async fn shapes(State(studio): Shared) -> Response {
    let list: Vec<_> = studio.sessions().iter().map(|s| json!({"id": s.id, "name": s.opened.name})).collect();
    json(&json!({"version": env!("CARGO_PKG_VERSION"), "shapes": list})).into_response()
}

async fn upload(State(studio): Shared, Query(asked): Asked, body: Bytes) -> Response {
    let read = move |studio: &Studio| {
        let name = asked.get("name").map_or("shape", |name| name.rsplit(['/', '\\']).next().unwrap_or(name));
        let file = read_bytes(body.into(), Some(name), &ReadLimits::default())
            .map_err(|e| Refused::wrong(format!("{name}: {e}")))?;
        let shape = file.to_shape().map_err(|e| Refused::wrong(format!("{name}: {e}")))?;
        let session = studio.open(Opened { name: name.to_owned(), path: None, file, shape })?;
        json(&json!({"id": session.id, "name": session.opened.name}))
    };
    working(studio, move |studio| studio.pool.install(|| read(studio))).await
}

async fn close(State(studio): Shared, Path(id): Path<u64>) -> Response {
    working(studio, move |studio| {
        studio.session(id)?;
        studio.close(id);
        json(&json!({}))
    })
    .await
}

async fn info(State(studio): Shared, Path(id): Path<u64>) -> Response {
    of_shape(studio, id, |session| json(&session.info()?)).await
}

async fn positions(State(studio): Shared, Path(id): Path<u64>) -> Response {
    at_once(studio, id, |session| Ok(bytes(points_bytes(session.points(), session.center)))).await
}

async fn triangles(State(studio): Shared, Path(id): Path<u64>) -> Response {
    at_once(studio, id, |session| {
        let triangles = &session.triangles;
        Ok(bytes(rows(triangles.len(), 12, |t, row| {
            for c in 0..3 {
                row[4 * c..][..4].copy_from_slice(&triangles[t][c].to_le_bytes());
            }
        })))
    })
    .await
}

/// What distances along the surface are measured by: positions in double precision, and the place of each vertex.
async fn surface(State(studio): Shared, Path(id): Path<u64>) -> Response {
    of_shape(studio, id, |session| {
        let points = session.points();
        let places = session.walk()?.geometry().vertex_map().as_slice();
        let mut content = rows(points.len(), 24, |x, row| {
            for c in 0..3 {
                row[8 * c..][..8].copy_from_slice(&points[x][c].to_le_bytes());
            }
        });
        content.extend(rows(places.len(), 4, |x, row| row.copy_from_slice(&places[x].to_le_bytes())));
        Ok(bytes(content))
    })
    .await
}

async fn levels(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    of_shape(studio, id, move |session| {
        let asked: LevelsAsked = parsed(&body, "choice of levels")?;
        let mut fresh = Prepared::asked(&session.opened.shape, session.walk()?, &asked, session.progress())?;
        let mut prepared = session.prepared()?;
        // Gains are those of levels: of as many they are kept.
        let mut document = prepared.document.clone();
        if fresh.n_levels() != prepared.n_levels() {
            document.layers.clear();
        }
        fresh.edit(document, &session.opened.file)?;
        *prepared = fresh;
        session.keep(&prepared)?;
        json(&json!({"levels": prepared.level_list(), "edit": prepared.document}))
    })
    .await
}

/// Bands one by one, coarse to fine, each sent when it is there.
async fn bands(State(studio): Shared, Path(id): Path<u64>) -> Response {
    let session = match studio.session(id) {
        Ok(session) => session,
        Err(refused) => return refused.into_response(),
    };
    let (send, mut receive) = tokio::sync::mpsc::channel::<Result<Bytes, std::io::Error>>(2);
    let (own, pool) = (Arc::clone(&session), Arc::clone(&studio));
    let ready = tokio::task::spawn_blocking(move || {
        let _turn = own.turn();
        pool.pool.install(|| own.prepared().map(|prepared| (prepared.levels.clone(), prepared.n_levels())))
    });
    let (levels, n_levels) = match ready.await {
        Ok(Ok(levels)) => levels,
        Ok(Err(refused)) => return refused.into_response(),
        Err(_) => return Refused::new(StatusCode::INTERNAL_SERVER_ERROR, "no bands").into_response(),
    };
    tokio::task::spawn_blocking(move || {
        for level in (1..=n_levels).rev() {
            let turn = session.turn();
            let Ok(prepared) = session.prepared() else { return };
            if prepared.levels != levels {
                return; // others have been asked for
            }
            let (scale, values) = studio.pool.install(|| prepared.band(level));
            drop(prepared);
            drop(turn);
            let head = [(level as u32).to_le_bytes(), scale.to_le_bytes()].concat();
            let sent = send.blocking_send(Ok(Bytes::from(head)));
            if sent.is_err() || send.blocking_send(Ok(Bytes::from(values))).is_err() {
                return; // the page is gone
            }
        }
    });
    bytes(Body::from_stream(futures_util::stream::poll_fn(move |context| receive.poll_recv(context))))
}

async fn edit(State(studio): Shared, Path(id): Path<u64>) -> Response {
    of_shape(studio, id, |session| json(&session.prepared()?.document)).await
}

async fn change(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    of_shape(studio, id, move |session| {
        let document: Document = parsed(&body, "edit")?;
        let mut prepared = session.prepared()?;
        let kept = &prepared.document;
        if document.revision <= kept.revision && document != *kept {
            let told = format!(
                "revision {} is not after {}, which is kept; was the shape edited in another tab?",
                document.revision, kept.revision
            );
            return Err(Refused::new(StatusCode::CONFLICT, told).with(json!({"edit": kept})));
        }
        let moved = prepared.edit(document, &session.opened.file)?;
        session.keep(&prepared)?;
        json(&moved)
    })
    .await
}

async fn exact(State(studio): Shared, Path(id): Path<u64>) -> Response {
    of_shape(studio, id, |session| {
        let points = Arc::clone(&session.prepared()?.points);
        Ok(bytes(points_bytes(&points, session.center)))
    })
    .await
}

async fn weights(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    of_shape(studio, id, move |session| {
        let region: Region = parsed(&body, "region")?;
        let mut prepared = session.prepared()?;
        let weights = prepared.weights(&region, &session.opened.file).map_err(|e| Refused::of(&e))?;
        let weights = weights.to_vertices(prepared.decomposer.geometry().vertex_map());
        Ok(bytes(rows(weights.len(), 1, |x, byte| byte[0] = (255.0 * weights[x]).round() as u8)))
    })
    .await
}

async fn field(State(studio): Shared, Path(id): Path<u64>, Query(asked): Asked) -> Response {
    of_shape(studio, id, move |session| {
        let name = asked.get("name").ok_or_else(|| Refused::wrong("give the name of a field: ?name=…"))?;
        match asked.get("of").map(String::as_str) {
            Some("region") => fields::as_region(session, name),
            _ => fields::values(session, name),
        }
    })
    .await
}

async fn features(State(studio): Shared, Path(id): Path<u64>, Query(asked): Asked) -> Response {
    of_shape(studio, id, move |session| {
        let default = adwave::features::FeatureParams::default().theta;
        let theta = asked.get("theta").map_or(Ok(default), |theta| theta.parse());
        let theta = theta.map_err(|_| Refused::wrong("theta is no number"))?;
        fields::feature_list(session, theta)
    })
    .await
}

async fn recipe(State(studio): Shared, Path(id): Path<u64>) -> Response {
    of_shape(studio, id, |session| {
        let prepared = session.prepared()?;
        let recipe = prepared.document.recipe(&prepared.levels, prepared.decomposer.operator_kind());
        Ok(bytes(recipe_to_text(&recipe)))
    })
    .await
}

async fn open_recipe(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    of_shape(studio, id, move |session| {
        let text = std::str::from_utf8(&body).map_err(|_| Refused::wrong("the recipe is no text"))?;
        let recipe = parse_recipe(text).map_err(|e| Refused::of(&e))?;
        let walk = session.walk()?;
        let levels = recipe.levels.clone();
        let mut fresh = Prepared::new(&session.opened.shape, walk, levels, session.progress())?;
        if recipe.operator.is_some_and(|kind| kind != fresh.decomposer.operator_kind()) {
            let told = "the studio takes the surface operator for levels by width and the walk for others; apply this recipe with the command or the Python package";
            return Err(Refused::wrong(told));
        }
        let mut prepared = session.prepared()?;
        let revision = prepared.document.revision + 1;
        let document = Document::of_recipe(&recipe, fresh.n_levels(), revision)?;
        fresh.edit(document, &session.opened.file)?;
        *prepared = fresh;
        session.keep(&prepared)?;
        json(&json!({"levels": prepared.level_list(), "edit": prepared.document}))
    })
    .await
}

async fn save_as(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    of_shape(studio, id, move |session| {
        let asked: SaveAsked =
            if body.is_empty() { SaveAsked::default() } else { parsed(&body, "name to save under")? };
        save::save(session, &asked)
    })
    .await
}

async fn download(State(studio): Shared, Path(id): Path<u64>, Query(asked): Asked) -> Response {
    of_shape(studio, id, move |session| {
        save::download(session, asked.get("format").map_or("ply", String::as_str))
    })
    .await
}

async fn page(State(studio): Shared, Path(id): Path<u64>) -> Response {
    of_shape(studio, id, |session| page::page(session)).await
}

async fn make_report(State(studio): Shared, Path(id): Path<u64>) -> Response {
    beside(
        studio,
        id,
        |session| session.edited_file(&*session.prepared()?),
        |studio, session, file| report::report(studio, session, &file),
    )
    .await
}

async fn show_report(State(studio): Shared, Path(word): Path<String>) -> Response {
    studio.reports.page(&word)
}

async fn compared(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    let taken = move |session: &Session| {
        let asked: CompareAsked = parsed(&body, "choice of a method")?;
        let prepared = session.prepared()?;
        Ok((asked.method, Arc::clone(&prepared.points), prepared.decomposer.clone()))
    };
    beside(studio, id, taken, |_, session, (method, edited, decomposer)| {
        compare::compare(session, method, &edited, &decomposer)
    })
    .await
}

/// How thoroughly.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DenoiseAsked {
    #[serde(default = "one")]
    strength: f64,
}

fn one() -> f64 {
    1.0
}

async fn denoised(State(studio): Shared, Path(id): Path<u64>, body: Bytes) -> Response {
    let taken = |session: &Session| session.edited_file(&*session.prepared()?);
    beside(studio, id, taken, move |studio, session, file| {
        let asked: DenoiseAsked = parsed(&body, "choice of a strength")?;
        let shape = file.to_shape_as(file.kind()).map_err(|e| Refused::wrong(e.to_string()))?;
        let geometry = PreparedGeometry::new(&shape, OperatorParams::default().weld, session.progress())
            .map_err(|e| Refused::of(&e))?;
        let params = DenoiseParams::default().with_strength(asked.strength);
        let clean = denoise(&geometry, &params, session.progress()).map_err(|e| Refused::of(&e))?;
        let mut file = file;
        file.set_points(clean.points).map_err(|e| Refused::wrong(e.to_string()))?;
        let shape = file.to_shape_as(file.kind()).map_err(|e| Refused::wrong(e.to_string()))?;
        let (stem, ending) = session.opened.name.rsplit_once('.').unwrap_or((&session.opened.name, "ply"));
        let name = format!("{stem}-denoised.{ending}");
        // Beside the same file, but with edits of its own.
        let session = studio.open(Opened { name, path: None, file, shape })?;
        json(&json!({"id": session.id, "name": session.opened.name, "noise": clean.info.noise}))
    })
    .await
}

async fn done(State(studio): Shared) -> Response {
    studio.finish();
    json(&json!({})).into_response()
}
