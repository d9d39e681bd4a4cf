//! Smooths a shape, file to file: `cargo run --example smooth_a_file [-- IN OUT]`.
//!
//! Without arguments it smooths the built-in creature. Everything else that the file holds (faces, colors, other fields) is
//! written as it was read.

use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::filter::{Preset, WeightedLayer};
use adwave::sample::Sample;
use adwave_io::{ReadLimits, ShapeFile, read_path, write_path};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut file = if let Some(path) = arguments.first() {
        read_path(Path::new(path), &ReadLimits::default())?
    } else {
        let creature = Sample::from_name("creature", Some(5000))?;
        ShapeFile::from_mesh(creature.points, creature.faces)
    };
    // Prepared once: vertices at one place joined, the diffusion operator built.
    let decomposer = Decomposer::new(&file.to_shape()?);
    // As many levels as reach details of the usual size.
    let (n_levels, why) = decomposer.default_levels();
    println!("{} vertices, {why}", decomposer.n_vertices());
    // All gains 0: f′ = f − Σ W_f(j) (eq. 18). `Preset::Enhance` makes details crisp instead.
    let layer = WeightedLayer::everywhere(Preset::Suppress.gains(n_levels));
    let schedule = Schedule::dyadic(n_levels)?;
    let smooth = decomposer.request(file.points().as_flattened(), 3, &schedule).filter_layers(&[layer])?;
    file.set_points(smooth.as_chunks::<3>().0.to_vec())?;
    let out = arguments.get(1).map_or("smooth.ply", String::as_str);
    write_path(&file, Path::new(out), None)?;
    println!("wrote {out}");
    Ok(())
}
