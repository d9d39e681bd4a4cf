//! Units of length, coordinate systems, and the digits of coordinates.

use std::io::Write;

use adwave_io::{
    CoordinateSystemKind, Format, LengthUnit, ReadLimits, ShapeFile, WriteReport, read_bytes, write_bytes,
};

const UNITS: [(&str, f64); 6] = [
    ("micron", 1e-6),
    ("millimeter", 1e-3),
    ("centimeter", 0.01),
    ("inch", 0.0254),
    ("foot", 0.3048),
    ("meter", 1.0),
];

fn read(bytes: &[u8], name: &str) -> ShapeFile {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn written(shape: &ShapeFile, format: Format) -> (Vec<u8>, WriteReport) {
    let mut bytes = Vec::new();
    let report = write_bytes(shape, format, &mut bytes).unwrap();
    (bytes, report)
}

/// Tetrahedron with an edge of 1 along each axis.
fn three_mf(unit: Option<&str>) -> Vec<u8> {
    let unit = unit.map_or(String::new(), |unit| format!("unit=\"{unit}\""));
    let vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        .iter()
        .map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"))
        .collect::<Vec<_>>()
        .concat();
    let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        .iter()
        .map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"))
        .collect::<Vec<_>>()
        .concat();
    let model = format!(
        "<model {unit} xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\">\
         <mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object></resources><build>\
         <item objectid=\"1\"/></build></model>"
    );
    let mut out = std::io::Cursor::new(Vec::new());
    let mut zip = zip::ZipWriter::new(&mut out);
    zip.start_file("3D/3dmodel.model", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(model.as_bytes()).unwrap();
    zip.finish().unwrap();
    out.into_inner()
}

fn amf(unit: Option<&str>) -> Vec<u8> {
    let unit = unit.map_or(String::new(), |unit| format!("unit=\"{unit}\""));
    let vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        .iter()
        .map(|[x, y, z]| {
            format!("<vertex><coordinates><x>{x}</x><y>{y}</y><z>{z}</z></coordinates></vertex>")
        })
        .collect::<Vec<_>>()
        .concat();
    format!(
        "<?xml version=\"1.0\"?><amf {unit}><object id=\"0\"><mesh><vertices>{vertices}</vertices><volume>\
         <triangle><v1>0</v1><v2>2</v2><v3>1</v3></triangle><triangle><v1>0</v1><v2>1</v2><v3>3</v3></triangle>\
         </volume></mesh></object></amf>"
    )
    .into_bytes()
}

fn unit_of(shape: &ShapeFile) -> (&str, Option<f64>) {
    let unit = shape.length_unit().unwrap();
    (unit.name(), unit.meters())
}

#[test]
fn units_of_3mf_and_amf_come_back_with_the_same_numbers() {
    for (name, meters) in UNITS {
        for (bytes, format) in [(three_mf(Some(name)), Format::THREE_MF), (amf(Some(name)), Format::AMF)] {
            let shape = read(&bytes, "a");
            assert_eq!((shape.format(), unit_of(&shape)), (Some(format), (name, Some(meters))));
            let (again, report) = written(&shape, format);
            let again = read(&again, "a");
            assert_eq!(unit_of(&again), (name, Some(meters)), "{format}");
            assert_eq!(again.points(), shape.points());
            assert!(report.not_written.is_empty() && report.notes.is_empty(), "{report:?}");
        }
    }
    for bytes in [three_mf(None), amf(None)] {
        assert_eq!(read(&bytes, "a").length_unit(), Some(&LengthUnit::MILLIMETER));
    }
    // AMF spells it so.
    assert_eq!(unit_of(&read(&amf(Some("feet")), "a")), ("foot", Some(0.3048)));
    let (feet, _) = written(&read(&amf(Some("feet")), "a"), Format::AMF);
    assert!(String::from_utf8(feet).unwrap().contains("<amf unit=\"feet\""));
}

#[test]
fn numbers_change_only_where_the_target_has_no_such_unit() {
    for (name, meters) in UNITS {
        let shape = read(&three_mf(Some(name)), "a.3mf");
        // glTF is in meters.
        let (bytes, report) = written(&shape, Format::GLB);
        let glb = read(&bytes, "a.glb");
        let edge = glb.points()[1][0];
        assert!((edge - meters).abs() <= 1e-7 * meters, "{name}: {edge}");
        assert_eq!(report.notes.iter().any(|n| n.contains("to meters")), name != "meter", "{report:?}");
        // AMF has no centimeters.
        let (bytes, report) = written(&shape, Format::AMF);
        let amf = read(&bytes, "a.amf");
        let expected = if name == "centimeter" { ("millimeter", 10.0) } else { (name, 1.0) };
        assert_eq!((unit_of(&amf).0, amf.points()[1][0]), expected);
        assert_eq!(report.notes.len(), usize::from(name == "centimeter"));
        // Formats without a unit keep the numbers, and a note names the unit.
        for format in [Format::STL, Format::OBJ, Format::PLY, Format::OFF] {
            let (bytes, report) = written(&shape, format);
            let again = read(&bytes, &format!("a.{}", format.name()));
            assert_eq!(
                (again.points()[1..].iter().flatten().fold(0.0_f64, |a, &c| a.max(c))),
                1.0,
                "{format}"
            );
            assert_eq!(report.notes.len(), 1, "{format}: {report:?}");
            assert!(
                report.notes[0].contains("no unit of length") && report.notes[0].contains(&name[..1]),
                "{report:?}"
            );
        }
        let (bytes, _) = written(&glb, Format::THREE_MF);
        assert_eq!(unit_of(&read(&bytes, "a.3mf")), ("meter", Some(1.0)));
    }
}

#[test]
fn a_part_of_a_shape_keeps_its_unit() {
    let shape = read(&three_mf(Some("inch")), "a.3mf");
    let part = shape.select_rows(&[true, true, true, false]).unwrap();
    assert_eq!(part.length_unit(), Some(&LengthUnit::INCH));
    let (bytes, _) = written(&part, Format::GLB);
    // The vertex that was left out comes back in the same unit.
    let glb = read(&bytes, "a.glb");
    assert!((glb.points()[3][2] - 0.0254).abs() < 1e-8);
}

#[test]
fn unknown_units_stay_and_are_never_guessed() {
    let shape = read(&amf(Some("fur<long".replace('<', "&lt;").as_str())), "a.amf");
    assert_eq!(unit_of(&shape), ("fur<long", None));
    assert!(shape.notes()[0].contains("is not known"), "{:?}", shape.notes());
    let (again, _) = written(&shape, Format::AMF);
    assert_eq!(unit_of(&read(&again, "a.amf")), ("fur<long", None));
    for format in [Format::THREE_MF, Format::GLB, Format::GLTF] {
        let error = write_bytes(&shape, format, &mut Vec::new()).unwrap_err().to_string();
        assert!(error.contains("unknown unit `fur<long`") && error.contains("state a known unit"), "{error}");
    }
    assert_eq!(written(&shape, Format::OBJ).1.notes.len(), 1);
    let error = read_bytes(three_mf(Some("furlong")), None, &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.contains("must be one of millimeter, micron") && error.contains("furlong"), "{error}");
}

#[test]
fn shapes_without_a_unit_keep_their_numbers() {
    let shape = read(b"v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n", "a.obj");
    assert_eq!(shape.length_unit(), None);
    for (format, unit) in [(Format::THREE_MF, "millimeters"), (Format::GLB, "meters")] {
        let (bytes, report) = written(&shape, format);
        assert_eq!(read(&bytes, "a").points()[1], [2.0, 0.0, 0.0]);
        assert!(report.notes[0].contains(unit), "{report:?}");
    }
    let mut shape = shape;
    shape.set_length_unit(Some(LengthUnit::INCH));
    assert!((read(&written(&shape, Format::GLB).0, "a").points()[1][0] - 0.0508).abs() < 1e-8);
    assert!(written(&read(&written(&shape, Format::PLY).0, "a.ply"), Format::STL).1.notes.is_empty());
}

/// LAS 1.2 or 1.4 of four points, with records of the user `LASF_Projection`.
fn las(minor: u8, records: &[(u16, Vec<u8>)], extended: &[(u16, Vec<u8>)]) -> Vec<u8> {
    let n_header = if minor >= 4 { 375_u16 } else { 227 };
    let mut file = vec![0; usize::from(n_header)];
    let mut put = |at: usize, value: &[u8]| file[at..at + value.len()].copy_from_slice(value);
    let n_records: usize = records.iter().map(|(_, content)| 54 + content.len()).sum();
    let start = usize::from(n_header) + n_records;
    put(0, b"LASF");
    put(24, &[1, minor]);
    put(94, &n_header.to_le_bytes());
    put(96, &(start as u32).to_le_bytes());
    put(100, &(records.len() as u32).to_le_bytes());
    put(105, &20_u16.to_le_bytes());
    put(107, &4_u32.to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &0.001_f64.to_le_bytes());
    }
    if minor >= 4 {
        put(235, &((start + 80) as u64).to_le_bytes());
        put(243, &(extended.len() as u32).to_le_bytes());
        put(247, &4_u64.to_le_bytes());
    }
    for (id, content) in records {
        let mut head = vec![0; 54];
        head[2..17].copy_from_slice(b"LASF_Projection");
        head[18..20].copy_from_slice(&id.to_le_bytes());
        head[20..22].copy_from_slice(&(content.len() as u16).to_le_bytes());
        file.extend(head);
        file.extend(content);
    }
    for k in 0..4_i32 {
        let mut row = vec![0; 20];
        row[..4].copy_from_slice(&(1000 * k).to_le_bytes());
        file.extend(row);
    }
    for (id, content) in extended {
        let mut head = vec![0; 60];
        head[2..17].copy_from_slice(b"LASF_Projection");
        head[18..20].copy_from_slice(&id.to_le_bytes());
        head[20..28].copy_from_slice(&(content.len() as u64).to_le_bytes());
        file.extend(head);
        file.extend(content);
    }
    file
}

fn keys(entries: &[[u16; 4]]) -> Vec<u8> {
    let head = [1, 1, 0, entries.len() as u16];
    std::iter::once(&head).chain(entries).flatten().flat_map(|x| x.to_le_bytes()).collect()
}

const DEGREES: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                       PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]\0";
const FEET: &str = "PROJCS[\"NAD83 / Ohio South (ftUS)\",GEOGCS[\"NAD83\",UNIT[\"degree\",0.01745]],\
                    UNIT[\"US survey foot\",0.3048006096012192]]\0";

