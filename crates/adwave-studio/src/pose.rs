//! Edits other than those of bands: clones of detail, and a deformation by handles. The deformation is prepared once
//! and then follows a dragged handle.

use crate::region_weights::region_weights;
use crate::response::{ApiError, encode_rows};
use adwave::region::Region;
use adwave::{Decomposer, Progress};
use adwave_deform::{CarriedVertex, Clones, Deformer, bind_pose, set_pose};
use adwave_io::{DetailClone, Pose, ShapeFile};
use serde::Deserialize;
use std::borrow::Cow;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Largest number of handles.
const MAX_HANDLES: usize = 200;
/// Largest number of clones, counted by their targets.
const MAX_CLONES: usize = 20_000;

/// Edits other than those of bands.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReshapedBy {
    /// Clones of detail, applied in this order.
    #[serde(default)]
    pub(crate) clones: Vec<DetailClone>,
    /// Handles that bend the shape.
    #[serde(default)]
    pub(crate) pose: Option<Pose>,
}

impl ReshapedBy {
    pub(crate) fn is_neutral(&self) -> bool {
        self.clones.is_empty() && self.bending().is_none()
    }

    /// Returns the pose if it has handles.
    fn bending(&self) -> Option<&Pose> {
        self.pose.as_ref().filter(|pose| !pose.handles.is_empty())
    }

    /// Checks the limits that do not depend on the shape.
    pub(crate) fn check(&self) -> Result<(), ApiError> {
        let n_handles = self.pose.as_ref().map_or(0, |pose| pose.handles.len());
        if n_handles > MAX_HANDLES {
            return Err(ApiError::bad_request(format!(
                "a pose has at most {MAX_HANDLES} handles, got {n_handles}; remove some"
            )));
        }
        let n_clones: usize = self.clones.iter().map(|clone| clone.targets.len()).sum();
        if n_clones > MAX_CLONES {
            return Err(ApiError::bad_request(format!(
                "an edit has at most {MAX_CLONES} clones, got {n_clones}; undo some"
            )));
        }
        Ok(())
    }
}

/// Manner in which a shape follows its handles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Follow {
    /// Moves one step toward the handles, while one is dragged.
    Step,
    /// Moves to rest from the unbent shape, so that the result depends only on the pose.
    Rest,
}

/// Prepared deformation with its current pose.
struct BoundPose {
    deformer: Deformer,
    pose: Pose,
    /// True if the deformer rests in the pose, as a new one would.
    is_at_rest: bool,
}

/// Deformation of a shape, which does not depend on its bands.
pub(crate) struct Poser {
    /// Diffusion of the walk operator, from which the base is computed for all levels.
    walk: Decomposer,
    bound: Mutex<Option<BoundPose>>,
    clones: Mutex<Option<Clones>>,
}

impl Poser {
    pub(crate) fn new(walk: Decomposer) -> Self {
        Self { walk, bound: Mutex::default(), clones: Mutex::default() }
    }

