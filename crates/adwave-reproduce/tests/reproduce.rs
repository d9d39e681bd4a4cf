//! Figures from end to end on small shapes, and that nothing of the paper is left out.

use adwave::Progress;
use adwave_reproduce::{
    Context, Event, FIGURES, Figure, Models, ReproduceError, Target, Verdict, reproduce, select,
};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Built-in shapes of these tests have so many vertices: figures are then made in a second even without optimization.
const SMALL: usize = 1500;

fn target(folder: &Path) -> Target {
    Target { folder: folder.join("out"), markdown: Some(folder.join("docs/PAPER.md")) }
}

fn named(names: &[&str]) -> Vec<&'static Figure> {
    select(&names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>()).unwrap()
}

#[test]
fn all_figures_and_tables_are_there_in_the_order_of_the_paper() {
    let names: Vec<&str> = FIGURES.iter().map(|f| f.name).collect();
    let figures = (1..=15).map(|k| format!("fig{k}"));
    let paper: Vec<String> = figures.chain(["table1", "table2", "section2.2"].map(str::to_owned)).collect();
    assert_eq!(names, paper);
}

#[test]
fn figures_are_selected_by_name_once_and_in_order() {
    let chosen: Vec<&str> = named(&["fig13", "FIG08", "fig8"]).iter().map(|f| f.name).collect();
    assert_eq!(chosen, ["fig8", "fig13"]);
    assert_eq!(named(&["all"]).len(), FIGURES.len());
    assert_eq!(named(&[]).len(), FIGURES.len());
    assert_eq!(select(&["fig8".to_owned(), "fig99".to_owned()]).unwrap_err(), "fig99");
}

#[test]
fn pictures_numbers_and_pages_of_a_figure_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let target = target(folder.path());
    let context = Context::new(Models::default(), Progress::none()).with_most_vertices(SMALL);
    let mut said = Vec::new();
    let figures = named(&["fig8", "fig13"]);
    let made = reproduce(&figures, &context, &target, &mut |event| {
        said.push(match event {
            Event::Started(figure) => format!("+{}", figure.name),
            Event::Finished(made) => format!("-{}", made.outcome.id),
        });
    })
    .unwrap();
    assert_eq!(said, ["+fig8", "-fig8", "+fig13", "-fig13"]);
    let index = std::fs::read_to_string(target.folder.join("index.html")).unwrap();
    let markdown = std::fs::read_to_string(target.markdown.as_ref().unwrap()).unwrap();
    for one in &made {
        let outcome = &one.outcome;
        assert!(outcome.pictures.iter().all(|p| p.bytes.starts_with(b"\x89PNG")), "{}", outcome.id);
        assert!(!outcome.tables.is_empty() && !outcome.text.is_empty(), "{}", outcome.id);
        for file in &one.files {
            assert!(file.is_file(), "{}", file.display());
            let name = format!("{}/{}", one.folder, file.file_name().unwrap().to_string_lossy());
            assert!(index.contains(&name), "the page links {name}");
        }
        assert!(index.contains(&outcome.title) && markdown.contains(&outcome.title));
        assert!(index.contains(outcome.verdict.headline()) && markdown.contains(outcome.verdict.headline()));
        assert!(markdown.contains(&format!("`adwave reproduce {} -o out`", outcome.id)));
        let small = format!("(paper/{}.", one.folder);
        assert!(markdown.contains(&small), "the Markdown shows {small}");
    }
    // An edit that carves moves inwards whatever the resolution.
    assert!(matches!(made[1].outcome.verdict, Verdict::AsClaimed(_)), "{:?}", made[1].outcome.verdict);
}

#[test]
fn what_is_to_stop_stops_and_leaves_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(true);
    let context =
        Context::new(Models::default(), Progress::none().with_cancel(&stop)).with_most_vertices(SMALL);
    let stopped = reproduce(&named(&["fig8"]), &context, &target(folder.path()), &mut |_| {});
    assert!(matches!(stopped, Err(ReproduceError::Cancelled)), "{stopped:?}");
    assert!(folder.path().join("out/index.html").is_file());
}

#[test]
fn a_model_that_one_figure_cannot_use_leaves_the_others() {
    let folder = tempfile::tempdir().unwrap();
    // All faces without area on one point: a walk that does not move, which has no levels by length.
    let still = "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n";
    std::fs::write(folder.path().join("horse.obj"), still).unwrap();
    let mut models = Models::search(&[folder.path().to_owned()]).unwrap();
    models.read(&["horse"]).unwrap();
    let context = Context::new(models, Progress::none()).with_most_vertices(SMALL);
    let mut finished = Vec::new();
    let result =
        reproduce(&named(&["fig8", "fig12", "fig13"]), &context, &target(folder.path()), &mut |event| {
            if let Event::Finished(made) = event {
                finished.push(made.outcome.id.clone());
            }
        });
    assert_eq!(finished, ["fig8", "fig13"]);
    let Err(ReproduceError::Figures(failed, _)) = result else { panic!("figure 12 has no levels") };
    assert_eq!(failed, ["fig12"]);
    let index = std::fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(index.contains("fig08/fig08.png") && index.contains("fig13/fig13.png"));
}

#[test]
fn what_cannot_be_written_shows_before_the_first_figure() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("out"), "a file").unwrap();
    let context = Context::new(Models::default(), Progress::none());
    let mut n_events = 0;
    let refused = reproduce(&named(&["fig8"]), &context, &target(folder.path()), &mut |_| n_events += 1);
    assert!(matches!(refused, Err(ReproduceError::Write { .. })), "{refused:?}");
    assert_eq!(n_events, 0);
}

#[test]
fn the_committed_page_has_a_section_for_each_figure() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = std::fs::read_to_string(root.join("docs/PAPER.md")).unwrap();
    let headings: Vec<&str> = page.lines().filter(|line| line.starts_with("## ")).collect();
    let expected: Vec<String> = FIGURES
        .iter()
        .map(|f| {
            let name =
                f.name.replace("fig", "Figure ").replace("table", "Table ").replace("section", "Section ");
            format!("## {name}: {}", f.title)
        })
        .collect();
    assert_eq!(headings, expected, "write it anew: adwave reproduce all -o out --markdown docs/PAPER.md");
    for figure in FIGURES {
        assert!(page.contains(&format!("`adwave reproduce {} -o out`", figure.name)), "{}", figure.name);
    }
    for line in page.lines().filter(|line| line.starts_with("![")) {
        let file = line.rsplit('(').next().unwrap().trim_end_matches(')');
        assert!(root.join("docs").join(file).is_file(), "{file}");
    }
}

#[test]
fn wavelets_of_subdivision_are_compared_in_both_directions() {
    let folder = tempfile::tempdir().unwrap();
    let target = target(folder.path());
    let context = Context::new(Models::default(), Progress::none()).with_most_vertices(SMALL);
    let made = reproduce(&named(&["section2.2"]), &context, &target, &mut |_| {}).unwrap();
    let outcome = &made[0].outcome;
    let markdown = std::fs::read_to_string(target.markdown.as_ref().unwrap()).unwrap();
    assert!(markdown.contains("## Section 2.2: "), "the heading names the section");
    assert!(!matches!(outcome.verdict, Verdict::NotAsClaimed(_)), "{:?}", outcome.verdict);
    assert_eq!(outcome.pictures.len(), 2);
    let sizes: Vec<&str> = outcome.tables[1].rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(sizes, ["10242", "2562", "642", "162", "42", "12"]);
}
