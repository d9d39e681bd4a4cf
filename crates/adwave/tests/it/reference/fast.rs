//! The code under test, asked in the terms of the formulas: matrices are dense and number their vertices as `dense.rs` does.

use crate::reference::dense::{Matrix, weld};
use crate::reference::shapes::Case;
use adwave::bands::{BandsParams, Engine, Schedule, smooth};
use adwave::basis::{BasisParams, basis, basis_by_squaring};
use adwave::features::{Feature, features};
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::laplacian::Laplacian;
use adwave::local_fit::LocalFit;
use adwave::operator::{Semigroup, local_operator};
use adwave::region::Region;
use adwave::saliency::{Saliency, saliency, saliency_per_level};
use adwave::shape::PreparedGeometry;
use adwave::{Decomposer, Progress};

pub(crate) use adwave::features::{FeatureParams, Refinement, Response, ThresholdScope};
pub(crate) use adwave::saliency::{SaliencyParams, Weighting};

/// The smallest error that can be asked for.
const ACCURACY: f64 = 1e-13;

/// A prepared shape.
pub(crate) struct Fast<'a> {
    case: &'a Case,
    decomposer: Decomposer,
    /// Position of each welded vertex in the analysis order.
    place: Vec<usize>,
}

/// T and what belongs to it; the matrix but for one common factor, which is a power of 2.
pub(crate) struct FastOperator {
    pub(crate) off_diagonal: Matrix,
    pub(crate) areas: Vec<f64>,
    pub(crate) mean_length: f64,
    pub(crate) time: f64,
    pub(crate) mean_square: Vec<f64>,
}

/// S_f(0..J) and W_f(1..J) in the order of the file.
pub(crate) struct FastBands {
    pub(crate) scaling: Vec<Vec<f64>>,
    pub(crate) wavelet: Vec<Vec<f64>>,
    pub(crate) reconstructed: Vec<f64>,
    pub(crate) sigma: Vec<f64>,
}

/// Method of computing bands.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Method {
    Default,
    Powers,
    Chebyshev,
}

impl<'a> Fast<'a> {
    pub(crate) fn new(case: &'a Case) -> Self {
        let decomposer =
            Decomposer::with_params(&case.parts.shape(), &case.params, Progress::none()).unwrap();
        let map = decomposer.vertex_map();
        let place = weld(&case.parts).first.into_iter().map(|x| map.welded(x)).collect();
        Self { case, decomposer, place }
    }

    /// This shape without some vertices of the file.
    pub(crate) fn masked(case: &'a Case, flags: &[bool]) -> Self {
        let whole = Self::new(case);
        Self { decomposer: whole.decomposer.masked(flags).unwrap(), ..whole }
    }

    fn vertices(&self, values: &[f64]) -> Vec<f64> {
        self.place.iter().map(|&x| values[x]).collect()
    }

    fn matrix(&self, entry: impl Fn(usize) -> Vec<f64>) -> Matrix {
        self.place.iter().map(|&x| self.vertices(&entry(x))).collect()
    }

    fn n_welded(&self) -> usize {
        self.place.len()
    }

    pub(crate) fn local_operator(&self) -> FastOperator {
        let shape = self.case.parts.shape();
        let geometry = PreparedGeometry::new(&shape, self.case.params.weld, Progress::none()).unwrap();
        let operator = local_operator(&geometry, &self.case.params, Progress::none()).unwrap();
        let off_diagonal = self.matrix(|x| {
            let mut row = vec![0.0; self.n_welded()];
            let (columns, values) = operator.rows().row(x);
            for (&y, value) in columns.iter().zip(values) {
                row[y as usize] = value * operator.log_factor()[x].exp();
            }
            row
        });
        FastOperator {
            off_diagonal,
            areas: self.vertices(operator.areas()),
            mean_length: operator.mean_length(),
            time: operator.time(),
            mean_square: self.vertices(operator.mean_square()),
        }
    }

