//! A progress bar, on a terminal only.

use crate::error::CliError;
use crate::global::Global;
use crate::output::available_memory;
use adwave::operator::OperatorParams;
use adwave::shape::Shape;
use adwave::{Decomposer, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Runs `work` with a handle that draws a bar and stops at Ctrl-C.
pub(crate) fn with_progress<T>(global: &Global<'_>, what: &str, work: impl FnOnce(Progress<'_>) -> T) -> T {
    let bar = bar(global, what);
    let report = |done: u64, total: u64| {
        bar.set_length(total);
        bar.set_position(done);
    };
    let result = work(global.progress().with_report(&report));
    bar.finish_and_clear();
    result
}

/// Runs `work`, whose length is not known, with a spinner.
pub(crate) fn with_spinner<T>(global: &Global<'_>, what: &str, work: impl FnOnce() -> T) -> T {
    let bar = bar(global, what);
    bar.enable_steady_tick(Duration::from_millis(100));
    let result = work();
    bar.finish_and_clear();
    result
}

/// Prepares a shape.
pub(crate) fn prepare(
    global: &Global<'_>,
    shape: &Shape,
    params: &OperatorParams,
) -> Result<Decomposer, CliError> {
    if params.keep_creases && matches!(shape, Shape::Graph(_)) {
        return Err(CliError::Input(
            "--keep-creases is of normals, which a graph has not; leave it out".to_owned(),
        ));
    }
    if let Some(free) = available_memory() {
        check_neighbors(shape, params, free)?;
    }
    with_progress(global, "preparing", |progress| Decomposer::with_params(shape, params, progress))
        .map_err(|_| CliError::Cancelled)
}

/// Refuses neighborhoods that take more memory than is free.
fn check_neighbors(shape: &Shape, params: &OperatorParams, free: u64) -> Result<(), CliError> {
    /// Bytes of a neighbor: its number and weight, in the operator and while it is made.
    const BYTES: u64 = 24;
    let n = shape.n_vertices() as u64;
    let (flag, of_each) = match shape {
        Shape::Cloud(_) => (format!("--neighbors {}", params.neighbors), params.neighbors as u64),
        // So many vertices are in r rings around one of six neighbors.
        Shape::Mesh(_) => {
            let r = params.rings as u64;
            (format!("--rings {r}"), r.saturating_add(1).saturating_mul(r).saturating_mul(3))
        }
        Shape::Graph(_) => return Ok(()),
    };
    let bytes = of_each.min(n).saturating_mul(n).saturating_mul(BYTES);
    if bytes <= free {
        return Ok(());
    }
    let gib = |bytes: u64| bytes as f64 / (1_u64 << 30) as f64;
    Err(CliError::Input(format!(
        "{flag} of {n} vertices takes about {:.0} GiB, and {:.1} GiB are free; take fewer",
        gib(bytes),
        gib(free)
    )))
}

/// A bar that is drawn on a terminal only.
pub(crate) fn bar(global: &Global<'_>, what: &str) -> ProgressBar {
    let shown = !global.quiet && std::io::stderr().is_terminal();
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{spinner} {msg} {bar:32} {percent} % {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(None, target).with_style(style).with_message(what.to_owned())
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
            "--neighbors 5000 of 100000 vertices takes about 11 GiB, and 8.0 GiB are free; take fewer"
        );
        assert!(check_neighbors(&cloud, &params, 12 << 30).is_ok());
        assert!(check_neighbors(&cloud, &OperatorParams::default(), 8 << 30).is_ok());
    }
}