#[test]
fn coordinate_systems_of_a_las_are_read_from_every_place() {
    let projected = keys(&[[1024, 0, 1, 1], [3072, 0, 1, 32633], [1026, 34737, 8, 0], [3076, 0, 1, 9001]]);
    let geographic = keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]);
    let text = |text: &str| text.as_bytes().to_vec();
    let meter = Some(LengthUnit::METER);
    let (degrees, map) = (CoordinateSystemKind::Geographic, CoordinateSystemKind::Projected);
    let cases = [
        (las(2, &[(2112, text(DEGREES))], &[]), "WGS 84", degrees, None),
        (las(4, &[], &[(7, vec![0; 9]), (2112, text(DEGREES))]), "WGS 84", degrees, None),
        (las(2, &[(34735, geographic)], &[]), "EPSG:4326", degrees, None),
        (las(2, &[(34735, projected), (34737, text("UTM 33N|"))], &[]), "UTM 33N, EPSG:32633", map, meter),
        (
            las(4, &[(2112, text(FEET))], &[]),
            "NAD83 / Ohio South (ftUS)",
            map,
            Some(LengthUnit::US_SURVEY_FOOT),
        ),
    ];
    for (bytes, name, kind, unit) in cases {
        let shape = read(&bytes, "a.las");
        let system = shape.coordinate_system().unwrap();
        assert_eq!((system.name.as_str(), system.kind), (name, kind));
        assert_eq!((&system.unit, shape.length_unit()), (&unit, unit.as_ref()), "{name}");
        assert_eq!(shape.notes().len(), usize::from(kind == degrees), "{:?}", shape.notes());
        // In its own format nothing is said, and the system stays.
        let (again, report) = written(&shape, Format::LAZ);
        assert!(report.notes.is_empty(), "{report:?}");
        assert_eq!(read(&again, "a.laz").coordinate_system(), shape.coordinate_system());
    }
    for bytes in [
        las(2, &[], &[]),
        las(4, &[(2112, text("PROJCS[\"broken"))], &[]),
        las(2, &[(34735, vec![1; 5])], &[]),
    ] {
        let shape = read(&bytes, "a.las");
        assert_eq!((shape.coordinate_system(), shape.length_unit(), shape.notes().len()), (None, None, 0));
    }
    // Feet become meters where the target is in meters.
    let (glb, report) = written(&read(&las(2, &[(2112, text(FEET))], &[]), "a.las"), Format::GLB);
    assert!((read(&glb, "a.glb").points()[3][0] - 3.0 * 0.304_800_6).abs() < 1e-6);
    assert!(report.notes[0].contains("from US survey feet to meters"), "{report:?}");
}

