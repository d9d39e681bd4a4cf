//! The command line: help, man page and completions come from here.

use crate::args::GlobalArgs;
use crate::commands::{
    animate::AnimateArgs,
    basis::BasisArgs,
    compare::CompareArgs,
    convert::ConvertArgs,
    deform::DeformArgs,
    demo::DemoArgs,
    denoise::DenoiseArgs,
    diff::DiffArgs,
    evaluate::EvaluateArgs,
    features::FeaturesArgs,
    filter::FilterArgs,
    formats::FormatsArgs,
    impute::ImputeArgs,
    info::InfoArgs,
    matching::MatchArgs,
    morph::MorphArgs,
    rebase::RebaseArgs,
    region::RegionArgs,
    render::RenderArgs,
    report::ReportArgs,
    reproduce::ReproduceArgs,
    resample::ResampleArgs,
    saliency::SaliencyArgs,
    sample::SampleArgs,
    scatter::ScatterArgs,
    shell::{CompletionsArgs, ManArgs},
    simplify::SimplifyArgs,
    studio::StudioArgs,
    tiles::{TileArgs, TilesArgs},
    transfer::TransferArgs,
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
  adwave demo                                         a tour of the method on a built-in shape
  adwave info scan.ply                                contents of a file, and the levels it gets
  adwave transform bunny.obj -o bands.npz             all bands, for numpy
  adwave denoise scan.obj -o clean.obj                remove noise without tuning
  adwave filter bunny.obj -o smooth.obj --preset smooth
  adwave filter bunny.obj -o crisp.obj --preset enhance --region 'ball:vertex=120,radius=10%'
  adwave region bunny.obj --region 'ball:vertex=120,radius=10%' -o mask.ply
  adwave studio bunny.obj                             a slider for each band, in a browser

A SHAPE is a file, '-' for the standard input, or sample:NAME for a built-in shape (see 'adwave sample').
Exit codes: 0 done, 1 the machine failed (disk, permissions), 2 bad usage or input, 130 stopped by Ctrl-C (143 by SIGTERM).
An option that would change nothing is refused, with a line that says when it applies."
)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: GlobalArgs,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Template of help: the purpose of a command and its examples come first, since most people need no option.
const HELP: &str = "{about-with-newline}\n{usage-heading} {usage}{after-help}\n\n{all-args}";

/// The command line with its help.
pub(crate) fn command() -> clap::Command {
    with_paragraphs(Cli::command()).mut_subcommands(|command| with_paragraphs(command).help_template(HELP))
}

/// Length from which on a line of a help text goes on in the next one: that of the lines of this source, less a long word.
const FULL_LINE: usize = 105;

/// A command with each paragraph of its prose in one line, which is then wrapped at the width of the terminal.
fn with_paragraphs(command: clap::Command) -> clap::Command {
    let Some(text) = command.get_after_help().map(ToString::to_string) else { return command };
    let mut joined = String::new();
    let mut before = "";
    for line in text.lines() {
        let is_prose = |line: &str| line.starts_with(|c: char| !c.is_whitespace());
        let word = line.split(' ').next().unwrap_or_default();
        let is_full = before.chars().count() + 1 + word.chars().count() > FULL_LINE;
        if !joined.is_empty() {
            joined.push(if is_full && is_prose(before) && is_prose(line) { ' ' } else { '\n' });
        }
        joined.push_str(line);
        before = line;
    }
    command.after_help(joined)
}

/// Words that people try as a command or an option, each with the command that does it.
const SYNONYMS: [(&[&str], &str); 18] = [
    (&["export", "save", "transcode"], "adwave convert SHAPE -o OUT"),
    (&["smooth", "laplacian", "taubin", "suppress"], "adwave filter SHAPE -o OUT --preset smooth"),
    (&["sharpen", "enhance"], "adwave filter SHAPE -o OUT --preset enhance"),
    (
        &["bend", "pose", "arap", "grab", "warp"],
        "adwave deform SHAPE -o OUT --fix REGION --move REGION --by x,y,z",
    ),
    (&["decimate", "reduce", "lod", "remesh"], "adwave simplify SHAPE -o OUT --error 0.1%"),
    (
        &["align", "register", "registration", "icp"],
        "adwave match SHAPE OTHER --moved OUT, or adwave diff SHAPE OTHER --align",
    ),
    (&["keypoints", "detect", "descriptors"], "adwave features SHAPE -o keypoints.csv"),
    (&["view", "show", "plot", "picture", "screenshot"], "adwave render SHAPE -o picture.png"),
    (&["distance", "hausdorff", "difference"], "adwave diff SHAPE OTHER"),
    (&["gui", "edit", "equalizer", "equaliser", "ui"], "adwave studio SHAPE"),
    (&["decompose", "bands", "wavelets", "split"], "adwave transform SHAPE -o bands.npz"),
    (
        &["reconstruct", "synthesize", "inverse", "compose"],
        "adwave filter SHAPE -o OUT --gains 0,1,2, which splits, changes and puts together",
    ),
    (&["inspect", "stats", "describe", "check", "summary"], "adwave info SHAPE"),
    (&["curvature", "curvatures"], "adwave render SHAPE -o picture.png --color mean-curvature"),
    (&["input", "in", "infile", "i"], "adwave COMMAND FILE: a file to read stands without an option"),
    (&["list", "ls"], "adwave sample, which lists the built-in shapes, or adwave formats"),
    (&["version"], "adwave --version"),
    (&["clean", "fair", "denoising", "despeckle"], "adwave denoise SHAPE -o OUT"),
];

