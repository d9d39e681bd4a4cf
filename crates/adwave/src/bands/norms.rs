//! Norms or normal components of the wavelet coefficients, without storing all channels of all levels.

use super::chebyshev::{EvaluationInfo, PassPlan, Polynomials};
use super::error::check_signal;
use super::real_series::LADDER;
use super::series::Series;
use super::wavelets::RowMeasure;
use super::{BandsError, Engine, Precision, Schedule, Transform, Wavelets};
use crate::operator::{BlockPrecision, RowOutput};
use crate::pages::zeros;
use crate::sparse::SignalView;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Total size of the wavelets in bytes below which computing them in two calls saves nothing.
const LARGE: usize = 64 << 20;

impl Transform {
    /// [`Wavelets::into_norms`] or [`Wavelets::into_along`] for a signal at the welded vertices, with the same
    /// bits.
    ///
    /// For a large signal the coarse levels are computed first and reduced to one channel, then the fine levels. This
    /// takes three fifths of the memory, and repeats only the few products that fine levels need.
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    pub(crate) fn measure_mean(
        &self,
        mean: &[f64],
        n_channels: usize,
        measure: RowMeasure<'_>,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Wavelets, BandsError> {
        if n_channels > 1
            && schedule.n_levels() * size_of_val(mean) >= LARGE
            && let Some(found) = self.compute_in_two_calls(mean, n_channels, measure, schedule, progress)?
        {
            return Ok(found);
        }
        let wavelets = self.decompose_mean(mean, n_channels, schedule, progress)?;
        Ok(match measure {
            RowMeasure::Norm => wavelets.into_norms(),
            RowMeasure::Along(normals) => wavelets.into_along(normals),
        })
    }

    /// Measures the coarse and the fine levels in two calls; `None` if the bits could differ from those of one call.
    fn compute_in_two_calls(
        &self,
        mean: &[f64],
        n_channels: usize,
        measure: RowMeasure<'_>,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Option<Wavelets>, BandsError> {
        if self.engine() != Engine::Chebyshev || schedule.first_real().is_some() || self.is_staged(schedule) {
            return Ok(None);
        }
        let (n, n_levels) = (self.operator().n_rows(), schedule.n_levels());
        check_signal(mean, n, n_channels)?;
        self.check_memory_of_wavelets(n_channels, schedule)?;
        self.check_precision(schedule, progress)?;
        let prepared = self.evaluator(progress)?;
        let steps = schedule.steps_from_zero();
        // Series of whole steps are the same on every grid.
        let band = |level: usize| self.band(&steps[level..level + 2], LADDER[0], prepared.growth);
        let series: Vec<Series> = parallel::map_items(n, n_levels, band);
        // The first call alone cannot tell if single precision keeps to the accuracy on all levels.
        let (signal, accuracy) = (SignalView { values: mean, n_channels }, self.params().accuracy);
        let precision = match self.params().precision {
            Precision::Auto => match prepared.format_for(&series, Precision::Auto, accuracy, progress)? {
                BlockPrecision::Single => return Ok(None),
                BlockPrecision::Double => Precision::Double,
            },
            asked => asked,
        };
        let mut passes = PassPlan::default();
        let call = |range: Range<usize>,
                    passes: &mut PassPlan|
         -> Result<(Vec<Vec<f64>>, EvaluationInfo), Cancelled> {
            let mut levels: Vec<Vec<f64>> = range.clone().map(|_| zeros(mean.len())).collect();
            let mut outs: Vec<&mut [f64]> = levels.iter_mut().map(Vec::as_mut_slice).collect();
            let output = RowOutput::Channels;
            let polynomials = Polynomials { series: &series[range], guard: &[], passes, output, precision };
            let outcome = prepared.evaluate(signal, polynomials, accuracy, &mut outs, progress)?;
            for level in &mut levels {
                *level = measure.measure_rows(level, n_channels);
            }
            Ok((levels, outcome))
        };
        // Two fifths: if a level has three channels, both calls then need about the same memory.
        let n_fine = 2 * n_levels / 5;
        let (coarse, first) = call(n_fine..n_levels, &mut passes)?;
        passes.repeat();
        let (mut levels, second) = call(0..n_fine, &mut passes)?;
        if passes.differ() {
            return Ok(None);
        }
        levels.extend(coarse);
        let mut outcome = first;
        outcome.add(&second);
        self.check_rounding(&outcome)?;
        let (sigma, info) = (schedule.sigma(self.operator().step_length()), self.info(&outcome, n_channels));
        Ok(Some(Wavelets { n_channels: 1, steps, sigma, levels, info }))
    }

