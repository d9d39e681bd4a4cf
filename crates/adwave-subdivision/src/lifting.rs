//! Wavelets by lifting (`sweldens1998`): prediction of midpoints, update of coarse vertices.

use crate::even_solve::EvenRule;
use crate::hierarchy::HierarchyLevel;
use crate::prediction::Prediction;
use crate::quad_stencils;
use crate::rows::{add_product, from_diagonal};
use crate::stencils;
use crate::update::{Synthesis, Update};
use crate::{Family, Hierarchy, LiftedCoefficients, SubdivisionError};
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};

/// Least mass of a vertex as a share of the mean mass, so that each update exists.
const LEAST_MASS: f64 = 1e-9;

/// Number of rings around the parents that the update of a Loop or Catmull–Clark wavelet may change; with one ring the
/// condition of the basis is five times as large (Loop), or up to fifty times (Catmull–Clark, on a prism).
const WIDE_RINGS: usize = 2;

/// Largest relative error of the values at the coarse vertices that solving for Catmull–Clark's rule may leave.
const EVEN_ERROR: f64 = 1e-12;

/// Largest number of neighbors of a coarse vertex; the number of products of their functions is its square.
const MAX_NEIGHBORS: usize = 1000;

/// Wavelets of a mesh, prepared for many fields.
///
/// A step from fine to coarse is `d = f_odd − P·c`, `c += U·d`, where c are the values at the coarse vertices; for
/// [`Family::Loop`] and [`Family::CatmullClark`], c are the values from which subdivision makes the values of f there.
/// P is the subdivision rule. U is the least squares solution on the rings of the parents of each midpoint, on two
/// rings for these families (see the module `update`). Every wavelet has integral 0, so that the mean of a field is the
/// same on all levels.
///
/// Each vertex has one coefficient: a detail of the level at which it is a midpoint, or a value on the coarsest level.
#[derive(Clone, Debug)]
pub struct LiftedWavelets {
    family: Family,
    /// Vertex of the mesh at each place; the vertices of each coarser level come first.
    order: Vec<u32>,
    /// Steps from fine to coarse.
    steps: Vec<LiftingStep>,
    /// Masses of the vertices in the order of the mesh, with sum 1.
    masses: Vec<f64>,
    /// Level of each vertex of the mesh: 1 for the finest details, one more than the number of levels for the coarsest
    /// values.
    levels: Vec<u32>,
    /// Norm of the basis function of each coefficient, in the order of the mesh.
    norms: Vec<f64>,
}

/// One step from fine to coarse.
#[derive(Clone, Debug)]
pub(crate) struct LiftingStep {
    n_coarse: usize,
    n_fine: usize,
    prediction: Prediction,
    update: CompressedRows<f64>,
    even: Option<EvenRule>,
}

/// Weights of one step before its update is known.
pub(crate) struct StepRule {
    pub(crate) n_coarse: usize,
    pub(crate) prediction: CompressedRows<f64>,
    /// Coarse vertices that the update of each midpoint may change.
    pub(crate) supports: CompressedRows<f64>,
    pub(crate) even: Option<EvenRule>,
}

impl StepRule {
    fn new(level: &HierarchyLevel, family: Family, hierarchy: &Hierarchy) -> Self {
        let (prediction, even) = match family {
            Family::Linear if hierarchy.is_of_quads() => (quad_stencils::linear(level), None),
            Family::Linear => (stencils::linear(level), None),
            Family::CatmullClark => {
                let even = quad_stencils::even_rule(level, hierarchy.corners);
                (quad_stencils::catmull_clark(level), Some(even))
            }
            Family::Loop => {
                (stencils::loop_midpoints(level), Some(EvenRule::new(stencils::loop_neighbors(level))))
            }
            _ => (stencils::butterfly(level), None),
        };
        let n_rings = if even.is_some() { WIDE_RINGS } else { 1 };
        let supports = stencils::parent_rings(level, n_rings);
        Self { n_coarse: level.topology.n_vertices, prediction, supports, even }
    }
}

