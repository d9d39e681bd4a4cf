//! Test client: a studio in this process, and HTTP requests as a browser sends them.

use adwave::Progress;
use adwave_io::{ReadLimits, read_path};
use adwave_studio::{StudioError, StudioInput, StudioOutcome, StudioParams, serve};
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread::JoinHandle;
use std::time::Duration;

pub(crate) struct Studio {
    pub(crate) host: String,
    pub(crate) token: String,
    /// Path of the link that opens the browser.
    pub(crate) path_for_browser: String,
    stop: &'static AtomicBool,
    thread: Option<JoinHandle<Result<StudioOutcome, StudioError>>>,
}

pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.text()))
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// One-line message of an error response.
    pub(crate) fn error(&self) -> String {
        let error = self.json()["error"].as_str().unwrap_or_default().to_owned();
        assert!(!error.is_empty() && !error.contains('\n'), "{}", self.text());
        error
    }

    pub(crate) fn floats(&self) -> Vec<f32> {
        self.body.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()
    }
}

/// Opens a file like the command does.
pub(crate) fn opened(path: &Path) -> StudioInput {
    let file = read_path(path, &ReadLimits::default()).unwrap();
    let shape = file.to_shape().unwrap();
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    StudioInput { name, path: Some(path.to_path_buf()), file, shape }
}

impl Studio {
    /// Starts a studio on a file, with edits stored in `autosave_folder`.
    pub(crate) fn on(path: &Path, autosave_folder: &Path) -> Self {
        Self::of(opened(path), autosave_folder)
    }

    pub(crate) fn of(opened: StudioInput, autosave_folder: &Path) -> Self {
        // Leaked, because the server must not outlive its flag.
        let stop: &'static AtomicBool = Box::leak(Box::new(AtomicBool::new(false)));
        let (send, receive) = mpsc::channel();
        let params = StudioParams::default().with_autosave_folder(Some(autosave_folder.to_path_buf()));
        let thread = std::thread::spawn(move || {
            serve(opened, &params, Progress::none().with_cancel(stop), |served| {
                send.send(served.clone()).unwrap();
            })
        });
        let address = receive.recv_timeout(Duration::from_secs(60)).expect("the studio is served");
        let (host, token) =
            address.url.strip_prefix("http://").and_then(|rest| rest.split_once("/#")).expect("an address");
        let path = address.url_for_browser.strip_prefix(&format!("http://{host}")).expect("the same host");
        let (host, token, path_for_browser) = (host.to_owned(), token.to_owned(), path.to_owned());
        Self { host, token, path_for_browser, stop, thread: Some(thread) }
    }

    /// Sends a request with only these headers and those that HTTP requires.
    pub(crate) fn bare(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        let mut head =
            format!("{method} {path} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n", body.len());
        if !headers.iter().any(|(name, _)| *name == "Host") {
            head += &format!("Host: {}\r\n", self.host);
        }
        for (name, value) in headers {
            head += &format!("{name}: {value}\r\n");
        }
        stream.write_all((head + "\r\n").as_bytes()).unwrap();
        // An error response may arrive before the whole request was read.
        let _ = stream.write_all(body);
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        let end = all.windows(4).position(|w| w == b"\r\n\r\n").expect("an answer") + 4;
        let head = String::from_utf8_lossy(&all[..end]).to_lowercase();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        let body = all.split_off(end);
        let body = if head.contains("transfer-encoding: chunked") { joined(&body) } else { body };
        Answer { status, head, body }
    }

    pub(crate) fn ask(&self, method: &str, path: &str, body: &[u8]) -> Answer {
        self.bare(method, path, &[("Authorization", &format!("Bearer {}", self.token))], body)
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        let answer = self.ask("GET", path, b"");
        assert_eq!(answer.status, 200, "{path}: {}", answer.text());
        answer
    }

    pub(crate) fn put(&self, path: &str, content: &Value) -> Answer {
        self.ask("PUT", path, content.to_string().as_bytes())
    }

    pub(crate) fn post(&self, path: &str, content: &Value) -> Answer {
        self.ask("POST", path, content.to_string().as_bytes())
    }

    /// Stops the studio like Ctrl-C does.
    pub(crate) fn end(mut self) -> StudioOutcome {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap().unwrap()
    }

    /// Waits until the studio ends.
    pub(crate) fn finished(mut self) -> StudioOutcome {
        self.thread.take().unwrap().join().unwrap().unwrap()
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Joins a chunked body.
fn joined(mut body: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    while let Some(at) = body.windows(2).position(|w| w == b"\r\n") {
        let n = usize::from_str_radix(std::str::from_utf8(&body[..at]).unwrap().trim(), 16).unwrap();
        all.extend_from_slice(&body[at + 2..][..n]);
        body = &body[at + 2 + n + 2..];
        if n == 0 {
            break;
        }
    }
    all
}
