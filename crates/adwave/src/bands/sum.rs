//! Sum of one band of each of several signals, by one recurrence: the adjoint of the bands.
//!
//! In the inner product of the stationary distribution π every band is self-adjoint, so the adjoint of
//! `f ↦ (W_f(1), …, W_f(J))` is `(h_1, …, h_J) ↦ Σ_j W_{h_j}(j)`. With `W_h(j) = (I − Φ₁)·Σ_k a_{jk} T_k(Y) h`,
//! `Y = 2Φ₁ − I`, this is `(I − Φ₁)·Σ_k T_k(Y) u_k` with `u_k = Σ_j a_{jk} h_j`, which the recurrence of
//! `clenshaw1955` sums from the highest term down: `b_k = u_k + 2Y b_{k+1} − b_{k+2}`, and the sum is
//! `u_0 + Y b_1 − b_2`.

use super::error::{check_buffer, check_signal};
use super::real_series::LADDER;
use super::series::Series;
use super::transform::add;
use super::{BandsError, Schedule, Transform};
use crate::operator::{BlockPrecision, Semigroup};
use crate::pages::zeros;
use crate::parallel;
use crate::shape::VertexMap;
use crate::sparse::{ClenshawTerm, SignalView, block_width, is_wide, wide_clenshaw};
use crate::{Cancelled, Progress};

/// Remainder of a series, relative to the sum of its terms, below which further terms are omitted.
const REMAINDER: f64 = 1e-15;

impl Transform {
    /// True if [`sum_of_bands`](Self::sum_of_bands) applies: the diffusion is reversible, the steps are whole or those
    /// of heat, and few enough that one recurrence is accurate.
    pub fn has_sum_of_bands(&self, schedule: &Schedule) -> bool {
        let is_heat = matches!(self.operator().semigroup(), Semigroup::Heat { .. });
        self.operator().is_reversible()
            && (is_heat || schedule.first_real().is_none())
            && !self.is_staged(schedule)
    }

    /// Computes `Σ_j W_{h_j}(j)` for one signal h_j of each level (n_vertices × n_channels, in the order of the shape,
    /// one after the other in `signals`), n_vertices × n_channels. It costs the products of the coarsest band, and
    /// is accurate to rounding.
    ///
    /// As in [`bands`](Self::bands), the difference of h_1 from its mean over welded vertices is part of the sum.
    ///
    /// # Errors
    /// [`BandsError`] if the signals have the wrong length or a value that is not finite, the operator or the levels
    /// have no such sum ([`has_sum_of_bands`](Self::has_sum_of_bands)), or the call is cancelled.
    ///
    /// ```
    /// use adwave::bands::{BandsParams, Schedule, Transform};
    /// use adwave::operator::{Diffusion, OperatorParams, local_operator};
    /// use adwave::shape::{Graph, PreparedGeometry, Shape, VertexMap, WeldMode};
    /// use adwave::Progress;
    /// let shape = Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?);
    /// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
    /// let operator = local_operator(&geometry, &OperatorParams::default(), Progress::none())?;
    /// let diffusion = Diffusion::new(operator, Progress::none())?; // one step takes the mean of both
    /// let transform = Transform::new(diffusion, &BandsParams::default())?;
    /// let (map, schedule) = (VertexMap::identity(2), Schedule::dyadic(2)?);
    /// let sum = transform.sum_of_bands(&map, &[1.0, 3.0, 5.0, 5.0], 1, &schedule, Progress::none())?;
    /// assert!((sum[0] + 1.0).abs() < 1e-12 && (sum[1] - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sum_of_bands(
        &self,
        vertex_map: &VertexMap,
        signals: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, BandsError> {
        let (n, n_levels) = (vertex_map.n_vertices(), schedule.n_levels());
        let len = n * n_channels;
        check_buffer(signals.len(), n_levels * len)?;
        if !self.has_sum_of_bands(schedule) {
            let level = schedule.first_real().unwrap_or(n_levels);
            return Err(BandsError::NotWhole { level, steps: schedule.steps()[level - 1] });
        }
        let mut means = Vec::with_capacity(n_levels);
        for signal in signals.chunks_exact(len.max(1)) {
            check_signal(signal, n, n_channels)?;
            means.push(vertex_map.mean(signal, n_channels));
        }
        let steps = schedule.steps_from_zero();
        let growth = self.evaluator(progress)?.growth;
        let series: Vec<Series> =
            parallel::map_items(n, n_levels, |level| self.band(&steps[level..level + 2], LADDER[0], growth));
        let sum = self.clenshaw(&series, &means, n_channels, progress)?;
        let mut sum = vertex_map.scatter(&sum, n_channels);
        if vertex_map.n_welded() < n {
            let mean = vertex_map.scatter(&means[0], n_channels);
            sum.iter_mut().zip(signals).zip(&mean).for_each(|((s, h), m)| *s += h - m);
        }
        Ok(sum)
    }

