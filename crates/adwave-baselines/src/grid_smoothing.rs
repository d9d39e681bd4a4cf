//! Smoothing of images and volumes by sampled kernels: the Gaussian of SciPy's `gaussian_filter`, and the starlet, an
//! isotropic undecimated wavelet transform (`starck2007`).

use rayon::prelude::*;

/// Standard deviations at which the Gaussian is cut off.
const TRUNCATION: f64 = 4.0;
/// Largest number of weights on either side of a kernel.
const MOST_WEIGHTS: f64 = 1e6;
/// Weights of the B3 spline at the offsets −2 … 2.
const B3: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
/// Values that a thread computes at least.
const CHUNK: usize = 1 << 12;

/// Places of an image or a volume with values.
#[derive(Clone, Copy, Debug)]
pub struct GridPlaces<'a> {
    /// Number of places along each axis; the last axis is contiguous.
    pub sizes: &'a [usize],
    /// Distance of neighbors along each axis.
    pub spacings: &'a [f64],
    /// False at places without data; `None` if all have data.
    pub kept: Option<&'a [bool]>,
}

/// Continuation of a line of values beyond its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum GridBorder {
    /// `c b a | a b c | c b a`, the mode `reflect` of SciPy.
    Reflect,
    /// `c b | a b c | b a`: the end itself is not repeated.
    Mirror,
}

impl GridBorder {
    /// Number of places after which a line of `n` values repeats.
    fn period(self, n: usize) -> usize {
        match self {
            Self::Reflect => 2 * n,
            Self::Mirror => (2 * n - 2).max(1),
        }
    }

    /// The place within the line that a place within the period stands for.
    fn fold(self, k: usize, n: usize) -> usize {
        match self {
            _ if k < n => k,
            Self::Reflect => 2 * n - 1 - k,
            Self::Mirror => 2 * n - 2 - k,
        }
    }
}

/// Symmetric weights at offsets within the period of a line.
struct Kernel {
    taps: Vec<(usize, f64)>,
    border: GridBorder,
    /// Variance in squared places.
    variance: f64,
}

impl Kernel {
    /// Normalized samples of a Gaussian; `None` if there are too many. `sigma` is its standard deviation in places.
    fn gaussian(sigma: f64, n: usize) -> Option<Self> {
        let radius = (TRUNCATION * sigma + 0.5).floor();
        if radius.is_nan() || radius > MOST_WEIGHTS {
            return None;
        }
        let (radius, period) = (radius as usize, GridBorder::Reflect.period(n));
        let weight = |k: usize| if k == 0 { 1.0 } else { (-0.5 * (k as f64 / sigma).powi(2)).exp() };
        let sum = 1.0 + 2.0 * (1..=radius).map(weight).sum::<f64>();
        let both =
            |k: usize| [k % period, (period - k % period) % period].map(|offset| (offset, weight(k) / sum));
        let mut taps = vec![(0, 1.0 / sum)];
        taps.extend((1..=radius).flat_map(both));
        if taps.len() > period {
            let mut folded = vec![0.0; period];
            for (offset, weight) in taps {
                folded[offset] += weight;
            }
            taps = folded.into_iter().enumerate().collect();
        }
        let variance = 2.0 * (1..=radius).map(|k| weight(k) / sum * (k as f64).powi(2)).sum::<f64>();
        Some(Self { taps, border: GridBorder::Reflect, variance })
    }

    /// Weights of the B3 spline, `2^(level − 1)` places apart.
    fn spline(level: usize, n: usize) -> Self {
        let period = GridBorder::Mirror.period(n);
        let step = (1..level).fold(1 % period, |step, _| 2 * step % period);
        let offsets = [2 * (period - step), period - step, 0, step, 2 * step];
        let taps = offsets.into_iter().zip(B3).map(|(offset, weight)| (offset % period, weight)).collect();
        Self { taps, border: GridBorder::Mirror, variance: 4.0_f64.powi(level as i32 - 1) }
    }

