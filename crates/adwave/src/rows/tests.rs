//! Construction, transposition and renumbering, compared with dense copies.

use super::*;
use crate::{Cancelled, Progress};
use std::sync::atomic::AtomicBool;

/// Rows of different lengths, some empty; below and above the size that one thread handles alone.
fn pattern(n: usize) -> Pattern {
    let row = |(): &mut (), x: usize, columns: &mut Vec<u32>| {
        columns.extend((0..x % 7).map(|k| ((x * 31 + k * 977) % n) as u32));
        columns.sort_unstable();
        columns.dedup();
    };
    let rows: Vec<Vec<u32>> = (0..n)
        .map(|x| {
            let mut columns = Vec::new();
            row(&mut (), x, &mut columns);
            columns
        })
        .collect();
    Pattern::from_rows(n, Progress::none(), || (), |(), x, out| out.extend(&rows[x])).unwrap()
}

#[test]
fn rows_are_built_in_order_on_any_number_of_threads() {
    for n in [1, 100, 10_000] {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| pattern(n));
        let five = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap().install(|| pattern(n));
        assert_eq!(one, five);
        let (offsets, columns) = one.clone().into_parts();
        assert_eq!(Pattern::new(offsets, columns, n), Ok(one));
    }
    assert_eq!(Pattern::default().n_rows(), 0);
}

#[test]
fn the_transpose_names_who_named() {
    for n in [50, 9000] {
        let pattern = pattern(n);
        let five = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap();
        let transpose = five.install(|| incidence(n, n, Progress::none(), |x| pattern.row(x))).unwrap();
        assert_eq!(transpose.nnz(), pattern.nnz());
        for y in 0..n {
            assert!(transpose.row(y).is_sorted());
            assert!(transpose.row(y).iter().all(|&x| pattern.row(x as usize).contains(&(y as u32))));
        }
        let union = pattern.union_with_transpose(Progress::none()).unwrap();
        for x in 0..n {
            let mut expected: Vec<u32> =
                pattern.row(x).iter().chain(transpose.row(x)).copied().filter(|&y| y as usize != x).collect();
            expected.sort_unstable();
            expected.dedup();
            assert_eq!(union.row(x), expected);
        }
    }
}

#[test]
fn arrays_that_do_not_fit_are_refused() {
    let new = |offsets: &[usize], columns: &[u32], values: &[f64]| {
        CompressedRows::new(offsets.to_vec(), columns.to_vec(), values.to_vec(), 3).unwrap_err()
    };
    assert_eq!(new(&[], &[], &[]), RowsError::NoOffsets);
    let lengths = RowsError::Lengths { first: 0, last: 2, n_columns: 1, n_values: 1 };
    assert_eq!(new(&[0, 2], &[0], &[1.0]), lengths);
    assert_eq!(new(&[0, 2, 1, 3], &[0, 1, 2], &[1.0; 3]), RowsError::EndsBeforeStart { row: 1 });
    assert_eq!(new(&[0, 0, 1], &[3], &[1.0]), RowsError::NoColumn { row: 1, column: 3, n_columns: 3 });
    assert_eq!(new(&[0, 2], &[1, 1], &[1.0; 2]), RowsError::NotRising { row: 0, column: 1 });
    let late = CompressedRows::from_sorted(2, 2, [(1, 0, 1.0), (0, 1, 1.0)]);
    assert_eq!(late, Err(RowsError::NotRising { row: 0, column: 1 }));
}

#[test]
fn scipy_gets_the_same_numbers_in_the_memory_that_is_there() {
    let matrix = CompressedRows::new(vec![0, 1, 3], vec![1, 0, 1], vec![1.0_f32, 2.0, 3.0], 2).unwrap();
    let (columns, values) = (matrix.columns().as_ptr().addr(), matrix.values().as_ptr().addr());
    let wide = matrix.clone().into_scipy_wide();
    assert_eq!(wide, (vec![0, 1, 3], vec![1, 0, 1], vec![1.0, 2.0, 3.0]));
    let (indptr, indices, data) = matrix.into_scipy().unwrap();
    assert_eq!((indptr, &indices, &data), (vec![0, 1, 3], &vec![1, 0, 1], &vec![1.0, 2.0, 3.0]));
    assert_eq!((indices.as_ptr().addr(), data.as_ptr().addr()), (columns, values), "copied");
}

#[test]
fn building_stops_when_told_to() {
    let stop = AtomicBool::new(true);
    let progress = Progress::none().with_cancel(&stop);
    let built = Pattern::from_rows(10_000, progress, || (), |(), x, out| out.push(x as u32));
    assert_eq!(built, Err(Cancelled));
    assert_eq!(incidence(10_000, 10_000, progress, |_| &[1]), Err(Cancelled));
}