    /// Φ₁.
    pub(crate) fn diffusion(&self) -> Matrix {
        let diffusion = self.decomposer.rows("a test").unwrap();
        self.matrix(|x| {
            let mut row = vec![0.0; self.n_welded()];
            let (columns, values) = diffusion.row(x);
            columns.iter().zip(values).for_each(|(&y, w)| row[y as usize] = *w);
            row[x] = diffusion.diagonal(x);
            row
        })
    }

    /// w and the areas of the Laplacian.
    pub(crate) fn laplacian(&self) -> (Matrix, Vec<f64>) {
        let geometry = self.decomposer.geometry().unwrap();
        let laplacian = Laplacian::new(geometry, self.case.params.neighbors, Progress::none()).unwrap();
        let row = |x: usize| {
            let mut row = vec![0.0; self.decomposer.n_places()];
            let (columns, values) = laplacian.weights().row(x);
            columns.iter().zip(values).for_each(|(&y, w)| row[y as usize] = *w);
            row
        };
        (self.matrix(row), self.vertices(&laplacian.areas()))
    }

    /// `rate·(I − Φ₁)`, of which heat takes the exponential.
    pub(crate) fn heat_generator(&self) -> Matrix {
        let Semigroup::Heat { rate, .. } = self.decomposer.operator().semigroup() else { panic!("no heat") };
        let mut generator = self.diffusion();
        for (x, row) in generator.iter_mut().enumerate() {
            let others: f64 = row.iter().enumerate().filter(|&(y, _)| y != x).map(|(_, w)| w).sum();
            for w in &mut *row {
                *w *= -rate;
            }
            row[x] = rate * others;
        }
        generator
    }

    pub(crate) fn is_reversible(&self) -> bool {
        self.decomposer.operator().is_reversible()
    }

    pub(crate) fn stationary(&self) -> Vec<f64> {
        self.vertices(self.decomposer.rows("a test").unwrap().stationary())
    }

    pub(crate) fn step_length(&self) -> f64 {
        self.decomposer.operator().step_length()
    }

    /// Area of every vertex of the file.
    pub(crate) fn areas_of_the_file(&self) -> Vec<f64> {
        self.decomposer.areas()
    }

    pub(crate) fn bands(
        &self,
        signal: &[f64],
        n_channels: usize,
        steps: &[f64],
        method: Method,
    ) -> FastBands {
        let params = match method {
            Method::Default => BandsParams::default().with_accuracy(ACCURACY),
            Method::Powers => BandsParams::default().with_engine(Engine::Powers),
            Method::Chebyshev => {
                BandsParams::default().with_accuracy(ACCURACY).with_engine(Engine::Chebyshev)
            }
        };
        let bands = self.split(signal, n_channels, steps, &params);
        FastBands {
            reconstructed: bands.reconstruct(),
            scaling: (0..=steps.len()).map(|j| bands.scaling(j).into_owned()).collect(),
            wavelet: bands.wavelets().map(<[f64]>::to_vec).collect(),
            sigma: bands.sigma,
        }
    }

    /// S_f(1..J) about a local linear fit, in the order of the file.
    pub(crate) fn linear_scaling(&self, field: &[f64], steps: &[f64], engine: Engine) -> Vec<Vec<f64>> {
        let schedule = Schedule::real(steps.to_vec()).unwrap();
        let request = self.decomposer.request(field, 1, &schedule);
        let request = request.params(&BandsParams::default().with_engine(engine));
        let bands = request.local_fit(LocalFit::Linear).bands().unwrap();
        (1..=steps.len()).map(|j| bands.scaling(j).into_owned()).collect()
    }

    fn split(
        &self,
        signal: &[f64],
        n_channels: usize,
        steps: &[f64],
        params: &BandsParams,
    ) -> adwave::bands::Bands {
        let schedule = Schedule::real(steps.to_vec()).unwrap();
        self.decomposer.request(signal, n_channels, &schedule).params(params).bands().unwrap()
    }

