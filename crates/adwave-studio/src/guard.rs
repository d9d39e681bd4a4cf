//! Access control: only the page of this server, opened through its link, may send requests.
//!
//! The server listens on the loopback interface, which any local program and any web page in a local browser can reach.
//! Three rules protect it. The `Host` header must be one of its own names, so that a DNS name rebound to the loopback
//! is rejected. A request sent by a page must come from this page. All requests below `/api` need a token that only the
//! printed link contains. There are no cookies, which other ports would share, and no permissions for other origins.
//!
//! The browser is opened by another link, which leads to the printed one: all users of the machine can read the arguments
//! of a program. It works once, so that whoever reads it there comes too late, or is noticed.

use crate::response::ApiError;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Token and host names against which requests are checked.
#[derive(Debug)]
pub(crate) struct Guard {
    token: String,
    /// Last part of the link that opens the browser, until it is used.
    ticket: Mutex<Option<String>>,
    /// Accepted `Host` headers, `NAME:PORT`.
    hosts: Vec<String>,
}

/// Headers of every response.
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

/// Beginning of the path that leads to the page once.
const TICKETS: &str = "/open/";

/// Number of random bytes of a token: 192 bits.
const N_TOKEN_BYTES: usize = 24;

/// Generates an unguessable token of 192 random bits, in URL-safe Base64.
pub(crate) fn generate_token() -> std::io::Result<String> {
    let mut random = [0; N_TOKEN_BYTES];
    getrandom::fill(&mut random).map_err(|e| std::io::Error::other(e.to_string()))?;
    Ok(URL_SAFE_NO_PAD.encode(random))
}

impl Guard {
    /// Creates the guard of a server on `port`, with a new token; `host` is an additional name of the server.
    pub(crate) fn new(port: u16, host: Option<&str>) -> std::io::Result<Self> {
        let (token, ticket) = (generate_token()?, Mutex::new(Some(generate_token()?)));
        let names = ["127.0.0.1", "localhost", "[::1]"].into_iter().chain(host);
        Ok(Self { token, ticket, hosts: names.map(|name| format!("{name}:{port}")).collect() })
    }

    /// Path of the page with the access token.
    pub(crate) fn page(&self) -> String {
        format!("/#{}", self.token)
    }

    /// Path that leads to the [`page`](Self::page) once; the page itself if it has been used.
    pub(crate) fn path_for_browser(&self) -> String {
        self.ticket().as_ref().map_or_else(|| self.page(), |ticket| format!("{TICKETS}{ticket}"))
    }

    fn ticket(&self) -> MutexGuard<'_, Option<String>> {
        self.ticket.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Response to a request for the page by a ticket; `None` if it is for something else.
    fn redeem(&self, request: &Request) -> Option<Response> {
        let given = request.uri().path().strip_prefix(TICKETS).filter(|_| request.method() == Method::GET)?;
        let mut ticket = self.ticket();
        if !ticket.as_deref().is_some_and(|ticket| is_same(given, ticket)) {
            let message = "This link works once, and was opened before. If that was not you, end the studio; else open \
                           the link printed in the terminal.";
            return Some(ApiError::new(StatusCode::UNAUTHORIZED, message).into_response());
        }
        *ticket = None;
        Some((StatusCode::SEE_OTHER, [(header::LOCATION, self.page())]).into_response())
    }

    /// Returns the error of a request that breaks a rule.
    fn check(&self, request: &Request) -> Option<ApiError> {
        let headers = request.headers();
        let text = |name: &HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let host = text(&header::HOST).unwrap_or("");
        if !self.hosts.iter().any(|known| known == host) {
            let message =
                format!("'{host}' is not a name of this server; open the link printed in the terminal");
            return Some(ApiError::new(StatusCode::MISDIRECTED_REQUEST, message));
        }
        let foreign = |reason: &str| {
            let message = format!("{reason}; open the link printed in the terminal in a new tab");
            Some(ApiError::new(StatusCode::FORBIDDEN, message))
        };
        if let Some(origin) = text(&header::ORIGIN) {
            let is_own = origin.strip_prefix("http://").is_some_and(|origin| origin == host);
            if !is_own {
                return foreign(&format!("the request comes from '{origin}'"));
            }
        }
        let site = text(&HeaderName::from_static("sec-fetch-site")).unwrap_or("none");
        if !matches!(site, "none" | "same-origin") {
            return foreign("the request comes from another page");
        }
        let needs_token = request.uri().path().starts_with("/api");
        (needs_token && !self.has_token(headers)).then(|| {
            let message = "This link is no longer valid. Open the latest link printed in the terminal.";
            ApiError::new(StatusCode::UNAUTHORIZED, message)
        })
    }

    /// True if the request has the token; the comparison takes constant time.
    fn has_token(&self, headers: &HeaderMap) -> bool {
        let header = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
        let Some(token) = header.and_then(|value| value.strip_prefix("Bearer ")) else { return false };
        is_same(token, &self.token)
    }
}

/// True if the texts are equal; the comparison takes a time that depends on their lengths alone.
fn is_same(given: &str, secret: &str) -> bool {
    let differs = given.bytes().zip(secret.bytes()).fold(0, |bits, (a, b)| bits | (a ^ b));
    given.len() == secret.len() && differs == 0
}

/// Middleware: rejects requests that break a rule, and adds the security headers to every response.
pub(crate) async fn check_request(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match guard.check(&request) {
        Some(error) => error.into_response(),
        None => match guard.redeem(&request) {
            Some(response) => response,
            None => next.run(request).await,
        },
    };
    for &(name, value) in HEADERS {
        // A report brings its own policy.
        response
            .headers_mut()
            .entry(HeaderName::from_static(name))
            .or_insert(HeaderValue::from_static(value));
    }
    response
}
