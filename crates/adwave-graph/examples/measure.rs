//! Times and memory of the tables in docs/GRAPHS.md, on synthetic cells and graphs:
//! `cargo run --release -p adwave-graph --example measure -- [impute|wide|nearest|scatter|stream|all] [double|single]`.

use adwave::Progress;
use adwave::bands::Precision;
use adwave::rows::CompressedRows;
use adwave_graph::{
    CountMatrix, CountValues, DimensionedPoints, ImputationInput, Kernel, ScatteringParams, SelfLoops,
    Transformation, WalkMatrix, WalkOptions, WalkPowers, impute_into, kernel_weights, nearest_lists, scatter,
};
use adwave_io::read_edge_rows;
use std::io::{BufRead, Read};
use std::time::Instant;

/// Runs of which the fastest counts.
const RUNS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted = std::env::args().nth(1).unwrap_or_else(|| "all".to_owned());
    let is_wanted = |name: &str| wanted == name || wanted == "all";
    let precisions = match std::env::args().nth(2) {
        Some(name) => vec![name.parse()?],
        None => vec![Precision::Double, Precision::Single],
    };
    for &precision in &precisions {
        if is_wanted("impute") {
            imputation(5_000, 8_000, 3, precision)?;
        }
        if is_wanted("wide") {
            imputation(100_000, 1_000, 8, precision)?;
        }
        if is_wanted("scatter") {
            scattering(1_000_000, precision)?;
        }
    }
    if is_wanted("nearest") {
        neighbors(100_000, 50, 15)?;
    }
    if is_wanted("stream") {
        stream(1_000_000, 10_000_000)?;
    }
    Ok(())
}

