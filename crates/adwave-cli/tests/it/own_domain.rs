//! A domain of a program's own, which stores no rows, in the subcommands: the numbers are those of the library.

use crate::cylinder::{ALONG, AROUND, Cylinder, HOLES};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::filter::{Edit, Gains, Layer, Preset, WeightedLayer};
use adwave::local_fit::LocalFit;
use adwave::region::parse_region;
use adwave_cli::{OwnDomain, Program, run_for};
use adwave_io::{ArrayValues, ReadLimits, read_npy, write_npy};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A cylinder with so many of the holes.
fn open(n_holes: &str) -> Result<Decomposer, String> {
    let n: usize = n_holes.parse().map_err(|_| format!("must be a number of holes, got '{n_holes}'"))?;
    let cylinder = Cylinder::new(&HOLES[..n.min(HOLES.len())]);
    Decomposer::from_domain(cylinder.clone(), cylinder).map_err(|e| e.to_string())
}

/// Runs a command line in a folder, whose name takes the place of `@`.
fn run(folder: &Path, line: &str) -> u8 {
    let domains = [OwnDomain { name: "cylinder", open }];
    let folder = folder.to_str().unwrap();
    let words =
        std::iter::once("adwave".to_owned()).chain(line.split(' ').map(|word| word.replace('@', folder)));
    run_for(Program::default().with_domains(&domains), words, &AtomicBool::new(false))
}

fn read(folder: &Path, name: &str) -> Vec<f64> {
    read_npy(&folder.join(name), &ReadLimits::default()).unwrap().values.to_f64()
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == expected.len() && off < 1e-9, "{what}: {off:e}");
}

fn field() -> Vec<f64> {
    (0..AROUND * ALONG).map(|x| (x % AROUND / 8) as f64 + ((x * x % 17) as f64 / 17.0 - 0.5) / 3.0).collect()
}

#[test]
fn subcommands_run_on_a_domain_of_the_program() {
    let (folder, values) = (tempfile::tempdir().unwrap(), field());
    let at = folder.path();
    write_npy(&at.join("f.npy"), &[values.len()], ArrayValues::F64(&values)).unwrap();
    let domain = open("6").unwrap();
    let schedule = Schedule::dyadic(4).unwrap();
    assert_eq!(run(at, "transform cylinder:6 --signal @/f.npy --levels 4 -q -o @/bands.npz"), 0);
    assert_eq!(
        run(at, "filter cylinder:6 --signal @/f.npy --levels 4 --preset smooth -q -o @/smooth.npy"),
        0
    );
    let layer = WeightedLayer::everywhere(Preset::Suppress.gains(4));
    let expected = domain
        .request(&values, 1, &schedule)
        .local_fit(LocalFit::Linear)
        .filter_layers(std::slice::from_ref(&layer))
        .unwrap();
    assert_close(&read(at, "smooth.npy"), &expected, "a filter");
    let ball = "ball:vertex=300,radius=4";
    let line = format!(
        "filter cylinder:6 --signal @/f.npy --levels 4 --gains 0,0,0,0 --region {ball} -q -o @/ball.npy"
    );
    assert_eq!(run(at, &line), 0);
    let layers = [Layer { gains: Gains::Gains(vec![0.0; 4]), region: parse_region(ball).unwrap() }];
    let mut editor = domain.request(&values, 1, &schedule).local_fit(LocalFit::Linear).editor().unwrap();
    editor.set_edit(&Edit::new(&layers)).unwrap();
    let found = read(at, "ball.npy");
    assert_close(&found, &editor.into_edited(), "a filter of a ball");
    assert!((20..80).contains(&found.iter().zip(&values).filter(|(a, b)| a != b).count()));
    for line in [
        "saliency cylinder:6 --signal @/f.npy --levels 4 -q -o @/saliency.npy",
        "features cylinder:6 --signal @/f.npy --levels 4 -q -o @/features.csv",
        "denoise cylinder:6 --signal @/f.npy -q -o @/clean.npy",
        "info cylinder:6 -q",
    ] {
        assert_eq!(run(at, line), 0, "{line}");
    }
    let clean = read(at, "clean.npy");
    let noise = |f: &[f64]| (0..f.len()).map(|x| (f[x] - (x % AROUND / 8) as f64).powi(2)).sum::<f64>();
    assert!(noise(&clean) < 0.6 * noise(&values), "{} of {}", noise(&clean), noise(&values));
    assert_eq!(read(at, "saliency.npy").len(), values.len());
}

#[test]
fn gaps_are_masked_by_the_domain() {
    let (folder, mut values) = (tempfile::tempdir().unwrap(), field());
    let at = folder.path();
    for x in [3, 4, 44, 700] {
        values[x] = f64::NAN;
    }
    write_npy(&at.join("f.npy"), &[values.len()], ArrayValues::F64(&values)).unwrap();
    assert_eq!(
        run(
            at,
            "filter cylinder:6 --signal @/f.npy --levels 4 --preset smooth --local-fit constant -q -o @/smooth.npy"
        ),
        0
    );
    let holes: Vec<usize> = HOLES.into_iter().chain([3, 4, 44, 700]).collect();
    let cylinder = Cylinder::new(&holes);
    let domain = Decomposer::from_domain(cylinder.clone(), cylinder).unwrap();
    let known: Vec<f64> = values.iter().map(|v| if v.is_nan() { 0.0 } else { *v }).collect();
    let layer = WeightedLayer::everywhere(Preset::Suppress.gains(4));
    let schedule = Schedule::dyadic(4).unwrap();
    let expected = domain.request(&known, 1, &schedule).filter_layers(std::slice::from_ref(&layer)).unwrap();
    for (x, found) in read(at, "smooth.npy").into_iter().enumerate() {
        assert!(
            if values[x].is_nan() { found.is_nan() } else { (found - expected[x]).abs() < 1e-9 },
            "place {x}: {found}, {}",
            expected[x]
        );
    }
}

#[test]
fn what_does_not_apply_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for line in [
        "info cylinder:many -q",
        "info cylinder:6 --operator surface -q",
        "info cone:6 -q",
        "denoise cylinder:6 -q -o @/clean.ply",
    ] {
        assert_eq!(run(folder.path(), line), 2, "{line}");
    }
}
