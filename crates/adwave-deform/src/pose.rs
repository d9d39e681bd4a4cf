//! The deformation that a pose describes, as recipes and the studio store it.

use crate::coarse_base::default_base;
use crate::{Clones, DeformError, DeformParams, DeformRegions, Deformer, HandleMotion};
use adwave::bands::Schedule;
use adwave::region::Region;
use adwave::vector::{Vector, norm};
use adwave::{Decomposer, Progress};
use adwave_io::{DetailClone, Pose, PoseHandle};

/// Largest share of a pose in a blend.
const MOST_SHARE: f64 = 1e6;

/// Binds a shape to the regions of a pose; [`set_pose`] sets the motions. `vertices` lists the vertices of a region.
/// `earlier` is a deformer of the same shape and width, whose base is used again if it can be.
///
/// A vertex of a handle is not fixed, and one of two handles belongs to the later one.
///
/// # Errors
/// Errors of `vertices` and of [`Deformer::bind`]; [`DeformError::BadLength`] if the width is no length.
pub fn bind_pose<E: From<DeformError>>(
    decomposer: &Decomposer,
    pose: &Pose,
    earlier: Option<&Deformer>,
    vertices: impl FnMut(&Region) -> Result<Vec<u32>, E>,
    progress: Progress<'_>,
) -> Result<Deformer, E> {
    let regions = pose_regions(decomposer, pose, vertices)?;
    // With a stiffness of its own, the units of the earlier one would round it.
    if let Some(earlier) =
        earlier.filter(|earlier| pose.stiffness.is_none() && earlier.keep_lengths() == pose.keep_lengths)
    {
        return Ok(earlier.rebind(&regions, progress)?);
    }
    let extent = decomposer.extent();
    let schedule = match pose.width.map(|width| width.to_model_units(extent)) {
        None => default_base(decomposer),
        Some(value) if value > 0.0 && value.is_finite() => {
            let lengths = Schedule::lengths(&[value], decomposer.operator().step_length());
            lengths.map_err(|_| DeformError::BadLength { what: "the width of a pose", value })?
        }
        Some(value) => return Err(DeformError::BadLength { what: "the width of a pose", value }.into()),
    };
    let stiffness = pose.stiffness.map(|length| length.to_model_units(extent));
    let params = DeformParams { stiffness, keep_lengths: pose.keep_lengths };
    Ok(Deformer::bind(decomposer, &schedule, &regions, &params, progress)?)
}

