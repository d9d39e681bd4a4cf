//! Times operations on one mesh on request, so that a harness can alternate between adwave and other programs.
//!
//! `timing_on_request FOLDER` reads `points.f64` (n × 3) and `triangles.u32` (m × 3), both little-endian, builds the
//! diffusion operator and prints a line of JSON. Then every line of the standard input is a request, answered by one
//! line of JSON:
//!
//! | request | answer |
//! |---|---|
//! | `operator DIR` | writes Φ₁ without its diagonal, in the order of the analysis, and the number of each vertex there |
//! | `basis LEVELS [DIR]` | seconds, entries, bytes; writes the matrices in the order of the mesh |
//! | `bands LEVELS ACCURACY` | seconds of all bands of xyz into ready memory by a prepared transform |
//! | `bits LEVELS ACCURACY CHANNELS` | a hash of all bands of that many channels, which compares two builds |
//! | `decompose LEVELS ACCURACY [DIR]` | the bands as one call from the operator in the order of the mesh; writes them |
//! | `filter LEVELS ACCURACY` | one filter with one gain per band, as one call |
//! | `wavelet VERTEX LEVEL [DIR]` | φ and ψ of one vertex of the mesh |
//! | `triad`, `product` | bandwidth of `a = b + s·c`; one product with Φ₁ and the bytes it must move |
//! | `memory LEVELS ACCURACY CHANNELS` | bytes beyond input and output, counted and as the system sees them |
//! | `against_powers LEVELS ACCURACY`, `against LEVELS ACCURACY REFERENCE` | relative error of each band |
//!
//! Seconds are those of one call, by a monotonic clock; `peak` is the largest amount of memory used during a request
//! beyond the amount before it.

use adwave::Progress;
use adwave::bands::{BandsParams, Engine, Schedule, Transform};
use adwave::basis::{BasisParams, basis, one_vertex};
use adwave::operator::{Diffusion, OperatorParams, local_operator};
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
use adwave::sparse::apply;
use adwave_bench_helpers::triad;
use std::collections::HashMap;
use std::error::Error;
use std::io::{BufRead, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

type Answer = Result<String, Box<dyn Error>>;

struct TimedShape {
    shape: Shape,
    geometry: PreparedGeometry,
    diffusion: Arc<Diffusion>,
}

impl TimedShape {
    fn read(folder: &Path) -> Result<(Self, f64), Box<dyn Error>> {
        let points = read_all(&folder.join("points.f64"), f64::from_le_bytes)?;
        let triangles = read_all(&folder.join("triangles.u32"), u32::from_le_bytes)?;
        let (points, triangles) = (points.as_chunks::<3>().0.to_vec(), triangles.as_chunks::<3>().0.to_vec());
        let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles))?);
        let start = Instant::now();
        // A row for each vertex, so that all programs get matrices of one size.
        let geometry = PreparedGeometry::new(&shape, WeldMode::Off, Progress::none())?;
        let diffusion = Arc::new(Diffusion::new(
            local_operator(&geometry, &OperatorParams::default(), Progress::none())?,
            Progress::none(),
        )?);
        Ok((Self { shape, geometry, diffusion }, start.elapsed().as_secs_f64()))
    }

    fn signal(&self) -> &[f64] {
        self.geometry.points().as_flattened()
    }

    fn n(&self) -> usize {
        self.diffusion.n_vertices()
    }

    fn wavelets(&self, transform: &Transform, levels: usize, outs: &mut [Vec<f64>]) -> Answer {
        let mut outs: Vec<&mut [f64]> = outs.iter_mut().map(Vec::as_mut_slice).collect();
        let (schedule, start) = (Schedule::dyadic(levels)?, Instant::now());
        let info = transform.wavelets_into(self.signal(), 3, &schedule, &mut outs, Progress::none())?;
        let seconds = start.elapsed().as_secs_f64();
        // Unfused, a product reads the walk and two vectors and writes one; a term reads two vectors and writes one.
        let entries = self.diffusion.weights().len() as u64;
        let n = self.n() as u64;
        let unfused = info.products * (12 * entries + 80 * n) + info.terms * 72 * n;
        Ok(format!(
            r#"{{"seconds":{seconds},"degree":{},"products":{},"terms":{},"error_bound":{:e},"unfused_bytes":{unfused}}}"#,
            info.degree, info.products, info.terms, info.error_bound
        ))
    }
}

/// Reads all values of a file of little-endian numbers.
fn read_all<T, const N: usize>(path: &Path, value: fn([u8; N]) -> T) -> std::io::Result<Vec<T>> {
    Ok(std::fs::read(path)?.as_chunks::<N>().0.iter().map(|bytes| value(*bytes)).collect())
}

