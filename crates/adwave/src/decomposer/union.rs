//! Several domains as one, each with an operator of its own: two hemispheres, and the voxels between them.

use super::{Decomposer, without_places};
use crate::bands::{BandsError, BandsParams, Schedule, Transform};
use crate::domain::{Domain, DomainError};
use crate::local_fit::LocalFit;
use crate::mask::MaskError;
use crate::operator::{DiffusionError, Invariant, Leap, Operator, RowWeights, Semigroup};
use crate::shape::{Adjacency, VertexMap};
use crate::{Cancelled, Progress};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Largest accuracy of bands; a leap of a part that misses even that does nothing, and says so by its bound.
const COARSEST_ACCURACY: f64 = 0.1;

impl Decomposer {
    /// Joins domains into one, whose places are those of the first, then those of the second, and so on. Nothing flows
    /// from one to another, and a width in model units is the same width on each. O(places + neighbors).
    ///
    /// The parts have heat as their operator: surfaces, curves, and grids.
    ///
    /// # Errors
    /// [`DomainError::Union`] if there is no part, or one has another operator than heat on scalars.
    ///
    /// ```
    /// use adwave::{Decomposer, Progress, bands::Schedule, grid::Grid, operator::*, sample::Sample, shape::{Mesh, Shape}};
    /// let ball = Sample::from_name("sphere", Some(500))?;
    /// let ball = Shape::Mesh(Mesh::new(ball.points, ball.faces)?);
    /// let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    /// let surface = Decomposer::with_params(&ball, &params, Progress::none())?;
    /// let grid = Grid::new(&[4, 5, 6], &[0.1; 3])?;
    /// let volume = Decomposer::from_domain(grid.clone(), grid.heat())?;
    /// let both = Decomposer::union(&[surface.clone(), volume.clone()])?;
    ///
    /// let signal: Vec<f64> = (0..both.n_vertices()).map(|i| (i as f64).sin()).collect();
    /// let (first, second) = signal.split_at(surface.n_vertices());
    /// let smooth = |part: &Decomposer, signal: &[f64]| {
    ///     let schedule = Schedule::lengths(&[0.2], part.operator().step_length()).unwrap();
    ///     part.decompose(signal, 1, &schedule).unwrap().coarsest().to_vec()
    /// };
    /// let apart = [smooth(&surface, first), smooth(&volume, second)].concat();
    /// assert!(smooth(&both, &signal).iter().zip(&apart).all(|(a, b)| (a - b).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn union(parts: &[Self]) -> Result<Self, DomainError> {
        let n_places: usize = parts.iter().map(Self::n_places).sum();
        if parts.is_empty() || n_places >= u32::MAX as usize {
            return Err(DomainError::Union {
                reason: "there must be one part or more, with fewer than 2³² places in all",
            });
        }
        if !parts.iter().all(|part| is_heat(part.operator().as_ref())) {
            let reason = "each part needs heat as its operator: a surface, a curve or a grid";
            return Err(DomainError::Union { reason });
        }
        let heat = UnionHeat::new(
            parts.iter().map(|part| Some(part.transform.clone())).collect(),
            &row_ranges(parts),
        );
        Self::from_domain(Union::new(parts), heat)
    }
}

/// Rows of each part among those of all.
fn row_ranges(parts: &[Decomposer]) -> Vec<Range<usize>> {
    let mut at = 0;
    let range = |part: &Decomposer| {
        at += part.n_places();
        at - part.n_places()..at
    };
    parts.iter().map(range).collect()
}

/// True if an operator is heat on scalars.
fn is_heat(operator: &dyn Operator) -> bool {
    matches!(operator.semigroup(), Semigroup::Heat { .. })
        && operator.is_reversible()
        && operator.invariant() == Invariant::Constants
        && operator.channels_at_place() == 1
}

/// Places of several domains, one domain after another.
#[derive(Debug)]
struct Union {
    parts: Vec<Decomposer>,
    rows: Vec<Range<usize>>,
    map: VertexMap,
    measure: Vec<f64>,
    /// Positions of all places; empty if a part has none.
    positions: Vec<[f64; 3]>,
    /// Mean distance of neighbors.
    spacing: [f64; 1],
}

impl Union {
    fn new(parts: &[Decomposer]) -> Self {
        let measure = parts.iter().flat_map(|part| match part.place_measure() {
            Some(measure) => measure.to_vec(),
            None => vec![1.0; part.n_places()],
        });
        let have_positions = parts.iter().all(|part| part.domain.n_positions() > 0);
        let positions = parts.iter().filter(|_| have_positions).flat_map(Decomposer::positions).copied();
        let n_places: usize = parts.iter().map(Decomposer::n_places).sum();
        let lengths: f64 = parts.iter().map(|part| part.mean_length() * part.n_places() as f64).sum();
        Self {
            rows: row_ranges(parts),
            map: VertexMap::union(parts.iter().map(Decomposer::vertex_map)),
            measure: measure.collect(),
            positions: positions.collect(),
            spacing: [lengths / n_places as f64],
            parts: parts.to_vec(),
        }
    }