    /// Φ₁^n f of a signal on the welded vertices, one step after the other.
    pub(crate) fn smoothed(&self, signal: &[f64], n_channels: usize, n_steps: u64) -> Vec<f64> {
        let mut there = vec![0.0; signal.len()];
        for (x, &place) in self.place.iter().enumerate() {
            there[place * n_channels..][..n_channels]
                .copy_from_slice(&signal[x * n_channels..][..n_channels]);
        }
        let out = &smooth(
            self.decomposer.rows("a test").unwrap(),
            &there,
            n_channels,
            &[n_steps],
            Progress::none(),
        )
        .unwrap()[0];
        self.place.iter().flat_map(|&x| out[x * n_channels..][..n_channels].to_vec()).collect()
    }

    /// Φ_1 … Φ_J by Algorithm 1.
    pub(crate) fn squared(&self, n_levels: usize, epsilon: f64) -> Vec<Matrix> {
        let params = BasisParams::new(Schedule::dyadic(n_levels).unwrap()).with_drop_tolerance(epsilon);
        let basis =
            basis_by_squaring(self.decomposer.rows("a test").unwrap(), &params, Progress::none()).unwrap();
        basis.scaling.iter().map(|level| self.matrix(|x| dense_row(level.row(x), self.n_welded()))).collect()
    }

    /// Φ_1 … Φ_J and Ψ_1 … Ψ_J by the fast method, in single precision and without dropping.
    pub(crate) fn basis(&self, n_levels: usize) -> (Vec<Matrix>, Vec<Matrix>) {
        let params = BasisParams::new(Schedule::dyadic(n_levels).unwrap()).with_drop_tolerance(0.0);
        let basis = basis(self.decomposer.rows("a test").unwrap(), &params, Progress::none()).unwrap();
        let n = self.n_welded();
        let wide = |(columns, values): (&[u32], &[f32])| {
            let values: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            dense_row((columns, &values), n)
        };
        let phi = basis.scaling.iter().map(|level| self.matrix(|x| wide(level.row(x)))).collect();
        let psi = (1..=n_levels)
            .map(|j| {
                let level = basis.wavelet(j);
                self.matrix(|x| wide(level.row(x)))
            })
            .collect();
        (phi, psi)
    }

    /// φ and ψ of a vertex of the file on level `n_levels`, at the vertices of the file.
    pub(crate) fn functions_of(&self, vertex: usize, n_levels: usize) -> (Vec<f64>, Vec<f64>) {
        let schedule = Schedule::dyadic(n_levels).unwrap();
        let functions = self.decomposer.basis_of_vertex(vertex, &schedule, Progress::none()).unwrap();
        (functions.scaling_function, functions.wavelet)
    }

    /// Eq. 18 for layers of gains and weights on dyadic levels.
    pub(crate) fn filter(
        &self,
        signal: &[f64],
        n_channels: usize,
        n_levels: usize,
        layers: &[(Vec<f64>, Vec<f64>)],
    ) -> Vec<f64> {
        let region = |k: usize| Region::Field { name: k.to_string(), low: 0.0, high: 1.0 };
        let layers_by_name: Vec<Layer> = (0..layers.len())
            .map(|k| Layer { gains: Gains::Gains(layers[k].0.clone()), region: region(k) })
            .collect();
        let field = |name: &str| name.parse().ok().map(|k: usize| (1, layers[k].1.clone()));
        let edit = Edit::new(&layers_by_name).with_fields(&field, &[]);
        let schedule = Schedule::dyadic(n_levels).unwrap();
        let params = BandsParams::default().with_accuracy(ACCURACY);
        let request = self.decomposer.request(signal, n_channels, &schedule).params(&params);
        let once = request.filter(&edit).unwrap();
        // The object that keeps the bands has another arithmetic for one layer.
        let mut editor = request.editor().unwrap();
        editor.set_edit(&edit).unwrap();
        for (a, b) in once.iter().zip(editor.edited()) {
            assert!(
                a == b || (a - b).abs() <= 1e-11 * a.abs().max(1.0) || (a.is_nan() && b.is_nan()),
                "{a}, {b}"
            );
        }
        editor.into_edited()
    }

    /// `Σ_j factors[j−1]·W_f(j)` on dyadic levels.
    pub(crate) fn weighted(
        &self,
        signal: &[f64],
        n_channels: usize,
        n_levels: usize,
        factors: &[f64],
    ) -> Vec<f64> {
        let schedule = Schedule::dyadic(n_levels).unwrap();
        let request = self.decomposer.request(signal, n_channels, &schedule).params(&accurate());
        request.weighted(factors).unwrap().0
    }

