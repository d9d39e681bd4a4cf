//! Tests that write followed by read is the identity except for reported losses, for every format and every pair of
//! formats; and that damaged bytes give an error of one line, never a panic.

use adwave::shape::Polygons;
use adwave_io::{
    CoordinatePrecision, Edges, Field, FieldValues, Format, ReadLimits, ShapeFile, WriteReport, read_bytes,
    write_bytes,
};
use proptest::collection::vec;
use proptest::prelude::*;

fn both_ways() -> Vec<Format> {
    // Coordinates of LAS are whole numbers of steps: `las_write.rs`.
    let is_las = |f: &Format| matches!(*f, Format::LAS | Format::LAZ);
    // Maps of the sky hold pixels that were read: `maps.rs`.
    let is_map = |f: &Format| *f == Format::FITS;
    let is_other =
        |f: &Format| f.holds_graphs() || f.holds_grids() || f.holds_brains() || is_las(f) || is_map(f);
    Format::all().filter(|f| f.can_read() && f.can_write() && !is_other(f)).collect()
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e3..1e3_f64,
        2 => any::<f32>().prop_map(f64::from),
        2 => any::<f64>(),
        1 => Just(0.1),
        1 => Just(-0.0),
    ]
}

fn values(n: usize) -> impl Strategy<Value = FieldValues> {
    prop_oneof![
        vec(any::<u8>(), n).prop_map(FieldValues::U8),
        vec(any::<i8>(), n).prop_map(FieldValues::I8),
        vec(any::<u16>(), n).prop_map(FieldValues::U16),
        vec(any::<i16>(), n).prop_map(FieldValues::I16),
        vec(any::<u32>(), n).prop_map(FieldValues::U32),
        vec(any::<i32>(), n).prop_map(FieldValues::I32),
        vec(any::<u64>(), n).prop_map(FieldValues::U64),
        vec(any::<i64>(), n).prop_map(FieldValues::I64),
        vec(any::<f32>(), n).prop_map(FieldValues::F32),
        vec(number(), n).prop_map(FieldValues::F64),
    ]
}

fn field(n: usize) -> impl Strategy<Value = Field> {
    const NAMES: [(&str, usize); 8] = [
        ("normal", 3),
        ("color", 3),
        ("color", 4),
        ("texcoord", 2),
        ("texcoord", 3),
        ("quality", 1),
        ("flow", 3),
        ("hks", 5),
    ];
    (0..NAMES.len()).prop_flat_map(move |i| {
        let (name, n_channels) = NAMES[i];
        values(n * n_channels).prop_map(move |values| Field::new(name, n_channels, values))
    })
}

fn shape() -> impl Strategy<Value = ShapeFile> {
    (1..12_usize)
        .prop_flat_map(|n| {
            let faces = vec(vec(0..n as u32, 3..6), 0..10);
            let face_fields = faces.prop_flat_map(|faces| {
                let n_faces = faces.len();
                (Just(faces), vec(field(n_faces), 0..2))
            });
            let edges = vec(proptest::array::uniform2(0..n as u32), 0..4);
            (
                vec(proptest::array::uniform3(number()), n),
                face_fields,
                vec(field(n), 0..4),
                any::<bool>(),
                edges,
            )
        })
        .prop_map(|(mut points, (faces, face_fields), fields, is_single, pairs)| {
            if is_single {
                for p in &mut points {
                    *p = p.map(|x| f64::from(x as f32));
                }
            }
            let faces: Polygons = faces.iter().map(Vec::as_slice).collect();
            let is_mesh = !faces.is_empty();
            let mut shape = ShapeFile::from_mesh(points, faces);
            if !pairs.is_empty() {
                let mut whole =
                    ShapeFile::from_graph(shape.n_vertices(), Edges { pairs, ..Edges::default() });
                whole.set_points(shape.points().to_vec()).unwrap();
                if !is_mesh {
                    shape = whole;
                }
            }
            shape.set_precision(if is_single { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 });
            for field in fields {
                shape.add_vertex_field(field).unwrap();
            }
            if is_mesh {
                for field in face_fields {
                    shape.add_face_field(field).unwrap();
                }
            }
            shape
        })
}

