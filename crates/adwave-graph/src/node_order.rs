//! Order of the nodes in products.

use crate::lanes::ROWS_AT_A_TIME;
use adwave::pages::zeros;
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Nodes in breadth-first order, component after component, so that neighbors are close to each other.
pub(crate) fn breadth_first(
    rows: &CompressedRows<f64>,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Cancelled> {
    let n = rows.n_rows();
    let mut is_seen = vec![false; n];
    let mut order: Vec<u32> = Vec::with_capacity(n);
    for start in 0..n {
        if std::mem::replace(&mut is_seen[start], true) {
            continue;
        }
        let mut read = order.len();
        order.push(start as u32);
        while let Some(&x) = order.get(read) {
            read += 1;
            if read.is_multiple_of(1 << 14) {
                progress.check()?;
            }
            for &y in rows.row(x as usize).0 {
                if !std::mem::replace(&mut is_seen[y as usize], true) {
                    order.push(y);
                }
            }
        }
    }
    Ok(order)
}

/// The matrix with rows and columns in another order. The result is written where it stays: nothing else of its size is
/// needed. O(entries · log of the entries per row).
pub(crate) fn reorder(rows: &CompressedRows<f64>, node_at: &[u32], place_of: &[u32]) -> CompressedRows<f64> {
    let n = rows.n_rows();
    let mut offsets = vec![0; n + 1];
    for (place, &node) in node_at.iter().enumerate() {
        offsets[place + 1] = offsets[place] + rows.row(node as usize).0.len();
    }
    let (mut columns, mut values) = (zeros::<u32>(rows.nnz()), zeros::<f64>(rows.nnz()));
    let (mut columns_left, mut values_left) = (columns.as_mut_slice(), values.as_mut_slice());
    let mut parts = Vec::new();
    for nodes in node_at.chunks(ROWS_AT_A_TIME) {
        let n_entries = nodes.iter().map(|&node| rows.row(node as usize).0.len()).sum();
        let (columns, others) = columns_left.split_at_mut(n_entries);
        let (values, other_values) = values_left.split_at_mut(n_entries);
        (columns_left, values_left) = (others, other_values);
        parts.push((nodes, columns, values));
    }
    parts.into_par_iter().for_each(|(nodes, columns, values)| {
        let mut entries = Vec::new();
        let mut at = 0;
        for &node in nodes {
            let (others, weights) = rows.row(node as usize);
            entries.clear();
            entries.extend(others.iter().map(|&y| place_of[y as usize]).zip(weights.iter().copied()));
            entries.sort_unstable_by_key(|entry| entry.0);
            for &(column, value) in &entries {
                (columns[at], values[at]) = (column, value);
                at += 1;
            }
        }
    });
    CompressedRows::new(offsets, columns, values, n).expect("an order has each node once")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::powers::tests::powers;

    #[test]
    fn another_order_is_that_of_the_permuted_matrix() {
        for n in [0, 1, 7, 2000] {
            let rows = if n == 0 {
                CompressedRows::new(vec![0], Vec::new(), Vec::new(), 0).unwrap()
            } else {
                powers(n, 0.25).walk().rows().clone()
            };
            let node_at = breadth_first(&rows, Progress::none()).unwrap();
            let mut place_of = vec![0; n];
            (0..).zip(&node_at).for_each(|(place, &node)| place_of[node as usize] = place);
            assert_eq!(reorder(&rows, &node_at, &place_of), rows.permute(&place_of));
        }
    }
}
