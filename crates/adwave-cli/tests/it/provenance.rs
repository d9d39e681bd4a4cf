//! Results say where they came from, and nothing of the machine.

use crate::common;

use common::{adwave, json, words};
use std::path::Path;

fn run(folder: &Path, line: &str) {
    adwave(folder).args(words(line)).assert().success();
}

#[test]
fn results_name_command_and_inputs_and_can_be_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    run(at, "sample sphere --vertices 300 -o a.ply");
    std::fs::create_dir(at.join("deep")).unwrap();
    std::fs::rename(at.join("a.ply"), at.join("deep/a.ply")).unwrap();
    for name in ["b.glb", "b.gltf", "b.vtp", "b.vtu", "b.las", "b.laz", "b.ply", "b.obj"] {
        let line = format!("filter deep/a.ply -o {name} --gains 0,1 --provenance");
        run(at, &line);
        let info = json(at, &format!("info {name}"));
        let made = &info["provenance"];
        assert_eq!(made["program"], concat!("adwave ", env!("CARGO_PKG_VERSION")));
        assert_eq!(made["command"], format!("adwave filter a.ply -o {name} --gains 0,1 --provenance"));
        let input = &made["inputs"][0];
        assert_eq!(input["name"], "a.ply");
        assert_eq!(input["sha256"].as_str().unwrap().len(), 64);
        let bytes = std::fs::read(at.join(name)).unwrap();
        let own = at.to_str().unwrap().as_bytes();
        assert!(!bytes.windows(own.len()).any(|part| part == own), "{name} names a folder");
        // The printed command makes the same file again where its input lies.
        std::fs::copy(at.join("deep/a.ply"), at.join("a.ply")).unwrap();
        run(at, made["command"].as_str().unwrap().strip_prefix("adwave ").unwrap());
        assert_eq!(std::fs::read(at.join(name)).unwrap(), bytes, "{name}");
        // The next result has its own.
        run(at, &format!("denoise {name} -o c.{} --provenance", &name[2..]));
        let next = json(at, &format!("info c.{}", &name[2..]));
        let command = next["provenance"]["command"].as_str().unwrap();
        assert!(command.starts_with(&format!("adwave denoise {name} ")), "{command}");
    }
    let text = adwave(at).args(["info", "b.vtp"]).assert().success().get_output().stdout.clone();
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("made by       adwave"), "{text}");
    assert!(text.contains("made from     a.ply, SHA-256 "), "{text}");
}

#[test]
fn what_is_not_asked_for_or_did_not_change_keeps_its_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    run(at, "sample torus --vertices 200 -o a.obj");
    run(at, "filter a.obj -o b.obj --gains 1,1");
    assert!(!std::fs::read_to_string(at.join("b.obj")).unwrap().contains("adwave filter"));
    // What a comment says is said anew, or it would be about another shape.
    run(at, "filter a.obj -o c.obj --gains 2,1 --provenance");
    run(at, "denoise c.obj -o d.obj");
    let command = json(at, "info d.obj")["provenance"]["command"].as_str().unwrap().to_owned();
    assert_eq!(command, "adwave denoise c.obj -o d.obj");
    run(at, "convert a.obj -o a.glb");
    run(at, "convert a.glb -o c.glb");
    assert_eq!(std::fs::read(at.join("a.glb")).unwrap(), std::fs::read(at.join("c.glb")).unwrap());
}

#[test]
fn bands_and_the_standard_input_are_named_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    run(at, "sample sphere --vertices 100 -o a.ply");
    let rows = "1\n".repeat(100);
    std::fs::write(at.join("c.csv"), format!("height\n{rows}")).unwrap();
    run(at, "transform sample:sphere --vertices 100 -o b.npz");
    let bytes = std::fs::read(at.join("b.npz")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("\"command\":\"adwave transform sample:sphere --vertices 100 -o b.npz\""));
    assert!(text.contains("{\"name\":\"sample:sphere\",\"sha256\":null}"));
    run(at, "transform a.ply --field c.csv -o d.npz");
    let text = String::from_utf8_lossy(&std::fs::read(at.join("d.npz")).unwrap()).into_owned();
    assert!(
        text.contains("{\"name\":\"a.ply\",\"sha256\":\"")
            && text.contains("{\"name\":\"c.csv\",\"sha256\":\"")
    );
    let piped = std::fs::read(at.join("a.ply")).unwrap();
    adwave(at).args(["convert", "-", "-o", "c.vtp"]).write_stdin(piped).assert().success();
    let inputs = &json(at, "info c.vtp")["provenance"]["inputs"];
    assert_eq!(inputs[0]["name"], "-");
    assert_eq!(inputs[0]["sha256"].as_str().unwrap().len(), 64);
}
