//! The commands of each guide run as they are written, one after the other, in an empty folder.

use crate::documented::{in_document, root, run_all, shrink_sizes};
use crate::harness::{Faults, run_line};
use tempfile::TempDir;

/// Pages whose commands write all files that they use. TOOLS.md has no command of adwave.
pub(crate) const PAGES: [&str; 14] = [
    "README.md",
    "docs/TUTORIAL.md",
    "docs/TASKS.md",
    "docs/GRIDS.md",
    "docs/SPACETIME.md",
    "docs/DIRECTIONS.md",
    "docs/GRAPHS.md",
    "docs/SUBDIVISION.md",
    "docs/DEFORM.md",
    "docs/SCALE.md",
    "docs/EVALUATION.md",
    "docs/STUDIO.md",
    "docs/PERFORMANCE.md",
    "site/front.md",
];

/// Runs the commands of some pages, each page in a folder of its own.
fn run_pages(pages: &[&str]) {
    let mut faults = Faults::default();
    for page in pages {
        let folder = TempDir::new().unwrap();
        faults.inspect(&run_line(folder.path(), "formats"));
        let mut commands = in_document(&root().join(page));
        commands.retain(|command| !command.takes_own_file);
        faults.expect(!commands.is_empty(), || format!("{page}: no command was found"));
        run_all(folder.path(), &commands, &shrink_sizes, &mut faults);
    }
    faults.finish();
}

#[test]
fn commands_of_the_first_pages_run_in_an_empty_folder() {
    run_pages(&PAGES[..2]);
}

#[test]
fn commands_by_task_run_in_an_empty_folder() {
    run_pages(&PAGES[2..3]);
}

#[test]
fn commands_of_other_pages_run_in_an_empty_folder() {
    run_pages(&PAGES[3..]);
}