fn is_gltf(format: Format) -> bool {
    matches!(format, Format::GLB | Format::GLTF)
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn held<'a>(fields: &'a [Field], report: &'a WriteReport, kind: &'a str) -> impl Iterator<Item = &'a Field> {
    fields.iter().filter(move |f| !report.not_written.contains(&format!("{kind} field `{}`", f.name)))
}

/// True if the report lists a part as rounded to 32-bit floats.
fn is_rounded(report: &WriteReport, what: &str) -> bool {
    report.not_written.contains(&format!("digits of {what} beyond 32-bit floats"))
}

/// A number unchanged, or rounded to a 32-bit float.
fn stored(x: f64, is_rounded: bool) -> f64 {
    if is_rounded { f64::from(x as f32) } else { x }
}

fn check_fields<'a>(
    what: &str,
    held: impl Iterator<Item = &'a Field>,
    read: &[Field],
    scale: f64,
    report: &WriteReport,
) {
    for field in held {
        let again = read.iter().find(|f| f.name == field.name);
        let again = again.unwrap_or_else(|| panic!("{what}: `{}` is gone", field.name));
        assert_eq!(again.n_channels, field.n_channels, "{what}: {}", field.name);
        for (x, y) in field.to_f64().iter().zip(again.to_f64()) {
            // glTF has linear intensities, of which 32-bit floats keep sixteen bits of a color, as a fraction.
            let is_light =
                what.starts_with("gl") && field.name == "color" && matches!(field.n_channels, 3 | 4);
            let scale = match field.values {
                FieldValues::U8(_) if field.name == "color" => scale,
                FieldValues::U16(_) if is_light => f64::from(u16::MAX),
                _ => 1.0,
            };
            let x = stored(x / scale, is_rounded(report, &format!("`{}`", field.name)));
            // The v of a glTF points down: 1 - v is rounded in both directions, by half a unit in the last place each
            // time.
            let is_flipped = what.starts_with("gl")
                && field.name == "texcoord"
                && (x - y).abs() <= f64::from(f32::EPSILON) * x.abs().max(1.0);
            let is_lit = is_light && (x - y).abs() <= 1e-6;
            // Intensities as floats become bytes where readers expect these.
            let is_float = matches!(field.values, FieldValues::F32(_) | FieldValues::F64(_));
            let is_byte = field.name == "color" && is_float && matches!(again.values, FieldValues::U8(_));
            let is_lit = is_lit || is_byte && (255.0 * x - y).abs() <= 0.5001;
            assert!(same(x, y) || is_flipped || is_lit, "{what}: `{}` {x} became {y}", field.name);
        }
    }
}

/// The part of a shape whose vertices have positions; `None` if all have one, none has one, or a face or an edge uses one
/// that has none, in a file that keeps faces or edges as `again` does.
fn without_missing(shape: &ShapeFile, again: &ShapeFile) -> Option<ShapeFile> {
    let is_there: Vec<bool> = shape.points().iter().map(|p| p.iter().all(|x| x.is_finite())).collect();
    let is_missing = |v: &u32| !is_there[*v as usize];
    let (faces, edges) = (shape.faces().corners(), shape.edges().pairs.as_flattened());
    let uses_missing = (!again.faces().is_empty() && faces.iter().any(is_missing))
        || (!again.edges().pairs.is_empty() && edges.iter().any(is_missing));
    let is_partial = is_there.contains(&true) && is_there.contains(&false);
    (is_partial && !uses_missing).then(|| shape.select_rows(&is_there).unwrap())
}

