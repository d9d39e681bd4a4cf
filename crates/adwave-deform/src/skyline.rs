//! Cholesky factor of a symmetric matrix, stored by rows from the first entry of each row on. Its bits do not depend on
//! the place of its memory, which libraries with aligned kernels do not promise.

use rayon::prelude::*;

/// Factor L of `A = L Lᵀ` by rows.
#[derive(Debug)]
pub(crate) struct Skyline {
    /// First column of each row.
    first: Vec<usize>,
    /// Place of the first value of each row.
    start: Vec<usize>,
    values: Vec<f64>,
}

/// Number of sums that run side by side.
const LANES: usize = 8;

/// Dot product with a fixed order of its sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (ra, rb) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = ra.remainder().iter().zip(rb.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in ra.zip(rb) {
        for l in 0..LANES {
            sums[l] += x[l] * y[l];
        }
    }
    sums.iter().sum::<f64>() + rest
}

impl Skyline {
    /// Factorizes the matrix with these entries of its lower triangle, which may repeat. `None` if it is not positive.
    pub(crate) fn new(n: usize, entries: &[(usize, usize, f64)]) -> Option<Self> {
        let mut first: Vec<usize> = (0..n).collect();
        for &(row, column, _) in entries {
            first[row] = first[row].min(column);
        }
        let mut start = vec![0; n + 1];
        for i in 0..n {
            start[i + 1] = start[i] + i + 1 - first[i];
        }
        let mut values = vec![0.0; start[n]];
        for &(row, column, value) in entries {
            values[start[row] + column - first[row]] += value;
        }
        let mut factor = Self { first, start, values };
        for i in 0..n {
            let (done, rest) = factor.values.split_at_mut(factor.start[i]);
            let row = &mut rest[..i + 1 - factor.first[i]];
            let own = factor.first[i];
            for j in own..i {
                let other = &done[factor.start[j]..factor.start[j + 1]];
                let from = own.max(factor.first[j]);
                let sum = dot(&row[from - own..j - own], &other[from - factor.first[j]..j - factor.first[j]]);
                row[j - own] = (row[j - own] - sum) / other[j - factor.first[j]];
            }
            let (before, diagonal) = row.split_at_mut(i - own);
            let pivot = diagonal[0] - dot(before, before);
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            diagonal[0] = pivot.sqrt();
        }
        Some(factor)
    }

    /// Solves for several right-hand sides in place, each on a thread of its own.
    pub(crate) fn solve(&self, sides: &mut [Vec<f64>; 3]) {
        sides.par_iter_mut().for_each(|x| self.solve_one(x));
    }

    fn solve_one(&self, x: &mut [f64]) {
        let n = self.first.len();
        for i in 0..n {
            let row = &self.values[self.start[i]..self.start[i + 1]];
            let (row, pivot) = (&row[..i - self.first[i]], row[i - self.first[i]]);
            x[i] = (x[i] - dot(row, &x[self.first[i]..i])) / pivot;
        }
        for i in (0..n).rev() {
            let row = &self.values[self.start[i]..self.start[i + 1]];
            let (row, pivot) = (&row[..i - self.first[i]], row[i - self.first[i]]);
            x[i] /= pivot;
            let own = x[i];
            for (y, l) in x[self.first[i]..i].iter_mut().zip(row) {
                *y -= own * l;
            }
        }
    }
}

/// Order of the vertices of a graph in which neighbors are near each other: reverse Cuthill–McKee.
pub(crate) fn near_order(offsets: &[usize], columns: &[u32]) -> Vec<usize> {
    let n = offsets.len() - 1;
    let row = |k: usize| &columns[offsets[k]..offsets[k + 1]];
    let sweep = |start: usize, is_done: &[bool]| {
        let mut is_seen = is_done.to_vec();
        let (mut order, mut next) = (vec![start], 0);
        is_seen[start] = true;
        while next < order.len() {
            let mut found: Vec<usize> =
                row(order[next]).iter().map(|&l| l as usize).filter(|&l| !is_seen[l]).collect();
            found.sort_by_key(|&l| (row(l).len(), l));
            for l in found {
                if !is_seen[l] {
                    is_seen[l] = true;
                    order.push(l);
                }
            }
            next += 1;
        }
        order
    };
    let (mut order, mut is_done) = (Vec::with_capacity(n), vec![false; n]);
    for k in 0..n {
        if is_done[k] {
            continue;
        }
        // The last of a sweep lies at an end of its part.
        let end = *sweep(k, &is_done).last().unwrap_or(&k);
        let part = sweep(end, &is_done);
        for &l in &part {
            is_done[l] = true;
        }
        order.extend(part);
    }
    order.reverse();
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_their_equations() {
        // A band matrix with a far entry.
        let n = 40;
        let mut entries: Vec<(usize, usize, f64)> = (0..n).map(|i| (i, i, 6.0 + i as f64)).collect();
        entries.extend((1..n).map(|i| (i, i - 1, -1.5)));
        entries.push((30, 2, 0.7));
        let factor = Skyline::new(n, &entries).unwrap();
        let right: Vec<f64> = (0..n).map(|i| ((i * 7) % 5) as f64 - 2.0).collect();
        let mut sides = [right.clone(), right.clone(), vec![0.0; n]];
        factor.solve(&mut sides);
        let mut product = vec![0.0; n];
        for &(i, j, a) in &entries {
            product[i] += a * sides[0][j];
            if i != j {
                product[j] += a * sides[0][i];
            }
        }
        assert!(product.iter().zip(&right).all(|(p, r)| (p - r).abs() < 1e-12));
        assert_eq!(sides[0], sides[1]);
        assert_eq!(sides[2], vec![0.0; n]);
        assert!(Skyline::new(1, &[(0, 0, -1.0)]).is_none());
    }

    #[test]
    fn an_order_has_each_vertex_once() {
        // A ring and a single vertex.
        let offsets = [0, 2, 4, 6, 8, 8];
        let columns = [1, 3, 0, 2, 1, 3, 0, 2];
        let mut order = near_order(&offsets, &columns);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4]);
    }
}
