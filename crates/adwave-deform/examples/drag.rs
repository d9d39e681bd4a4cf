//! Times of binding, dragging and releasing a handle on the built-in creature, and how far dragging lags behind.
//!
//! `drag [VERTICES …]`; 50 000 and 500 000 without a number. The lower tenth along y is held, the upper tenth turns by 60° in 40
//! steps.

use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::vector::{norm, subtract};
use adwave::{Decomposer, Progress};
use adwave_deform::{DeformParams, DeformRegions, Deformer, HandleMotion, default_base};
use std::time::Instant;

/// Seconds of all threads of this program so far, where the system tells.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = text.rsplit(')').next().unwrap_or_default().split_whitespace();
    // Hundredths of a second in user and system mode, the 14th and the 15th field.
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Number of motions of the mouse.
const MOTIONS: u32 = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut sizes: Vec<usize> = std::env::args().skip(1).map(|arg| arg.parse()).collect::<Result<_, _>>()?;
    if sizes.is_empty() {
        sizes = vec![50_000, 500_000];
    }
    println!(
        "| vertices | nodes | bind, s | new handles, s | update, ms: least, median | step, points, CPU | release, s | lag, % |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for size in sizes {
        let sample = Sample::from_name("creature", Some(size))?;
        let mut heights: Vec<f64> = sample.points.iter().map(|p| p[1]).collect();
        heights.sort_by(f64::total_cmp);
        let (low, high) = (heights[heights.len() / 10], heights[heights.len() * 9 / 10]);
        let those = |inside: &dyn Fn(f64) -> bool| {
            (0..).zip(&sample.points).filter(|(_, p)| inside(p[1])).map(|(v, _)| v).collect::<Vec<u32>>()
        };
        let regions = DeformRegions { fixed: those(&|y| y < low), handles: vec![those(&|y| y > high)] };
        let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces)?));
        let schedule = default_base(&decomposer);
        let params = DeformParams::default();
        let (start, before) = (Instant::now(), cpu_seconds());
        let mut deformer = Deformer::bind(&decomposer, &schedule, &regions, &params, Progress::none())?;
        let (bind, bind_cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - before);
        let start = Instant::now();
        drop(deformer.rebind(&regions, Progress::none())?);
        let rebind = start.elapsed().as_secs_f64();
        let center = [0.0, 0.5 * (low + high), 0.0];
        let motion = |k: u32| {
            let angle = 60_f64.to_radians() * f64::from(k) / f64::from(MOTIONS);
            HandleMotion::from_turn([0.0, 0.0, 1.0], angle, center)
        };
        let mut points = vec![[0.0; 3]; sample.points.len()];
        let (mut updates, mut parts, mut cpu) = (Vec::new(), [0.0, 0.0], [0.0, 0.0]);
        for k in 1..=MOTIONS {
            let (start, before) = (Instant::now(), cpu_seconds());
            deformer.set(1, motion(k)?)?;
            deformer.step(Progress::none())?;
            let (stepped, between) = (start.elapsed().as_secs_f64(), cpu_seconds());
            deformer.points_into(&mut points);
            cpu = [cpu[0] + between - before, cpu[1] + cpu_seconds() - between];
            let all = start.elapsed().as_secs_f64();
            updates.push(1e3 * all);
            parts = [parts[0] + 1e3 * stepped, parts[1] + 1e3 * (all - stepped)];
        }
        updates.sort_by(f64::total_cmp);
        let start = Instant::now();
        let info = deformer.solve(Progress::none())?;
        let released = deformer.points();
        let release = start.elapsed().as_secs_f64();
        let lag = points.iter().zip(&released).map(|(p, q)| norm(&subtract(p, q))).fold(0.0, f64::max);
        println!(
            "| {} | {} | {bind:.2}; CPU {bind_cpu:.2} | {rebind:.2} | {:.0}, {:.0} | {:.0}, {:.0}; CPU {:.0}, {:.0} | {release:.2} | {:.2} |",
            sample.points.len(),
            deformer.info().n_nodes,
            updates[0],
            updates[updates.len() / 2],
            parts[0] / f64::from(MOTIONS),
            parts[1] / f64::from(MOTIONS),
            1e3 * cpu[0] / f64::from(MOTIONS),
            1e3 * cpu[1] / f64::from(MOTIONS),
            100.0 * lag / decomposer.diagonal()
        );
        eprintln!("{info:?}");
    }
    Ok(())
}
