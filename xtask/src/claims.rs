//! `cargo xtask bench-claims`: the page `docs/BENCHMARKS.md` and the tables in `docs/benchmarks`, made from the pages
//! on which the measurements stand.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Folder of the tables, from the root of the repository.
const TABLES: &str = "docs/benchmarks";
/// Page that says for each claim how it was measured.
const PAGE: &str = "docs/BENCHMARKS.md";

/// A claim with the table that it rests on.
struct Claim {
    /// Name of its file below [`TABLES`], without the ending.
    name: &'static str,
    says: &'static str,
    /// Page with the table, in `docs`.
    page: &'static str,
    /// Heading above the table, with its signs of the level.
    heading: &'static str,
    /// Number of the table below the heading, from 0.
    table: usize,
    /// Line above the paragraph that names the machine.
    machine: &'static str,
    command: &'static str,
    /// List of the peers with their versions.
    peers: &'static str,
    settings: &'static str,
    /// Where adwave loses, or does not win.
    losses: &'static str,
}

/// All claims, in the order of the page.
const CLAIMS: [Claim; 11] = [
    Claim {
        name: "bands",
        says: "All bands of a shape of 556,051 vertices are computed faster than by SciPy, VTK and PyGSP.",
        page: "PERFORMANCE.md",
        heading: "### All bands of xyz, J = 8, 556,051 vertices",
        table: 0,
        machine: "## Machine",
        command: "cargo xtask bench-peers --only bands",
        peers: "benches/peers/requirements.txt",
        settings: "All get the same operator, matrices ready, each in a process of its own. VTK smooths once, with 40 \
                   iterations and its own weights. Least / median.",
        losses: "VTK on all cores misses the goal of 5 times. Up to three levels, single products are cheaper.",
    },
    Claim {
        name: "matrices",
        says: "The matrices Φ₁ … Φ₆ are computed faster than by MKL, GraphBLAS and SciPy.",
        page: "PERFORMANCE.md",
        heading: "### Φ₁ … Φ₆ stored, 34,834 vertices",
        table: 0,
        machine: "## Machine",
        command: "cargo xtask bench-peers --only basis",
        peers: "benches/peers/requirements.txt",
        settings: "Peers square, drop entries below 1e-6 and divide rows by their sums. We store single precision.",
        losses: "MKL misses the goal of 10 times.",
    },
    Claim {
        name: "memory",
        says: "The peak memory of the first call, result included.",
        page: "PERFORMANCE.md",
        heading: "## Peak memory during the first call, result included",
        table: 0,
        machine: "## Machine",
        command: "cargo xtask bench-peers --only memory",
        peers: "benches/peers/requirements.txt",
        settings: "Each program in a new process.",
        losses: "SciPy needs less for the bands, and for the matrices in single precision; VTK needs half for one band.",
    },
    Claim {
        name: "smoothing-a-volume",
        says: "From narrow to wide, the cost of smoothing a volume doubles at most.",
        page: "PERFORMANCE.md",
        heading: "### One level",
        table: 0,
        machine: "<!-- measured grids: begin -->",
        command: "cargo xtask bench-grids",
        peers: "benches/grids/requirements.txt",
        settings: "SciPy's gaussian_filter, cut at 4 standard deviations; one core; ours in double precision.",
        losses: "SciPy is faster at σ = 1.",
    },
    Claim {
        name: "bands-of-grids",
        says: "Eight bands of an image and of a volume are faster than a Gaussian for each scale.",
        page: "PERFORMANCE.md",
        heading: "### Eight bands, σ from 0.7 to 90 places",
        table: 0,
        machine: "<!-- measured grids: begin -->",
        command: "cargo xtask bench-grids",
        peers: "benches/grids/requirements.txt",
        settings: "SciPy works in single precision and on one core, ours in double precision on all.",
        losses: "The comparison is of two cores with one.",
    },
    Claim {
        name: "heat-in-a-mask",
        says: "Nothing crosses a mask.",
        page: "PERFORMANCE.md",
        heading: "### Heat in a mask",
        table: 0,
        machine: "<!-- measured grids: begin -->",
        command: "cargo xtask bench-grids",
        peers: "benches/grids/requirements.txt",
        settings: "SciPy without a mask, on one core: a Gaussian that crosses the mask does less.",
        losses: "On one core the mask costs more than a Gaussian without one.",
    },
    Claim {
        name: "series-of-volumes",
        says: "A series of volumes is smoothed from file to file.",
        page: "PERFORMANCE.md",
        heading: "### A series of volumes",
        table: 0,
        machine: "<!-- measured grids: begin -->",
        command: "cargo xtask bench-grids",
        peers: "benches/grids/requirements.txt",
        settings: "nibabel and SciPy on one core; 60 frames, times 20.",
        losses: "None in time, with two cores against one.",
    },
    Claim {
        name: "denoising",
        says: "Without tuning, adwave leaves the smallest angle between normals on published pairs of meshes.",
        page: "DENOISING.md",
        heading: "## Mean angle of the normals, degrees",
        table: 0,
        machine: "<!-- measured: begin -->",
        command: "cargo xtask bench-peers --only denoise --models FOLDER_WITH_PAIRS",
        peers: "benches/denoise/requirements.txt",
        settings: "All with their defaults; DENOISING.md names them. Pairs that were published are not ours to ship; \
                   without them the built-in shapes are compared.",
        losses: "Noise of a scanner: on the bracket four programs leave less, and on the creature every program, adwave too, \
                 leaves more than there was. Taubin smoothing is a little better on the creature with noise along its \
                 normals.",
    },
    Claim {
        name: "denoising-time",
        says: "Denoising a mesh takes about a second for 36,000 vertices.",
        page: "DENOISING.md",
        heading: "## Time and memory",
        table: 0,
        machine: "<!-- measured: begin -->",
        command: "cargo xtask bench-peers --only denoise --models FOLDER_WITH_PAIRS",
        peers: "benches/denoise/requirements.txt",
        settings: "Ours from file to file, the others the call alone; in turns.",
        losses: "Bilateral filtering takes half the time and a quarter of the memory.",
    },
    Claim {
        name: "reading-files",
        says: "Text formats are read faster than by other libraries.",
        page: "PERFORMANCE.md",
        heading: "## Reading files",
        table: 0,
        machine: "## Reading files",
        command: "python benches/formats/speed.py",
        peers: "benches/formats/requirements.txt",
        settings: "Files in the cache of the system; medians of five in turns.",
        losses: "A ratio below 1: for eleven binary formats a peer is faster, up to five times.",
    },
    Claim {
        name: "large-clouds",
        says: "Bands of ten million points, from file to file, take as long as one smoothing by SciPy in memory.",
        page: "SCALE.md",
        heading: "### Other programs",
        table: 0,
        machine: "### Clouds",
        command: "cargo xtask bench-clouds",
        peers: "benches/clouds/requirements.txt",
        settings: "Every program uses both cores where it can. The others compute one quantity at one scale.",
        losses: "Open3D needs half the time for one quantity, CloudCompare for outliers.",
    },
];

