//! Some places of a domain as a domain of their own, which labels may divide.

use super::{Decomposer, transform};
use crate::domain::{Domain, DomainError};
use crate::local_fit::LocalFit;
use crate::operator::{NoRows, Semigroup};
use crate::shape::{Adjacency, VertexMap};
use crate::{Cancelled, Progress};
use std::borrow::Cow;
use std::sync::Arc;

impl Decomposer {
    /// Some of the vertices or places, in the order of `vertices`, as a domain of their own. Nothing flows between those
    /// of different labels, of which there is one for each, nor to those that are left out, as at a mask. Welded
    /// vertices have the label of the last one. O(entries).
    ///
    /// # Errors
    /// [`DomainError::Length`] unless there is one label for each vertex; [`DomainError::Part`] if there is none, or one is
    /// named twice or does not exist, or the operator is not heat; [`DomainError::NoRows`] if its rows cannot be stored;
    /// or if the call is cancelled.
    ///
    /// ```
    /// use adwave::{Decomposer, Progress, bands::Schedule, grid::Grid};
    /// let grid = Grid::new(&[6], &[2.0])?;
    /// let line = Decomposer::from_domain(grid.clone(), grid.heat())?;
    /// let part = line.part(&[5, 4, 3, 0, 1], &[7, 7, 7, 1, 1], Progress::none())?;
    /// let smooth = part.decompose(&[9.0, 0.0, 0.0, 0.0, 4.0], 1, &Schedule::real(vec![1e6])?)?;
    /// let expected = [3.0, 3.0, 3.0, 2.0, 2.0];
    /// assert!(smooth.coarsest().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn part(
        &self,
        vertices: &[u32],
        labels: &[u32],
        progress: Progress<'_>,
    ) -> Result<Self, DomainError> {
        if labels.len() != vertices.len() {
            let (n_found, n_places) = (labels.len(), vertices.len());
            return Err(DomainError::Length { what: "labels", n_found, n_places });
        }
        let refused = |reason: &'static str| Err(DomainError::Part { reason });
        if vertices.is_empty() {
            return refused("none is named");
        }
        if !matches!(self.operator().semigroup(), Semigroup::Heat { .. }) {
            return refused("the operator must be heat: a surface, a curve or a grid");
        }
        let (mut is_named, mut of_place) = (vec![false; self.n_vertices()], vec![None; self.n_places()]);
        for (&vertex, &label) in vertices.iter().zip(labels) {
            match is_named.get_mut(vertex as usize) {
                Some(is_named) if !*is_named => *is_named = true,
                Some(_) => return refused("one is named twice"),
                None => return refused("one that is named does not exist"),
            }
            of_place[self.vertex_map().welded(vertex as usize)] = Some(label);
        }
        let rows = self.operator().stored_rows(progress)?;
        let rows = rows.ok_or(NoRows { needed_by: "a part of a domain" })?.divided(&of_place, progress)?;
        let part = Part::new(self, &of_place, vertices, rows.neighbors());
        Ok(Self { params: self.params, ..Self::join(Arc::new(part), transform(rows)) })
    }
}

/// Some places of a domain.
#[derive(Debug)]
struct Part {
    whole: Decomposer,
    /// Places of the whole, in ascending order.
    places: Vec<u32>,
    /// Number in the part of each place of the whole; `u32::MAX` for those outside.
    number: Vec<u32>,
    map: VertexMap,
    measure: Option<Vec<f64>>,
    positions: Vec<[f64; 3]>,
    spacing: [f64; 1],
    /// Neighbors within the same label.
    neighbors: Adjacency,
}

impl Part {
    /// The places of the whole that have a label, with the vertices in the order of the part.
    fn new(whole: &Decomposer, labels: &[Option<u32>], vertices: &[u32], neighbors: &Adjacency) -> Self {
        let places: Vec<u32> = (0..labels.len() as u32).filter(|&x| labels[x as usize].is_some()).collect();
        let mut number = vec![u32::MAX; labels.len()];
        for (k, &place) in (0..).zip(&places) {
            number[place as usize] = k;
        }
        let class = |vertex: &u32| number[whole.vertex_map().welded(*vertex as usize)];
        let map = VertexMap::from_classes(vertices.iter().map(class).collect(), places.len());
        let gathered = |values: &[f64]| places.iter().map(|&place| values[place as usize]).collect();
        let positions = whole.positions();
        let has_positions = !positions.is_empty();
        Self {
            measure: whole.place_measure().map(gathered),
            positions: places.iter().filter(|_| has_positions).map(|&x| positions[x as usize]).collect(),
            spacing: [whole.mean_length()],
            neighbors: neighbors.clone(),
            whole: whole.clone(),
            places,
            number,
            map,
        }
    }

    /// Flags of all places of the whole, true outside the part and where `masked` is.
    fn without(&self, masked: Option<&[bool]>) -> Vec<bool> {
        let is_out = |k: &u32| *k == u32::MAX || masked.is_some_and(|masked| masked[*k as usize]);
        self.number.iter().map(is_out).collect()
    }
}

impl Domain for Part {
    fn vertex_map(&self) -> &VertexMap {
        &self.map
    }

    fn measure(&self) -> Option<&[f64]> {
        self.measure.as_deref()
    }

    fn spacings(&self) -> &[f64] {
        &self.spacing
    }

    fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    fn extent(&self, masked: Option<&[bool]>) -> f64 {
        self.whole.domain().extent(Some(&self.without(masked)))
    }

    fn neighbors(&self, _: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        Ok(Some(Cow::Borrowed(&self.neighbors)))
    }

    fn squared_length(&self, x: usize, y: usize) -> f64 {
        self.whole.domain().squared_length(self.places[x] as usize, self.places[y] as usize)
    }

    fn outsiders(&self) -> Option<Vec<bool>> {
        let all = self.whole.domain().outsiders()?;
        let own: Vec<bool> = self.places.iter().map(|&place| all[place as usize]).collect();
        own.contains(&true).then_some(own)
    }

    /// The border of the whole, and the places next to others outside the part.
    fn border(
        &self,
        _: &Adjacency,
        masked: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Vec<usize>, Cancelled> {
        let out = self.without(masked);
        let border = self.whole.domain().border(self.whole.try_neighbors(progress)?, Some(&out), progress)?;
        let own = border.into_iter().map(|place| self.number[place]).filter(|k| *k != u32::MAX);
        Ok(own.map(|k| k as usize).collect())
    }

    fn may_fill_volume(&self) -> bool {
        self.whole.domain().may_fill_volume()
    }

    fn local_fit(&self, asked: LocalFit) -> LocalFit {
        self.whole.applied_local_fit(asked)
    }
}
