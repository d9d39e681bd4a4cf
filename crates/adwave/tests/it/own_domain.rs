//! All that works on shapes works on a domain and an operator of one's own that store no rows, as on the same walk given by its
//! rows.

use crate::cylinder::{ALONG, AROUND, Cylinder, HOLES};
use adwave::bands::{BandsParams, Engine, Schedule};
use adwave::denoise::{DenoiseParams, denoise_signal};
use adwave::domain::{Domain, DomainError};
use adwave::features::{FeatureParams, features};
use adwave::filter::{Edit, Gains, Layer, Preset, WeightedLayer};
use adwave::local_fit::LocalFit;
use adwave::operator::{Diffusion, Invariant, Leap, Operator};
use adwave::region::parse_region;
use adwave::rows::CompressedRows;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::shape::VertexMap;
use adwave::{Cancelled, Decomposer, Progress};
use std::sync::Arc;

/// Rounding of some hundred products, relative to the largest value.
const ROUNDING: f64 = 1e-10;

/// Matrix of the same walk, with its diagonal.
fn matrix(cylinder: &Cylinder) -> CompressedRows<f64> {
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for x in 0..AROUND * ALONG {
        let mut row: Vec<(usize, f64)> = cylinder.sides(x).map(|y| (y, 0.125)).collect();
        row.push((x, 1.0 - 0.125 * row.len() as f64));
        row.sort_unstable_by_key(|entry| entry.0);
        for (y, w) in row {
            columns.push(y as u32);
            values.push(w);
        }
        offsets.push(columns.len());
    }
    CompressedRows::new(offsets, columns, values, AROUND * ALONG).unwrap()
}

/// The cylinder by its stencil, and by stored rows of the same walk.
fn both() -> [Decomposer; 2] {
    let cylinder = Cylinder::new(&HOLES);
    let rows = Diffusion::from_walk(&matrix(&cylinder), Progress::none()).unwrap();
    let stored = Decomposer::from_domain(cylinder.clone(), Stored(Arc::new(rows))).unwrap();
    [Decomposer::from_domain(cylinder.clone(), cylinder).unwrap(), stored]
}

/// Rows of which only the products and the rows are told.
#[derive(Debug)]
struct Stored(Arc<Diffusion>);

