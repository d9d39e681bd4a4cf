//! The clones of detail of an edit, as recipes and the studio store them.

use crate::coarse_base::default_base;
use crate::{DeformError, DetailCloner, Stamp};
use adwave::vector::{add_scaled, subtract};
use adwave::{Decomposer, Progress};
use adwave_io::DetailClone;

/// Clones of the detail finer than the usual base, one after the other. Those that were applied before are kept, so
/// that a further one costs its own vertices only.
pub struct Clones {
    decomposer: Decomposer,
    cloner: DetailCloner,
    /// Clones in `details`, each of one target.
    applied: Vec<DetailClone>,
    details: Vec<[f64; 3]>,
    is_changed: Vec<bool>,
}

impl Clones {
    /// Prepares a shape for clones. O(n).
    ///
    /// # Errors
    /// [`DeformError`] if the shape has no positions or the call is cancelled.
    pub fn new(decomposer: &Decomposer, progress: Progress<'_>) -> Result<Self, DeformError> {
        let schedule = default_base(decomposer);
        let cloner = DetailCloner::new(decomposer, &schedule, 1..=schedule.n_levels(), progress)?;
        let details = cloner.details().to_vec();
        let is_changed = vec![false; details.len()];
        Ok(Self { decomposer: decomposer.clone(), cloner, applied: Vec::new(), details, is_changed })
    }

    /// Applies a list of clones to the shape as it was opened. On an error the clones before it are applied.
    ///
    /// # Errors
    /// Errors of [`DetailCloner::stamp`].
    pub fn set(&mut self, clones: &[DetailClone], progress: Progress<'_>) -> Result<(), DeformError> {
        let single = |clone: &DetailClone| {
            let each = clone.targets.iter();
            each.map(|&target| DetailClone { targets: vec![target], ..clone.clone() }).collect::<Vec<_>>()
        };
        let wanted: Vec<DetailClone> = clones.iter().flat_map(single).collect();
        if !wanted.starts_with(&self.applied) {
            self.details.copy_from_slice(self.cloner.details());
            self.is_changed.fill(false);
            self.applied.clear();
        }
        for clone in wanted.into_iter().skip(self.applied.len()) {
            let stamp = Stamp {
                source: clone.source,
                target: clone.targets[0],
                radius: clone.radius.to_model_units(self.decomposer.extent()),
                angle: clone.angle.to_radians(),
                strength: clone.strength,
            };
            let stamped = self.cloner.stamp(&stamp, &mut self.details, progress)?;
            for x in stamped.vertices {
                self.is_changed[x as usize] = true;
            }
            self.applied.push(clone);
        }
        Ok(())
    }

    /// Adds the changes by the clones to positions. Vertices outside all clones keep their bits.
    ///
    /// # Panics
    /// Unless there is a position for each vertex.
    pub fn add_to(&self, points: &mut [[f64; 3]]) {
        let welded = self.decomposer.vertex_map().as_slice();
        assert_eq!(points.len(), welded.len(), "a position for each vertex");
        for (p, &x) in points.iter_mut().zip(welded) {
            let x = x as usize;
            if self.is_changed[x] {
                *p = add_scaled(p, 1.0, &subtract(&self.details[x], &self.cloner.details()[x]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::region::Length;
    use adwave::sample::Sample;
    use adwave::shape::{Mesh, Shape};

    fn sphere() -> (Decomposer, Vec<[f64; 3]>) {
        let sample = Sample::from_name("creature", Some(3000)).unwrap();
        let shape = Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces).unwrap());
        (Decomposer::new(&shape), sample.points)
    }

    fn clone_to(targets: &[u32]) -> DetailClone {
        let radius = Length::PercentOfDiagonal(6.0);
        DetailClone { source: 100, targets: targets.to_vec(), radius, angle: 30.0, strength: 0.75 }
    }

    fn applied(clones: &mut Clones, list: &[DetailClone], points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        clones.set(list, Progress::none()).unwrap();
        let mut points = points.to_vec();
        clones.add_to(&mut points);
        points
    }

    #[test]
    fn clones_one_by_one_are_those_at_once_and_are_taken_back() {
        let (decomposer, points) = sphere();
        let mut clones = Clones::new(&decomposer, Progress::none()).unwrap();
        assert_eq!(applied(&mut clones, &[], &points), points);
        let first = applied(&mut clones, &[clone_to(&[700])], &points);
        assert_ne!(first, points);
        let both = applied(&mut clones, &[clone_to(&[700, 720])], &points);
        let mut fresh = Clones::new(&decomposer, Progress::none()).unwrap();
        assert_eq!(applied(&mut fresh, &[clone_to(&[700]), clone_to(&[720])], &points), both);
        assert_eq!(applied(&mut clones, &[clone_to(&[700])], &points), first);
        assert_eq!(applied(&mut clones, &[], &points), points);
        // Far vertices keep their bits.
        let far = (0..points.len()).max_by(|&a, &b| {
            let d = |v: usize| adwave::vector::norm(&subtract(&points[v], &points[700]));
            d(a).total_cmp(&d(b))
        });
        assert_eq!(first[far.unwrap()], points[far.unwrap()]);
    }

    #[test]
    fn a_clone_onto_itself_changes_nothing() {
        let (decomposer, points) = sphere();
        let mut clones = Clones::new(&decomposer, Progress::none()).unwrap();
        let itself = DetailClone { targets: vec![100], angle: 0.0, ..clone_to(&[]) };
        let after = applied(&mut clones, &[itself], &points);
        let most = after.iter().zip(&points).map(|(a, b)| adwave::vector::norm(&subtract(a, b)));
        assert!(most.fold(0.0, f64::max) < 1e-12);
    }

    #[test]
    fn bad_clones_are_refused() {
        let (decomposer, _) = sphere();
        let mut clones = Clones::new(&decomposer, Progress::none()).unwrap();
        for bad in [
            DetailClone { source: 99_999, ..clone_to(&[5]) },
            DetailClone { radius: Length::Units(0.0), ..clone_to(&[5]) },
            DetailClone { strength: 1.5, ..clone_to(&[5]) },
            DetailClone { angle: f64::NAN, ..clone_to(&[5]) },
            clone_to(&[99_999]),
        ] {
            assert!(clones.set(std::slice::from_ref(&bad), Progress::none()).is_err(), "{bad:?}");
        }
    }
}
