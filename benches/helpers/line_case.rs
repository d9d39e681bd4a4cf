//! Figure 2 and Table 1 of the paper in numbers: three kinds of wavelets on a line of points.
//!
//! `cargo run --release -p adwave-bench-helpers --bin line_case [-- POINTS]`; a second argument names a CSV file for
//! the functions.

use adwave::shape::{Graph, Shape};
use adwave_baselines::line::{LineCase, line_case};
use std::fmt::Write;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let points: u32 = arguments.next().map_or(Ok(100), |a| a.parse())?;
    let edges: Vec<_> = (1..points).map(|i| (i - 1, i, 1.0)).collect();
    let shape = Shape::Graph(Graph::new(points as usize, &edges)?);
    let cases = line_case(&shape, &[9, 10])?;
    println!(
        "{:<6} {:>5} {:>7} {:>10} {:>10} {:>10} {:>10} {:>12} {:>12} {:>10}",
        "",
        "level",
        "number",
        "supp phi",
        "supp psi",
        "supp dual",
        "mean psi",
        "orthogonal",
        "rebuilt",
        "seconds"
    );
    for c in &cases {
        let LineCase { name, level, count, scaling, wavelet, dual, defect, error, seconds, .. } = c;
        println!(
            "{name:<6} {level:>5} {count:>7} {:>10.1} {:>10.1} {:>10} {:>10.2e} {defect:>12.2e} {error:>12.2e} {seconds:>10.2e}",
            scaling.support,
            wavelet.support,
            dual.map_or("-".to_owned(), |d| format!("{:.1}", d.support)),
            wavelet.mean,
        );
    }
    if let Some(path) = arguments.next() {
        let mut csv = String::from("point");
        for c in &cases {
            write!(csv, ",{0}_phi_{1},{0}_psi_{1}", c.name, c.level)?;
        }
        for x in 0..points as usize {
            write!(csv, "\n{x}")?;
            for c in &cases {
                write!(csv, ",{},{}", c.middle_scaling[x], c.middle_wavelet[x])?;
            }
        }
        std::fs::write(path, csv + "\n")?;
    }
    Ok(())
}
