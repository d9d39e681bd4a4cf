//! From operator flags to a shape that is prepared with its diffusion operator.

use super::applicable::check_operator_options;
use super::shape::{Carrier, Input};
use super::signal::Signal;
use super::walk::in_file;
use crate::args::{LevelArgs, OperatorArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, note, number};
use adwave::mask::{MaskedChannels, channels_by_mask, missing};
use adwave::operator::{CloudGraph, OperatorKind, OperatorParams, OperatorTask, choose_operator};
use adwave::shape::{PreparedGeometry, Shape, VertexRole, describe_outsiders};
use adwave::signal::CloseSheets;
use adwave::{Decomposer, LevelSpec, Progress};

/// Parameters of the diffusion operator for a task.
pub(crate) fn operator_for_task(args: &OperatorArgs, task: OperatorTask) -> Result<OperatorParams, CliError> {
    operator_with_default(args, task.default_kind())
}

/// Parameters of the diffusion operator for the levels that the flags ask for.
pub(crate) fn operator_for_levels(
    args: &OperatorArgs,
    levels: &LevelArgs,
) -> Result<OperatorParams, CliError> {
    operator_for_spec(args, &levels.to_spec())
}

/// Parameters of the diffusion operator for a map or features of a shape: on a mesh the surface decides, not its
/// triangles.
pub(crate) fn operator_for_analysis(
    args: &OperatorArgs,
    levels: &LevelArgs,
    shape: &Shape,
) -> Result<OperatorParams, CliError> {
    operator_for_task(args, levels.to_spec().analysis_task(shape))
}

/// Parameters of the diffusion operator for levels.
pub(crate) fn operator_for_spec(args: &OperatorArgs, levels: &LevelSpec) -> Result<OperatorParams, CliError> {
    operator_for_task(args, levels.operator_task())
}

/// Parameters of the diffusion operator, of the kind `default` if neither a kind nor an option of the walk is asked
/// for.
pub(crate) fn operator_with_default(
    args: &OperatorArgs,
    default: OperatorKind,
) -> Result<OperatorParams, CliError> {
    if args.directed && args.density_invariant {
        return Err(CliError::Input(
            "--density-invariant needs steps in both directions; leave out --directed".to_owned(),
        ));
    }
    let kind = choose_operator(args.operator, default, args.changed_walk_option())
        .map_err(|error| CliError::Input(format!("{error} (--operator walk)")))?;
    Ok(args.to_walk_params().with_kind(kind))
}

/// A shape with its diffusion operator.
pub(crate) fn prepare(
    global: &Global<'_>,
    input: &Input,
    params: &OperatorParams,
) -> Result<Decomposer, CliError> {
    check_operator(&input.shape, params, global)?;
    let build = |progress: Progress<'_>| build_decomposer(input, params, progress);
    let decomposer = with_progress(global, "preparing", build)?;
    note_outsiders(decomposer.geometry(), input, global);
    Ok(decomposer)
}

/// Prints notes on placeholders and strays, with their rows in the file, on vertices that were welded although their
/// positions differ, and on given normals whose signs were changed or are not used.
pub(crate) fn note_outsiders(geometry: Option<&PreparedGeometry>, input: &Input, global: &Global<'_>) {
    let Some(geometry) = geometry else { return };
    if let Some(seams) = geometry.seams() {
        let text = format!(
            "{} within {} of another, along open borders that nearly coincide; they are welded (--weld 0 keeps them apart)",
            count(seams.n_vertices, "vertex is", "vertices are"),
            number(seams.distance)
        );
        note(global, &text);
    }
    let outsiders: Vec<(usize, VertexRole)> = (geometry.outsiders().into_iter())
        .map(|(vertex, role)| (input.file.file_row(vertex), role))
        .collect();
    for role in [VertexRole::Placeholder, VertexRole::Stray] {
        if let Some(text) = describe_outsiders(&outsiders, role) {
            note(global, &text);
        }
    }
    if let Some(text) = geometry.given_normals().and_then(|given| given.check.describe()) {
        note(global, &text);
    }
}

/// Warns that points of a cloud have neighbors on two surfaces, which an edit of the positions joins.
pub(crate) fn note_close_sheets(sheets: Option<CloseSheets>, global: &Global<'_>) {
    let Some(sheets) = sheets else { return };
    let text =
        format!("{}, and these surfaces are joined; {KEEP_SHEETS_APART}", describe_close_sheets(sheets));
    note(global, &text);
}

/// Warns that points of a cloud have neighbors on two surfaces, and tells how far apart these are after an edit.
pub(crate) fn note_moved_sheets(before: CloseSheets, after: Option<CloseSheets>, global: &Global<'_>) {
    let outcome = match after {
        Some(after) => {
            format!("afterwards {:.0} % do, about {}", 100.0 * after.share, number(after.distance))
        }
        None => "afterwards none do: the surfaces were joined".to_owned(),
    };
    note(global, &format!("{}; {outcome}; {KEEP_SHEETS_APART}", describe_close_sheets(before)));
}

/// Advice for clouds with surfaces closer than their points.
const KEEP_SHEETS_APART: &str = "normals that point outwards (nx, ny, nz) keep them apart";

fn describe_close_sheets(sheets: CloseSheets) -> String {
    format!(
        "{:.0} % of the points lie between two surfaces about {} apart, which is closer than their neighbors",
        100.0 * sheets.share,
        number(sheets.distance)
    )
}