impl LiftedWavelets {
    /// Prepares the wavelets of a hierarchy, for masses of the vertices (areas of any surface with these faces).
    ///
    /// A mass below 10⁻⁹ of the mean is raised to that value. O(n); about 1 µs per vertex and thread.
    ///
    /// # Errors
    /// [`SubdivisionError`] if the number of masses is wrong, if a mass is negative or not finite, for [`Family::Haar`]
    /// and [`Family::Irregular`], for a coarse vertex with too many neighbors, and on cancellation.
    pub fn new(
        hierarchy: &Hierarchy,
        family: Family,
        masses: &[f64],
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        if matches!(family, Family::Haar | Family::Irregular) {
            let reason = match family {
                Family::Haar => "has one value per face; use HaarWavelets",
                _ => "needs no hierarchy; use LiftedWavelets::new_irregular",
            };
            return Err(SubdivisionError::Family { family: family.name(), reason });
        }
        let of_quads = hierarchy.is_of_quads();
        if family != Family::Linear && of_quads != (family == Family::CatmullClark) {
            let reason = if of_quads {
                "is for triangles, and the mesh has quadrilaterals; use 'catmull-clark' or 'linear'"
            } else {
                "is for quadrilaterals, and the mesh has triangles; use 'butterfly', 'loop' or 'linear'"
            };
            return Err(SubdivisionError::Family { family: family.name(), reason });
        }
        for level in &hierarchy.levels[1..] {
            if let Some(corners) = level.topology.faces.iter().find(|corners| corners.len() > MAX_NEIGHBORS) {
                let (vertex, n_neighbors) = (hierarchy.order[corners[0] as usize], corners.len());
                return Err(SubdivisionError::Crowded { vertex, n_neighbors, most: MAX_NEIGHBORS });
            }
            let n_neighbors = |v: &u32| level.topology.n_neighbors(*v);
            let most = (0..level.topology.n_vertices as u32).max_by_key(n_neighbors).unwrap_or(0);
            if n_neighbors(&most) > MAX_NEIGHBORS {
                let (vertex, n_neighbors) = (hierarchy.order[most as usize], n_neighbors(&most));
                return Err(SubdivisionError::Crowded { vertex, n_neighbors, most: MAX_NEIGHBORS });
            }
        }
        let rules: Vec<StepRule> =
            hierarchy.levels[1..].iter().map(|level| StepRule::new(level, family, hierarchy)).collect();
        for (k, rule) in rules.iter().enumerate().filter(|_| family == Family::CatmullClark) {
            let error = rule.even.as_ref().map_or(Ok(0.0), |even| even.measured_error(progress))?;
            if error.is_nan() || error > EVEN_ERROR {
                return Err(SubdivisionError::Singular { level: k + 1, error });
            }
        }
        Self::from_rules(family, hierarchy.order.clone(), rules.into_iter(), masses, progress)
    }

    /// Prepares the wavelets of steps from fine to coarse, for an order of the vertices.
    pub(crate) fn from_rules(
        family: Family,
        order: Vec<u32>,
        rules: impl Iterator<Item = StepRule>,
        masses: &[f64],
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        let n = order.len();
        let masses = usable_masses(masses, n, "areas of the vertices")?;
        let mut fine: Vec<f64> = order.iter().map(|&v| masses[v as usize]).collect();
        let mut products = from_diagonal(&fine);
        let mut norms = vec![0.0; n];
        let mut levels = vec![0_u32; n];
        let mut steps = Vec::new();
        for (step, rule) in (1..).zip(rules) {
            progress.check()?;
            let StepRule { n_coarse, prediction, supports, even } = rule;
            let synthesis = Synthesis { even: even.as_ref(), prediction: &prediction, n_coarse };
            let Update { rows, masses, products: coarse_products, norms: found } =
                synthesis.update(&supports, &fine, &products, progress)?;
            for (&v, norm) in order[n_coarse..].iter().zip(found) {
                norms[v as usize] = norm;
                levels[v as usize] = step;
            }
            let prediction = Prediction::new(&prediction);
            steps.push(LiftingStep { n_coarse, n_fine: fine.len(), prediction, update: rows, even });
            (fine, products) = (masses, coarse_products);
        }
        for (k, &v) in order[..fine.len()].iter().enumerate() {
            norms[v as usize] = products.get(k, k).max(0.0).sqrt();
            levels[v as usize] = steps.len() as u32 + 1;
        }
        Ok(Self { family, order, steps, masses, levels, norms })
    }

    /// Family of the wavelets.
    pub fn family(&self) -> Family {
        self.family
    }

    /// Number of levels.
    pub fn n_levels(&self) -> usize {
        self.steps.len()
    }

    /// Number of vertices of the mesh.
    pub fn n_vertices(&self) -> usize {
        self.order.len()
    }

