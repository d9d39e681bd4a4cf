//! Command lines without options, and a value of each option that makes a difference.

use crate::harness::split_words;

/// Shortest useful lines of each command. `{in}` and `{other}` stand for shapes; all results go below `out/`.
const BASES: [(&str, &[&str]); 34] = [
    ("info", &["info {in}"]),
    ("transform", &["transform {in} -o out/r.ply"]),
    ("filter", &["filter {in} -o out/r.ply --gains 0,0.5,1", "filter {in} -o out/r.ply --preset smooth"]),
    ("region", &["region {in} -o out/r.ply --region ball:vertex=31,radius=40%"]),
    ("denoise", &["denoise {in} -o out/r.ply"]),
    ("simplify", &["simplify {in} -o out/r.ply --ratio 0.5"]),
    (
        "deform",
        &["deform {in} -o out/r.ply --fix ball:vertex=31,radius=30% --move vertices:indices=2 --by 0.1,0,0"],
    ),
    ("rebase", &["rebase {in} --base {in} -o out/r.ply", "rebase {in} --write-base out/r.ply"]),
    ("transfer", &["transfer {in} --from {other} -o out/r.ply"]),
    ("resample", &["resample relief --from ball.ply --to ball2.ply -o out/r.npy"]),
    ("morph", &["morph {in} {other} -o out/r.ply --share 0.5"]),
    (
        "animate",
        &[
            "animate walk -o out/r.npy --motion out/m.ply",
            "animate mesh.ply --positions moves.npy -o out/r.npy",
        ],
    ),
    ("saliency", &["saliency {in} -o out/r.ply"]),
    ("features", &["features {in} -o out/r.csv --theta 0.5"]),
    ("match", &["match {in} {other} -o out/r.csv"]),
    ("diff", &["diff {in} {other} -o out/r.ply"]),
    ("evaluate", &["evaluate {in} --runs 1 --percent 10 --theta 0.5", "evaluate {in} --fixations gaze"]),
    ("compare", &["compare {in} --with mht --harmonics 20 -o out"]),
    ("impute", &["impute counts.npy -o out/r.npy --points cells.npy", "impute cells.h5ad -o out/r.h5ad"]),
    ("scatter", &["scatter --graph graph.mtx --field cells.npy -o out/r.npy"]),
    ("basis", &["basis {in} --vertex 3 --level 2 -o out/r.ply", "basis {in} --levels 2 -o out/r.npz"]),
    ("render", &["render {in} -o out/r.png --size 400x300"]),
    ("report", &["report {in} -o out/r.html"]),
    ("studio", &[]),
    (
        "tiles",
        &["tiles scan.las -o out/r.las --gains 0,0.5,1", "tiles mesh.ply -o out/r.ply --gains 0,0.5,1"],
    ),
    ("tile", &["tile job status"]),
    ("convert", &["convert {in} -o out/r.ply"]),
    ("formats", &["formats"]),
    ("sample", &["sample sphere --vertices 60 -o out/r.ply", "sample terrain --points 50 -o out/r.las"]),
    ("demo", &["demo -o out --vertices 2000"]),
    ("reproduce", &["reproduce fig4 -o out --most-vertices 200"]),
    ("completions", &["completions bash"]),
    ("man", &["man"]),
    ("notices", &["notices"]),
];

/// One option of one command, or of all (`*`).
pub(crate) struct OptionCase {
    pub(crate) command: &'static str,
    pub(crate) option: &'static str,
    /// Value that differs from the default; empty for a flag.
    pub(crate) value: &'static str,
    /// Further words without which the option is refused; `!--other` takes that option away.
    pub(crate) needs: &'static str,
    /// File instead of the usual one of its kind.
    pub(crate) input: &'static str,
}

const fn case(command: &'static str, option: &'static str, value: &'static str) -> OptionCase {
    OptionCase { command, option, value, needs: "", input: "" }
}

#[expect(clippy::needless_pass_by_value, reason = "cases are written in place")]
const fn with(case: OptionCase, needs: &'static str) -> OptionCase {
    OptionCase { needs, ..case }
}

