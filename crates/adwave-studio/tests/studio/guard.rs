//! Access control: each rule is tested with a request that breaks it.

use crate::client::Studio;
use adwave_io::{ShapeFile, write_path};
use tempfile::TempDir;

fn studio(folder: &TempDir) -> Studio {
    let path = folder.path().join("points.ply");
    let points = (0..30).map(|k| [f64::from(k % 5), f64::from(k / 5), 0.0]).collect();
    write_path(&ShapeFile::from_cloud(points), &path, None).unwrap();
    Studio::on(&path, folder.path())
}

#[test]
fn only_who_has_the_token_is_given_anything() {
    let folder = TempDir::new().unwrap();
    let studio = studio(&folder);
    let other = "x".repeat(studio.token.len());
    let right = format!("Bearer {}", studio.token);
    for wrong in
        [None, Some(""), Some("Bearer "), Some(&other), Some(&studio.token), Some(&right[..right.len() - 1])]
    {
        let headers: Vec<(&str, &str)> = wrong.iter().map(|token| ("Authorization", *token)).collect();
        for (method, path) in
            [("GET", "/api/shapes"), ("GET", "/api/shapes/1/positions"), ("POST", "/api/done")]
        {
            let refused = studio.bare(method, path, &headers, b"");
            assert_eq!(refused.status, 401, "{wrong:?}");
            assert!(refused.error().contains("no longer valid"), "{}", refused.error());
        }
    }
    // The token is not accepted in the query, because addresses are logged.
    let refused = studio.bare("GET", &format!("/api/shapes?token={}", studio.token), &[], b"");
    assert_eq!(refused.status, 401);
    // The page itself contains no data of the shape.
    assert_eq!(studio.bare("GET", "/", &[], b"").status, 200);
    assert!(studio.token.len() >= 22, "at least 128 bits");
}

#[test]
fn the_link_that_opens_the_browser_leads_to_the_page_once() {
    let folder = TempDir::new().unwrap();
    let studio = studio(&folder);
    let path = &studio.path_for_browser;
    assert!(path.starts_with("/open/") && !path.contains(&studio.token), "{path}");
    let wrong = studio.bare("GET", &format!("{}x", &path[..path.len() - 1]), &[], b"");
    assert_eq!(wrong.status, 401);
    assert_ne!(studio.bare("HEAD", path, &[], b"").status, 303, "a look at the link does not use it up");
    assert_eq!(studio.bare("GET", path, &[("Sec-Fetch-Site", "cross-site")], b"").status, 403);
    let opened = studio.bare("GET", path, &[], b"");
    assert_eq!(opened.status, 303);
    let page = format!("/#{}", studio.token).to_lowercase(); // as the test client has all headers
    assert!(opened.head.contains(&page), "{}", opened.head);
    let again = studio.bare("GET", path, &[], b"");
    assert_eq!(again.status, 401);
    assert!(again.error().contains("works once") && !again.head.contains(&page));
}

#[test]
fn names_that_were_bound_to_this_machine_are_not_answered() {
    let folder = TempDir::new().unwrap();
    let studio = studio(&folder);
    let right = format!("Bearer {}", studio.token);
    let port = studio.host.rsplit_once(':').unwrap().1.to_owned();
    for host in ["evil.example", &format!("evil.example:{port}"), "127.0.0.1:1", "127.0.0.1", ""] {
        let refused = studio.bare("GET", "/api/shapes", &[("Host", host), ("Authorization", &right)], b"");
        assert_eq!(refused.status, 421, "{host}");
    }
    for host in [format!("localhost:{port}"), format!("[::1]:{port}"), format!("127.0.0.1:{port}")] {
        let answer = studio.bare("GET", "/api/shapes", &[("Host", &host), ("Authorization", &right)], b"");
        assert_eq!(answer.status, 200, "{host}");
    }
}

#[test]
fn other_pages_are_refused_even_with_the_token() {
    let folder = TempDir::new().unwrap();
    let studio = studio(&folder);
    let right = format!("Bearer {}", studio.token);
    let own = format!("http://{}", studio.host);
    for (name, value, status) in [
        ("Origin", "http://evil.example", 403),
        ("Origin", "null", 403),
        ("Origin", "http://127.0.0.1:1", 403),
        ("Origin", own.as_str(), 200),
        ("Sec-Fetch-Site", "cross-site", 403),
        ("Sec-Fetch-Site", "same-site", 403),
        ("Sec-Fetch-Site", "same-origin", 200),
        ("Sec-Fetch-Site", "none", 200),
    ] {
        let answer = studio.bare("GET", "/api/shapes", &[(name, value), ("Authorization", &right)], b"");
        assert_eq!(answer.status, status, "{name}: {value}");
        // No response permits another origin to read it.
        assert!(!answer.head.contains("access-control-allow"), "{}", answer.head);
    }
    let preflight = [("Origin", "http://evil.example"), ("Access-Control-Request-Method", "PUT")];
    assert_eq!(studio.bare("OPTIONS", "/api/shapes/1/edit", &preflight, b"").status, 403);
}

#[test]
fn every_answer_says_what_a_page_may_do() {
    let folder = TempDir::new().unwrap();
    let studio = studio(&folder);
    for path in ["/", "/main.js", "/nothing", "/api/shapes", "/api/nothing"] {
        let head = studio.bare("GET", path, &[], b"").head;
        for rule in [
            "content-security-policy: default-src 'none'; script-src 'self'",
            "frame-ancestors 'none'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cross-origin-opener-policy: same-origin",
            "cross-origin-embedder-policy: require-corp",
            "cross-origin-resource-policy: same-origin",
        ] {
            assert!(head.contains(rule), "{path}: {rule} is not in {head}");
        }
    }
}

#[test]
fn large_bodies_and_other_files_are_refused() {
    let folder = TempDir::new().unwrap();
    let studio = studio(&folder);
    let large = vec![b' '; (64 << 20) + 1];
    assert_eq!(studio.ask("PUT", "/api/shapes/1/edit", &large).status, 413);
    for path in ["/../Cargo.toml", "/%2e%2e/Cargo.toml", "/etc/passwd", "//etc/passwd", "/main.js/.."] {
        assert_eq!(studio.bare("GET", path, &[], b"").status, 404, "{path}");
    }
}
