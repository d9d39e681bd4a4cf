//! Thin walls of clouds: given normals keep sheets apart that are closer than their points.

use adwave::filter::{Preset, WeightedLayer};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::{PointCloud, Shape};
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Points along a side of a plate.
const SIDE: u32 = 40;

/// Largest relative change of the thickness of a plate.
const KEPT: f64 = 0.03;

/// Two rough sheets of jittered points one unit apart, `gap` above each other, the upper ones first.
fn plate(gap: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut noise = |size: f64| size * 2.0 * (f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5);
    let heights = [gap, 0.0];
    let mut points = Vec::new();
    for height in heights {
        for i in 0..SIDE * SIDE {
            let (x, y) = (f64::from(i % SIDE), f64::from(i / SIDE));
            points.push([x + noise(0.3), y + noise(0.3), height + noise(0.08)]);
        }
    }
    points
}

/// Normals of the two sheets, multiplied by `sign` of the point.
fn normals(sign: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
    let n = (SIDE * SIDE) as usize;
    (0..2 * n).map(|x| [0.0, 0.0, sign(x) * if x < n { 2.0 } else { -1.0 }]).collect()
}

fn smoothed(cloud: PointCloud, kind: OperatorKind) -> Vec<[f64; 3]> {
    let points = cloud.points().to_vec();
    let params = OperatorParams { kind, ..OperatorParams::default() };
    let decomposer = Decomposer::with_params(&Shape::Cloud(cloud), &params, Progress::none()).unwrap();
    let schedule = decomposer.default_schedule().schedule;
    let layer = WeightedLayer::everywhere(Preset::Suppress.gains(schedule.n_levels()));
    let smooth = decomposer.request(points.as_flattened(), 3, &schedule).filter_layers(&[layer]).unwrap();
    smooth.as_chunks().0.to_vec()
}

fn thickness(points: &[[f64; 3]]) -> f64 {
    let n = points.len() / 2;
    let mean = |part: &[[f64; 3]]| part.iter().map(|p| p[2]).sum::<f64>() / n as f64;
    mean(&points[..n]) - mean(&points[n..])
}

#[test]
fn opposite_normals_keep_a_plate_as_thick_as_it_is() {
    for gap in [1.0, 0.5, 0.25] {
        for seed in 0..2 {
            for sign in [1.0, -1.0] {
                let cloud = PointCloud::new(plate(gap, seed)).unwrap().with_normals(normals(|_| sign));
                for kind in [OperatorKind::Walk, OperatorKind::Surface] {
                    let found = thickness(&smoothed(cloud.clone(), kind));
                    assert!((found / gap - 1.0).abs() < KEPT, "{gap} {kind:?}: {found}");
                }
            }
        }
    }
}

#[test]
fn normals_of_arbitrary_sign_and_of_one_sheet_change_nothing() {
    let n = (SIDE * SIDE) as usize;
    let points = plate(1.0, 5)[..n].to_vec();
    let plain = PointCloud::new(points).unwrap();
    let expected = smoothed(plain.clone(), OperatorKind::Walk);
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let signs: Vec<f64> = (0..n).map(|_| if random.next_u32() % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let few: Vec<f64> = (0..n).map(|x| if x % 17 == 0 { -1.0 } else { 1.0 }).collect();
    for signs in [signs, few, vec![1.0; n], vec![0.0; n], vec![f64::NAN; n]] {
        let given = normals(|x| signs[x % n])[..n].to_vec();
        assert_eq!(smoothed(plain.clone().with_normals(given), OperatorKind::Walk), expected);
    }
}
