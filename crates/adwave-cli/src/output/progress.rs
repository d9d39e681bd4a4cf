//! A progress bar, on a terminal only.

use super::print_remarks;
use crate::global::Global;
use adwave::Progress;
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

/// A bar that is drawn on a terminal only. Remarks about inputs are printed before.
pub(crate) fn bar(global: &Global<'_>, what: &str) -> ProgressBar {
    print_remarks(global);
    let is_shown = !global.quiet && std::io::stderr().is_terminal();
    let target = if is_shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{spinner} {msg} {bar:32} {percent} % {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(None, target).with_style(style).with_message(what.to_owned())
}
