//! Deformation by handles with detail kept.

mod carrier;
mod facts;
mod kept;

use crate::coarse_base::{CoarseBase, ROWS_AT_A_TIME};
use crate::front::NO_SOURCE;
use crate::lengths::{KeptLengths, LengthSolver};
use crate::newton::{EarlierSteps, NodeSolver, NodeState, StepLimits};
use crate::node_energy::NodeEnergy;
use crate::regions::{BoundRows, DeformRegions};
use crate::rotation::{IDENTITY, Matrix, NO_TURN, image, to_matrix, turn_change};
use crate::{DeformError, HandleMotion, NewCrossings, new_crossings};
use adwave::bands::Schedule;
use adwave::vector::{Vector, add_scaled, subtract};
use adwave::{Decomposer, Progress};
use carrier::{Carrier, blend};
pub use facts::{BindInfo, DeformInfo, DeformParams};
use rayon::prelude::*;
use std::sync::Arc;

/// Products with the Hessian in a step while a handle is dragged.
const DRAG_PRODUCTS: usize = 12;

/// Products with the Hessian in a step of a solve.
const SOLVE_PRODUCTS: usize = 60;

/// Steps of a solve at most; three to ten are usual.
const MAX_STEPS: usize = 40;

/// Relative decrease of the energy below which a solve ends.
const CONVERGED: f64 = 1e-7;

/// Energy below which a shape counts as moved rigidly.
const RIGID_ENERGY: f64 = 1e-24;

/// A shape bound to handles, whose coarse shape bends while all finer detail rides along in turning frames.
///
/// `f′ = S_J′ + R (f − S_J)`: the coarse shape S_J moves by affine maps of nodes, blended over it, such that it
/// stretches and bends as little as possible (`sorkine2007`, `sumner2007`); R blends the rotations of the nodes.
/// Handles follow their motions exactly. A step costs the same on any number of vertices; [`points`](Self::points)
/// costs O(n). The example `survey` bends the four shapes of `botsch2008`.
///
/// ```
/// use adwave::{Decomposer, Progress, bands::Schedule, sample::Sample, shape::{Mesh, Shape}};
/// use adwave_deform::{DeformParams, DeformRegions, Deformer, HandleMotion};
/// let sample = Sample::from_name("sphere", Some(2000))?;
/// let shape = Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces)?);
/// let below = |z: f64| (0..).zip(&sample.points).filter(|(_, p)| z * p[2] > 0.8).map(|(v, _)| v).collect();
/// let regions = DeformRegions { fixed: below(-1.0), handles: vec![below(1.0)] };
/// let decomposer = Decomposer::new(&shape);
/// let (schedule, params) = (Schedule::dyadic(6)?, DeformParams::default());
/// let mut deformer = Deformer::bind(&decomposer, &schedule, &regions, &params, Progress::none())?;
/// deformer.set(1, HandleMotion::from_translation([0.0, 0.0, 0.5]))?;
/// deformer.solve(Progress::none())?;
/// let top = regions.handles[0][0] as usize;
/// assert!((deformer.points()[top][2] - sample.points[top][2] - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Deformer {
    decomposer: Decomposer,
    base: Arc<CoarseBase>,
    regions: DeformRegions,
    bound: BoundRows,
    stiffness: f64,
    /// Share of lengths, and the solver for them once it was needed.
    keep_lengths: f64,
    length_solver: Option<LengthSolver>,
    /// Positions that keep lengths, of the last solve.
    kept: Option<KeptLengths>,
    energy: NodeEnergy,
    solver: NodeSolver,
    /// Motion of each region in units of the nodes, the fixed part first if there is one.
    motions: Vec<HandleMotion>,
    has_fixed: bool,
    state: NodeState,
    earlier: EarlierSteps,
    is_at_rest: bool,
}

/// Displacement and rotation of a column.
#[derive(Clone, Copy)]
struct ColumnMotion {
    /// `L − I`.
    linear: Matrix,
    /// Displacement of the origin.
    offset: Vector,
    turn: [f64; 4],
    /// Difference between the linear part of a handle and its rotation; `None` if it is a rotation.
    stretch: Option<Matrix>,
}