/// Adds clones of detail to `points`, one position for each vertex of the shape, and carries the result into a pose.
/// `decomposer` is that of the shape before all edits. `vertices` lists the vertices of a region.
///
/// # Errors
/// Errors of [`Clones::set`], [`bind_pose`], [`set_pose`] and [`Deformer::solve`].
pub fn reshape<E: From<DeformError>>(
    decomposer: &Decomposer,
    clones: &[DetailClone],
    pose: Option<&Pose>,
    mut points: Vec<[f64; 3]>,
    vertices: impl FnMut(&Region) -> Result<Vec<u32>, E>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, E> {
    if !clones.is_empty() {
        let mut prepared = Clones::new(decomposer, progress)?;
        prepared.set(clones, progress)?;
        prepared.add_to(&mut points);
    }
    let Some(pose) = pose.filter(|pose| !pose.handles.is_empty()) else { return Ok(points) };
    let mut deformer = bind_pose(decomposer, pose, None, vertices, progress)?;
    set_pose(&mut deformer, pose)?;
    deformer.solve(progress)?;
    let mut posed = points.clone();
    deformer.carried_into(&points, &mut posed);
    Ok(posed)
}

/// Sets the motions of all handles of a pose.
///
/// # Errors
/// [`DeformError::BadMotion`] if a number is not finite or too large.
pub fn set_pose(deformer: &mut Deformer, pose: &Pose) -> Result<(), DeformError> {
    for (k, handle) in pose.handles.iter().enumerate() {
        let motion = motion(handle, deformer.center_of_handle(k))?;
        deformer.set(k + 1, motion)?;
    }
    Ok(())
}

/// Blend of poses that differ by the motions of their handles alone: turns and translations are weighted sums, so that
/// handles turn on the way, and the shape bends anew instead of moving along straight lines. The pose at rest has what
/// the shares leave to 1.
///
/// # Errors
/// [`DeformError::BadShare`] if there is no pose, if regions, width, stiffness or lengths differ, and for another number
/// of shares or one that is not finite.
///
/// ```
/// use adwave_io::{Pose, PoseHandle};
/// let region: adwave::region::Region = adwave::region::parse_region("ball:vertex=7,radius=5%")?;
/// let turned = |degrees: f64| {
///     let handle = PoseHandle { by: [0.0; 3], turn: [degrees, 0.0, 0.0], region: region.clone() };
///     Pose { handles: vec![handle], ..Pose::default() }
/// };
/// let blend = adwave_deform::blend_poses(&[turned(20.0), turned(80.0)], &[0.5, 0.25])?;
/// assert_eq!(blend.handles[0].turn, [30.0, 0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn blend_poses(poses: &[Pose], shares: &[f64]) -> Result<Pose, DeformError> {
    if shares.len() != poses.len() {
        return Err(DeformError::BadShare(format!(
            "a blend needs a share for each pose, {} in all, got {}",
            poses.len(),
            shares.len()
        )));
    }
    if let Some(share) = shares.iter().find(|share| !(share.is_finite() && share.abs() <= MOST_SHARE)) {
        return Err(DeformError::BadShare(format!("shares of poses must be in -1e6..=1e6, got {share:?}")));
    }
    let Some(first) = poses.first() else {
        return Err(DeformError::BadShare("a blend needs at least one pose, got none".to_owned()));
    };
    let mut blend = first.clone();
    for handle in &mut blend.handles {
        (handle.by, handle.turn) = ([0.0; 3], [0.0; 3]);
    }
    for (k, (pose, share)) in poses.iter().zip(shares).enumerate() {
        let mut at_rest = pose.clone();
        for (handle, sum) in at_rest.handles.iter_mut().zip(&mut blend.handles) {
            for c in 0..3 {
                sum.by[c] += share * handle.by[c];
                sum.turn[c] += share * handle.turn[c];
            }
            (handle.by, handle.turn) = (sum.by, sum.turn);
        }
        if at_rest != blend {
            return Err(DeformError::BadShare(format!(
                "poses of a blend must have the same regions, width, stiffness and lengths, and pose {} differs from the first",
                k + 1
            )));
        }
    }
    Ok(blend)
}

/// Turn about a center, and then a translation.
fn motion(handle: &PoseHandle, center: Vector) -> Result<HandleMotion, DeformError> {
    let angle = norm(&handle.turn).to_radians();
    if angle == 0.0 {
        return HandleMotion::new(*HandleMotion::default().linear(), handle.by);
    }
    let turn = HandleMotion::from_turn(handle.turn, angle, center)?;
    HandleMotion::new(*turn.linear(), [0, 1, 2].map(|c| turn.translation()[c] + handle.by[c]))
}

