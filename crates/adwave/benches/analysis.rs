//! Times of saliency and features on the creature of 50 000 vertices, its bands given, and of the signals of its shape.
//!
//! `cargo bench -p adwave --bench analysis`.

use adwave::bands::Schedule;
use adwave::features::{FeatureParams, Refinement, Response, describe, features};
use adwave::saliency::{SaliencyParams, saliency};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, PreparedGeometry, Shape, WeldMode};
use adwave::signal::{SurfaceSignal, surface_signal};
use adwave::{Decomposer, Progress};
use criterion::{Criterion, criterion_group, criterion_main};

fn analysis(criterion: &mut Criterion) {
    let sample = Sample::from_name("creature", Some(50_000)).expect("a sample");
    let cloud = Shape::Cloud(PointCloud::new(sample.points.clone()).expect("finite points"));
    let mesh = Shape::Mesh(Mesh::new(sample.points, sample.faces).expect("a mesh"));
    let schedule = Schedule::dyadic(8).expect("a valid number of levels");
    let mut group = criterion.benchmark_group("creature of 50000 vertices");
    group.sample_size(20);
    for (kind, shape) in [("mesh", &mesh), ("cloud", &cloud)] {
        let decomposer = Decomposer::new(shape);
        let points = shape.points().expect("a shape with points").as_flattened();
        let bands = decomposer.request(points, 3, &schedule).wavelets().expect("a valid request");
        group.bench_function(format!("{kind}: saliency, 6 levels"), |b| {
            b.iter(|| {
                saliency(&decomposer, &bands, &SaliencyParams::paper(), Progress::none())
                    .expect("a valid request")
            });
        });
        let default = FeatureParams::default();
        for (name, params) in [
            ("features", default),
            ("features, 3 channels", default.with_response(Response::Channels)),
            ("features, refined", default.with_refinement(Refinement::Quadratic).with_max_edge_ratio(10.0)),
        ] {
            group.bench_function(format!("{kind}: {name}"), |b| {
                b.iter(|| features(&decomposer, &bands, &params, Progress::none()).expect("a valid request"));
            });
        }
        let found = features(&decomposer, &bands, &default, Progress::none()).expect("a valid request");
        group.bench_function(format!("{kind}: {} descriptors", found.len()), |b| {
            b.iter(|| describe(&decomposer, &bands, &found));
        });
        let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
        group.bench_function(format!("{kind}: mean curvature"), |b| {
            b.iter(|| {
                surface_signal(&geometry, SurfaceSignal::MeanCurvature, Progress::none()).expect("a surface")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, analysis);
criterion_main!(benches);