impl Deformer {
    /// Binds a shape to its regions. O(n log n); a shape of 500 000 vertices takes about 1.2 s on two cores.
    ///
    /// # Errors
    /// [`DeformError`] if the shape has no positions, a region is empty or two overlap, the stiffness is no length, or
    /// the call is cancelled.
    pub fn bind(
        decomposer: &Decomposer,
        schedule: &Schedule,
        regions: &DeformRegions,
        params: &DeformParams,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        if let Some(stiffness) = params.stiffness.filter(|l| !(l.is_finite() && *l >= 0.0)) {
            return Err(DeformError::BadStiffness(stiffness));
        }
        if !(0.0..=1.0).contains(&params.keep_lengths) {
            return Err(DeformError::BadLengths(params.keep_lengths));
        }
        let base = Arc::new(CoarseBase::new(decomposer, schedule, progress)?);
        Self::with_base(decomposer.clone(), base, regions, params, progress)
    }

    /// Binds the same shape to other regions; the nodes stay.
    ///
    /// # Errors
    /// As for [`bind`](Self::bind).
    pub fn rebind(&self, regions: &DeformRegions, progress: Progress<'_>) -> Result<Self, DeformError> {
        let stiffness = Some(self.stiffness * self.base.unit);
        let params = DeformParams { stiffness, keep_lengths: self.keep_lengths };
        Self::with_base(self.decomposer.clone(), Arc::clone(&self.base), regions, &params, progress)
    }

    fn with_base(
        decomposer: Decomposer,
        base: Arc<CoarseBase>,
        regions: &DeformRegions,
        params: &DeformParams,
        progress: Progress<'_>,
    ) -> Result<Self, DeformError> {
        let stiffness = params.stiffness.map_or(1.0, |length| length / base.unit);
        let bound = BoundRows::new(&decomposer, &base, regions, progress)?;
        let energy = NodeEnergy::new(&base, &bound, stiffness * stiffness, progress)?;
        let is_point: Vec<bool> = bound.regions.iter().map(|region| region.is_point).collect();
        let solver = NodeSolver::new(&energy, base.nodes.len(), &is_point)?;
        let has_fixed = !regions.fixed.is_empty();
        let motions = vec![HandleMotion::default(); bound.regions.len()];
        let rest = |c: &Vector| [IDENTITY[0], IDENTITY[1], IDENTITY[2], *c];
        let state = NodeState {
            maps: energy.centers.iter().map(rest).collect(),
            turns: vec![NO_TURN; energy.n_columns()],
        };
        let regions = regions.clone();
        Ok(Self {
            decomposer,
            base,
            regions,
            bound,
            stiffness,
            keep_lengths: params.keep_lengths,
            length_solver: None,
            kept: None,
            energy,
            solver,
            motions,
            has_fixed,
            state,
            earlier: EarlierSteps::default(),
            is_at_rest: true,
        })
    }

    /// Facts about the nodes and the parts.
    pub fn info(&self) -> BindInfo {
        BindInfo {
            n_nodes: self.base.nodes.len(),
            n_samples: self.base.samples.len(),
            sigma: self.base.sigma,
            spacing: self.base.unit,
            stiffness: self.stiffness * self.base.unit,
            n_following_parts: self.bound.followers.len(),
            n_following_vertices: self.bound.followers.iter().map(|part| part.n_vertices).sum(),
            is_free: !self.has_fixed,
        }
    }

    /// Share of lengths, [`DeformParams::keep_lengths`].
    pub fn keep_lengths(&self) -> f64 {
        self.keep_lengths
    }

    /// Regions that the shape is bound to.
    pub fn regions(&self) -> &DeformRegions {
        &self.regions
    }

    /// Sets the motion of handle `handle` (from 1), from the rest shape. [`step`](Self::step) or
    /// [`solve`](Self::solve) lets the shape follow.
    ///
    /// # Errors
    /// [`DeformError::NoSuchHandle`]; [`DeformError::BadMotion`] if the motion leads too far to be computed.
    pub fn set(&mut self, handle: usize, motion: HandleMotion) -> Result<(), DeformError> {
        let n_handles = self.regions.handles.len();
        if handle == 0 || handle > n_handles {
            return Err(DeformError::NoSuchHandle { handle, n_handles });
        }
        let motion = motion.in_unit(self.base.unit);
        if let Some(&value) = motion.translation().iter().find(|c| !c.is_finite() || c.abs() > 1e60) {
            return Err(DeformError::BadMotion(value));
        }
        self.motions[handle - 1 + usize::from(self.has_fixed)] = motion;
        Ok(())
    }

    /// Sets the motion of handle `handle` (from 1) to the [blend](HandleMotion::blend) of motions about its center.
    ///
    /// # Errors
    /// As for [`set`](Self::set) and [`HandleMotion::blend`].
    pub fn set_blend(
        &mut self,
        handle: usize,
        motions: &[HandleMotion],
        shares: &[f64],
    ) -> Result<(), DeformError> {
        let n_handles = self.regions.handles.len();
        if handle == 0 || handle > n_handles {
            return Err(DeformError::NoSuchHandle { handle, n_handles });
        }
        let center = self.center_of_handle(handle - 1);
        self.set(handle, HandleMotion::blend(motions, shares, center)?)
    }

