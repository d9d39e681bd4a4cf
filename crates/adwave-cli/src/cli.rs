//! The command line as a whole: help, man page and completions come from here.

use crate::args::GlobalArgs;
use crate::commands::{
    basis::BasisArgs,
    compare::CompareArgs,
    convert::ConvertArgs,
    demo::DemoArgs,
    denoise::DenoiseArgs,
    diff::DiffArgs,
    evaluate::EvaluateArgs,
    features::FeaturesArgs,
    filter::FilterArgs,
    formats::FormatsArgs,
    info::InfoArgs,
    matching::MatchArgs,
    region::RegionArgs,
    render::RenderArgs,
    report::ReportArgs,
    reproduce::ReproduceArgs,
    saliency::SaliencyArgs,
    sample::SampleArgs,
    shell::{CompletionsArgs, ManArgs},
    simplify::SimplifyArgs,
    studio::StudioArgs,
    tiles::{TileArgs, TilesArgs},
    transform::TransformArgs,
};
use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};

/// Wavelets for shapes: split a mesh, a point cloud or a graph, or any signal on it, into bands from fine to coarse,
/// change the bands, and put the shape back together without loss.
#[derive(Debug, Parser)]
#[command(
    name = "adwave",
    version,
    after_help = "\
Examples:
  adwave demo                                         all of it, on a built-in shape
  adwave info scan.ply                                what is in a file, and which levels it gets
  adwave transform bunny.obj -o bands.npz             all bands, for numpy
  adwave denoise scan.obj -o clean.obj                noise off, no knob needed
  adwave filter bunny.obj -o smooth.obj --preset smooth
  adwave filter bunny.obj -o crisp.obj --preset enhance --region 'ball:vertex=120,radius=10%'
  adwave region bunny.obj --region 'ball:vertex=120,radius=10%' -o mask.ply
  adwave studio bunny.obj                             a slider for each band, in the browser

A SHAPE is a file, '-' for the standard input, or sample:NAME for a built-in shape (see 'adwave sample').
Exit codes: 0 done, 1 the machine failed (disk, permissions), 2 bad usage or input, 130 stopped by Ctrl-C."
)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: GlobalArgs,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What a command is for and its examples come first: most people need no option.
const HELP: &str = "{about-with-newline}\n{usage-heading} {usage}{after-help}\n\n{all-args}";

/// The command line with its help.
pub(crate) fn command() -> clap::Command {
    Cli::command().mut_subcommands(|command| command.help_template(HELP))
}

/// Words that people try as a command or an option, and what does that here.
const MEANT: [(&[&str], &str); 10] = [
    (&["export", "save", "transcode"], "adwave convert SHAPE -o OUT"),
    (&["smooth", "laplacian", "taubin", "suppress"], "adwave filter SHAPE -o OUT --preset smooth"),
    (&["sharpen", "enhance"], "adwave filter SHAPE -o OUT --preset enhance"),
    (&["decimate", "reduce", "lod", "remesh"], "adwave simplify SHAPE -o OUT --error 0.1%"),
    (
        &["align", "register", "registration", "icp"],
        "adwave match SHAPE OTHER --moved OUT, or adwave diff SHAPE OTHER --align",
    ),
    (&["keypoints", "detect", "descriptors"], "adwave features SHAPE -o keypoints.csv"),
    (&["view", "show", "plot", "picture", "screenshot"], "adwave render SHAPE -o picture.png"),
    (&["distance", "hausdorff", "difference"], "adwave diff SHAPE OTHER"),
    (&["gui", "edit", "equalizer", "equalizer", "ui"], "adwave studio SHAPE"),
    (&["decompose", "bands", "wavelets", "split"], "adwave transform SHAPE -o bands.npz"),
];