    /// Number of vertices of a level.
    ///
    /// # Panics
    /// If the level does not exist.
    pub fn n_vertices_at(&self, level: usize) -> usize {
        if level == 0 { self.order.len() } else { self.steps[level - 1].n_coarse }
    }

    /// Vertices of the mesh in the order of the levels: the vertices of each coarser level come first.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Masses of the vertices for which the mean of a field is the same on all levels, in the order of the mesh.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Level of the coefficient of each vertex: 1 for the finest details, one more than the number of levels for values
    /// of the coarsest level.
    pub fn levels(&self) -> &[u32] {
        &self.levels
    }

    /// Norm of the basis function of each coefficient. If the functions were orthogonal, a coefficient times its norm
    /// would be the error without this coefficient.
    pub fn norms(&self) -> &[f64] {
        &self.norms
    }

    /// Computes the coefficients of a field of `n_channels` values per vertex, row-major. O(n).
    ///
    /// # Errors
    /// [`SubdivisionError`] for a wrong number of values, a value that is not finite, and on cancellation.
    pub fn analyze(
        &self,
        values: &[f64],
        n_channels: usize,
        progress: Progress<'_>,
    ) -> Result<LiftedCoefficients, SubdivisionError> {
        check_field(values, self.n_vertices(), n_channels, "values of the vertices")?;
        let mut field = self.gather(values, n_channels);
        for step in &self.steps {
            step.analyze(&mut field, n_channels, progress)?;
        }
        let values = self.scatter(&field, n_channels);
        Ok(LiftedCoefficients { n_channels, values, levels: self.levels.clone(), norms: self.norms.clone() })
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
        check_field(coefficients, self.n_vertices(), n_channels, "coefficients")?;
        let mut field = self.gather(coefficients, n_channels);
        for step in self.steps.iter().rev() {
            step.synthesize(&mut field, n_channels, progress)?;
        }
        Ok(self.scatter(&field, n_channels))
    }

