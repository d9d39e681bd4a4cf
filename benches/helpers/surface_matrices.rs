//! Writes the matrices of the heat equation on a mesh for other programs: `surface_matrices MESH OUT.npz`.
//!
//! The file has `mass` (n), the M of the operator, `areas` (n), M before the smallest masses were raised, and L ≥ 0
//! as `data`, `indices` and `indptr` (n + 1), all in the order of the mesh's vertices. The vertices must be at
//! distinct positions.

use adwave::Progress;
use adwave::operator::{OperatorKind, OperatorParams, Semigroup, surface_diffusion};
use adwave::shape::{PreparedGeometry, WeldMode};
use adwave_io::{ArrayValues, Compression, ReadLimits, read_path, write_npz};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [mesh, out] = &arguments[..] else {
        return Err("usage: surface_matrices MESH OUT.npz".into());
    };
    let shape = read_path(mesh, &ReadLimits::default())?.to_shape()?;
    let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none())?;
    let map = geometry.vertex_map();
    let n = geometry.n_vertices();
    if map.n_vertices() != n {
        return Err("the vertices must be at distinct positions".into());
    }
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let surface = surface_diffusion(&geometry, &params, Progress::none())?;
    let diffusion = &surface.diffusion;
    let Semigroup::Heat { rate, .. } = diffusion.semigroup() else {
        return Err("the operator has no heat equation".into());
    };
    // λ = rate/τ, τ = s²/4.
    let lambda = 4.0 * rate / diffusion.step_length().powi(2);
    let total = surface.areas.iter().sum::<f64>() * (1.0 + surface.info.added_mass);
    let mass: Vec<f64> = (0..n).map(|x| total * diffusion.stationary()[map.welded(x)]).collect();
    let areas: Vec<f64> = (0..n).map(|x| surface.areas[map.welded(x)]).collect();
    let mut vertex_at = vec![0_usize; n];
    for x in 0..n {
        vertex_at[map.welded(x)] = x;
    }
    let (mut data, mut indices, mut indptr) = (Vec::new(), Vec::new(), vec![0_i64]);
    for (x, mass) in mass.iter().enumerate() {
        let (columns, weights) = diffusion.row(map.welded(x));
        let scale = mass * lambda;
        indices.push(x as i64);
        data.push(scale * weights.iter().sum::<f64>());
        for (&y, w) in columns.iter().zip(weights) {
            indices.push(vertex_at[y as usize] as i64);
            data.push(-scale * w);
        }
        indptr.push(indices.len() as i64);
    }
    let entries = [data.len()];
    write_npz(
        out,
        &[
            ("mass", &[n], ArrayValues::F64(&mass)),
            ("areas", &[n], ArrayValues::F64(&areas)),
            ("data", &entries, ArrayValues::F64(&data)),
            ("indices", &entries, ArrayValues::I64(&indices)),
            ("indptr", &[n + 1], ArrayValues::I64(&indptr)),
        ],
        Compression::Stored,
    )?;
    Ok(())
}
