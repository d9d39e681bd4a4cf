//! Thin walls of clouds: given normals keep sheets apart that are closer than their points.

use adwave::filter::{Preset, WeightedLayer};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::{PointCloud, Shape, nearest_neighbors};
use adwave::signal::close_sheets;
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
    let params = OperatorParams::default().with_kind(kind);
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

#[test]
fn sheets_without_normals_are_reported_and_shapes_of_one_sheet_are_not() {
    let find = |points: &[[f64; 3]]| {
        let near = nearest_neighbors(points, 10);
        close_sheets(points, &near.adjacency, Progress::none()).unwrap()
    };
    let mut state = 5_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31)
    };
    let mut square = |height: &dyn Fn(f64, f64) -> f64, noise: f64| -> Vec<[f64; 3]> {
        (0..1500)
            .map(|_| {
                let (x, y) = (39.0 * random(), 39.0 * random());
                let bell = (0..6).map(|_| random() - 0.5).sum::<f64>() * std::f64::consts::SQRT_2;
                [x, y, height(x, y) + noise * bell]
            })
            .collect()
    };
    // One sheet: flat, rough, curved, with a crease, with a step, steep.
    for noise in [0.0, 0.05, 0.3, 1.0] {
        let shapes: [&dyn Fn(f64, f64) -> f64; 6] = [
            &|_, _| 0.0,
            &|x, y| (x / 3.0).sin() * (y / 4.0).cos(),
            &|x, _| 0.04 * x * x,
            &|x, _| (x - 20.0).abs(),
            &|x, _| if x > 20.0 { 8.0 } else { 0.0 },
            &|x, y| 3.0 * x + y,
        ];
        for (k, height) in shapes.into_iter().enumerate() {
            let points = square(height, noise);
            assert_eq!(find(&points), None, "shape {k}, noise {noise}");
        }
    }
    // Two sheets, at several distances in spacings, flat and curved.
    for gap in [0.3, 0.5, 1.0] {
        for bend in [0.0, 0.01] {
            let lower = square(&|x, _| bend * x * x, 0.05 * gap);
            let upper = square(&|x, _| bend * x * x + gap, 0.05 * gap);
            let points: Vec<[f64; 3]> = lower.into_iter().chain(upper).collect();
            let sheets = find(&points).unwrap_or_else(|| panic!("gap {gap}, bend {bend}"));
            assert!(sheets.share > 0.1, "gap {gap}, bend {bend}: {sheets:?}");
            assert!((sheets.distance / gap - 1.0).abs() < 0.25, "gap {gap}, bend {bend}: {sheets:?}");
        }
    }
}
