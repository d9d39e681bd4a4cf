//! Guarantees of thinned clouds, checked by brute force.

use adwave::Progress;
use adwave::sample::Sample;
use adwave::shape::PointCloud;
use adwave_simplify::{CloudTarget, SimplifyError, simplify_cloud};
use proptest::prelude::*;

fn cloud(n: usize) -> PointCloud {
    PointCloud::new(Sample::from_name("creature", Some(n)).unwrap().points).unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
}

/// Smallest distance between kept points, and largest and mean squared distance from any point to the nearest kept one.
fn by_brute_force(points: &[[f64; 3]], kept: &[u32]) -> (f64, f64, f64) {
    let at = |k: &u32| points[*k as usize];
    let mut least = f64::INFINITY;
    for (i, a) in kept.iter().enumerate() {
        least = kept[..i].iter().map(|b| distance(at(a), at(b))).fold(least, f64::min);
    }
    let nearest = |p: [f64; 3]| kept.iter().map(|k| distance(p, at(k))).fold(f64::INFINITY, f64::min);
    let distances: Vec<f64> = points.iter().map(|&p| nearest(p)).collect();
    let square = distances.iter().map(|d| d * d).sum::<f64>() / points.len() as f64;
    (least, distances.into_iter().fold(0.0, f64::max), square)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn kept_points_are_apart_and_dropped_ones_near(
        points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..200),
        spacing in 0.01..1.5_f64,
    ) {
        let cloud = PointCloud::new(points.clone()).unwrap();
        let thinned = simplify_cloud(&cloud, CloudTarget::Spacing(spacing), Progress::none()).unwrap();
        let (least, greatest, square) = by_brute_force(&points, &thinned.kept);
        prop_assert!(least >= spacing);
        prop_assert!(greatest < spacing);
        prop_assert!((thinned.deviation.greatest() - greatest).abs() < 1e-12);
        prop_assert!((thinned.deviation.rms() - square.sqrt()).abs() < 1e-12);
    }
}

#[test]
fn numbers_of_points_are_met() {
    let cloud = cloud(8000);
    for n in [6000, 2000, 200, 20] {
        let found = simplify_cloud(&cloud, CloudTarget::Points(n), Progress::none()).unwrap().kept.len();
        assert!(found.abs_diff(n) <= 1 + n / 50, "{found} in place of {n}");
        let about = simplify_cloud(&cloud, CloudTarget::About(n), Progress::none()).unwrap().kept.len();
        assert!(about.abs_diff(n) <= 1 + n / 5, "{about} in place of about {n}");
    }
    let half = simplify_cloud(&cloud, CloudTarget::Ratio(0.5), Progress::none()).unwrap().kept.len();
    assert!(half.abs_diff(cloud.points().len() / 2) <= 80);
    let all = simplify_cloud(&cloud, CloudTarget::Points(1_000_000), Progress::none()).unwrap();
    assert_eq!(all.kept.len(), cloud.points().len());
}

#[test]
fn the_order_of_the_points_does_not_matter() {
    let cloud = cloud(3000);
    let reversed = PointCloud::new(cloud.points().iter().rev().copied().collect()).unwrap();
    let kept = |cloud: &PointCloud| {
        let thinned = simplify_cloud(cloud, CloudTarget::Spacing(0.05), Progress::none()).unwrap();
        let mut kept: Vec<[u64; 3]> =
            thinned.kept.iter().map(|&x| cloud.points()[x as usize].map(f64::to_bits)).collect();
        kept.sort_unstable();
        kept
    };
    assert_eq!(kept(&cloud), kept(&reversed));
}

#[test]
fn clouds_as_odd_as_they_come() {
    let thin = |points: Vec<[f64; 3]>, target| {
        simplify_cloud(&PointCloud::new(points).unwrap(), target, Progress::none()).map(|t| t.kept.len())
    };
    assert_eq!(thin(vec![[1.0; 3]], CloudTarget::Spacing(1.0)), Ok(1));
    assert_eq!(thin(vec![[1.0; 3]; 50_000], CloudTarget::Spacing(1e-300)), Ok(1));
    assert_eq!(thin(vec![[1.0; 3]; 50_000], CloudTarget::Points(7)), Ok(1));
    // Spacing 0 keeps all points, including those at equal positions.
    assert_eq!(thin(vec![[1.0; 3]; 50_000], CloudTarget::Spacing(0.0)), Ok(50_000));
    assert_eq!(thin(vec![[0.0; 3], [1e90, 0.0, 0.0]], CloudTarget::Spacing(1e-90)), Ok(2));
    assert_eq!(thin(vec![[0.0; 3], [1e-200, 0.0, 0.0]], CloudTarget::Spacing(1e-199)), Ok(1));
    assert_eq!(thin(vec![[0.0; 3], [1.0; 3]], CloudTarget::Spacing(f64::MAX)), Ok(1));
    assert_eq!(thin(vec![[0.0; 3]], CloudTarget::Points(0)), Err(SimplifyError::NoVertices));
    assert_eq!(
        thin(vec![[0.0; 3]], CloudTarget::Spacing(f64::INFINITY)),
        Err(SimplifyError::Length(f64::INFINITY))
    );
    // On a grid the number of kept points changes in jumps.
    let grid: Vec<[f64; 3]> = (0..2500).map(|k| [f64::from(k % 50), f64::from(k / 50), 0.0]).collect();
    let n = thin(grid, CloudTarget::Points(2000)).unwrap();
    assert!(n > 0 && n <= 2500, "{n}");
}