    /// Crossings of the deformed shape that the shape itself does not have.
    ///
    /// # Errors
    /// As for [`new_crossings`].
    pub fn new_crossings(&self, progress: Progress<'_>) -> Result<NewCrossings, DeformError> {
        new_crossings(&self.decomposer, &self.points(), progress)
    }

    /// Mean position of the vertices of handle `k`, from 0, in model units.
    pub(crate) fn center_of_handle(&self, k: usize) -> Vector {
        let points = self.decomposer.points().unwrap_or_default();
        let vertices = &self.regions.handles[k];
        let share = 1.0 / vertices.len().max(1) as f64;
        let sum = |c: usize| vertices.iter().map(|&v| share * points[v as usize][c]).sum();
        [sum(0), sum(1), sum(2)]
    }

    /// Motion that all regions have in common: that of the fixed part, or of the first handle's rotation.
    fn common_motion(&self) -> HandleMotion {
        let first = self.motions[0];
        if self.has_fixed || first.is_rigid() {
            return first;
        }
        let (center, rotation) = (self.bound.regions[0].center, to_matrix(&first.rotation()));
        let (moved, turned) = (first.apply(&center), image(&rotation, &center));
        HandleMotion::new(rotation, subtract(&moved, &turned)).unwrap_or_default()
    }

    /// Sets the regions' columns to their motions relative to the common one. Returns false if nothing moves.
    fn pull_handles(&mut self) -> bool {
        let common = self.common_motion();
        let n_nodes = self.base.nodes.len();
        let is_common = self.motions.iter().all(|motion| *motion == common);
        if is_common {
            let rest = |c: &Vector| [IDENTITY[0], IDENTITY[1], IDENTITY[2], *c];
            self.state.maps = self.energy.centers.iter().map(rest).collect();
            self.state.turns = vec![NO_TURN; self.energy.n_columns()];
            return false;
        }
        for (k, motion) in self.motions.iter().enumerate() {
            let column = n_nodes + k;
            let center = self.energy.centers[column];
            let is_rest = *motion == common;
            let relative = if is_rest { HandleMotion::default() } else { motion.relative_to(&common) };
            if self.bound.regions[k].is_point {
                let shift = self.shift_of_point(k, &relative);
                self.state.maps[column][3] = add_scaled(&center, 1.0, &shift);
                continue;
            }
            let moved = if is_rest { center } else { relative.apply(&center) };
            let l = relative.linear();
            let images = [0, 1, 2].map(|c| [l[0][c], l[1][c], l[2][c]]);
            self.state.maps[column] = [images[0], images[1], images[2], moved];
            let turn = if is_rest { NO_TURN } else { relative.rotation() };
            let before = &self.state.turns[column];
            let cosine: f64 = turn.iter().zip(before).map(|(a, b)| a * b).sum();
            self.state.turns[column] = if cosine < 0.0 { turn.map(|c| -c) } else { turn };
        }
        true
    }

    /// Displacement of the single point of a region by a motion.
    fn shift_of_point(&self, region: usize, motion: &HandleMotion) -> Vector {
        let vertex = self.bound.regions[region].vertices[0] as usize;
        let p = self.decomposer.positions()[vertex].map(|c| c / self.base.unit);
        subtract(&motion.apply(&p), &p)
    }

    /// One truncated Newton step from the present state, for use while a handle is dragged.
    ///
    /// # Errors
    /// [`DeformError::Cancelled`] if the call is cancelled; the state is then that before the step.
    pub fn step(&mut self, progress: Progress<'_>) -> Result<DeformInfo, DeformError> {
        self.kept = None;
        if !self.pull_handles() {
            self.is_at_rest = true;
            return Ok(DeformInfo { is_converged: true, ..DeformInfo::default() });
        }
        self.is_at_rest = false;
        self.solver.fit_maps(&self.energy, &mut self.state);
        let limits = StepLimits { max_products: DRAG_PRODUCTS, progress };
        let step = self.solver.step(&self.energy, &mut self.state, &mut self.earlier, limits)?;
        Ok(DeformInfo {
            n_steps: 1,
            n_products: step.n_products,
            n_length_steps: 0,
            energy_before: step.before,
            energy_after: step.after,
            is_converged: step.before - step.after <= CONVERGED * step.before,
        })
    }

