//! Files of values on surfaces, written anew and into copies of files that exist.

use adwave_io::{
    CiftiColumns, Field, FieldValues, LabelEntry, LabelTable, ReadLimits, read_gifti_fields,
    read_surface_values, rewrite_values, write_annotation, write_cifti_fields, write_gifti_fields,
};
use std::fs;
use std::path::Path;

fn values(n: usize, n_channels: usize) -> Field {
    let value = |i: usize| if i / n_channels == 3 { f64::NAN } else { (i as f64).sin() };
    Field::new("bold", n_channels, FieldValues::F64((0..n * n_channels).map(value).collect()))
}

/// Writes a copy with other values; false if they do not fit.
fn rewrite(source: &Path, structure: Option<&str>, field: &Field, path: &Path) -> bool {
    let Some(bytes) = rewrite_values(source, structure, field, path).unwrap() else { return false };
    fs::write(path, bytes).unwrap();
    true
}

fn read(path: &Path, structure: &str, n: usize) -> Vec<Field> {
    read_surface_values(path, Some(structure), n, &ReadLimits::default()).unwrap()
}

#[test]
fn a_new_cifti_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let (scalars, series) = (folder.path().join("a.dscalar.nii"), folder.path().join("a.dtseries.nii"));
    let field = values(40, 6);
    write_cifti_fields(&scalars, std::slice::from_ref(&field), "CortexRight", CiftiColumns::Scalars).unwrap();
    write_cifti_fields(&series, std::slice::from_ref(&field), "CortexRight", CiftiColumns::Series).unwrap();
    let maps = read(&scalars, "CortexRight", 40);
    let names: Vec<&str> = maps.iter().map(|field| field.name.as_str()).collect();
    assert_eq!(names, ["bold_0", "bold_1", "bold_2", "bold_3", "bold_4", "bold_5"]);
    let samples = &read(&series, "CortexRight", 40)[0];
    assert_eq!(samples.n_channels, 6);
    for i in 0..40 {
        for (c, map) in maps.iter().enumerate() {
            let expected = field.get(i, c);
            for found in [map.get(i, 0), samples.get(i, c)] {
                assert!(
                    found == f64::from(expected as f32) || (found.is_nan() && expected.is_nan()),
                    "{i} {c}"
                );
            }
        }
    }
    let error = read_surface_values(&scalars, Some("CortexLeft"), 40, &ReadLimits::default()).unwrap_err();
    assert!(error.to_string().contains("CORTEX_RIGHT"), "{error}");
    // Vertex 3 has no value and no row.
    let text = String::from_utf8_lossy(&fs::read(&scalars).unwrap()).into_owned();
    assert!(text.contains("IndexCount=\"39\"") && text.contains("<VertexIndices>0 1 2 4 5"));
}

#[test]
fn values_that_no_file_can_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dscalar.nii");
    let write = |values: Vec<f64>| {
        let field = Field::new("f", 1, FieldValues::F64(values));
        write_cifti_fields(&path, &[field], "CortexLeft", CiftiColumns::Scalars).unwrap_err().to_string()
    };
    assert!(write(vec![f64::NAN; 4]).contains("NaN everywhere"));
    assert!(write(vec![1e300, 0.0]).contains("32-bit"));
    assert!(!path.exists());
}

#[test]
fn other_structures_of_a_cifti_stay() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (folder.path().join("old.dtseries.nii"), folder.path().join("new.dtseries.nii"));
    let field = values(40, 5);
    write_cifti_fields(&old, std::slice::from_ref(&field), "CortexLeft", CiftiColumns::Series).unwrap();
    let other = Field::new("bold", 5, FieldValues::F64((0..200).map(f64::from).collect()));
    assert!(rewrite(&old, Some("CortexLeft"), &other, &new));
    let found = &read(&new, "CortexLeft", 40)[0];
    assert_eq!((found.get(0, 4), found.get(39, 0)), (4.0, 195.0));
    assert!(found.get(3, 0).is_nan(), "a vertex without a row has none afterwards either");
    let (before, after) = (fs::read(&old).unwrap(), fs::read(&new).unwrap());
    let n_head = before.len() - 39 * 5 * 4;
    assert_eq!((before.len(), &before[..n_head]), (after.len(), &after[..n_head]));
    // Another number of columns, another structure, another kind of file.
    assert!(!rewrite(&old, Some("CortexLeft"), &values(40, 4), &new));
    assert!(!rewrite(&old, Some("CortexRight"), &other, &new));
    assert!(!rewrite(&old, Some("CortexLeft"), &other, &folder.path().join("a.dscalar.nii")));
    assert!(!rewrite(&old, Some("CortexLeft"), &other, &folder.path().join("a.func.gii")));
}

