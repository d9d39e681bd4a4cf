//! Tests of FreeSurfer surfaces, and of values at their vertices in files of FreeSurfer and CIFTI.

use adwave::shape::Polygons;
use adwave_io::{
    Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, SignalSource, named_signal,
    parse_surface_values, read_bytes, write_bytes,
};

const CREATOR: &[u8] = b"created by someone on Mon Jan 1\n\n";
const TAIL: &[u8] = b"\0\0\0\x02\0\0\0\0\0\0\0\x14valid = 1  # volume info valid\n";

fn read(bytes: &[u8], name: Option<&str>) -> Result<ShapeFile, ReadError> {
    read_bytes(bytes.to_vec(), name, &ReadLimits::default())
}

fn values(bytes: &[u8], structure: Option<&str>, n: usize) -> Result<Vec<Field>, ReadError> {
    parse_surface_values(bytes, structure, n, &ReadLimits::default())
}

fn ints(numbers: &[i32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_be_bytes()).collect()
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_be_bytes()).collect()
}

fn surface() -> Vec<u8> {
    let points = floats(&[0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 1.0, -0.25, 1.0, 1.0, 0.1]);
    [b"\xff\xff\xfe", CREATOR, &ints(&[4, 2]), &points, &ints(&[0, 1, 2, 1, 3, 2]), TAIL].concat()
}

#[test]
fn a_name_states_the_hemisphere_in_every_format() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (name, structure) in [
        ("lh.c.obj", Some("CortexLeft")),
        ("sub/rh.pial.obj", Some("CortexRight")),
        ("flh.obj", None),
        ("lh.d/white.obj", None),
        ("lh", None),
    ] {
        assert_eq!(read(obj, Some(name)).unwrap().structure(), structure, "{name}");
    }
}

#[test]
fn a_surface_keeps_its_creator_and_its_volume() {
    let bytes = surface();
    let mut shape = read(&bytes, Some("subject/surf/lh.white")).unwrap();
    assert_eq!((shape.format(), shape.structure()), (Some(Format::FREESURFER), Some("CortexLeft")));
    assert_eq!(shape.points()[3], [1.0, 1.0, f64::from(0.1_f32)]);
    assert_eq!(shape.faces().triangles(), Some([[0, 1, 2], [1, 3, 2]].as_slice()));
    let mut again = Vec::new();
    assert_eq!(write_bytes(&shape, Format::FREESURFER, &mut again).unwrap().not_written, [""; 0]);
    assert_eq!(again, bytes);
    let mut points = shape.points().to_vec();
    points[0] = [7.0, 8.0, 9.0];
    shape.set_points(points).unwrap();
    let mut moved = Vec::new();
    write_bytes(&shape, Format::FREESURFER, &mut moved).unwrap();
    let at = 3 + CREATOR.len() + 8;
    assert_eq!(moved[at..at + 12], floats(&[7.0, 8.0, 9.0]));
    assert_eq!((&moved[..at], &moved[at + 12..]), (&bytes[..at], &bytes[at + 12..]));
    // Another format reports its losses.
    let report = write_bytes(&shape, Format::PLY, &mut Vec::new()).unwrap();
    assert_eq!(report.not_written, ["the source volume of the surface"]);
}

#[test]
fn a_new_surface_has_what_the_format_holds() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1e-9]];
    let square: Polygons = std::iter::once(&[0_u32, 1, 2, 3][..]).collect();
    let mut shape = ShapeFile::from_mesh(points, square);
    shape.add_vertex_field(Field::new("heat", 1, FieldValues::U8(vec![1; 4]))).unwrap();
    let mut bytes = Vec::new();
    let report = write_bytes(&shape, Format::FREESURFER, &mut bytes).unwrap();
    assert_eq!(
        report.not_written,
        ["digits of coordinates beyond 32-bit floats", "vertex field `heat`", "polygons (as triangles)"]
    );
    assert_eq!(read(&bytes, None).unwrap().faces().len(), 2);
}

