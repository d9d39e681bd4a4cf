//! Law of the dependencies: they run one way, `adwave ← {adwave-io, …} ← adwave-cli`. Dependencies of tests and
//! examples may run the other way.

use serde_json::Value;
use std::process::Command;

#[test]
fn crates_depend_only_on_those_below_them() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let layer = |name: &str| match name {
        "adwave" | "adwave-test-data" => Some(0),
        "adwave-graph" | "adwave-io" | "adwave-register" | "adwave-render" | "adwave-simplify"
        | "adwave-subdivision" => Some(1),
        "adwave-baselines" | "adwave-report" => Some(2),
        "adwave-deform" | "adwave-fuzz" | "adwave-reproduce" | "adwave-tiles" => Some(3),
        "adwave-studio" => Some(4),
        "adwave-cli" => Some(5),
        "xtask" | "adwave-bench-helpers" | "adwave-python" => Some(6),
        _ => None,
    };
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() >= 4, "{} packages", packages.len());
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let above = layer(name).unwrap_or_else(|| panic!("say in this test where the crate {name} stands"));
        for dependency in package["dependencies"].as_array().unwrap() {
            let on = dependency["name"].as_str().unwrap();
            if dependency["kind"] == "dev" {
                continue;
            }
            assert_ne!(on, "adwave-test-data", "{name}: only tests may use it");
            if let Some(below) = layer(on) {
                assert!(below < above, "{name} must not depend on {on}");
            }
        }
    }
}

#[test]
fn the_method_knows_no_files_and_no_terminal() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/adwave/src");
    let mut stack = vec![std::path::PathBuf::from(source)];
    let mut n_files = 0;
    while let Some(path) = stack.pop() {
        if path.is_dir() {
            stack.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|e| e == "rs") {
            n_files += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            for banned in ["std::fs", "println!", "eprintln!", "print!(", "std::env", "static mut"] {
                let found =
                    text.lines().find(|line| line.contains(banned) && !line.trim_start().starts_with("//"));
                assert!(found.is_none(), "{}: {banned}", path.display());
            }
        }
    }
    assert!(n_files > 10, "only {n_files} files looked at");
}

/// Modules of `adwave` from the bottom up; modules of one line may not import each other. A module that moves to
/// another layer moves here as well.
const LAYERS: [&[&str]; 20] = [
    &["bessel", "error", "named", "pages"],
    &["progress", "vector"],
    &["parallel"],
    &["rows"],
    &["shape"],
    &["laplacian"],
    &["operator"],
    &["sparse"],
    &["bands"],
    &["mask", "sample", "signal", "basis", "local_fit"],
    &["domain"],
    &["grid"],
    &["region", "time"],
    &["filter"],
    &["decomposer"],
    &["editor", "positions", "denoise", "directions"],
    &["population"],
    &["saliency"],
    &["features"],
    &["measure"],
];

/// Permitted imports from a higher layer: importing module, imported module, reason.
const ALLOWED: [(&str, &str, &str); 0] = [];

/// Module of a type that is re-exported at the root of the crate.
fn home(name: &str) -> &str {
    match name {
        "ClassifiedError" | "ErrorKind" => "error",
        "NamedEntry" | "NamedValue" | "UnknownName" | "named_values" => "named",
        "Cancelled" | "Progress" | "ProgressCounter" => "progress",
        "Decomposer" | "BandsRequest" | "LevelSpec" | "LevelSpecError" | "ResolvedLevels" => "decomposer",
        module => module,
    }
}

/// Lists the modules of the crate that the code of a file imports by `crate::…`, in braces or not. Comments and tests
/// do not count.
fn imports(text: &str) -> Vec<String> {
    let code: Vec<&str> = text
        .lines()
        .take_while(|line| line.trim() != "#[cfg(test)]" || line.starts_with(' '))
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    let code = code.join("\n");
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let after = &code[at + "crate::".len()..];
        let name = |text: &str| -> String {
            text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
        };
        let Some(list) = after.strip_prefix('{') else {
            found.push(name(after));
            continue;
        };
        let (mut depth, mut start) = (1, 0);
        for (k, c) in list.char_indices() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if (c == ',' && depth == 1) || depth == 0 {
                found.push(name(&list[start..k]));
                start = k + 1;
            }
            if depth == 0 {
                break;
            }
        }
    }
    found.retain(|name| !name.is_empty());
    found
}

#[test]
fn imports_are_found_in_any_form() {
    let text = "use crate::shape::{Mesh, Shape};\nuse crate::{Progress, sparse::{a, b}, bands};\n// crate::filter\n\
                fn f() { crate::rows::g() }\n#[cfg(test)]\nuse crate::features::h;";
    assert_eq!(imports(text), ["shape", "Progress", "sparse", "bands", "rows"]);
}

