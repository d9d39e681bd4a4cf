//! A process that treats small shapes only starts no thread. In a file of its own: tests beside it would start some.
#![cfg(target_os = "linux")]

use adwave::bands::{BandsParams, Schedule, Transform, smooth};
use adwave::features::{FeatureParams, features};
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::operator::Diffusion;
use adwave::region::parse_region;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::shape::{Mesh, PointCloud, Polygons, Shape, VertexMap};
use adwave::sparse::apply;
use adwave::{Decomposer, Progress};

#[test]
fn small_shapes_start_no_thread() {
    // One test: another one beside it would be a thread.
    products_and_powers_of_a_small_shape_start_no_thread();
    all_that_is_asked_of_a_small_mesh_and_cloud_starts_no_thread();
}

/// Threads of this process.
fn n_threads() -> usize {
    std::fs::read_dir("/proc/self/task").expect("Linux lists the threads of a process").count()
}

/// The cycle of `n` vertices.
fn cycle(n: u32) -> Diffusion {
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for x in 0..n {
        columns.extend([x, (x + 1) % n, (x + n - 1) % n]);
        values.extend([0.5, 0.25, 0.25]);
        offsets.push(columns.len());
    }
    Diffusion::from_rows(&offsets, &columns, &values).expect("rows that sum to 1")
}

/// Asserts that there are as many threads as before.
struct Watch(usize);

impl Watch {
    fn after(&self, what: &str) {
        assert_eq!(n_threads(), self.0, "{what} started threads");
    }
}

fn products_and_powers_of_a_small_shape_start_no_thread() {
    let watch = Watch(n_threads());
    let diffusion = cycle(1000);
    watch.after("the operator");
    for d in [1, 3, 6] {
        let signal: Vec<f64> = (0..1000 * d).map(|i| (i * i % 23) as f64).collect();
        let mut out = vec![0.0; signal.len()];
        apply(&diffusion, &signal, &mut out, d);
        watch.after("a product");
        smooth(&diffusion, &signal, d, &[1, 4], Progress::none()).expect("nobody stops it");
        watch.after("smoothing");
        let transform = Transform::new(diffusion.clone(), &BandsParams::default()).expect("a valid accuracy");
        let (schedule, map) = (Schedule::dyadic(3).expect("3 levels"), VertexMap::identity(1000));
        transform.bands(&map, &signal, d, &schedule, Progress::none()).expect("a valid request");
        watch.after("the transform");
    }
}

fn all_that_is_asked_of_a_small_mesh_and_cloud_starts_no_thread() {
    let watch = Watch(n_threads());
    let points: Vec<[f64; 3]> = (0..900)
        .map(|i| {
            let (x, y) = (f64::from(i % 30), f64::from(i / 30));
            [x, y, (0.3 * x).sin() + (0.2 * y).cos()]
        })
        .collect();
    let square = |k: u32| (k / 29) * 30 + k % 29;
    let faces: Vec<[u32; 3]> =
        (0..29 * 29).map(square).flat_map(|a| [[a, a + 1, a + 30], [a + 1, a + 31, a + 30]]).collect();
    let mesh = Mesh::new(points.clone(), Polygons::from_triangles(&faces)).expect("a valid mesh");
    let cloud = Shape::Cloud(PointCloud::new(points.clone()).expect("finite points"));
    let schedule = Schedule::voices(5, 2).expect("5 octaves");
    for shape in [Shape::Mesh(mesh), cloud] {
        let decomposer = Decomposer::new(&shape);
        watch.after("preparing");
        let request = decomposer.request(points.as_flattened(), 3, &schedule).accuracy(1e-6);
        let bands = request.bands().expect("a valid request");
        watch.after("the bands");
        bands.energy(&decomposer.areas()).expect("one area per vertex");
        watch.after("the energy");
        let norms = request.norms().expect("a valid request");
        watch.after("norms");
        saliency(&decomposer, &norms, &SaliencyParams::paper(), Progress::none()).expect("levels");
        watch.after("saliency");
        features(&decomposer, &norms, &FeatureParams::default(), Progress::none()).expect("levels");
        watch.after("features");
        let region = parse_region("ball:vertex=3,radius=20%").expect("a region");
        let layers = [Layer { gains: Gains::Preset(Preset::Enhance), region }];
        request.filter(&Edit::new(&layers)).expect("a valid edit");
        watch.after("a filter");
        request.editor().expect("bands").set_edit(&Edit::new(&layers)).expect("a valid edit");
        watch.after("an editor");
        decomposer.health();
        watch.after("health");
    }
}