    fn wavelets(&self, signal: &[f64], n_channels: usize, n_levels: usize) -> adwave::bands::Wavelets {
        let schedule = Schedule::dyadic(n_levels).unwrap();
        self.decomposer.request(signal, n_channels, &schedule).params(&accurate()).wavelets().unwrap()
    }

    /// Eq. 17 on dyadic levels: the map and its levels in the order of the file.
    pub(crate) fn saliency(
        &self,
        signal: &[f64],
        n_channels: usize,
        n_levels: usize,
        params: &SaliencyParams,
    ) -> (Saliency, Vec<Vec<f64>>) {
        let wavelets = self.wavelets(signal, n_channels, n_levels).into_norms();
        let map = saliency(&self.decomposer, &wavelets, params, Progress::none()).unwrap();
        let levels = saliency_per_level(&self.decomposer, &wavelets, params, Progress::none()).unwrap();
        (map, levels.into_iter().map(|(_, map)| map).collect())
    }

    /// Algorithm 2 on dyadic levels.
    pub(crate) fn features(
        &self,
        signal: &[f64],
        n_channels: usize,
        n_levels: usize,
        params: &FeatureParams,
    ) -> Vec<Feature> {
        let wavelets = self.wavelets(signal, n_channels, n_levels);
        features(&self.decomposer, &wavelets, params, Progress::none()).unwrap()
    }

    /// Bands of given values in place of a signal's: W(j) of the welded vertices at index j − 1, and σ_0 … σ_J.
    fn given(&self, levels: &[Vec<f64>], sigma: &[f64]) -> adwave::bands::Wavelets {
        let mut wavelets = self.wavelets(&vec![0.0; self.decomposer.n_vertices()], 1, levels.len());
        for (there, level) in wavelets.levels.iter_mut().zip(levels) {
            for (&place, value) in self.place.iter().zip(level) {
                there[place] = *value;
            }
        }
        wavelets.sigma = sigma.to_vec();
        wavelets
    }

    /// Algorithm 2 on bands of given values.
    pub(crate) fn features_of(
        &self,
        levels: &[Vec<f64>],
        sigma: &[f64],
        params: &FeatureParams,
    ) -> Vec<Feature> {
        features(&self.decomposer, &self.given(levels, sigma), params, Progress::none()).unwrap()
    }

    /// Eq. 17 on bands of given values.
    pub(crate) fn saliency_of(
        &self,
        levels: &[Vec<f64>],
        sigma: &[f64],
        params: &SaliencyParams,
    ) -> Saliency {
        saliency(&self.decomposer, &self.given(levels, sigma), params, Progress::none()).unwrap()
    }

    /// True if the analysis order has the welded vertex `x` before `y`.
    pub(crate) fn comes_first(&self, x: usize, y: usize) -> bool {
        self.place[x] < self.place[y]
    }

    /// Mean square of each band on dyadic levels, weighted.
    pub(crate) fn energy(
        &self,
        signal: &[f64],
        n_channels: usize,
        n_levels: usize,
        weights: &[f64],
    ) -> Vec<f64> {
        self.split(signal, n_channels, &dyadic(n_levels), &accurate()).energy(weights).unwrap()
    }
}

/// The gains of a preset, by its name.
pub(crate) fn preset(name: &str, n_levels: usize) -> Vec<f64> {
    name.parse::<Preset>().unwrap().gains(n_levels)
}

fn accurate() -> BandsParams {
    BandsParams::default().with_accuracy(ACCURACY)
}

/// The steps 2^(j−1) of level j.
pub(crate) fn dyadic(n_levels: usize) -> Vec<f64> {
    (0..n_levels).map(|j| f64::from(1_u32 << j)).collect()
}

fn dense_row((columns, values): (&[u32], &[f64]), n: usize) -> Vec<f64> {
    let mut row = vec![0.0; n];
    columns.iter().zip(values).for_each(|(&y, v)| row[y as usize] = *v);
    row
}
