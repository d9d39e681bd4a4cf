//! CIFTI files as a whole: parts, voxels, and the same file with other values.

use adwave_io::{
    BrainPlaces, Field, FieldValues, Format, ReadLimits, ShapeFile, ValueType, read_bytes, write_bytes,
};

/// Two surfaces of 4 vertices with 3 and 4 rows, 3 voxels and 1 voxel, in two columns.
fn sample() -> Vec<u8> {
    Format::CIFTI.samples().next().unwrap().1.to_vec()
}

fn read(bytes: Vec<u8>) -> Result<ShapeFile, String> {
    read_bytes(bytes, Some("a.dscalar.nii"), &ReadLimits::default()).map_err(|e| e.to_string())
}

fn written(file: &ShapeFile) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    write_bytes(file, Format::CIFTI, &mut bytes).map(|_| bytes).map_err(|e| e.to_string())
}

/// Index of the first byte of the numbers.
fn start(bytes: &[u8]) -> usize {
    i64::from_le_bytes(bytes[168..176].try_into().unwrap()) as usize
}

/// The sample with another text of the same length in its XML.
fn with_text(from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut bytes = sample();
    let at = bytes.windows(from.len()).position(|text| text == from.as_bytes()).unwrap();
    bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
    bytes
}

/// The file with another text in its XML, and all lengths as they must be.
fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let (old, at) =
        (start(bytes), bytes.windows(from.len()).position(|text| text == from.as_bytes()).unwrap());
    let xml = bytes[552..old].iter().rposition(|b| *b != 0).unwrap() + 553;
    let mut out = bytes[..at].to_vec();
    out.extend(to.as_bytes());
    out.extend(&bytes[at + from.len()..xml]);
    let new = 544 + (out.len() - 544).next_multiple_of(16);
    out.resize(new, 0);
    out[168..176].copy_from_slice(&(new as i64).to_le_bytes());
    out[544..548].copy_from_slice(&((new - 544) as i32).to_le_bytes());
    out.extend(&bytes[old..]);
    out
}

#[test]
fn parts_say_where_each_row_is() {
    let file = read(sample()).unwrap();
    assert_eq!((file.format(), file.n_vertices()), (Some(Format::CIFTI), 11));
    let brain = file.brain().unwrap();
    let names: Vec<(&str, usize)> =
        brain.parts.iter().map(|p| (p.structure.as_str(), p.rows.start)).collect();
    let expected = [("CORTEX_LEFT", 0), ("CORTEX_RIGHT", 3), ("THALAMUS_LEFT", 7), ("THALAMUS_RIGHT", 10)];
    assert_eq!(names, expected);
    let left = BrainPlaces::Surface { n_vertices: 4, vertices: vec![0, 1, 3] };
    assert_eq!(brain.parts[0].places, left);
    // Voxels (1, 2, 3), (2, 2, 3), (1, 3, 3) and (3, 2, 3) in steps of (−2, 2, 2) from (90, −126, −72).
    let volume = brain.volume.as_ref().unwrap();
    assert_eq!((&volume.sizes[..], &volume.spacings[..]), (&[1, 2, 3][..], &[2.0; 3][..]));
    let BrainPlaces::Voxels { voxels } = &brain.parts[2].places else { panic!("no voxels") };
    let positions: Vec<[f64; 3]> = voxels.iter().map(|&voxel| volume.position(voxel as usize)).collect();
    assert_eq!(positions, [[88.0, -122.0, -66.0], [86.0, -122.0, -66.0], [88.0, -120.0, -66.0]]);
    let values = file.field("values").unwrap();
    assert_eq!((values.get(4, 0), values.get(4, 1)), (2.0, 6.0));
    assert!(file.to_shape().unwrap_err().to_string().contains("as a field of it"));
}