    /// Bends the shape by a pose; on an error the previous pose remains.
    fn follow(
        &self,
        pose: &Pose,
        file: &ShapeFile,
        follow: Follow,
        progress: Progress<'_>,
    ) -> Result<MutexGuard<'_, Option<BoundPose>>, ApiError> {
        let mut guard = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |bound: &BoundPose| bound.pose == *pose && bound.is_at_rest;
        if guard.as_ref().is_some_and(is_same) {
            return Ok(guard);
        }
        let has_regions = |bound: &BoundPose| has_equal_regions(&bound.pose, pose);
        let mut is_new = false;
        let mut next = match guard.take() {
            Some(bound) if has_regions(&bound) => bound,
            other => {
                is_new = true;
                let base = other.as_ref().filter(|bound| has_equal_base(&bound.pose, pose));
                let earlier = base.map(|bound| &bound.deformer);
                let vertices = |region: &Region| self.vertices(region, file);
                let bound = bind_pose(&self.walk, pose, earlier, vertices, progress);
                match bound {
                    Ok(deformer) => BoundPose { deformer, pose: pose.clone(), is_at_rest: false },
                    Err(error) => {
                        *guard = other;
                        return Err(error);
                    }
                }
            }
        };
        if follow == Follow::Rest {
            next.deformer.reset();
        }
        let moved = set_pose(&mut next.deformer, pose).and_then(|()| {
            // A dragged handle is followed step by step, from the pose before it was touched.
            if follow == Follow::Rest || is_new {
                next.deformer.solve(progress)
            } else {
                next.deformer.step(progress)
            }
        });
        if let Err(error) = moved {
            // The deformer may be halfway; the next request binds it again.
            return Err(error.into());
        }
        next.pose = pose.clone();
        next.is_at_rest = follow == Follow::Rest;
        *guard = Some(next);
        Ok(guard)
    }

    /// Adds the detail of clones to positions of the shape.
    fn add_clones(
        &self,
        clones: &[DetailClone],
        points: &mut [[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<(), ApiError> {
        if clones.is_empty() {
            return Ok(());
        }
        let mut guard = self.clones.lock().unwrap_or_else(PoisonError::into_inner);
        let prepared = match guard.as_mut() {
            Some(prepared) => prepared,
            None => guard.insert(Clones::new(&self.walk, progress)?),
        };
        prepared.set(clones, progress)?;
        prepared.add_to(points);
        Ok(())
    }

    /// Adds clones to positions of the shape, then moves the positions into the pose.
    pub(crate) fn carry(
        &self,
        by: &ReshapedBy,
        file: &ShapeFile,
        mut points: Vec<[f64; 3]>,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, ApiError> {
        self.add_clones(&by.clones, &mut points, progress)?;
        let Some(pose) = by.bending() else { return Ok(points) };
        let bound = self.follow(pose, file, Follow::Rest, progress)?;
        let Some(bound) = bound.as_ref() else { return Ok(points) };
        let mut carried = points.clone();
        bound.deformer.carried_into(&points, &mut carried);
        Ok(carried)
    }

    /// Positions and rotations, after clones and pose, of some vertices of the shape without changes of its bands;
    /// `None` selects all vertices.
    pub(crate) fn carried_vertices(
        &self,
        by: &ReshapedBy,
        file: &ShapeFile,
        follow: Follow,
        vertices: Option<&[u32]>,
    ) -> Result<Vec<CarriedVertex>, ApiError> {
        let mut rest = Cow::Borrowed(file.points());
        if !by.clones.is_empty() {
            self.add_clones(&by.clones, rest.to_mut(), Progress::none())?;
        }
        let all: Vec<u32>;
        let vertices = if let Some(vertices) = vertices {
            vertices
        } else {
            all = (0..self.walk.n_vertices() as u32).collect();
            &all
        };
        if let Some(pose) = by.bending() {
            let bound = self.follow(pose, file, follow, Progress::none())?;
            if let Some(bound) = bound.as_ref() {
                return Ok(bound.deformer.carried_vertices(vertices, &rest));
            }
        }
        let still = |v: &u32| CarriedVertex { point: rest[*v as usize], turn: [1.0, 0.0, 0.0, 0.0] };
        Ok(vertices.iter().map(still).collect())
    }

    /// Lists the vertices of a region, those with a weight above 0.
    fn vertices(&self, region: &Region, file: &ShapeFile) -> Result<Vec<u32>, ApiError> {
        let weights = region_weights(region, file, &self.walk, Progress::none());
        let weights = weights.map_err(|e| ApiError::from_classified(&e))?;
        let weights = weights.to_vertices(self.walk.vertex_map());
        Ok((0..).zip(&weights).filter(|(_, w)| **w > 0.0).map(|(v, _)| v).collect())
    }
}

fn has_equal_base(a: &Pose, b: &Pose) -> bool {
    a.width == b.width && a.stiffness == b.stiffness && a.keep_lengths == b.keep_lengths
}

fn has_equal_regions(a: &Pose, b: &Pose) -> bool {
    let regions = |pose: &Pose| pose.handles.iter().map(|handle| handle.region.clone()).collect::<Vec<_>>();
    has_equal_base(a, b) && a.fixed == b.fixed && regions(a) == regions(b)
}

/// Encodes positions relative to `center`, `f32 × 3 × m`, and then rotations as quaternions x, y, z, w, `i16 × 4 × m`.
pub(crate) fn encode_carried(carried: &[CarriedVertex], center: [f64; 3]) -> Vec<u8> {
    let mut content = encode_rows(carried.len(), 12, |k, row| {
        for c in 0..3 {
            row[4 * c..][..4].copy_from_slice(&((carried[k].point[c] - center[c]) as f32).to_le_bytes());
        }
    });
    content.extend(encode_rows(carried.len(), 8, |k, row| {
        let [w, x, y, z] = carried[k].turn;
        for (c, value) in [x, y, z, w].into_iter().enumerate() {
            let value = (value * f64::from(i16::MAX)).round() as i16;
            row[2 * c..][..2].copy_from_slice(&value.to_le_bytes());
        }
    }));
    content
}
