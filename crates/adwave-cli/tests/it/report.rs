//! `adwave report`: one file that is whole, safe and legible, whatever the shape; refusals before any long work.

use crate::common;

use base64::Engine as _;
use common::page::{Tag, tags};
use common::{adwave, json, refused};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Makes the report of `arguments` and checks what every page has; gives the page and what the command prints.
fn report(folder: &Path, arguments: &str) -> (String, Value) {
    let made = json(folder, &format!("report {arguments} -o page.html"));
    let page = fs::read_to_string(folder.join("page.html")).unwrap();
    assert_eq!(made["bytes"].as_u64(), Some(page.len() as u64));
    let tags = tags(&page);
    check_links(&tags);
    check_pictures(&tags, &made);
    let ids: Vec<&str> = tags.iter().filter(|t| t.name == "section").filter_map(|t| t.get("id")).collect();
    assert_eq!(ids, ["health", "shape", "bands", "saliency", "features", "presets", "timings"]);
    for name in ["viewport", "color-scheme"] {
        assert!(tags.iter().any(|t| t.name == "meta" && t.get("name") == Some(name)), "{name}");
    }
    assert!(page.contains("prefers-color-scheme:dark"));
    let left: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains(".tmp")), "{left:?}");
    (page, made)
}

/// Nothing runs, and nothing is loaded from outside the file.
fn check_links(tags: &[Tag]) {
    for tag in tags {
        assert!(
            !["script", "link", "iframe", "object", "embed", "base"].contains(&tag.name.as_str()),
            "{tag:?}"
        );
        for (name, value) in &tag.attributes {
            assert!(!name.starts_with("on"), "{tag:?}");
            if ["src", "href", "srcset"].contains(&name.as_str()) {
                assert!(value.starts_with("data:") || value.starts_with('#'), "{tag:?}");
            } else {
                assert!(!value.contains("http:") && !value.contains("https:"), "{tag:?}");
            }
        }
    }
    for link in tags.iter().filter_map(|t| t.get("href")).filter_map(|link| link.strip_prefix('#')) {
        assert!(tags.iter().any(|t| t.get("id") == Some(link)), "nothing has the name {link}");
    }
}

/// Each picture says what it shows, is what its type says, and of the size that is kept free for it.
fn check_pictures(tags: &[Tag], made: &Value) {
    let decoded = |uri: &str| {
        let (head, body) = uri.split_once(";base64,").unwrap();
        (head.to_owned(), base64::engine::general_purpose::STANDARD.decode(body).unwrap())
    };
    let mut n_shaded = 0;
    for tag in tags.iter().filter(|t| t.name == "img") {
        let alt = tag.get("alt").unwrap();
        assert!(alt.split_whitespace().count() > 2, "{alt}");
        let (head, bytes) = decoded(tag.get("src").unwrap());
        let size = ["width", "height"].map(|side| tag.get(side).unwrap().parse::<u32>().unwrap());
        if head == "data:image/svg+xml" {
            let svg = String::from_utf8(bytes).unwrap();
            assert!(!svg.replace("http://www.w3.org/2000/svg", "").contains("http"), "{svg}");
        } else {
            let picture = image::load_from_memory(&bytes).unwrap();
            assert_eq!([picture.width(), picture.height()], size);
            n_shaded += 1;
        }
    }
    let dark = tags.iter().filter(|t| t.name == "source").map(|t| decoded(t.get("srcset").unwrap()));
    let dark: Vec<_> = dark.map(|(_, bytes)| image::load_from_memory(&bytes).unwrap()).collect();
    assert_eq!(dark.len(), n_shaded);
    assert_eq!(made["pictures"].as_u64(), Some(n_shaded as u64));
    let captions = tags.iter().filter(|t| t.name == "figcaption").count();
    assert_eq!(captions, tags.iter().filter(|t| t.name == "img").count());
}