#[test]
fn quadrangles_are_split_as_freesurfer_does() {
    let counts = [0, 0, 4, 0, 0, 1];
    let quad = |first: [u8; 4]| first.iter().flat_map(|&v| [0, 0, v]).collect::<Vec<u8>>();
    let hundredths: Vec<u8> = (0..12_i16).flat_map(|i| (50 * i - 300).to_be_bytes()).collect();
    let old = [b"\xff\xff\xff", &counts[..], &hundredths, &quad([0, 1, 2, 3])].concat();
    let shape = read(&old, Some("rh.smoothwm")).unwrap();
    assert_eq!((shape.points()[0], shape.points()[3]), ([-3.0, -2.5, -2.0], [1.5, 2.0, 2.5]));
    assert_eq!(shape.faces().triangles(), Some([[0, 1, 3], [2, 3, 1]].as_slice()));
    assert_eq!(shape.structure(), Some("CortexRight"));
    let places: Vec<f32> = (0..12_u8).map(f32::from).collect();
    let new = [b"\xff\xff\xfd", &counts[..], &floats(&places), &quad([1, 2, 3, 0])].concat();
    let shape = read(&new, None).unwrap();
    assert_eq!(
        (shape.points()[3], shape.faces().triangles()),
        ([9.0, 10.0, 11.0], Some([[1, 2, 3], [1, 3, 0]].as_slice()))
    );
    for bytes in [old, new] {
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end], None).is_err(), "{end}");
        }
    }
}