impl Operator for Stored {
    fn n_rows(&self) -> usize {
        self.0.n_vertices()
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn difference(&self, x: &[f64], d: usize, out: &mut [f64], _: Progress<'_>) -> Result<(), Cancelled> {
        for (row, out) in out.chunks_exact_mut(d).enumerate() {
            let (columns, values) = self.0.row(row);
            for (c, out) in out.iter_mut().enumerate() {
                let change = |(&y, w): (&u32, &f64)| w * (x[row * d + c] - x[y as usize * d + c]);
                *out = columns.iter().zip(values).map(change).sum();
            }
        }
        Ok(())
    }

    fn step_length(&self) -> f64 {
        0.5_f64.sqrt()
    }

    fn rows(&self) -> Option<&Arc<Diffusion>> {
        Some(&self.0)
    }
}

fn signal(d: usize) -> Vec<f64> {
    let noise = |i: usize| {
        let hash = (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let hash = (hash ^ (hash >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (hash >> 11) as f64 * (-53_f64).exp2() - 0.5
    };
    (0..AROUND * ALONG * d).map(|i| (i / d % AROUND / 8) as f64 + (i % d) as f64 + 0.3 * noise(i)).collect()
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let off =
        found.iter().zip(expected).map(|(a, b)| if a.is_nan() && b.is_nan() { 0.0 } else { (a - b).abs() });
    let off = off.fold(0.0, f64::max);
    assert!(off <= ROUNDING && found.len() == expected.len(), "{what}: {off:e}");
    assert!(found.iter().zip(expected).all(|(a, b)| a.is_nan() == b.is_nan()), "{what}: other gaps");
}

#[test]
fn bands_masks_and_filters_are_those_of_the_stored_walk() {
    let [own, stored] = both();
    assert!(own.operator().rows().is_none() && own.geometry().is_none() && own.shape().is_none());
    assert_eq!(own.extent(), stored.extent());
    let schedule = Schedule::dyadic(6).unwrap();
    for d in [1, 3] {
        let mut values = signal(d);
        let [a, b] = [&own, &stored].map(|domain| domain.decompose(&values, d, &schedule).unwrap());
        assert_close(&a.into_vec(), &b.into_vec(), "bands");
        for x in [3, 4, 44, 700] {
            values[x * d] = f64::NAN;
        }
        let missing = adwave::mask::missing(&values, d).unwrap();
        // Of stored rows a masked neighbor's steps go to the others; of this stencil they stay.
        let masked = own.masked(&missing).unwrap();
        let holes: Vec<usize> = HOLES.into_iter().chain([3, 4, 44, 700]).collect();
        let more = Cylinder::new(&holes);
        let more = Decomposer::from_domain(more.clone(), more).unwrap();
        let filled: Vec<f64> = values.iter().map(|v| if v.is_nan() { 0.0 } else { *v }).collect();
        let [a, b] = [(&masked, &values), (&more, &filled)]
            .map(|(domain, values)| domain.decompose(values, d, &schedule).unwrap().into_vec());
        let known = |bands: &[f64]| -> Vec<f64> {
            let is_known = |i: &usize| !missing[i / d % missing.len()];
            (0..bands.len()).filter(is_known).map(|i| bands[i]).collect()
        };
        assert_close(&known(&a), &known(&b), "masked bands");
        assert!(a.iter().enumerate().all(|(i, v)| v.is_nan() == missing[i / d % missing.len()]));
        let layer = WeightedLayer::everywhere(Preset::Suppress.gains(6));
        let [a, b] = [&own, &stored].map(|domain| {
            let values = signal(d);
            domain.request(&values, d, &schedule).filter_layers(std::slice::from_ref(&layer)).unwrap()
        });
        assert_close(&a, &b, "a filter");
    }
}

#[test]
fn regions_features_saliency_and_denoising_follow_the_neighbors_of_the_domain() {
    let [own, stored] = both();
    let (schedule, values) = (Schedule::dyadic(6).unwrap(), signal(1));
    let region = parse_region("ball:vertex=300,radius=4").unwrap();
    let layers = [Layer { gains: Gains::Gains(vec![2.0; 6]), region }];
    let [a, b] = [&own, &stored].map(|domain| {
        let mut editor = domain.request(&values, 1, &schedule).editor().unwrap();
        editor.set_edit(&Edit::new(&layers)).unwrap();
        editor.into_edited()
    });
    assert_close(&a, &b, "an edit of a ball");
    let n_changed = a.iter().zip(&values).filter(|(a, b)| a != b).count();
    assert!((20..80).contains(&n_changed), "{n_changed} places within 4 of one");
    let bump = |x: usize| {
        let away = (x / AROUND).abs_diff(12).pow(2) + (x % AROUND).abs_diff(20).pow(2);
        9.0 * (-(away as f64) / 8.0).exp()
    };
    let bumpy: Vec<f64> = values.iter().enumerate().map(|(x, v)| v + bump(x)).collect();
    let [a, b] = [&own, &stored].map(|domain| {
        let wavelets = domain.request(&bumpy, 1, &schedule).norms().unwrap();
        let map = saliency(domain, &wavelets, &SaliencyParams::default(), Progress::none()).unwrap().map;
        let found = features(domain, &wavelets, &FeatureParams::default(), Progress::none()).unwrap();
        (map, found.iter().map(|f| (f.vertex, f.level)).collect::<Vec<_>>())
    });
    assert_close(&a.0, &b.0, "saliency");
    assert!(!a.1.is_empty() && a.1 == b.1, "features {:?}", a.1);
    let clean: Vec<f64> = (0..values.len()).map(|x| (x % AROUND / 8) as f64).collect();
    let square = |f: &[f64]| f.iter().zip(&clean).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    for fit in [LocalFit::Constant, LocalFit::Linear] {
        let params = DenoiseParams::default().with_local_fit(fit);
        let found = denoise_signal(&own, &values, 1, &params, Progress::none()).unwrap();
        let ratio = square(&found.values) / square(&values);
        assert!(ratio < 0.5, "{fit:?} leaves {ratio} of the noise");
        let level = found.info[0].noise;
        assert!((0.06..0.12).contains(&level), "noise of .087 found as {level}");
    }
    let slope: Vec<f64> = (0..values.len()).map(|x| 2.0 * (x / AROUND) as f64 + 1.0).collect();
    let whole = Cylinder::new(&[]);
    let whole = Decomposer::from_domain(whole.clone(), whole).unwrap();
    let bands = whole.request(&slope, 1, &schedule).local_fit(LocalFit::Linear).bands().unwrap();
    let largest = bands.wavelets().flatten().fold(0.0_f64, |most, w| most.max(w.abs()));
    assert!(largest < 1e-9, "a linear fit changes a slope by {largest:e}");
}

/// The stencil with a way to take many steps at once.
#[derive(Clone, Debug)]
struct Leaping(Cylinder);

impl Operator for Leaping {
    fn n_rows(&self) -> usize {
        self.0.n_rows()
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn difference(&self, x: &[f64], d: usize, out: &mut [f64], p: Progress<'_>) -> Result<(), Cancelled> {
        self.0.difference(x, d, out, p)
    }

    fn leap(&self) -> Option<&dyn Leap> {
        Some(self)
    }
}

impl Leap for Leaping {
    fn take_steps(
        &self,
        n_steps: f64,
        x: &[f64],
        d: usize,
        _: f64,
        out: &mut [f64],
        p: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        let mut now = x.to_vec();
        for _ in 0..n_steps as usize {
            self.0.multiply(&now, d, out, p)?;
            now.copy_from_slice(out);
        }
        out.copy_from_slice(&now);
        Ok(1e-15)
    }
}

#[test]
fn leaps_give_the_bands_of_products() {
    let cylinder = Cylinder::new(&HOLES);
    let products = Decomposer::from_domain(cylinder.clone(), cylinder.clone()).unwrap();
    let leaps = Decomposer::from_domain(cylinder.clone(), Leaping(cylinder)).unwrap();
    let (schedule, values) = (Schedule::dyadic(7).unwrap(), signal(2));
    let [a, b] = [&leaps, &products].map(|domain| domain.decompose(&values, 2, &schedule).unwrap());
    assert_eq!((a.info.engine, b.info.engine), (Engine::Leaps, Engine::Chebyshev));
    assert!(a.info.error_bound > 0.0 && a.info.error_bound <= 1e-10, "{:?}", a.info);
    assert_close(&a.into_vec(), &b.into_vec(), "bands");
    let factors = [1.0, -0.5, 2.0, 0.0, 0.25, 1.0, 3.0];
    let [a, b] =
        [&leaps, &products].map(|domain| domain.request(&values, 2, &schedule).weighted(&factors).unwrap().0);
    assert_close(&a, &b, "a weighted sum");
    // The first band of a long wave is a small difference of large values: leaps do not have its digits, series do.
    let wave = |x: usize| 100.0 + (std::f64::consts::TAU * (x % AROUND) as f64 / AROUND as f64).cos();
    let wave: Vec<f64> = (0..AROUND * ALONG).map(wave).collect();
    let [a, b] = [&leaps, &products]
        .map(|domain| domain.request(&wave, 1, &schedule).accuracy(1e-13).bands().unwrap());
    assert_eq!((a.info.engine, b.info.engine), (Engine::Chebyshev, Engine::Chebyshev));
    assert!(a.into_vec() == b.into_vec());
    let by_products = BandsParams::default().with_engine(Engine::Chebyshev);
    let bands = leaps.request(&values, 2, &schedule).params(&by_products).bands().unwrap();
    assert_eq!(bands.info.engine, Engine::Chebyshev);
}

/// Vectors of two channels at each place of a ring that turn by a quarter on each step.
#[derive(Debug)]
struct Turning(usize);

impl Operator for Turning {
    fn n_rows(&self) -> usize {
        self.0
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn difference(&self, x: &[f64], d: usize, out: &mut [f64], _: Progress<'_>) -> Result<(), Cancelled> {
        let n = self.0;
        for i in 0..n {
            let [before, after] = [(i + n - 1) % n, (i + 1) % n];
            for c in (0..d).step_by(2) {
                let at = |row: usize| [x[row * d + c], x[row * d + c + 1]];
                let ([a, b], [e, f], [g, h]) = (at(i), at(before), at(after));
                // A vector from before turns left on its way, one from after turns right.
                out[i * d + c] = 0.25 * (a + f) + 0.25 * (a - h);
                out[i * d + c + 1] = 0.25 * (b - e) + 0.25 * (b + g);
            }
        }
        Ok(())
    }

    fn invariant(&self) -> Invariant {
        Invariant::Nothing
    }

    fn channels_at_place(&self) -> usize {
        2
    }
}

#[test]
fn vectors_that_turn_have_bands_and_come_in_pairs() {
    let transform = adwave::bands::Transform::from_operator(Turning(12), &BandsParams::default()).unwrap();
    // A field that turns with the steps is kept; one that is constant is an eigenvector to 1/2.
    let schedule = Schedule::dyadic(2).unwrap();
    let turn = |i: usize| match i % 4 {
        0 => [1.0, 0.0],
        1 => [0.0, 1.0],
        2 => [-1.0, 0.0],
        _ => [0.0, -1.0],
    };
    for (field, factors) in
        [((0..12).map(turn).collect::<Vec<_>>(), [0.0, 0.0]), (vec![[1.0, 2.0]; 12], [0.5, 0.25])]
    {
        let (mut first, mut second) = (vec![0.0; 24], vec![0.0; 24]);
        let outs: &mut [&mut [f64]] = &mut [&mut first, &mut second];
        transform.wavelets_into(field.as_flattened(), 2, &schedule, outs, Progress::none()).unwrap();
        for (band, factor) in [(first, factors[0]), (second, factors[1])] {
            let expected: Vec<f64> = field.as_flattened().iter().map(|v| factor * v).collect();
            assert_close(&band, &expected, "a band of vectors");
        }
    }
    let mut out = vec![0.0; 36];
    let outs: &mut [&mut [f64]] = &mut [&mut out];
    let one = Schedule::dyadic(1).unwrap();
    let error = transform.wavelets_into(&[0.0; 36], 3, &one, outs, Progress::none()).unwrap_err().to_string();
    assert!(error.contains("multiple of 2, got 3"), "{error}");
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let (cylinder, short) = (Cylinder::new(&[]), Turning(7));
    let error = Decomposer::from_domain(cylinder.clone(), short).unwrap_err();
    assert_eq!(error, DomainError::RowCount { n_rows: 7, n_places: AROUND * ALONG });
    let bare = WalkWithoutNeighbors(VertexMap::identity(AROUND * ALONG));
    assert_eq!(Decomposer::from_domain(bare, cylinder).unwrap_err(), DomainError::NoNeighbors);
}

#[derive(Debug)]
struct WalkWithoutNeighbors(VertexMap);

impl Domain for WalkWithoutNeighbors {
    fn vertex_map(&self) -> &VertexMap {
        &self.0
    }

    fn has_neighbors(&self) -> bool {
        false
    }
}