    /// Gradient of a function of all bands with respect to the signal, n_vertices × n_channels, from its gradients with
    /// respect to W_f(1) … W_f(J) and S_f(J) ((J + 1)·n_vertices·n_channels values, as in [`Bands`](super::Bands), in
    /// the order of the shape). The inner product is the plain sum over vertices and channels.
    ///
    /// With the share `s(x) = π(x)/m(x)` of each of the m(x) vertices that are welded to x and the gradients ḡ_j, it is
    /// `ḡ_{J+1} + s·Σ_j W_{h_j}(j)`, `h_j = (ḡ_j − ḡ_{J+1})/s`. All bands take one recurrence where
    /// [`has_sum_of_bands`](Self::has_sum_of_bands) is true, else one for each level.
    ///
    /// # Errors
    /// [`BandsError`] if the gradients have the wrong length or a value that is not finite, the operator is not
    /// reversible or leaves vertices without area, or the call is cancelled.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::shape::{Graph, Shape};
    /// use adwave::{Decomposer, Progress};
    /// let pair = Decomposer::new(&Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?));
    /// let map = pair.vertex_map();
    /// // W_f(1) of the first vertex is (f_0 − f_1)/2.
    /// let schedule = Schedule::dyadic(1)?;
    /// let gradient =
    ///     pair.transform().gradient_of_bands(map, &[1.0, 0.0, 0.0, 0.0], 1, &schedule, Progress::none())?;
    /// assert!((gradient[0] - 0.5).abs() < 1e-12 && (gradient[1] + 0.5).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn gradient_of_bands(
        &self,
        vertex_map: &VertexMap,
        gradients: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, BandsError> {
        let (n, n_levels) = (vertex_map.n_vertices(), schedule.n_levels());
        let len = n * n_channels;
        check_buffer(gradients.len(), (n_levels + 1) * len)?;
        check_signal(gradients, (n_levels + 1) * n, n_channels)?;
        let share = self.share_of_each_vertex(vertex_map)?;
        let (finer, rest) = gradients.split_at(n_levels * len);
        let mut scaled: Vec<f64> = zeros(finer.len());
        for (scaled, gradient) in scaled.chunks_exact_mut(len).zip(finer.chunks_exact(len)) {
            parallel::visit_rows(scaled, n_channels, super::bands::VERTICES_AT_A_TIME, |first, scaled| {
                for (i, h) in (first * n_channels..).zip(scaled) {
                    *h = (gradient[i] - rest[i]) / share[i / n_channels];
                }
            });
        }
        let sum = if self.has_sum_of_bands(schedule) {
            self.sum_of_bands(vertex_map, &scaled, n_channels, schedule, progress)?
        } else {
            let mut sum: Vec<f64> = zeros(len);
            for (level, signal) in scaled.chunks_exact(len).enumerate() {
                let factors: Vec<f64> = (0..n_levels).map(|j| f64::from(u8::from(j == level))).collect();
                let (band, _) =
                    self.weighted(vertex_map, signal, n_channels, schedule, &factors, progress)?;
                add(1.0, &band, &mut sum, n_channels);
            }
            sum
        };
        let mut gradient = rest.to_vec();
        parallel::visit_rows(&mut gradient, n_channels, super::bands::VERTICES_AT_A_TIME, |first, rows| {
            for (i, gradient) in (first * n_channels..).zip(rows) {
                *gradient += share[i / n_channels] * sum[i];
            }
        });
        Ok(gradient)
    }