    /// The part of a place, and the first place of that part.
    fn part_of(&self, place: usize) -> (&Decomposer, usize) {
        let k = self.rows.partition_point(|rows| rows.end <= place);
        (&self.parts[k], self.rows[k].start)
    }

    fn parts_with_rows(&self) -> impl Iterator<Item = (&Decomposer, &Range<usize>)> {
        self.parts.iter().zip(&self.rows)
    }
}

impl Domain for Union {
    fn vertex_map(&self) -> &VertexMap {
        &self.map
    }

    fn measure(&self) -> Option<&[f64]> {
        Some(&self.measure)
    }

    fn spacings(&self) -> &[f64] {
        &self.spacing
    }

    fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The largest of the parts.
    fn extent(&self, masked: Option<&[bool]>) -> f64 {
        let extent = |(part, rows): (&Decomposer, &Range<usize>)| match masked {
            Some(masked) => part.domain.extent(Some(&masked[rows.clone()])),
            None => part.extent,
        };
        self.parts_with_rows().map(extent).fold(0.0, f64::max)
    }

    fn neighbors(&self, progress: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        let (mut offsets, mut columns) = (vec![0], Vec::new());
        for (part, rows) in self.parts_with_rows() {
            let (neighbors, before) = (part.try_neighbors(progress)?, columns.len());
            columns.extend(neighbors.columns().iter().map(|y| y + rows.start as u32));
            offsets.extend(neighbors.offsets()[1..].iter().map(|end| before + end));
        }
        let all = Adjacency::new(offsets, columns, self.map.n_welded());
        Ok(Some(Cow::Owned(all.expect("lists of neighbors, one after another"))))
    }

    fn squared_length(&self, x: usize, y: usize) -> f64 {
        let (part, first) = self.part_of(x);
        part.domain.squared_length(x - first, y - first)
    }

    fn outsiders(&self) -> Option<Vec<bool>> {
        let flags = |part: &Decomposer| {
            let mut flags = part.domain.outsiders().unwrap_or_else(|| vec![false; part.n_places()]);
            for (is_out, masked) in flags.iter_mut().zip(part.mask_flags().unwrap_or_default()) {
                *is_out |= masked;
            }
            flags
        };
        let all: Vec<bool> = self.parts.iter().flat_map(flags).collect();
        all.contains(&true).then_some(all)
    }

    fn border(
        &self,
        _: &Adjacency,
        masked: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Vec<usize>, Cancelled> {
        let mut border = Vec::new();
        for (part, rows) in self.parts_with_rows() {
            let masked = masked.map(|masked| &masked[rows.clone()]);
            let own = part.domain.border(part.try_neighbors(progress)?, masked, progress)?;
            border.extend(own.into_iter().map(|x| rows.start + x));
        }
        Ok(border)
    }

    fn may_fill_volume(&self) -> bool {
        self.parts.iter().any(|part| part.domain.may_fill_volume())
    }

    /// A constant fit, as fits of the parts would differ.
    fn local_fit(&self, _: LocalFit) -> LocalFit {
        LocalFit::Constant
    }
}

/// Heat on each part: n steps are the time in which heat spreads by `step_length·√n` everywhere.
#[derive(Debug)]
struct UnionHeat {
    parts: Vec<UnionPart>,
    weights: Vec<f64>,
    /// Root mean square length of a step: the shortest of the parts.
    step_length: f64,
    rate: f64,
    /// Dispersion that is made up for in all parts.
    dispersion: f64,
}

#[derive(Debug)]
struct UnionPart {
    /// The part's own operator; `None` if nothing diffuses there.
    transform: Option<Transform>,
    rows: Range<usize>,
    /// Steps of the part in one step of the union.
    steps: f64,
    /// Factor of the part's own `I − Φ₁`, in [0, 1].
    share: f64,
}

impl UnionHeat {
    fn new(transforms: Vec<Option<Transform>>, rows: &[Range<usize>]) -> Self {
        let length = |transform: &Transform| transform.operator().step_length();
        let transforms: Vec<Option<Transform>> =
            transforms.into_iter().map(|transform| transform.filter(|t| length(t) > 0.0)).collect();
        let shortest = transforms.iter().flatten().map(length).fold(f64::INFINITY, f64::min);
        let step_length = if shortest.is_finite() { shortest } else { 1.0 };
        let steps = |transform: &Transform| (step_length / length(transform)).powi(2);
        let rate_of = |transform: &Transform| match transform.operator().semigroup() {
            Semigroup::Heat { rate, .. } => steps(transform) * rate,
            _ => 0.0,
        };
        let rate = transforms.iter().flatten().map(rate_of).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let dispersion_of = |transform: &Transform| match transform.operator().semigroup() {
            // Relative to the union's I − Φ₁.
            Semigroup::Heat { dispersion, .. } => dispersion * rate / rate_of(transform),
            _ => 0.0,
        };
        let dispersion = transforms.iter().flatten().map(dispersion_of).fold(f64::INFINITY, f64::min);
        let dispersion = if dispersion.is_finite() { dispersion } else { 0.0 };
        let n_rows = rows.last().map_or(0, |rows| rows.end);
        let mut weights = Vec::with_capacity(n_rows);
        for (transform, rows) in transforms.iter().zip(rows) {
            let share = rows.len() as f64 / n_rows as f64;
            match transform.as_ref().map(|transform| transform.operator().weights()) {
                Some(RowWeights::Each(own)) => weights.extend(own.iter().map(|weight| share * weight)),
                _ => weights.extend(rows.clone().map(|_| 1.0 / n_rows as f64)),
            }
        }
        let part = |(transform, rows): (Option<Transform>, &Range<usize>)| UnionPart {
            steps: transform.as_ref().map_or(0.0, steps),
            share: transform.as_ref().map_or(0.0, |transform| rate_of(transform) / rate),
            rows: rows.clone(),
            transform,
        };
        Self {
            parts: transforms.into_iter().zip(rows).map(part).collect(),
            weights,
            step_length,
            rate,
            dispersion,
        }
    }
}

impl Operator for UnionHeat {
    fn n_rows(&self) -> usize {
        self.weights.len()
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        for part in &self.parts {
            let range = part.rows.start * n_channels..part.rows.end * n_channels;
            let (x, out) = (&x[range.clone()], &mut out[range]);
            match &part.transform {
                Some(transform) => {
                    transform.operator().difference(x, n_channels, out, progress)?;
                    for value in out {
                        *value *= part.share;
                    }
                }
                None => out.fill(0.0),
            }
        }
        Ok(())
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn weights(&self) -> RowWeights<'_> {
        RowWeights::Each(&self.weights)
    }