    /// [`Wavelets::into_along`] for a signal of three channels, up to rounding. The component along the normals is
    /// taken from the vectors of the recurrence, so no band has three channels. The accuracy refers to these
    /// components.
    ///
    /// `None` if the engine is [`Engine::Powers`] or a level has fractional steps.
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    pub(crate) fn normal_components_in_one_pass(
        &self,
        mean: &[f64],
        normals: &[[f64; 3]],
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<Option<Wavelets>, BandsError> {
        if self.engine() != Engine::Chebyshev || schedule.first_real().is_some() || self.is_staged(schedule) {
            return Ok(None);
        }
        let (n, n_levels) = (self.operator().n_rows(), schedule.n_levels());
        check_signal(mean, n, 3)?;
        self.check_memory_of_wavelets(3, schedule)?;
        self.check_precision(schedule, progress)?;
        let prepared = self.evaluator(progress)?;
        let steps = schedule.steps_from_zero();
        let band = |level: usize| self.band(&steps[level..level + 2], LADDER[0], prepared.growth);
        let series: Vec<Series> = parallel::map_items(n, n_levels, band);
        let mut levels: Vec<Vec<f64>> = series.iter().map(|_| zeros(n)).collect();
        let mut outs: Vec<&mut [f64]> = levels.iter_mut().map(Vec::as_mut_slice).collect();
        let (passes, output) = (&mut PassPlan::default(), RowOutput::AlongNormals(normals));
        let polynomials =
            Polynomials { series: &series, guard: &[], passes, output, precision: self.params().precision };
        let (signal, accuracy) = (SignalView { values: mean, n_channels: 3 }, self.params().accuracy);
        let outcome = prepared.evaluate(signal, polynomials, accuracy, &mut outs, progress)?;
        self.check_rounding(&outcome)?;
        let (sigma, info) = (schedule.sigma(self.operator().step_length()), self.info(&outcome, 3));
        Ok(Some(Wavelets { n_channels: 1, steps, sigma, levels, info }))
    }
}

#[cfg(test)]
mod tests {
    use crate::bands::wavelets::RowMeasure;
    use crate::bands::{Precision, Schedule, Transform};
    use crate::sample::Sample;
    use crate::shape::{Mesh, Shape};
    use crate::{Decomposer, Progress};

