//! Other wavelets on the same diffusion: spectral graph wavelets and diffusion wavelets.

use crate::arrays;
use crate::call::run;
use crate::error::{self, Stage, StageError, stage, value_error};
use crate::options::word;
use crate::prepared::Prepared;
use adwave::Progress;
use adwave::shape::VertexMap;
use adwave_baselines::multiscale::{
    BiorthogonalDiffusionWavelets, Coefficients, DiffusionWavelets, MultiscaleError, MultiscaleParams,
};
use adwave_baselines::sgwt::{Frame, KernelFamily, Kernels, normalized_laplacian};
use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<FrameData>()?;
    module.add_class::<MultiscaleData>()
}

const FAMILIES: &[(&str, KernelFamily)] = &[
    ("meyer", KernelFamily::Meyer),
    ("mexican-hat", KernelFamily::MexicanHat),
    ("abspline", KernelFamily::Abspline),
    ("itersine", KernelFamily::Itersine),
];

/// One channel of a signal over the welded vertices.
fn channel(map: &VertexMap, values: &[f64], n_channels: usize, c: usize) -> Vec<f64> {
    let values: Vec<f64> = values.iter().skip(c).step_by(n_channels).copied().collect();
    map.mean(&values, 1)
}

/// Writes a channel over the welded vertices into n × n_channels values at the vertices of the shape.
fn write_channel(map: &VertexMap, welded: &[f64], out: &mut [f64], n_channels: usize, c: usize) {
    for (row, value) in out.chunks_exact_mut(n_channels).zip(map.scatter(welded, 1)) {
        row[c] = value;
    }
}

/// Kernels of the normalized Laplacian, as polynomials.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct FrameData {
    frame: Frame,
    root: Vec<f64>,
    map: VertexMap,
}

#[pymethods]
impl FrameData {
    #[new]
    #[pyo3(signature = (prepared, family, n_kernels, accuracy))]
    fn new(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        family: &str,
        n_kernels: usize,
        accuracy: f64,
    ) -> PyResult<Self> {
        let family = word("family", family, FAMILIES)?;
        let decomposer = &prepared.get().decomposer;
        let (frame, root) = run(py, usize::MAX, None, |_| {
            let rows = stage(decomposer.rows("a spectral graph wavelet"))?;
            let (laplacian, root) = stage(normalized_laplacian(rows))?;
            // I − Q has its spectrum in [0, 2].
            let kernels = stage(Kernels::new(family, n_kernels, 2.0))?;
            Ok::<_, StageError>((stage(Frame::new(laplacian, kernels, accuracy))?, root))
        })?;
        Ok(Self { frame, root, map: decomposer.vertex_map().clone() })
    }

    #[getter]
    fn bounds(&self) -> (f64, f64) {
        self.frame.bounds
    }

    #[getter]
    fn degree(&self) -> usize {
        self.frame.polynomials.iter().map(|p| p.coefficients.len().saturating_sub(1)).max().unwrap_or(0)
    }

    #[getter]
    fn n_kernels(&self) -> usize {
        self.frame.kernels.len()
    }

    /// `g_i(λ)` of each kernel, kernels × values.
    #[pyo3(signature = (lambda_))]
    fn kernels<'py>(&self, py: Python<'py>, lambda_: Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        let kernels = &self.frame.kernels;
        let values = (0..kernels.len()).flat_map(|i| lambda_.iter().map(move |&l| kernels.value(i, l)));
        Ok(arrays::matrix(py, values.collect(), lambda_.len())?.into_any())
    }

    /// Coefficients, kernels × vertices × channels, the low pass first.
    #[pyo3(signature = (signal, progress=None))]
    fn analyze<'py>(
        &self,
        py: Python<'py>,
        signal: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (n, d) = (signal.shape()[0], signal.shape()[1]);
        if n != self.map.n_vertices() || d == 0 {
            return Err(value_error(format!(
                "signal: shape ({n}, {d}) for {} vertices; give one row for each",
                self.map.n_vertices()
            )));
        }
        let values = arrays::rows(&signal, "signal")?;
        let out = run(py, usize::MAX, progress.as_ref(), |p| {
            let mut out = vec![0.0; self.frame.kernels.len() * n * d];
            for c in 0..d {
                let f: Vec<f64> =
                    channel(&self.map, values, d, c).iter().zip(&self.root).map(|(f, r)| f * r).collect();
                let found = self.frame.analyze(&f, p)?;
                for (level, found) in out.chunks_exact_mut(n * d).zip(found) {
                    let unscaled: Vec<f64> = found.iter().zip(&self.root).map(|(v, r)| v / r).collect();
                    write_channel(&self.map, &unscaled, level, d, c);
                }
            }
            Ok::<_, adwave_baselines::sgwt::SgwtError>(out)
        })?;
        Ok(arrays::levels(py, out, n, d)?.into_any())
    }

    /// The signal with these coefficients, and the number of iterations.
    #[pyo3(signature = (coefficients, tolerance, progress=None))]
    fn synthesize<'py>(
        &self,
        py: Python<'py>,
        coefficients: PyReadonlyArray3<'py, f64>,
        tolerance: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, usize)> {
        let n = self.map.n_vertices();
        let shape = coefficients.shape();
        let d = shape[2];
        if !coefficients.is_c_contiguous() || shape[..2] != [self.frame.kernels.len(), n] || d == 0 {
            return Err(value_error(format!(
                "coefficients: shape {shape:?}; this frame's are ({}, {n}, channels)",
                self.frame.kernels.len()
            )));
        }
        let values = coefficients.as_slice()?;
        let (out, iterations) = run(py, usize::MAX, progress.as_ref(), |p| {
            let (mut out, mut iterations) = (vec![0.0; n * d], 0);
            for c in 0..d {
                let parts: Vec<Vec<f64>> = values
                    .chunks_exact(n * d)
                    .map(|level| channel(&self.map, level, d, c))
                    .map(|part| part.iter().zip(&self.root).map(|(f, r)| f * r).collect())
                    .collect();
                let (back, info) = self.frame.inverse(&parts, tolerance, p)?;
                iterations = iterations.max(info.iterations);
                let unscaled: Vec<f64> = back.iter().zip(&self.root).map(|(v, r)| v / r).collect();
                write_channel(&self.map, &unscaled, &mut out, d, c);
            }
            Ok::<_, adwave_baselines::sgwt::SgwtError>((out, iterations))
        })?;
        Ok((arrays::matrix(py, out, d)?.into_any(), iterations))
    }
}

