//! A small `.h5ad` file.

use hdf5_pure::{AttrValue, FileBuilder};
use std::path::Path;

/// Writes `n` cells on a ring, whose neighbors are in `obsp`, with the genes CD4, CD8A, g2, g3 … The layer `counts` has
/// `count(cell, gene)`, and `X`, compressed by rows, twice as much.
pub(crate) fn write_cells_file(path: &Path, n: usize, n_genes: usize, count: &dyn Fn(usize, usize) -> f64) {
    let string = |text: &str| AttrValue::VarLenString(text.to_owned());
    let mut builder = FileBuilder::new();
    builder.set_attr("encoding-type", string("anndata"));
    builder.set_attr("encoding-version", string("0.1.0"));
    let values: Vec<f64> = (0..n * n_genes).map(|i| count(i / n_genes, i % n_genes)).collect();
    let doubled: Vec<f32> = values.iter().map(|v| 2.0 * *v as f32).collect();
    let mut x = builder.create_group("X");
    x.set_attr("encoding-type", string("csr_matrix"));
    x.set_attr("encoding-version", string("0.1.0"));
    x.set_attr("shape", AttrValue::I64Array(vec![n as i64, n_genes as i64]));
    x.create_dataset("indptr").with_i32_data(&(0..=n).map(|c| (c * n_genes) as i32).collect::<Vec<_>>());
    x.create_dataset("indices")
        .with_i32_data(&(0..n * n_genes).map(|i| (i % n_genes) as i32).collect::<Vec<_>>());
    x.create_dataset("data").with_f32_data(&doubled);
    builder.add_group(x.finish());
    let mut layers = builder.create_group("layers");
    layers.create_dataset("counts").with_f64_data(&values).with_shape(&[n as u64, n_genes as u64]);
    builder.add_group(layers.finish());
    let mut pairs = builder.create_group("obsp");
    let mut ring = pairs.create_group("connectivities");
    ring.set_attr("encoding-type", string("csr_matrix"));
    ring.set_attr("shape", AttrValue::I64Array(vec![n as i64, n as i64]));
    let neighbors: Vec<i32> = (0..n).flat_map(|c| [(c + 1) % n, (c + n - 1) % n]).map(|c| c as i32).collect();
    ring.create_dataset("indptr").with_i32_data(&(0..=n).map(|c| 2 * c as i32).collect::<Vec<_>>());
    ring.create_dataset("indices").with_i32_data(&neighbors);
    ring.create_dataset("data").with_f64_data(&vec![1.0; 2 * n]);
    pairs.add_group(ring.finish());
    builder.add_group(pairs.finish());
    let cells = (0..n).map(|c| format!("cell{c}")).collect();
    let genes = (0..n_genes).map(|g| match g {
        0 => "CD4".to_owned(),
        1 => "CD8A".to_owned(),
        _ => format!("g{g}"),
    });
    for (frame, names) in [("obs", cells), ("var", genes.collect::<Vec<_>>())] {
        let mut group = builder.create_group(frame);
        group.set_attr("encoding-type", string("dataframe"));
        group.set_attr("encoding-version", string("0.2.0"));
        group.set_attr("_index", string("_index"));
        group
            .create_dataset("_index")
            .with_vlen_strings(&names.iter().map(String::as_str).collect::<Vec<_>>());
        builder.add_group(group.finish());
    }
    builder.write(path).unwrap();
}
