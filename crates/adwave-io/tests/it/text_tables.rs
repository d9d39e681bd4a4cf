//! Columns of text tables, as different programs write them.

use adwave_io::{Format, ReadLimits, ShapeFile, parse_csv_fields, read_bytes, write_bytes};

fn read(text: &str, name: &str) -> ShapeFile {
    read_bytes(text.as_bytes().to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn error(text: &str, name: &str) -> String {
    read_bytes(text.as_bytes().to_vec(), Some(name), &ReadLimits::default()).unwrap_err().to_string()
}

fn moved_up(file: &mut ShapeFile, format: Format) -> String {
    let points = file.points().iter().map(|p| [p[0], p[1], p[2] + 0.25]).collect();
    file.set_points(points).unwrap();
    let mut out = Vec::new();
    write_bytes(file, format, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn names_decide_which_columns_are_coordinates() {
    let file = read("id,lon,lat,elev\n1,8.5,50.5,300\n2,8.75,50.25,301\n", "a.csv");
    assert_eq!(file.points(), [[8.5, 50.5, 300.0], [8.75, 50.25, 301.0]]);
    assert_eq!(file.field("id").unwrap().to_f64(), [1.0, 2.0]);
    let notes = file.notes();
    assert_eq!(
        notes[0],
        "the columns `lon`, `lat` and `elev` are x, y and z; others would be if they were named so"
    );
    assert!(notes[1].contains("degrees (by the names of the columns)"), "{notes:?}");
    assert!(file.coordinate_system().unwrap().is_geographic());
    // Meters, whatever the names say.
    let file = read("long,lat,z\n500000,5400000,300\n500001,5400000,301\n", "a.csv");
    assert!(file.coordinate_system().is_none());
    for (head, row) in [
        ("Northing,Easting,H", "50,8,3"),
        ("intensity,Y [m],X [m],Z [m]", "9,50,8,3"),
        ("pid\tz\ty\tx", "7\t3\t50\t8"),
        ("no;Hochwert;Rechtswert;Hoehe", "7;50;8;3"),
        ("index,a,b,c", "7,8,50,3"),
        ("x,y,value,id", "8,50,3,1"),
    ] {
        let file = read(&format!("{head}\n{row}\n{row}\n"), "a.csv");
        assert_eq!(file.points(), [[8.0, 50.0, 3.0]; 2], "{head}");
    }
    assert!(read("X,Y,Z,v\n1,2,3,4\n", "a.csv").notes().is_empty());
    assert!(error("x,y,a,b\n1,2,3,4\n", "a.csv").contains("name the third one z"));
}

#[test]
fn quotes_words_and_missing_numbers_are_understood() {
    let file = read("\"\",\"X\",\"Y\",\"Z\",\"v\"\n\"1\",0.5,0.25,1,2\n\"2\",1,2,3,NA\n", "a.csv");
    assert_eq!(file.points(), [[0.5, 0.25, 1.0], [1.0, 2.0, 3.0]]);
    assert_eq!(file.field("index").unwrap().to_f64(), [1.0, 2.0]);
    assert!(file.field("v").unwrap().get(1, 0).is_nan());
    let text = "X,Y,Z,Label,v\n1,2,3,\"oak, red\",0.5\n4,5,6,fir,0.25\n";
    let mut file = read(text, "a.csv");
    assert_eq!(file.field_names(), ["v"]);
    assert_eq!(file.notes(), ["the column of text is left out: `Label` (\"oak, red\")"]);
    let written = moved_up(&mut file, Format::CSV);
    assert_eq!(written, "X,Y,Z,Label,v\n1,2,3.25,\"oak, red\",0.5\n4,5,6.25,fir,0.25\n");
    let without_names = read("1 2 3 tree 5\n4 5 6 rock 7\n", "a.xyz");
    assert_eq!(without_names.points()[1], [4.0, 5.0, 6.0]);
    assert_eq!(without_names.field_names(), ["column_5"]);
    assert!(error("x,y,z\n1,2,3\n4,five,6\n", "a.csv").contains("line 3"));
}

#[test]
fn decimal_commas_are_read_and_written() {
    let mut file = read("X;Y;Z;v\n0,5;-0,25;1;9,5\n2,5;1e-1;0;3\n", "a.csv");
    assert_eq!(file.points(), [[0.5, -0.25, 1.0], [2.5, 0.1, 0.0]]);
    assert_eq!(file.field("v").unwrap().to_f64(), [9.5, 3.0]);
    assert_eq!(moved_up(&mut file, Format::CSV), "X;Y;Z;v\n0,5;-0,25;1,25;9,5\n2,5;1e-1;0,25;3\n");
    for text in [
        "0,5 -0,25 1,0\n2,5 0,1 0,0\n",
        "0,5\t-0,25\t1,0\n2,5\t0,1\t0,0\n",
        "x y z\n0,5 -0,25 1\n2,5 0,1 0\n",
    ] {
        assert_eq!(read(text, "a.xyz").points(), [[0.5, -0.25, 1.0], [2.5, 0.1, 0.0]], "{text}");
    }
    assert_eq!(read("1,2,3\n4,5,6\n", "a.xyz").points()[1], [4.0, 5.0, 6.0]);
}

#[test]
fn columns_of_words_in_a_table_of_values_are_left_out() {
    let fields = parse_csv_fields(b"name,value\nTP53,1.5\nMDM2,NA\n", &ReadLimits::default()).unwrap();
    assert_eq!(fields.len(), 1);
    assert_eq!(fields[0].name, "value");
    assert_eq!(fields[0].get(0, 0), 1.5);
    let german = parse_csv_fields(b"value;other\n1,5;2\n", &ReadLimits::default()).unwrap();
    assert_eq!(german[0].to_f64(), [1.5]);
    assert!(parse_csv_fields(b"name\na\nb\n", &ReadLimits::default()).is_err());
}

/// Rows of a total station: number, northing, easting, height, code.
fn survey(number: impl Fn(usize) -> String, separator: &str, code: impl Fn(usize) -> String) -> String {
    let row = |i: usize| {
        let t = i as f64;
        let [north, east, height] = [5000.125 + 3.0 * t, 2000.375 - 2.0 * t, 100.5 + t.sin().round() / 8.0];
        [number(i), north.to_string(), east.to_string(), height.to_string(), code(i)].join(separator)
    };
    (0..12).map(row).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn the_number_of_a_surveyed_point_is_no_coordinate() {
    let tree = |i: usize| ["TREE", "EDGE", ""][i % 3].to_owned();
    for (text, name) in [
        (survey(|i| (i + 1).to_string(), ",", tree), "a.txt"),
        (survey(|i| (i + 1).to_string(), ",", tree), "a.csv"),
        (survey(|i| (101 + 3 * i).to_string(), ";", tree), "a.txt"),
        // Measured again, in another order.
        (survey(|i| (7 * i % 12 + 1).to_string(), "\t", |_| "KERB".to_owned()), "a.txt"),
        (survey(|i| (i + 1).to_string(), " ", |i| (i % 4).to_string()), "a.xyz"),
        (survey(|i| format!("P{i}"), ",", |_| "WALL".to_owned()), "a.csv"),
    ] {
        let file = read_bytes(text.clone().into_bytes(), Some(name), &ReadLimits::default()).unwrap();
        assert_eq!(file.points()[1], [1998.375, 5003.125, 100.625], "{text}");
        assert!(file.notes()[0].contains("northing (y), easting (x) and height (z); a first line"), "{text}");
        let mut moved = file.clone();
        moved.set_points(file.points().to_vec()).unwrap();
        let mut out = Vec::new();
        write_bytes(&moved, file.format().unwrap(), &mut out).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), text);
    }
}

#[test]
fn numbers_before_coordinates_are_told_by_their_values() {
    let points =
        |text: &str| read_bytes(text.as_bytes().to_vec(), Some("a.txt"), &ReadLimits::default()).unwrap();
    // Nodes of a mesh program.
    let nodes = points("1 0.5 0.25 0\n2 1.5 0.25 1\n3 2.5 0.75 0\n4 3.5 0.5 0\n");
    assert_eq!(nodes.points()[3], [3.5, 0.5, 0.0]);
    assert_eq!(nodes.field("number").unwrap().to_f64(), [1.0, 2.0, 3.0, 4.0]);
    // Eastings of UTM come before northings that are greater.
    let utm =
        points("1,500100.5,5200000.25,12.5,A\n2,500101.5,5200001.25,12.5,A\n3,500102.5,5200002.25,13.5,B\n");
    assert_eq!(utm.points()[0], [500_100.5, 5_200_000.25, 12.5]);
    // Coordinates with an intensity, a grid, and integers that repeat.
    for text in [
        "0.5 0.25 1.5 7\n1.5 0.25 2.5 8\n2.5 1.25 2.5 9\n",
        "0 0 1.5 7\n1 0 2.5 8\n2 1 2.5 9\n",
        "1 0.5 0.25 7\n1 1.5 0.25 8\n2 2.5 0.75 9\n",
    ] {
        let file = points(text);
        let first: f64 = text.split(' ').next().unwrap().parse().unwrap();
        assert_eq!((file.points()[0][0], file.notes().len()), (first, 0), "{text}");
    }
}
