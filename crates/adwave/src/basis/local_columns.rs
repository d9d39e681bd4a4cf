//! Rows of Φ₁ⁿ for a block of vertices at once, as dense columns over the vertices that the walks have reached.
//!
//! Row x of Φ₁ⁿ is `e_xᵀΦ₁ⁿ`, so `v ← Φ₁ᵀv` starting from `v = e_x`. The walks of neighboring vertices reach nearly
//! the same vertices. They share one list of active vertices and one small local matrix, and each product treats
//! them as lanes of a vector. Every few products the list is rebuilt: vertices where every lane is small are
//! dropped, and those within a few steps of the others are added.

use super::sparse_accumulator::SparseAccumulator;
use super::transpose::{Group, Transpose};
use crate::operator::Diffusion;

/// Number of rows computed side by side.
pub(super) const LANES: usize = 32;

/// One value of each lane.
pub(super) type Lanes = [f32; LANES];

/// Local number of a vertex that is not active.
const ABSENT: u32 = u32::MAX;

/// The walks of a block of vertices.
#[derive(Debug)]
pub(super) struct LocalColumns {
    /// Active vertices, in ascending order.
    pub(super) active: Vec<u32>,
    /// Values `now[k][l]` of lane `l` at vertex `active[k]`.
    pub(super) now: Vec<Lanes>,
    /// Buffer for the next columns; in a recurrence, the columns of the term before.
    pub(super) other: Vec<Lanes>,
    /// Sums of a recurrence, one per level that it serves.
    pub(super) sums: Vec<Vec<Lanes>>,
    spare: Vec<Lanes>,
    /// Local matrix: the entries of row `k` are the groups `starts[k]..starts[k + 1]`, including the diagonal.
    starts: Vec<u32>,
    groups: Vec<Group>,
    /// Local number of each vertex of the shape.
    number: Vec<u32>,
    accumulator: SparseAccumulator,
    front: Vec<u32>,
    next_front: Vec<u32>,
    before: Vec<u32>,
    /// Position of each active vertex in the previous list.
    origin: Vec<u32>,
    is_large: Vec<bool>,
}

impl LocalColumns {
    /// Allocates memory for walks over `n` vertices.
    pub(super) fn new(n: usize) -> Self {
        Self {
            active: Vec::new(),
            now: Vec::new(),
            other: Vec::new(),
            sums: Vec::new(),
            spare: Vec::new(),
            starts: Vec::new(),
            groups: Vec::new(),
            number: vec![ABSENT; n],
            accumulator: SparseAccumulator::new(n),
            front: Vec::new(),
            next_front: Vec::new(),
            before: Vec::new(),
            origin: Vec::new(),
            is_large: Vec::new(),
        }
    }

    /// Starts lane `l` at vertex `first + l`, for all vertices before `end`.
    pub(super) fn start(&mut self, first: usize, end: usize) {
        self.forget_numbers();
        self.active.clear();
        self.active.extend(first as u32..end as u32);
        self.sums.clear();
        self.now.clear();
        self.now.resize(end - first, [0.0; LANES]);
        self.other.clear();
        self.other.resize(end - first, [0.0; LANES]);
        for (l, row) in self.now.iter_mut().enumerate() {
            row[l] = 1.0;
        }
    }

    fn forget_numbers(&mut self) {
        for &x in &self.active {
            self.number[x as usize] = ABSENT;
        }
    }

    /// Drops vertices where no lane exceeds `floor`, adds those within `rings` steps of the others, and builds the
    /// local matrix. With `floor` 0 no reached vertex is dropped.
    pub(super) fn regrow(
        &mut self,
        diffusion: &Diffusion,
        transpose: &Transpose,
        arch: pulp::Arch,
        floor: f32,
        rings: u64,
    ) {
        self.forget_numbers();
        self.front.clear();
        self.is_large.clear();
        self.is_large.resize(self.active.len(), false);
        // In a walk the other columns are scratch memory; in a recurrence they are the term before.
        let others = if self.sums.is_empty() { None } else { Some(&self.other) };
        for columns in [&self.now].into_iter().chain(others).chain(&self.sums) {
            arch.dispatch(FindLarge { columns, floor, is_large: &mut self.is_large });
        }
        for (&x, _) in self.active.iter().zip(&self.is_large).filter(|(_, is_large)| **is_large) {
            self.accumulator.insert(x);
            self.front.push(x);
        }
        for _ in 0..rings {
            if self.front.is_empty() {
                break;
            }
            self.next_front.clear();
            for &x in &self.front {
                for &y in diffusion.row(x as usize).0 {
                    if self.accumulator.insert(y) {
                        self.next_front.push(y);
                    }
                }
            }
            std::mem::swap(&mut self.front, &mut self.next_front);
        }
        std::mem::swap(&mut self.active, &mut self.before);
        self.active.clear();
        self.accumulator.drain_sorted(&mut self.active);
        self.carry_over(arch);
        self.build_matrix(transpose);
    }

