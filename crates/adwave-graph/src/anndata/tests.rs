use super::*;
use hdf5_pure::{AttrValue, FileBuilder};

fn path(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("adwave-anndata-{}-{name}.h5ad", std::process::id()))
}

/// A file that is removed in the end.
struct TemporaryFile(std::path::PathBuf);

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The matrix 0 2 0 / 5 0 1 of two cells and three genes, as compressed rows or columns, with a dense layer.
fn bytes(is_by_rows: bool) -> Vec<u8> {
    let string = |text: &str| AttrValue::VarLenString(text.to_owned());
    let mut builder = FileBuilder::new();
    let mut x = builder.create_group("X");
    x.set_attr("encoding-type", string(if is_by_rows { "csr_matrix" } else { "csc_matrix" }));
    x.set_attr("shape", AttrValue::I64Array(vec![2, 3]));
    // Indices within a row need not ascend.
    let (offsets, indices, data): (&[i32], &[i32], &[f32]) = if is_by_rows {
        (&[0, 1, 3], &[1, 2, 0], &[2.0, 1.0, 5.0])
    } else {
        (&[0, 1, 2, 3], &[1, 0, 1], &[5.0, 2.0, 1.0])
    };
    x.create_dataset("indptr").with_i32_data(offsets);
    x.create_dataset("indices").with_i32_data(indices);
    x.create_dataset("data").with_f32_data(data);
    builder.add_group(x.finish());
    let mut layers = builder.create_group("layers");
    layers.create_dataset("raw").with_i64_data(&[0, 1, 2, 3, 4, 5]).with_shape(&[2, 3]);
    builder.add_group(layers.finish());
    for (frame, names) in [("obs", vec!["a", "b"]), ("var", vec!["Cd4", "7", "Actb"])] {
        let mut group = builder.create_group(frame);
        group.set_attr("_index", string("names"));
        group.create_dataset("names").with_vlen_strings(&names);
        builder.add_group(group.finish());
    }
    builder.finish().unwrap()
}

fn stored(name: &str, bytes: &[u8]) -> TemporaryFile {
    let file = TemporaryFile(path(name));
    std::fs::write(&file.0, bytes).unwrap();
    file
}

fn sparse(file: &AnnDataFile) -> CompressedRows<f64> {
    match file.matrix(None, Progress::none()).unwrap() {
        AnnDataMatrix::Sparse(matrix) => matrix,
        AnnDataMatrix::Dense(..) => panic!("X is sparse"),
    }
}

#[test]
fn sparse_rows_and_columns_layers_and_names_are_read() {
    for is_by_rows in [true, false] {
        let stored = stored(&format!("read-{is_by_rows}"), &bytes(is_by_rows));
        let file = AnnDataFile::open(&stored.0, 1 << 20).unwrap();
        assert_eq!((file.n_cells(), file.n_genes()), (2, 3));
        let matrix = sparse(&file);
        assert_eq!(matrix.row(0), ([1].as_slice(), [2.0].as_slice()));
        assert_eq!(matrix.row(1), ([0, 2].as_slice(), [5.0, 1.0].as_slice()));
        let layer = file.matrix(Some("raw"), Progress::none()).unwrap();
        assert_eq!(layer, AnnDataMatrix::Dense(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0], 3));
        let error = file.matrix(Some("x"), Progress::none()).unwrap_err().to_string();
        assert!(error.contains("`x`; the file has raw"), "{error}");
        assert!(file.connectivities(Progress::none()).unwrap().is_none());
        assert!(file.principal_components(Progress::none()).unwrap().is_none());
        // A name comes before a number.
        let genes = ["Actb", "7", "0"].map(str::to_owned);
        assert_eq!(file.columns_of(&genes).unwrap(), [2, 1, 0]);
        let missing = file.columns_of(&["Cd8".to_owned()]).unwrap_err().to_string();
        assert!(missing.contains("`Cd8`"), "{missing}");
    }
}