/// Lines of a page below a heading, up to the next heading.
fn section<'a>(page: &'a str, heading: &str) -> Result<Vec<&'a str>, String> {
    let mut lines = page.lines().skip_while(|line| *line != heading);
    lines.next().ok_or_else(|| format!("there must be a line “{heading}”"))?;
    Ok(lines.take_while(|line| !line.starts_with('#')).collect())
}

/// Rows of a table below a heading, the head first; cells are without signs of emphasis and of code.
fn table_rows(page: &str, claim: &Claim) -> Result<Vec<Vec<String>>, String> {
    let lines = section(page, claim.heading)?;
    let tables: Vec<&[&str]> =
        lines.split(|line| !line.starts_with('|')).filter(|rows| rows.len() > 2).collect();
    let rows = tables.get(claim.table).ok_or_else(|| format!("“{}” must have a table", claim.heading))?;
    let cells = |row: &str| -> Vec<String> {
        let inside = row.trim().trim_start_matches('|').trim_end_matches('|');
        inside.split('|').map(|cell| cell.replace("**", "").replace('`', "").trim().to_owned()).collect()
    };
    Ok(rows.iter().enumerate().filter(|(k, _)| *k != 1).map(|(_, row)| cells(row)).collect())
}

/// Text of a table as comma-separated values.
fn csv(rows: &[Vec<String>]) -> String {
    let quoted = |cell: &String| {
        if cell.contains([',', '"']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
    };
    rows.iter().map(|row| row.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n").collect()
}

/// First paragraph below a line of a page, on one line, that names a machine.
fn machine_below(page: &str, line: &str) -> Result<String, String> {
    let below: Vec<&str> = page.lines().skip_while(|other| *other != line).skip(1).collect();
    let paragraph = below
        .split(|line| line.is_empty())
        .find(|lines| lines.iter().any(|line| line.contains("cores")))
        .ok_or_else(|| format!("a paragraph below “{line}” must name the machine"))?;
    Ok(paragraph.join(" "))
}

/// Peers of a list of requirements, as one line.
fn peers(root: &Path, list: &str) -> Result<String, String> {
    let text = read(root, list)?;
    Ok(text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.replace("==", " "))
        .collect::<Vec<_>>()
        .join(", "))
}

fn read(root: &Path, path: &str) -> Result<String, String> {
    std::fs::read_to_string(root.join(path)).map_err(|e| format!("cannot read {path}: {e}"))
}

/// Day on which the first row of a table came into the history, or “not in the history”.
fn day_in_history(root: &Path, claim: &Claim, page: &str) -> String {
    let row = section(page, claim.heading)
        .ok()
        .and_then(|lines| lines.into_iter().filter(|line| line.starts_with('|')).nth(2))
        .unwrap_or_default();
    let path = format!("docs/{}", claim.page);
    let words = ["log", "-1", "--format=%as", "-S", row, "--", &path];
    let day = Command::new("git").current_dir(root).args(words).output();
    let day = day.map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned());
    day.ok().filter(|day| !day.is_empty()).unwrap_or_else(|| "not in the history".to_owned())
}

