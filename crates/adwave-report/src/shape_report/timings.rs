//! Timings section: seconds of each step.

use super::Subject;
use crate::page::{Block, Section};
use crate::table::{Table, grouped};

pub(super) fn section(subject: &Subject<'_>, seconds: &[(String, f64)]) -> Section {
    let mut section = Section::new("timings", "Time");
    let mut table = Table::new("timings.csv", "Wall-clock seconds of each part.", &["part", "seconds"]);
    for (part, took) in seconds {
        table.push([part.clone(), format!("{took:.3}")]);
    }
    table.push(["sum".to_owned(), format!("{:.3}", seconds.iter().map(|s| s.1).sum::<f64>())]);
    section.push(Block::Table(table));
    section.say(format!(
        "{} {} × {} channel{}, on {} thread{}. Operator is the preparation of the shape, bands is the decomposition; presets are \
         sums of these bands. Numbers and pictures do not depend on the number of threads.",
        grouped(subject.bands.n_vertices),
        subject.vertices(),
        subject.bands.n_channels,
        if subject.bands.n_channels == 1 { "" } else { "s" },
        rayon::current_num_threads(),
        if rayon::current_num_threads() == 1 { "" } else { "s" },
    ));
    section
}
