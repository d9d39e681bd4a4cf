//! Times of a product, of the bands of 8 and 16 levels, and of powers, on a sphere of 262 146 vertices.
//!
//! `cargo bench -p adwave`. What a file of your own costs, and what the machine could do at best, the program
//! `engine_timing` of `benches/helpers` tells.

use adwave::Progress;
use adwave::bands::{BandsParams, Schedule, Transform, smooth};
use adwave::operator::{Diffusion, OperatorParams, local_operator};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PreparedGeometry, Shape};
use adwave::sparse::apply;
use criterion::{Criterion, criterion_group, criterion_main};
use std::sync::Arc;

fn engine(criterion: &mut Criterion) {
    let sphere = Sample::from_name("sphere", Some(262_146)).expect("a sample");
    let params = OperatorParams::default();
    let shape = Shape::Mesh(Mesh::new(sphere.points, sphere.faces).expect("a mesh"));
    let geometry = PreparedGeometry::new(&shape, params.weld, Progress::none()).expect("not cancelled");
    let operator = local_operator(&geometry, &params, Progress::none()).expect("not cancelled");
    let diffusion = Arc::new(Diffusion::new(operator, Progress::none()).expect("not cancelled"));
    let signal = geometry.points().as_flattened();
    let mut group = criterion.benchmark_group("sphere of 262146 vertices");
    group.sample_size(10);

    let mut out = vec![0.0; signal.len()];
    group.bench_function("product", |b| b.iter(|| apply(&diffusion, signal, &mut out, 3)));
    group.bench_function("powers, 16 steps", |b| {
        b.iter(|| smooth(&diffusion, signal, 3, &[16], Progress::none()).expect("not cancelled"));
    });
    let accurate = BandsParams::default().with_accuracy(1e-5);
    group.bench_function("prepare", |b| {
        b.iter(|| {
            let transform = Transform::new(Arc::clone(&diffusion), &accurate).expect("a valid accuracy");
            transform.prepare(Progress::none())
        });
    });
    let transform = Transform::new(diffusion, &accurate).expect("a valid accuracy");
    for levels in [8, 16] {
        let schedule = Schedule::dyadic(levels).expect("a valid number of levels");
        let mut wavelets = vec![vec![0.0; signal.len()]; levels];
        let mut outs: Vec<&mut [f64]> = wavelets.iter_mut().map(Vec::as_mut_slice).collect();
        group.bench_function(format!("bands, {levels} levels"), |b| {
            b.iter(|| {
                transform
                    .wavelets_into(signal, 3, &schedule, &mut outs, Progress::none())
                    .expect("a valid request")
            });
        });
        let factors = vec![0.5; levels];
        group.bench_function(format!("weighted sum of {levels} bands"), |b| {
            b.iter(|| {
                transform
                    .weighted_into(signal, 3, &schedule, &factors, &mut out, Progress::none())
                    .expect("a valid request")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, engine);
criterion_main!(benches);