/// Texts of the page and of its tables, by their paths from the root; `day` gives the day of a measurement.
fn render(root: &Path, day: &dyn Fn(&Claim, &str) -> String) -> Result<BTreeMap<String, String>, String> {
    let mut files = BTreeMap::new();
    let mut text = "\
# Benchmarks that you can run

You doubt a number, or want those of your machine. Each part says what is claimed, which command measures it, on which
machine it was measured, with which peers and settings, and where adwave loses. The figures were not measured for this
page: they are the rows of the pages named, of the day on which these came into the history.

```sh
cargo xtask bench-claims             # this page and its tables, from the measurements that the pages have
cargo xtask bench-claims --measure   # measure again first, an hour and a half; installs the peers below target/
```

"
    .to_owned();
    for claim in &CLAIMS {
        let page = read(root, &format!("docs/{}", claim.page))?;
        let rows = table_rows(&page, claim).map_err(|e| format!("{}: {e}", claim.page))?;
        let machine = machine_below(&page, claim.machine).map_err(|e| format!("{}: {e}", claim.page))?;
        let path = format!("{TABLES}/{}.csv", claim.name);
        let n_rows = rows.len() - 1;
        let plural = if n_rows == 1 { "" } else { "s" };
        let title = claim.name.replace('-', " ");
        let (first, rest) = title.split_at(1);
        let title = first.to_uppercase() + rest;
        let facts = [
            ("Claim", claim.says.to_owned()),
            ("Command", format!("`{}`", claim.command)),
            ("Machine", machine),
            ("Peers", peers(root, claim.peers)?),
            ("Settings", claim.settings.to_owned()),
            ("Losses", claim.losses.to_owned()),
            ("Measured", format!("{} ([{}]({}))", day(claim, &page), claim.page, claim.page)),
            ("Table", format!("[{}.csv](benchmarks/{}.csv), {n_rows} row{plural}", claim.name, claim.name)),
        ];
        let _ = write!(text, "## {title}\n\n| | |\n|---|---|\n");
        for (name, fact) in facts {
            let _ = writeln!(text, "| {name} | {} |", fact.replace('|', "\\|"));
        }
        text.push('\n');
        files.insert(path, csv(&rows));
    }
    files.insert(PAGE.to_owned(), text.trim_end().to_owned() + "\n");
    Ok(files)
}

/// Writes the page and its tables.
///
/// # Errors
/// A line of text if a page has no such table, or a file cannot be written.
pub fn write(root: &Path) -> Result<(), String> {
    std::fs::create_dir_all(root.join(TABLES)).map_err(|e| format!("cannot make {TABLES}: {e}"))?;
    for (path, text) in render(root, &|claim, page| day_in_history(root, claim, page))? {
        std::fs::write(root.join(&path), text).map_err(|e| format!("cannot write {path}: {e}"))?;
        println!("{path}");
    }
    Ok(())
}

/// Differences of the committed page and tables from those that the measured pages give; days are not compared, because a
/// copy of the repository may have no history.
///
/// # Errors
/// A line of text if a page has no such table, or a file is missing.
pub fn differences(root: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for (path, text) in render(root, &|_, _| "DAY".to_owned())? {
        let committed = read(root, &path)?;
        let without_days = |line: &str| {
            let is_day = line.starts_with("| Measured | ");
            if is_day {
                line.split_once(" (").map_or("", |(_, rest)| rest).to_owned()
            } else {
                line.to_owned()
            }
        };
        let (new, old): (Vec<_>, Vec<_>) =
            (text.lines().map(without_days).collect(), committed.lines().map(without_days).collect());
        if new != old {
            found.push(format!("{path} is not that of the measured pages; run `cargo xtask bench-claims`"));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::{csv, machine_below, section};

    #[test]
    fn sections_end_at_the_next_heading_and_cells_are_quoted() {
        let page =
            "# A\n\n## M\n\nwords\n\nTwo cores\nof a kind.\n\n| a | b |\n|---|---|\n| 1 | 2 |\n## B\n| c |\n";
        assert_eq!(section(page, "## M").unwrap().len(), 9);
        assert!(section(page, "## C").unwrap_err().contains("## C"));
        assert_eq!(machine_below(page, "## M").unwrap(), "Two cores of a kind.");
        let rows = [vec!["a, b".to_owned(), "say \"x\"".to_owned()]];
        assert_eq!(csv(&rows), "\"a, b\",\"say \"\"x\"\"\"\n");
    }
}