    /// Convolves lines of `n` values, `stride` apart.
    fn apply(&self, values: &[f64], n: usize, stride: usize) -> Vec<f64> {
        let period = self.border.period(n);
        let sources: Vec<usize> = (0..2 * period).map(|k| self.border.fold(k % period, n)).collect();
        let mut out = vec![0.0; values.len()];
        let rows = out.par_chunks_mut(stride).with_min_len(CHUNK.div_ceil(stride)).enumerate();
        rows.for_each(|(row, out)| {
            let (line, place) = (row / n * n, row % n);
            for &(offset, weight) in &self.taps {
                let from = (line + sources[place + offset]) * stride;
                out.iter_mut().zip(&values[from..]).for_each(|(out, value)| *out += weight * value);
            }
        });
        out
    }
}

/// Smoothed values, and the mean variance of the kernel along an axis, in squared units of the spacings.
struct Smoothed {
    values: Vec<f64>,
    variance: f64,
}

impl GridPlaces<'_> {
    /// Axes with more than one place, with the distance between their neighbors in the order of the values.
    fn axes(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let stride = |axis: usize| self.sizes[axis + 1..].iter().product::<usize>();
        (0..self.sizes.len()).filter(|&axis| self.sizes[axis] > 1).map(move |axis| (axis, stride(axis)))
    }

    /// Convolves along all axes. Where there are places without data, the smoothed values are divided by the smoothed
    /// flags of the places with data.
    fn smooth(
        &self,
        values: &[f64],
        n_channels: usize,
        kernel: impl Fn(usize) -> Option<Kernel>,
    ) -> Option<Smoothed> {
        let kernels = self.axes().map(|(axis, stride)| Some((axis, stride, kernel(axis)?)));
        let kernels: Vec<(usize, usize, Kernel)> = kernels.collect::<Option<_>>()?;
        let along_all = |mut values: Vec<f64>, n_channels: usize| {
            for (axis, stride, kernel) in &kernels {
                values = kernel.apply(&values, self.sizes[*axis], stride * n_channels);
            }
            values
        };
        let squares = kernels.iter().map(|(axis, _, kernel)| kernel.variance * self.spacings[*axis].powi(2));
        let variance = squares.sum::<f64>() / kernels.len().max(1) as f64;
        let Some(kept) = self.kept else {
            return Some(Smoothed { values: along_all(values.to_vec(), n_channels), variance });
        };
        let mut filled = values.to_vec();
        let rows = filled.chunks_exact_mut(n_channels).zip(kept).filter(|(_, kept)| !**kept);
        rows.for_each(|(row, _)| row.fill(0.0));
        let mut smoothed = along_all(filled, n_channels);
        let weights = along_all(kept.iter().map(|kept| f64::from(u8::from(*kept))).collect(), 1);
        for ((row, weight), kept) in smoothed.chunks_exact_mut(n_channels).zip(weights).zip(kept) {
            for v in row {
                *v = if *kept { *v / weight } else { f64::NAN };
            }
        }
        Some(Smoothed { values: smoothed, variance })
    }
}

/// Smoothed values at each level, finest first, and their widths.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothedLevels {
    /// Values S_1 … S_J.
    pub levels: Vec<Vec<f64>>,
    /// Width σ_j of each level, √2 times the standard deviation of its kernel along an axis (root mean square over the
    /// axes), in the unit of the spacings.
    pub sigma: Vec<f64>,
}

