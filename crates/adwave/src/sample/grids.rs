//! Built-in images and volumes: heights of a landscape, and a head as magnetic resonance shows it.

use super::noise::check_sigma;
use super::{MAX_VERTICES, NoiseSigma, SampleError, SampleInfo};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use std::f64::consts::TAU;

/// The samples that are images or volumes, by name.
pub const GRID_SAMPLE_NAMES: [SampleInfo; 3] = [
    SampleInfo {
        name: "hills",
        description: "image: heights of a landscape in meters, 7.68 km by 7.68 km",
        default_vertices: 256 * 256,
        min_vertices: 16,
    },
    SampleInfo {
        name: "head",
        description: "volume: a head of skin, skull, folded cortex and ventricles, voxels of 3 × 2 × 2 mm",
        default_vertices: 56 * 96 * 80,
        min_vertices: 1000,
    },
    SampleInfo {
        name: "bold",
        description: "series: a coarse head, two spots of which are active, 90 frames, one every 2 s",
        default_vertices: 21 * 24 * 20,
        min_vertices: 1000,
    },
];

/// Side of the landscape, in meters.
const HILLS_SIDE: f64 = 7680.0;
/// Number of octaves of the landscape, and of waves in each.
const OCTAVES: (usize, usize) = (7, 6);
/// Half of the axes z, y and x of the volume, in millimeters.
const HEAD_HALF: [f64; 3] = [84.0, 96.0, 80.0];
/// Spacings of the default volume along z, y and x, in millimeters.
const HEAD_SPACINGS: [f64; 3] = [3.0, 2.0, 2.0];

/// Frames of the series, and seconds from one to the next.
const BOLD_FRAMES: (usize, f64) = (90, 2.0);
/// Centers of the active spots along z, y and x, in millimeters, and seconds of a period of each.
const BOLD_SPOTS: [([f64; 3], f64); 2] = [([30.0, -50.0, 25.0], 40.0), ([20.0, 40.0, -40.0], 24.0)];
/// Standard deviation of a spot, in millimeters, and its height in shares of the brightness.
const BOLD_SPOT: (f64, f64) = (11.0, 0.04);

/// A generated image or volume, in the order of [`Grid`](crate::grid::Grid).
#[derive(Clone, Debug, PartialEq)]
pub struct GridSample {
    /// Number of places along each axis; the last one is contiguous.
    pub sizes: Vec<usize>,
    /// Spacing of each axis: meters for hills, millimeters for the head.
    pub spacings: Vec<f64>,
    /// Values of each place, one per frame: heights in meters, or brightness from 0 to 100.
    pub values: Vec<f64>,
    /// Number of frames.
    pub n_frames: usize,
    /// Seconds from frame to frame, if there are several.
    pub frame_step: Option<f64>,
}

impl GridSample {
    /// One frame.
    fn new(sizes: Vec<usize>, spacings: Vec<f64>, values: Vec<f64>) -> Self {
        Self { sizes, spacings, values, n_frames: 1, frame_step: None }
    }

    /// Generates the sample `name` with about `n_places` places, or its default number; `None` if no image or volume
    /// has this name. O(n) time and memory.
    ///
    /// ```
    /// use adwave::sample::GridSample;
    /// let hills = GridSample::from_name("hills", Some(4096))?.unwrap();
    /// assert_eq!((hills.sizes, hills.spacings), (vec![64, 64], vec![120.0, 120.0]));
    /// # Ok::<(), adwave::sample::SampleError>(())
    /// ```
    ///
    /// # Errors
    /// [`SampleError::VertexCount`] outside `min_vertices` … [`MAX_VERTICES`].
    pub fn from_name(name: &str, n_places: Option<usize>) -> Result<Option<Self>, SampleError> {
        let Some(info) = GRID_SAMPLE_NAMES.iter().find(|info| info.name == name) else { return Ok(None) };
        let n = n_places.unwrap_or(info.default_vertices);
        if !(info.min_vertices..=MAX_VERTICES).contains(&n) {
            let (name, min) = (info.name, info.min_vertices);
            return Err(SampleError::VertexCount { name, n_vertices: n, min, max: MAX_VERTICES });
        }
        // The size of the head belongs to the voxels of its own sample.
        let usual = 56 * 96 * 80;
        Ok(Some(match info.name {
            "hills" => hills(n),
            "head" => head(n, usual),
            _ => bold(head(n, usual)),
        }))
    }

    /// Adds independent Gaussian noise to the values, in their unit, or for [`NoiseSigma::MeanEdge`] in multiples of
    /// their standard deviation.
    ///
    /// # Errors
    /// [`SampleError::BadSigma`] if `sigma` is negative, infinite or NaN.
    pub fn add_noise(&mut self, sigma: NoiseSigma, seed: u64) -> Result<(), SampleError> {
        let n = self.values.len() as f64;
        let mean = self.values.iter().sum::<f64>() / n;
        let square = self.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
        let sigma = match sigma {
            NoiseSigma::Model(sigma) => sigma,
            NoiseSigma::MeanEdge(multiple) => multiple * square.sqrt(),
        };
        check_sigma(sigma)?;
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        for value in &mut self.values {
            let normal: f64 = StandardNormal.sample(&mut random);
            *value += sigma * normal;
        }
        Ok(())
    }
}

