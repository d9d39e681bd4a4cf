//! Parts of domains, and domains joined into one.

use adwave::bands::{BandsParams, Schedule};
use adwave::denoise::{DenoiseParams, denoise_signal};
use adwave::domain::DomainError;
use adwave::filter::{Edit, Gains, Layer};
use adwave::grid::Grid;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::region::parse_region;
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, Shape};
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| f64::from(random.next_u32()) / 4_294_967_296.0 - 0.5).collect()
}

fn surface(name: &str, n: usize) -> Decomposer {
    let Sample { points, faces, .. } = Sample::from_name(name, Some(n)).unwrap();
    let mesh = Shape::Mesh(Mesh::new(points, faces).unwrap());
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    Decomposer::with_params(&mesh, &params, Progress::none()).unwrap()
}

fn volume(sizes: &[usize], spacings: &[f64]) -> Decomposer {
    let grid = Grid::new(sizes, spacings).unwrap();
    Decomposer::from_domain(grid.clone(), grid.heat()).unwrap()
}

/// Bands of widths in model units, fine to coarse, and the rest.
fn bands(domain: &Decomposer, signal: &[f64], n_channels: usize, widths: &[f64]) -> Vec<f64> {
    let schedule = Schedule::lengths(widths, domain.operator().step_length()).unwrap();
    domain.decompose(signal, n_channels, &schedule).unwrap().into_vec()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_part_is_the_domain_with_a_mask() {
    for (name, whole) in
        [("surface", surface("knot", 3000)), ("volume", volume(&[9, 8, 11], &[1.0, 1.0, 2.0]))]
    {
        let n = whole.n_vertices();
        // In reverse order, to see that it is the part's.
        let vertices: Vec<u32> = (0..n as u32).rev().filter(|i| i % 7 != 0).collect();
        let part = whole.part(&vertices, &vec![3; vertices.len()], Progress::none()).unwrap();
        let masked = whole.masked(&(0..n).map(|i| i % 7 == 0).collect::<Vec<_>>()).unwrap();
        let signal = noise(2 * n, 3);
        let kept = |values: &[f64]| -> Vec<f64> {
            let of_band = |band: &[f64]| -> Vec<f64> {
                vertices.iter().flat_map(|&i| band[2 * i as usize..][..2].to_vec()).collect()
            };
            values.chunks_exact(2 * n).flat_map(of_band).collect()
        };
        let widths = [1.0, 3.0].map(|w| w * whole.mean_length());
        let expected = kept(&bands(&masked, &signal, 2, &widths));
        let found = bands(&part, &kept(&signal), 2, &widths);
        let off = largest_difference(&found, &expected);
        assert!(off < 1e-9, "{name}: {off:e}");
        assert_eq!(part.n_vertices(), vertices.len());
        assert!((part.extent() - masked.extent()).abs() < 1e-12, "{name}");
        assert_eq!(part.positions().len(), part.n_places());
    }
}

#[test]
fn nothing_flows_between_labels() {
    let whole = volume(&[6, 6, 6], &[1.0; 3]);
    let labels: Vec<u32> = (0..216).map(|i| if i < 108 { 1 } else { 2 }).collect();
    let all: Vec<u32> = (0..216).collect();
    let part = whole.part(&all, &labels, Progress::none()).unwrap();
    let signal: Vec<f64> = labels.iter().map(|l| f64::from(*l)).collect();
    assert_eq!(bands(&part, &signal, 1, &[4.0])[216..], signal, "each label has its own constant");
    let [first, second] =
        [0..108, 108..216].map(|range| whole.part(&all[range], &[5; 108], Progress::none()).unwrap());
    let signal = noise(216, 1);
    let apart =
        [&bands(&first, &signal[..108], 1, &[2.0])[108..], &bands(&second, &signal[108..], 1, &[2.0])[108..]];
    assert!(largest_difference(&bands(&part, &signal, 1, &[2.0])[216..], &apart.concat()) < 1e-10);
}

/// Two surfaces of different size, an anisotropic volume, and a single place.
fn four() -> Vec<Decomposer> {
    let line = volume(&[3], &[0.1]).part(&[1], &[1], Progress::none()).unwrap();
    vec![surface("sphere", 1500), surface("knot", 2500), volume(&[7, 6, 5], &[0.1, 0.1, 0.2]), line]
}

#[test]
fn a_union_is_its_parts() {
    let parts = four();
    let all = Decomposer::union(&parts).unwrap();
    let (n, widths) = (all.n_vertices(), [0.05, 0.2, 0.5]);
    let signal = noise(3 * n, 5);
    let found = bands(&all, &signal, 3, &widths);
    let mut at = 0;
    for (k, part) in parts.iter().enumerate() {
        let rows = 3 * at..3 * (at + part.n_vertices());
        at += part.n_vertices();
        let own = if part.n_vertices() > 1 {
            bands(part, &signal[rows.clone()], 3, &widths)
        } else {
            [vec![0.0; 9], signal[rows.clone()].to_vec()].concat()
        };
        for (band, own) in found.chunks_exact(3 * n).zip(own.chunks_exact(rows.len())) {
            let off = largest_difference(&band[rows.clone()], own);
            assert!(off < 2e-10, "part {k}: {off:e}");
        }
    }
    assert_eq!(at, n);
    let sum: Vec<f64> = (0..3 * n).map(|i| found.chunks_exact(3 * n).map(|band| band[i]).sum()).collect();
    assert!(largest_difference(&sum, &signal) < 1e-14);
    // A constant of each part has no bands, to the last bit.
    let constants: Vec<f64> =
        parts.iter().zip([1.0, -2.0, 3.0, 4.0]).flat_map(|(part, c)| vec![c; part.n_vertices()]).collect();
    assert!(largest_difference(&bands(&all, &constants, 1, &widths)[3 * n..], &constants) < 1e-12);
}

#[test]
fn all_that_works_on_a_domain_works_on_a_union() {
    let parts = four();
    let all = Decomposer::union(&parts).unwrap();
    let n = all.n_vertices();
    // A vertex without a value in each of two parts, and a part without any.
    let mut signal = noise(n, 9);
    signal[3] = f64::NAN;
    signal[1700] = f64::NAN;
    signal[n - 1] = f64::NAN;
    let flags: Vec<bool> = signal.iter().map(|v| v.is_nan()).collect();
    let masked = all.masked(&flags).unwrap();
    let found = bands(&masked, &signal, 1, &[0.2]);
    let first = parts[0].masked(&flags[..parts[0].n_vertices()]).unwrap();
    let own = bands(&first, &signal[..parts[0].n_vertices()], 1, &[0.2]);
    let n_first = parts[0].n_vertices();
    let pairs = found[n..n + n_first].iter().zip(&own[n_first..]);
    assert!(pairs.filter(|(a, _)| !a.is_nan()).all(|(a, b)| (a - b).abs() < 1e-9));
    assert!(found[3].is_nan() && found[n - 1].is_nan());

    let region = parse_region("ball:point=0 0 0,radius=0.5").unwrap();
    let layers = [Layer { gains: Gains::Gains(vec![0.0]), region: region.clone() }];
    let schedule = Schedule::lengths(&[0.2], all.operator().step_length()).unwrap();
    let layers = Edit::new(&layers).resolve(1, all.metric(), Progress::none()).unwrap();
    let signal = noise(n, 2);
    let (edited, _) = all
        .request(&signal, 1, &schedule)
        .params(&BandsParams::default())
        .edit(layers, adwave::EditBits::Accuracy)
        .unwrap();
    let changed = signal.iter().zip(&edited).filter(|(a, b)| a != b).count();
    assert!(changed > 0 && changed < n, "{changed} of {n}");
    let clean = denoise_signal(&all, &signal, 1, &DenoiseParams::default(), Progress::none()).unwrap();
    assert!(clean.values.iter().all(|v| v.is_finite()));
    assert!((clean.info[0].noise / (1.0 / 12.0_f64.sqrt()) - 1.0).abs() < 0.2, "{}", clean.info[0].noise);
}

#[test]
fn wrong_parts_are_refused() {
    let ball = surface("sphere", 300);
    let graph = Decomposer::new(&Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)]).unwrap()));
    assert!(matches!(Decomposer::union(&[]), Err(DomainError::Union { .. })));
    assert!(matches!(Decomposer::union(&[ball.clone(), graph.clone()]), Err(DomainError::Union { .. })));
    let part =
        |of: &Decomposer, vertices: &[u32]| of.part(vertices, &vec![1; vertices.len()], Progress::none());
    assert!(matches!(
        ball.part(&[1, 2], &[1], Progress::none()),
        Err(DomainError::Length { n_found: 1, .. })
    ));
    for (domain, vertices) in [(&ball, &[][..]), (&ball, &[7, 300]), (&ball, &[7, 8, 7]), (&graph, &[0, 1])] {
        assert!(matches!(part(domain, vertices), Err(DomainError::Part { .. })), "{vertices:?}");
    }
}