#[test]
fn cut_and_changed_bytes_are_errors() {
    let bytes = surface();
    for end in 0..bytes.len() - TAIL.len() {
        let error = read(&bytes[..end], Some("lh.pial")).unwrap_err().to_string();
        assert!(!error.contains('\n'), "{error}");
    }
    let mut wrong = bytes.clone();
    let corner = bytes.len() - TAIL.len() - 1;
    wrong[corner] = 9;
    let error = read(&wrong, None).unwrap_err().to_string();
    assert!(error.contains("face 1 names vertex 9, but there are 4"), "{error}");
    for at in 0..bytes.len() {
        for byte in [0, 1, 0x7f, 0xff] {
            let mut wrong = bytes.clone();
            wrong[at] = byte;
            if let Err(error) = read(&wrong, None) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
}

fn curv() -> Vec<u8> {
    [b"\xff\xff\xff".to_vec(), ints(&[4, 2, 1]), floats(&[0.5, -1.0, 2.5, f32::NAN])].concat()
}

/// Five vertices; the last two have no label and a label missing in the table.
fn annotation(is_new: bool) -> Vec<u8> {
    let pairs = ints(&[5, 0, 0x0003_0201, 1, 0x0006_0504, 2, 0x0003_0201, 3, 0, 4, 77]);
    let entry =
        |name: &[u8], color: [i32; 4]| [ints(&[name.len() as i32]), name.to_vec(), ints(&color)].concat();
    let (a, b) = (entry(b"a\0", [1, 2, 3, 0]), entry(b"bb\0", [4, 5, 6, 0]));
    let file = [ints(&[4]), b"ctab".to_vec()].concat();
    let table = if is_new {
        [ints(&[1, -2, 9]), file, ints(&[2]), ints(&[3]), a, ints(&[8]), b].concat()
    } else {
        [ints(&[1, 2]), file, a, b].concat()
    };
    [pairs, table].concat()
}

fn mgh() -> Vec<u8> {
    let mut bytes = ints(&[1, 3, 1, 1, 2, 4]);
    bytes.resize(284, 0);
    bytes.extend([1_i16, 2, 3, -4, -5, -6].iter().flat_map(|x| x.to_be_bytes()));
    bytes
}

#[test]
fn values_of_freesurfer() {
    let field = &values(&curv(), None, 4).unwrap()[0];
    assert_eq!((field.get(1, 0), field.get(3, 0).is_nan()), (-1.0, true));
    assert_eq!(
        values(&annotation(true), None, 5).unwrap()[0].values,
        FieldValues::I32(vec![3, 8, 3, -1, -1])
    );
    assert_eq!(
        values(&annotation(false), None, 5).unwrap()[0].values,
        FieldValues::I32(vec![0, 1, 0, -1, -1])
    );
    let overlay = &values(&mgh(), None, 3).unwrap()[0];
    assert_eq!((overlay.n_channels, &overlay.values), (2, &FieldValues::I16(vec![1, -4, 2, -5, 3, -6])));
    for bytes in [curv(), annotation(true), annotation(false), mgh()] {
        for end in 0..bytes.len() {
            // Without its table an annotation has colors as numbers.
            let is_whole = values(&bytes[..end], None, 4).is_ok();
            assert!(!is_whole || end == 44, "{end} of {}", bytes.len());
        }
    }
    // They are not shapes, and the message tells what to do.
    for bytes in [curv(), mgh()] {
        let error = read(&bytes, Some("lh.curv")).unwrap_err().to_string();
        assert!(error.contains("as a field of a surface"), "{error}");
    }
}

/// Dense values in two columns: three vertices of a left side of 4, two of a right side of 5.
fn cifti(is_big: bool) -> Vec<u8> {
    let model = |side: &str, first: usize, n: usize, list: &str| {
        let count = list.split(' ').count();
        format!(
            "<BrainModel IndexOffset=\"{first}\" IndexCount=\"{count}\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" \
             BrainStructure=\"CIFTI_STRUCTURE_CORTEX_{side}\" SurfaceNumberOfVertices=\"{n}\">\
             <VertexIndices>{list}</VertexIndices></BrainModel>"
        )
    };
    let xml = format!(
        "<?xml version=\"1.0\"?><CIFTI Version=\"2\"><Matrix><MatrixIndicesMap AppliesToMatrixDimension=\"0\" \
         IndicesMapToDataType=\"CIFTI_INDEX_TYPE_SCALARS\"><NamedMap><MapName>thick</MapName></NamedMap>\
         <NamedMap><MapName>curv</MapName></NamedMap></MatrixIndicesMap><MatrixIndicesMap \
         AppliesToMatrixDimension=\"1\" IndicesMapToDataType=\"CIFTI_INDEX_TYPE_BRAIN_MODELS\">{}{}\
         </MatrixIndicesMap></Matrix></CIFTI>",
        model("LEFT", 0, 4, "0 2 3"),
        model("RIGHT", 3, 5, "1 4")
    );
    let i16 = |n: i16| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let i32 = |n: i32| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let i64 = |n: i64| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let size = (xml.len() + 8).next_multiple_of(16);
    let start = 544 + size;
    let mut bytes = vec![0; start];
    bytes[..4].copy_from_slice(&i32(540));
    bytes[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
    bytes[12..14].copy_from_slice(&i16(16));
    for (k, n) in [6, 1, 1, 1, 1, 2, 5, 1].into_iter().enumerate() {
        bytes[16 + 8 * k..24 + 8 * k].copy_from_slice(&i64(n));
    }
    bytes[168..176].copy_from_slice(&i64(start as i64));
    bytes[540] = 1;
    bytes[544..548].copy_from_slice(&i32(size as i32));
    bytes[548..552].copy_from_slice(&i32(32));
    bytes[552..552 + xml.len()].copy_from_slice(xml.as_bytes());
    for x in 0..10_u8 {
        let x = f32::from(x);
        bytes.extend(if is_big { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    bytes
}

#[test]
fn dense_values_lie_at_the_vertices_of_the_surface() {
    for is_big in [false, true] {
        let bytes = cifti(is_big);
        let left = values(&bytes, Some("CortexLeft"), 4).unwrap();
        assert_eq!(left.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["thick", "curv"]);
        let FieldValues::F32(curv) = &left[1].values else { panic!("another type") };
        assert_eq!((curv[0], curv[2], curv[3], curv[1].is_nan()), (1.0, 3.0, 5.0, true));
        // Without a name the number of vertices decides.
        assert_eq!(values(&bytes, None, 5).unwrap()[0].get(4, 0), 8.0);
        for end in 0..bytes.len() {
            assert!(values(&bytes[..end], Some("CortexLeft"), 4).is_err(), "{end}");
        }
    }
    let error = |structure, n| values(&cifti(false), structure, n).unwrap_err().to_string();
    assert!(error(Some("CortexLeft"), 5).contains("for 4 vertices of CORTEX_LEFT, but the surface has 5"));
    assert!(error(Some("Cerebellum"), 4).contains("has values for CORTEX_LEFT, CORTEX_RIGHT"));
    assert!(error(None, 6).contains("not for a surface of 6 vertices"));
}

#[test]
fn fields_are_named_by_files_without_endings() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("lh.thickness"), curv()).unwrap();
    std::fs::write(path("maps.dscalar.nii"), cifti(false)).unwrap();
    std::fs::write(path("lh.notes"), b"nothing of the kind").unwrap();
    let file = read(&surface(), Some("lh.white")).unwrap();
    let shape = file.to_shape().unwrap();
    let source = SignalSource { file: &file, shape: &shape, name: "lh.white" };
    let named = |name: String| named_signal(source, &name, None);
    assert_eq!(named(path("lh.thickness")).unwrap().values[2], 2.5);
    assert_eq!(named(format!("{}:curv", path("maps.dscalar.nii"))).unwrap().values[3], 5.0);
    let error = named(path("lh.notes")).unwrap_err().to_string();
    assert!(error.contains("has no supported values"), "{error}");
}
