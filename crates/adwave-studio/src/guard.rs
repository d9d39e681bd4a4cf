//! Who may ask: only the page of this server, opened by who started it.
//!
//! The server listens on the loopback, where any program of this machine and any page in any browser on it can reach it. So: the name that
//! it was asked by is one of its own (a name that was rebound to the loopback is not), a request from a page comes from this page, and all
//! that gives or takes anything needs a token that only the address that was opened has. No cookies, which other ports would share, and
//! no permission for other origins at all.

use crate::answer::Refused;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use std::sync::Arc;

/// What requests are held against.
#[derive(Debug)]
pub(crate) struct Guard {
    token: String,
    /// `NAME:PORT` that this server is.
    hosts: Vec<String>,
}

/// Sent with every answer.
const HEADERS: &[(&str, &str)] = &[
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' blob: data:; \
         worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cache-control", "no-store"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-embedder-policy", "require-corp"),
    ("cross-origin-resource-policy", "same-origin"),
];

/// Random bytes of a token: 192 bits.
const TOKEN_BYTES: usize = 24;

/// A word of 192 random bits, which nobody guesses.
pub(crate) fn random_word() -> std::io::Result<String> {
    let mut random = [0; TOKEN_BYTES];
    getrandom::fill(&mut random).map_err(|e| std::io::Error::other(e.to_string()))?;
    Ok(URL_SAFE_NO_PAD.encode(random))
}

impl Guard {
    /// A fresh token for a server on that port, which is also known by `host` where one is named.
    pub(crate) fn new(port: u16, host: Option<&str>) -> std::io::Result<Self> {
        let token = random_word()?;
        let names = ["127.0.0.1", "localhost", "[::1]"].into_iter().chain(host);
        Ok(Self { token, hosts: names.map(|name| format!("{name}:{port}")).collect() })
    }

    pub(crate) fn token(&self) -> &str {
        &self.token
    }

    fn refusal(&self, request: &Request) -> Option<Refused> {
        let headers = request.headers();
        let text = |name: &HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let host = text(&header::HOST).unwrap_or("");
        if !self.hosts.iter().any(|own| own == host) {
            let told = format!("this server is not '{host}'; open the address that it printed");
            return Some(Refused::new(StatusCode::MISDIRECTED_REQUEST, told));
        }
        let elsewhere = |why: &str| {
            let told = format!("{why}; open the address that the studio printed in a tab of its own");
            Some(Refused::new(StatusCode::FORBIDDEN, told))
        };
        if let Some(origin) = text(&header::ORIGIN) {
            let is_own = origin.strip_prefix("http://").is_some_and(|origin| origin == host);
            if !is_own {
                return elsewhere(&format!("the request comes from '{origin}'"));
            }
        }
        let site = text(&HeaderName::from_static("sec-fetch-site")).unwrap_or("none");
        if !matches!(site, "none" | "same-origin") {
            return elsewhere("the request comes from another page");
        }
        let needs_token = request.uri().path().starts_with("/api");
        (needs_token && !self.has_token(headers)).then(|| {
            let told = "the token is missing or that of an earlier run; open the address that the studio printed, with all that follows the #";
            Refused::new(StatusCode::UNAUTHORIZED, told)
        })
    }

    /// Compared in a time that does not tell how much of it is right.
    fn has_token(&self, headers: &HeaderMap) -> bool {
        let given = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
        let Some(given) = given.and_then(|value| value.strip_prefix("Bearer ")) else { return false };
        let differs = given.bytes().zip(self.token.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
        given.len() == self.token.len() && differs == 0
    }
}

/// Refuses what is not from this page, and says in every answer what the page may do.
pub(crate) async fn guarded(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut answer = match guard.refusal(&request) {
        Some(refused) => refused.into_response(),
        None => next.run(request).await,
    };
    for &(name, value) in HEADERS {
        // A report has a policy of its own.
        answer.headers_mut().entry(HeaderName::from_static(name)).or_insert(HeaderValue::from_static(value));
    }
    answer
}
