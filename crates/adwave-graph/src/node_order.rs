//! Order of the nodes in products.

use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};

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
