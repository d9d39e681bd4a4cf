//! `adwave reproduce`: the figures and tables of the paper.

use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::bar;
use crate::output::{print, tell};
use adwave_reproduce::{
    Context, Event, FIGURES, Figure, Models, ReproducedFigure, Target, reproduce, select,
};
use clap::Args;
use indicatif::ProgressBar;
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::Path;
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(Debug, Args)]
#[command(after_help = "\
DIR/index.html shows every figure with its pictures, an explanation, and whether the claim of the paper holds. DIR/figNN holds the
pictures in full size and the numbers as CSV.

Models are found by name in the given folders and all folders below: armadillo, dinosaur, skull, horse, kitten, face, bunny,
spot (with its texture), gargoyle, buddha, hand, pegaso, cow, sphere. Built-in shapes replace those that are missing.

Examples:
  adwave reproduce -o out
  adwave reproduce fig10 table2 -o out
  adwave reproduce all -o out --models models --models textured-models")]
pub(crate) struct ReproduceArgs {
    /// fig1 … fig15, table1, table2, section2.2, or all
    #[arg(value_name = "FIGURE", default_value = "all")]
    pub(crate) figures: Vec<String>,
    /// Folder for the files
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Folder with copies of the paper's models; may be given several times
    #[arg(long, value_name = "DIR")]
    pub(crate) models: Vec<PathBuf>,
    /// Write the page as Markdown too, with small pictures in a folder next to it
    #[arg(long, value_name = "FILE.md")]
    pub(crate) markdown: Option<PathBuf>,
    /// Largest number of vertices of built-in shapes, for a quick sketch of every figure
    #[arg(long, value_name = "N", value_parser = crate::args::count_from_one)]
    pub(crate) most_vertices: Option<NonZeroUsize>,
}

pub(crate) fn run(args: &ReproduceArgs, global: &Global<'_>) -> Result<(), CliError> {
    let start = Instant::now();
    let figures = select(&args.figures).map_err(|name| {
        let known = FIGURES.iter().map(|f| f.name).collect::<Vec<_>>().join(", ");
        CliError::Input(format!("figure must be all, {known}, got '{name}'"))
    })?;
    if args.output.exists() && !args.output.is_dir() {
        return Err(CliError::Input(format!("{} is a file; give a folder", args.output.display())));
    }
    let models = models(args, &figures)?;
    let found: Vec<Value> = models
        .files()
        .map(|(name, path)| json!({"name": name, "file": path.display().to_string()}))
        .collect();
    let line = FigureProgress::new(global, figures.len());
    let report = |done: u64, total: u64| line.part(done, total);
    let progress = global.progress().with_report(&report);
    let mut context = Context::new(models, progress);
    if let Some(most) = args.most_vertices {
        context = context.with_most_vertices(most.get());
    }
    let target = Target { folder: args.output.clone(), markdown: args.markdown.clone() };
    let made = reproduce(&figures, &context, &target, &mut |event| match event {
        Event::Started(figure) => line.begin(figure),
        Event::Finished(made) => line.end(made),
    });
    line.finish();
    let made = made?;
    let index = args.output.join("index.html");
    let json = json!({
        "output": args.output.display().to_string(),
        "index": index.display().to_string(),
        "models": found,
        "seconds": start.elapsed().as_secs_f64(),
        "figures": made.iter().map(describe).collect::<Vec<Value>>(),
    });
    print(global, &summary(&made, &index, start.elapsed()), &json)
}

/// The user's models, of which those that the figures use are read.
fn models(args: &ReproduceArgs, figures: &[&Figure]) -> Result<Models, CliError> {
    if args.models.is_empty() {
        return Ok(Models::default());
    }
    let mut models = Models::search(&args.models)?;
    let wanted: Vec<&str> = figures.iter().flat_map(|f| f.models.iter().copied()).collect();
    models.read(&wanted)?;
    Ok(models)
}

fn describe(made: &ReproducedFigure) -> Value {
    let outcome = &made.outcome;
    json!({
        "id": outcome.id,
        "title": outcome.title,
        "command": outcome.command,
        "shapes": outcome.shapes,
        "verdict": outcome.verdict.keyword(),
        "because": outcome.verdict.sentence(),
        "text": outcome.text,
        "seconds": made.seconds,
        "files": made.files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>(),
    })
}

fn summary(made: &[ReproducedFigure], index: &Path, took: Duration) -> String {
    let count = |keyword: &str| made.iter().filter(|m| m.outcome.verdict.keyword() == keyword).count();
    format!(
        "{} of {} as claimed in the paper, {} partly, {} not as claimed; {:.1} s\n{}\n",
        count("as-claimed"),
        made.len(),
        count("partly"),
        count("not-as-claimed"),
        took.as_secs_f64(),
        index.display(),
    )
}

/// A line for every finished figure, and on a terminal a bar for the current one.
struct FigureProgress<'a> {
    global: &'a Global<'a>,
    bar: ProgressBar,
    n_figures: usize,
}

impl<'a> FigureProgress<'a> {
    fn new(global: &'a Global<'a>, n_figures: usize) -> Self {
        Self { global, bar: bar(global, ""), n_figures }
    }

    fn begin(&self, figure: &Figure) {
        self.bar.reset();
        self.bar.set_message(format!("{} {}", figure.name, figure.title));
        self.bar.enable_steady_tick(Duration::from_millis(100));
    }

    fn part(&self, done: u64, total: u64) {
        self.bar.set_length(total);
        self.bar.set_position(done);
    }

    fn end(&self, made: &ReproducedFigure) {
        if !self.global.quiet && self.n_figures > 1 {
            let outcome = &made.outcome;
            let verdict = outcome.verdict.headline().to_lowercase();
            self.bar.suspend(|| {
                tell(&format!("{:<7}{:>7.1} s  {}: {verdict}", outcome.id, made.seconds, outcome.title));
            });
        }
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