    fn semigroup(&self) -> Semigroup {
        Semigroup::Heat { rate: self.rate, dispersion: self.dispersion }
    }

    fn step_length(&self) -> f64 {
        self.step_length
    }

    fn prepare(&self, progress: Progress<'_>) -> Result<(), Cancelled> {
        self.parts
            .iter()
            .filter_map(|part| part.transform.as_ref())
            .try_for_each(|part| part.prepare(progress))
    }

    fn masked(
        &self,
        masked: &[bool],
        squared_length: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        progress: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        if masked.len() != self.n_rows() {
            return Err(DiffusionError::RowCount { n_rows: self.n_rows(), n_vertices: masked.len() });
        }
        let mut transforms = Vec::with_capacity(self.parts.len());
        for UnionPart { transform, rows, .. } in &self.parts {
            let (flags, first) = (&masked[rows.clone()], rows.start);
            let own_length = move |x: usize, y: usize| squared_length(first + x, first + y);
            transforms.push(match transform {
                Some(transform) if !flags.contains(&true) => Some(transform.clone()),
                Some(transform) if flags.contains(&false) => {
                    match without_places(transform, flags, own_length, progress) {
                        Ok(transform) => Some(transform),
                        Err(MaskError::Rows(error)) => return Err(error),
                        Err(_) => return Ok(None),
                    }
                }
                _ => None,
            });
        }
        let rows: Vec<Range<usize>> = self.parts.iter().map(|part| part.rows.clone()).collect();
        Ok(Some(Arc::new(Self::new(transforms, &rows))))
    }

    fn keeps_promises(&self) -> bool {
        true
    }

    fn leap(&self) -> Option<&dyn Leap> {
        Some(self)
    }
}

impl Leap for UnionHeat {
    fn take_steps(
        &self,
        n_steps: f64,
        x: &[f64],
        n_channels: usize,
        accuracy: f64,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        let mut worst = 0.0_f64;
        for part in &self.parts {
            let range = part.rows.start * n_channels..part.rows.end * n_channels;
            let (x, out) = (&x[range.clone()], &mut out[range]);
            worst = worst.max(part.take_steps(n_steps, x, n_channels, accuracy, out, progress)?);
        }
        Ok(worst)
    }
}

impl UnionPart {
    /// Computes n steps of the union on the part's rows of `x` into `out`: what is left of it without the band of these
    /// steps. Returns a bound of the error relative to `x`, at most `accuracy` where the series of the operator reach it.
    fn take_steps(
        &self,
        n_steps: f64,
        x: &[f64],
        n_channels: usize,
        accuracy: f64,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        let Some(transform) = &self.transform else {
            out.copy_from_slice(x);
            return Ok(0.0);
        };
        let Ok(schedule) = Schedule::real(vec![self.steps * n_steps]) else {
            out.copy_from_slice(x);
            return Ok(1.0);
        };
        let mut asked = accuracy;
        while asked <= COARSEST_ACCURACY {
            let params = BandsParams { accuracy: asked, ..*transform.params() };
            let outcome = transform.with_params(&params).and_then(|transform| {
                transform.weighted_into(x, n_channels, &schedule, &[-1.0], out, progress.quiet())
            });
            match outcome {
                Ok(info) => {
                    for (out, x) in out.iter_mut().zip(x) {
                        *out += x;
                    }
                    return Ok(info.error_bound);
                }
                Err(BandsError::Cancelled(cancelled)) => return Err(cancelled),
                Err(BandsError::Missed { reached, .. }) => asked = (2.0 * reached).max(2.0 * asked),
                Err(_) => break,
            }
        }
        out.copy_from_slice(x);
        Ok(1.0)
    }
}
