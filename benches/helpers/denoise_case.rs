//! Noise and denoising of meshes, one step per call, for `benches/denoise`:
//!
//!     denoise_case noise normal|isotropic|impulsive|scanner SIGMA SEED IN OUT denoise_case bilateral SIGMA_S NORMAL_ROUNDS VERTEX_ROUNDS IN OUT denoise_case guided SIGMA_R NORMAL_ROUNDS VERTEX_ROUNDS IN OUT denoise_case sinc PASS_BAND DEGREE IN OUT
//!
//! A parameter `-` selects the default. Prints the seconds of the step itself, without reading and writing.

use adwave::Progress;
use adwave::shape::{Mesh, PreparedGeometry, Shape, WeldMode};
use adwave_baselines::differential::{Differential, Weights};
use adwave_baselines::normal_filter::{
    BilateralParams, GuidedParams, NormalScheme, bilateral_normals, guided_normals,
};
use adwave_baselines::taubin::WindowedSinc;
use adwave_bench_helpers::Noise;
use adwave_io::{ReadLimits, read_path, write_path};
use std::error::Error;
use std::path::Path;
use std::str::FromStr;
use std::time::Instant;

type CaseOutcome<T> = Result<T, Box<dyn Error>>;

fn main() -> CaseOutcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [step, parameters @ .., input, output] = &words[..] else {
        return Err("usage: denoise_case STEP [PARAMETERS …] IN OUT".into());
    };
    let mut file = read_path(Path::new(input), &ReadLimits::default())?;
    let shape = file.to_shape()?;
    let Some(mesh) = shape.as_mesh() else { return Err("the shape must be a mesh".into()) };
    let start = Instant::now();
    let points = result(step, parameters, &shape, mesh)?;
    println!("{}", start.elapsed().as_secs_f64());
    file.set_points(points)?;
    write_path(&file, Path::new(output), None)?;
    Ok(())
}

fn result(step: &str, parameters: &[String], shape: &Shape, mesh: &Mesh) -> CaseOutcome<Vec<[f64; 3]>> {
    let none = Progress::none();
    let prepared = || PreparedGeometry::new(shape, WeldMode::default(), none);
    Ok(match (step, parameters) {
        ("noise", [kind, sigma, seed]) => {
            let kind = Noise::from_name(kind).ok_or_else(|| format!("unknown noise '{kind}'"))?;
            kind.apply(mesh, sigma.parse()?, seed.parse()?)
        }
        ("bilateral", [sigma_s, normals, vertices]) => {
            let default = BilateralParams::default();
            let params = default
                .with_sigma_s(parse_or_default(sigma_s, default.sigma_s)?)
                .with_scheme(NormalScheme::Local { iterations: parse_or_default(normals, 20)? })
                .with_vertex_iterations(parse_or_default(vertices, default.vertex_iterations)?);
            bilateral_normals(&prepared()?, &params, none)?
        }
        ("guided", [sigma_r, normals, vertices]) => {
            let default = GuidedParams::default();
            let params = default
                .with_sigma_r(parse_or_default(sigma_r, default.sigma_r)?)
                .with_normal_iterations(parse_or_default(normals, default.normal_iterations)?)
                .with_vertex_iterations(parse_or_default(vertices, default.vertex_iterations)?);
            guided_normals(&prepared()?, &params, none)?
        }
        ("sinc", [pass_band, degree]) => {
            let filter = WindowedSinc::new(parse_or_default(pass_band, 0.1)?, parse_or_default(degree, 20)?)?;
            let k = Differential::new(shape, Weights::Uniform)?;
            filter.apply(&k, mesh.points().as_flattened(), 3)?.as_chunks().0.to_vec()
        }
        _ => {
            return Err(
                format!("'{step}' does not exist or does not take {} parameters", parameters.len()).into()
            );
        }
    })
}

fn parse_or_default<T: FromStr<Err: Error + 'static>>(word: &str, default: T) -> CaseOutcome<T> {
    if word == "-" { Ok(default) } else { Ok(word.parse()?) }
}
