//! The medial wall in a field: one connected piece of exact zeros.

/// Shares of the sphere's vertices that a medial wall may have; on fsaverage and fs_LR it has 6 % to 10 %.
const SHARES: [f64; 2] = [0.02, 0.2];
/// Share of all zeros that the largest piece of them must have.
const ONE_PIECE: f64 = 0.98;

/// Finds the medial wall of a field with `n_channels` values per vertex: true for the vertices where all channels are
/// exactly 0, if they are 2 % to 20 % of all and at least 98 % of them are connected; `None` for other fields.
/// FreeSurfer and Workbench write zeros there. O(values).
pub(super) fn find_medial_wall(
    values: &[f64],
    n_channels: usize,
    triangles: &[[u32; 3]],
) -> Option<Vec<bool>> {
    let is_zero: Vec<bool> =
        values.chunks_exact(n_channels).map(|row| row.iter().all(|v| *v == 0.0)).collect();
    let n_zeros = is_zero.iter().filter(|is_zero| **is_zero).count();
    let share = n_zeros as f64 / is_zero.len() as f64;
    if !(SHARES[0]..=SHARES[1]).contains(&share) {
        return None;
    }
    let mut root: Vec<u32> = (0..is_zero.len() as u32).collect();
    for &[a, b, c] in triangles {
        for (x, y) in [(a, b), (b, c), (c, a)] {
            if is_zero[x as usize] && is_zero[y as usize] {
                let (x, y) = (find(&mut root, x), find(&mut root, y));
                root[x.max(y) as usize] = x.min(y);
            }
        }
    }
    let mut sizes = vec![0_usize; is_zero.len()];
    for v in (0..is_zero.len()).filter(|&v| is_zero[v]) {
        sizes[find(&mut root, v as u32) as usize] += 1;
    }
    let largest = sizes.into_iter().max().unwrap_or(0);
    (largest as f64 >= ONE_PIECE * n_zeros as f64).then_some(is_zero)
}

/// Representative of the piece of a vertex, with paths halved.
fn find(root: &mut [u32], mut x: u32) -> u32 {
    while root[x as usize] != x {
        root[x as usize] = root[root[x as usize] as usize];
        x = root[x as usize];
    }
    x
}