enum WaveletBasis {
    Orthogonal(DiffusionWavelets),
    Biorthogonal(BiorthogonalDiffusionWavelets),
}

/// Diffusion wavelets, orthogonal or biorthogonal, of a shape of few vertices.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct MultiscaleData {
    basis: WaveletBasis,
    map: VertexMap,
}

impl MultiscaleData {
    /// Coefficients of a signal over the welded vertices.
    fn analyze_welded(&self, f: &[f64]) -> Result<Coefficients, MultiscaleError> {
        match &self.basis {
            WaveletBasis::Orthogonal(basis) => basis.analyze(f),
            WaveletBasis::Biorthogonal(basis) => basis.analyze(f),
        }
    }

    /// Functions over the welded vertices as rows over the vertices of the shape.
    fn functions_as_rows<'py>(&self, py: Python<'py>, functions: &[Vec<f64>]) -> PyResult<Bound<'py, PyAny>> {
        let n = self.map.n_vertices();
        let rows: Vec<f64> = functions.iter().flat_map(|f| self.map.scatter(f, 1)).collect();
        Ok(numpy::PyArrayMethods::reshape(&arrays::vector(py, rows), [functions.len(), n])?.into_any())
    }
}

#[pymethods]
impl MultiscaleData {
    #[new]
    #[pyo3(signature = (prepared, orthogonal, n_levels, precision, progress=None))]
    fn new(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        orthogonal: bool,
        n_levels: usize,
        precision: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let decomposer = &prepared.get().decomposer;
        let params = MultiscaleParams::default().with_levels(n_levels).with_precision(precision);
        let diffusion = decomposer.rows("a diffusion wavelet basis").map_err(|e| error::to_exception(&e))?;
        let basis = run(py, usize::MAX, progress.as_ref(), |p: Progress<'_>| -> Stage<WaveletBasis> {
            Ok(if orthogonal {
                WaveletBasis::Orthogonal(stage(DiffusionWavelets::new(diffusion, &params, p))?)
            } else {
                WaveletBasis::Biorthogonal(stage(BiorthogonalDiffusionWavelets::new(diffusion, &params, p))?)
            })
        })?;
        Ok(Self { basis, map: decomposer.vertex_map().clone() })
    }

    /// Number of scaling functions of each level, from level 0.
    #[getter]
    fn ranks(&self) -> Vec<usize> {
        match &self.basis {
            WaveletBasis::Orthogonal(basis) => basis.ranks(),
            WaveletBasis::Biorthogonal(basis) => basis.ranks(),
        }
    }

    /// Coefficients of a signal: of the wavelets of each level, then of the last scaling functions.
    fn analyze<'py>(&self, py: Python<'py>, signal: Vec<f64>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        if signal.len() != self.map.n_vertices() {
            let (n, got) = (self.map.n_vertices(), signal.len());
            return Err(value_error(format!("signal: {got} values for {n} vertices")));
        }
        let found =
            self.analyze_welded(&channel(&self.map, &signal, 1, 0)).map_err(|e| error::to_exception(&e))?;
        let all = found.wavelets.into_iter().chain([found.scaling]);
        Ok(all.map(|values| arrays::vector(py, values).into_any()).collect())
    }

    /// The signal with these coefficients.
    fn synthesize<'py>(
        &self,
        py: Python<'py>,
        mut coefficients: Vec<Vec<f64>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let scaling = coefficients.pop().unwrap_or_default();
        let coefficients = Coefficients { scaling, wavelets: coefficients };
        let back = match &self.basis {
            WaveletBasis::Orthogonal(basis) => basis.synthesize(&coefficients),
            WaveletBasis::Biorthogonal(basis) => basis.synthesize(&coefficients),
        };
        let back = back.map_err(|e| error::to_exception(&e))?;
        Ok(arrays::vector(py, self.map.scatter(&back, 1)).into_any())
    }

    /// Scaling functions (`kind` 0), wavelets (1) or duals (2) of a level from 1, a row for each.
    fn functions<'py>(&self, py: Python<'py>, level: usize, kind: u8) -> PyResult<Bound<'py, PyAny>> {
        let n_levels = self.ranks().len() - 1;
        if level == 0 || level > n_levels {
            return Err(value_error(format!("level must be in 1..={n_levels}, got {level}")));
        }
        let functions = match (&self.basis, kind) {
            (WaveletBasis::Orthogonal(basis), 1) => basis.wavelets(level),
            (WaveletBasis::Orthogonal(basis), _) => basis.scaling_functions(level),
            (WaveletBasis::Biorthogonal(basis), 1) => basis.wavelets(level),
            (WaveletBasis::Biorthogonal(basis), 0) => basis.scaling_functions(level),
            (WaveletBasis::Biorthogonal(basis), _) => basis.dual_functions(level),
        };
        self.functions_as_rows(py, &functions)
    }
}