#[test]
fn a_copy_has_the_new_matrix_and_keeps_the_rest() {
    let (from, to) = (stored("from", &bytes(true)), TemporaryFile(path("to")));
    let values = [1.5, 2.0, 3.0, 4.0, 5.0, 6.25];
    let matrix = ReplacedMatrix { values: &values, n_cells: 2, genes: None };
    assert!(write_replaced(&from.0, &to.0, matrix).unwrap().is_empty());
    let file = AnnDataFile::open(&to.0, 1 << 20).unwrap();
    assert_eq!(file.matrix(None, Progress::none()).unwrap(), AnnDataMatrix::Dense(values.to_vec(), 3));
    assert_eq!(file.gene_names().unwrap(), ["Cd4", "7", "Actb"]);
    assert!(file.matrix(Some("raw"), Progress::none()).is_ok());

    let genes = ["Actb".to_owned()];
    let matrix = ReplacedMatrix { values: &values[..2], n_cells: 2, genes: Some(&genes) };
    assert_eq!(write_replaced(&from.0, &to.0, matrix).unwrap(), ["layers"]);
    let file = AnnDataFile::open(&to.0, 1 << 20).unwrap();
    assert_eq!(file.matrix(None, Progress::none()).unwrap(), AnnDataMatrix::Dense(values[..2].to_vec(), 1));
    assert_eq!(file.gene_names().unwrap(), genes);
}

#[test]
fn damaged_and_oversized_files_are_errors() {
    let whole = bytes(true);
    let limited = stored("limited", &whole);
    let error = AnnDataFile::open(&limited.0, 8).unwrap().matrix(None, Progress::none()).unwrap_err();
    assert!(matches!(error, AnnDataError::TooLarge { .. }), "{error}");
    let mut state = 9_u64;
    let mut next = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as usize % n
    };
    let (mut n_read, mut n_refused) = (0, 0);
    for round in 0..400 {
        let mut bytes = whole.clone();
        if round % 4 == 0 {
            bytes.truncate(next(whole.len()));
        }
        for _ in 0..next(6) {
            let at = next(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
            if let Some(byte) = bytes.get_mut(at) {
                *byte = next(256) as u8;
            }
        }
        let (from, to) = (stored("damaged", &bytes), TemporaryFile(path("edited")));
        let read = AnnDataFile::open(&from.0, 1 << 20).and_then(|file| {
            file.matrix(None, Progress::none())?;
            file.matrix(Some("raw"), Progress::none())?;
            file.gene_names()
        });
        let matrix = ReplacedMatrix { values: &[0.0; 6], n_cells: 2, genes: None };
        // Either outcome is right, as long as there is one.
        let _ = write_replaced(&from.0, &to.0, matrix);
        *(if read.is_ok() { &mut n_read } else { &mut n_refused }) += 1;
    }
    assert!(n_read > 0 && n_refused > 0, "{n_read} read, {n_refused} refused");
}

#[test]
fn files_from_before_version_0_7_are_read() {
    let mut builder = FileBuilder::new();
    builder.create_dataset("X").with_f64_data(&[1.0, 2.0, 3.0, 4.0]).with_shape(&[2, 2]);
    builder.create_dataset("var").with_i64_data(&[1, 2]);
    let mut neighbors = builder.create_group("uns");
    let mut group = neighbors.create_group("neighbors");
    let mut weights = group.create_group("connectivities");
    weights.set_attr("h5sparse_format", AttrValue::VarLenString("csr".to_owned()));
    weights.set_attr("h5sparse_shape", AttrValue::I64Array(vec![2, 2]));
    weights.create_dataset("indptr").with_i32_data(&[0, 1, 2]);
    weights.create_dataset("indices").with_i32_data(&[1, 0]);
    weights.create_dataset("data").with_f64_data(&[0.5, 0.5]);
    group.add_group(weights.finish());
    neighbors.add_group(group.finish());
    builder.add_group(neighbors.finish());
    let stored = stored("old", &builder.finish().unwrap());
    let file = AnnDataFile::open(&stored.0, 1 << 20).unwrap();
    assert_eq!(file.connectivities_name(), Some("uns/neighbors/connectivities"));
    let weights = file.connectivities(Progress::none()).unwrap().unwrap();
    assert_eq!(weights.row(0), (&[1_u32][..], &[0.5][..]));
    // Genes have no names that can be read, but columns.
    let columns = |genes: [&str; 2]| file.columns_of(&genes.map(str::to_owned));
    assert_eq!(columns(["1", "0"]).unwrap(), [1, 0]);
    for genes in [["Cd4", "0"], ["0", "2"]] {
        let error = columns(genes).unwrap_err().to_string();
        assert!(error.contains("data frame") && error.contains(".npy"), "{error}");
    }
}

#[test]
fn a_file_that_was_cut_is_refused() {
    let bytes = bytes(true);
    for length in [64, bytes.len() / 2, bytes.len() - 1] {
        let stored = stored(&format!("cut{length}"), &bytes[..length]);
        let error = AnnDataFile::open(&stored.0, 1 << 20).unwrap_err().to_string();
        assert!(error.contains(&format!("it has {length}; it was cut")), "{error}");
    }
}
