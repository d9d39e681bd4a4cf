//! Requests for the bands of a signal, in the form that the caller needs.

use super::Decomposer;
use crate::Progress;
use crate::bands::{
    Bands, BandsError, BandsInfo, BandsParams, Precision, RowMeasure, Schedule, Transform, Wavelets,
    check_buffer, check_factors, check_signal,
};
use crate::filter::{Edit, FilterError, FilterInput, LayerSlot, WeightedLayer};
use crate::local_fit::{LinearTransform, LocalFit};
use crate::mask::Mask;
use crate::pages::zeros;
use crate::parallel;
use crate::region::RegionWeights;
use crate::shape::Shape;
use std::borrow::Cow;

/// A request for the bands of a signal: options first, then the call that selects the result.
///
/// | last call | result | order | memory beyond the prepared shape, values |
/// |---|---|---|---|
/// | [`bands`](Self::bands) | W_f(1..J) and S_f(J) | the shape's | (J + 1)·n·d |
/// | [`bands_into`](Self::bands_into) | the same, into the caller's buffer | the shape's | n·d |
/// | [`visit_bands`](Self::visit_bands) | the same, one after another | the shape's | 3·n·d on images and volumes |
/// | [`wavelets`](Self::wavelets) | W_f(1..J) | analysis | J·n·d |
/// | [`norms`](Self::norms) | ‖W_f(1..J)‖ over the channels | analysis | J·n·d, then J·n; less for large signals |
/// | [`normal_components`](Self::normal_components) | W_f(1..J)·n, along the normals | analysis | as for norms |
/// | [`normal_components_in_one_pass`](Self::normal_components_in_one_pass) | the same up to rounding | analysis | J·n |
/// | [`weighted`](Self::weighted) | Σ_j a_j·W_f(j) by one polynomial | the shape's | 2·n·d |
/// | [`filter`](Self::filter), [`filter_layers`](Self::filter_layers) | the edited signal (eq. 18), once | the shape's | 2·n·d for one layer |
/// | [`editor`](Self::editor) | an [`Editor`](crate::Editor) that keeps the bands | both | (J + 3)·n·d |
#[derive(Clone, Copy, Debug)]
pub struct BandsRequest<'a> {
    decomposer: &'a Decomposer,
    signal: &'a [f64],
    n_channels: usize,
    schedule: &'a Schedule,
    params: BandsParams,
    local_fit: LocalFit,
    progress: Progress<'a>,
}

impl<'a> BandsRequest<'a> {
    pub(super) fn new(
        decomposer: &'a Decomposer,
        signal: &'a [f64],
        n_channels: usize,
        schedule: &'a Schedule,
    ) -> Self {
        let (params, local_fit, progress) = (BandsParams::default(), LocalFit::Constant, Progress::none());
        Self { decomposer, signal, n_channels, schedule, params, local_fit, progress }
    }

    /// Sets the accuracy, the method and the memory limit.
    #[must_use]
    pub fn params(self, params: &BandsParams) -> Self {
        Self { params: *params, ..self }
    }

    /// Sets the largest relative error of each band.
    #[must_use]
    pub fn accuracy(self, accuracy: f64) -> Self {
        Self { params: self.params.with_accuracy(accuracy), ..self }
    }

    /// Sets the fields that smoothing leaves unchanged: [`LocalFit::Linear`] keeps slopes. Each channel is treated by
    /// itself, as a field over the surface, or over the plane of the two other coordinates if it is a coordinate of
    /// the shape. It takes two to four times the products. On a shape without positions nothing changes.
    ///
    /// The default is [`LocalFit::Constant`], the bands of the diffusion operator itself (eq. 11).
    #[must_use]
    pub fn local_fit(self, local_fit: LocalFit) -> Self {
        Self { local_fit, ..self }
    }

    /// Sets the progress report and the cancellation.
    #[must_use]
    pub fn progress(self, progress: Progress<'a>) -> Self {
        Self { progress, ..self }
    }

