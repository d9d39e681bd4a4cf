//! Significant features of images and volumes: none of noise, of slopes and of edges, and all blobs in their place and of
//! their size.

use adwave::bands::{BandsParams, Schedule};
use adwave::features::{Feature, FeatureParams, Refinement, Response, features, value_step};
use adwave::grid::Grid;
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Independent normal noise of variance 1.
fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut uniform = || (f64::from(random.next_u32()) + 0.5) / 4_294_967_296.0;
    (0..n).map(|_| (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()).collect()
}

/// The value of a function of the coordinates at each place, with noise.
fn values(sizes: &[usize], f: impl Fn(&[f64; 3]) -> f64, deviation: f64, seed: u64) -> Vec<f64> {
    let n: usize = sizes.iter().product();
    let noise = noise(n, seed);
    let value = |place: usize| {
        let (mut at, mut rest) = ([0.0; 3], place);
        for axis in (0..sizes.len()).rev() {
            at[axis] = (rest % sizes[axis]) as f64;
            rest /= sizes[axis];
        }
        f(&at) + deviation * noise[place]
    };
    (0..n).map(value).collect()
}

fn found_with(grid: &Grid, values: &[f64], params: &FeatureParams) -> Vec<Feature> {
    let decomposer = Decomposer::from_domain(grid.clone(), grid.heat()).unwrap();
    assert!(params.finds_significant(&decomposer));
    let schedule = Schedule::dyadic(9).unwrap();
    let bands = BandsParams::default().with_accuracy(decomposer.analysis_accuracy());
    let wavelets = decomposer.request(values, 1, &schedule).params(&bands).norms().unwrap();
    features(&decomposer, &wavelets, &params.with_value_step(value_step(values)), Progress::none()).unwrap()
}

fn found(grid: &Grid, values: &[f64]) -> Vec<Feature> {
    found_with(grid, values, &FeatureParams::default())
}

fn even(sizes: &[usize]) -> Grid {
    Grid::new(sizes, &vec![1.0; sizes.len()]).unwrap()
}

