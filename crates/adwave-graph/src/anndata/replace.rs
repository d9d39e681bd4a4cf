//! A copy of an `.h5ad` file with another matrix.

use super::AnnDataError;
use super::elements::unreadable;
use hdf5_pure::{AttrValue, DatasetBuilder, File, Group};
use std::path::Path;

/// A dense matrix that replaces `X`.
#[derive(Clone, Copy, Debug)]
pub struct ReplacedMatrix<'a> {
    /// Values, row after row.
    pub values: &'a [f64],
    /// Number of cells.
    pub n_cells: usize,
    /// Names of the genes of the columns if they are not those of the file. Then `var` has these names alone, and all
    /// objects with a row or column for each of the old genes are left out: layers, `varm`, `varp` and `raw`.
    pub genes: Option<&'a [String]>,
}

/// Writes a copy of a file with the matrix as its `X`; everything else keeps its bytes. Returns the names of the
/// objects that were left out. If the new matrix does not fit into the space of the old one, that space stays in the
/// file. Files in the oldest form of HDF5, the default of h5py, are held in memory during the call.
///
/// # Errors
/// [`AnnDataError`] if a file cannot be read or written; an incomplete target may be left.
pub fn write_replaced(
    source: &Path,
    target: &Path,
    matrix: ReplacedMatrix<'_>,
) -> Result<Vec<String>, AnnDataError> {
    std::fs::copy(source, target)?;
    let edit = |what: &'static str| move |error: hdf5_pure::Error| unreadable(what, &error);
    let file = File::open_rw(target).map_err(edit("the file"))?;
    let root = file.root();
    let mut left_out = Vec::new();
    root.delete("X").map_err(edit("X"))?;
    if matrix.genes.is_some() {
        left_out = delete_per_gene(&root)?;
    }
    file.commit().map_err(edit("X"))?;
    let n_genes = matrix.genes.map_or(matrix.values.len() / matrix.n_cells.max(1), <[String]>::len);
    root.create_dataset("X", |dataset| {
        dataset.with_f64_data(matrix.values).with_shape(&[matrix.n_cells as u64, n_genes as u64]);
        encode(dataset, "array");
    })
    .map_err(edit("X"))?;
    if let Some(genes) = matrix.genes {
        create_index(&root, genes).map_err(edit("var"))?;
        for name in EMPTIED.iter().filter(|name| left_out.iter().any(|left| left == *name)) {
            root.create_group_with(name, |group| {
                group.set_attr("encoding-type", string("dict"));
                group.set_attr("encoding-version", string("0.1.0"));
            })
            .map_err(edit("the file"))?;
        }
    }
    file.commit().map_err(edit("X"))?;
    Ok(left_out)
}

/// Groups with a row or column per gene, which stay as empty groups.
const EMPTIED: [&str; 3] = ["layers", "varm", "varp"];

/// Deletes the objects with a row or column per gene, and returns the names of the nonempty ones.
fn delete_per_gene(root: &Group) -> Result<Vec<String>, AnnDataError> {
    let failed = |error: hdf5_pure::Error| unreadable("the file", &error);
    let groups = root.groups().map_err(failed)?;
    let mut left_out = Vec::new();
    for name in EMPTIED.into_iter().chain(["raw"]).filter(|name| groups.iter().any(|group| group == name)) {
        let group = root.group(name).map_err(failed)?;
        if group.groups().map_err(failed)?.is_empty() && group.datasets().map_err(failed)?.is_empty() {
            continue;
        }
        root.delete(name).map_err(failed)?;
        left_out.push(name.to_owned());
    }
    root.delete("var").map_err(failed)?;
    Ok(left_out)
}

/// Creates a data frame `var` that has an index alone.
fn create_index(root: &Group, genes: &[String]) -> Result<(), hdf5_pure::Error> {
    root.create_group_with("var", |group| {
        group.set_attr("encoding-type", string("dataframe"));
        group.set_attr("encoding-version", string("0.2.0"));
        group.set_attr("_index", string("_index"));
        group.set_attr("column-order", AttrValue::F64Array(Vec::new()));
        group.create_dataset("_index", |dataset| {
            let names: Vec<&str> = genes.iter().map(String::as_str).collect();
            dataset.with_vlen_strings(&names);
            encode(dataset, "string-array");
        });
    })?;
    Ok(())
}

fn encode(dataset: &mut DatasetBuilder, kind: &str) {
    dataset.set_attr("encoding-type", string(kind)).set_attr("encoding-version", string("0.2.0"));
}

fn string(text: &str) -> AttrValue {
    AttrValue::VarLenString(text.to_owned())
}