    /// Moves the values from the old list of active vertices to the new one.
    fn carry_over(&mut self, arch: pulp::Arch) {
        self.origin.clear();
        let mut k = 0;
        for &x in &self.active {
            while k < self.before.len() && self.before[k] < x {
                k += 1;
            }
            let known = k < self.before.len() && self.before[k] == x;
            self.origin.push(if known { k as u32 } else { ABSENT });
        }
        let in_recurrence = !self.sums.is_empty();
        carry(arch, &mut self.now, &self.origin, &mut self.spare);
        if in_recurrence {
            carry(arch, &mut self.other, &self.origin, &mut self.spare);
            for sum in &mut self.sums {
                carry(arch, sum, &self.origin, &mut self.spare);
            }
        } else {
            self.other.resize(self.active.len(), [0.0; LANES]);
        }
    }

    fn build_matrix(&mut self, transpose: &Transpose) {
        for (&x, k) in self.active.iter().zip(0..) {
            self.number[x as usize] = k;
        }
        self.starts.clear();
        self.starts.push(0);
        self.groups.clear();
        for (&y, k) in self.active.iter().zip(0_u32..) {
            for group in transpose.column(y) {
                // Inactive vertices contribute nothing. A branch would be mispredicted at the rim, so there is
                // none.
                self.groups.push(group.map(|(x, w)| {
                    let source = self.number[x as usize];
                    if source == ABSENT { (k, 0.0) } else { (source, w) }
                }));
            }
            self.starts.push(self.groups.len() as u32);
        }
    }

    /// Applies one step to every walk: `v ← Φ₁ᵀv`.
    pub(super) fn advance(&mut self, arch: pulp::Arch) {
        arch.dispatch(StepProduct {
            starts: &self.starts,
            groups: &self.groups,
            now: &self.now,
            next: &mut self.other,
        });
        std::mem::swap(&mut self.now, &mut self.other);
    }

    /// The local matrix: start of the groups of each row, and the groups.
    pub(super) fn matrix(&self) -> (&[u32], &[Group]) {
        (&self.starts, &self.groups)
    }
}

/// Renumbers columns: row `k` becomes the row at `origin[k]`, or zeros.
fn carry(arch: pulp::Arch, columns: &mut Vec<Lanes>, origin: &[u32], spare: &mut Vec<Lanes>) {
    spare.resize(origin.len(), [0.0; LANES]);
    arch.dispatch(CarryOver { from: columns, origin, to: spare });
    std::mem::swap(columns, spare);
}

struct CarryOver<'a> {
    from: &'a [Lanes],
    origin: &'a [u32],
    to: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for CarryOver<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (row, &k) in self.to.iter_mut().zip(self.origin) {
            *row = if k == ABSENT { [0.0; LANES] } else { self.from[k as usize] };
        }
    }
}

/// Marks the rows in which the magnitude of some lane exceeds `floor`.
struct FindLarge<'a> {
    columns: &'a [Lanes],
    floor: f32,
    is_large: &'a mut [bool],
}

impl pulp::NullaryFnOnce for FindLarge<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (is_large, row) in self.is_large.iter_mut().zip(self.columns) {
            let mut large = 0_u32;
            for v in row {
                large |= u32::from(v.abs() > self.floor);
            }
            *is_large |= large != 0;
        }
    }
}

/// Computes `next = A·now` for the local matrix, compiled for every instruction set and selected at run time.
struct StepProduct<'a> {
    starts: &'a [u32],
    groups: &'a [Group],
    now: &'a [Lanes],
    next: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for StepProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { starts, groups, now, next } = self;
        for (row, range) in next.iter_mut().zip(starts.windows(2)) {
            *row = row_times(&groups[range[0] as usize..range[1] as usize], now);
        }
    }
}

/// Number of groups of a row that are summed one after another. Longer rows are summed in such parts, because the
/// error of a sum in single precision grows with its length.
const GROUPS_A_SUM: usize = 32;

/// Product of one row of the local matrix with the columns.
#[inline(always)]
pub(super) fn row_times(groups: &[Group], columns: &[Lanes]) -> Lanes {
    if groups.len() <= GROUPS_A_SUM {
        return part_times(groups, columns);
    }
    let mut sum = [0.0_f64; LANES];
    for part in groups.chunks(GROUPS_A_SUM) {
        for (s, p) in sum.iter_mut().zip(part_times(part, columns)) {
            *s += f64::from(p);
        }
    }
    sum.map(|s| s as f32)
}

#[inline(always)]
fn part_times(groups: &[Group], columns: &[Lanes]) -> Lanes {
    let mut sum = [0.0_f32; LANES];
    for group in groups {
        for &(source, w) in group {
            let from = &columns[source as usize];
            // Products and sums are rounded separately, so every instruction set gives the same bits.
            for l in 0..LANES {
                sum[l] += w * from[l];
            }
        }
    }
    sum
}