/// CIFTI of two hemispheres of four vertices with columns as the XML says, in 16-bit integers that stand for
/// 0.5 x + 1, or in 32-bit floats. The header states no intent, as files of most scripts.
fn two_hemispheres(columns: &str, n_columns: usize, is_scaled: bool) -> Vec<u8> {
    let model = |structure: &str, first: usize| {
        format!(
            "<BrainModel IndexOffset=\"{first}\" IndexCount=\"4\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" \
             BrainStructure=\"CIFTI_STRUCTURE_CORTEX_{structure}\" SurfaceNumberOfVertices=\"4\">\
             <VertexIndices>0 1 2 3</VertexIndices></BrainModel>"
        )
    };
    let mut xml = format!(
        "<CIFTI Version=\"2\"><Matrix><MatrixIndicesMap AppliesToMatrixDimension=\"0\" {columns}</MatrixIndicesMap>\
         <MatrixIndicesMap AppliesToMatrixDimension=\"1\" \
         IndicesMapToDataType=\"CIFTI_INDEX_TYPE_BRAIN_MODELS\">{}{}</MatrixIndicesMap></Matrix></CIFTI>",
        model("LEFT", 0),
        model("RIGHT", 4)
    );
    xml += &" ".repeat(16 - (8 + xml.len()) % 16);
    let mut bytes = vec![0_u8; 540];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &540_i32.to_le_bytes());
    put(4, b"n+2\0\r\n\x1a\n");
    let (code, bits) = if is_scaled { (4_i16, 16_i16) } else { (16, 32) };
    put(12, &code.to_le_bytes());
    put(14, &bits.to_le_bytes());
    for (k, size) in [6, 1, 1, 1, 1, n_columns as i64, 8, 1].into_iter().enumerate() {
        put(16 + 8 * k, &size.to_le_bytes());
    }
    put(168, &((552 + xml.len()) as i64).to_le_bytes());
    if is_scaled {
        put(176, &0.5_f64.to_le_bytes());
        put(184, &1_f64.to_le_bytes());
    }
    bytes.extend([1, 0, 0, 0]);
    bytes.extend(((8 + xml.len()) as i32).to_le_bytes());
    bytes.extend(32_i32.to_le_bytes());
    bytes.extend(xml.as_bytes());
    for k in 0..(8 * n_columns) as i16 {
        if is_scaled {
            bytes.extend(k.to_le_bytes());
        } else {
            bytes.extend((0.5 * f32::from(k) + 1.0).to_le_bytes());
        }
    }
    bytes
}