#[test]
fn noise_slopes_edges_and_rounded_values_have_no_features() {
    type Scene = (&'static str, fn(&[f64; 3]) -> f64);
    let scenes: [Scene; 5] = [
        ("noise", |_| 0.0),
        ("slope", |p| 0.7 * p[0] - 0.3 * p[1] + 0.2 * p[2]),
        ("bowl", |p| 0.002 * ((p[0] - 60.0).powi(2) + (p[1] - 30.0).powi(2) + p[2] * p[2])),
        ("step", |p| if 0.8 * p[0] + 0.6 * p[1] + 0.1 * p[2] > 60.0 { 9.0 } else { 0.0 }),
        ("disk", |p| if (p[0] - 55.0).hypot(p[1] - 50.0) < 31.0 { 25.0 } else { 0.0 }),
    ];
    for sizes in [vec![150, 130], vec![40, 60, 50], vec![6000]] {
        let grid = even(&sizes);
        // In a sequence a step stands out as a bump does.
        let n_scenes = if sizes.len() == 1 { 3 } else { scenes.len() };
        for (name, scene) in scenes.into_iter().take(n_scenes) {
            for (deviation, seed) in [(0.0, 0), (0.02, 1), (1.0, 2), (1.0, 3)] {
                let exact = values(&sizes, scene, deviation, seed);
                // In whole numbers the steps of a slope are wide.
                let whole: Vec<f64> = exact.iter().map(|v| (0.2 * v).round()).collect();
                for (kind, values) in [("exact", exact), ("whole", whole)] {
                    let found = found(&grid, &values);
                    assert!(found.is_empty(), "{name} {kind} {deviation} {sizes:?}: {:?}", found[0]);
                }
            }
        }
    }
}

#[test]
fn noise_that_neighbors_share_has_no_features() {
    let grid = even(&[200, 220]);
    let decomposer = Decomposer::from_domain(grid.clone(), grid.heat()).unwrap();
    for (sigma, seed) in [(0.7, 1), (1.0, 2), (1.5, 3)] {
        let smooth = Schedule::lengths(&[sigma * 2.0_f64.sqrt()], 1.0).unwrap();
        let noise = decomposer.decompose(&noise(grid.n_places(), seed), 1, &smooth).unwrap();
        let found = found(&grid, noise.coarsest());
        assert!(found.len() <= usize::from(sigma > 1.0) * 4, "{sigma}: {}", found.len());
    }
}

/// Places of four blobs, three above and one below their surroundings, in units of the spacings.
fn four_blobs(sizes: &[usize], spacings: &[f64]) -> Vec<([f64; 3], f64)> {
    let blob = |k: usize| {
        let part = [[0.3, 0.7][k % 2], [0.3, 0.71][k / 2], 0.5];
        let along = |c: usize| sizes.get(c).map_or(0.0, |n| (part[c] * *n as f64).round() * spacings[c]);
        (std::array::from_fn(along), if k == 2 { -1.0 } else { 1.0 })
    };
    (0..4).map(blob).collect()
}

/// Distance of two points.
fn away(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
}

/// Gaussian of the distance of two points.
fn blob(a: &[f64; 3], b: &[f64; 3], sigma: f64) -> f64 {
    (-away(a, b).powi(2) / (2.0 * sigma * sigma)).exp()
}

/// Asserts that each of the blobs is the nearest feature to its place, of its size and of its sign.
fn assert_found(found: &[Feature], blobs: &[([f64; 3], f64)], size: f64, name: &str) {
    for (center, sign) in blobs {
        let distance = |f: &Feature| away(&f.position.unwrap(), center);
        let nearest = found.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let nearest = nearest.unwrap_or_else(|| panic!("{name}: no features"));
        assert!(distance(nearest) <= 0.5 * size, "{name}: {}", distance(nearest));
        assert!((nearest.sigma / size - 1.0).abs() < 0.25, "{name}: {}", nearest.sigma);
        assert_eq!(f64::from(nearest.sign()), *sign, "{name}");
    }
}

#[test]
fn blobs_are_found_in_their_place_and_of_their_size() {
    for (sizes, spacings) in [(vec![160, 180], [1.0, 1.0, 1.0]), (vec![48, 60, 40], [1.0, 1.0, 1.5])] {
        let grid = Grid::new(&sizes, &spacings[..sizes.len()]).unwrap();
        let blobs = four_blobs(&sizes, &spacings);
        for (size, deviation) in [(2.0, 0.0), (2.0, 0.05), (3.3, 0.1), (4.0, 0.2)] {
            let scene = |at: &[f64; 3]| {
                let at = std::array::from_fn(|c| at[c] * spacings[c]);
                blobs.iter().map(|(center, sign)| sign * blob(&at, center, size)).sum()
            };
            let values = values(&sizes, scene, deviation, 5);
            let params = FeatureParams::default().with_refinement(Refinement::Quadratic);
            let found = found_with(&grid, &values, &params);
            assert_eq!(found.len(), blobs.len(), "{size} {deviation}: {found:?}");
            assert_found(&found, &blobs, size, &format!("{size} {deviation}"));
        }
    }
}

#[test]
fn blobs_on_a_hill_ten_times_as_high_are_found() {
    for (sizes, size, deviation) in
        [(vec![160, 180], 2.0, 0.02), (vec![160, 180], 3.0, 0.05), (vec![48, 60, 40], 2.0, 0.02)]
    {
        let blobs = four_blobs(&sizes, &[1.0; 3]);
        let middle = std::array::from_fn(|c| sizes.get(c).map_or(0.0, |n| 0.5 * *n as f64));
        let scene = |at: &[f64; 3]| {
            let spots: f64 = blobs.iter().map(|(center, sign)| sign * blob(at, center, size)).sum();
            spots + 10.0 * blob(at, &middle, 5.0 * size)
        };
        let found = found(&even(&sizes), &values(&sizes, scene, deviation, 5));
        assert_found(&found, &blobs, size, &format!("{sizes:?} {size} {deviation}"));
    }
}

#[test]
fn the_order_of_the_axes_changes_no_feature() {
    let sizes = [90, 120];
    let blobs = |p: &[f64; 3]| {
        (-((p[0] - 30.0).powi(2) + (p[1] - 40.0).powi(2)) / 18.0).exp()
            - (-((p[0] - 60.0).powi(2) + (p[1] - 80.0).powi(2)) / 50.0).exp()
    };
    let upright = values(&sizes, blobs, 0.05, 9);
    let turned: Vec<f64> = (0..upright.len()).map(|i| upright[(i % 90) * 120 + i / 90]).collect();
    let mut first = found(&even(&sizes), &upright);
    let mut second = found(&even(&[120, 90]), &turned);
    for feature in &mut second {
        feature.position = feature.position.map(|[x, y, z]| [y, x, z]);
    }
    for list in [&mut first, &mut second] {
        list.sort_by(|a, b| a.position.partial_cmp(&b.position).unwrap());
    }
    assert_eq!(first.len(), 2);
    for (a, b) in first.iter().zip(&second) {
        assert_eq!((a.position, a.level, a.sign()), (b.position, b.level, b.sign()));
        // Patches in which noise is measured have other places.
        assert!((a.sigma / b.sigma - 1.0).abs() < 1e-6 && (a.strength / b.strength - 1.0).abs() < 0.1);
    }
}

#[test]
fn places_next_to_a_mask_have_no_features_and_theta_is_the_rule_of_the_paper() {
    let sizes = [100, 100];
    let kept = (0..10_000).map(|x| x / 100 > 20 || x % 100 > 50).collect();
    let grid = even(&sizes).with_kept(kept).unwrap();
    let ramp_and_blob =
        |p: &[f64; 3]| 3.0 * p[0] + 20.0 * (-((p[0] - 60.0).powi(2) + (p[1] - 50.0).powi(2)) / 32.0).exp();
    let values = values(&sizes, ramp_and_blob, 0.3, 2);
    let found = found(&grid, &values);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].vertex, 6050);
    let decomposer = Decomposer::from_domain(grid.clone(), grid.heat()).unwrap();
    for params in
        [FeatureParams::default().with_theta(2.0), FeatureParams::default().with_response(Response::Literal)]
    {
        assert!(!params.finds_significant(&decomposer));
    }
}
