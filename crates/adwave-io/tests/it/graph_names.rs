//! Names of the nodes of graphs, and what their weights change.

use adwave_io::{Format, ReadLimits, ShapeFile, read_bytes, write_bytes};

fn read(text: &str, name: &str) -> ShapeFile {
    read_bytes(text.as_bytes().to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

/// Text of the shape in a format, and the parts that it lacks.
fn written(shape: &ShapeFile, format: Format) -> (String, Vec<String>) {
    let mut bytes = Vec::new();
    let report = write_bytes(shape, format, &mut bytes).unwrap();
    (String::from_utf8(bytes).unwrap(), report.not_written)
}

fn names(shape: &ShapeFile) -> Vec<&str> {
    shape.vertex_names().unwrap_or_default().iter().map(String::as_str).collect()
}

/// Path over these nodes as a GraphML.
fn graphml(ids: &[&str]) -> String {
    let nodes = ids.iter().map(|id| format!("<node id=\"{id}\"/>")).collect::<Vec<_>>().concat();
    let edges = ids
        .windows(2)
        .map(|pair| format!("<edge source=\"{}\" target=\"{}\"/>", pair[0], pair[1]))
        .collect::<Vec<_>>()
        .concat();
    format!("<graphml><graph edgedefault=\"undirected\">{nodes}{edges}</graph></graphml>")
}

#[test]
fn ids_survive_in_every_graph_format() {
    let shape = read(&graphml(&["TP53", "MDM2", "CDKN1A"]), "g.graphml");
    for (format, ending) in [(Format::GRAPHML, "graphml"), (Format::TGF, "tgf"), (Format::EDGE_LIST, "edges")]
    {
        let (text, lost) = written(&shape, format);
        assert!(lost.is_empty(), "{format}: {lost:?}");
        let again = read(&text, &format!("a.{ending}"));
        assert_eq!(names(&again), ["TP53", "MDM2", "CDKN1A"], "{format}");
        assert_eq!(again.edges().pairs, shape.edges().pairs, "{format}");
        let (text, _) = written(&again, Format::GRAPHML);
        assert_eq!(names(&read(&text, "b.graphml")), ["TP53", "MDM2", "CDKN1A"], "{format}");
    }
    assert_eq!(written(&shape, Format::MTX).1, ["names of vertices"]);
}

#[test]
fn ids_that_only_number_the_rows_are_no_names() {
    let plain = read(&graphml(&["n0", "n1", "n2"]), "g.graphml");
    assert!(plain.vertex_names().is_none() && written(&plain, Format::MTX).1.is_empty());
    let shifted = read(&graphml(&["n1", "n0", "n2"]), "g.graphml");
    assert_eq!(names(&read(&written(&shifted, Format::GRAPHML).0, "g.graphml")), ["n1", "n0", "n2"]);
    assert!(read("1\n2\n#\n1 2\n", "a.tgf").vertex_names().is_none());
    assert!(read("0 1\n1 2\n", "a.edges").vertex_names().is_none());
}

#[test]
fn special_characters_are_escaped_or_reported() {
    let shape = read(&graphml(&["a &lt;b&gt;", "&amp;&quot;'", "ä 漢"]), "g.graphml");
    assert_eq!(names(&shape), ["a <b>", "&\"'", "ä 漢"]);
    assert_eq!(names(&read(&written(&shape, Format::GRAPHML).0, "g.graphml")), names(&shape));
    for format in [Format::TGF, Format::EDGE_LIST] {
        assert_eq!(written(&shape, format).1, ["names of vertices"], "{format}");
    }
    // A tab would become a blank in an attribute.
    let tab = read(&graphml(&["a&#9;b", "c"]), "g.graphml");
    assert_eq!(written(&tab, Format::GRAPHML).1, ["names of vertices"]);
    let error = read_bytes(graphml(&["A", "B", "A"]).into_bytes(), None, &ReadLimits::default()).unwrap_err();
    assert!(error.to_string().contains("occurs twice"), "{error}");
}

#[test]
fn lists_of_edges_keep_numbers_and_words_and_skip_the_names_of_columns() {
    let numbers = read("100 7\n7 3000\n", "a.edges");
    assert_eq!(names(&numbers), ["7", "100", "3000"]);
    let (text, lost) = written(&numbers, Format::EDGE_LIST);
    assert!(lost.is_empty(), "{lost:?}");
    assert_eq!(
        (text.as_str(), read(&text, "a.edges").field("id").unwrap().to_f64()),
        ("100 7\n7 3000\n", vec![7.0, 100.0, 3000.0])
    );
    let table = read("source,target,weight\nTP53,MDM2,0.5\nMDM2,TP53,0.25\n", "a.edges");
    assert_eq!((names(&table), table.edges().weights.clone()), (vec!["TP53", "MDM2"], vec![0.5, 0.25]));
    // A node without edges is not in a list.
    let lonely = "<graphml><graph edgedefault=\"undirected\"><node id=\"A\"/><node id=\"B\"/><node id=\"C\"/>\
                  <edge source=\"A\" target=\"B\"/></graph></graphml>";
    let (text, lost) = written(&read(lonely, "g.graphml"), Format::EDGE_LIST);
    assert_eq!((lost, read(&text, "a.edges").n_vertices()), (vec!["names of vertices".to_owned()], 3));
}

#[test]
fn a_part_of_a_graph_keeps_the_names_of_its_nodes() {
    let shape = read(&graphml(&["A", "B", "C", "D"]), "g.graphml");
    let subset = adwave_io::Subset { vertices: &[1, 3], ..adwave_io::Subset::default() };
    assert_eq!(names(&shape.subset(&subset).unwrap()), ["B", "D"]);
}

#[test]
fn changes_of_weights_are_counted() {
    let changes = |entries: &str, n: usize| {
        let text = format!("%%MatrixMarket matrix coordinate real general\n3 3 {n}\n{entries}");
        read(&text, "a.mtx").graph_changes()
    };
    let same = changes("1 2 3\n2 1 3\n", 2);
    assert_eq!((same.n_pairs, same.n_asymmetric, same.n_loops, same.note()), (1, 0, 0, None));
    let directed = changes("1 2 3\n2 1 4\n2 3 1\n3 3 1\n", 4);
    assert_eq!((directed.n_pairs, directed.n_asymmetric, directed.n_loops), (2, 2, 1));
    // Repeated entries add up.
    assert_eq!(changes("1 2 1\n1 2 2\n2 1 3\n", 3).n_asymmetric, 0);
    let walk = changes("1 2 0.5\n1 3 0.5\n2 1 1\n3 1 1\n", 4);
    assert!(walk.is_stochastic && walk.note().unwrap().contains("M itself is not the walk"), "{walk:?}");
    assert!(!changes("1 2 0.5\n2 1 1\n", 2).is_stochastic);
    let symmetric = "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 9\n2 1 1\n";
    assert_eq!(read(symmetric, "a.mtx").graph_changes().n_loops, 1);
}