/// Points 0.5 apart on hills, with that many decimals, at a corner.
fn hills(corner: [f64; 2], decimals: Option<usize>) -> Vec<[f64; 3]> {
    let point = |k: usize| {
        let (x, y) = ((k % 30) as f64, (k / 30) as f64);
        let exact =
            [corner[0] + 0.5 * x + 0.1 * y.sin(), corner[1] + 0.5 * y + 0.1 * x.cos(), (0.2 * x * y).sin()];
        decimals.map_or(exact, |decimals| exact.map(|c| format!("{c:.decimals$}").parse().unwrap()))
    };
    (0..900).map(point).collect()
}

#[test]
fn a_new_las_has_steps_that_keep_the_digits() {
    for corner in [[0.0, 0.0], [500_000.0, 5_400_000.0], [-3.0e5, 20.0]] {
        for (decimals, step) in [(Some(2), "0.001"), (Some(3), "0.001"), (Some(5), "1e-5"), (None, "")] {
            let points = hills(corner, decimals);
            let (bytes, report) = written(&ShapeFile::from_cloud(points.clone()), Format::LAS);
            assert!(report.not_written.is_empty(), "{report:?}");
            assert!(
                report.notes[0].starts_with(&format!("coordinates are stored in steps of {step}")),
                "{report:?}"
            );
            assert_eq!(report.notes[0].contains("rounded"), decimals.is_none(), "{report:?}");
            let limit = if decimals.is_some() { 2e-9 } else { 5e-4 };
            for (p, q) in points.iter().zip(read(&bytes, "a.las").points()) {
                assert!(p.iter().zip(q).all(|(a, b)| (a - b).abs() <= limit), "{p:?} {q:?}");
            }
        }
    }
}