/// A number in −1 … 1 for each index.
fn noise(i: u64) -> f64 {
    let mixed = i.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5851_F42D_4C95_7F2D;
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ (mixed >> 32)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A value that is normal enough: the sum of four uniform ones.
fn bell(i: u64) -> f64 {
    (0..4).map(|k| noise(4 * i + k)).sum::<f64>()
}

/// Cells in clusters of `d` dimensions, of falling spread like principal components.
fn cells(n: usize, d: usize) -> Vec<f64> {
    let spread = |c: usize| 10.0 / (1.0 + c as f64).sqrt();
    let mut values = Vec::with_capacity(n * d);
    for x in 0..n as u64 {
        let cluster = x % 20;
        for c in 0..d {
            let center = bell(1_000_000_007 + cluster * 1000 + c as u64);
            values.push(spread(c) * (center + 0.5 * bell((x << 8) + c as u64)));
        }
    }
    values
}

/// The walk of cells to their nearest neighbors in a few dimensions.
fn cell_walk(n: usize) -> Result<WalkPowers, Box<dyn std::error::Error>> {
    let values = cells(n, 10);
    let points = DimensionedPoints { values: &values, n_dimensions: 10 };
    let lists = nearest_lists(points, 15, Progress::none())?;
    let weights =
        kernel_weights(&lists, Kernel::Adaptive { decay: 1.0, scale_neighbor: 5 }, Progress::none())?;
    let options = WalkOptions { self_loops: SelfLoops::Weight(1.0), ..WalkOptions::default() };
    let walk = WalkMatrix::from_weights(weights, options, Progress::none())?;
    Ok(WalkPowers::new(walk, Progress::none())?)
}

fn imputation(
    n: usize,
    n_genes: usize,
    steps: u32,
    precision: Precision,
) -> Result<(), Box<dyn std::error::Error>> {
    let powers = cell_walk(n)?;
    let counts: Vec<f64> = (0..(n * n_genes) as u64).map(|i| (3.0 * noise(i)).max(0.0).floor()).collect();
    let channels: Vec<usize> = (0..n_genes).collect();
    let mut out = vec![1.0; counts.len()];
    let before = peak_bytes();
    let used = processor_seconds();
    let best = best_seconds(RUNS, || {
        let matrix = CountMatrix { values: CountValues::Dense(&counts), n_channels: n_genes };
        let transformation = Transformation::default();
        let input = ImputationInput { counts: matrix, transformation, channels: &channels, precision };
        impute_into(&powers, input, f64::from(steps), &mut out, Progress::none()).expect("counts are values");
    });
    let per_row = powers.walk().rows().nnz() as f64 / n as f64;
    println!(
        "{n} cells × {n_genes} genes, {per_row:.1} entries a row, {steps} steps, {precision}: {best:.2} s ({:.2} s of all processors); input and output {} MB, beyond them {} MB",
        (processor_seconds() - used) / RUNS as f64,
        16 * counts.len() / 1_000_000,
        (peak_bytes().saturating_sub(before)) / 1_000_000,
    );
    Ok(())
}

fn neighbors(n: usize, d: usize, k: usize) -> Result<(), Box<dyn std::error::Error>> {
    let values = cells(n, d);
    let (start, used) = (Instant::now(), processor_seconds());
    let lists = nearest_lists(DimensionedPoints { values: &values, n_dimensions: d }, k, Progress::none())?;
    println!(
        "{n} points × {d}, {k} neighbors, exact: {:.1} s ({:.1} s of all processors), {} entries",
        start.elapsed().as_secs_f64(),
        processor_seconds() - used,
        lists.indices.len()
    );
    Ok(())
}

/// Ends of the edges of a graph whose degrees follow a power law.
fn edge(i: u64, n: u64) -> (u64, u64) {
    // The density of the end u falls like u^(−½), so that node 0 has about √n times the mean degree.
    let draw = |i: u64| (0.5 * (noise(i) + 1.0)).powi(2);
    ((draw(2 * i) * n as f64) as u64, (0.5 * (noise(2 * i + 1) + 1.0) * n as f64) as u64)
}

fn power_law(n: usize, n_edges: usize) -> Result<CompressedRows<f64>, Box<dyn std::error::Error>> {
    let list = read_edge_rows(EdgeText::new(n as u64, n_edges as u64), n, Progress::none())?;
    Ok(list.weights)
}

fn scattering(n: usize, precision: Precision) -> Result<(), Box<dyn std::error::Error>> {
    let weights = power_law(n, 5 * n)?;
    let degrees = (0..n).map(|x| weights.row(x).0.len());
    let (largest, nnz) = (degrees.max().unwrap_or(0), weights.nnz());
    let walk = WalkMatrix::from_weights(
        weights,
        WalkOptions { stay: 0.5, ..WalkOptions::default() },
        Progress::none(),
    )?;
    let powers = WalkPowers::new(walk, Progress::none())?;
    let signal: Vec<f64> = (0..n as u64).map(noise).collect();
    let scales = vec![1, 2, 4, 8, 16, 32];
    let params = ScatteringParams::default().with_scales(scales).with_precision(precision);
    let (start, used) = (Instant::now(), processor_seconds());
    let found = scatter(&powers, &signal, 1, &params, Progress::none())?;
    println!(
        "{n} nodes, {nnz} entries, largest degree {largest}, J = 6, {} paths of one channel, {precision}: {:.2} s ({:.2} s of all processors), peak {} MB",
        found.paths.len(),
        start.elapsed().as_secs_f64(),
        processor_seconds() - used,
        peak_bytes() / 1_000_000
    );
    Ok(())
}

fn stream(n: usize, n_edges: usize) -> Result<(), Box<dyn std::error::Error>> {
    let start = Instant::now();
    let weights = power_law(n, n_edges)?;
    let read = start.elapsed().as_secs_f64();
    let largest = (0..n).map(|x| weights.row(x).0.len()).max().unwrap_or(0);
    let walk = WalkMatrix::from_weights(
        weights,
        WalkOptions { stay: 0.5, ..WalkOptions::default() },
        Progress::none(),
    )?;
    let powers = WalkPowers::new(walk, Progress::none())?;
    let signal: Vec<f64> = (0..64 * n as u64).map(noise).collect();
    let mut out = vec![1.0; signal.len()];
    let used = processor_seconds();
    let best = best_seconds(1, || {
        powers.apply_into(&signal, 64, 8, &mut out, Progress::none()).expect("values are finite");
    });
    println!(
        "{n_edges} lines read in {read:.1} s; {n} nodes, {} entries, largest degree {largest}, 64 channels, 8 steps: {best:.1} s ({:.1} s of all processors), peak {} MB",
        powers.walk().rows().nnz(),
        processor_seconds() - used,
        peak_bytes() / 1_000_000
    );
    Ok(())
}

/// Seconds of all processors that the process has used; 0 where the system does not tell.
fn processor_seconds() -> f64 {
    let line = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let words = line.rsplit(')').next().unwrap_or_default().split_whitespace();
    words.skip(11).take(2).filter_map(|word| word.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn best_seconds(n_runs: usize, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..n_runs {
        let start = Instant::now();
        work();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

/// Largest memory of the process so far; 0 where the system does not tell.
fn peak_bytes() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<usize>().ok());
    1024 * kilobytes.unwrap_or(0)
}

/// The text of a list of edges, line by line.
struct EdgeText {
    n_nodes: u64,
    n_edges: u64,
    edge: u64,
    line: Vec<u8>,
    at: usize,
}

impl EdgeText {
    fn new(n_nodes: u64, n_edges: u64) -> Self {
        Self { n_nodes, n_edges, edge: 0, line: Vec::new(), at: 0 }
    }
}

impl Read for EdgeText {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let available = self.fill_buf()?;
        let n = available.len().min(out.len());
        out[..n].copy_from_slice(&available[..n]);
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for EdgeText {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.at == self.line.len() && self.edge < self.n_edges {
            let (u, v) = edge(self.edge, self.n_nodes);
            self.line.clear();
            self.line.extend_from_slice(format!("{u} {v}\n").as_bytes());
            self.at = 0;
            self.edge += 1;
        }
        Ok(&self.line[self.at..])
    }

    fn consume(&mut self, n: usize) {
        self.at += n;
    }
}
