//! One grid cell of the polygonizer: the grouping of its crossed edges into sheets of the surface.
//!
//! Corner c of a cell has the bits x, y, z (1, 2, 4). Edge 4·axis + u + 2v runs along `axis`, at offset u along the
//! next axis and v along the one after. Faces are numbered 2·axis + side.

/// The sheets of the surface in one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Links {
    /// Loop that passes each edge; [`NONE`](Self::NONE) if the surface does not cross it.
    pub(super) loop_of: [u8; 12],
    /// Number of loops, 0 to 4.
    pub(super) n_loops: u8,
    /// One bit per face, set if one loop passes it twice.
    pub(super) twice: u8,
}

impl Links {
    /// Marks an edge without a loop.
    pub(super) const NONE: u8 = u8::MAX;
}

/// Offset of corner `c` in cells.
pub(super) fn corner_offset(c: usize) -> [i32; 3] {
    [(c & 1) as i32, (c >> 1 & 1) as i32, (c >> 2 & 1) as i32]
}

/// Number of the edge along `axis` at offsets `u`, `v` (0 or 1) along the next two axes.
pub(super) fn edge_index(axis: usize, u: usize, v: usize) -> usize {
    4 * axis + u + 2 * v
}

/// The four corners of a face in cyclic order, and the edges between successive corners.
fn face_ring(face: usize) -> ([usize; 4], [usize; 4]) {
    let (axis, side) = (face / 2, face % 2);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(du, dv)| side << axis | du << u | dv << v);
    // Along u (offsets v, axis) and along v (offsets axis, u), by the numbering of `edge_index`.
    let edges =
        [edge_index(u, 0, side), edge_index(v, side, 1), edge_index(u, 1, side), edge_index(v, side, 0)];
    (corners, edges)
}

/// Groups the crossed edges of a cell with the corners `inside` into loops. A face whose corners alternate is
/// ambiguous: inside corners are kept apart there, or outside corners if the face's bit is set in `flips`.
pub(super) fn link(inside: u8, flips: u8) -> Links {
    let is_inside = |c: usize| inside >> c & 1 == 1;
    let mut label: [u8; 12] = std::array::from_fn(|e| e as u8);
    let mut join = |a: usize, b: usize| {
        let (keep, drop) = (label[a].min(label[b]), label[a].max(label[b]));
        for l in &mut label {
            if *l == drop {
                *l = keep;
            }
        }
    };
    let mut crossed = [false; 12];
    let mut ambiguous = Vec::new();
    for face in 0..6 {
        let (corners, edges) = face_ring(face);
        let cut: Vec<usize> =
            (0..4).filter(|&i| is_inside(corners[i]) != is_inside(corners[(i + 1) % 4])).collect();
        for &i in &cut {
            crossed[edges[i]] = true;
        }
        if cut.len() == 2 {
            join(edges[cut[0]], edges[cut[1]]);
        } else if cut.len() == 4 {
            let apart = flips >> face & 1 == 0;
            // The corner between edges i − 1 and i is cut off.
            let first = usize::from(is_inside(corners[0]) != apart);
            let pairs = [first, first + 2].map(|i| (edges[(i + 3) % 4], edges[i]));
            for (a, b) in pairs {
                join(a, b);
            }
            ambiguous.push((face, pairs));
        }
    }
    let mut names: Vec<u8> = (0..12).filter(|&e| crossed[e]).map(|e| label[e]).collect();
    names.sort_unstable();
    names.dedup();
    let loop_of = std::array::from_fn(|e| match names.binary_search(&label[e]) {
        Ok(i) if crossed[e] => i as u8,
        _ => Links::NONE,
    });
    let twice = ambiguous
        .iter()
        .filter(|(_, [a, b])| loop_of[a.0] == loop_of[b.0])
        .fold(0, |bits, (face, _)| bits | 1 << face);
    Links { loop_of, n_loops: names.len() as u8, twice }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_corner_makes_one_loop_of_three() {
        for c in 0..8 {
            let links = link(1 << c, 0);
            assert_eq!(links.n_loops, 1);
            assert_eq!(links.loop_of.iter().filter(|&&l| l != Links::NONE).count(), 3);
        }
    }

    #[test]
    fn opposite_corners_of_a_face_are_apart_and_join_when_flipped() {
        // Corners 0 and 3 lie across the face z = 0, which is face 4.
        assert_eq!(link(0b1001, 0).n_loops, 2);
        let joined = link(0b1001, 1 << 4);
        assert_eq!(joined.n_loops, 1);
        assert_eq!(joined.twice, 1 << 4);
    }

    #[test]
    fn checkerboard_has_four_loops() {
        assert_eq!(link(0b0110_1001, 0).n_loops, 4);
    }

    /// Flipping a face that one loop passes twice splits that loop, in every configuration.
    #[test]
    fn flipping_a_doubly_passed_face_splits_a_loop() {
        let mut n_cases = 0;
        for inside in 0..=255 {
            let links = link(inside, 0);
            for face in (0..6).filter(|face| links.twice >> face & 1 == 1) {
                n_cases += 1;
                let split = link(inside, 1 << face);
                assert_eq!(split.n_loops, links.n_loops + 1, "corners {inside:#b}, face {face}");
                assert_eq!(split.twice & 1 << face, 0);
            }
        }
        assert!(n_cases > 0);
    }
}