#[test]
fn the_same_file_has_the_new_values() {
    let (bytes, mut file) = (sample(), read(sample()).unwrap());
    assert_eq!(written(&file).unwrap(), bytes, "nothing changed");
    let new: Vec<f64> = (0..22).map(|k| f64::from(k) / 8.0).collect();
    file.add_vertex_field(Field::new("values", 2, FieldValues::F64(new.clone()))).unwrap();
    let edited = written(&file).unwrap();
    assert_eq!(edited[..start(&bytes)], bytes[..start(&bytes)]);
    assert_eq!(read(edited).unwrap().field("values").unwrap().to_f64(), new);
    file.add_vertex_field(Field::new("values", 1, FieldValues::F64(vec![0.0; 11]))).unwrap();
    assert!(written(&file).unwrap_err().contains("other columns"));
    file.add_vertex_field(Field::new("values", 2, FieldValues::F64(vec![1e300; 22]))).unwrap();
    assert!(written(&file).unwrap_err().contains("3.4e38"));
    let mut ply = Vec::new();
    assert!(write_bytes(&file, Format::PLY, &mut ply).unwrap_err().to_string().contains("parts of a brain"));
    assert!(written(&ShapeFile::from_cloud(vec![[0.0; 3]])).unwrap_err().contains("values of a brain"));
}

#[test]
fn scaled_integers_become_floats() {
    let mut bytes = sample();
    let start = start(&bytes);
    bytes.truncate(start);
    bytes[12..16].copy_from_slice(&[4, 0, 16, 0]); // 16-bit integers
    bytes[176..184].copy_from_slice(&0.5_f64.to_le_bytes());
    bytes[184..192].copy_from_slice(&3.0_f64.to_le_bytes());
    bytes.extend((0..22_i16).flat_map(i16::to_le_bytes));
    bytes.extend(b"after");
    let file = read(bytes).unwrap();
    assert_eq!(file.field("values").unwrap().values.value_type(), ValueType::F32);
    let again = written(&file).unwrap();
    assert!(again.ends_with(b"after"));
    let values = read(again).unwrap().field("values").unwrap().to_f64();
    assert_eq!(values, (0..22).map(|k| 3.0 + 0.5 * f64::from(k)).collect::<Vec<_>>());
}

#[test]
fn damaged_files_are_refused() {
    let refused = |bytes: Vec<u8>, expected: &str| {
        let error = read(bytes).unwrap_err();
        assert!(error.contains(expected), "{error}");
    };
    refused(with_text("INDEX_TYPE_SCALARS", "INDEX_TYPE_LABELS_"), "neither scalars nor a series");
    refused(with_text("IndexOffset=\"3\"", "IndexOffset=\"4\""), "begin at 4 instead of 3");
    refused(with_text("4,5,6", "4,3,6"), "beyond its volume of [4, 3, 6]");
    refused(with_text("4,5,6", "4,5,x"), "does not say where they are");
    let spread = replaced(&replaced(&sample(), "4,5,6", "9,9,9000000"), "3 2 3\n", "3 2 8000000\n");
    refused(spread, "must lie close together");
    let empty = replaced(
        &sample(),
        "IndexCount=\"3\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\"",
        "IndexCount=\"0\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\"",
    );
    let empty = replaced(&empty, "1 2 3\n2 2 3\n1 3 3\n", "");
    let empty = replaced(
        &empty,
        "IndexCount=\"1\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\"",
        "IndexCount=\"0\" ModelType=\"CIFTI_MODEL_TYPE_VOXELS\"",
    );
    refused(replaced(&empty, "3 2 3\n", ""), "structures without voxels");
    refused(with_text("-2 0 0 90", "-2 0 0 xx"), "does not say where they are");
    refused(with_text("1 3 3\n", "1 3 \n\n"), "another number of voxels");
}

#[test]
fn no_cut_or_changed_byte_breaks_the_reader() {
    let bytes = sample();
    for end in 0..bytes.len() {
        assert!(read(bytes[..end].to_vec()).is_err(), "{end}");
    }
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 0x15;
        let _ = read(changed).map(|file| written(&file));
    }
}
