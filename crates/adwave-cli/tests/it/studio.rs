//! `adwave studio` as a shell has it: what it prints, what it refuses, how it ends.

use crate::common;

use adwave_io::{Field, FieldValues, GRID_VALUES, GridLayout, ShapeFile, write_path};
use common::{adwave, refused};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

#[test]
fn what_cannot_be_opened_is_refused_in_one_line() {
    let folder = TempDir::new().unwrap();
    let refused = |line: &str| refused(folder.path(), line);
    assert!(refused("studio no-such-file.obj").contains("no-such-file.obj"));
    assert!(refused("studio sample:creature --host 0.0.0.0").contains("--i-know"));
    std::fs::write(folder.path().join("empty.obj"), "").unwrap();
    assert!(refused("studio empty.obj --no-open").contains("empty.obj"));
}

#[test]
fn the_help_has_examples() {
    let help = adwave(&std::env::temp_dir()).args(["studio", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    assert!(help.contains("adwave studio bunny.obj") && help.contains("ssh -L"), "{help}");
}

#[test]
#[cfg(unix)]
fn it_prints_its_address_and_ctrl_c_ends_it() {
    let folder = TempDir::new().unwrap();
    let mut studio = Command::new(env!("CARGO_BIN_EXE_adwave"))
        .args(["studio", "sample:creature", "--vertices", "3000", "--no-open"])
        .env("XDG_STATE_HOME", folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut printed = BufReader::new(studio.stdout.take().unwrap());
    printed.read_line(&mut line).unwrap();
    assert!(line.starts_with("http://127.0.0.1:") && line.contains("/#"), "{line}");
    let stopped = Instant::now();
    let pid = studio.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    assert_eq!(studio.wait().unwrap().code(), Some(0));
    assert!(stopped.elapsed() < Duration::from_secs(5), "{:?}", stopped.elapsed());
    assert_eq!(std::io::read_to_string(printed).unwrap(), "press Ctrl-C to end\n");
    let told = std::io::read_to_string(studio.stderr.take().unwrap()).unwrap();
    assert_eq!(told, "");
}

/// A studio of the command, and requests to it.
struct ServedStudio {
    process: Child,
    host: String,
    token: String,
}

impl ServedStudio {
    fn on(folder: &Path, words: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_adwave"))
            .arg("studio")
            .args(words)
            .args(["--no-open", "--quiet"])
            .current_dir(folder)
            .env("XDG_STATE_HOME", folder.join("state"))
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").and_then(|rest| rest.split_once("/#"));
        let (host, token) =
            address.map(|(host, token)| (host.to_owned(), token.to_owned())).expect("an address");
        Self { process, host, token }
    }

    /// Body of the response to a request.
    fn ask(&self, method: &str, path: &str, body: &str) -> String {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let (host, token, length) = (&self.host, &self.token, body.len());
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: {length}\r\n\
             Authorization: Bearer {token}\r\n\r\n"
        );
        stream.write_all((head + body).as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with("HTTP/1.1 200"), "{method} {path}: {answer}");
        body.to_owned()
    }
}

impl Drop for ServedStudio {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn a_saved_image_or_volume_has_the_bytes_of_the_command() {
    let folder = TempDir::new().unwrap();
    let run = |line: &str| {
        adwave(folder.path()).args(line.split(' ')).assert().success();
    };
    run("sample hills --vertices 3000 -o hills.tif");
    run("sample head --vertices 6000 -o head.nii.gz");
    run("sample bold --vertices 1500 -o bold.nii.gz");
    let only = "--only=values=5..";
    let opened = [("hills.tif", ""), ("head.nii.gz", ""), ("head.nii.gz", only), ("bold.nii.gz", "")];
    for (name, selection) in opened {
        let mut words = vec![name];
        words.extend((!selection.is_empty()).then_some(selection));
        let studio = ServedStudio::on(folder.path(), &words);
        let info: Value = serde_json::from_str(&studio.ask("GET", "/api/shapes/1", "")).unwrap();
        let n_levels = info["levels"].as_array().unwrap().len();
        let gains: Vec<f64> = (0..n_levels).map(|j| [0.25, 1.5, 1.0][j % 3]).collect();
        let layer = json!({"name": "", "on": true, "opacity": 1.0, "gains": gains, "region": null});
        let edit = json!({"revision": 9, "layers": [layer]});
        studio.ask("PUT", "/api/shapes/1/edit", &edit.to_string());
        let saved = format!("saved-{name}");
        studio.ask("POST", "/api/shapes/1/save", &json!({"name": saved, "replace": true}).to_string());
        std::fs::write(folder.path().join("edit.toml"), studio.ask("GET", "/api/shapes/1/recipe", ""))
            .unwrap();
        run(format!("filter {name} {selection} --recipe edit.toml -o command-{name}")
            .replace("  ", " ")
            .as_str());
        let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
        assert!(read(&saved) == read(&format!("command-{name}")), "{name} {selection}");
        assert!(read(&saved) != read(name), "{name} {selection}");
    }
}

#[test]
fn a_series_whose_gaps_differ_is_refused_in_one_line_with_what_to_do() {
    let folder = TempDir::new().unwrap();
    let mut series = ShapeFile::from_grid(GridLayout::new(&[3, 4, 5], &[1.0; 3])).unwrap();
    let value = |k: usize| if k == 9 { f32::NAN } else { (k % 7) as f32 };
    let values = FieldValues::F32((0..240).map(value).collect());
    series.add_vertex_field(Field::new(GRID_VALUES, 4, values)).unwrap();
    write_path(&series, &folder.path().join("bold.nii.gz"), None).unwrap();
    let text = refused(folder.path(), "studio bold.nii.gz --no-open");
    assert!(text.contains("series whose frames") && text.contains("adwave filter"), "{text}");
}
