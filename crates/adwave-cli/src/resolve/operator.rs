//! From operator flags to a shape that is prepared with its diffusion operator.

use super::signal::Signal;
use crate::args::{LevelArgs, OperatorArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::note;
use crate::output::progress::with_progress;
use adwave::mask::missing;
use adwave::operator::{CloudGraph, OperatorKind, OperatorParams, OperatorTask, choose_operator};
use adwave::shape::{Shape, VertexRole, describe_outsiders};
use adwave::{Decomposer, LevelSpec, Progress};

/// How the diffusion operator is built for a task.
pub(crate) fn operator_for_task(args: &OperatorArgs, task: OperatorTask) -> Result<OperatorParams, CliError> {
    operator_with_default(args, task.default_kind())
}

/// How the diffusion operator is built for the levels that are asked for.
pub(crate) fn operator_for_levels(
    args: &OperatorArgs,
    levels: &LevelArgs,
) -> Result<OperatorParams, CliError> {
    operator_for_spec(args, &levels.to_spec())
}

/// How the diffusion operator is built for levels.
pub(crate) fn operator_for_spec(args: &OperatorArgs, levels: &LevelSpec) -> Result<OperatorParams, CliError> {
    operator_for_task(args, levels.operator_task())
}

/// How the diffusion operator is built, of the kind `default` if neither a kind nor an option of the walk is asked for.
pub(crate) fn operator_with_default(
    args: &OperatorArgs,
    default: OperatorKind,
) -> Result<OperatorParams, CliError> {
    let (walk, unchanged) = (args.to_walk_params(), OperatorParams::default());
    if args.directed && args.density_invariant {
        return Err(CliError::Input(
            "--density-invariant needs steps in both directions; leave out --directed".to_owned(),
        ));
    }
    let walk_options = [
        ("--rings", walk.rings != unchanged.rings),
        ("--mesh-area", walk.mesh_area != unchanged.mesh_area),
        ("--directed", walk.cloud_graph != unchanged.cloud_graph),
        ("--cloud-area", walk.cloud_area != unchanged.cloud_area),
        ("--density-invariant", walk.density_invariant),
    ];
    let asked = walk_options.iter().find(|(_, is_asked)| *is_asked).map(|(option, _)| *option);
    let kind = choose_operator(args.operator, default, asked)
        .map_err(|error| CliError::Input(format!("{error} (--operator walk)")))?;
    Ok(walk.with_kind(kind))
}

/// A shape with its diffusion operator.
pub(crate) fn prepare(
    global: &Global<'_>,
    shape: &Shape,
    params: &OperatorParams,
) -> Result<Decomposer, CliError> {
    check_operator(shape, params)?;
    let decomposer = with_progress(global, "preparing", |progress| build_operator(shape, params, progress))?;
    let outsiders = decomposer.geometry().outsiders();
    for role in [VertexRole::Placeholder, VertexRole::Stray] {
        if let Some(text) = describe_outsiders(&outsiders, role) {
            note(global, &text);
        }
    }
    Ok(decomposer)
}

/// A shape with its diffusion operator, for a signal: vertices where the signal is NaN are masked.
pub(crate) fn prepare_for_signal(
    global: &Global<'_>,
    shape: &Shape,
    params: &OperatorParams,
    signal: &Signal,
    name: &str,
) -> Result<Decomposer, CliError> {
    mask_missing(prepare(global, shape, params)?, signal, name, global)
}

/// Refuses options that do not go with the shape, and neighborhoods that need more memory than is free.
pub(crate) fn check_operator(shape: &Shape, params: &OperatorParams) -> Result<(), CliError> {
    if params.keep_creases && matches!(shape, Shape::Graph(_)) {
        return Err(CliError::Input(
            "--keep-creases needs normals, and a graph has none; leave it out".to_owned(),
        ));
    }
    if params.cloud_graph == CloudGraph::Directed {
        let what = match shape {
            Shape::Cloud(_) => "",
            Shape::Graph(_) => "a graph is walked by its symmetric weights, (M + Mᵀ)/2 of a matrix M",
            Shape::Mesh(_) => "a mesh is walked along its edges in both directions",
        };
        if !what.is_empty() {
            return Err(CliError::Input(format!("--directed needs a cloud, but {what}; leave it out")));
        }
    }
    adwave_io::free_memory().map_or(Ok(()), |free| check_neighbors(shape, params, free))
}

/// Builds the operator.
pub(crate) fn build_operator(
    shape: &Shape,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<Decomposer, CliError> {
    Decomposer::with_params(shape, params, progress).map_err(|_| CliError::Cancelled)
}

/// Masks the vertices where the signal is NaN, with a note.
pub(crate) fn mask_missing(
    decomposer: Decomposer,
    signal: &Signal,
    name: &str,
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    let Some(flags) = missing(&signal.values, signal.n_channels) else { return Ok(decomposer) };
    let masked = decomposer.masked(&flags).map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    let n_missing = flags.iter().filter(|&&is_missing| is_missing).count();
    note(global, &format!("{name} is NaN at {n_missing} of {} vertices, which are masked", flags.len()));
    Ok(masked)
}

/// Refuses neighborhoods that take more memory than `free` bytes.
fn check_neighbors(shape: &Shape, params: &OperatorParams, free: u64) -> Result<(), CliError> {
    /// Bytes of a neighbor: its number and weight, in the operator and while it is built.
    const BYTES: u64 = 24;
    let n = shape.n_vertices() as u64;
    let (flag, n_neighbors) = match shape {
        Shape::Cloud(_) => (format!("--neighbors {}", params.neighbors), params.neighbors as u64),
        // r rings around a vertex with six neighbors have 3·r·(r + 1) vertices.
        Shape::Mesh(_) => {
            let r = params.rings as u64;
            (format!("--rings {r}"), r.saturating_add(1).saturating_mul(r).saturating_mul(3))
        }
        Shape::Graph(_) => return Ok(()),
    };
    let bytes = n_neighbors.min(n).saturating_mul(n).saturating_mul(BYTES);
    if bytes <= free {
        return Ok(());
    }
    let gib = |bytes: u64| bytes as f64 / (1_u64 << 30) as f64;
    Err(CliError::Input(format!(
        "{flag} needs about {:.0} GiB for {n} vertices, and {:.1} GiB are free; choose a smaller number",
        gib(bytes),
        gib(free)
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::shape::PointCloud;

    #[test]
    fn neighborhoods_that_do_not_fit_are_refused_with_numbers() {
        let cloud = Shape::Cloud(PointCloud::new(vec![[0.0; 3]; 100_000]).unwrap());
        let params = OperatorParams::default().with_neighbors(5000);
        let error = check_neighbors(&cloud, &params, 8 << 30).unwrap_err().to_string();
        assert_eq!(
            error,
            "--neighbors 5000 needs about 11 GiB for 100000 vertices, and 8.0 GiB are free; choose a smaller number"
        );
        assert!(check_neighbors(&cloud, &params, 12 << 30).is_ok());
        assert!(check_neighbors(&cloud, &OperatorParams::default(), 8 << 30).is_ok());
    }
}