/// Waves of seven octaves in directions that never repeat; the three longest have sharp ridges.
fn hills(n: usize) -> GridSample {
    let side = ((n as f64).sqrt().round() as usize).max(4);
    let spacing = HILLS_SIDE / side as f64;
    let (n_octaves, n_waves) = OCTAVES;
    // Multiples of these numbers fill an interval evenly.
    let part = |k: usize, number: f64| (k as f64 * number).fract();
    let height = |place: usize| {
        let (y, x) = ((place / side) as f64 * spacing, (place % side) as f64 * spacing);
        let mut height = 900.0;
        for octave in 0..n_octaves {
            let length = 5200.0 * 0.5_f64.powi(octave as i32);
            let wave = |k: usize| {
                let (turn, phase) = (TAU * part(k, 0.754_877_666), TAU * part(k, 0.569_840_29));
                let stretch = length * (0.75 + 0.5 * part(k, 0.618_033_989));
                (TAU * (x * turn.cos() + y * turn.sin()) / stretch + phase).cos()
            };
            let sum: f64 = (0..n_waves).map(|k| wave(1 + octave * n_waves + k)).sum();
            let even = sum / (n_waves as f64 / 2.0).sqrt();
            let shape = if octave < 3 { 0.8 - even.abs() } else { even };
            height += 0.045 * length * 0.9_f64.powi(octave as i32) * shape;
        }
        height
    };
    let values = crate::parallel::collect(side * side, height);
    GridSample::new(vec![side; 2], vec![spacing; 2], values)
}

/// Mean of eight points of each voxel.
fn head(n: usize, usual: usize) -> GridSample {
    let scale = (usual as f64 / n as f64).cbrt();
    let sizes: Vec<usize> = HEAD_HALF
        .iter()
        .zip(HEAD_SPACINGS)
        .map(|(half, spacing)| ((2.0 * half / (scale * spacing)).round() as usize).max(2))
        .collect();
    let spacings: Vec<f64> =
        HEAD_HALF.iter().zip(&sizes).map(|(half, size)| 2.0 * half / *size as f64).collect();
    let value = |place: usize| {
        let at = [place / (sizes[1] * sizes[2]), place / sizes[2] % sizes[1], place % sizes[2]];
        let corner = |bit: usize| {
            let place = |axis: usize| {
                let within = if bit >> axis & 1 == 1 { 0.75 } else { 0.25 };
                (at[axis] as f64 + within) * spacings[axis] - HEAD_HALF[axis]
            };
            brightness([place(0), place(1), place(2)])
        };
        (0..8).map(corner).sum::<f64>() / 8.0
    };
    let values = crate::parallel::collect(sizes.iter().product(), value);
    GridSample::new(sizes, spacings, values)
}

/// The head over time: two spots whose brightness rises and falls, each with a period of its own.
fn bold(head: GridSample) -> GridSample {
    let GridSample { sizes, spacings, values: still, .. } = head;
    let (n_frames, step) = BOLD_FRAMES;
    let (width, height) = BOLD_SPOT;
    let value = |index: usize| {
        let (place, seconds) = (index / n_frames, (index % n_frames) as f64 * step);
        let at = [place / (sizes[1] * sizes[2]), place / sizes[2] % sizes[1], place % sizes[2]];
        let active = |(center, period): &([f64; 3], f64)| {
            let offset =
                |axis: usize| (at[axis] as f64 + 0.5) * spacings[axis] - HEAD_HALF[axis] - center[axis];
            let square: f64 = (0..3).map(|axis| offset(axis).powi(2)).sum();
            height * (-0.5 * square / (width * width)).exp() * (TAU * seconds / period).sin()
        };
        still[place] * (1.0 + BOLD_SPOTS.iter().map(active).sum::<f64>())
    };
    let values = crate::parallel::collect(still.len() * n_frames, value);
    GridSample { sizes, spacings, values, n_frames, frame_step: Some(step) }
}

/// Brightness of the tissue at z, y and x, in millimeters from the center.
fn brightness([z, y, x]: [f64; 3]) -> f64 {
    let depth = |radii: [f64; 3]| {
        let [a, b, c] = radii;
        ((z / a).powi(2) + (y / b).powi(2) + (x / c).powi(2)).sqrt()
    };
    let r = depth([78.0, 90.0, 74.0]);
    let ventricle = |side: f64| {
        ((z - 8.0) / 12.0).powi(2) + ((y + 4.0) / 30.0).powi(2) + ((x - side * 13.0) / 7.0).powi(2) < 1.0
    };
    // Gyri and sulci: the border of the cortex winds about an ellipsoid.
    let folds = (z / 5.5 + (y / 9.0).sin()).sin() + (y / 6.0 + (x / 8.0).cos()).sin() + (x / 5.0).sin();
    let between = if x.abs() < 1.5 { 0.06 } else { 0.0 };
    let cortex = r + 0.025 * folds + between;
    match () {
        () if r > 1.0 => 0.0,
        () if r > 0.94 => 75.0,
        () if r > 0.88 => 12.0,
        () if ventricle(1.0) || ventricle(-1.0) || cortex > 0.84 => 28.0,
        () if cortex > 0.74 => 62.0,
        () => 96.0,
    }
}