#[test]
fn modules_of_the_method_use_only_those_below_them() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/adwave/src");
    let layer = |module: &str| LAYERS.iter().position(|layer| layer.contains(&module));
    let (mut wrong, mut n_imports, mut n_used) = (Vec::new(), 0, [0; ALLOWED.len()]);
    let mut stack = vec![std::path::PathBuf::from(source)];
    while let Some(path) = stack.pop() {
        if path.is_dir() {
            stack.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
            continue;
        }
        let inside = path.strip_prefix(source).unwrap().to_string_lossy().into_owned();
        let module = inside.split('/').next().unwrap().trim_end_matches(".rs").to_owned();
        if module == "lib" || path.extension().is_none_or(|e| e != "rs") || inside.ends_with("tests.rs") {
            continue;
        }
        let above =
            layer(&module).unwrap_or_else(|| panic!("say in LAYERS where the module {module} stands"));
        for name in imports(&std::fs::read_to_string(&path).unwrap()) {
            let on = home(&name);
            let below = layer(on).unwrap_or_else(|| panic!("{inside}: LAYERS has no {on}"));
            n_imports += 1;
            if on == module || below < above {
                continue;
            }
            match ALLOWED.iter().position(|(from, to, _)| *from == module && *to == on) {
                Some(k) => n_used[k] += 1,
                None => wrong.push(format!("{inside} uses {on}")),
            }
        }
    }
    assert!(n_imports > 100, "only {n_imports} imports found");
    wrong.sort();
    wrong.dedup();
    assert!(wrong.is_empty(), "upward imports:\n{}", wrong.join("\n"));
    for ((from, to, reason), n) in ALLOWED.iter().zip(n_used) {
        assert!(n > 0, "{from} no longer uses {to} ({reason}): take it off the list");
    }
}

/// Layers of the other crates from the bottom up, as modules at the root of each. Modules of one layer may import each
/// other.
const ROOMS: [(&str, &[&[&str]]); 4] = [
    (
        "crates/adwave-io",
        &[
            &["error", "format", "limits", "progress", "provenance", "unknown"],
            &["text", "bytes", "files"],
            &["transaction", "model"],
            &["formats"],
            &["registry"],
            &["texture", "signal", "region_field", "recipe", "pose", "mesh_stream", "cloud_part"],
            &["selection"],
        ],
    ),
    (
        "crates/adwave-tiles",
        &[
            &["error", "bytes", "bounds", "vector", "files", "layout", "params"],
            &["index"],
            &["halo"],
            &["sources"],
            &["stages"],
            &["job"],
            &["run"],
            &["terrain"],
        ],
    ),
    (
        "crates/adwave-report",
        &[&["detail", "table"], &["page"], &["analysis"], &["shape_report", "difference_report"], &["demo"]],
    ),
    (
        "crates/adwave-cli",
        &[
            &["error", "given", "inputs", "global"],
            &["output"],
            &["args"],
            &["resolve"],
            &["commands"],
            &["cli", "main"],
        ],
    ),
];

/// Imports that point up in these crates, each with its reason.
const UPWARD: [(&str, &str); 6] = [
    (
        "crates/adwave-cli/src/global.rs -> crates/adwave-cli/src/args/global.rs",
        "the flags of every command are declared with the other flags",
    ),
    (
        "crates/adwave-cli/src/output/print.rs -> crates/adwave-cli/src/args/file_name.rs",
        "names of files are printed as the parser of arguments encodes them",
    ),
    (
        "crates/adwave-io/src/bytes/cursor.rs -> crates/adwave-io/src/model/field.rs",
        "a cursor reads the values of a field by their type",
    ),
    (
        "crates/adwave-io/src/error.rs -> crates/adwave-io/src/text/mod.rs",
        "messages quote the file by the rules of text",
    ),
    (
        "crates/adwave-io/src/formats/gltf/texture.rs -> crates/adwave-io/src/texture/picture.rs",
        "a format names its pictures, the room of textures decodes them",
    ),
    ("crates/adwave-io/src/formats/obj/texture.rs -> crates/adwave-io/src/texture/picture.rs", "as for glTF"),
];

#[test]
fn rooms_of_the_other_crates_use_only_those_below_them() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut upward = Vec::new();
    for (package, layers) in ROOMS {
        upward.extend(xtask::style::upward_imports(root, package, layers).unwrap());
    }
    upward.sort();
    let allowed: Vec<&str> = UPWARD.iter().map(|(import, _)| *import).collect();
    assert_eq!(upward, allowed, "imports that point up, beside those that UPWARD allows");
}
