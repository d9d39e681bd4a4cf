//! Files of values on surfaces, written anew and into copies of files that exist.

use adwave_io::{
    CiftiColumns, Field, FieldValues, ReadLimits, read_gifti_fields, read_surface_values, rewrite_values,
    write_cifti_fields, write_gifti_fields,
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