/// Vertices of the regions, each in one of them.
fn pose_regions<E>(
    decomposer: &Decomposer,
    pose: &Pose,
    mut vertices: impl FnMut(&Region) -> Result<Vec<u32>, E>,
) -> Result<DeformRegions, E> {
    let map = decomposer.vertex_map();
    let mut is_taken = vec![false; map.n_welded()];
    let mut free = |found: Vec<u32>| -> Vec<u32> {
        let is_free = |v: &u32| !is_taken.get(map.welded(*v as usize)).copied().unwrap_or(false);
        let found: Vec<u32> = found.into_iter().filter(is_free).collect();
        for &v in &found {
            is_taken[map.welded(v as usize)] = true;
        }
        found
    };
    let mut handles = Vec::with_capacity(pose.handles.len());
    for handle in pose.handles.iter().rev() {
        handles.push(free(vertices(&handle.region)?));
    }
    handles.reverse();
    let fixed = pose.fixed.as_ref().map(&mut vertices).transpose()?.unwrap_or_default();
    Ok(DeformRegions { fixed: free(fixed), handles })
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::region::Length;
    use adwave::sample::Sample;
    use adwave::shape::{Mesh, Shape};

    fn ball(vertex: u32, radius: f64) -> Region {
        let radius = Length::Units(radius);
        Region::Vertices { indices: vec![vertex], radius, falloff: None }
    }

    fn sphere() -> (Decomposer, Vec<[f64; 3]>) {
        let sample = Sample::from_name("sphere", Some(2000)).unwrap();
        let shape = Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces).unwrap());
        (Decomposer::new(&shape), sample.points)
    }

    fn bound(decomposer: &Decomposer, pose: &Pose, earlier: Option<&Deformer>) -> Deformer {
        let vertices = |region: &Region| -> Result<Vec<u32>, DeformError> {
            let weights =
                region.weights(decomposer.metric(), &|_| None, &[], Progress::none()).expect("weights");
            let weights = weights.to_vertices(decomposer.vertex_map());
            Ok((0..).zip(&weights).filter(|(_, w)| **w > 0.0).map(|(v, _)| v).collect())
        };
        let mut deformer = bind_pose(decomposer, pose, earlier, vertices, Progress::none()).unwrap();
        set_pose(&mut deformer, pose).unwrap();
        deformer.solve(Progress::none()).unwrap();
        deformer
    }

    fn highest(points: &[[f64; 3]], sign: f64) -> u32 {
        let order =
            |a: &u32, b: &u32| (sign * points[*a as usize][2]).total_cmp(&(sign * points[*b as usize][2]));
        (0..points.len() as u32).max_by(order).unwrap()
    }

    #[test]
    fn handles_follow_exactly_and_overlapping_regions_are_told_apart() {
        let (decomposer, points) = sphere();
        let (top, bottom) = (highest(&points, 1.0), highest(&points, -1.0));
        let by = [0.1, 0.0, 0.4];
        // The fixed region holds the vertex of the first handle, and both handles overlap.
        let pose = Pose {
            fixed: Some(Region::Any(vec![ball(bottom, 0.5), ball(top, 0.3)])),
            handles: vec![
                PoseHandle { by: [0.0; 3], turn: [0.0, 0.0, 20.0], region: ball(top, 0.4) },
                PoseHandle { by, turn: [0.0; 3], region: ball(top, 0.0) },
            ],
            ..Pose::default()
        };
        let deformer = bound(&decomposer, &pose, None);
        let after = deformer.points();
        let expected = [0, 1, 2].map(|c| points[top as usize][c] + by[c]);
        assert!(norm(&[0, 1, 2].map(|c| after[top as usize][c] - expected[c])) < 1e-12);
        assert_eq!(after[bottom as usize], points[bottom as usize]);
        assert!(deformer.regions().handles[1] == vec![top] && deformer.regions().handles[0].len() > 1);
    }

    #[test]
    fn a_reset_deformer_and_one_that_is_bound_again_give_the_bits_of_a_new_one() {
        let (decomposer, points) = sphere();
        let (top, bottom) = (highest(&points, 1.0), highest(&points, -1.0));
        let handle = |by: [f64; 3]| PoseHandle { by, turn: [0.0; 3], region: ball(top, 0.0) };
        let pose = |by: [f64; 3]| Pose {
            fixed: Some(ball(bottom, 0.6)),
            handles: vec![handle(by)],
            ..Pose::default()
        };
        let target = pose([0.3, 0.2, 0.1]);
        let fresh = bound(&decomposer, &target, None).points();
        let mut dragged = bound(&decomposer, &pose([-0.5, 0.1, 0.7]), None);
        set_pose(&mut dragged, &pose([1.5, 0.1, 0.7])).unwrap();
        dragged.step(Progress::none()).unwrap();
        let again = bound(&decomposer, &target, Some(&dragged)).points();
        assert_eq!(again, fresh);
        dragged.reset();
        set_pose(&mut dragged, &target).unwrap();
        dragged.solve(Progress::none()).unwrap();
        assert_eq!(dragged.points(), fresh);
        // Vertices one by one are those of the whole.
        let chosen = [top, bottom, 5, 77];
        let (turns, some) = (dragged.rotations(), dragged.carried_vertices(&chosen, &points));
        for (v, carried) in chosen.iter().zip(some) {
            assert_eq!((carried.point, carried.turn), (fresh[*v as usize], turns[*v as usize]));
        }
        // Values other than the shape's turn with the frames.
        let mut lifted = points.clone();
        for p in &mut lifted {
            p[0] += 0.01;
        }
        let mut moved = vec![[0.0; 3]; points.len()];
        dragged.carried_into(&lifted, &mut moved);
        let v = points.iter().position(|p| p[2].abs() < 0.1).unwrap();
        let turned = crate::rotation::turn_change(&turns[v], &[0.01, 0.0, 0.0]);
        let expected = [0, 1, 2].map(|c| fresh[v][c] + turned[c] + if c == 0 { 0.01 } else { 0.0 });
        assert!(norm(&[0, 1, 2].map(|c| moved[v][c] - expected[c])) < 1e-12);
    }
}
