//! Shapes bent by their handles, such as the four of the survey `botsch2008`, and measures of the results, beside those
//! of another program if its files are there.
//!
//! `survey FOLDER [OUT] [LEVELS] [STIFFNESS]` reads each `NAME.off` with `NAME.sel` and `NAME.def`, writes
//! `OUT/NAME-detail.off` and `OUT/NAME-lengths.off`, and measures `OUT/NAME-libigl.off` and `OUT/NAME-open3d.off` too.
//! LEVELS is a number for all, or a width in % of the diagonal.

mod metrics;

use adwave::bands::Schedule;
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};
use adwave_deform::{DeformParams, DeformRegions, Deformer, HandleMotion, default_base};
use adwave_io::{ReadLimits, read_path, write_path};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new(args.first().ok_or("survey FOLDER [OUT] [LEVELS] [STIFFNESS]")?);
    let out = args.get(1).map(Path::new);
    let width: Option<f64> = args.get(2).and_then(|text| text.strip_suffix('%')?.parse().ok());
    let levels: Option<usize> =
        args.get(2).filter(|_| width.is_none()).map(|text| text.parse()).transpose()?;
    let stiffness: Option<f64> = args.get(3).map(|text| text.parse()).transpose()?;
    let limits = ReadLimits::default();
    println!(
        "| test | method | s of the processor | edge strain rms / 99 % | dihedral | folds | crossing pairs | volume | detail |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for name in &names(folder)? {
        let path = |end: &str| folder.join(format!("{name}.{end}"));
        let mut file = read_path(&path("off"), &limits)?;
        let mesh = Mesh::new(file.points().to_vec(), file.faces().clone())?;
        let decomposer = Decomposer::new(&Shape::Mesh(mesh));
        let schedule = match levels {
            Some(levels) => Schedule::dyadic(levels)?,
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
        let motion = HandleMotion::from_matrix(&matrix)?;
        let bend = |lengths: f64| -> Result<_, Box<dyn std::error::Error>> {
            let start = processor_seconds();
            let spacing = 0.75 * schedule.sigma(decomposer.operator().step_length()).last().unwrap();
            let params = DeformParams::default()
                .with_stiffness(stiffness.map(|s| s * spacing))
                .with_keep_lengths(lengths);
            let mut deformer = Deformer::bind(&decomposer, &schedule, &regions, &params, Progress::none())?;
            deformer.set(1, motion)?;
            let info = deformer.solve(Progress::none())?;
            let points = deformer.points();
            let seconds = processor_seconds() - start;
            eprintln!("{name}: {info:?} {:?}", deformer.info());
            Ok((points, seconds))
        };
        let print = |method: &str, points: &[[f64; 3]], seconds: Option<f64>| {
            let m = metrics::measure(&decomposer, &schedule, points);
            let volume = m.volume.map_or_else(|| "open".to_owned(), |v| format!("{:+.1} %", 100.0 * v));
            let seconds = seconds.map_or_else(String::new, |s| format!("{s:.2}"));
            println!(
                "| {name} | {method} | {seconds} | {:.4} / {:.3} | {:.2}° | {} | {} | {volume} | {:.3} |",
                m.strain_rms, m.strain_99, m.dihedral, m.folds, m.crossing, m.detail
            );
        };
        for (lengths, ending) in [(0.0, "-detail"), (1.0, "-lengths")] {
            let (points, seconds) = bend(lengths)?;
            print(if lengths > 0.0 { "adwave, lengths" } else { "adwave, detail" }, &points, Some(seconds));
            if let Some(out) = out {
                file.set_points(points)?;
                write_path(&file, &out.join(format!("{name}{ending}.off")), None)?;
            }
        }
        for (program, ending) in [("libigl", "-libigl"), ("Open3D", "-open3d")] {
            let theirs = out.map(|out| out.join(format!("{name}{ending}.off"))).filter(|path| path.exists());
            if let Some(theirs) = theirs {
                print(program, read_path(&theirs, &limits)?.points(), None);
            }
        }
    }
    Ok(())
}

/// Seconds that the processor has spent on this program, as Linux counts them in hundredths; NaN on other systems.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |k: usize| fields.get(k).and_then(|field| field.parse::<f64>().ok()).unwrap_or(f64::NAN);
    (ticks(11) + ticks(12)) / 100.0
}

/// Names of the tests below a folder, ascending.
fn names(folder: &Path) -> Result<Vec<String>, std::io::Error> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "sel") {
            names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    names.sort();
    Ok(names)
}