    /// Newton steps until the energy no longer falls, and then, if [`DeformParams::keep_lengths`] is above 0, steps of all
    /// vertices that keep lengths.
    ///
    /// # Errors
    /// As for [`step`](Self::step), and [`DeformError::TooLargeForLengths`].
    pub fn solve(&mut self, progress: Progress<'_>) -> Result<DeformInfo, DeformError> {
        self.kept = None;
        let mut info = self.solve_nodes(progress)?;
        if self.keep_lengths > 0.0 && !self.is_at_rest {
            let kept = self.solve_lengths(progress)?;
            info.n_length_steps = kept.n_steps;
            info.is_converged &= kept.is_converged;
            self.kept = Some(kept);
        }
        Ok(info)
    }

    /// Newton steps until the energy no longer falls: from the present state while handles are dragged, from rotations
    /// spread over the shape otherwise, whichever has less energy.
    fn solve_nodes(&mut self, progress: Progress<'_>) -> Result<DeformInfo, DeformError> {
        if !self.pull_handles() {
            self.is_at_rest = true;
            return Ok(DeformInfo { is_converged: true, ..DeformInfo::default() });
        }
        let mut fresh = self.state.clone();
        self.solver.harmonic_start(&self.energy, &mut fresh);
        let value = |state: &NodeState| {
            let rotations: Vec<Matrix> = state.turns.iter().map(to_matrix).collect();
            self.energy.value(&state.maps, &rotations)
        };
        let mut state = fresh;
        if !self.is_at_rest {
            let mut present = self.state.clone();
            self.solver.fit_maps(&self.energy, &mut present);
            if value(&present) < value(&state) {
                state = present;
            }
        }
        let mut info = DeformInfo { energy_before: value(&state), ..DeformInfo::default() };
        info.energy_after = info.energy_before;
        // Where lengths alone decide, the nodes only show the way.
        let (max_steps, max_products) =
            if self.keep_lengths < 1.0 { (MAX_STEPS, SOLVE_PRODUCTS) } else { (1, DRAG_PRODUCTS) };
        while info.n_steps < max_steps && info.energy_after > RIGID_ENERGY {
            progress.step(info.n_steps as u64, max_steps as u64)?;
            let limits = StepLimits { max_products, progress };
            let step = self.solver.step(&self.energy, &mut state, &mut self.earlier, limits)?;
            info.n_steps += 1;
            info.n_products += step.n_products;
            info.energy_after = step.after;
            if step.before - step.after <= CONVERGED * step.before {
                info.is_converged = true;
                break;
            }
        }
        info.is_converged |= info.energy_after <= RIGID_ENERGY || self.keep_lengths == 1.0;
        self.state = state;
        self.is_at_rest = false;
        Ok(info)
    }

