//! The law of a bump: on a plane, with the height of one Gaussian bump as the signal, the strongest feature sits on the top, at
//! a size that fits the bump's width and does not depend on the mesh. What holds for which response, and the closed forms
//! behind it, are in docs/THEORY.md.

use crate::common;

use adwave::bands::{Schedule, Wavelets};
use adwave::features::{Feature, FeatureParams, Refinement, Response, features};
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};
use std::f64::consts::PI;

/// Standard deviation of the bump; the plane is [−1, 1]².
const WIDTH: f64 = 0.12;
/// Squares along a side, and levels up to the same σ: the mesh, 4 times and 16 times as fine.
const MESHES: [(u32, usize); 3] = [(60, 9), (120, 11), (240, 13)];
/// Largest error of the size relative to the bump's width, and change when the mesh is refined.
const SIZE: f64 = 0.15;
/// The plane's border and the size of its triangles, where a closed form has neither.
const CLOSED_FORM: f64 = 0.03;

/// The bump of height 1 over `top`.
fn bump(p: &[f64; 3], top: [f64; 2]) -> f64 {
    (-((p[0] - top[0]).powi(2) + (p[1] - top[1]).powi(2)) / (2.0 * WIDTH * WIDTH)).exp()
}

/// Relief of equal amplitude in every octave: half-waves as long as the plane, a half, a quarter … a thirty-second of it, with
/// no slope across the border, so that the border adds nothing.
fn relief(p: &[f64; 3]) -> f64 {
    let octave = |i: i32| {
        let k = 0.5 * PI * f64::from(1 << i);
        (k * (p[0] + 1.0)).cos() * (k * (p[1] + 1.0)).cos()
    };
    (0..6).map(octave).sum()
}

struct Ground {
    decomposer: Decomposer,
    bands: Wavelets,
}

impl Ground {
    fn new(n: u32, levels: usize, height: &dyn Fn(&[f64; 3]) -> f64) -> Self {
        let (points, faces) = common::plane(n);
        let shape = Shape::Mesh(Mesh::new(points, faces).unwrap());
        let decomposer = Decomposer::new(&shape);
        let height: Vec<f64> = shape.points().unwrap().iter().map(height).collect();
        let schedule = Schedule::dyadic(levels).unwrap();
        let bands = decomposer.request(&height, 1, &schedule).wavelets().unwrap();
        Self { decomposer, bands }
    }

    fn features(&self, response: Response) -> Vec<Feature> {
        let params = FeatureParams::default().with_response(response).with_refinement(Refinement::Quadratic);
        features(&self.decomposer, &self.bands, &params, Progress::none()).unwrap()
    }

    fn strongest(&self, response: Response) -> Feature {
        let found = self.features(response);
        found.into_iter().max_by(|a, b| a.response.total_cmp(&b.response)).unwrap()
    }
}

/// Checks that sizes fit the width, and stay when the mesh is refined.
fn fits(sizes: &[f64], fitting: f64, response: Response) {
    for size in sizes {
        let off = size / fitting;
        assert!((1.0 - SIZE..1.0 + SIZE).contains(&off), "{response:?}: {off} of the fitting size");
    }
    assert!(sizes.iter().all(|s| (s / sizes[0] - 1.0).abs() < SIZE), "{response:?}: {sizes:?}");
}

#[test]
fn a_lone_bump_is_found_on_its_top_at_its_own_size_however_fine_the_mesh() {
    // u = σ²/2w² at which (u/2)/((1 + u/2)(1 + u)) is largest, and the same over √u.
    let plain = 2.0_f64.sqrt();
    let over_sigma = (33.0_f64.sqrt() - 3.0) / 6.0;
    let grounds = MESHES.map(|(n, levels)| (n, Ground::new(n, levels, &|p| bump(p, [0.0, 0.0]))));
    for (response, u) in
        [(Response::Literal, plain), (Response::Channels, plain), (Response::Sigma, over_sigma)]
    {
        let sizes = grounds.each_ref().map(|(n, ground)| {
            let strongest = ground.strongest(response);
            assert_eq!(strongest.vertex as u32, n / 2 * (n + 1) + n / 2, "{response:?}");
            let position = strongest.position.unwrap();
            assert!(position.iter().all(|c| c.abs() < 1e-3 * WIDTH), "{response:?}: {position:?}");
            strongest.sigma
        });
        fits(&sizes, (2.0 * u).sqrt() * WIDTH, response);
    }
}

#[test]
fn the_normalized_response_of_a_lone_bump_has_no_size() {
    // mean|W_j| is the bump's own there, and R_j at the top is |M|/4π · q^(1/(q−1)) / a with a = w² + σ²/4, b = w² + σ²/2 and
    // q = b/a, which falls with σ.
    for (n, levels) in MESHES {
        let ground = Ground::new(n, levels, &|p| bump(p, [0.0, 0.0]));
        let top = ground.decomposer.vertex_map().welded((n / 2 * (n + 1) + n / 2) as usize);
        let mut before = f64::INFINITY;
        for j in 1..=levels {
            let (w, sigma) = (ground.bands.wavelet(j), ground.bands.sigma[j]);
            let response = w[top] * w.len() as f64 / w.iter().map(|w| w.abs()).sum::<f64>();
            assert!(response < before, "level {j}: {response} after {before}");
            before = response;
            // The plane ends where wide levels have not: the form is that of an infinite one.
            if (4.0 * 2.0 / f64::from(n)..2.0 * WIDTH).contains(&sigma) {
                let (a, b) = (WIDTH * WIDTH + sigma * sigma / 4.0, WIDTH * WIDTH + sigma * sigma / 2.0);
                let q = b / a;
                let form = 4.0 / (4.0 * PI) * q.powf(1.0 / (q - 1.0)) / a;
                assert!((response / form - 1.0).abs() < CLOSED_FORM, "level {j}: {response}, not {form}");
            }
        }
        assert!(ground.features(Response::Normalized).iter().all(|f| f.vertex != top));
    }
}

#[test]
fn on_ground_with_relief_of_all_sizes_the_normalized_response_finds_the_bump_at_its_own_size() {
    /// Not where the relief is symmetric, and at a vertex of each mesh.
    const TOP: [f64; 2] = [0.1, -1.0 / 6.0];
    /// The amplitude of an octave: so much that the relief and not the bump makes the means, so little that it does not hide
    /// the bump.
    const RELIEF: f64 = 0.1;
    // With means that are the same on every level it is the plain response.
    let fitting = (2.0 * 2.0_f64.sqrt()).sqrt() * WIDTH;
    for response in [Response::Normalized, Response::Literal, Response::Channels] {
        let sizes = MESHES.map(|(n, levels)| {
            let ground = Ground::new(n, levels, &|p| bump(p, TOP) + RELIEF * relief(p));
            let strongest = ground.strongest(response);
            let [x, y, _] = strongest.position.unwrap();
            let off = (x - TOP[0]).hypot(y - TOP[1]) / WIDTH;
            assert!(off < 0.25, "{response:?}: {off} widths off the top");
            strongest.sigma
        });
        fits(&sizes, fitting, response);
    }
}
