//! `adwave basis`: the scaling function and the wavelet of one vertex, as fields.

use crate::args::{BasisArgs, GlobalArgs};
use crate::error::CliError;
use crate::output::{check_writable, format_of, number, print, write_shape};
use crate::progress::{with_progress, with_spinner};
use crate::shape_input::load;
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave_io::{Field, FieldValues};
use serde_json::json;
use std::time::Instant;

pub(crate) fn run(args: &BasisArgs, global: &GlobalArgs) -> Result<(), CliError> {
    format_of(&args.output)?;
    check_writable(&args.output)?;
    let schedule = Schedule::dyadic(args.level)?;
    let input = with_spinner(global, "reading", || load(&args.shape))?;
    let n_vertices = input.shape.n_vertices();
    if args.vertex >= n_vertices {
        return Err(CliError::Input(format!(
            "there is no vertex {}; {} has {n_vertices} vertices, counted from 0",
            args.vertex, input.name
        )));
    }
    let decomposer = Decomposer::new(&input.shape, &args.shape.operator());
    let start = Instant::now();
    let functions = with_progress(global, "walking", |progress| {
        decomposer.basis_of_vertex(args.vertex, &schedule, progress)
    })
    .map_err(|_| CliError::Cancelled)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut file = super::transform::fresh(&input.file);
    for (name, values) in [("phi", &functions.scaling_function), ("psi", &functions.wavelet)] {
        file.add_vertex_field(Field::new(name, 1, FieldValues::F64(values.clone())));
    }
    write_shape(global, &file, &args.output)?;
    let support = functions.scaling_function.iter().filter(|&&v| v != 0.0).count();
    let (phi, psi) = (functions.scaling_function[args.vertex], functions.wavelet[args.vertex]);
    let sigma = schedule.sigma(decomposer.diffusion().step_length())[args.level];
    let text = format!(
        "vertex {} of {}, level {}: {} steps, sigma {}\n\
         phi reaches {support} of {n_vertices} vertices; phi {} and psi {} at the vertex itself; {:.1} ms\n{}\n",
        args.vertex,
        input.name,
        args.level,
        schedule.steps()[args.level - 1],
        number(sigma),
        number(phi),
        number(psi),
        1e3 * seconds,
        args.output.display()
    );
    let json = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "vertex": args.vertex,
        "level": args.level,
        "steps": schedule.steps()[args.level - 1],
        "sigma": sigma,
        "support": support,
        "phi_at_vertex": phi,
        "psi_at_vertex": psi,
        "seconds": seconds,
    });
    print(global, &text, &json)
}