    /// Motions of all columns: nodes, regions, and parts that follow.
    fn column_motions(&self) -> Vec<ColumnMotion> {
        let mut motions: Vec<ColumnMotion> = (0..self.energy.n_columns())
            .map(|k| {
                let (map, c) = (&self.state.maps[k], &self.energy.centers[k]);
                let linear: Matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| map[j][i] - IDENTITY[i][j]));
                let turned = image(&linear, c);
                let offset = [0, 1, 2].map(|i| map[3][i] - c[i] - turned[i]);
                ColumnMotion { linear, offset, turn: self.state.turns[k], stretch: None }
            })
            .collect();
        let n_nodes = self.base.nodes.len();
        for (k, region) in self.bound.regions.iter().enumerate() {
            let motion = &mut motions[n_nodes + k];
            if region.is_point {
                // The detail of a point turns, and the point itself goes where it was sent.
                let vertex = region.vertices[0] as usize;
                let p = self.decomposer.positions()[vertex].map(|c| c / self.base.unit);
                let change = turn_change(&motion.turn, &subtract(&p, &self.base.points[vertex]));
                motion.offset = subtract(&motion.offset, &change);
            } else if !self.motions[k].is_rigid() {
                let r = to_matrix(&motion.turn);
                let difference = |i: usize, j: usize| motion.linear[i][j] + IDENTITY[i][j] - r[i][j];
                motion.stretch = Some([0, 1, 2].map(|i| [0, 1, 2].map(|j| difference(i, j))));
            }
        }
        self.with_followers(motions)
    }

    /// Adds the rigid motions of parts that follow a vertex of another part.
    fn with_followers(&self, mut motions: Vec<ColumnMotion>) -> Vec<ColumnMotion> {
        for part in &self.bound.followers {
            let x = part.anchor as usize;
            let (shift, turn) = blend(&motions, self.bound.rows.row(x), &self.base.points[x]);
            let matrix = to_matrix(&turn);
            let linear: Matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[i][j] - IDENTITY[i][j]));
            let turned = image(&linear, &self.base.points[x]);
            let offset = subtract(&shift, &turned);
            motions.push(ColumnMotion { linear, offset, turn, stretch: None });
        }
        motions
    }

    /// Positions of the deformed shape, in its order and in model units.
    pub fn points(&self) -> Vec<[f64; 3]> {
        let mut points = vec![[0.0; 3]; self.decomposer.n_vertices()];
        self.points_into(&mut points);
        points
    }

    /// [`points`](Self::points) into a buffer. O(n), by all threads.
    ///
    /// # Panics
    /// Unless the buffer has a place for each vertex.
    pub fn points_into(&self, points: &mut [[f64; 3]]) {
        let rest = self.decomposer.points().unwrap_or_default();
        self.carried_into(rest, points);
    }

    /// Deformed positions for other values of the same shape, such as the result of an edit of its bands:
    /// `S_J′ + R (f − S_J)` for these positions f. A pose and an edit are thus independent of each other.
    ///
    /// # Panics
    /// Unless there is a position and a place for each vertex.
    pub fn carried_into(&self, rest: &[[f64; 3]], points: &mut [[f64; 3]]) {
        let n = self.decomposer.n_vertices();
        assert!(rest.len() == n && points.len() == n, "a position for each vertex");
        let carrier = Carrier::new(self);
        points.par_chunks_mut(ROWS_AT_A_TIME).enumerate().for_each(|(chunk, points)| {
            for (v, point) in (chunk * ROWS_AT_A_TIME..).zip(points) {
                *point = carrier.point(v, &rest[v]);
            }
        });
    }

    /// New places and frames of some vertices, which a display needs: `S_J′ + R (f − S_J)` and R for each, with
    /// positions f of the shape in `rest`. O(vertices).
    ///
    /// # Panics
    /// If a vertex does not exist, or has no position in `rest`.
    pub fn carried_vertices(&self, vertices: &[u32], rest: &[[f64; 3]]) -> Vec<CarriedVertex> {
        let carrier = Carrier::new(self);
        let carried = |v: &u32| {
            let v = *v as usize;
            CarriedVertex { point: carrier.point(v, &rest[v]), turn: carrier.turn(v) }
        };
        vertices.par_iter().with_min_len(ROWS_AT_A_TIME / 4).map(carried).collect()
    }

    /// Takes all motions back and forgets earlier states, so that later results depend on the motions alone.
    pub fn reset(&mut self) {
        self.kept = None;
        self.motions.fill(HandleMotion::default());
        self.pull_handles();
        self.earlier = EarlierSteps::default();
        self.is_at_rest = true;
    }

    /// The common motion in model units; `None` if it moves nothing.
    fn common_in_model_units(&self) -> Option<HandleMotion> {
        let common = self.common_motion();
        (common != HandleMotion::default()).then(|| common.in_unit(1.0 / self.base.unit))
    }

    /// Motion of each region that differs from the common one, in model units; its vertices follow it exactly.
    fn exact_regions(&self) -> Vec<Option<HandleMotion>> {
        let common = self.common_motion();
        let exact = |motion: &HandleMotion| (*motion != common).then(|| motion.in_unit(1.0 / self.base.unit));
        self.motions.iter().map(exact).collect()
    }

    /// Motion of the region of a vertex without neighbors.
    fn exact_motion(&self, x: usize) -> Option<HandleMotion> {
        let region = self.bound.region_of[x];
        (region != NO_SOURCE).then(|| self.motions[region as usize].in_unit(1.0 / self.base.unit))
    }

    /// Rotation of the frame of each vertex, as a unit quaternion `w, x, y, z`, in the order of the shape.
    pub fn rotations(&self) -> Vec<[f64; 4]> {
        let carrier = Carrier::new(self);
        (0..self.decomposer.n_vertices()).into_par_iter().map(|v| carrier.turn(v)).collect()
    }

    /// Energy, solver and state, for tests of derivatives.
    #[cfg(test)]
    pub(crate) fn parts(&self) -> (&NodeEnergy, &NodeSolver, &NodeState) {
        (&self.energy, &self.solver, &self.state)
    }

    /// Energy of the present state, without unit; 0 at rest.
    pub fn energy(&self) -> f64 {
        let rotations: Vec<Matrix> = self.state.turns.iter().map(to_matrix).collect();
        self.energy.value(&self.state.maps, &rotations)
    }
}

/// Place and frame of a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriedVertex {
    /// Position in model units.
    pub point: [f64; 3],
    /// Rotation of the frame, as a unit quaternion `w, x, y, z`.
    pub turn: [f64; 4],
}
