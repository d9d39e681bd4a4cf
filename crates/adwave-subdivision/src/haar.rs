//! Haar wavelets on faces, orthonormal for any areas.
//!
//! Let a face have four children of areas a₀ … a₃, a₀ in the middle. Its value is c = Σ √(a_i/A)·c_i, where c_i is the
//! value of a child times the root of its area. With q_i = √(a_i/A), the reflection `H = I − 2vvᵀ/vᵀv`, v = q − e₀
//! (`householder1958`), maps (c₀, …, c₃) to c and three details. It is orthonormal for all areas. If the three outer
//! areas agree, the details are equal for the outer children up to their order, like those of SOHO (`lessig2008`).

use crate::lifting::{check_field, usable_masses};
use crate::topology::NONE;
use crate::{Family, Hierarchy, LiftedCoefficients, SubdivisionError};
use adwave::Progress;

/// Haar wavelets on the faces of a hierarchy, prepared for many fields.
///
/// Each face has one coefficient: each of the three outer children has a detail of its level, and the inner child has
/// the value of the coarser face.
#[derive(Clone, Debug)]
pub struct HaarWavelets {
    /// Areas of the faces, with sum 1.
    areas: Vec<f64>,
    /// Groups of sibling faces for each level, from fine to coarse, as faces of the mesh.
    steps: Vec<Vec<Siblings>>,
    levels: Vec<u32>,
}

/// Four faces of the mesh that represent the children of one face, and the reflection of their values.
#[derive(Clone, Copy, Debug)]
struct Siblings {
    faces: [u32; 4],
    v: [f64; 4],
    /// Factor 2/vᵀv of the reflection, or 0 if v is 0.
    scale: f64,
}

impl Siblings {
    fn new(faces: [u32; 4], areas: [f64; 4]) -> Self {
        let total: f64 = areas.iter().sum();
        let q = areas.map(|a| (a / total).sqrt());
        // 1 − q₀ without cancellation.
        let rest = (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) / (1.0 + q[0]);
        let v = [-rest, q[1], q[2], q[3]];
        let square: f64 = v.iter().map(|x| x * x).sum();
        Self { faces, v, scale: if square > 0.0 { 2.0 / square } else { 0.0 } }
    }

    /// Reflects the values of the four faces in place.
    fn reflect(&self, values: &mut [f64], d: usize) {
        for channel in 0..d {
            let at = self.faces.map(|f| f as usize * d + channel);
            let dot: f64 = at.iter().zip(self.v).map(|(&i, v)| values[i] * v).sum();
            for (&i, v) in at.iter().zip(self.v) {
                values[i] -= self.scale * dot * v;
            }
        }
    }
}

impl HaarWavelets {
    /// Prepares the wavelets of a hierarchy, for the areas of its faces.
    ///
    /// # Errors
    /// [`SubdivisionError`] if the number of areas is wrong, if an area is negative or not finite, and for
    /// quadrilaterals.
    pub fn new(hierarchy: &Hierarchy, areas: &[f64]) -> Result<Self, SubdivisionError> {
        if hierarchy.is_of_quads() {
            let reason = "is for triangles, and the mesh has quadrilaterals; use 'catmull-clark' or 'linear'";
            return Err(SubdivisionError::Family { family: Family::Haar.name(), reason });
        }
        let n_faces = hierarchy.n_faces(0);
        let areas = usable_masses(areas, n_faces, "areas of the faces")?;
        // The face of the mesh that stands for each face of the level at hand, and the area of that face.
        let mut names: Vec<u32> = (0..n_faces as u32).collect();
        let mut sizes = areas.clone();
        let mut levels = vec![0; n_faces];
        let mut steps = Vec::new();
        for (step, level) in (1..).zip(&hierarchy.levels[1..]) {
            let (mut siblings, mut coarse_names, mut coarse_sizes) = (Vec::new(), Vec::new(), Vec::new());
            for children in &level.children {
                coarse_names.push(names[children[0] as usize]);
                if children[1] == NONE {
                    coarse_sizes.push(sizes[children[0] as usize]);
                    continue;
                }
                let own = children.map(|f| sizes[f as usize]);
                coarse_sizes.push(own.iter().sum());
                let faces = children.map(|f| names[f as usize]);
                for face in &faces[1..] {
                    levels[*face as usize] = step;
                }
                siblings.push(Siblings::new(faces, own));
            }
            steps.push(siblings);
            (names, sizes) = (coarse_names, coarse_sizes);
        }
        for face in names {
            levels[face as usize] = steps.len() as u32 + 1;
        }
        Ok(Self { areas, steps, levels })
    }

    /// Number of faces of the mesh.
    pub fn n_faces(&self) -> usize {
        self.areas.len()
    }

    /// Areas of the faces as shares of the total area.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Computes the orthonormal coefficients of a field of `n_channels` values per face; their squares sum to Σ a·f².
    /// O(n).
    ///
    /// # Errors
    /// [`SubdivisionError`] for a wrong number of values, a value that is not finite, and on cancellation.
    pub fn analyze(
        &self,
        values: &[f64],
        n_channels: usize,
        progress: Progress<'_>,
    ) -> Result<LiftedCoefficients, SubdivisionError> {
        check_field(values, self.n_faces(), n_channels, "values of the faces")?;
        let mut field = values.to_vec();
        for (row, area) in field.chunks_exact_mut(n_channels).zip(&self.areas) {
            for value in row {
                *value *= area.sqrt();
            }
        }
        for siblings in &self.steps {
            progress.check()?;
            for four in siblings {
                four.reflect(&mut field, n_channels);
            }
        }
        let norms = vec![1.0; self.n_faces()];
        Ok(LiftedCoefficients { n_channels, values: field, levels: self.levels.clone(), norms })
    }

    /// Computes the field of some coefficients; the inverse of [`analyze`](Self::analyze). O(n).
    ///
    /// # Errors
    /// [`SubdivisionError`] for a wrong number of coefficients, a coefficient that is not finite, and on cancellation.
    pub fn synthesize(
        &self,
        coefficients: &[f64],
        n_channels: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, SubdivisionError> {
        check_field(coefficients, self.n_faces(), n_channels, "coefficients")?;
        let mut field = coefficients.to_vec();
        for siblings in self.steps.iter().rev() {
            progress.check()?;
            for four in siblings {
                four.reflect(&mut field, n_channels);
            }
        }
        for (row, area) in field.chunks_exact_mut(n_channels).zip(&self.areas) {
            for value in row {
                *value /= area.sqrt();
            }
        }
        Ok(field)
    }
}