/// Writes, reads, and checks everything except reported losses; returns the shape that was read.
fn there_and_back(shape: &ShapeFile, format: Format) -> Option<ShapeFile> {
    let mut bytes = Vec::new();
    let report = match write_bytes(shape, format, &mut bytes) {
        Ok(report) => report,
        Err(error) => {
            let stl = matches!(format, Format::STL | Format::STL_ASCII);
            let fields = shape.vertex_fields().iter().flat_map(Field::to_f64);
            let is_large = |x: f64| x.is_finite() && (x as f32).is_infinite();
            let beyond = shape.points().as_flattened().iter().copied().chain(fields).any(is_large);
            let is_single =
                matches!(format, Format::GIFTI | Format::STL | Format::FREESURFER | Format::OFF_BINARY)
                    || is_gltf(format);
            let is_expected = (stl && shape.faces().is_empty()) || (is_single && beyond);
            assert!(is_expected, "{format}: {error}");
            return None;
        }
    };
    // Without a name: the content alone must identify the format, except for text of plain rows.
    let again = read_bytes(bytes.clone(), None, &ReadLimits::default())
        .unwrap_or_else(|e| panic!("{format}: {e}\n{}", String::from_utf8_lossy(&bytes)));
    let what = format.to_string();
    let left = |name: &str| report.not_written.iter().any(|l| l == name);
    if matches!(format, Format::STL | Format::STL_ASCII) {
        let triangles: usize = shape.faces().iter().map(|f| f.len() - 2).sum();
        assert_eq!(again.faces().len(), triangles);
        return Some(again);
    }
    // Points without a position that no face or edge uses are left out on reading, and come back when they are written.
    let kept = without_missing(shape, &again);
    if let Some(kept) = &kept {
        let rows = again.file_rows().map(|rows| rows.vertex_rows().to_vec());
        assert_eq!(rows, kept.file_rows().map(|rows| rows.vertex_rows().to_vec()), "{what}");
    }
    let shape = kept.as_ref().unwrap_or(shape);
    assert_eq!(again.n_vertices(), shape.n_vertices(), "{what}");
    if report.notes.iter().any(|note| note.starts_with("coordinates are converted")) {
        return Some(again);
    }
    let extent =
        shape.points().as_flattened().iter().filter(|x| x.is_finite()).fold(0.0, |a: f64, x| a.max(x.abs()));
    for (x, y) in shape.points().as_flattened().iter().zip(again.points().as_flattened()) {
        let is_rounded = is_rounded(&report, "coordinates");
        let x = stored(
            *x,
            matches!(format, Format::GIFTI | Format::FREESURFER | Format::OFF_BINARY) && is_rounded,
        );
        // Far from the origin a glTF has them about their center, with more digits than 32-bit floats have there.
        let is_single = f64::from(x as f32) == *y;
        let near = is_rounded && (is_single || (x - y).abs() <= 1e-7 * x.abs().max(extent));
        // A node that shifts makes 0 of -0.
        let is_near = is_gltf(format) && (near || x == *y);
        assert!(same(x, *y) || is_near, "{what}: {x} became {y}");
    }
    if left("the order of faces (triangles come first)") {
        let by_size = |n: usize| shape.faces().iter().filter(move |f| f.len() == n);
        let is_split = left("polygons (as triangles)");
        assert!(is_split || again.faces().iter().eq(by_size(3).chain(by_size(4))), "{what}");
        return Some(again);
    }
    if !left("faces") && !left("polygons (as triangles)") {
        assert_eq!(again.faces(), shape.faces(), "{what}");
    }
    if !left("edges") {
        assert_eq!(again.edges().pairs, shape.edges().pairs, "{what}");
    }
    let scale = if matches!(format, Format::OBJ | Format::AMF) { 255.0 } else { 1.0 };
    check_fields(
        &what,
        held(shape.vertex_fields(), &report, "vertex"),
        again.vertex_fields(),
        scale,
        &report,
    );
    check_fields(&what, held(shape.face_fields(), &report, "face"), again.face_fields(), scale, &report);
    Some(again)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_is_lost_unreported(shape in shape()) {
        for first in both_ways() {
            let Some(read) = there_and_back(&shape, first) else { continue };
            for second in both_ways() {
                there_and_back(&read, second);
            }
        }
    }

    #[test]
    fn an_added_field_joins_the_original(shape in shape(), extra in any::<u16>()) {
        for format in both_ways().into_iter().filter(|f| !matches!(*f, Format::STL | Format::STL_ASCII)) {
            let Some(mut read) = there_and_back(&shape, format) else { continue };
            let n = read.n_vertices();
            read.add_vertex_field(Field::new("added", 1, FieldValues::U16(vec![extra; n]))).unwrap();
            let own = read.format().unwrap();
            there_and_back(&read, own);
            // And one that replaces the original field.
            read.add_vertex_field(Field::new("color", 3, FieldValues::U8(vec![7; 3 * n]))).unwrap();
            there_and_back(&read, own);
        }
    }

    #[test]
    fn graphs_come_back(n in 1..20_u32, seed in vec((any::<u32>(), any::<u32>(), number()), 1..20)) {
        for direction in [adwave_io::Direction::Both, adwave_io::Direction::RowToColumn] {
            let pairs: Vec<[u32; 2]> = seed
                .iter()
                .map(|&(a, b, _)| [a % n, b % n])
                .map(|[a, b]| if direction == adwave_io::Direction::Both { [a.max(b), a.min(b)] } else { [a, b] })
                .collect();
            let weights = seed.iter().map(|s| if s.2.is_nan() { 1.0 } else { s.2 }).collect();
            let edges = Edges { pairs, weights, direction };
            let graph = ShapeFile::from_graph(n as usize, edges.clone());
            let mut bytes = Vec::new();
            write_bytes(&graph, Format::MTX, &mut bytes).unwrap();
            let read = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
            prop_assert_eq!(read.n_vertices(), n as usize);
            prop_assert_eq!(read.edges(), &edges);
            for format in Format::all().filter(|f| f.holds_graphs()) {
                let mut bytes = Vec::new();
                let report = write_bytes(&graph, format, &mut bytes).unwrap();
                let hint = format!("a.{format}");
                let read = read_bytes(bytes, Some(&hint), &ReadLimits::default()).unwrap();
                prop_assert_eq!(read.n_vertices(), n as usize);
                prop_assert_eq!(&read.edges().pairs, &edges.pairs);
                // If directions are lost, each edge has half of its weight in both directions.
                let is_halved = report.not_written.iter().any(|w| w.starts_with("directions of edges"));
                prop_assert_eq!(read.edges().direction == direction, !is_halved);
                let part = if is_halved { 0.5 } else { 1.0 };
                for (x, y) in edges.weights.iter().zip(&read.edges().weights) {
                    prop_assert_eq!(part * x, *y);
                }
            }
        }
    }

    #[test]
    fn broken_bytes_give_one_line(shape in shape(), flips in vec((any::<usize>(), any::<u8>()), 1..6)) {
        for format in both_ways() {
            let mut bytes = Vec::new();
            if write_bytes(&shape, format, &mut bytes).is_err() {
                continue;
            }
            for end in 0..bytes.len() {
                survives(bytes[..end].to_vec(), format);
            }
            for &(at, byte) in &flips {
                let at = at % bytes.len();
                bytes[at] = byte;
                survives(bytes.clone(), format);
            }
        }
    }

    #[test]
    fn noise_gives_one_line(noise in vec(any::<u8>(), 0..400)) {
        const HEADS: [&[u8]; 8] = [
            b"",
            b"ply\nformat binary_big_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n",
            b"# .PCD v0.7\nFIELDS x y z\nPOINTS 4000000000\nDATA binary_compressed\n",
            b"LASF",
            b"OFF\n4000000000 4000000000 0\n",
            b"%%MatrixMarket matrix coordinate real general\n4000000000 4000000000 4000000000\n",
            b"v 1 2 3\n",
            b"solid ",
        ];
        for head in HEADS {
            survives([head, noise.as_slice()].concat(), Format::OBJ);
        }
    }
}

fn survives(bytes: Vec<u8>, format: Format) {
    let hint = format!("a.{}", format.extensions().first().unwrap_or(&"txt"));
    if let Err(error) = read_bytes(bytes, Some(&hint), &ReadLimits::default()) {
        let message = error.to_string();
        assert!(!message.contains('\n') && !message.contains('\r'), "{message:?}");
    }
}