/// Words that people try as an option, each with the option of a command that does it and how that is used. The first
/// row whose option the command has counts.
const OPTION_SYNONYMS: [(&[&str], &str, &str); 12] = [
    (&["top", "count", "number", "n", "max", "limit", "k"], "best", "--best N"),
    (&["size", "count", "number", "n", "points", "target"], "vertices", "--vertices N"),
    (&["faces", "triangles"], "vertices", "--vertices N: a mesh has about twice as many triangles"),
    (&["percent", "fraction", "factor", "reduction"], "ratio", "--ratio 0.1"),
    (&["width", "height", "resolution"], "size", "--size 1600x1200"),
    (&["field", "signal", "values", "scalars", "scalar"], "color", "--color FIELD"),
    (&["background", "bg", "alpha"], "transparent", "--transparent"),
    (&["iterations", "sigma", "lambda", "amount", "weight", "level"], "strength", "--strength 1.5"),
    (
        &["sigma", "width", "radius", "scale", "kernel", "cutoff", "lowpass", "low-pass"],
        "gains",
        "--fwhm WIDTH --gains 0, which removes what is narrower",
    ),
    (&["weight", "at", "t", "alpha", "blend", "factor", "amount"], "share", "--share 0.5"),
    (
        &[
            "band",
            "gain",
            "strength",
            "amount",
            "keep",
            "drop",
            "remove",
            "boost",
            "highpass",
            "high-pass",
            "bandpass",
        ],
        "gains",
        "--gains 0,1,2: a gain for each band, fine to coarse",
    ),
    (&["bands", "scales", "depth"], "levels", "--levels N"),
];

/// Improves the tips of an error of usage: words that people try get the option or the command that does the task, and
/// no tip takes a misspelled option for a value, or another word for a misspelled one.
pub(crate) fn improve_tips(mut error: clap::Error) -> clap::Error {
    let is_of_value = |tips: &ContextValue| matches!(tips, ContextValue::StyledStrs(tips) if tips.iter().any(|tip| tip.to_string().contains("as a value")));
    if let Some(tip) = better_tip(&error) {
        error.remove(ContextKind::SuggestedSubcommand);
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    } else if error.get(ContextKind::Suggested).is_some_and(is_of_value) {
        error.remove(ContextKind::Suggested);
    }
    for (tried, suggested) in [
        (ContextKind::InvalidArg, ContextKind::SuggestedArg),
        (ContextKind::InvalidSubcommand, ContextKind::SuggestedSubcommand),
    ] {
        let (Some(tried), Some(tip)) = (word_of(&error, tried), word_of(&error, suggested)) else { continue };
        if tried.chars().next() != tip.chars().next() && !tip.contains(&tried) {
            error.remove(suggested);
        }
    }
    error
}

/// The word, or the last of the words, of a part of an error, without the dashes of an option.
fn word_of(error: &clap::Error, kind: ContextKind) -> Option<String> {
    match error.get(kind)? {
        ContextValue::String(word) => Some(word),
        ContextValue::Strings(words) => words.last(), // the best of them
        _ => None,
    }
    .map(|word| word.trim_start_matches('-').to_lowercase())
}

