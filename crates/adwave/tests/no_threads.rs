//! A process that treats small shapes only starts no thread. In a file of its own: tests beside it would start some.
#![cfg(target_os = "linux")]

use adwave::Progress;
use adwave::bands::{BandsParams, Schedule, Transform, smooth};
use adwave::operator::Diffusion;
use adwave::sparse::apply;

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

#[test]
fn products_and_powers_of_a_small_shape_start_no_thread() {
    let before = n_threads();
    let diffusion = cycle(1000);
    for d in [1, 3, 6] {
        let signal: Vec<f64> = (0..1000 * d).map(|i| (i * i % 23) as f64).collect();
        let mut out = vec![0.0; signal.len()];
        apply(&diffusion, &signal, &mut out, d);
        smooth(&diffusion, &signal, d, &[1, 4], Progress::none()).expect("nobody stops it");
        let transform = Transform::new(&diffusion, &BandsParams::default()).expect("a valid accuracy");
        assert!(transform.diffusion().n_vertices() == 1000 && Schedule::dyadic(3).is_ok());
    }
    assert_eq!(n_threads(), before);
}
