//! Tests of DMAT, TGF, lists of edges and GraphML.

use adwave_io::{
    Direction, Edges, Field, FieldValues, Format, ReadLimits, ShapeFile, ShapeKind, parse_dmat_field,
    read_dmat_field, read_path,
};
use adwave_test_data::data_test;

use crate::common;
use crate::meshes::{error, read, survives, written};

#[test]
fn a_matrix_of_three_columns_is_a_cloud() {
    let cloud = ShapeFile::from_cloud(vec![[0.0, 1.0, 2.0], [0.1, -0.0, 1e300]]);
    let text = written(&cloud, Format::DMAT);
    assert_eq!(text, b"3 2\n0\n0.1\n1\n-0\n2\n1e300\n");
    let binary = written(&cloud, Format::DMAT_BINARY);
    for (bytes, format) in [(&text, Format::DMAT), (&binary, Format::DMAT_BINARY)] {
        let again = read(bytes, "a");
        assert_eq!((again.points(), again.format()), (cloud.points(), Some(format)));
        let field = parse_dmat_field(bytes, "a").unwrap();
        assert_eq!((field.n_channels, field.to_f64()), (3, cloud.points().as_flattened().to_vec()));
    }
    assert!(error(b"2 2\n1\n2\n3\n4\n", "a.dmat").contains("use the matrix as a field of a shape"));
    assert!(error(b"3 1000000000\n1\n", "a.dmat").contains("get the whole file"));
    survives(&text, "a.dmat", |end, _| assert!(end + 6 >= text.len(), "{end}"));
    survives(&binary, "a.dmat", |end, _| panic!("cut at {end}"));
}

#[test]
fn a_tgf_has_places_or_labels_and_weights() {
    let file = read(b"a 0 0 0\nb 1 0 0\nc 0 1 0\n#\na b 0.5\nc b 2\n", "a.tgf");
    assert_eq!((file.points().len(), file.edges().pairs.as_slice()), (3, &[[0, 1], [2, 1]][..]));
    assert_eq!(file.edges().weights, [0.5, 2.0]);
    assert_eq!(file.kind(), ShapeKind::Graph);
    let named = read(b"1 first\n2 second\n#\n1 2 likes\n", "a.tgf");
    assert_eq!(
        (named.points().len(), named.edges().weights.len(), named.extras()),
        (0, 0, &["labels of vertices".to_owned()][..])
    );
    assert!(
        error(b"1\n2\n#\n1 3\n", "a.tgf")
            .contains("line 4: an edge names vertex \"3\", which does not exist")
    );
    assert!(error(b"1\n1\n#\n", "a.tgf").contains("line 2: vertex \"1\" occurs twice"));
    assert!(error(b"1\n2\n", "a.tgf").contains("the line with # between vertices and edges is missing"));
    survives(&written(&file, Format::TGF), "a.tgf", |_, _| {});
}

#[test]
fn lists_of_edges_as_programs_write_them() {
    let edges = |text: &str| {
        let file = read(text.as_bytes(), "a.edges");
        (file.n_vertices(), file.edges().pairs.clone(), file.edges().weights.clone())
    };
    // SNAP, NetworkX with and without a dictionary, KONECT, commas.
    let snap = "# Nodes: 5 Edges: 2\n# FromNodeId\tToNodeId\n0\t1\n3\t1\n";
    assert_eq!(edges(snap), (5, vec![[0, 1], [3, 1]], vec![]));
    assert_eq!(
        edges("1 2 {'weight': 0.5}\n2 3 {'color': 1, 'weight': 2}\n"),
        (3, vec![[0, 1], [1, 2]], vec![0.5, 2.0])
    );
    assert_eq!(edges("1 2 {}\n2 3 {}\n"), (3, vec![[0, 1], [1, 2]], vec![]));
    assert_eq!(edges("% sym\n1 2 0.5 9999\n2 4 1 9999\n"), (3, vec![[0, 1], [1, 2]], vec![0.5, 1.0]));
    assert_eq!(edges("b,a,2\na,c,3\n"), (3, vec![[0, 1], [1, 2]], vec![2.0, 3.0]));
    let sparse = read(b"100 7\n7 50\n", "a.edges");
    assert_eq!(sparse.field("id").unwrap().values, FieldValues::U64(vec![7, 50, 100]));
    assert_eq!(sparse.edges().pairs, [[2, 0], [0, 1]]);
    assert!(error(b"1 2\n3\n", "a.edges").contains("line 2: an edge needs two vertices, got \"3\""));
    // A count of vertices without bytes in the file must not allocate memory.
    assert_eq!(edges("# Nodes: 4000000000\n0 1\n").0, 2);
    survives(snap.as_bytes(), "a.edges", |_, _| {});
}