#[expect(clippy::needless_pass_by_value, reason = "cases are written in place")]
const fn in_file(case: OptionCase, input: &'static str) -> OptionCase {
    OptionCase { input, ..case }
}

/// The cases: of each option that of the command, else that of all commands.
const CASES: &[OptionCase] = &[
    // General.
    case("*", "--json", ""),
    case("*", "--quiet", ""),
    case("*", "--threads", "1"),
    case("*", "--max-input", "30"),
    case("*", "--provenance", ""),
    // The shape.
    in_file(case("*", "--box", "0,0,0,6,6,99"), "scan.las"),
    in_file(case("*", "--resolution", "3"), "scan.las"),
    case("*", "--only", "y=..0.8"),
    case("*", "--mask", "mask.csv"),
    with(case("*", "--invert-mask", ""), "--mask mask.csv"),
    case("*", "--all-points", ""),
    case("*", "--as", "cloud"),
    in_file(case("*", "--vertices", "80"), "sample:sphere"),
    in_file(with(case("*", "--noise", "0.3"), "--vertices 300"), "sample:sphere"),
    in_file(with(case("*", "--seed", "9"), "--noise 0.3 --vertices 300"), "sample:sphere"),
    in_file(with(case("*", "--allow-degrees", ""), "--lengths 2,4,8"), "scan2.las"),
    case("*", "--surface", "mesh.ply"),
    // The operator.
    case("*", "--operator", "surface"),
    in_file(case("match", "--operator", "walk"), "creature.ply"),
    case("diff", "--operator", "walk"),
    case("*", "--weld", "0.01"),
    case("*", "--no-weld", ""),
    case("*", "--rings", "2"),
    case("*", "--mesh-area", "mixed-voronoi"),
    case("*", "--neighbors", "5"),
    case("*", "--directed", ""),
    case("*", "--cloud-area", "unit"),
    case("*", "--density-invariant", ""),
    case("*", "--keep-creases", ""),
    // The signal.
    case("*", "--signal", "heat"),
    in_file(with(case("*", "--texture", "second.png"), "--signal texture-luminance"), "texture.obj"),
    with(case("*", "--as-numbers", ""), "--signal classification"),
    with(case("*", "--keep-sentinels", ""), "--signal depth.csv"),
    with(case("*", "--local-fit", "constant"), "--signal heat"),
    // The levels.
    case("*", "--levels", "5"),
    case("*", "--voices", "2"),
    case("*", "--steps", "1,3,9"),
    case("*", "--lengths", "5%,10%,20%"),
    case("*", "--fwhm", "5%,10%,20%"),
    with(case("*", "--accuracy", "0.1"), "--steps 1.5,20,300"),
    case("tiles", "--accuracy", "0.1"),
    with(case("filter", "--precision", "single"), "--signal heat --local-fit constant"),
    with(case("info", "--accuracy", "0.1"), "--detail --steps 1.5,20,300"),
    case("info", "--detail", ""),
    case("info", "--error", "1%"),
    // Results.
    case("*", "--output", "out/other.ply"),
    case("features", "--output", "out/other.csv"),
    case("match", "--output", "out/other.csv"),
    case("render", "--output", "out/other.png"),
    case("report", "--output", "out/other.html"),
    case("tiles", "--output", "out/other.las"),
    case("*", "--region", "ball:vertex=31,radius=20%"),
    case("*", "--border", "keep"),
    case("*", "--keep-normals", ""),
    // region
    with(case("region", "--invert-mask", ""), "--mask mask.csv --region ball:vertex=30,radius=40%"),
    with(case("region", "--operator", "surface"), "--region field:name=saliency,high=0.01"),
    with(case("region", "--density-invariant", ""), "--region field:name=saliency,high=0.01"),
    with(case("region", "--keep-creases", ""), "--region field:name=saliency,high=0.01"),
    // filter
    with(case("filter", "--as-labels", ""), "--signal classification"),
    with(case("filter", "--preset", "enhance"), "!--gains"),
    case("filter", "--gains", "1,2,0"),
    in_file(case("filter", "--keep-volume", ""), "closed.ply"),
    in_file(with(case("filter", "--value-type", "f32"), "-o out/r.tif"), "image.tif"),
    in_file(with(case("filter", "--time-fwhm", "3s"), "-o out/r.nii"), "series.nii"),
    in_file(with(case("filter", "--time-lengths", "2"), "-o out/r.nii"), "series.nii"),
    in_file(with(case("filter", "--time-gains", "2"), "-o out/r.nii --time-fwhm 3s"), "series.nii"),
    in_file(with(case("filter", "--time-step", "1s"), "-o out/r.nii --time-fwhm 3s"), "series.nii"),
    in_file(with(case("filter", "--time-ends", "causal"), "-o out/r.nii --time-fwhm 3s"), "series.nii"),
    with(case("filter", "--directions", "lines"), "--signal normals"),
    in_file(with(case("filter", "--tensors", "fsl"), "-o out/r.nii"), "tensors.nii"),
    in_file(
        with(case("filter", "--gains-by-time", "0,2;1,0"), "-o out/r.nii --time-fwhm 3s !--gains !--preset"),
        "series.nii",
    ),
    in_file(with(case("denoise", "--value-type", "f32"), "-o out/r.tif"), "image.tif"),
    with(case("denoise", "--directions", "lines"), "--signal normals"),
    in_file(with(case("denoise", "--tensors", "fsl"), "-o out/r.nii"), "tensors.nii"),
    case("filter", "--along", "z"),
    with(case("filter", "--recipe", "recipe.toml"), "!--gains !--preset"),
    case("filter", "--save-recipe", "out/saved.toml"),
    with(case("filter", "--save-steps", ""), "--save-recipe out/saved.toml"),
    // denoise
    with(case("denoise", "--operator", "surface"), "--signal heat"),
    with(case("denoise", "--rings", "2"), "--signal heat"),
    with(case("denoise", "--mesh-area", "mixed-voronoi"), "--signal heat"),
    with(case("denoise", "--neighbors", "5"), "--signal heat"),
    with(case("denoise", "--directed", ""), "--signal heat"),
    with(case("denoise", "--cloud-area", "unit"), "--signal heat"),
    with(case("denoise", "--density-invariant", ""), "--signal heat"),
    with(case("denoise", "--keep-creases", ""), "--signal heat"),
    in_file(case("denoise", "--outliers", "drop"), "outliers.xyz"),
    case("denoise", "--strength", "2"),
    case("denoise", "--creases", "none"),
    case("denoise", "--noise-sigma", "0.03"),
    case("denoise", "--shared-noise", "auto"),
    case("denoise", "--noise-map", ""),
    with(case("denoise", "--noise-model", "poisson"), "--signal gaze"),
    in_file(with(case("denoise", "--in-time", ""), "-o out/r.nii"), "series.nii"),
    in_file(with(case("denoise", "--time-step", "1s"), "-o out/r.nii --in-time"), "series.nii"),
    in_file(with(case("denoise", "--time-ends", "causal"), "-o out/r.nii --in-time"), "series.nii"),
    // transform
    in_file(with(case("transform", "--time-fwhm", "3s,9s"), "-o out/r.npz"), "series.nii"),
    in_file(with(case("transform", "--time-lengths", "2,8"), "-o out/r.npz"), "series.nii"),
    in_file(with(case("transform", "--time-step", "1s"), "-o out/r.npz --time-fwhm 3s"), "series.nii"),
    in_file(with(case("transform", "--time-ends", "periodic"), "-o out/r.npz --time-fwhm 3s"), "series.nii"),
    with(case("transform", "--directions", "lines"), "--signal normals"),
    in_file(with(case("transform", "--tensors", "fsl"), "-o out/r.nii"), "tensors.nii"),
    case("transform", "--basis", "irregular"),
    with(case("transform", "--keep", "0.1"), "--basis irregular"),
    with(case("transform", "--inverse", ""), "--basis irregular"),
    in_file(with(case("transform", "--sharp-edges", "30"), "--basis catmull-clark"), "quads.ply"),
    in_file(with(case("transform", "--border-corners", "sharp"), "--basis catmull-clark"), "quads.ply"),
    // simplify
    in_file(with(case("simplify", "--level", "1"), "!--ratio"), "levels.ply"),
    with(case("simplify", "--error", "2%"), "!--ratio"),
    with(case("simplify", "--vertices", "100"), "!--ratio"),
    case("simplify", "--ratio", "0.7"),
    case("simplify", "--measure", ""),
    case("simplify", "--keep-border", ""),
    case("simplify", "--weights", "mean-curvature"),
    in_file(with(case("simplify", "--allow-degrees", ""), "--error 2 !--ratio"), "scan2.las"),
    // deform, rebase, transfer and morph
    case("deform", "--fix", "ball:vertex=31,radius=20%"),
    case("deform", "--move", "vertices:indices=3"),
    case("deform", "--by", "0,0.1,0"),
    with(case("deform", "--to", "0,0,1"), "!--by"),
    with(case("deform", "--turn", "z,30,0,0,1"), "!--by"),
    with(case("deform", "--matrix", "shift.txt"), "!--by"),
    with(case("deform", "--recipe", "pose.toml"), "!--fix !--move !--by"),
    with(case("deform", "--shares", "0.5"), "!--fix !--move !--by --recipe pose.toml"),
    case("deform", "--stiffness", "20%"),
    case("deform", "--keep-lengths", "1"),
    case("*", "--width", "10%"),
    with(case("rebase", "--write-base", "out/base.ply"), "!--base !--output"),
    case("rebase", "--base", "mesh2.ply"),
    in_file(with(case("rebase", "--level", "1"), "!--base !--output --write-base out/base.ply"), "quads.ply"),
    in_file(
        with(case("rebase", "--family", "linear"), "!--base !--output --write-base out/base.ply --level 1"),
        "quads.ply",
    ),
    in_file(
        with(case("rebase", "--sharp-edges", "30"), "!--base !--output --write-base out/base.ply --level 1"),
        "quads.ply",
    ),
    in_file(
        with(
            case("rebase", "--border-corners", "sharp"),
            "!--base !--output --write-base out/base.ply --level 1",
        ),
        "quads.ply",
    ),
    case("transfer", "--from", "creature.ply"),
    case("transfer", "--region", "ball:vertex=31,radius=30%"),
    case("morph", "--share", "2"),
    case("morph", "--band-shares", "0,1"),
    with(case("morph", "--levels", "1"), "--band-shares 0"),
    // resample
    case("resample", "--from", "ball3.ply"),
    case("resample", "--to", "ball3.ply"),
    case("resample", "--keep", "sum"),
    case("resample", "--from-areas", "egg.ply"),
    case("resample", "--to-areas", "egg2.ply"),
    case("resample", "--to-mask", "inside"),
    case("resample", "--zeros", "values"),
    // animate
    case("animate", "--positions", "moves2.npy"),
    case("animate", "--animation", "Second"),
    case("animate", "--output", "out/other.npy"),
    case("animate", "--still", ""),
    case("animate", "--denoise", ""),
    with(case("animate", "--strength", "0.5"), "--denoise"),
    case("animate", "--gains", "0,1,2"),
    case("animate", "--motion", "out/m.ply"),
    case("animate", "--time-fwhm", "3s"),
    case("animate", "--time-lengths", "2"),
    with(case("animate", "--time-gains", "2"), "--time-fwhm 3s"),
    with(case("animate", "--time-step", "2s"), "--time-fwhm 3s"),
    with(case("animate", "--time-ends", "causal"), "--time-fwhm 3s"),
    // Maps and features.
    case("*", "--mask-border", "1"),
    case("*", "--skip", "1"),
    case("*", "--weighting", "paper"),
    with(case("evaluate", "--weighting", "paper"), "--levels 5"),
    case("*", "--unsigned", ""),
    case("*", "--up", "x"),
    case("saliency", "--per-level", ""),
    case("saliency", "--color-map", "turbo"),
    case("saliency", "--color-top", "50"),
    in_file(case("*", "--theta", "1.2"), "creature.ply"),
    in_file(case("*", "--response", "sigma"), "creature.ply"),
    in_file(case("*", "--per-component", ""), "creature.ply"),
    in_file(case("*", "--refine", ""), "creature.ply"),
    in_file(case("*", "--edge-ratio", "2"), "creature.ply"),
    in_file(case("*", "--best", "2"), "creature.ply"),
    in_file(case("features", "--descriptors", ""), "creature.ply"),
    // evaluate
    case("evaluate", "--percent", "40"),
    case("evaluate", "--runs", "2"),
    in_file(case("evaluate", "--within", "0.2"), "creature.ply"),
    with(case("evaluate", "--fixations", "gaze"), "!--runs !--percent !--theta"),
    case("evaluate", "--threshold", "0.3"),
    case("evaluate", "--map", "heat"),
    // match
    in_file(with(case("match", "--noise", "0.3"), "--vertices 2000"), "sample:creature"),
    in_file(with(case("match", "--seed", "9"), "--noise 0.3 --vertices 2000"), "sample:creature"),
    in_file(case("match", "--as", "cloud"), "creature.ply"),
    in_file(with(case("match", "--neighbors", "5"), "--as cloud"), "creature.ply"),
    in_file(with(case("match", "--directed", ""), "--as cloud"), "creature.ply"),
    in_file(case("match", "--keep-creases", ""), "creature.ply"),
    case("match", "--picture", "out/pairs.png"),
    in_file(case("match", "--moved", "out/moved.ply"), "creature.ply"),
    in_file(case("match", "--motion", "none"), "creature.ply"),
    in_file(case("match", "--within", "0.1"), "creature.ply"),
    in_file(with(case("match", "--search-points", "200"), "--as cloud"), "creature.ply"),
    in_file(with(case("match", "--ratio", "0.5"), "--motion none"), "creature.ply"),
    with(case("match", "--view", "top"), "--picture out/pairs.png"),
    with(case("match", "--up", "x"), "--picture out/pairs.png"),
    // diff
    case("diff", "--levels", "3"),
    case("diff", "--align", ""),
    case("diff", "--by", "closest"),
    with(case("diff", "--limit", "1%"), "--by closest"),
    with(case("diff", "--view", "top"), "-o out/r.html"),
    with(case("diff", "--up", "x"), "-o out/r.html"),
    // basis
    case("basis", "--vertex", "7"),
    case("basis", "--level", "3"),
    case("basis", "--levels", "3"),
    case("basis", "--drop-tolerance", "0.01"),
    case("*", "--walk", "walk.mtx"),
    with(case("denoise", "--walk", "walk.mtx"), "--signal degree"),
    // impute
    case("impute", "--output", "out/other.npy"),
    case("impute", "--time", "3"),
    case("impute", "--genes", "0,2"),
    case("impute", "--layer", "counts"),
    with(case("impute", "--library-size", "median"), "--time 3"),
    with(case("impute", "--sqrt", ""), "--time 3"),
    case("impute", "--seed", "5"),
    with(case("impute", "--precision", "single"), "--time 3"),
    case("impute", "--curve", "out/curve.csv"),
    with(case("impute", "--graph", "graph.mtx"), "!--points"),
    with(case("impute", "--walk", "walk.mtx"), "!--points"),
    case("impute", "--points", "counts.npy"),
    with(case("impute", "--symmetrize", "mean"), "!--points --graph graph.mtx"),
    // scatter
    case("scatter", "--output", "out/other.npy"),
    case("scatter", "--field", "counts.npy"),
    case("scatter", "--scales", "1,3"),
    case("scatter", "--orders", "1"),
    case("scatter", "--pool", "moments"),
    case("scatter", "--precision", "single"),
    with(case("scatter", "--batch", "batch.npy"), "--pool mean"),
    with(case("scatter", "--graph", "graph2.mtx"), "!--graph"),
    with(case("scatter", "--walk", "walk.mtx"), "!--graph"),
    with(case("scatter", "--points", "cells.npy"), "!--graph"),
    with(case("scatter", "--neighbors", "5"), "!--graph --points cells.npy"),
    with(case("scatter", "--kernel", "paper"), "!--graph --points cells.npy"),
    with(case("scatter", "--normalize", "column"), "!--graph --points cells.npy"),
    // walks
    case("*", "--kernel", "paper"),
    case("*", "--self-loops", "3"),
    case("*", "--symmetrize", "maximum"),
    case("*", "--normalize", "symmetric"),
    case("*", "--stay", "0.25"),
    // compare
    with(case("compare", "--with", "taubin"), "!--harmonics"),
    case("compare", "--harmonics", "30"),
    // render and pictures
    case("*", "--view", "top"),
    case("render", "--color", "heat"),
    with(case("render", "--color-map", "turbo"), "--color x"),
    with(case("render", "--range", "0,0.3"), "--color x"),
    with(case("render", "--no-bar", ""), "--color x"),
    case("render", "--features", "balls.csv"),
    case("render", "--glyphs", "coords"),
    with(case("render", "--glyph-kind", "crosses"), "--glyphs coords"),
    case("render", "--zoom", "2"),
    case("render", "--frame", "all"),
    case("render", "--focus", "vertex=5"),
    case("render", "--orthographic", ""),
    in_file(case("render", "--relief", "0.1"), "image.tif"),
    case("render", "--size", "80x90"),
    case("render", "--transparent", ""),
    case("render", "--crease", "5"),
    case("render", "--grid", ""),
    with(case("render", "--own-scale", ""), "closed.ply --grid"),
    in_file(with(case("render", "--texture", "second.png"), "--color texture"), "texture.obj"),
    // tiles
    case("tiles", "--gains", "1,2,0"),
    with(case("tiles", "--levels", "4"), "!--gains --magnitudes 2"),
    case("tiles", "--magnitudes", "2"),
    case("tiles", "--vectors", "1"),
    case("tiles", "--saliency", ""),
    with(case("tiles", "--skip", "1"), "--saliency"),
    case("tiles", "--features", "out/f.csv"),
    with(case("tiles", "--theta", "1"), "--features out/f.csv"),
    with(case("tiles", "--denoise", ""), "!--gains"),
    with(case("tiles", "--strength", "2"), "--denoise !--gains"),
    with(case("tiles", "--creases", "none"), "--denoise !--gains"),
    with(case("tiles", "--shared-noise", "0.2"), "--denoise !--gains"),
    with(case("tiles", "--noise-sigma", "0.3"), "--denoise !--gains"),
    case("tiles", "--along", "z"),
    case("tiles", "--border", "free"),
    with(case("tiles", "--local-fit", "constant"), "--along z"),
    with(case("tiles", "--keep-volume", "twice"), "!--gains --gains 0,0"),
    with(case("tiles", "--allow-degrees", ""), "--denoise --noise-sigma 0.3 !--gains"),
    case("tiles", "--memory", "90M"),
    case("tiles", "--tiles", "2"),
    case("tiles", "--workers", "2"),
    case("tiles", "--work", "out/work"),
    case("tiles", "--forecast", ""),
    case("tiles", "--plan-only", ""),
    case("tiles", "--keep-work", ""),
    case("tile", "--if-missing", ""),
    // Others.
    case("formats", "--markdown", ""),
    case("sample", "--vertices", "90"),
    case("sample", "--points", "100"),
    with(case("convert", "--all-points", ""), "--only z=..99"),
    case("convert", "--turn-faces", "all"),
    case("demo", "--vertices", "2300"),
    case("demo", "--output", "out/tour"),
    case("compare", "--output", "out/results"),
    case("reproduce", "--output", "out/paper"),
    case("reproduce", "--models", "."),
    case("reproduce", "--markdown", "out/paper.md"),
    case("reproduce", "--most-vertices", "300"),
    case("man", "--output", "out/pages"),
    // A server: its options are tested where it is started.
    case("studio", "--port", "1"),
    case("studio", "--no-open", ""),
    case("studio", "--host", "::1"),
    case("studio", "--i-know", ""),
];