/// Smooths by a Gaussian with the standard deviation σ/√2 along each axis as SciPy's `gaussian_filter` does: samples up
/// to 4 standard deviations, normalized, borders that reflect. The widths of the result are those of the samples.
/// O(places × σ / spacing).
///
/// `None` if a kernel has more than a million weights.
pub fn gaussian_levels(
    places: &GridPlaces<'_>,
    values: &[f64],
    n_channels: usize,
    sigma: &[f64],
) -> Option<SmoothedLevels> {
    let smooth = |sigma: &f64| {
        let kernel = |axis: usize| {
            let deviation = sigma / (std::f64::consts::SQRT_2 * places.spacings[axis]);
            Kernel::gaussian(deviation, places.sizes[axis])
        };
        let smoothed = places.smooth(values, n_channels, kernel)?;
        Some((smoothed.values, (2.0 * smoothed.variance).sqrt()))
    };
    let (levels, sigma) = sigma.iter().map(smooth).collect::<Option<Vec<_>>>()?.into_iter().unzip();
    Some(SmoothedLevels { levels, sigma })
}

/// Smooths by the starlet: level j convolves the level below with the B3 spline [1 4 6 4 1]/16 along each axis, its weights
/// `2^(j − 1)` places apart, with mirrored borders. The bands are differences of successive levels. O(places × levels).
pub fn starlet_levels(
    places: &GridPlaces<'_>,
    values: &[f64],
    n_channels: usize,
    n_levels: usize,
) -> SmoothedLevels {
    let mut levels: Vec<Vec<f64>> = Vec::with_capacity(n_levels);
    for level in 1..=n_levels {
        let below = levels.last().map_or(values, Vec::as_slice);
        let kernel = |axis: usize| Some(Kernel::spline(level, places.sizes[axis]));
        levels.extend(places.smooth(below, n_channels, kernel).map(|smoothed| smoothed.values));
    }
    SmoothedLevels { levels, sigma: starlet_widths(places, n_levels) }
}