    /// Copies the request for another signal.
    pub(crate) fn with_signal<'s>(&self, signal: &'s [f64], n_channels: usize) -> BandsRequest<'s>
    where
        'a: 's,
    {
        BandsRequest { signal, n_channels, ..*self }
    }

    /// Reports of the progress.
    pub(crate) fn reports(&self) -> Progress<'a> {
        self.progress
    }

    /// Parameters of the bands.
    pub(crate) fn bands_params(&self) -> &BandsParams {
        &self.params
    }

    fn transform(&self) -> Result<Transform, BandsError> {
        self.decomposer.transform.with_params(&self.params)
    }

    pub(crate) fn decomposer(&self) -> &'a Decomposer {
        self.decomposer
    }

    pub(crate) fn signal(&self) -> &'a [f64] {
        self.signal
    }

    pub(crate) fn schedule(&self) -> &'a Schedule {
        self.schedule
    }

    pub(crate) fn n_channels(&self) -> usize {
        self.n_channels
    }

    pub(crate) fn vertex_map(&self) -> &'a crate::shape::VertexMap {
        self.decomposer.vertex_map()
    }

    /// The signal with a value at every vertex.
    pub(crate) fn filled(&self) -> Result<Cow<'a, [f64]>, BandsError> {
        match &self.decomposer.mask {
            Some(mask) => Ok(Cow::Owned(mask.fill(self.signal, self.n_channels, self.vertex_map())?)),
            None => Ok(Cow::Borrowed(self.signal)),
        }
    }

    /// All bands: [`Transform::bands`].
    ///
    /// # Errors
    /// As for [`Transform::bands`].
    pub fn bands(&self) -> Result<Bands, BandsError> {
        let filled = self.filled()?;
        let (d, schedule) = (self.n_channels, self.schedule);
        let mut bands = if self.is_linear() {
            self.unmasked_wavelets(&filled)?.to_bands(self.vertex_map(), &filled)
        } else {
            self.transform()?.bands(self.vertex_map(), &filled, d, schedule, self.progress)?
        };
        if let Some(mask) = &self.decomposer.mask {
            bands.visit_levels(|level| mask.clear(level, self.n_channels));
        }
        Ok(bands)
    }

    /// W_f(1), …, W_f(J), S_f(J) into a buffer of (J + 1)·n_vertices·n_channels values: [`Transform::bands_into`].
    ///
    /// # Errors
    /// As for [`Transform::bands_into`].
    pub fn bands_into(&self, buffer: &mut [f64]) -> Result<BandsInfo, BandsError> {
        let (filled, d) = (self.filled()?, self.n_channels);
        let info = if self.is_linear() {
            check_buffer(buffer.len(), (self.schedule.n_levels() + 1) * filled.len())?;
            self.unmasked_wavelets(&filled)?.write_bands(self.vertex_map(), &filled, buffer)
        } else {
            let (vertex_map, schedule) = (self.vertex_map(), self.schedule);
            self.transform()?.bands_into(vertex_map, &filled, d, schedule, buffer, self.progress)?
        };
        if let Some(mask) = &self.decomposer.mask {
            buffer.chunks_exact_mut(filled.len()).for_each(|level| mask.clear(level, d));
        }
        Ok(info)
    }

    /// Calls `visit(level, band)` with W_f(1), …, W_f(J), S_f(J) in turn, with levels counted from 0, each n_vertices ×
    /// n_channels: [`Transform::visit_bands`], in the memory of three signals for images and volumes without a mask.
    ///
    /// ```
    /// use adwave::bands::{BandsError, Schedule};
    /// use adwave::grid::Grid;
    /// use adwave::Decomposer;
    /// let grid = Grid::new(&[4], &[1.0])?;
    /// let line = Decomposer::from_domain(grid.clone(), grid.heat())?;
    /// let (mut sum, mut levels) = ([0.0; 4], Vec::new());
    /// let schedule = Schedule::dyadic(2)?;
    /// line.request(&[4.0, 1.0, 0.0, 2.0], 1, &schedule).visit_bands(|level, band| {
    ///     levels.push(level);
    ///     sum.iter_mut().zip(band).for_each(|(sum, w)| *sum += *w);
    ///     Ok::<(), BandsError>(())
    /// })?;
    /// assert_eq!(levels, [0, 1, 2]);
    /// assert!(sum.iter().zip([4.0, 1.0, 0.0, 2.0]).all(|(sum, f)| (sum - f).abs() < 1e-15));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Transform::visit_bands`].
    pub fn visit_bands<E: From<BandsError>>(
        &self,
        mut visit: impl FnMut(usize, &mut [f64]) -> Result<(), E>,
    ) -> Result<BandsInfo, E> {
        let (filled, d) = (self.filled()?, self.n_channels);
        let mask = self.decomposer.mask.as_ref();
        let visit = |level: usize, band: &mut [f64]| {
            if let Some(mask) = mask {
                mask.clear(band, d);
            }
            visit(level, band)
        };
        if self.is_linear() {
            let mut bands = self.unmasked_wavelets(&filled)?.to_bands(self.vertex_map(), &filled);
            return bands.try_visit_levels(visit).map(|()| bands.info);
        }
        let (vertex_map, schedule, progress) = (self.vertex_map(), self.schedule, self.progress);
        self.transform()?.visit_bands(vertex_map, &filled, d, schedule, progress, visit)
    }

    /// Wavelet coefficients in the analysis order; NaN at masked vertices.
    ///
    /// # Errors
    /// As for [`Transform::wavelets`].
    pub fn wavelets(&self) -> Result<Wavelets, BandsError> {
        let mut wavelets = self.unmasked_wavelets(&self.filled()?)?;
        self.clear_masked(&mut wavelets);
        Ok(wavelets)
    }

    /// Sets the values at masked vertices to NaN.
    fn clear_masked(&self, wavelets: &mut Wavelets) {
        let Some(masked) = self.decomposer.mask_flags() else { return };
        let d = wavelets.n_channels;
        for level in &mut wavelets.levels {
            parallel::visit_rows(level, d, 1 << 12, |first, rows| {
                for (row, masked) in rows.chunks_exact_mut(d).zip(&masked[first..]) {
                    if *masked {
                        row.fill(f64::NAN);
                    }
                }
            });
        }
    }

    /// Wavelet coefficients that are 0 at masked vertices.
    pub(crate) fn unmasked_wavelets(&self, filled: &[f64]) -> Result<Wavelets, BandsError> {
        let (transform, mean) = (self.transform()?, self.mean(filled)?);
        if self.is_linear() {
            return self.linear_wavelets(&transform, &mean);
        }
        transform.decompose_mean(&mean, self.n_channels, self.schedule, self.progress)
    }

    /// True if the bands are about a local linear fit.
    fn is_linear(&self) -> bool {
        self.decomposer.applied_local_fit(self.local_fit) == LocalFit::Linear
    }

    /// Wavelet coefficients about a local linear fit of each channel of `mean`.
    fn linear_wavelets(&self, transform: &Transform, mean: &[f64]) -> Result<Wavelets, BandsError> {
        if transform.params().precision == Precision::Single {
            return Err(BandsError::NotSingle { reason: "no bound of the error of a linear fit is known" });
        }
        let transform = &transform.in_double();
        let (d, schedule) = (self.n_channels, self.schedule);
        let n = mean.len() / d;
        let mut levels = vec![Vec::new(); schedule.n_levels()];
        if d > 1 {
            levels.fill_with(|| zeros(mean.len()));
        }
        let mut info: Option<BandsInfo> = None;
        let mut prepared: Option<LinearTransform<'_>> = None;
        for c in 0..d {
            let field: Vec<f64> = parallel::try_collect(n, self.progress, |x| mean[x * d + c])?;
            let domain = self.decomposer.fit_domain(&field);
            let linear = match prepared.take().filter(|prepared| prepared.domain() == domain) {
                Some(prepared) => prepared,
                None => self.decomposer.linear_transform(transform, domain, self.progress)?,
            };
            let (found, cost) = linear.wavelets(&field, schedule, self.progress)?;
            for (level, found) in levels.iter_mut().zip(found) {
                if d == 1 {
                    *level = found;
                } else {
                    parallel::visit_rows(level, d, 1 << 12, |first, rows| {
                        rows.chunks_exact_mut(d).zip(&found[first..]).for_each(|(row, w)| row[c] = *w);
                    });
                }
            }
            info = Some(match info {
                Some(sum) => sum.plus(&cost),
                None => cost,
            });
            prepared = Some(linear);
        }
        Ok(Wavelets {
            n_channels: d,
            steps: schedule.steps_from_zero(),
            sigma: schedule.sigma(transform.operator().step_length()),
            levels,
            info: info.expect("a signal has a channel"),
        })
    }

    /// Mean of the signal at each welded vertex.
    fn mean<'s>(&'s self, filled: &'s [f64]) -> Result<Cow<'s, [f64]>, BandsError> {
        check_signal(filled, self.decomposer.n_vertices(), self.n_channels)?;
        // Only for the shape's own coordinates, not for equal ones: their means are the positions of the welded
        // vertices, which exist already.
        let own = self.decomposer.shape().and_then(Shape::points).unwrap_or_default().as_flattened();
        if std::ptr::eq(filled, own) && self.n_channels == 3 {
            return Ok(Cow::Borrowed(self.decomposer.positions().as_flattened()));
        }
        if self.vertex_map().is_identity() {
            return Ok(Cow::Borrowed(filled));
        }
        Ok(Cow::Owned(self.vertex_map().mean(filled, self.n_channels)))
    }

    /// Euclidean norms of the wavelet coefficients over the channels, in the analysis order; a signal of one
    /// channel keeps its sign. They are the input of saliency and features.
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    pub fn norms(&self) -> Result<Wavelets, BandsError> {
        self.one_channel(RowMeasure::Norm)
    }

    /// Normal components `W_f(j,x)·n(x)` of a vector signal for unit normals n at the welded vertices, in the
    /// analysis order (see [`outward_normals`](crate::signal::outward_normals)). They are the input of signed
    /// saliency.
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    ///
    /// # Panics
    /// Unless the signal has three channels and there is one normal per welded vertex.
    pub fn normal_components(&self, normals: &[[f64; 3]]) -> Result<Wavelets, BandsError> {
        let n_welded = self.decomposer.n_places();
        assert_eq!((self.n_channels, n_welded), (3, normals.len()), "a vector and a normal at each vertex");
        self.one_channel(RowMeasure::Along(normals))
    }

    /// [`normal_components`](Self::normal_components) up to rounding, in a third of its memory and less time, for
    /// pictures of signed saliency ([`saliency_f32`](crate::saliency::saliency_f32)).
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    ///
    /// # Panics
    /// As for [`normal_components`](Self::normal_components).
    pub fn normal_components_in_one_pass(&self, normals: &[[f64; 3]]) -> Result<Wavelets, BandsError> {
        let n_welded = self.decomposer.n_places();
        assert_eq!((self.n_channels, n_welded), (3, normals.len()), "a vector and a normal at each vertex");
        if self.is_linear() {
            return self.normal_components(normals);
        }
        let (filled, transform) = (self.filled()?, self.transform()?);
        let found = transform.normal_components_in_one_pass(
            &self.mean(&filled)?,
            normals,
            self.schedule,
            self.progress,
        )?;
        let Some(mut found) = found else { return self.normal_components(normals) };
        self.clear_masked(&mut found);
        Ok(found)
    }

    fn one_channel(&self, measure: RowMeasure<'_>) -> Result<Wavelets, BandsError> {
        let (filled, transform) = (self.filled()?, self.transform()?);
        if self.is_linear() {
            let mut found = self.unmasked_wavelets(&filled)?.into_measure(measure);
            self.clear_masked(&mut found);
            return Ok(found);
        }
        let mean = self.mean(&filled)?;
        let (schedule, progress) = (self.schedule, self.progress);
        let mut found = transform.measure_mean(&mean, self.n_channels, measure, schedule, progress)?;
        self.clear_masked(&mut found);
        Ok(found)
    }

    /// Weighted sum `Σ_j factors[j−1]·W_f(j)` by a single polynomial of Φ₁; see [`Transform::weighted`]. NaN at
    /// masked vertices.
    ///
    /// # Errors
    /// As for [`Transform::weighted`].
    pub fn weighted(&self, factors: &[f64]) -> Result<(Vec<f64>, BandsInfo), BandsError> {
        let (mut sum, info) = self.unmasked_weighted(&self.filled()?, factors)?;
        if let Some(mask) = &self.decomposer.mask {
            mask.clear(&mut sum, self.n_channels);
        }
        Ok((sum, info))
    }

    fn unmasked_weighted(
        &self,
        filled: &[f64],
        factors: &[f64],
    ) -> Result<(Vec<f64>, BandsInfo), BandsError> {
        if self.is_linear() {
            check_factors(factors, self.schedule)?;
            let bands = self.unmasked_wavelets(filled)?.to_bands(self.vertex_map(), filled);
            let mut sum = zeros(filled.len());
            for (factor, band) in factors.iter().zip(bands.wavelets()) {
                parallel::visit_rows(&mut sum, 1, 1 << 12, |first, rows| {
                    rows.iter_mut().zip(&band[first..]).for_each(|(s, w)| *s += factor * w);
                });
            }
            return Ok((sum, bands.info));
        }
        let transform = self.transform()?;
        transform.weighted(self.vertex_map(), filled, self.n_channels, self.schedule, factors, self.progress)
    }

    /// Edits the signal once: `f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)` with `Γ(j,x) = Π_layers (1 + r(x)·(g_j − 1))`
    /// (eq. 18).
    ///
    /// Vertices outside all regions keep their values exactly. The order of the layers does not matter. A single
    /// layer costs about as much as its coarsest band; several layers cost all bands. For repeated edits of one
    /// signal use an [`editor`](Self::editor).
    ///
    /// # Errors
    /// [`FilterError`] if gains or regions do not match, or the bands cannot be computed.
    pub fn filter(&self, edit: &Edit<'_>) -> Result<Vec<f64>, FilterError> {
        let layers = edit.resolve(self.schedule.n_levels(), self.decomposer.metric(), self.progress)?;
        self.filter_layers(&layers)
    }

    /// [`filter`](Self::filter) with layers whose gains and weights are already numbers.
    ///
    /// # Errors
    /// As for [`filter`](Self::filter).
    pub fn filter_layers(&self, layers: &[WeightedLayer]) -> Result<Vec<f64>, FilterError> {
        Ok(self.filter_layers_with_info(layers)?.0)
    }

    /// [`filter_layers`](Self::filter_layers), and the cost and error bound of its bands.
    ///
    /// # Errors
    /// As for [`filter`](Self::filter).
    pub fn filter_layers_with_info(
        &self,
        layers: &[WeightedLayer],
    ) -> Result<(Vec<f64>, BandsInfo), FilterError> {
        self.check(layers)?;
        let filled = self.filled()?;
        if let [layer] = layers
            && !self.is_linear()
        {
            // Γ − 1 = r·(g − 1): the weight is a factor of the sum over the bands, which is one polynomial of Φ₁.
            let factors: Vec<f64> = layer.gains.iter().map(|g| g - 1.0).collect();
            let (change, info) = self.unmasked_weighted(&filled, &factors)?;
            return Ok((self.add_weighted(&layer.weights, change), info));
        }
        let wavelets = self.unmasked_wavelets(&filled)?;
        let vertex_map = self.vertex_map();
        let mean = vertex_map.mean(&filled, self.n_channels);
        let slots: Vec<LayerSlot> =
            layers.iter().map(|layer| LayerSlot::new(layer.clone(), vertex_map)).collect();
        let masked = self.decomposer.mask().map(Mask::vertices);
        let source =
            FilterInput { signal: self.signal, wavelets: &wavelets, mean: &mean, vertex_map, masked };
        let mut edited = vec![0.0; self.signal.len()];
        source.apply(&slots, &mut Vec::new(), &mut edited);
        Ok((edited, wavelets.info.clone()))
    }

    fn check(&self, layers: &[WeightedLayer]) -> Result<(), FilterError> {
        let n_levels = self.schedule.n_levels();
        let mut layers = layers.iter().enumerate();
        layers.try_for_each(|(k, layer)| layer.check(k + 1, n_levels, self.vertex_map()))
    }

    /// Computes `f + r·change`.
    fn add_weighted(&self, weights: &RegionWeights, change: Vec<f64>) -> Vec<f64> {
        let (d, mut edited) = (self.n_channels, change);
        // Adding 0 would turn −0 into 0, and a file's text with it.
        let sum = |value: f64, change: f64| if change == 0.0 { value } else { value + change };
        let weights = match weights {
            RegionWeights::Everywhere => None,
            weights => Some(weights.to_vertices(self.vertex_map())),
        };
        parallel::visit_rows(&mut edited, d, 1 << 12, |first, rows| {
            let before = &self.signal[first * d..][..rows.len()];
            let Some(weights) = &weights else {
                rows.iter_mut().zip(before).for_each(|(new, value)| *new = sum(*value, *new));
                return;
            };
            let rows = rows.chunks_exact_mut(d).zip(before.chunks_exact(d));
            for ((row, before), weight) in rows.zip(&weights[first..]) {
                row.iter_mut().zip(before).for_each(|(new, value)| *new = sum(*value, weight * *new));
            }
        });
        if let Some(mask) = &self.decomposer.mask {
            mask.restore(self.signal, d, &mut edited);
        }
        edited
    }
}
