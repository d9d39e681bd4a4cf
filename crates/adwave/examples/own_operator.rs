//! Bands of a diffusion operator of one's own: `cargo run --example own_operator [-- N]`.
//!
//! Any matrix of probabilities will do: rows that sum to 1, no entry below 0. Here it is a drift along a ring of N places,
//! which no shape gives, as it prefers one direction.

use adwave::Progress;
use adwave::bands::{BandsParams, Schedule, Transform};
use adwave::operator::Diffusion;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let n: u32 = std::env::args().nth(1).map_or(Ok(64), |n| n.parse())?;
    // Compressed rows: row x is columns[2x..2x + 2] and values[2x..2x + 2]. Stay with 3/4, go on with 1/4.
    let offsets: Vec<usize> = (0..=n as usize).map(|x| 2 * x).collect();
    let columns: Vec<u32> = (0..n).flat_map(|x| [x, (x + 1) % n]).collect();
    let values = [0.75, 0.25].repeat(n as usize);
    let diffusion = Diffusion::from_rows(&offsets, &columns, &values)?;
    // Such an operator need not be reversible: powers are taken one by one, and only whole ones.
    println!("{} places, reversible: {}", diffusion.n_vertices(), diffusion.is_reversible());

    let transform = Transform::new(diffusion, &BandsParams::default())?;
    let schedule = Schedule::new(vec![1, 4, 16])?;
    // A single 1; W_f(1), W_f(2), W_f(3) come into buffers of our own, in the numbering of the matrix.
    let mut signal = vec![0.0; n as usize];
    signal[0] = 1.0;
    let mut wavelets = vec![vec![0.0; signal.len()]; schedule.n_levels()];
    let mut buffers: Vec<&mut [f64]> = wavelets.iter_mut().map(Vec::as_mut_slice).collect();
    let info = transform.wavelets_into(&signal, 1, &schedule, &mut buffers, Progress::none())?;
    println!("{} products with the matrix", info.products);
    for (steps, wavelet) in schedule.steps().iter().zip(&wavelets) {
        // The columns of this matrix sum to 1 as well, so wavelets sum to 0.
        let sum: f64 = wavelet.iter().sum();
        println!("up to {steps} steps: {:.4} at place 0, sum {sum:.1}", wavelet[0]);
    }
    Ok(())
}