    /// Computes the field on a coarser level with the same mean, in the order of [`order`](Self::order); on level 0 the
    /// field itself.
    ///
    /// # Errors
    /// As for [`analyze`](Self::analyze), and [`SubdivisionError::Level`] for a level that does not exist.
    pub fn coarse_field(
        &self,
        values: &[f64],
        n_channels: usize,
        level: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, SubdivisionError> {
        self.check_level(level)?;
        check_field(values, self.n_vertices(), n_channels, "values of the vertices")?;
        if level == 0 {
            return Ok(values.to_vec());
        }
        let mut field = self.gather(values, n_channels);
        for step in &self.steps[..level] {
            step.analyze(&mut field, n_channels, progress)?;
        }
        field.truncate(self.n_vertices_at(level) * n_channels);
        Ok(field)
    }

    /// Computes the field on the mesh that a field on a coarser level represents: subdivision without details.
    ///
    /// # Errors
    /// As for [`synthesize`](Self::synthesize), and [`SubdivisionError::Level`] for a level that does not exist.
    pub fn fine_field(
        &self,
        coarse: &[f64],
        n_channels: usize,
        level: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, SubdivisionError> {
        self.check_level(level)?;
        check_field(coarse, self.n_vertices_at(level), n_channels, "values of the vertices of the level")?;
        if level == 0 {
            return Ok(coarse.to_vec());
        }
        let mut field = coarse.to_vec();
        field.resize(self.n_vertices() * n_channels, 0.0);
        for step in self.steps[..level].iter().rev() {
            step.synthesize(&mut field, n_channels, progress)?;
        }
        Ok(self.scatter(&field, n_channels))
    }

    /// Computes the field on the next finer level that a field on a coarser level represents, in the order of the
    /// vertices of that level: one step of subdivision without details.
    ///
    /// # Errors
    /// As for [`synthesize`](Self::synthesize), and [`SubdivisionError::Level`] for level 0 or one that does not exist.
    pub fn next_field(
        &self,
        coarse: &[f64],
        n_channels: usize,
        level: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, SubdivisionError> {
        self.check_level(level)?;
        let Some(finer) = level.checked_sub(1) else {
            return Err(SubdivisionError::Level { level, n_levels: self.n_levels() });
        };
        check_field(coarse, self.n_vertices_at(level), n_channels, "values of the vertices of the level")?;
        let mut field = coarse.to_vec();
        field.resize(self.n_vertices_at(finer) * n_channels, 0.0);
        self.steps[finer].synthesize(&mut field, n_channels, progress)?;
        Ok(if finer == 0 { self.scatter(&field, n_channels) } else { field })
    }

    fn check_level(&self, level: usize) -> Result<(), SubdivisionError> {
        if level > self.n_levels() {
            return Err(SubdivisionError::Level { level, n_levels: self.n_levels() });
        }
        Ok(())
    }

    /// Sorts values of the mesh into the order of the levels, `d` channels each.
    fn gather(&self, values: &[f64], d: usize) -> Vec<f64> {
        if d == 1 {
            return self.order.iter().map(|&v| values[v as usize]).collect();
        }
        self.order.iter().flat_map(|&v| values[v as usize * d..][..d].iter().copied()).collect()
    }

    /// Sorts values of the levels into the order of the mesh, `d` channels each.
    fn scatter(&self, field: &[f64], d: usize) -> Vec<f64> {
        let mut values = vec![0.0; field.len()];
        for (&v, row) in self.order.iter().zip(field.chunks_exact(d)) {
            values[v as usize * d..][..d].copy_from_slice(row);
        }
        values
    }
}

impl LiftingStep {
    fn analyze(&self, field: &mut [f64], d: usize, progress: Progress<'_>) -> Result<(), Cancelled> {
        let (coarse, details) = field[..self.n_fine * d].split_at_mut(self.n_coarse * d);
        if let Some(rule) = &self.even {
            rule.solve(coarse, d, progress)?;
        }
        self.prediction.add_product(-1.0, coarse, details, d, progress)?;
        add_product(&self.update, 1.0, details, coarse, d, progress)
    }

    fn synthesize(&self, field: &mut [f64], d: usize, progress: Progress<'_>) -> Result<(), Cancelled> {
        let (coarse, details) = field[..self.n_fine * d].split_at_mut(self.n_coarse * d);
        add_product(&self.update, -1.0, details, coarse, d, progress)?;
        self.prediction.add_product(1.0, coarse, details, d, progress)?;
        if let Some(rule) = &self.even {
            let moved = rule.apply(coarse, d, progress)?;
            coarse.copy_from_slice(&moved);
        }
        Ok(())
    }
}

/// Checks masses, raises them to a least value, and scales their sum to 1; the results are equal if all masses are 0.
pub(crate) fn usable_masses(
    masses: &[f64],
    expected: usize,
    what: &'static str,
) -> Result<Vec<f64>, SubdivisionError> {
    if masses.len() != expected {
        return Err(SubdivisionError::WrongNumber { what, n_given: masses.len(), expected });
    }
    if let Some((element, &value)) = masses.iter().enumerate().find(|(_, m)| !m.is_finite()) {
        return Err(SubdivisionError::NotFinite { what: "areas", element, value });
    }
    if let Some((element, &value)) = masses.iter().enumerate().find(|(_, m)| **m < 0.0) {
        return Err(SubdivisionError::NegativeMass { element, value });
    }
    // Divided by the greatest first: areas of huge or tiny shapes must not overflow in squares.
    let greatest = masses.iter().copied().fold(0.0, f64::max);
    if greatest == 0.0 {
        return Ok(vec![1.0 / expected.max(1) as f64; expected]);
    }
    let relative: Vec<f64> = masses.iter().map(|m| m / greatest).collect();
    let least = LEAST_MASS * relative.iter().sum::<f64>() / expected as f64;
    let total: f64 = relative.iter().map(|m| m.max(least)).sum();
    Ok(relative.into_iter().map(|m| m.max(least) / total).collect())
}

/// Checks the number of values and that they are finite.
pub(crate) fn check_field(
    values: &[f64],
    n_elements: usize,
    n_channels: usize,
    what: &'static str,
) -> Result<(), SubdivisionError> {
    if n_channels == 0 {
        return Err(SubdivisionError::WrongNumber { what: "channels or more", n_given: 0, expected: 1 });
    }
    let expected = n_elements * n_channels;
    if values.len() != expected {
        return Err(SubdivisionError::WrongNumber { what, n_given: values.len(), expected });
    }
    if let Some((i, &value)) = values.iter().enumerate().find(|(_, v)| !v.is_finite()) {
        return Err(SubdivisionError::NotFinite { what, element: i / n_channels, value });
    }
    Ok(())
}