#[test]
fn steps_of_32_bit_floats_are_said_on_reading_and_writing() {
    let file = |north: f64| ShapeFile::from_cloud(hills([0.0, north], None));
    let ply = |north: f64, property: &str| {
        let rows = hills([0.0, north], None)
            .iter()
            .map(|p| format!("{} {} {}\n", p[0] as f32, p[1] as f32, p[2] as f32))
            .collect::<Vec<_>>()
            .concat();
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 900\nproperty {property} x\nproperty {property} y\nproperty {property} z\nend_header\n{rows}"
        );
        read(text.as_bytes(), "a.ply")
    };
    let notes = ply(5.4e6, "float").notes().to_vec();
    assert!(notes.len() == 1 && notes[0].contains("multiples of 0.5, while neighbors are 0.5"), "{notes:?}");
    assert!(ply(100.0, "float").notes().is_empty() && ply(5.4e6, "double").notes().is_empty());
    for format in [Format::OFF_BINARY, Format::GLB] {
        let says = |north: f64| {
            written(&file(north), format).1.notes.iter().any(|n| n.contains("rounded to 32-bit floats"))
        };
        assert!(says(5.4e6) && !says(100.0), "{format}");
    }
    for format in [Format::PLY, Format::OBJ, Format::XYZ, Format::VTP, Format::LAS] {
        let notes = written(&file(5.4e6), format).1.notes;
        assert!(!notes.iter().any(|n| n.contains("32-bit floats")), "{format}: {notes:?}");
    }
    // The number type of the file stays, and rounding what moved is said.
    let mut moved = ply(5.4e6, "float");
    let points = moved.points().iter().map(|p| [p[0], p[1] + 0.2, p[2]]).collect();
    moved.set_points(points).unwrap();
    assert!(written(&moved, Format::PLY).1.notes.iter().any(|n| n.contains("rounded to 32-bit floats")));
}
