//! Finds the features of a point cloud: `cargo run --example features_of_a_cloud [-- IN]`.
//!
//! Features are places where the shape stands out at one size (Algorithm 2). A file with faces is taken by its vertices.

use adwave::bands::Schedule;
use adwave::features::{FEATURE_EXTENT, FeatureParams, features};
use adwave::sample::Sample;
use adwave::shape::{PointCloud, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, read_path};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let points = match std::env::args().nth(1) {
        Some(path) => read_path(Path::new(&path), &ReadLimits::default())?.into_parts().points,
        // Drawn evenly by area, as a scanner might; the seed makes it the same each time.
        None => Sample::from_name("creature", Some(10_000))?.draw_cloud(6000, 1)?.points,
    };
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone())?));
    // Features are larger than what a filter takes away: more levels than by default.
    let (n_levels, why) = decomposer.levels_reaching(FEATURE_EXTENT);
    println!("{} points, {why}", decomposer.n_vertices());
    // Features read the lengths of the vectors W_f(j,x) only.
    let schedule = Schedule::dyadic(n_levels)?;
    let norms = decomposer.request(points.as_flattened(), 3, &schedule).norms()?;
    let params = FeatureParams::default().with_best(5);
    for feature in features(&decomposer, &norms, &params, Progress::none())? {
        let [x, y, z] = feature.position.ok_or("a cloud has positions")?;
        println!(
            "({x:6.3}, {y:6.3}, {z:6.3}) of radius {:.3}, {:.1} times the mean",
            feature.sigma, feature.strength
        );
    }
    Ok(())
}
