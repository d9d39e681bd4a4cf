//! Graphs: asymmetric matrices, self-loops, ids of nodes, and names of columns.

use crate::common;

use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;

fn notes(folder: &Path, line: &str) -> String {
    let output = adwave(folder).args(words(line)).assert().success().get_output().stderr.clone();
    String::from_utf8(output).unwrap()
}

/// Files of a ring of 12 nodes: symmetric, directed, with self-loops, as a transition matrix.
fn rings(folder: &Path) {
    const N: usize = 12;
    let write = |name: &str, kind: &str, entries: Vec<(usize, usize, f64)>| {
        let rows = entries
            .iter()
            .map(|(a, b, w)| format!("{} {} {w}\n", a % N + 1, b % N + 1))
            .collect::<Vec<_>>()
            .concat();
        let head = format!("%%MatrixMarket matrix coordinate real {kind}\n{N} {N} {}\n", entries.len());
        fs::write(folder.join(name), head + &rows).unwrap();
    };
    let both = || (0..N).flat_map(|i| [(i, i + 1, 1.0), (i + 1, i, 1.0)]).collect::<Vec<_>>();
    write("symmetric.mtx", "general", both());
    write("directed.mtx", "general", (0..N).map(|i| (i, i + 1, 1.0 + i as f64)).collect());
    write("loops.mtx", "general", both().into_iter().chain([(3, 3, 2.0), (5, 5, 1.0)]).collect());
    let third = |i: usize| [(i, i, 0.5), (i, i + 1, 0.25), (i, i + N - 1, 0.25)];
    write("walk.mtx", "general", (0..N).flat_map(third).collect());
    let edges = (0..N).map(|i| format!("v{i},v{},{}\n", (i + 1) % N, 1 + i)).collect::<Vec<_>>().concat();
    fs::write(folder.join("ring.edges"), "source,target,weight\n".to_owned() + &edges).unwrap();
    let nodes = (0..N).map(|i| format!("<node id=\"v{i}\"/>")).collect::<Vec<_>>().concat();
    let edges = (0..N)
        .map(|i| format!("<edge source=\"v{i}\" target=\"v{}\"/>", (i + 1) % N))
        .collect::<Vec<_>>()
        .concat();
    let graph = |default: &str, more: &str| {
        format!("<graphml><graph edgedefault=\"{default}\">{nodes}{edges}{more}</graph></graphml>")
    };
    fs::write(folder.join("directed.graphml"), graph("directed", "")).unwrap();
    fs::write(folder.join("loop.graphml"), graph("undirected", "<edge source=\"v2\" target=\"v2\"/>"))
        .unwrap();
    fs::write(folder.join("plain.graphml"), graph("undirected", "")).unwrap();
    let rows = (0..N).map(|i| format!("{i},{},{}\n", i * i % 7, 0.5 * i as f64)).collect::<Vec<_>>().concat();
    fs::write(folder.join("genes.csv"), "CD3,CD4,MS4A1\n".to_owned() + &rows).unwrap();
}

#[test]
fn changes_to_the_matrix_are_said_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    rings(path);
    let expected: [(&str, &[&str]); 8] = [
        ("symmetric.mtx", &[]),
        ("directed.mtx", &["not symmetric at 12 of 12 pairs", "(M + Mᵀ)/2 is used", "lazy walk"]),
        ("loops.mtx", &["2 self-loops are dropped", "lazy walk of the symmetric weights"]),
        ("walk.mtx", &["12 self-loops are dropped", "rows of M sum to 1, but M itself is not the walk"]),
        ("ring.edges", &[]),
        ("directed.graphml", &["not symmetric at 12 of 12 pairs"]),
        ("loop.graphml", &["1 self-loop is dropped"]),
        ("plain.graphml", &[]),
    ];
    for (name, texts) in expected {
        for line in [
            format!("info {name}"),
            format!("transform {name} -o o.npz --signal genes.csv --levels 3"),
            format!("filter {name} -o o.csv --signal genes.csv --preset smooth --levels 3"),
            format!("denoise {name} -o o.csv --signal genes.csv"),
        ] {
            let said = notes(path, &line);
            assert_eq!(said.matches("lazy walk").count(), usize::from(!texts.is_empty()), "{line}: {said}");
            assert!(texts.iter().all(|text| said.contains(text)), "{line}: {said}");
        }
    }
    let info = json(path, "info walk.mtx");
    assert_eq!((&info["dropped_loops"], &info["asymmetric_pairs"]), (&12.into(), &0.into()));
    assert_eq!(json(path, "info directed.mtx")["made_symmetric"], true);
    assert_eq!(json(path, "info ring.edges")["health"]["vertices"], 12);
}