/// Widths σ_j of the levels of the starlet: `2 (4^j − 1)/3` times the mean square of the spacings is σ_j².
///
/// ```
/// use adwave_baselines::grid_smoothing::{GridPlaces, starlet_widths};
/// let places = GridPlaces { sizes: &[8, 8], spacings: &[1.0, 1.0], kept: None };
/// assert_eq!(starlet_widths(&places, 2), [2.0_f64.sqrt(), 10.0_f64.sqrt()]);
/// ```
pub fn starlet_widths(places: &GridPlaces<'_>, n_levels: usize) -> Vec<f64> {
    let squares = || places.axes().map(|(axis, _)| places.spacings[axis].powi(2));
    let mean = squares().sum::<f64>() / squares().count().max(1) as f64;
    (1..=n_levels).map(|j| (2.0 * (4.0_f64.powi(j as i32) - 1.0) / 3.0 * mean).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(n: usize) -> GridPlaces<'static> {
        const SIZES: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9];
        GridPlaces { sizes: &SIZES[n..=n], spacings: &[0.5], kept: None }
    }

    #[test]
    fn the_gaussian_has_the_samples_of_the_formula() {
        // A standard deviation of 0.5 places: radius 2, weights e^(-2) and e^(-8) beside 1.
        let sum = 1.0 + 2.0 * ((-2.0_f64).exp() + (-8.0_f64).exp());
        let weights = [1.0, (-2.0_f64).exp(), (-8.0_f64).exp()].map(|w| w / sum);
        let sigma = 0.25 * 2.0_f64.sqrt();
        let impulse = |at: usize| (0..7).map(|k| f64::from(u8::from(k == at))).collect::<Vec<_>>();
        let smooth = |at| gaussian_levels(&line(7), &impulse(at), 1, &[sigma]).unwrap().levels.remove(0);
        let [w0, w1, w2] = weights;
        let expect = |found: Vec<f64>, expected: [f64; 7]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?} {expected:?}");
        };
        expect(smooth(3), [0.0, w2, w1, w0, w1, w2, 0.0]);
        // Reflected at the border: a b c continues to the left as a b c.
        expect(smooth(0), [w0 + w1, w1 + w2, w2, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn an_image_is_smoothed_as_by_scipy() {
        let values = [3.0, -1.0, 0.5, 8.0, 2.0, 0.0, 1.0, 4.0, 7.0, 5.0, -2.0, 6.0];
        // scipy.ndimage.gaussian_filter(values, [0.8 / 1.0, 0.8 / 0.5]) of SciPy 1.17.1
        let expected = [
            1.650_160_494_632_496_8,
            1.963_689_784_581_493_3,
            2.702_020_232_865_889_3,
            3.433_710_785_694_480_6,
            2.298_205_853_497_589_3,
            2.317_478_535_246_449,
            2.579_010_025_615_737_3,
            2.933_068_468_513_105,
            3.905_707_617_796_884_4,
            3.482_823_107_550_837,
            3.141_869_743_163_914_7,
            3.092_255_350_841_133,
        ];
        let places = GridPlaces { sizes: &[3, 4], spacings: &[1.0, 0.5], kept: None };
        let sigma = 0.8 * std::f64::consts::SQRT_2;
        let found = gaussian_levels(&places, &values, 1, &[sigma]).unwrap().levels.remove(0);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }

    #[test]
    fn wide_gaussians_on_short_lines_keep_the_sum() {
        for sigma in [0.1, 3.0, 40.0] {
            let values = [3.0, -1.0, 0.5, 8.0];
            let smoothed = gaussian_levels(&line(4), &values, 1, &[sigma]).unwrap().levels.remove(0);
            assert!((smoothed.iter().sum::<f64>() - 10.5).abs() < 1e-12, "{sigma}: {smoothed:?}");
        }
        assert!(gaussian_levels(&line(4), &[0.0; 4], 1, &[1e12]).is_none());
    }

    #[test]
    fn bands_and_rest_of_the_starlet_sum_to_the_image() {
        let sizes = [6, 9];
        let places = GridPlaces { sizes: &sizes, spacings: &[1.0, 2.0], kept: None };
        let image: Vec<f64> = (0..108).map(|k| f64::from(k * 7919 % 101)).collect();
        let SmoothedLevels { levels, sigma } = starlet_levels(&places, &image, 2, 5);
        assert_eq!((levels.len(), sigma[0]), (5, 5.0_f64.sqrt()));
        let mut sum = levels[4].clone();
        for j in 0..5 {
            let below = if j == 0 { &image } else { &levels[j - 1] };
            sum.iter_mut().zip(below).zip(&levels[j]).for_each(|((s, a), b)| *s += a - b);
        }
        assert!(sum.iter().zip(&image).all(|(a, b)| (a - b).abs() < 1e-12));
        // In the middle of a line an impulse becomes the spline, then the product of two.
        let impulse: Vec<f64> = (0..9).map(|k| f64::from(u8::from(k == 4))).collect();
        let levels = starlet_levels(&line(9), &impulse, 1, 2).levels;
        assert_eq!(levels[0], [0.0, 0.0, 1.0, 4.0, 6.0, 4.0, 1.0, 0.0, 0.0].map(|w| w / 16.0));
        assert!((levels[1][4] - 44.0 / 256.0).abs() < 1e-15, "6·6 + 2·4·1 of 256 reach the middle");
    }

    #[test]
    fn places_without_data_give_nothing_and_get_nothing() {
        let kept = [true, true, false, true, true];
        let places = GridPlaces { kept: Some(&kept), ..line(5) };
        let values = [2.0, 2.0, f64::NAN, 2.0, 2.0];
        let gaussian = gaussian_levels(&places, &values, 1, &[1.0]).unwrap().levels.remove(0);
        let starlet = starlet_levels(&places, &values, 1, 3).levels.remove(2);
        for smoothed in [gaussian, starlet] {
            assert!(smoothed[2].is_nan());
            assert!((0..5).filter(|k| *k != 2).all(|k| (smoothed[k] - 2.0).abs() < 1e-12), "{smoothed:?}");
        }
    }
}
