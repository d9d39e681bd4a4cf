//! Results of a run without what differs from run to run: times, memory, names of files, and the command itself.

use crate::harness::Run;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Keys of reports whose values depend on the machine or on the names of files.
const VOLATILE: [&str; 12] = [
    "seconds",
    "milliseconds",
    "peak_memory_bytes",
    "output",
    "index",
    "files",
    "folder",
    "path",
    "bytes",
    "command",
    "read",
    "draw",
];

/// Result of a run: the report, and the bytes of each file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Signature {
    pub(crate) code: Option<i32>,
    pub(crate) report: String,
    pub(crate) files: BTreeMap<String, Vec<u8>>,
}

impl Signature {
    /// The result of a run, and of the files that it wrote into a folder, below which `written` lies.
    pub(crate) fn new(run: &Run, written: &Path) -> Self {
        let report = match serde_json::from_str::<Value>(&run.out) {
            Ok(json) => stable(&json).to_string(),
            Err(_) => stable_text(&run.out),
        };
        let mut files = BTreeMap::new();
        collect(written, written, &mut files);
        Self { code: run.code, report, files }
    }
}

/// A report without volatile keys.
fn stable(json: &Value) -> Value {
    match json {
        Value::Object(entries) => entries
            .iter()
            .filter(|(key, _)| !VOLATILE.contains(&key.as_str()))
            .map(|(key, value)| (key.clone(), stable(value)))
            .collect(),
        Value::Array(values) => values.iter().map(stable).collect(),
        other => other.clone(),
    }
}

/// Lines of text without those that state times.
fn stable_text(text: &str) -> String {
    text.lines().filter(|line| !line.contains(" s,") && !line.contains(" ms")).collect::<Vec<_>>().join("\n")
}

fn collect(base: &Path, folder: &Path, files: &mut BTreeMap<String, Vec<u8>>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            collect(base, &path, files);
        } else {
            let name = path.strip_prefix(base).unwrap().to_string_lossy().into_owned();
            let bytes = std::fs::read(&path).unwrap_or_default();
            files.insert(name, stable_bytes(&path, bytes));
        }
    }
}

/// Bytes of a file without provenance, which names the command.
pub(crate) fn stable_bytes(path: &Path, bytes: Vec<u8>) -> Vec<u8> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "las" if bytes.len() > 227 => {
            let offset = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
            bytes[offset.min(bytes.len())..].to_vec()
        }
        "ply" => {
            let end = find(&bytes, b"end_header\n").unwrap_or(0);
            let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
            let head: Vec<&str> = head.lines().filter(|line| !line.starts_with("comment")).collect();
            [head.join("\n").as_bytes(), &bytes[end..]].concat()
        }
        // Pictures are the part of a page that depends on options alone.
        "html" => {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let pictures = text.split("src=\"data:").skip(1).filter_map(|rest| rest.split('"').next());
            pictures.collect::<Vec<_>>().join("\n").into_bytes()
        }
        "json" => match serde_json::from_slice::<Value>(&bytes) {
            Ok(json) => stable(&json).to_string().into_bytes(),
            Err(_) => bytes,
        },
        _ => bytes,
    }
}

fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).position(|window| window == pattern)
}
