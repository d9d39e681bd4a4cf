//! Writes small files of every format into a folder, which `crates/adwave-io/oracles/check.py` reads with other
//! libraries: `cargo run -p adwave-bench-helpers --bin oracle_files -- FOLDER`.

use std::path::PathBuf;

use adwave::rows::CompressedRows;
use adwave::shape::Polygons;
use adwave_io::{
    ArrayValues, Compression, Edges, Field, FieldValues, ShapeFile, WriteError, write_gifti_fields,
    write_matrix_market, write_npy, write_npz, write_path, write_sparse_npz,
};

fn main() -> Result<(), WriteError> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| ".".into()));
    let points = vec![[0.0, 0.0, 0.1], [1.0, 0.0, 0.2], [1.0, 1.0, 0.3], [0.0, 1.0, 0.4], [0.5, 2.0, 0.5]];
    let faces: Polygons = [&[0_u32, 1, 2, 3][..], &[3, 2, 4]].into_iter().collect();
    let mut mesh = ShapeFile::from_mesh(points.clone(), faces);
    mesh.add_vertex_field(Field::new("quality", 1, FieldValues::F32(vec![0.0, 0.1, 0.2, 0.3, 0.4])))
        .expect("one row each");
    mesh.add_vertex_field(Field::new("flow", 3, FieldValues::F64((0..15).map(f64::from).collect())))
        .expect("one row each");
    mesh.add_vertex_field(Field::new("color", 3, FieldValues::U8((0..15).collect()))).expect("one row each");
    mesh.add_vertex_field(Field::new("label", 1, FieldValues::I64(vec![-1, 0, 1, 2, 3])))
        .expect("one row each");
    mesh.add_face_field(Field::new("part", 1, FieldValues::U16(vec![7, 9]))).expect("one row each");
    for name in ["mesh.vtp", "mesh.ply", "mesh.obj", "mesh.off", "mesh.stl"] {
        write_path(&mesh, &folder.join(name), None)?;
    }
    write_path(&mesh, &folder.join("ascii.ply"), Some(adwave_io::Format::PLY_ASCII))?;
    write_path(&ShapeFile::from_cloud(points.clone()), &folder.join("cloud.vtp"), None)?;
    let mut wire = ShapeFile::from_graph(5, Edges { pairs: vec![[0, 1], [1, 4]], ..Edges::default() });
    wire.set_points(points).expect("one row each");
    write_path(&wire, &folder.join("wire.vtp"), None)?;
    mesh.add_vertex_field(Field::new(
        "a<b> & \"c\"",
        1,
        FieldValues::F64(vec![0.5, f64::NAN, -2.0, 1e-3, 7.0]),
    ))
    .expect("one row each");
    write_path(&mesh, &folder.join("mesh.gii"), None)?;
    write_path(&mesh, &folder.join("mesh.gii.gz"), None)?;
    write_gifti_fields(&folder.join("fields.func.gii"), mesh.vertex_fields(), Some("CortexLeft"))?;
    // More than one block of the compression.
    let n = 300_000;
    let mut large = ShapeFile::from_cloud((0..n).map(|i| [f64::from(i), 0.0, 0.0]).collect());
    large.add_vertex_field(Field::new("i", 1, FieldValues::I32((0..n).collect()))).expect("one row each");
    write_path(&large, &folder.join("large.vtp"), None)?;

    write_npy(&folder.join("a.npy"), &[2, 3], ArrayValues::F64(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]))?;
    for (name, compression) in [("stored.npz", Compression::Stored), ("deflated.npz", Compression::Deflated)]
    {
        let arrays: [(&str, &[usize], ArrayValues<'_>); 4] = [
            ("x", &[3], ArrayValues::F32(&[0.5, 1.5, 2.5])),
            ("index", &[2, 1, 2], ArrayValues::U32(&[1, 2, 3, 4])),
            ("empty", &[0, 3], ArrayValues::F64(&[])),
            ("n", &[], ArrayValues::I64(&[-5])),
        ];
        write_npz(&folder.join(name), &arrays, compression)?;
    }
    // [[0, 1.5, 0], [2, 0, -3]]
    let matrix =
        CompressedRows::new(vec![0, 1, 3], vec![1, 0, 2], vec![1.5, 2.0, -3.0], 3).expect("sorted rows");
    write_sparse_npz(&folder.join("sparse.npz"), &matrix, Compression::Deflated)?;
    write_matrix_market(&folder.join("sparse.mtx"), &matrix)
}