#[test]
fn the_xml_of_a_cifti_says_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let series = "IndicesMapToDataType=\"CIFTI_INDEX_TYPE_SERIES\" NumberOfSeriesPoints=\"2\" \
                  SeriesExponent=\"0\" SeriesStart=\"3\" SeriesStep=\"0.72\" SeriesUnit=\"SECOND\">";
    let scalars = "IndicesMapToDataType=\"CIFTI_INDEX_TYPE_SCALARS\"><NamedMap><MapName>thick</MapName></NamedMap>\
                   <NamedMap><MapName>curv</MapName></NamedMap>";
    for (columns, ending) in [(series, "dtseries.nii"), (scalars, "dscalar.nii")] {
        for is_scaled in [false, true] {
            let (old, new) = (folder.path().join("old.nii"), folder.path().join(format!("new.{ending}")));
            fs::write(&old, two_hemispheres(columns, 2, is_scaled)).unwrap();
            let edited = Field::new("v", 2, FieldValues::F64(vec![0.25, -7.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
            assert!(rewrite(&old, Some("CortexRight"), &edited, &new), "{ending}");
            let numbers = |structure: &str| -> Vec<f64> {
                let fields = read(&new, structure, 4);
                (0..4)
                    .flat_map(|i| {
                        fields.iter().flat_map(move |f| (0..f.n_channels).map(move |c| f.get(i, c)))
                    })
                    .collect()
            };
            assert_eq!(numbers("CortexRight"), edited.to_f64());
            assert_eq!(numbers("CortexLeft"), [1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5]);
            let written = fs::read(&new).unwrap();
            assert!(String::from_utf8_lossy(&written).contains(columns), "names and the time step stay");
            assert_eq!(written.len(), fs::read(&old).unwrap().len() + if is_scaled { 32 } else { 0 });
        }
    }
}

#[test]
fn arrays_of_a_gifti_keep_intents_names_and_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (folder.path().join("old.func.gii"), folder.path().join("new.func.gii"));
    let names = ["rest [1]", "rest [2]", "rest [3]"];
    let fields: Vec<Field> = names
        .iter()
        .enumerate()
        .map(|(c, name)| Field::new(*name, 1, FieldValues::F32((0..30).map(|i| (i + c) as f32).collect())))
        .collect();
    write_gifti_fields(&old, &fields, Some("CortexLeft")).unwrap();
    let text = fs::read_to_string(&old).unwrap();
    let step = "<MD><Name>TimeStep</Name><Value>2.5</Value></MD>\n<MD><Name>Name</Name>";
    let text =
        text.replace("NIFTI_INTENT_SHAPE", "NIFTI_INTENT_TIME_SERIES").replace("<MD><Name>Name</Name>", step);
    fs::write(&old, &text).unwrap();
    let edited = Field::new("old", 3, FieldValues::F64((0..90).map(|k| f64::from(k) / 8.0).collect()));
    assert!(rewrite(&old, None, &edited, &new));
    let read = read_gifti_fields(&new, &ReadLimits::default()).unwrap();
    for (c, field) in read.iter().enumerate() {
        assert_eq!((field.name.as_str(), field.get(29, 0)), (names[c], f64::from(87 + c as u32) / 8.0));
    }
    let written = fs::read_to_string(&new).unwrap();
    assert_eq!(written.matches("NIFTI_INTENT_TIME_SERIES").count(), 3);
    assert_eq!(written.matches("<Value>2.5</Value>").count(), 3);
    assert!(!rewrite(&old, None, &values(30, 2), &new));
}

/// Names and colors of the labels 0, 3 and 7.
fn label_table() -> LabelTable {
    let entry = |(k, key): (usize, i32)| {
        let color = [f32::from(40 * (k as u8 + 1)) / 255.0, 1.0 / 255.0, 0.2, 1.0];
        LabelEntry { key, name: format!("area <{key}>"), color }
    };
    LabelTable::new([0, 3, 7].into_iter().enumerate().map(entry).collect())
}

/// Labels of twelve vertices, of which one has none.
fn labels() -> Field {
    let key = |i: usize| if i == 5 { f64::NAN } else { [0.0, 3.0, 7.0][i % 3] };
    Field::new("areas", 1, FieldValues::F64((0..12).map(key).collect()))
        .with_labels(Some(label_table().into()))
}

#[test]
fn labels_keep_names_and_colors_in_each_file_that_has_room_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let field = labels();
    write_gifti_fields(&path("a.label.gii"), std::slice::from_ref(&field), None).unwrap();
    write_annotation(&path("lh.a.annot"), &field).unwrap();
    let fields = std::slice::from_ref(&field);
    write_cifti_fields(&path("a.dlabel.nii"), fields, "CortexLeft", CiftiColumns::Labels).unwrap();
    let gifti = read_gifti_fields(&path("a.label.gii"), &ReadLimits::default()).unwrap().remove(0);
    let annotation = read(&path("lh.a.annot"), "CortexLeft", 12).remove(0);
    let cifti = read(&path("a.dlabel.nii"), "CortexLeft", 12).remove(0);
    for (name, found, nothing) in
        [("gifti", gifti, -1.0), ("annot", annotation, -1.0), ("cifti", cifti, f64::NAN)]
    {
        for i in 0..12 {
            let (asked, is) = (field.get(i, 0), found.get(i, 0));
            let same = is == asked || asked.is_nan() && (is == nothing || is.is_nan() && nothing.is_nan());
            assert!(same, "{name}: {is} for {asked}");
        }
        let table = found.labels.unwrap();
        for entry in label_table().entries() {
            assert_eq!(table.entry(entry.key), Some(entry), "{name}");
        }
    }
}

#[test]
fn labels_that_a_file_cannot_hold_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lh.a.annot");
    let refused = |field: &Field| write_annotation(&path, field).unwrap_err().to_string();
    let bare = Field { labels: None, ..labels() };
    assert!(refused(&bare).contains("no table of their names and colors"), "{}", refused(&bare));
    let with = |change: fn(&mut LabelEntry)| {
        let mut entries = label_table().entries().to_vec();
        change(&mut entries[1]);
        labels().with_labels(Some(LabelTable::new(entries).into()))
    };
    assert!(refused(&with(|entry| entry.color = [0.0; 4])).contains("black"));
    assert!(refused(&with(|entry| entry.color[0] = 40.0 / 255.0)).contains("one color"));
    assert!(refused(&with(|entry| entry.key = 4)).contains("label 3, which has no name"));
    assert!(!path.exists());
    let other = with(|entry| entry.name = "another".into());
    let gifti = write_gifti_fields(&folder.path().join("a.label.gii"), &[labels(), other], None);
    assert!(gifti.unwrap_err().to_string().contains("two names"));
    let cifti =
        write_cifti_fields(&folder.path().join("a.dlabel.nii"), &[bare], "CortexLeft", CiftiColumns::Labels);
    assert!(cifti.unwrap_err().to_string().contains("no table"));
}
