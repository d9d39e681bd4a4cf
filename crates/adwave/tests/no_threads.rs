//! A process that treats small shapes only starts no thread. In a file of its own: tests beside it would start some.
#![cfg(target_os = "linux")]

use adwave::bands::{BandsParams, Schedule, Transform, smooth};
use adwave::features::{FeatureParams, features};
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::operator::Diffusion;
use adwave::region::parse_region;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Shape, VertexMap};
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

fn products_and_powers_of_a_small_shape_start_no_thread() {
    let before = n_threads();
    let diffusion = cycle(1000);
    for d in [1, 3, 6] {
        let signal: Vec<f64> = (0..1000 * d).map(|i| (i * i % 23) as f64).collect();
        let mut out = vec![0.0; signal.len()];
        apply(&diffusion, &signal, &mut out, d);
        smooth(&diffusion, &signal, d, &[1, 4], Progress::none()).expect("nobody stops it");
        let transform = Transform::new(diffusion.clone(), &BandsParams::default()).expect("a valid accuracy");
        let (schedule, map) = (Schedule::dyadic(3).expect("3 levels"), VertexMap::identity(1000));
        transform.bands(&map, &signal, d, &schedule, Progress::none()).expect("a valid request");
    }
    assert_eq!(n_threads(), before);
}

fn all_that_is_asked_of_a_small_mesh_and_cloud_starts_no_thread() {
    let before = n_threads();
    let sample = Sample::by_name("torus", Some(1000)).expect("a built-in shape");
    let points = sample.points.clone();
    let mesh = Shape::Mesh(Mesh::new(sample.points, sample.faces).expect("a valid mesh"));
    let cloud = Shape::Cloud(PointCloud::new(points.clone()).expect("finite points"));
    let schedule = Schedule::voices(5, 2).expect("5 octaves");
    for shape in [mesh, cloud] {
        let decomposer = Decomposer::new(&shape);
        let request = decomposer.request(points.as_flattened(), 3, &schedule).accuracy(1e-6);
        let bands = request.bands().expect("a valid request");
        bands.energy(&decomposer.areas()).expect("one area per vertex");
        let norms = request.norms().expect("a valid request");
        saliency(&decomposer, &norms, &SaliencyParams::default(), Progress::none()).expect("levels");
        features(&decomposer, &norms, &FeatureParams::default(), Progress::none()).expect("levels");
        let region = parse_region("ball:vertex=3,radius=20%").expect("a region");
        let layers = [Layer { gains: Gains::Preset(Preset::Enhance), region }];
        request.filter(&Edit::new(&layers)).expect("a valid edit");
        request.editor().expect("bands").set_edit(&Edit::new(&layers)).expect("a valid edit");
        decomposer.health();
    }
    assert_eq!(n_threads(), before);
}