    fn creature() -> (Decomposer, Vec<f64>) {
        let sample = Sample::from_name("creature", Some(6000)).expect("a built-in shape");
        let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).expect("a mesh"));
        let decomposer = Decomposer::new(&shape);
        let mean = decomposer.positions().as_flattened().to_vec();
        (decomposer, mean)
    }

    #[test]
    fn two_calls_give_the_bits_of_one() {
        let (decomposer, mean) = creature();
        let none = Progress::none();
        let mut n_compared = 0;
        for accuracy in [1e-3, 1e-9] {
            let params = decomposer.transform().params().with_accuracy(accuracy);
            let params = params.with_precision(Precision::Double);
            let transform: Transform = decomposer.transform().with_params(&params).expect("an accuracy");
            for (n_levels, n_channels) in [(3, 3), (6, 3), (9, 3), (12, 3), (8, 2), (8, 6)] {
                // Blocks of one, two and three channels, and more than one block.
                let n = mean.len() / 3;
                let signal: Vec<f64> =
                    (0..n * n_channels).map(|i| mean[i % mean.len()] + (i % n_channels) as f64).collect();
                let schedule = Schedule::dyadic(n_levels).expect("levels");
                let one = transform.decompose_mean(&signal, n_channels, &schedule, none);
                let one = one.expect("a signal").into_norms();
                let two =
                    transform.compute_in_two_calls(&signal, n_channels, RowMeasure::Norm, &schedule, none);
                let Some(two) = two.expect("a signal") else { continue };
                assert!(one.levels == two.levels, "{n_levels} levels of {n_channels} channels");
                assert_eq!((one.steps, one.sigma), (two.steps, two.sigma));
                assert_eq!(one.info.error_bound, two.info.error_bound);
                n_compared += 1;
            }
        }
        assert!(n_compared > 6, "{n_compared} of 12 in two calls");
    }

    #[test]
    fn parts_along_normals_at_once_are_those_of_the_bands() {
        let (decomposer, mean) = creature();
        let none = Progress::none();
        let normals: Vec<[f64; 3]> =
            mean.as_chunks().0.iter().map(|p| crate::vector::unit(p).expect("no vertex at 0")).collect();
        for (n_levels, accuracy) in [(1, 1e-3), (5, 1e-3), (8, 1e-10), (11, 1e-6)] {
            let schedule = Schedule::dyadic(n_levels).expect("levels");
            let transform = decomposer.transform();
            let exact = transform.decompose_mean(&mean, 3, &schedule, none);
            let exact = exact.expect("a signal").into_along(&normals);
            let transform = transform.with_params(&transform.params().with_accuracy(accuracy));
            let found = transform
                .expect("an accuracy")
                .normal_components_in_one_pass(&mean, &normals, &schedule, none);
            let found = found.expect("a signal").expect("no powers");
            assert_eq!((&found.steps, &found.sigma), (&exact.steps, &exact.sigma));
            assert!(found.info.error_bound <= accuracy, "{:?}", found.info);
            for (found, exact) in found.levels.iter().zip(&exact.levels) {
                let mu = decomposer.rows("the test").expect("a stored walk").stationary();
                let square = |value: &dyn Fn(usize) -> f64| -> f64 {
                    (0..mu.len()).map(|x| mu[x] * value(x) * value(x)).sum()
                };
                let (off, all) = (square(&|x| found[x] - exact[x]), square(&|x| exact[x]));
                assert!(off.sqrt() <= (accuracy + 1e-10) * all.sqrt(), "{n_levels}: {off:e} of {all:e}");
            }
        }
    }

    #[test]
    fn measures_in_single_precision_keep_to_their_bound() {
        let (decomposer, mean) = creature();
        let none = Progress::none();
        let normals: Vec<[f64; 3]> =
            mean.as_chunks().0.iter().map(|p| crate::vector::unit(p).expect("no vertex at 0")).collect();
        let schedule = Schedule::dyadic(7).expect("levels");
        let exact = decomposer.transform().decompose_mean(&mean, 3, &schedule, none).expect("a signal");
        let params = decomposer.transform().params().with_accuracy(1e-4).with_precision(Precision::Single);
        let single = decomposer.transform().with_params(&params).expect("an accuracy");
        let along = single.normal_components_in_one_pass(&mean, &normals, &schedule, none);
        let norms = single.compute_in_two_calls(&mean, 3, RowMeasure::Norm, &schedule, none);
        let one = single.decompose_mean(&mean, 3, &schedule, none).expect("a signal").into_norms();
        if let Some(two) = norms.as_ref().expect("a signal") {
            assert!(two.levels == one.levels, "two calls give the bits of one");
        }
        let cases = [
            (along.expect("a signal").expect("no powers"), exact.clone().into_along(&normals)),
            (one, exact.into_norms()),
        ];
        let mu = decomposer.rows("the test").expect("a stored walk").stationary();
        let norm = |value: &dyn Fn(usize) -> f64| -> f64 {
            (0..mu.len()).map(|x| mu[x] * value(x) * value(x)).sum::<f64>().sqrt()
        };
        for (found, exact) in cases {
            let bound = found.info.error_bound;
            assert!(found.info.precision == Precision::Single && bound < 0.1, "{:?}", found.info);
            for (found, exact) in found.levels.iter().zip(&exact.levels) {
                let error = norm(&|x| found[x] - exact[x]) / norm(&|x| exact[x]);
                assert!(error > 1e-9 && error <= bound, "{error:e} with a bound of {bound:e}");
            }
        }
    }

    #[test]
    fn fractional_powers_are_left_to_a_single_call() {
        let (decomposer, mean) = creature();
        let schedule = Schedule::voices(3, 2).expect("levels");
        let transform = decomposer.transform();
        let two = transform
            .compute_in_two_calls(&mean, 3, RowMeasure::Norm, &schedule, Progress::none())
            .expect("a signal");
        assert!(two.is_none());
        let norms = transform
            .measure_mean(&mean, 3, RowMeasure::Norm, &schedule, Progress::none())
            .expect("a signal");
        let one = transform.decompose_mean(&mean, 3, &schedule, Progress::none()).expect("a signal");
        assert!(norms.levels == one.into_norms().levels);
    }
}
