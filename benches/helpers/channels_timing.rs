//! Times signals of many channels on graphs of nearest neighbors: the eighth power of the walk in double and in single
//! precision, and the gradient of eight bands beside the bands themselves. Prints a line of JSON for each, with the shortest
//! and the median time in seconds, and in ns per entry, channel and product.
//!
//! `channels_timing [NODES:NEIGHBORS:CHANNELS …]`: random points in a cube, each joined with its nearest neighbors in both
//! directions; all threads of the pool (`RAYON_NUM_THREADS`). By default the rows of docs/PERFORMANCE.md.

use adwave::bands::{BandsParams, Precision, Schedule};
use adwave::operator::OperatorParams;
use adwave::shape::{PointCloud, Shape};
use adwave::{Decomposer, Progress};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// Calls of each kind, after a first one that is not counted.
const CALLS: usize = 5;

/// Power of the walk.
const STEPS: u64 = 8;

/// Channels whose gradient is timed.
const GRADIENT_CHANNELS: usize = 64;

/// Levels whose gradient is timed.
const GRADIENT_LEVELS: usize = 8;

/// Accuracy that single precision reaches on these graphs.
const SINGLE_ACCURACY: f64 = 1e-3;

fn main() -> Result<(), Failure> {
    let cases: Vec<String> = std::env::args().skip(1).collect();
    let usual = ["30000:14:256", "100000:18:64", "100000:18:1000", "100000:18:12"].map(str::to_owned);
    for case in if cases.is_empty() { &usual[..] } else { &cases[..] } {
        let numbers: Vec<usize> = case.split(':').map(str::parse).collect::<Result<_, _>>()?;
        let [n, neighbors, channels] = numbers[..] else {
            return Err(format!("a case is NODES:NEIGHBORS:CHANNELS, got {case}").into());
        };
        measure(n, neighbors, channels)?;
    }
    Ok(())
}

/// Shortest and median time of several calls, in seconds.
fn time(mut call: impl FnMut() -> Result<(), Failure>) -> Result<[f64; 2], Failure> {
    call()?;
    let mut seconds = Vec::with_capacity(CALLS);
    for _ in 0..CALLS {
        let start = Instant::now();
        call()?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    Ok([seconds[0], seconds[CALLS / 2]])
}

/// Numbers between 0 and 1 (splitmix64).
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 * (-53_f64).exp2()
    }
}

fn measure(n: usize, neighbors: usize, channels: usize) -> Result<(), Failure> {
    let mut noise = Uniform(7);
    let points: Vec<[f64; 3]> = (0..n).map(|_| [0; 3].map(|_| noise.next())).collect();
    let params = OperatorParams::default().with_neighbors(neighbors);
    let cloud = Shape::Cloud(PointCloud::new(points)?);
    let decomposer = Decomposer::with_params(&cloud, &params, Progress::none())?;
    let entries = decomposer.n_entries().unwrap_or_default();
    let signal: Vec<f64> = (0..n * channels).map(|_| noise.next()).collect();
    let mut out = vec![0.0; signal.len()];
    let schedule = Schedule::new(vec![STEPS])?;
    let per_row = entries as f64 / n as f64;
    let print = |what: &str, [least, median]: [f64; 2], products: u64| {
        let per = |seconds: f64| 1e9 * seconds / (entries as f64 * channels as f64 * products as f64);
        println!(
            r#"{{"what":"{what}","nodes":{n},"entries_per_row":{per_row:.1},"channels":{channels},"least":{least:.4},"median":{median:.4},"ns_per_entry_channel_product":[{:.3},{:.3}]}}"#,
            per(least),
            per(median)
        );
    };
    let formats = [(Precision::Double, 1e-10), (Precision::Single, SINGLE_ACCURACY)];
    for (precision, accuracy) in
        formats.into_iter().filter(|(format, _)| *format == Precision::Double || channels >= 16)
    {
        let params = BandsParams::default().with_precision(precision).with_accuracy(accuracy);
        let transform = decomposer.transform().with_params(&params)?;
        let mean = decomposer.vertex_map().mean(&signal, channels);
        let taken = time(|| {
            transform.weighted_into(&mean, channels, &schedule, &[1.0], &mut out, Progress::none())?;
            Ok(())
        })?;
        print(&format!("power {STEPS}, {}", precision.name()), taken, STEPS);
    }
    if channels == GRADIENT_CHANNELS {
        let (map, schedule) = (decomposer.vertex_map(), Schedule::dyadic(GRADIENT_LEVELS)?);
        let transform = decomposer.transform();
        let mut bands = vec![0.0; (GRADIENT_LEVELS + 1) * signal.len()];
        let forward = time(|| {
            transform.bands_into(map, &signal, channels, &schedule, &mut bands, Progress::none())?;
            Ok(())
        })?;
        print("bands of 8 levels", forward, 1);
        let backward = time(|| {
            transform.gradient_of_bands(map, &bands, channels, &schedule, Progress::none())?;
            Ok(())
        })?;
        print("gradient of 8 levels", backward, 1);
        println!(r#"{{"what":"gradient / bands","median":{:.3}}}"#, backward[1] / forward[1]);
    }
    Ok(())
}
