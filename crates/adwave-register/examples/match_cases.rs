//! Experiments.
#[path = "../tests/cases/mod.rs"]
mod cases;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, read_path};
use adwave_register::{Motion, Registrand, SearchParams, common_lengths, describe_shape, search_motions};
use cases::{Random, Surface, Terrain};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

struct Case {
    name: String,
    first: Surface,
    second: Surface,
    truth: Option<Motion>,
    scaled: bool,
}

fn load(path: &str) -> Surface {
    let file = read_path(Path::new(path), &ReadLimits::default()).unwrap();
    let triangles = adwave::shape::triangulate(file.points(), file.faces());
    Surface { points: file.points().to_vec(), triangles }
}

fn make(kind: &str, seed: u64, files: &[String]) -> Option<Case> {
    let mut r = Random::new(1000 + seed);
    let noise = [0.0, 0.1, 0.2][(seed % 3) as usize];
    let file = |k: u64| load(&files[(k % files.len() as u64) as usize]);
    let (first, second, truth) = match kind {
        "t-un" => (
            Terrain::new(2 * seed).patch(0.0, 0.0, 70, 70),
            Terrain::new(2 * seed + 1).patch(0.3, 0.4, 70, 70),
            false,
        ),
        "t-25" | "t-30" | "t-50" => {
            let o: f64 = kind[2..].parse::<f64>().unwrap() / 100.0;
            let t = Terrain::new(2 * seed);
            let shift = (80.0 * (1.0 - o)).round();
            (t.patch(0.0, 0.0, 80, 80), t.patch(shift + 0.37, 0.61, 80, 79), true)
        }
        "s-un" => (file(seed), file(seed + 1 + seed / files.len() as u64), false),
        "s-25" | "s-30" | "s-50" => {
            let o: f64 = kind[2..].parse::<f64>().unwrap() / 100.0;
            let [a, b] = file(seed).overlapping(&r.direction(), o);
            (a, b, true)
        }
        "s-dis" => {
            let [a, b] = file(seed).parts(&r.direction(), 0.45, 0.55);
            (a, b, false)
        }
        "s-id" => {
            let s = file(seed);
            (s.clone(), s, true)
        }
        "v-60" | "v-90" | "v-120" => {
            let s = file(seed);
            let degrees: f64 = kind[2..].parse().unwrap();
            let (a, b) = (r.direction(), r.direction());
            let c = adwave::vector::unit(&adwave::vector::cross(&a, &b)).unwrap();
            let (sin, cos) = degrees.to_radians().sin_cos();
            let e = adwave::vector::cross(&c, &a);
            let d: [f64; 3] = std::array::from_fn(|k| cos * a[k] + sin * e[k]);
            (s.view(&a), s.view(&d), true)
        }
        _ => return None,
    };
    let motion = r.motion(50.0);
    let (first, second) =
        (first.noisy(noise, 7 * seed + 1), second.noisy(noise, 7 * seed + 2).moved(&motion));
    Some(Case {
        name: format!("{kind} {seed}"),
        first,
        second,
        truth: truth.then_some(motion),
        scaled: false,
    })
}

fn run(case: &Case) -> String {
    let t0 = Instant::now();
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let d = [&case.first, &case.second]
        .map(|s| Decomposer::with_params(&s.shape(), &params, Progress::none()).unwrap());
    let lengths = common_lengths(&d[0], &d[1]).unwrap();
    let theta = std::env::var("TH").map_or(1.0, |t| t.parse().unwrap());
    let f = [0, 1].map(|k| describe_shape(&d[k], None, &lengths, theta, Progress::none()).unwrap());
    let n = [f[0].features.len(), f[1].features.len()];
    let [fa, fb] = f;
    let t1 = Instant::now();
    let a = Registrand::new(&d[0], fa, Progress::none()).unwrap().unwrap();
    let b = Registrand::new(&d[1], fb, Progress::none()).unwrap().unwrap();
    let found = search_motions(
        &a,
        &b,
        &SearchParams { scaled: case.scaled, ..SearchParams::default() },
        Progress::none(),
    )
    .unwrap();
    let t2 = Instant::now();
    let mut out = format!(
        "# {} verts {} {} features {} {} describe {:.2} search {:.2}\n",
        case.name,
        case.first.points.len(),
        case.second.points.len(),
        n[0],
        n[1],
        (t1 - t0).as_secs_f64(),
        (t2 - t1).as_secs_f64()
    );
    if let Some(t) = &case.truth {
        let pairs = adwave_register::pairs_under(
            &a.features.keys,
            &b.features.keys,
            t,
            b.area,
            &adwave_register::PairParams::default(),
        );
        let close = pairs.iter().filter(|p| p.sigmas < 0.5).count();
        let mut rank = [0usize; 12];
        for p in &pairs {
            let d = |i: usize| -> f64 {
                a.features.descriptors[p.first]
                    .iter()
                    .zip(&b.features.descriptors[i])
                    .map(|(x, y)| (x - y) * (x - y))
                    .sum()
            };
            let own = d(p.second);
            let r = (0..b.features.keys.len())
                .filter(|&i| {
                    b.features.keys[i].sign == a.features.keys[p.first].sign
                        && (b.features.keys[i].sigma / a.features.keys[p.first].sigma).log2().abs() < 0.75
                        && d(i) < own
                })
                .count();
            rank[r.min(11)] += 1;
        }
        let f = adwave_register::fit_under(&a, &b, t);
        out += &format!(
            "truth {} pairs {} close {close} ranks {rank:?} info {:.1} agree {:.3} cost {:.3} conflict {:.3} overlap {:.3} median {:.5}\n",
            case.name,
            pairs.len(),
            f.information,
            f.agreement,
            f.cost,
            f.conflict,
            f.overlap,
            f.median / a.extent
        );
    }
    for (label, list) in [("real", &found.motions), ("null", &found.chance)] {
        for m in list.iter().take(if label == "real" { 2 } else { 1 }) {
            let err = case
                .truth
                .as_ref()
                .map_or(-1.0, |t| 100.0 * m.motion.difference(t, &case.first.points) / a.extent);
            let f = m.fit;
            out += &format!(
                "{label} {} err {err:.3} info {:.1} agree {:.3} cost {:.3} conflict {:.3} overlap {:.3} median {:.5} medprec {:.2}\n",
                case.name,
                f.information,
                f.agreement,
                f.cost,
                f.conflict,
                f.overlap,
                f.median / a.extent,
                f.median / a.spacing
            );
        }
    }
    out
}

fn main() {
    let mut args = std::env::args().skip(1);
    let kinds: Vec<String> = args.next().unwrap().split(',').map(str::to_owned).collect();
    let (lo, hi): (u64, u64) = (args.next().unwrap().parse().unwrap(), args.next().unwrap().parse().unwrap());
    let files: Vec<String> = args.collect();
    let jobs: Vec<(String, u64)> = (lo..hi).flat_map(|s| kinds.iter().map(move |k| (k.clone(), s))).collect();
    let start = Instant::now();
    jobs.par_iter().for_each(|(k, s)| {
        if start.elapsed().as_secs() > 170 {
            return;
        }
        let case = make(k, *s, &files).unwrap();
        if case.first.points.len() < 50 || case.second.points.len() < 50 {
            return;
        }
        print!("{}", run(&case));
    });
}
