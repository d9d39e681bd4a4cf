//! Four tests of the survey `botsch2008`: bends shapes by their handles and measures the results, beside those of another
//! program if its files are there.
//!
//! `survey FOLDER [OUT] [LEVELS] [STIFFNESS]` reads `NAME.off`, `NAME.sel` and `NAME.def`, writes `OUT/NAME.off` and measures
//! `OUT/NAME-arap.off` too. LEVELS is a number for all, or numbers separated by commas; or a width in % of the diagonal.

mod metrics;

use adwave::bands::Schedule;
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};
use adwave_deform::{DeformParams, DeformRegions, Deformer, HandleMotion, default_base};
use adwave_io::{ReadLimits, read_path, write_path};
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new(args.first().ok_or("survey FOLDER [OUT] [LEVELS] [STIFFNESS]")?);
    let out = args.get(1).map(Path::new);
    let width: Option<f64> = args.get(2).and_then(|text| text.strip_suffix('%')?.parse().ok());
    let levels: Vec<usize> = match args.get(2).filter(|_| width.is_none()) {
        Some(text) => text.split(',').map(str::parse).collect::<Result<_, _>>()?,
        None => Vec::new(),
    };
    let stiffness: Option<f64> = args.get(3).map(|text| text.parse()).transpose()?;
    let limits = ReadLimits::default();
    println!(
        "| test | method | nodes | σ_J, % | edge strain rms / 99 % | dihedral | folds | crossing | volume | detail |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (k, name) in ["plane", "cylinder", "bar", "cactus"].into_iter().enumerate() {
        let path = |end: &str| folder.join(format!("{name}.{end}"));
        let mut file = read_path(&path("off"), &limits)?;
        let mesh = Mesh::new(file.points().to_vec(), file.faces().clone())?;
        let decomposer = Decomposer::new(&Shape::Mesh(mesh));
        let schedule = match levels.get(k).or(levels.first()) {
            Some(&levels) => Schedule::dyadic(levels)?,
            None if width.is_some() => {
                let sigma = width.unwrap_or_default() / 100.0 * decomposer.extent();
                Schedule::lengths(&[sigma], decomposer.operator().step_length())?
            }
            None => default_base(&decomposer),
        };
        let numbers = |end: &str| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
            let text = std::fs::read_to_string(path(end))?;
            let words = text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace);
            Ok(words.map(str::parse).collect::<Result<_, _>>()?)
        };
        let state = numbers("sel")?;
        let those = |code: f64| (0..).zip(&state).filter(|(_, s)| **s == code).map(|(v, _)| v).collect();
        let regions = DeformRegions { fixed: those(0.0), handles: vec![those(2.0)] };
        let rows = numbers("def")?;
        let matrix: [[f64; 4]; 4] = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| rows[4 * i + j]));
        let start = Instant::now();
        let unit = decomposer.diagonal();
        let first =
            Deformer::bind(&decomposer, &schedule, &regions, &DeformParams::default(), Progress::none())?;
        let params = DeformParams::default().with_stiffness(stiffness.map(|s| s * first.info().spacing));
        let mut deformer = Deformer::bind(&decomposer, &schedule, &regions, &params, Progress::none())?;
        let bound = start.elapsed();
        deformer.set(1, HandleMotion::from_matrix(&matrix)?)?;
        let start = Instant::now();
        let info = deformer.solve(Progress::none())?;
        let points = deformer.points();
        eprintln!("{name}: bound {bound:?}, solved {:?}, {info:?} {:?}", start.elapsed(), deformer.info());
        let print = |method: &str, points: &[[f64; 3]]| {
            let m = metrics::measure(&decomposer, &schedule, points);
            let volume = m.volume.map_or_else(|| "open".to_owned(), |v| format!("{:+.1} %", 100.0 * v));
            let (nodes, sigma) = (deformer.info().n_nodes, 100.0 * deformer.info().sigma / unit);
            println!(
                "| {name} | {method} | {nodes} | {sigma:.1} | {:.3} / {:.3} | {:.2}° | {} | {} | {volume} | {:.3} |",
                m.strain_rms, m.strain_99, m.dihedral, m.folds, m.crossing, m.detail
            );
        };
        print("adwave", &points);
        if let Some(out) = out {
            let theirs = out.join(format!("{name}-arap.off"));
            if theirs.exists() {
                print("libigl", read_path(&theirs, &limits)?.points());
            }
            file.set_points(points)?;
            write_path(&file, &out.join(format!("{name}.off")), None)?;
        }
    }
    Ok(())
}