const GRAPHML: &str = "<?xml version=\"1.0\"?><graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\
    <key id=\"d0\" for=\"node\" attr.name=\"x\" attr.type=\"double\"/><key id=\"d1\" for=\"node\" attr.name=\"y\" attr.type=\"double\"/>\
    <key id=\"d2\" for=\"node\" attr.name=\"age\" attr.type=\"int\"><default>7</default></key>\
    <key id=\"d3\" for=\"edge\" attr.name=\"weight\" attr.type=\"double\"/><key id=\"d4\" for=\"node\" attr.name=\"name\" attr.type=\"string\"/>\
    <graph edgedefault=\"undirected\"><node id=\"a\"><data key=\"d0\">0.5</data><data key=\"d1\">1</data><data key=\"d4\">b</data></node>\
    <node id=\"b\"><data key=\"d0\">2</data><data key=\"d1\">3</data><data key=\"d2\">40</data></node>\
    <edge source=\"b\" target=\"a\"><data key=\"d3\">0.25</data></edge></graph></graphml>";

#[test]
fn a_graphml_has_places_fields_and_weights() {
    let file = read(GRAPHML.as_bytes(), "a.xml");
    assert_eq!(
        (file.points(), file.format()),
        (&[[0.5, 1.0, 0.0], [2.0, 3.0, 0.0]][..], Some(Format::GRAPHML))
    );
    assert_eq!(
        (file.edges().pairs.as_slice(), file.edges().weights.as_slice()),
        (&[[1, 0]][..], &[0.25][..])
    );
    assert_eq!(file.field("age").unwrap().values, FieldValues::I32(vec![7, 40]));
    assert_eq!(file.extras(), ["texts of nodes"]);
    let positions =
        GRAPHML.replace("attr.name=\"x\" attr.type=\"double\"", "attr.name=\"pos\" attr.type=\"string\"");
    let positions = positions.replace("0.5<", "[1, 2, 3]<").replace(">2<", ">(4 5)<");
    assert_eq!(read(positions.as_bytes(), "a.graphml").points(), [[1.0, 2.0, 3.0], [4.0, 5.0, 0.0]]);
    let nowhere = positions.replace("(4 5)", "nan 5");
    assert!(read(nowhere.as_bytes(), "a.graphml").points().is_empty());
    let directed = read(GRAPHML.replace("undirected", "directed").as_bytes(), "a.graphml");
    assert_eq!(directed.edges().direction, Direction::RowToColumn);
    assert!(
        error(GRAPHML.replace("source=\"b\"", "source=\"c\"").as_bytes(), "a.graphml")
            .contains("names node \"c\"")
    );
    survives(GRAPHML.as_bytes(), "a.graphml", |end, _| panic!("cut at {end}"));
}

#[test]
fn a_graphml_keeps_fields_and_places() {
    let pairs = vec![[0, 1], [2, 1]];
    let mut graph = ShapeFile::from_graph(3, Edges { pairs, weights: vec![0.5, 1.5], ..Edges::default() });
    graph.set_points(vec![[0.0, 0.1, 0.2], [1.0, 2.0, 3.0], [-1.0, 0.0, 1e-300]]).unwrap();
    graph
        .add_vertex_field(Field::new("flow", 3, FieldValues::F32((0..9).map(|k| k as f32 / 7.0).collect())))
        .unwrap();
    graph.add_vertex_field(Field::new("label", 1, FieldValues::I32(vec![-1, 0, 5]))).unwrap();
    let again = read(&written(&graph, Format::GRAPHML), "a");
    assert_eq!((again.points(), again.edges()), (graph.points(), graph.edges()));
    assert_eq!(again.vertex_fields(), graph.vertex_fields());
}

/// Counts of the first lines, by hand; the bytes of the binary file by NumPy.
#[data_test]
fn real_files() {
    let folder = common::test_inputs().join("formats/messy/libigl-tests-data");
    let points = read_path(&folder.join("duplicated_faces_V.dmat"), &ReadLimits::default()).unwrap();
    assert_eq!((points.n_vertices(), points.format()), (493, Some(Format::DMAT_BINARY)));
    let field = read_dmat_field(&folder.join("3holes-miq-UV.dmat"), &ReadLimits::default()).unwrap();
    assert_eq!((field.n_channels, field.len(), field.get(0, 0)), (2, 4023, 0.114_864_074_767_894_1));
    let field =
        read_dmat_field(&folder.join("decimated-knight-matlab-active-set.dmat"), &ReadLimits::default())
            .unwrap();
    assert_eq!((field.n_channels, field.len()), (7, 1822));
    let graph = read_path(&folder.join("decimated-knight.tgf"), &ReadLimits::default()).unwrap();
    assert_eq!((graph.n_vertices(), graph.edges().pairs.len()), KNIGHT);
    assert_eq!(graph.points().len(), graph.n_vertices());
}

/// Lines before and after the first `#`.
const KNIGHT: (usize, usize) = (8, 7);