/// Lines of a command without options.
pub(crate) fn base_lines(command: &str) -> &'static [&'static str] {
    let found = BASES.iter().find(|(name, _)| *name == command);
    found.unwrap_or_else(|| panic!("add a line of '{command}' to BASES in option_cases.rs")).1
}

/// Words of a line on an input of one kind.
pub(crate) fn base_line(line: &str, kind: &str) -> Vec<String> {
    let (_, file) = crate::fixtures::INPUTS.iter().find(|(name, _)| *name == kind).unwrap();
    file_line(line, file)
}

/// Words of a line on a file.
pub(crate) fn file_line(line: &str, file: &str) -> Vec<String> {
    let other = match file.rsplit_once('.') {
        Some((stem, extension))
            if ["mesh", "cloud", "curve", "graph", "scan", "creature"].contains(&stem) =>
        {
            format!("{stem}2.{extension}")
        }
        _ => file.to_owned(),
    };
    let other = if other == "scan2.las" { "scan.las".to_owned() } else { other };
    split_words(&line.replace("{in}", file).replace("{other}", &other))
}

/// The case of an option of a command.
pub(crate) fn option_case(command: &str, option: &str) -> &'static OptionCase {
    let of = |name: &str| CASES.iter().find(|case| case.command == name && case.option == option);
    of(command).or_else(|| of("*")).unwrap_or_else(|| {
        panic!("add a case for {option} of '{command}' to CASES in option_cases.rs: a value that makes a difference")
    })
}