    /// Share of each vertex in the stationary distribution.
    fn share_of_each_vertex(&self, vertex_map: &VertexMap) -> Result<Vec<f64>, BandsError> {
        let operator = self.operator();
        if !operator.is_reversible() {
            return Err(BandsError::NoAdjoint { reason: "the operator is not reversible" });
        }
        let (weights, n) = (operator.weights(), operator.n_rows());
        let weight = |x: usize| weights.weight(x, n);
        let mut n_members = vec![0_u32; vertex_map.n_welded()];
        for &x in vertex_map.as_slice() {
            n_members[x as usize] += 1;
        }
        let is_alone = |x: usize| operator.rows().is_some_and(|rows| rows.row(x).0.is_empty());
        if (0..n).any(|x| weight(x) <= 0.0 && !is_alone(x)) {
            return Err(BandsError::NoAdjoint { reason: "the walk leaves vertices without area for ever" });
        }
        let share = |&x: &u32| {
            // A vertex without neighbors has bands 0 whatever its share, except for the difference of its members from
            // their mean, which is self-adjoint for equal shares.
            let whole = if is_alone(x as usize) { 1.0 } else { weight(x as usize) };
            whole / f64::from(n_members[x as usize])
        };
        Ok(vertex_map.as_slice().iter().map(share).collect())
    }