/// A tip that fits what was tried better than a word of similar letters.
fn better_tip(error: &clap::Error) -> Option<String> {
    let of_command =
        |tried: &str| SYNONYMS.iter().find(|(words, _)| words.contains(&tried)).map(|(_, tip)| *tip);
    let Some(ContextValue::String(argument)) = error.get(ContextKind::InvalidArg) else {
        return of_command(&word_of(error, ContextKind::InvalidSubcommand)?).map(|tip| format!("use {tip}"));
    };
    if let Some(ContextValue::String(value)) = error.get(ContextKind::InvalidValue) {
        return (argument.contains("<REGION>") && value.contains(['<', '>'])).then(|| {
            "a region on one side of a plane is 'half-space:point=0 0 0.5,normal=0 0 1', and one by a field \
             'field:name=NAME,low=A,high=B'"
                .to_owned()
        });
    }
    // "Usage: adwave filter …"
    let usage = error.get(ContextKind::Usage)?.to_string();
    let cli = Cli::command();
    let command =
        cli.find_subcommand(usage.split_whitespace().skip_while(|word| *word != "adwave").nth(1)?)?;
    let has = |option: &str| command.get_arguments().any(|argument| argument.get_long() == Some(option));
    if !argument.starts_with('-') {
        let tip = if has("from") {
            format!("--from {argument} names the other shape")
        } else if has("output") {
            format!("no further file is read; -o {argument} names the result")
        } else {
            return None;
        };
        return Some(tip);
    }
    let tried = word_of(error, ContextKind::InvalidArg)?;
    let row =
        OPTION_SYNONYMS.iter().find(|(words, option, _)| words.contains(&tried.as_str()) && has(option));
    row.map(|(_, _, tip)| *tip).or_else(|| of_command(&tried)).map(|tip| format!("use {tip}"))
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Report what a shape consists of, what is unusual about it, and which levels it gets
    Info(InfoArgs),
    /// Split a shape, or a signal on it, into bands
    Transform(TransformArgs),
    /// Weaken or strengthen bands, everywhere or in a region, and write the shape back
    Filter(FilterArgs),
    /// Compute the weights of a region and how much of the shape it covers
    Region(RegionArgs),
    /// Remove noise without tuning; sharp edges are preserved
    Denoise(DenoiseArgs),
    /// Reduce the number of vertices, and measure the distance to the original
    Simplify(SimplifyArgs),
    /// Bend a shape by handles while its detail rides along
    Deform(DeformArgs),
    /// Put the detail of a shape onto its base that was edited elsewhere, or write the base
    Rebase(RebaseArgs),
    /// Carry the detail of a shape onto another mesh or cloud of the same surface
    Transfer(TransferArgs),
    /// Carry fields and labels between registered spheres, such as those of cortical surfaces
    Resample(ResampleArgs),
    /// Blend two shapes with the same faces, band by band
    Morph(MorphArgs),
    /// Smooth, calm or exaggerate the motion of a shape that is given by frames
    Animate(AnimateArgs),
    /// Map where a signal stands out, over all levels
    Saliency(SaliencyArgs),
    /// Find features: places where a level stands out, each with its size
    Features(FeaturesArgs),
    /// Align two scans of one object, and pair their features
    Match(MatchArgs),
    /// Compare two versions of a shape, an image or a volume, scale by scale
    Diff(DiffArgs),
    /// Measure how repeatable features are, or how well a map agrees with eye fixations
    Evaluate(EvaluateArgs),
    /// Compare adwave with another method on the same task
    Compare(CompareArgs),
    /// Write scaling functions and wavelets, of one vertex as fields or of all as sparse matrices
    Basis(BasisArgs),
    /// Average counts over similar cells, for a time that is chosen by cross-validation
    Impute(ImputeArgs),
    /// Compute scattering features of fields on a graph
    Scatter(ScatterArgs),
    /// Draw a picture of a shape, of a field on it or of its features; or a sheet of several
    Render(RenderArgs),
    /// Write a page about a shape, an image or a volume: health, bands, saliency, features and presets, with pictures
    Report(ReportArgs),
    /// Edit a shape in a browser: a slider for each band, a brush, layers
    Studio(StudioArgs),
    /// Process clouds and meshes that are larger than memory, tile by tile
    Tiles(TilesArgs),
    /// Run one job of 'adwave tiles', for clusters
    Tile(TileArgs),
    /// Convert a shape to another format
    Convert(ConvertArgs),
    /// List the file formats: what each reads, writes, keeps and loses
    Formats(FormatsArgs),
    /// Write a built-in shape
    Sample(SampleArgs),
    /// Decompose, filter and edit a built-in creature, and show the results
    Demo(DemoArgs),
    /// Reproduce the figures and tables of the paper, and check its claims
    Reproduce(ReproduceArgs),
    /// Print the completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page
    Man(ManArgs),
    /// Print the notices and licenses of the software that adwave contains
    Notices,
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::bands::DEFAULT_EXTENT;
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
        assert_eq!(saliency.map.to_params(&saliency.border), SaliencyParams::default());
        assert_eq!(saliency.shape.operator.to_walk_params(), OperatorParams::default());
        assert_eq!(saliency.levels.accuracy, None);
        let Command::Features(features) = parse("adwave features a.ply") else { panic!("features") };
        assert_eq!(features.detect.to_params(&features.border), FeatureParams::default());
    }

    #[test]
    fn tips_fit_what_was_tried() {
        let said = |line: &str| {
            let error = command().try_get_matches_from(line.split_whitespace()).unwrap_err();
            improve_tips(error).to_string()
        };
        assert!(said("adwave smooth a.ply -o b.ply").contains("filter SHAPE -o OUT --preset smooth"));
        assert!(said("adwave filter a.ply --smooth -o b.ply").contains("--preset smooth"));
        assert!(said("adwave decimate a.ply").contains("adwave simplify"));
        assert!(said("adwave reconstruct bands.npz").contains("adwave filter SHAPE -o OUT --gains"));
        for (line, tip) in [
            ("adwave features a.ply --top 10", "use --best N\n"),
            ("adwave features a.ply -n 10", "use --best N\n"),
            ("adwave simplify a.ply -o b.ply --faces 500", "use --vertices N: a mesh has"),
            ("adwave simplify a.ply -o b.ply --percent 10", "use --ratio 0.1\n"),
            ("adwave render a.ply -o a.png --width 800", "use --size 1600x1200\n"),
            ("adwave render a.ply -o a.png --field curv", "use --color FIELD\n"),
            ("adwave denoise a.ply -o b.ply --iterations 3", "use --strength 1.5\n"),
            ("adwave filter a.ply -o b.ply --sigma 2", "use --fwhm WIDTH --gains 0"),
            ("adwave filter a.ply -o b.ply --keep 1-3", "use --gains 0,1,2"),
            ("adwave filter a.ply -o b.ply --bands 6", "use --levels N\n"),
            ("adwave filter a.ply -o b.ply --preset smooth --strength 0.5", "use --gains 0,1,2"),
            ("adwave convert a.ply -o b.ply --bands 6", "use adwave transform SHAPE -o bands.npz\n"),
            ("adwave convert a.ply b.ply", "no further file is read; -o b.ply names the result\n"),
            ("adwave transfer a.ply b.ply -o c.ply", "--from b.ply names the other shape\n"),
            ("adwave filter --input a.ply -o b.ply", "stands without an option\n"),
            ("adwave morph a.ply b.ply -o c.ply --weight 0.5", "use --share 0.5\n"),
            ("adwave sample --list", "use adwave sample, which lists"),
            ("adwave version", "use adwave --version\n"),
            ("adwave region a.ply --region z>0.5", "'half-space:point=0 0 0.5,normal=0 0 1'"),
        ] {
            let said = said(line);
            assert!(said.contains(tip) && said.matches("tip:").count() == 1, "{said}");
        }
        assert!(said("adwave filter a.ply --level 5 -o b.ply").contains("'--levels'"));
        assert!(said("adwave filtr a.ply -o b.ply").contains("'filter'"));
        assert!(said("adwave egion a.ply").contains("'region'"));
        let other = said("adwave transform a.ply -o b.npz --strength 2");
        assert!(!other.contains("tip:"), "{other}");
        assert!(!said("adwave denoise a.ply --iterations 3 -o b.ply").contains("as a value"));
    }

    #[test]
    fn prose_of_help_is_wrapped_at_the_width_of_the_terminal_alone() {
        const WIDTH: usize = 72;
        let mut command = command().term_width(WIDTH);
        let help = command.find_subcommand_mut("denoise").unwrap().render_long_help().to_string();
        let paragraph = help.split("\n\n").find(|p| p.starts_with("Points of a cloud move")).unwrap();
        let lines: Vec<&str> = paragraph.lines().collect();
        assert!(lines.len() > 5, "{paragraph}");
        for pair in lines.windows(2) {
            let word = pair[1].split(' ').next().unwrap();
            assert!(pair[0].chars().count() + word.chars().count() >= WIDTH, "{paragraph}");
        }
    }

    #[test]
    fn help_names_the_widths_up_to_which_levels_go() {
        let mut command = Cli::command();
        let info = command.find_subcommand_mut("info").unwrap().render_long_help().to_string();
        let (levels, features) = (100.0 * DEFAULT_EXTENT, 100.0 * FEATURE_EXTENT);
        let saliency = 100.0 * SALIENCY_EXTENT;
        let named = format!(
            "until a level is {levels} % of the diagonal wide, for features {features} %, for signed saliency and diff {saliency} %"
        );
        assert!(info.split_whitespace().collect::<Vec<_>>().join(" ").contains(&named), "{named}: {info}");
    }
}