/// A signal split into channels that are NaN at the same vertices, with a decomposer that masks these, so that a gap in
/// one channel leaves the others alone.
pub(crate) struct SignalParts {
    parts: Vec<SignalPart>,
    n_channels: usize,
}

/// Channels of a signal that are NaN at the same vertices.
pub(crate) struct SignalPart {
    channels: MaskedChannels,
    pub(crate) decomposer: Decomposer,
}

impl SignalParts {
    /// Splits a signal, with a note on the masked vertices. Channels without any value stay as they are if others have
    /// values.
    pub(crate) fn new(
        decomposer: &Decomposer,
        signal: &Signal,
        name: &str,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        let n_channels = signal.n_channels;
        let groups = channels_by_mask(&signal.values, n_channels);
        if let ([_, _, ..], n_vertices) = (&groups[..], decomposer.n_vertices()) {
            let n_missing = |group: &MaskedChannels| {
                group
                    .missing
                    .as_ref()
                    .map_or(0, |flags| flags.iter().filter(|&&is_missing| is_missing).count())
            };
            let most = groups.iter().map(n_missing).max().unwrap_or_default();
            let text = format!(
                "{name} is NaN at other vertices in each of {} groups of channels, at most {most} of {n_vertices}; each is \
                 masked where it is NaN",
                groups.len()
            );
            note(global, &text);
        }
        let is_single = groups.len() == 1;
        let mut parts = Vec::with_capacity(groups.len());
        for channels in groups {
            let masked = match &channels.missing {
                None => decomposer.clone(),
                Some(_) if is_single => mask_missing(decomposer.clone(), signal, name, global)?,
                Some(flags) => {
                    decomposer.masked(flags).map_err(|e| CliError::Input(format!("{name}: {e}")))?
                }
            };
            parts.push(SignalPart { channels, decomposer: masked });
        }
        Ok(Self { parts, n_channels })
    }

    /// The part of the first channel.
    pub(crate) fn first(&self) -> &SignalPart {
        &self.parts[0]
    }

    /// New values of a signal, computed part by part from the values of its channels and their number.
    pub(crate) fn map(
        &self,
        values: &[f64],
        mut compute: impl FnMut(&SignalPart, &[f64], usize) -> Result<Vec<f64>, CliError>,
    ) -> Result<Vec<f64>, CliError> {
        if let [part] = &self.parts[..]
            && part.channels.channels.len() == self.n_channels
        {
            return compute(part, values, self.n_channels);
        }
        let mut result = values.to_vec();
        for part in &self.parts {
            let own = part.channels.select(values, self.n_channels);
            let new = compute(part, &own, part.channels.channels.len())?;
            part.channels.place(&new, &mut result, self.n_channels);
        }
        Ok(result)
    }
}

impl SignalPart {
    /// Indices of its channels in the signal.
    pub(crate) fn channels(&self) -> &[usize] {
        &self.channels.channels
    }
}

/// A shape with its diffusion operator, for a signal: vertices where the signal is NaN are masked.
pub(crate) fn prepare_for_signal(
    global: &Global<'_>,
    input: &Input,
    params: &OperatorParams,
    signal: &Signal,
    name: &str,
) -> Result<Decomposer, CliError> {
    mask_missing(prepare(global, input, params)?, signal, name, global)
}

/// Refuses options that do not go with the shape, and neighborhoods that need more memory than is free.
pub(crate) fn check_operator(
    shape: &Shape,
    params: &OperatorParams,
    global: &Global<'_>,
) -> Result<(), CliError> {
    check_operator_options(shape, params, global)?;
    if params.keep_creases && shape.is_graph() {
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

/// The domain of an input with its operator: a domain of the program's own, a walk that was given, or the shape's own.
pub(crate) fn build_decomposer(
    input: &Input,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<Decomposer, CliError> {
    match &input.carrier {
        Carrier::Shape => {
            let params = params.with_corrected_dispersion(input.file.is_map());
            build_operator(&input.shape, &params, progress)
        }
        Carrier::Walk(walk) => build_operator(&input.shape, params, progress)?
            .with_walk(&walk.rows, progress)
            .map_err(|e| in_file(&walk.path, &e)),
        Carrier::Own(domain) => Ok(domain.clone()),
    }
}

/// Builds the operator of a shape.
pub(crate) fn build_operator(
    shape: &Shape,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<Decomposer, CliError> {
    Decomposer::with_params(shape, params, progress).map_err(|_| CliError::Cancelled)
}

/// Masks the vertices where the signal is NaN, with a note unless these are known.
pub(crate) fn mask_missing(
    decomposer: Decomposer,
    signal: &Signal,
    name: &str,
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    let Some(flags) = missing(&signal.values, signal.n_channels) else { return Ok(decomposer) };
    let masked = decomposer.masked(&flags).map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    if decomposer.mask_flags().is_some() {
        return Ok(masked);
    }
    // Reading has told of the places of an image or a volume that have no data.
    let outsiders = decomposer.domain().outsiders().unwrap_or_default();
    let is_known = |x: usize| outsiders.get(x).copied().unwrap_or(false);
    if flags.iter().enumerate().all(|(x, &is_missing)| !is_missing || is_known(x)) {
        return Ok(masked);
    }
    let n_missing = flags.iter().filter(|&&is_missing| is_missing).count();
    note(
        global,
        &format!(
            "{name} is NaN at {n_missing} of {} vertices, which are masked; values there would take part",
            flags.len()
        ),
    );
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