    /// `(I − Φ₁)·Σ_k T_k(2Φ₁ − I) u_k` with `u_k = Σ_j series[j]_k·signals[j]`.
    fn clenshaw(
        &self,
        series: &[Series],
        signals: &[Vec<f64>],
        n_channels: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let len = signals.first().map_or(0, Vec::len);
        let degrees: Vec<usize> = series.iter().map(|s| s.degree_within(REMAINDER * s.total, 0)).collect();
        if let Some(diffusion) = self.operator().rows().filter(|_| is_wide(n_channels)) {
            let terms: Vec<ClenshawTerm<'_>> = (0..series.len())
                .map(|j| ClenshawTerm {
                    signal: SignalView { values: &signals[j], n_channels },
                    coefficients: &series[j].coefficients[..=degrees[j]],
                })
                .collect();
            let mut sum: Vec<f64> = zeros(len);
            let mut at = 0;
            while at < n_channels {
                let width = block_width(n_channels, n_channels - at, BlockPrecision::Double);
                wide_clenshaw(diffusion, &terms, at..at + width, &mut sum, progress)?;
                at += width;
            }
            return Ok(sum);
        }
        let highest = degrees.iter().copied().max().unwrap_or(0);
        let (mut b1, mut b2, mut product): (Vec<f64>, Vec<f64>, Vec<f64>) =
            (zeros(len), zeros(len), zeros(len));
        for k in (0..=highest).rev() {
            progress.step((highest - k) as u64, highest as u64 + 1)?;
            self.operator().multiply(&b1, n_channels, &mut product, progress)?;
            // Y b = 2Φ₁b − b, once for the last term and twice for the others.
            let factor = if k == 0 { 1.0 } else { 2.0 };
            let terms: Vec<(f64, &[f64])> = (0..series.len())
                .filter(|&j| k <= degrees[j])
                .map(|j| (series[j].coefficients[k], &signals[j][..]))
                .collect();
            parallel::visit_rows(&mut b2, n_channels, super::bands::VERTICES_AT_A_TIME, |first, b2| {
                let at = first * n_channels;
                for (i, b2) in b2.iter_mut().enumerate() {
                    let u: f64 = terms.iter().map(|(a, h)| a * h[at + i]).sum();
                    *b2 = u + factor * (2.0 * product[at + i] - b1[at + i]) - *b2;
                }
            });
            std::mem::swap(&mut b1, &mut b2);
        }
        self.operator().multiply(&b1, n_channels, &mut product, progress)?;
        add(-1.0, &product, &mut b1, n_channels);
        Ok(b1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Decomposer;
    use crate::operator::{OperatorKind, OperatorParams};
    use crate::sample::Sample;
    use crate::shape::{Graph, Mesh, PointCloud, Shape};

    /// Default relative accuracy of bands, with a margin.
    const ACCURATE: f64 = 1e-9;

    #[test]
    fn the_sum_is_that_of_the_bands_of_each_signal() {
        let edges: Vec<(u32, u32, f64)> = (0..40_u32)
            .flat_map(|i| [(i, (i + 1) % 41, 1.0 + f64::from(i % 3)), (i, (i * 7 + 3) % 41, 0.5)])
            .filter(|(a, b, _)| a != b)
            .collect();
        let shape = Shape::Graph(Graph::new(41, &edges).unwrap());
        let (n_channels, schedule) = (2, Schedule::new(vec![1, 3, 10, 40]).unwrap());
        let len = 41 * n_channels;
        let signals: Vec<f64> = (0..4 * len).map(|i| (i as f64 * 0.7).sin() + (i % 5) as f64).collect();
        for kind in [OperatorKind::Walk, OperatorKind::Surface] {
            let params = OperatorParams::default().with_kind(kind);
            let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
            let (map, transform) = (decomposer.vertex_map(), decomposer.transform());
            let sum = transform.sum_of_bands(map, &signals, n_channels, &schedule, Progress::none()).unwrap();
            let mut expected = vec![0.0; len];
            for (level, signal) in signals.chunks_exact(len).enumerate() {
                let bands = transform.bands(map, signal, n_channels, &schedule, Progress::none()).unwrap();
                let band = bands.wavelets().nth(level).unwrap();
                expected.iter_mut().zip(band).for_each(|(e, w)| *e += w);
            }
            let scale = expected.iter().fold(0.0_f64, |most, e| most.max(e.abs()));
            for (found, expected) in sum.iter().zip(&expected) {
                assert!((found - expected).abs() <= ACCURATE * scale, "{kind:?}: {found} for {expected}");
            }
            assert!(scale > 0.1);
        }
    }

    /// Values between −1 and 1.
    fn noise(len: usize, seed: u32) -> Vec<f64> {
        (0..len as u32)
            .map(|i| f64::from(i.wrapping_mul(2_654_435_761) ^ seed) / 2_f64.powi(31) - 1.0)
            .collect()
    }

    #[test]
    fn the_gradient_is_the_adjoint_of_the_bands() {
        let sphere = Sample::from_name("sphere", Some(60)).unwrap();
        // Some vertices twice, so that they are welded.
        let points = [&sphere.points[..], &sphere.points[..7]].concat();
        let doubled = Shape::Cloud(PointCloud::new(points).unwrap());
        let whole = Schedule::new(vec![1, 2, 7]).unwrap();
        let fractional = Schedule::real(vec![0.5, 1.5, 7.0]).unwrap();
        let sphere = Shape::Mesh(Mesh::new(sphere.points, sphere.faces).unwrap());
        let cases = [
            (&sphere, OperatorKind::Walk, &whole),
            (&sphere, OperatorKind::Surface, &fractional),
            (&sphere, OperatorKind::Walk, &fractional),
            (&doubled, OperatorKind::Walk, &whole),
        ];
        for ((shape, kind, schedule), n_channels) in
            cases.into_iter().flat_map(|case| [1, 2, 16, 37].map(|n_channels| (case, n_channels)))
        {
            let params = OperatorParams::default().with_kind(kind);
            let decomposer = Decomposer::with_params(shape, &params, Progress::none()).unwrap();
            let (map, transform) = (decomposer.vertex_map(), decomposer.transform());
            let len = map.n_vertices() * n_channels;
            let (signal, gradients) = (noise(len, 1), noise(4 * len, 77));
            let bands = transform.bands(map, &signal, n_channels, schedule, Progress::none()).unwrap();
            let gradient =
                transform.gradient_of_bands(map, &gradients, n_channels, schedule, Progress::none()).unwrap();
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let (forward, backward) = (product(bands.as_slice(), &gradients), product(&signal, &gradient));
            let size = product(&gradients, &gradients).sqrt() * product(&signal, &signal).sqrt();
            assert!(
                (forward - backward).abs() <= ACCURATE * size,
                "{kind:?}, {n_channels} channels: {forward} and {backward}"
            );
            let of_gains = bands.gradient_of_gains(&gradients[..len]).unwrap();
            for (level, found) in of_gains.into_iter().enumerate() {
                let expected = product(bands.wavelet(level + 1), &gradients[..len]);
                assert!((found - expected).abs() <= 1e-12 * size, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn fractional_steps_of_a_walk_are_refused() {
        let shape = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)]).unwrap());
        let decomposer = Decomposer::new(&shape);
        let schedule = Schedule::real(vec![0.5]).unwrap();
        let map = decomposer.vertex_map();
        let found =
            decomposer.transform().sum_of_bands(map, &[1.0, 2.0, 3.0], 1, &schedule, Progress::none());
        assert!(matches!(found, Err(BandsError::NotWhole { level: 1, .. })), "{found:?}");
    }
}
