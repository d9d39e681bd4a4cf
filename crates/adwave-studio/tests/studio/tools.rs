//! Concurrent requests, the exported page, comparison with other methods, and the report.

use crate::client::Studio;
use crate::server::{creature, edit, layer};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use serde_json::{Value, json};
use std::io::Read;
use tempfile::TempDir;

#[test]
fn many_requests_at_once_are_all_answered() {
    // A pool thread that waits steals work of another request; waiting for a lock there would deadlock.
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 4000), folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let half = json!({"half-space": {"point": [0, 0, 0], "normal": [1, 0, 0], "falloff": 0}});
    let region = json!({"blurred": {"by": "3%", "region": half}});
    std::thread::scope(|scope| {
        for k in 0..12_u64 {
            let (studio, region) = (&studio, &region);
            scope.spawn(move || {
                let answer = match k % 4 {
                    0 => studio.post("/api/shapes/1/weights", region),
                    1 => studio.put("/api/shapes/1/edit", &edit(k, &[layer(&vec![0.5; n_levels], region)])),
                    2 => studio.get("/api/shapes/1/field?name=saliency"),
                    _ => studio.get("/api/shapes/1/bands"),
                };
                assert!([200, 409].contains(&answer.status), "{k}: {}", answer.text());
            });
        }
    });
}

#[test]
fn the_page_in_one_file_has_all_within_itself() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 2000), folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let ball = json!({"ball": {"center": {"vertex": 3}, "radius": "20%"}});
    studio.put("/api/shapes/1/edit", &edit(1, &[layer(&vec![0.5; n_levels], &ball)]));
    let page = studio.get("/api/shapes/1/page").text();
    assert!(page.starts_with("<!doctype html>") && page.contains("default-src 'none'"));
    assert!(!page.contains("<link") && !page.contains(" src=") && page.matches("</script>").count() == 2);
    let packed = page.split("type=\"text/plain\">").nth(1).unwrap().split("</script>").next().unwrap();
    let packed = STANDARD.decode(packed).unwrap();
    let mut content = Vec::new();
    GzDecoder::new(&packed[..]).read_to_end(&mut content).unwrap();
    let size = u32::from_le_bytes(content[..4].try_into().unwrap()) as usize;
    let head: Value = serde_json::from_slice(&content[4..4 + size]).unwrap();
    assert_eq!(
        head["layers"][0],
        json!({"name": "a layer", "opacity": 1.0, "gains": vec![0.5; n_levels], "mask": 0})
    );
    let positions = studio.get("/api/shapes/1/positions").body;
    let n = positions.len() / 12;
    assert_eq!((&head["n_vertices"], &head["rules"]), (&json!(n), &json!(false)));
    let at = (4 + size).next_multiple_of(4);
    assert_eq!(content[at..at + 12 * n], positions);
    // The mask is last, padded to a multiple of four.
    let mask = content.len() - n.next_multiple_of(4);
    assert_eq!(content[mask..mask + n], studio.post("/api/shapes/1/weights", &ball).body);
}

#[test]
fn other_methods_are_as_smooth_as_the_edit() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 2000), folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let ask = |method: &str| studio.post("/api/shapes/1/compare", &json!({"method": method}));
    assert!(ask("taubin").error().contains("must be smoother than the original"));
    let mut gains = vec![1.0; n_levels];
    gains[..2].fill(0.2);
    studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains, &Value::Null)]));
    for method in ["taubin", "harmonics"] {
        let answer = ask(method);
        let about = answer
            .head
            .lines()
            .find_map(|line| line.to_lowercase().strip_prefix("x-compare: ").map(str::to_owned));
        let about: Value =
            serde_json::from_str(&about.unwrap_or_else(|| panic!("{}", answer.text()))).unwrap();
        let of = |what: &str| about["roughness"][what].as_f64().unwrap();
        assert!((of("other") / of("edit") - 1.0).abs() < 0.02 && of("edit") < of("before"), "{about}");
        assert_eq!(answer.body.len(), studio.get("/api/shapes/1/positions").body.len());
    }
    assert!(ask("lee").error().contains("lee"));
}

#[test]
fn distances_from_another_tab_are_signed_and_summed_up() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let studio = Studio::on(&path, folder.path());
    let moved = std::fs::read(&path).unwrap();
    studio.ask("POST", "/api/shapes?name=other.ply", &moved);
    let ask = |id: u64, from: u64| {
        let answer = studio.post(&format!("/api/shapes/{id}/deviation"), &json!({"from": from}));
        let about =
            answer.head.lines().find_map(|line| line.strip_prefix("x-deviation: ").map(str::to_owned));
        let about: Value =
            serde_json::from_str(&about.unwrap_or_else(|| panic!("{}", answer.text()))).unwrap();
        (answer.floats(), about)
    };
    let (values, about) = ask(1, 2);
    assert!(values.iter().all(|v| v.abs() < 1e-6));
    assert_eq!((&about["signed"], &about["beyond_border"]), (&json!(true), &json!(0)));
    // Without its finest band the other surface lies inside of bumps and outside of hollows of the first.
    let n_levels = studio.get("/api/shapes/2").json()["levels"].as_array().unwrap().len();
    let mut gains = vec![1.0; n_levels];
    gains[..2].fill(0.0);
    studio.put("/api/shapes/2/edit", &edit(1, &[layer(&gains, &Value::Null)]));
    let (values, about) = ask(1, 2);
    let (back, _) = ask(2, 1);
    assert_eq!(values.len(), back.len());
    assert!(values.iter().any(|v| *v > 1e-3) && values.iter().any(|v| *v < -1e-3));
    let greatest = values.iter().fold(0.0_f32, |most, v| most.max(v.abs()));
    assert_eq!(about["greatest"].as_f64().unwrap() as f32, greatest);
    let rms = about["rms"].as_f64().unwrap();
    assert!(rms > 0.0 && rms < f64::from(greatest), "{about}");
    // Where a point of one lies outside, the nearest of the other is mostly inside.
    let opposite = values.iter().zip(&back).filter(|(a, b)| **a * **b <= 0.0).count();
    assert!(opposite > values.len() * 9 / 10, "{opposite}");
    let missing = studio.post("/api/shapes/1/deviation", &json!({"from": 7}));
    assert!(missing.status == 404 && missing.error().contains("shape 7 is not open"));
}

#[test]
fn a_report_is_at_an_address_that_nobody_guesses() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 2000), folder.path());
    let path = studio.post("/api/shapes/1/report", &json!({})).json()["path"].as_str().unwrap().to_owned();
    // Browsers open it without the token.
    let page = |path: &str| studio.bare("GET", path, &[], b"");
    let report = page(&format!("/{path}"));
    assert!(report.status == 200 && report.text().contains("creature.ply"), "{}", report.text());
    let policy = report.head.lines().find(|line| line.starts_with("content-security-policy")).unwrap();
    assert!(policy.contains("style-src 'unsafe-inline'") && !policy.contains("script-src"), "{policy}");
    assert_eq!(page("/report/0000").status, 404);
}
