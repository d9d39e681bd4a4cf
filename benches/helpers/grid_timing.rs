//! Heat and bands on a grid: `grid_timing SIZES SIGMAS ACCURACY ROUNDS VALUES.f32 OUT.f64 [MASK.u8]`.
//!
//! SIZES and SIGMAS are separated by commas, the widths being standard deviations along each axis in places. Prints the
//! seconds of each round and of the processors, and the largest bound of an error relative to a band; OUT gets the coarsest
//! signal. One width is a weighted sum of one band, several are all bands into a buffer that exists.

use adwave::Decomposer;
use adwave::bands::{BandsParams, Schedule};
use adwave::grid::Grid;
use std::error::Error;
use std::time::Instant;

fn numbers<T: std::str::FromStr>(text: &str) -> Result<Vec<T>, T::Err> {
    text.split(',').map(str::parse).collect()
}

/// Seconds of all processors that this process has taken.
fn processor_seconds() -> Result<f64, Box<dyn Error>> {
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let after_name = stat.rsplit_once(')').ok_or("a name in /proc/self/stat")?.1;
    let ticks = after_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
    Ok(ticks.sum::<Result<f64, _>>()? / TICKS)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [sizes, sigmas, accuracy, rounds, values, out, mask @ ..] = &arguments[..] else {
        return Err("SIZES SIGMAS ACCURACY ROUNDS VALUES.f32 OUT.f64 [MASK.u8]".into());
    };
    let sizes: Vec<usize> = numbers(sizes)?;
    let widths: Vec<f64> = numbers::<f64>(sigmas)?.iter().map(|s| s * std::f64::consts::SQRT_2).collect();
    let (accuracy, n_rounds): (f64, usize) = (accuracy.parse()?, rounds.parse()?);
    let bytes = std::fs::read(values)?;
    let values: Vec<f64> = bytes.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect();
    drop(bytes);
    let mut grid = Grid::new(&sizes, &vec![1.0; sizes.len()])?;
    if let [mask] = mask {
        grid = grid.with_kept(std::fs::read(mask)?.into_iter().map(|flag| flag != 0).collect())?;
    }
    let decomposer = Decomposer::from_domain(grid.clone(), grid.heat())?;
    let schedule = Schedule::lengths(&widths, 1.0)?;
    let params = BandsParams::default().with_accuracy(accuracy);
    let request = decomposer.request(&values, 1, &schedule).params(&params);
    let mut bands = vec![0.0; if widths.len() > 1 { (widths.len() + 1) * values.len() } else { 0 }];
    let (mut coarsest, mut error) = (Vec::new(), 0.0_f64);
    for round in 0..n_rounds {
        let (start, before) = (Instant::now(), processor_seconds()?);
        let info = if widths.len() == 1 {
            let (band, info) = request.weighted(&[1.0])?;
            coarsest = band;
            info
        } else {
            request.bands_into(&mut bands)?
        };
        let seconds = start.elapsed().as_secs_f64();
        let busy = processor_seconds()? - before;
        error = error.max(info.error_bound);
        println!("{{\"round\": {round}, \"seconds\": {seconds}, \"processor\": {busy}, \"error\": {error}}}");
    }
    if widths.len() == 1 {
        coarsest.iter_mut().zip(&values).for_each(|(band, value)| *band = value - *band);
    } else {
        coarsest = bands.split_off(widths.len() * values.len());
    }
    std::fs::write(out, coarsest.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())?;
    Ok(())
}