/// Words of a base line with further words: an option that is given again replaces its value, and `!--option` takes one away.
pub(crate) fn with_words(base: &[String], further: &[String]) -> Vec<String> {
    let mut words = base.to_vec();
    let mut rest = further.iter().peekable();
    while let Some(word) = rest.next() {
        if let Some(option) = word.strip_prefix('!') {
            remove(&mut words, option);
        } else if word.starts_with('-') {
            let option = word.split('=').next().unwrap_or(word);
            remove(&mut words, if option == "-o" { "--output" } else { option });
            words.push(word.clone());
            if let Some(value) = rest.next_if(|next| !next.starts_with(['-', '!']) && !word.contains('=')) {
                words.push(value.clone());
            }
        } else {
            words.push(word.clone());
        }
    }
    words
}

/// Takes an option and its value away.
fn remove(words: &mut Vec<String>, option: &str) {
    let is_it = |word: &String| word == option || (option == "--output" && word == "-o");
    if let Some(at) = words.iter().position(is_it) {
        let has_value = words.get(at + 1).is_some_and(|next| !next.starts_with('-'));
        words.drain(at..=at + usize::from(has_value));
    }
}

#[test]
fn every_case_is_of_an_option() {
    let commands = crate::harness::commands();
    for case in CASES {
        let has = |command: &clap::Command| {
            (case.command == "*" || command.get_name() == case.command)
                && crate::harness::options(command).iter().any(|arg| crate::harness::name(arg) == case.option)
        };
        assert!(commands.iter().any(has), "no command {} has {}", case.command, case.option);
    }
    for (name, _) in BASES {
        assert!(commands.iter().any(|command| command.get_name() == name), "there is no command {name}");
    }
}

#[test]
fn an_option_that_is_given_again_replaces_its_value() {
    let words = |line: &str| split_words(line);
    let merged = with_words(&words("basis a --level 2 -o r.ply"), &words("-o r.npz --levels 2"));
    assert_eq!(merged, words("basis a --level 2 -o r.npz --levels 2"));
    assert_eq!(with_words(&words("x --theta 1"), &words("--theta=2")), words("x --theta=2"));
}
