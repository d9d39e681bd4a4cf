//! Times the nearest neighbors of a cloud: `neighbor_time CLOUD [K] [RUNS]`.
//!
//! Prints a line of JSON: points, k, the seconds of each run, and the sum of the distances to the k-th neighbor,
//! which other programs must reproduce.

use adwave::shape::nearest_neighbors;
use adwave_io::{ReadLimits, read_path};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: neighbor_time CLOUD [K] [RUNS]")?;
    let k = arguments.next().map_or(Ok(10), |k| k.parse())?;
    let runs: usize = arguments.next().map_or(Ok(3), |n| n.parse())?;
    let shape = read_path(path.as_ref(), &ReadLimits::default())?;
    let (mut seconds, mut sum) = (Vec::new(), 0.0);
    for _ in 0..runs {
        let start = Instant::now();
        let near = nearest_neighbors(shape.points(), k);
        seconds.push(start.elapsed().as_secs_f64());
        sum = near.radius.iter().sum();
    }
    println!(r#"{{"points":{},"k":{k},"seconds":{seconds:?},"radii":{sum:?}}}"#, shape.points().len());
    Ok(())
}
