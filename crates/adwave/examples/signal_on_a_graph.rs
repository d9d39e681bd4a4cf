//! Splits a signal on a graph into bands and takes its noise away: `cargo run --example signal_on_a_graph [-- IN.mtx]`.
//!
//! The graph is a ring of stations or one of a file (a MatrixMarket matrix, or the edges of a mesh); the signal is made up.

use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::filter::WeightedLayer;
use adwave::shape::{Graph, Shape};
use adwave_io::{ReadLimits, ShapeKind, read_path};
use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let shape = if let Some(path) = std::env::args().nth(1) {
        read_path(Path::new(&path), &ReadLimits::default())?.into_shape_as(ShapeKind::Graph)?
    } else {
        // (node, node, weight): a larger weight makes a step between the two more likely.
        let edges: Vec<_> = (0..200).map(|u| (u, (u + 1) % 200, 1.0)).collect();
        Shape::Graph(Graph::new(200, &edges)?)
    };
    let decomposer = Decomposer::new(&shape);
    let n = decomposer.n_vertices();
    // One value per node: a wave, and something that turns its sign from node to node.
    let wave = |x: usize| (TAU * x as f64 / n as f64).sin();
    let signal: Vec<f64> = (0..n).map(|x| wave(x) + if x % 2 == 0 { 0.2 } else { -0.2 }).collect();

    let schedule = Schedule::dyadic(5)?; // 1, 2, 4, 8, 16 steps of the diffusion
    let request = decomposer.request(&signal, 1, &schedule);
    let bands = request.bands()?;
    // f = S_f(J) + Σ_j W_f(j) (eq. 15).
    for (j, band) in (1..).zip(bands.wavelets()) {
        println!("band {j}: rms {:.4}", rms(band));
    }
    println!("the rest: rms {:.4}", rms(bands.coarsest()));

    // Gains, fine to coarse: without the finest band (eq. 18).
    let quiet = request.filter_layers(&[WeightedLayer::everywhere(vec![0.0, 1.0, 1.0, 1.0, 1.0])])?;
    let difference = |values: &[f64]| rms(&(0..n).map(|x| values[x] - wave(x)).collect::<Vec<_>>());
    println!("distance from the wave: {:.4} before, {:.4} after", difference(&signal), difference(&quiet));
    Ok(())
}

/// The root of the mean square.
fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}