#[test]
fn a_mesh_gets_every_section_and_the_numbers_that_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let (page, made) = report(folder.path(), "sample:creature --vertices 2000 --levels 6");
    assert_eq!(made["pictures"], 20);
    assert_eq!(made["health"]["closed"], true);
    assert_eq!(made["bands"].as_array().unwrap().len(), 6);
    let shares = made["bands"].as_array().unwrap().iter().map(|b| b["detail_share"].as_f64().unwrap());
    assert!((shares.sum::<f64>() - 1.0).abs() < 1e-12, "shares of a whole");
    let names: Vec<&str> =
        made["presets"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["suppress", "suppress-paper", "enhance", "band1", "band2"]);
    let ratio = |k: usize| made["presets"][k]["volume_ratio"].as_f64().unwrap();
    assert!(ratio(1) < ratio(0) && ratio(0) < 1.0, "smoothing shrinks, the paper's more");
    for part in ["reading", "diffusion", "bands", "saliency", "features", "presets", "pictures"] {
        assert!(made["seconds"]["parts"][part].is_number(), "{part}");
        assert!(page.contains(&format!("<td class=\"s\">{part}</td>")), "{part}");
    }
    assert!(page.contains("Nothing unusual."));
    assert!(page.contains("adwave report sample:creature --vertices 2000 --levels 6"));
}

#[test]
fn the_same_shape_gives_the_same_page_but_for_the_times() {
    let folder = tempfile::tempdir().unwrap();
    let page = |threads: &str| {
        let (page, _) = report(folder.path(), &format!("sample:knot --vertices 600 --threads {threads}"));
        let end = page.find("<section id=\"timings\"").unwrap();
        page[..end].to_owned()
    };
    assert!(page("1") == page("2"), "the pages differ");
}

#[test]
fn a_cloud_is_drawn_with_its_field() {
    let folder = tempfile::tempdir().unwrap();
    let rows = (0..400).map(|i| format!("{},{},{},{}\n", i % 20, i / 20, (i % 7) * (i % 3), i % 5));
    fs::write(folder.path().join("scan.csv"), "x,y,z,intensity\n".to_owned() + &rows.collect::<String>())
        .unwrap();
    let (page, made) = report(folder.path(), "scan.csv --field intensity --up z --view top");
    assert_eq!((made["kind"].as_str(), made["field"].as_str()), (Some("cloud"), Some("intensity")));
    assert!(made["pictures"].as_u64().unwrap() >= 18);
    assert!(
        page.contains("<h1>intensity on scan.csv</h1>") && page.contains("evens out"),
        "{}",
        &page[..900]
    );
}

#[test]
fn a_graph_gets_charts_and_tables() {
    let folder = tempfile::tempdir().unwrap();
    let edges: Vec<String> = (2..=60).map(|i| format!("{i} {} 1\n", 1 + (i * 7) % (i - 1))).collect();
    fs::write(
        folder.path().join("tree.mtx"),
        format!("%%MatrixMarket matrix coordinate real symmetric\n60 60 59\n{}", edges.concat()),
    )
    .unwrap();
    let (page, made) = report(folder.path(), "tree.mtx");
    assert_eq!((made["field"].as_str(), made["pictures"].as_u64()), (Some("degree"), Some(0)));
    assert!(tags(&page).iter().any(|t| t.get("alt").is_some_and(|alt| alt.contains("energy of each band"))));
    assert!(page.contains("A graph has no positions") && page.contains("nodes"));
    assert!(!page.contains("% of the diagonal"), "a graph has no diagonal");
}