fn write_all<const N: usize>(path: &Path, values: impl Iterator<Item = [u8; N]>) -> std::io::Result<()> {
    let mut out = std::io::BufWriter::new(std::fs::File::create(path)?);
    values.into_iter().try_for_each(|bytes| out.write_all(&bytes))?;
    out.flush()
}

fn write_rows(folder: &str, name: &str, offsets: &[usize], columns: &[u32]) -> std::io::Result<()> {
    let folder = Path::new(folder);
    std::fs::create_dir_all(folder)?;
    write_all(&folder.join(format!("{name}offsets.i64")), offsets.iter().map(|&o| (o as u64).to_le_bytes()))?;
    write_all(&folder.join(format!("{name}columns.u32")), columns.iter().map(|c| c.to_le_bytes()))
}

fn params(accuracy: f64) -> BandsParams {
    BandsParams::default().with_accuracy(accuracy)
}

fn outputs(levels: usize, len: usize) -> Vec<Vec<f64>> {
    // Ones, so that the memory is allocated before the clock starts.
    (0..levels).map(|_| vec![1.0; len]).collect()
}

fn operator(subject: &TimedShape, folder: &str) -> Answer {
    let walk = &subject.diffusion;
    write_rows(folder, "", walk.neighbors().offsets(), walk.neighbors().columns())?;
    let folder = Path::new(folder);
    write_all(&folder.join("values.f64"), walk.weights().iter().map(|w| w.to_le_bytes()))?;
    write_all(&folder.join("stationary.f64"), walk.stationary().iter().map(|p| p.to_le_bytes()))?;
    write_all(
        &folder.join("number.u32"),
        subject.geometry.vertex_map().as_slice().iter().map(|c| c.to_le_bytes()),
    )?;
    Ok(r#"{"written":true}"#.into())
}

fn explicit(subject: &TimedShape, levels: usize, folder: Option<&str>) -> Answer {
    let params = BasisParams::new(Schedule::dyadic(levels)?);
    let start = Instant::now();
    let result = basis(&subject.diffusion, &params, Progress::none())?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some(folder) = folder {
        let ordered = result.to_shape_order(subject.geometry.vertex_map())?;
        for (level, matrix) in (1..).zip(&ordered.scaling) {
            write_rows(folder, &format!("{level}-"), matrix.offsets(), matrix.columns())?;
            let path = Path::new(folder).join(format!("{level}-values.f32"));
            write_all(&path, matrix.values().iter().map(|v| v.to_le_bytes()))?;
        }
    }
    Ok(format!(
        r#"{{"seconds":{seconds},"nnz":{:?},"bytes":{}}}"#,
        result.info.nnz,
        result.info.bytes.iter().sum::<u64>()
    ))
}

fn one_call(subject: &TimedShape, levels: usize, accuracy: f64, folder: Option<&str>) -> Answer {
    let signal = subject.shape.points().ok_or("a mesh has points")?.as_flattened();
    let (vertex_map, schedule) = (subject.geometry.vertex_map(), Schedule::dyadic(levels)?);
    let start = Instant::now();
    let params = params(accuracy);
    let transform = Transform::new(Arc::clone(&subject.diffusion), &params)?;
    let bands = transform.bands(vertex_map, signal, 3, &schedule, Progress::none())?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some(folder) = folder {
        std::fs::create_dir_all(folder)?;
        let path = Path::new(folder).join("wavelets.f64");
        write_all(&path, bands.wavelets().flatten().map(|w| w.to_le_bytes()))?;
    }
    Ok(format!(r#"{{"seconds":{seconds}}}"#))
}

fn filter(subject: &TimedShape, levels: usize, accuracy: f64) -> Answer {
    let signal = subject.shape.points().ok_or("a mesh has points")?.as_flattened();
    let (vertex_map, schedule) = (subject.geometry.vertex_map(), Schedule::dyadic(levels)?);
    let factors: Vec<f64> = (1..=levels).map(|j| if j % 2 == 0 { -1.0 } else { 0.5 }).collect();
    let start = Instant::now();
    let params = params(accuracy);
    let transform = Transform::new(Arc::clone(&subject.diffusion), &params)?;
    let added = transform.weighted(vertex_map, signal, 3, &schedule, &factors, Progress::none())?.0;
    let filtered: Vec<f64> = signal.iter().zip(&added).map(|(f, w)| f + w).collect();
    let seconds = start.elapsed().as_secs_f64();
    Ok(format!(r#"{{"seconds":{seconds},"n":{}}}"#, filtered.len()))
}

fn wavelet(subject: &TimedShape, vertex: usize, level: u32, folder: Option<&str>) -> Answer {
    let steps = 1_u64 << (level - 1);
    let welded = subject.geometry.vertex_map().as_slice();
    let at = *welded.get(vertex).ok_or("the vertex must exist")? as usize;
    let start = Instant::now();
    let found = one_vertex(&subject.diffusion, at, steps / 2, steps, 1e-9, Progress::none())?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some(folder) = folder {
        std::fs::create_dir_all(folder)?;
        let dense = found.wavelet.to_dense(subject.n());
        let in_mesh_order = welded.iter().map(|&class| dense[class as usize].to_le_bytes());
        write_all(&Path::new(folder).join("wavelet.f64"), in_mesh_order)?;
    }
    Ok(format!(r#"{{"seconds":{seconds},"nnz":{}}}"#, found.wavelet.columns.len()))
}

fn bandwidth() -> String {
    let (bytes, threads) = (triad(), rayon::current_num_threads());
    format!(r#"{{"bytes_per_second":{bytes},"threads":{threads}}}"#)
}

fn product(subject: &TimedShape, out: &mut Vec<f64>) -> String {
    out.resize(subject.signal().len(), 0.0);
    let start = Instant::now();
    apply(&subject.diffusion, subject.signal(), out, 3);
    let seconds = start.elapsed().as_secs_f64();
    // Weights, columns, row ends; the signal in and out.
    let bytes = 12 * subject.diffusion.weights().len() + 8 * subject.n() + 48 * subject.n();
    format!(r#"{{"seconds":{seconds},"bytes":{bytes}}}"#)
}

/// Number of kilobytes from `/proc/self/status`, in bytes.
fn status(field: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with(field))?;
    Some(1024 * line.split_whitespace().nth(1)?.parse::<u64>().ok()?)
}

/// Resets the highest memory use to the present one and returns it; `None` if the system cannot.
fn reset_peak() -> Option<u64> {
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    status("VmRSS:")
}

fn memory(subject: &TimedShape, levels: usize, accuracy: f64, channels: usize) -> Answer {
    let xyz = subject.signal();
    let signal: Vec<f64> =
        (0..subject.n() * channels).map(|i| xyz[3 * (i / channels) + i % channels % 3]).collect();
    let (mut wavelets, schedule) = (outputs(levels, signal.len()), Schedule::dyadic(levels)?);
    let mut outs: Vec<&mut [f64]> = wavelets.iter_mut().map(Vec::as_mut_slice).collect();
    let before = reset_peak();
    let transform = Transform::new(Arc::clone(&subject.diffusion), &params(accuracy))?;
    let info = transform.wavelets_into(&signal, channels, &schedule, &mut outs, Progress::none())?;
    let walk = subject.diffusion.bytes();
    let seen = before.zip(status("VmHWM:")).map(|(before, peak)| peak.saturating_sub(before) + walk);
    let seen = seen.map_or("null".into(), |bytes| bytes.to_string());
    Ok(format!(r#"{{"counted":{},"seen":{seen},"walk":{walk},"n":{}}}"#, info.bytes, subject.n()))
}

/// FNV-1a over the bits of all bands of a signal of `channels` channels: coordinates in turn, distorted so that no
/// two are equal.
fn bits(subject: &TimedShape, levels: usize, accuracy: f64, channels: usize) -> Answer {
    let xyz = subject.signal();
    let value = |i: usize| xyz[3 * (i / channels) + i % channels % 3] * (1.0 + (i % channels) as f64).sqrt();
    let signal: Vec<f64> = (0..subject.n() * channels).map(value).collect();
    let (mut wavelets, schedule) = (outputs(levels, signal.len()), Schedule::dyadic(levels)?);
    let mut outs: Vec<&mut [f64]> = wavelets.iter_mut().map(Vec::as_mut_slice).collect();
    let transform = Transform::new(Arc::clone(&subject.diffusion), &params(accuracy))?;
    let info = transform.wavelets_into(&signal, channels, &schedule, &mut outs, Progress::none())?;
    let hash = wavelets
        .iter()
        .flatten()
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, w| (hash ^ w.to_bits()).wrapping_mul(0x0100_0000_01b3));
    Ok(format!(
        r#"{{"hash":"{hash:016x}","error_bound":{:e},"products":{}}}"#,
        info.error_bound, info.products
    ))
}

/// `max ‖w − e‖ / ‖e‖` per band, with plain norms and norms weighted by π; the larger one.
fn errors(subject: &TimedShape, levels: usize, accuracy: f64, reference: &Transform) -> Answer {
    let (mut ours, mut exact) =
        (outputs(levels, subject.signal().len()), outputs(levels, subject.signal().len()));
    subject.wavelets(
        &Transform::new(Arc::clone(&subject.diffusion), &params(accuracy))?,
        levels,
        &mut ours,
    )?;
    subject.wavelets(reference, levels, &mut exact)?;
    let pi = subject.diffusion.stationary();
    let relative = |w: &[f64], e: &[f64], weight: &dyn Fn(usize) -> f64| {
        let (mut error, mut square) = (0.0, 0.0);
        for (i, (w, e)) in w.iter().zip(e).enumerate() {
            error += weight(i / 3) * (w - e).powi(2);
            square += weight(i / 3) * e * e;
        }
        (error / square).sqrt()
    };
    let errors: Vec<String> = ours
        .iter()
        .zip(&exact)
        .map(|(w, e)| format!("{:e}", relative(w, e, &|_| 1.0).max(relative(w, e, &|x| pi[x]))))
        .collect();
    Ok(format!(r#"{{"relative":[{}]}}"#, errors.join(",")))
}

/// State state between requests: transforms by the bits of their accuracy, and outputs.
struct RequestState {
    transforms: HashMap<u64, Transform>,
    outs: Vec<Vec<f64>>,
    product: Vec<f64>,
}

fn answer(subject: &TimedShape, state: &mut RequestState, words: &[&str]) -> Answer {
    match *words {
        ["operator", folder] => operator(subject, folder),
        ["basis", levels] => explicit(subject, levels.parse()?, None),
        ["basis", levels, folder] => explicit(subject, levels.parse()?, Some(folder)),
        ["bands", levels, accuracy] => {
            let (levels, accuracy): (usize, f64) = (levels.parse()?, accuracy.parse()?);
            if let std::collections::hash_map::Entry::Vacant(free) =
                state.transforms.entry(accuracy.to_bits())
            {
                free.insert(Transform::new(Arc::clone(&subject.diffusion), &params(accuracy))?);
            }
            if state.outs.len() != levels {
                state.outs = outputs(levels, subject.signal().len());
            }
            subject.wavelets(&state.transforms[&accuracy.to_bits()], levels, &mut state.outs)
        }
        ["decompose", levels, accuracy] => one_call(subject, levels.parse()?, accuracy.parse()?, None),
        ["decompose", levels, accuracy, folder] => {
            one_call(subject, levels.parse()?, accuracy.parse()?, Some(folder))
        }
        ["filter", levels, accuracy] => filter(subject, levels.parse()?, accuracy.parse()?),
        ["wavelet", vertex, level] => wavelet(subject, vertex.parse()?, level.parse()?, None),
        ["wavelet", vertex, level, folder] => wavelet(subject, vertex.parse()?, level.parse()?, Some(folder)),
        ["triad"] => Ok(bandwidth()),
        ["product"] => Ok(product(subject, &mut state.product)),
        ["memory", levels, accuracy, channels] => {
            state.transforms.clear();
            memory(subject, levels.parse()?, accuracy.parse()?, channels.parse()?)
        }
        ["bits", levels, accuracy, channels] => {
            bits(subject, levels.parse()?, accuracy.parse()?, channels.parse()?)
        }
        ["against_powers", levels, accuracy] => {
            let powers = BandsParams::default().with_engine(Engine::Powers);
            errors(
                subject,
                levels.parse()?,
                accuracy.parse()?,
                &Transform::new(Arc::clone(&subject.diffusion), &powers)?,
            )
        }
        ["against", levels, accuracy, reference] => {
            let finer = Transform::new(Arc::clone(&subject.diffusion), &params(reference.parse()?))?;
            errors(subject, levels.parse()?, accuracy.parse()?, &finer)
        }
        _ => Err(format!("unknown request: {}", words.join(" ")).into()),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder =
        std::env::args().nth(1).ok_or("usage: timing_on_request FOLDER, then requests line by line")?;
    let (subject, seconds) = TimedShape::read(folder.as_ref())?;
    println!(
        r#"{{"n":{},"nnz":{},"operator_seconds":{seconds},"walk_bytes":{}}}"#,
        subject.n(),
        subject.diffusion.nnz(),
        subject.diffusion.bytes()
    );
    let mut state = RequestState { transforms: HashMap::new(), outs: Vec::new(), product: Vec::new() };
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let before = reset_peak();
        match answer(&subject, &mut state, &words) {
            Ok(answer) => {
                let peak = before.zip(status("VmHWM:")).map(|(before, peak)| peak.saturating_sub(before));
                let peak = peak.map_or("null".into(), |bytes| bytes.to_string());
                println!("{},\"peak\":{peak}}}", answer.trim_end_matches('}'));
            }
            Err(error) => println!(r#"{{"error":{:?}}}"#, error.to_string()),
        }
    }
    Ok(())
}