/// An error of usage with tips that fit: none that takes a misspelled option for a value, and for words that people try the command
/// that does it.
pub(crate) fn with_fitting_tips(mut error: clap::Error) -> clap::Error {
    let word = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.trim_start_matches('-').to_lowercase()),
        _ => None,
    };
    let tried = word(ContextKind::InvalidArg).or_else(|| word(ContextKind::InvalidSubcommand));
    let meant = tried.and_then(|tried| MEANT.iter().find(|(words, _)| words.contains(&tried.as_str())));
    let is_of_value = |tips: &ContextValue| matches!(tips, ContextValue::StyledStrs(tips) if tips.iter().any(|tip| tip.to_string().contains("as a value")));
    if let Some((_, command)) = meant {
        error.remove(ContextKind::SuggestedSubcommand);
        let tip = clap::builder::StyledStr::from(format!("for that there is: {command}"));
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip]));
    } else if error.get(ContextKind::Suggested).is_some_and(is_of_value) {
        error.remove(ContextKind::Suggested);
    }
    error
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Show what a shape consists of, what is unusual about it, and which levels it gets
    Info(InfoArgs),
    /// Split a shape or a signal on it into all its bands
    Transform(TransformArgs),
    /// Change bands, everywhere or by region, and write the shape back with everything its file had
    Filter(FilterArgs),
    /// Measure a region by itself: its weights, and how much of the shape it covers
    Region(RegionArgs),
    /// Take noise off a shape: how much is there, and whether creases stay, is found by itself
    Denoise(DenoiseArgs),
    /// Drop vertices, and measure how far the result is from the shape
    Simplify(SimplifyArgs),
    /// Map where a signal stands out, over all levels
    Saliency(SaliencyArgs),
    /// Find the places where a level stands out, each with its size
    Features(FeaturesArgs),
    /// Find the motion between two scans of one thing, and which of their features are the same
    Match(MatchArgs),
    /// Compare two versions of a shape: what differs, and at which scale
    Diff(DiffArgs),
    /// Measure how stable the features are, or how well a map agrees with fixations of the eye
    Evaluate(EvaluateArgs),
    /// Do the same by another method, and show the differences and the times side by side
    Compare(CompareArgs),
    /// Write the scaling functions and wavelets: those of one vertex as fields, or all as sparse matrices
    Basis(BasisArgs),
    /// Draw a picture of a shape, a field on it, its features; or a sheet of several
    Render(RenderArgs),
    /// Write one page about a shape: health, bands, saliency, features, presets, as pictures and tables
    Report(ReportArgs),
    /// Open an equalizer for the shape in the browser: a slider for each band, a brush, layers
    Studio(StudioArgs),
    /// Bands of clouds and meshes that are larger than memory, tile by tile, with the bytes of the whole
    Tiles(TilesArgs),
    /// Do one job of 'adwave tiles', for clusters
    Tile(TileArgs),
    /// Write a shape in another format
    Convert(ConvertArgs),
    /// List the formats of files: what is read, written, kept and lost
    Formats(FormatsArgs),
    /// Write a built-in shape
    Sample(SampleArgs),
    /// Decompose, filter and edit a built-in creature, and show what happened
    Demo(DemoArgs),
    /// Reproduce the figures and tables of the paper, with the numbers behind them and whether its claims hold
    Reproduce(ReproduceArgs),
    /// Print the completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page
    Man(ManArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::bands::{BandsParams, DEFAULT_EXTENT};
    use adwave::features::{FEATURE_EXTENT, FeatureParams};
    use adwave::operator::OperatorParams;
    use adwave::saliency::{SALIENCY_EXTENT, SaliencyParams};

    #[test]
    fn the_flags_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn what_is_not_asked_for_is_as_the_library_has_it() {
        let parse = |line: &str| Cli::try_parse_from(line.split_whitespace()).unwrap().command;
        let Command::Saliency(saliency) = parse("adwave saliency a.ply -o b.ply") else { panic!("saliency") };
        assert_eq!(saliency.map.params(&saliency.border), SaliencyParams::default());
        assert_eq!(saliency.shape.operator().ok(), Some(OperatorParams::default()));
        assert_eq!(saliency.levels.accuracy, BandsParams::default().accuracy);
        let Command::Features(features) = parse("adwave features a.ply") else { panic!("features") };
        assert_eq!(features.detect.params(&features.border), FeatureParams::default());
    }

    #[test]
    fn tips_fit_what_was_tried() {
        let said = |line: &str| {
            let error = command().try_get_matches_from(line.split_whitespace()).unwrap_err();
            with_fitting_tips(error).to_string()
        };
        assert!(said("adwave smooth a.ply -o b.ply").contains("filter SHAPE -o OUT --preset smooth"));
        assert!(said("adwave filter a.ply --smooth -o b.ply").contains("--preset smooth"));
        assert!(said("adwave decimate a.ply").contains("adwave simplify"));
        assert!(said("adwave filter a.ply --level 5 -o b.ply").contains("'--levels'"));
        assert!(!said("adwave denoise a.ply --iterations 3 -o b.ply").contains("as a value"));
    }

    #[test]
    fn help_names_the_widths_up_to_which_levels_go() {
        let mut command = Cli::command();
        let info = command.find_subcommand_mut("info").unwrap().render_long_help().to_string();
        let (levels, features) = (100.0 * DEFAULT_EXTENT, 100.0 * FEATURE_EXTENT);
        let saliency = 100.0 * SALIENCY_EXTENT;
        let named = format!(
            "until a level is {levels} % of the diagonal wide, for features {features} %, for signed saliency {saliency} %"
        );
        assert!(info.split_whitespace().collect::<Vec<_>>().join(" ").contains(&named), "{named}: {info}");
    }
}