#[test]
fn directed_steps_are_refused_for_graphs_and_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    rings(path);
    for line in [
        "info directed.mtx --directed",
        "transform directed.graphml -o o.npz --signal genes.csv --directed",
        "filter directed.mtx -o o.csv --signal genes.csv --preset smooth --directed",
        "denoise directed.mtx -o o.csv --signal genes.csv --directed",
        "filter sample:sphere -o o.ply --preset smooth --directed",
        "denoise sample:sphere -o o.ply --directed",
    ] {
        let error = refused(path, line);
        assert!(
            error.contains("--directed needs a cloud") && error.contains("leave it out"),
            "{line}: {error}"
        );
    }
    notes(path, "info sample:sphere --as cloud --directed");
}

#[test]
fn names_of_columns_survive_in_tables() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    rings(path);
    let head = |name: &str| fs::read_to_string(path.join(name)).unwrap().lines().next().unwrap().to_owned();
    for command in ["filter --preset smooth --levels 3", "denoise"] {
        let (first, rest) = command.split_once(' ').unwrap_or((command, ""));
        notes(path, &format!("{first} symmetric.mtx -o all.csv --signal genes.csv {rest}"));
        assert_eq!(head("all.csv"), "CD3,CD4,MS4A1");
        notes(path, &format!("{first} symmetric.mtx -o one.csv --signal genes.csv:CD4 {rest}"));
        assert_eq!(head("one.csv"), "CD4");
    }
    // The second pass reads what the first wrote.
    notes(path, "filter symmetric.mtx -o again.csv --signal all.csv --preset smooth --levels 3");
    assert_eq!(head("again.csv"), "CD3,CD4,MS4A1");
    fs::write(path.join("single.csv"), "TP53\n".to_owned() + &"1\n2\n3\n".repeat(4)).unwrap();
    notes(path, "filter symmetric.mtx -o single-out.csv --signal single.csv --preset smooth --levels 3");
    assert_eq!(head("single-out.csv"), "TP53");
    fs::write(path.join("plain.csv"), "1,2,3\n".repeat(12)).unwrap();
    notes(path, "filter symmetric.mtx -o plain-out.csv --signal plain.csv --preset smooth --levels 3");
    assert_eq!(head("plain-out.csv"), "plain_x,plain_y,plain_z");
}

#[test]
fn ids_of_nodes_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = "<graphml><key id=\"k\" for=\"node\" attr.name=\"level\" attr.type=\"double\"/><graph edgedefault=\"undirected\">\
        <node id=\"TP53\"><data key=\"k\">1</data></node><node id=\"MDM2\"><data key=\"k\">2</data></node>\
        <node id=\"a &lt;b&gt; &amp; &quot;c&quot;\"><data key=\"k\">4</data></node><node id=\"lonely\"><data key=\"k\">3</data></node>\
        <edge source=\"TP53\" target=\"MDM2\"/><edge source=\"MDM2\" target=\"a &lt;b&gt; &amp; &quot;c&quot;\"/></graph></graphml>";
    fs::write(path.join("g.graphml"), text).unwrap();
    for line in [
        "convert g.graphml -o out.graphml",
        "filter g.graphml -o out.graphml --signal level --preset smooth --levels 3",
        "denoise g.graphml -o out.graphml --signal level",
    ] {
        notes(path, line);
        let out = fs::read_to_string(path.join("out.graphml")).unwrap();
        for id in ["\"TP53\"", "\"MDM2\"", "\"a &lt;b&gt; &amp; &quot;c&quot;\"", "\"lonely\""] {
            assert!(out.contains(&format!("<node id={id}>")), "{line}: {out}");
        }
        assert!(out.contains("<edge source=\"TP53\" target=\"MDM2\">"), "{out}");
    }
    let said = notes(path, "convert g.graphml -o out.mtx");
    assert!(said.contains("cannot store") && said.contains("names of vertices"), "{said}");
}