#[test]
fn degenerate_shapes_have_a_page_that_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let (page, made) = report(path, "one.obj");
    assert_eq!(made["health"]["boundary_edges"], 3);
    assert!(page.contains("Edges on a border"));
    fs::write(path.join("same.xyz"), "1 1 1\n".repeat(9)).unwrap();
    let (page, made) = report(path, "same.xyz");
    assert_eq!(made["health"]["welded_vertices"], 8);
    assert!(page.contains("every band is 0") && page.contains("nothing stands out"));
    fs::write(path.join("point.xyz"), "1 2 3\n").unwrap();
    report(path, "point.xyz");
    for far in ["1e90", "1e-90"] {
        fs::write(
            path.join("far.obj"),
            format!("v 0 0 0\nv {far} 0 0\nv 0 {far} 0\nv 0 0 {far}\nf 1 2 3\nf 1 3 4\n"),
        )
        .unwrap();
        report(path, "far.obj --levels 3");
    }
    // A face that is named twice, one without area, three faces at an edge, a vertex of no face.
    let odd =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nv 9 9 9\nf 1 2 3\nf 1 2 3\nf 1 2 4\nf 2 1 5\nf 1 1 2\n";
    fs::write(path.join("odd.obj"), odd).unwrap();
    let (page, _) = report(path, "odd.obj --levels 3");
    for words in ["Edges of three or more faces", "Repeated faces", "Vertices of no face", "irregularities"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn where_the_field_is_nan_vertices_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let values: String =
        (0..400).map(|i| if i % 10 == 0 { "nan\n".to_owned() } else { format!("{}\n", i % 9) }).collect();
    let rows = (0..400).map(|i| format!("{} {} 0\n", i % 20, i / 20));
    fs::write(folder.path().join("grid.xyz"), rows.collect::<String>()).unwrap();
    fs::write(folder.path().join("heat.csv"), format!("heat\n{values}")).unwrap();
    let (page, made) = report(folder.path(), "grid.xyz --field heat.csv:heat");
    assert!(page.contains("Vertices without a value") && page.contains(">40<"));
    assert!(made["bands"].as_array().unwrap().iter().all(|b| b["rms"].as_f64().unwrap() > 0.0));
}

#[test]
fn names_cannot_become_part_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let name = "<script>alert(1)<script>&\"`_1`.csv";
    let field = "</figure><img src=x onerror='alert(2)'>";
    let rows = (0..64).map(|i| format!("{},{},0,{}\n", i % 8, i / 8, i % 5));
    fs::write(folder.path().join(name), format!("x,y,z,\"{field}\"\n{}", rows.collect::<String>())).unwrap();
    adwave(folder.path()).args(["report", name, "--field", field, "-o", "page.html"]).assert().success();
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    let tags = tags(&page);
    check_links(&tags);
    assert!(
        page.contains("&lt;script&gt;alert(1)")
            && page.contains("&lt;/figure&gt;&lt;img src=x onerror=&#39;alert(2)&#39;&gt;")
    );
    assert!(tags.iter().filter(|t| t.name == "img").all(|t| t.get("src") != Some("x")));
}

#[test]
fn bad_requests_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.csv"), "x,y,z,heat\n0,0,0,1\n1,0,0,2\n0,1,0,3\n").unwrap();
    fs::write(path.join("g.mtx"), "%%MatrixMarket matrix coordinate real symmetric\n3 3 2\n2 1 1\n3 2 1\n")
        .unwrap();
    fs::write(path.join("page.html"), "as it was").unwrap();
    fs::create_dir(path.join("folder.html")).unwrap();
    for (arguments, words) in [
        ("missing.obj -o nowhere/page.html", "nowhere"),
        ("missing.obj -o folder.html", "is a folder"),
        ("missing.obj -o page.pdf", ".html"),
        ("missing.obj -o page.html --levels 0", "level"),
        ("missing.obj -o page.html --levels 99", "steps"),
        ("missing.obj -o page.html --steps 4,2", "2"),
        ("missing.obj -o page.html --lengths 1,0.5", "0.5"),
        ("missing.obj -o page.html --accuracy 2", "2"),
        ("missing.obj -o page.html", "missing.obj"),
        ("a.csv -o page.html --field cold", "heat"),
        ("g.mtx -o page.html --field coords", "degree"),
        ("g.mtx -o page.html --field cold", "degree"),
        ("a.csv -o page.html --field heat --texture t.png", "texture"),
    ] {
        let error = refused(path, &format!("report {arguments}"));
        assert!(error.contains(words), "{arguments}: {error}");
    }
    assert_eq!(fs::read_to_string(path.join("page.html")).unwrap(), "as it was");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused_before_the_shape_is_read() {
    let folder = tempfile::tempdir().unwrap();
    // No one can make files there, whoever runs the test.
    let run = adwave(folder.path()).args(["report", "missing.obj", "-o", "/proc/page.html"]).assert().code(1);
    let error = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(error.contains("/proc/page.html") && error.trim_end().lines().count() == 1, "{error}");
}
