//! The edited shape as a file, beside the one that was opened or as bytes.

use crate::answer::{Answer, Refused, bytes, json};
use crate::session::Session;
use adwave::Progress;
use adwave_io::{Format, write_bytes_with, write_path};
use axum::http::StatusCode;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

/// Where to.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SaveAsked {
    name: Option<String>,
    /// Whether a file that is there already is replaced.
    #[serde(default)]
    replace: bool,
}

/// Writes the shape after the edit that is kept, with all that its file had.
pub(crate) fn save(session: &Session, asked: &SaveAsked) -> Answer {
    let path = place(session, asked)?;
    let prepared = session.prepared()?;
    let file = session.edited_file(&prepared)?;
    drop(prepared);
    let report = write_path(&file, &path, None).map_err(|e| Refused::of(&e))?;
    session.written.lock().unwrap_or_else(PoisonError::into_inner).insert(path.clone());
    json(&serde_json::json!({"path": path.display().to_string(), "notes": notes(&report.not_written)}))
}

fn notes(not_written: &[String]) -> Vec<String> {
    not_written.iter().map(|what| format!("{what} is not in the file: its format cannot hold it")).collect()
}

/// The path of a name beside the file that was opened.
fn place(session: &Session, asked: &SaveAsked) -> Result<PathBuf, Refused> {
    let opened = session.opened.path.as_deref();
    let name = match &asked.name {
        Some(name) => name.clone(),
        None => default_name(session),
    };
    let path = Path::new(&name);
    let is_plain = path.file_name().is_some_and(|only| only == path.as_os_str());
    if !is_plain || name.starts_with('.') || name.contains(['/', '\\', ':', '\0']) {
        let told = "give a name without folders; the file is written beside the one that was opened";
        return Err(Refused::wrong(format!("'{name}': {told}")));
    }
    if Format::from_path(path).is_none() {
        return Err(Refused::wrong(format!(
            "'{name}' has no ending of a known format, such as .ply or .obj"
        )));
    }
    let path = session.folder.join(path);
    if opened.is_some_and(|own| same(own, &path)) {
        return Err(Refused::wrong(format!("'{name}' is the file that was opened; take another name")));
    }
    let is_ours = session.written.lock().unwrap_or_else(PoisonError::into_inner).contains(&path);
    if path.exists() && !is_ours && !asked.replace {
        let told = "is there already; take another name, or say that it is to be replaced";
        return Err(Refused::new(StatusCode::CONFLICT, format!("{} {told}", path.display()))
            .with(serde_json::json!({"exists": true})));
    }
    Ok(path)
}

fn same(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// `NAME-edited.EXT`; PLY where the format is not written.
fn default_name(session: &Session) -> String {
    let name = Path::new(&session.opened.name);
    let stem = name.file_stem().and_then(|s| s.to_str()).unwrap_or("shape").replace([':', '.'], "-");
    let own = name.extension().and_then(|e| e.to_str()).filter(|_| Format::from_path(name).is_some());
    format!("{stem}-edited.{}", own.unwrap_or("ply"))
}

/// The same as bytes.
pub(crate) fn download(session: &Session, format: &str) -> Answer {
    let format = Format::from_name(format)
        .ok_or_else(|| Refused::wrong(format!("'{format}' is no format that is written")))?;
    let prepared = session.prepared()?;
    let file = session.edited_file(&prepared)?;
    drop(prepared);
    let mut content = Vec::new();
    write_bytes_with(&file, format, &mut content, Progress::none()).map_err(|e| Refused::of(&e))?;
    Ok(bytes(content))
}
