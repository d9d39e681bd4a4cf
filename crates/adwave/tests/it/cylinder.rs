//! A domain and its operator that store no rows: a ring of places by a path of places, with holes.

use adwave::domain::Domain;
use adwave::operator::{DiffusionError, Operator};
use adwave::shape::{Adjacency, VertexMap};
use adwave::{Cancelled, Progress};
use std::borrow::Cow;
use std::sync::Arc;

/// Places around the ring.
pub(crate) const AROUND: usize = 40;
/// Places along the path.
pub(crate) const ALONG: usize = 25;

/// Places of a cylinder that are not holes. A step goes to each of the four sides with 1/8, and stays where there is none.
#[derive(Clone, Debug)]
pub(crate) struct Cylinder {
    map: VertexMap,
    is_hole: Vec<bool>,
    positions: Vec<[f64; 3]>,
}

impl Cylinder {
    pub(crate) fn new(holes: &[usize]) -> Self {
        let angle = |x: usize| std::f64::consts::TAU * (x % AROUND) as f64 / AROUND as f64;
        let radius = AROUND as f64 / std::f64::consts::TAU;
        let place = |x: usize| [radius * angle(x).cos(), radius * angle(x).sin(), (x / AROUND) as f64];
        Self {
            map: VertexMap::identity(AROUND * ALONG),
            is_hole: (0..AROUND * ALONG).map(|x| holes.contains(&x)).collect(),
            positions: (0..AROUND * ALONG).map(place).collect(),
        }
    }

    pub(crate) fn sides(&self, x: usize) -> impl Iterator<Item = usize> + '_ {
        let (row, at) = (x / AROUND, x % AROUND);
        let ring = [(at + 1) % AROUND, (at + AROUND - 1) % AROUND].map(|at| Some(row * AROUND + at));
        let path = [row.checked_sub(1), Some(row + 1).filter(|row| *row < ALONG)]
            .map(|row| row.map(|row| row * AROUND + at));
        ring.into_iter().chain(path).flatten().filter(move |&y| !self.is_hole[x] && !self.is_hole[y])
    }
}

impl Domain for Cylinder {
    fn vertex_map(&self) -> &VertexMap {
        &self.map
    }

    fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    fn neighbors(&self, _: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        let (mut offsets, mut columns) = (vec![0], Vec::new());
        for x in 0..self.positions.len() {
            let mut row: Vec<u32> = self.sides(x).map(|y| y as u32).collect();
            row.sort_unstable();
            columns.extend(row);
            offsets.push(columns.len());
        }
        Ok(Some(Cow::Owned(Adjacency::new(offsets, columns, self.positions.len()).unwrap())))
    }
}

impl Operator for Cylinder {
    fn n_rows(&self) -> usize {
        self.positions.len()
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn difference(&self, x: &[f64], d: usize, out: &mut [f64], _: Progress<'_>) -> Result<(), Cancelled> {
        for (row, out) in out.chunks_exact_mut(d).enumerate() {
            for (c, out) in out.iter_mut().enumerate() {
                *out = self.sides(row).map(|y| 0.125 * (x[row * d + c] - x[y * d + c])).sum();
            }
        }
        Ok(())
    }

    fn step_length(&self) -> f64 {
        0.5_f64.sqrt()
    }

    /// A masked place is one more hole.
    fn masked(
        &self,
        masked: &[bool],
        _: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        _: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        let is_hole = self.is_hole.iter().zip(masked).map(|(a, b)| *a || *b).collect();
        Ok(Some(Arc::new(Self { is_hole, ..self.clone() })))
    }
}

/// Holes of the tests.
pub(crate) const HOLES: [usize; 6] = [130, 131, 170, 171, 511, 900];
