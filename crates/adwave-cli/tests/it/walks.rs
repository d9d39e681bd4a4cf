//! Walks without a shape: imputation and scattering against direct computations, and what is refused.

use crate::cells_file::write_cells_file;
use crate::common::{adwave, json, refused, words};
use adwave::Progress;
use adwave_graph::{AnnDataFile, AnnDataMatrix};
use adwave_io::{ArrayValues, ReadLimits, read_npy, write_npy};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Nodes of the ring.
const N: usize = 40;

/// Genes of the counts.
const GENES: usize = 3;

fn count(node: usize, gene: usize) -> f64 {
    ((node * 7 + gene * 11) % 13 + 2 * node / N) as f64
}

/// Writes a ring as edges and as a matrix, counts in both forms, points on a circle and a field.
fn write_ring(folder: &Path) {
    let at = |name: &str| folder.join(name);
    let (mut edges, mut entries, mut counts) = (String::new(), String::new(), String::new());
    let (mut named, mut bare) = (",CD4,g1,g2\n".to_owned(), String::new());
    for x in 0..N {
        writeln!(edges, "{x} {}", (x + 1) % N).unwrap();
        for y in [(x + 1) % N, (x + N - 1) % N] {
            writeln!(entries, "{} {} 1", x + 1, y + 1).unwrap();
        }
        for g in 0..GENES {
            writeln!(counts, "{} {} {}", x + 1, g + 1, count(x, g)).unwrap();
        }
        let row = format!("{},{},{}", count(x, 0), count(x, 1), count(x, 2));
        writeln!(named, "{x},{row}").unwrap();
        writeln!(bare, "{row}").unwrap();
    }
    let banner = "%%MatrixMarket matrix coordinate real general\n";
    fs::write(at("ring.txt"), edges).unwrap();
    fs::write(at("ring.mtx"), format!("{banner}{N} {N} {}\n{entries}", 2 * N)).unwrap();
    fs::write(at("cells.csv"), named.replace('\n', "\r\n")).unwrap();
    fs::write(at("counts.csv"), bare).unwrap();
    fs::write(at("counts.mtx"), format!("{banner}{N} {GENES} {}\n{counts}", N * GENES)).unwrap();
    let values: Vec<f64> = (0..N * GENES).map(|i| count(i / GENES, i % GENES)).collect();
    write_npy(&at("counts.npy"), &[N, GENES], ArrayValues::F64(&values)).unwrap();
    let angle = |x: usize| std::f64::consts::TAU * x as f64 / N as f64;
    let points: Vec<f64> = (0..N).flat_map(|x| [angle(x).cos(), angle(x).sin()]).collect();
    write_npy(&at("points.npy"), &[N, 2], ArrayValues::F64(&points)).unwrap();
}

fn read(folder: &Path, name: &str) -> Vec<f64> {
    read_npy(&folder.join(name), &ReadLimits::default()).unwrap().values.to_f64()
}

/// A step of the walk on the ring that stays with the weight of one neighbor times `stay`.
fn step(values: &[f64], stay: f64) -> Vec<f64> {
    let d = values.len() / N;
    let at = |x: usize, c: usize| values[x % N * d + c];
    (0..N * d)
        .map(|i| {
            let (x, c) = (i / d, i % d);
            (at(x + 1, c) + at(x + N - 1, c) + stay * at(x, c)) / (2.0 + stay)
        })
        .collect()
}

fn assert_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn imputed_counts_are_those_of_powers_of_the_walk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_ring(path);
    let mut expected: Vec<f64> = (0..N * GENES).map(|i| count(i / GENES, i % GENES)).collect();
    for _ in 0..3 {
        expected = step(&expected, 1.0);
    }
    for counts in ["counts.npy", "counts.mtx", "counts.csv", "cells.csv"] {
        for graph in ["--graph ring.txt", "--graph ring.mtx"] {
            json(path, &format!("impute {counts} -o i.npy {graph} --time 3"));
            assert_near(&read(path, "i.npy"), &expected);
        }
    }
    json(path, "impute counts.npy -o one.npy --graph ring.txt --time 3 --genes 2");
    let gene: Vec<f64> = expected.iter().copied().skip(2).step_by(GENES).collect();
    assert_near(&read(path, "one.npy"), &gene);
    json(path, "impute cells.csv -o one.npy --graph ring.txt --time 3 --genes g2");
    assert_near(&read(path, "one.npy"), &gene);
    let text = fs::read_to_string(path.join("cells.csv")).unwrap();
    for (from, to, named) in [
        ("\r\n2,", "\r\n2,x", "line 4: column CD4 must have a number, got \"x"),
        ("\r\n2,", "\r\n2,,", "same number of cells"),
    ] {
        fs::write(path.join("wrong.csv"), text.replacen(from, to, 1)).unwrap();
        let error = refused(path, "impute wrong.csv -o o.npy --graph ring.txt --time 3");
        assert!(error.contains("wrong.csv") && error.contains(named), "{error}");
    }
    let error = refused(path, "impute cells.csv -o o.npy --graph ring.txt --time 3 --genes CD8A");
    assert!(error.contains("the names of its columns"), "{error}");
    let chosen = adwave(path).args(words("impute counts.npy -o i.npy --graph ring.txt --json")).assert();
    let output = chosen.success().get_output().clone();
    assert!(
        String::from_utf8(output.stderr).unwrap().contains("note: a graph that was made from these counts")
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let errors: Vec<f64> = report["errors"].as_array().unwrap().iter().map(|e| e.as_f64().unwrap()).collect();
    let steps = report["steps"].as_f64().unwrap() as usize;
    assert!(errors.iter().all(|e| *e >= errors[steps]));
}

#[test]
fn cells_of_an_anndata_are_imputed_into_a_copy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_cells_file(&path.join("cells.h5ad"), N, GENES, &count);
    let mut expected: Vec<f64> = (0..N * GENES).map(|i| count(i / GENES, i % GENES)).collect();
    for _ in 0..3 {
        expected = step(&expected, 1.0);
    }
    let matrix = |name: &str| {
        let file = AnnDataFile::open(&path.join(name), 1 << 20).unwrap();
        let AnnDataMatrix::Dense(values, _) = file.matrix(None, Progress::none()).unwrap() else {
            panic!("X of {name} is dense")
        };
        (values, file.gene_names().unwrap(), file.matrix(Some("counts"), Progress::none()).is_ok())
    };
    json(path, "impute cells.h5ad -o all.h5ad --layer counts --time 3");
    let (values, genes, has_layer) = matrix("all.h5ad");
    assert_near(&values, &expected);
    assert_eq!((genes.len(), has_layer), (GENES, true));
    // X is twice the layer.
    json(path, "impute cells.h5ad -o one.h5ad --genes g2,CD4 --time 3");
    let (values, genes, has_layer) = matrix("one.h5ad");
    let pairs: Vec<f64> = expected.chunks(GENES).flat_map(|row| [2.0 * row[2], 2.0 * row[0]]).collect();
    assert_near(&values, &pairs);
    assert_eq!((genes, has_layer), (vec!["g2".to_owned(), "CD4".to_owned()], false));
    json(path, "impute cells.h5ad -o all.npy --layer counts --time 3");
    assert_near(&read(path, "all.npy"), &expected);
    let bytes = fs::read(path.join("cells.h5ad")).unwrap();
    fs::write(path.join("cut.h5ad"), &bytes[..bytes.len() / 2]).unwrap();
    fs::write(path.join("text.h5ad"), "no file of this kind").unwrap();
    for (line, named) in [
        ("impute cut.h5ad -o o.h5ad", "cannot be read"),
        ("impute text.h5ad -o o.h5ad", "cannot be read"),
        ("impute cells.h5ad -o o.h5ad --layer raw", "the file has counts"),
        ("impute cells.h5ad -o o.h5ad --genes CD3", "`CD3`"),
        ("impute cells.h5ad -o o.mtx", ".npy or .h5ad"),
        ("impute cells.h5ad -o o.npy --max-input 100", "--max-input"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(named), "{line}: {error}");
        assert!(!path.join("o.h5ad").exists());
    }
}

#[test]
fn a_given_walk_and_points_of_any_dimension_take_the_place_of_a_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_ring(path);
    let banner = "%%MatrixMarket matrix coordinate real general\n";
    let entries: String = (0..N).fold(String::new(), |text, x| {
        let (before, after) = ((x + N - 1) % N + 1, (x + 1) % N + 1);
        text + &format!("{} {before} 0.25\n{} {} 0.5\n{} {after} 0.25\n", x + 1, x + 1, x + 1, x + 1)
    });
    fs::write(path.join("walk.mtx"), format!("{banner}{N} {N} {}\n{entries}", 3 * N)).unwrap();
    // The walk of the ring is that of its graph, so that all results agree.
    for command in [
        "filter ring.mtx -o r.npy --signal points.npy --preset smooth --steps 1,2,4",
        "denoise ring.mtx -o r.npy --signal points.npy",
    ] {
        json(path, command);
        let own = read(path, "r.npy");
        json(path, &format!("{command} --walk walk.mtx"));
        assert_near(&read(path, "r.npy"), &own);
    }
    for command in [
        "info ring.mtx",
        "saliency ring.mtx -o r.npy --signal points.npy",
        "features ring.mtx --signal points.npy --theta 0.1",
        "report ring.mtx -o r.html --signal points.npy",
    ] {
        json(path, &format!("{command} --walk walk.mtx"));
    }
    // Two neighbors of a point on a circle are those on the ring.
    let report = json(path, "info points:points.npy --neighbors 2");
    assert_eq!(report["health"]["vertices"], N);
    for command in [
        "filter points:points.npy -o r.npy --signal points.npy --preset smooth",
        "saliency points:points.npy -o r.npy --signal points.npy",
    ] {
        json(path, &format!("{command} --neighbors 2"));
    }
    for (line, named) in [
        (
            "filter ring.mtx -o o.npy --signal points.npy --preset smooth --walk walk.mtx --density-invariant",
            "not with --walk",
        ),
        ("info ring.mtx --walk counts.mtx", "sums to"),
        ("info points:none.npy", "none.npy"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(named), "{line}: {error}");
    }
}

#[test]
fn scattering_is_the_size_of_differences_of_powers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_ring(path);
    let line = "scatter --graph ring.txt --field points.npy -o s.npy --scales 1,2 --orders 0,1";
    let report = json(path, line);
    assert_eq!(report["shape"], serde_json::json!([3, N, 2]));
    let field = read(path, "points.npy");
    let once = step(&field, 2.0);
    let twice = step(&once, 2.0);
    let size = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect() };
    assert_near(&read(path, "s.npy"), &[field.clone(), size(&field, &once), size(&once, &twice)].concat());
}

#[test]
fn single_precision_keeps_to_the_bound_that_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_ring(path);
    for line in [
        "impute counts.npy -o o.npy --points points.npy --time 3",
        "scatter --points points.npy --field counts.npy -o o.npy",
        "scatter --points points.npy --field counts.npy -o o.npy --normalize column",
    ] {
        let double = json(path, line)["products"].clone();
        assert_eq!(json(path, &format!("{line} --precision auto"))["products"], double, "{line}");
        assert!(double["precision"] == "double" && double["error_bound"].as_f64().unwrap() < 1e-12, "{line}");
        let exact = read(path, "o.npy");
        let single = json(path, &format!("{line} --precision single"))["products"].clone();
        assert_eq!(single["precision"], "single", "{line}");
        let bound = single["error_bound"].as_f64().unwrap();
        let output = adwave(path).args(words(&format!("{line} --precision single"))).assert().success();
        let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
        assert!(text.contains("single precision: "), "{text}");
        let largest = exact.iter().copied().fold(0.0, f64::max);
        let error = exact.iter().zip(read(path, "o.npy")).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error > 0.0 && error <= bound * largest && bound < 1e-5, "{line}: {error:e} {bound:e}");
    }
    let half = "impute counts.npy -o o.npy --points points.npy --stay 0.5 --time 0.5 --precision single";
    assert_eq!(json(path, half)["products"]["precision"], "double");
}

#[test]
fn options_of_the_walk_apply_to_points() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_ring(path);
    let plain = "impute counts.npy -o i.npy --points points.npy --time 2";
    assert_eq!(json(path, plain)["graph"]["nodes"], N);
    let before = read(path, "i.npy");
    for options in
        ["--neighbors 4", "--kernel paper", "--self-loops 3", "--normalize symmetric", "--stay 0.25"]
    {
        json(path, &format!("{plain} {options}"));
        assert!(read(path, "i.npy") != before, "{options}");
    }
    json(path, &format!("{plain} --neighbors 4 --kernel self-tuning --self-loops 0 --stay 0.5"));
}

#[test]
fn what_is_no_walk_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_ring(path);
    let banner = "%%MatrixMarket matrix coordinate real general\n";
    for (name, text) in [
        ("wide.mtx", format!("{banner}{N} 4000000000 1\n1 1 5\n")),
        ("tall.mtx", format!("{banner}99999999 3 1\n1 1 5\n")),
        ("gaps.txt", "0 4000000000\n".to_owned()),
        ("endless.txt", "1".repeat(1 << 20)),
        ("long.txt", "0 1\n".repeat(600)),
        ("half.mtx", format!("{banner}2 2 2\n1 1 0.6\n2 2 1\n")),
    ] {
        fs::write(path.join(name), text).unwrap();
    }
    for (line, named) in [
        ("impute wide.mtx -o o.npy --graph ring.txt --time 1", "empty"),
        ("impute tall.mtx -o o.npy --graph ring.txt --time 1", "empty"),
        ("impute counts.npy -o o.npy --graph gaps.txt", "without gaps"),
        ("impute counts.npy -o o.npy --graph endless.txt", "fewer than 65536 bytes"),
        ("impute counts.npy -o o.npy --walk half.mtx", "sums to 0.6"),
        ("impute counts.npy -o o.npy --graph ring.txt --neighbors 3", "--neighbors applies to points"),
        ("impute counts.npy -o o.npy --walk ring.mtx --stay 0.5", "--stay applies to weights"),
        ("impute counts.npy -o o.npy --graph ring.txt --time 1e300", "got 1e300"),
        ("impute counts.npy -o o.npy --graph long.txt --max-input 2000", "--max-input"),
        ("scatter --graph ring.txt --field counts.mtx -o o.npy", "read from .npy"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(named), "{line}: {error}");
        assert!(!path.join("o.npy").exists());
    }
    for line in [
        "impute counts.npy -o o.npy",
        "scatter --graph ring.txt --points points.npy --field points.npy -o o.npy",
    ] {
        adwave(path).args(words(line)).assert().code(2);
    }
}

#[test]
fn the_graph_of_cells_is_chosen_from_counts_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let (n, n_genes) = (120, 40);
    // Smooth rates along a line of cells, and rounding noise of a fixed pattern.
    let value = |x: usize, g: usize| {
        let angle = x as f64 / n as f64 * (1.0 + (g % 3) as f64) * std::f64::consts::PI + g as f64;
        let noise = ((x * 7919 + g * 104_729) % 13) as f64 / 13.0;
        (6.0 + 4.0 * angle.sin() + 3.0 * noise).floor()
    };
    let counts: Vec<f64> = (0..n).flat_map(|x| (0..n_genes).map(move |g| value(x, g))).collect();
    write_npy(&path.join("counts.npy"), &[n, n_genes], ArrayValues::F64(&counts)).unwrap();
    let found = json(path, "impute counts.npy -o all.npy --curve curve.csv");
    let (choice, steps) = (&found["choice"], found["steps"].as_f64().unwrap() as u64);
    assert_eq!(choice["compared"].as_array().unwrap().len(), 14);
    assert_eq!(choice["steps_by_gene"].as_array().unwrap().len(), n_genes);
    assert_eq!(choice["best"]["steps"].as_u64(), Some(steps));
    let least = choice["best"]["unexplained_share"].as_f64().unwrap();
    for graph in choice["compared"].as_array().unwrap() {
        assert!(graph["unexplained_share"].as_f64().unwrap() >= least - 1e-12);
    }
    let curve = fs::read_to_string(path.join("curve.csv")).unwrap();
    let errors: Vec<f64> =
        curve.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert_eq!(errors.len(), 32);
    assert!((errors[steps as usize - 1] - least).abs() < 1e-12);
    let all = read(path, "all.npy");
    json(path, "impute counts.npy -o some.npy --genes 7,2");
    let some = read(path, "some.npy");
    for x in 0..n {
        assert_eq!(some[2 * x..][..2], [all[x * n_genes + 7], all[x * n_genes + 2]]);
    }
    let text = adwave(path).args(words("impute counts.npy -o all.npy")).assert().success();
    let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
    assert!(text.contains("chosen by 8 genes held back from the graphs of 120 cells"), "{text}");
    let time = refused(path, "impute counts.npy -o all.npy --time 3");
    assert!(time.contains("--time"), "{time}");
    let neighbors = refused(path, "impute counts.npy -o all.npy --neighbors 3");
    assert!(neighbors.contains("the graph is chosen"), "{neighbors}");
    write_npy(&path.join("few.npy"), &[20, n_genes], ArrayValues::F64(&counts[..20 * n_genes])).unwrap();
    let few = refused(path, "impute few.npy -o few-out.npy");
    assert!(few.contains("at least 50 cells"), "{few}");
}

/// Points of the unit sphere along a spiral, and values that vary from each to the next.
fn write_sphere(folder: &Path) {
    let n = 3000;
    let point = |k: usize| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), 2.399_963 * k as f64);
        [r * angle.cos(), r * angle.sin(), z]
    };
    let points: Vec<[f64; 3]> = (0..n).map(point).collect();
    write_npy(&folder.join("p.npy"), &[n, 3], ArrayValues::F64(points.as_flattened())).unwrap();
    let flat: Vec<f64> = points.iter().flat_map(|p| [p[0], p[1]]).collect();
    write_npy(&folder.join("flat.npy"), &[n, 2], ArrayValues::F64(&flat)).unwrap();
    let four: Vec<f64> = points.iter().flat_map(|p| [p[0], p[1], p[2], 0.0]).collect();
    write_npy(&folder.join("four.npy"), &[n, 4], ArrayValues::F64(&four)).unwrap();
    let text = |p: &[f64; 3]| format!("{:?} {:?} {:?}\n", p[0], p[1], p[2]);
    fs::write(folder.join("p.xyz"), points.iter().map(text).collect::<String>()).unwrap();
    let plane: String = points.iter().map(|p| text(&[p[0], p[1], 0.0])).collect();
    fs::write(folder.join("flat.xyz"), plane).unwrap();
    let values: Vec<f64> = (0..n).map(|k| (7.0 * k as f64 * k as f64).sin()).collect();
    write_npy(&folder.join("f.npy"), &[n], ArrayValues::F64(&values)).unwrap();
}

#[test]
fn points_of_the_plane_and_of_space_are_clouds_with_lengths() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_sphere(path);
    for (table, cloud) in [("points:p.npy", "p.xyz"), ("points:flat.npy", "flat.xyz")] {
        for levels in ["--fwhm 0.2618", "--fwhm 5%", "--lengths 0.1", "--steps 8"] {
            for shape in [table, cloud] {
                json(path, &format!("filter {shape} -o o.npy --signal f.npy {levels} --gains 0"));
                fs::rename(path.join("o.npy"), path.join(format!("{}.npy", shape.len()))).unwrap();
            }
            assert_eq!(
                read(path, &format!("{}.npy", table.len())),
                read(path, &format!("{}.npy", cloud.len())),
                "{table} {levels}"
            );
        }
    }
    assert_eq!(json(path, "info points:p.npy --as cloud")["health"]["vertices"], 3000);
    let graph = "filter points:p.npy --as graph -o o.npy --signal f.npy --gains 0";
    json(path, &format!("{graph} --steps 8"));
    let output =
        adwave(path).args(words(&format!("{graph} --fwhm 5%"))).assert().code(2).get_output().clone();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("adwave: a width in % needs positions"), "{said}");
    let error = refused(path, "info points:four.npy --as cloud");
    assert!(error.contains("a cloud has two or three columns, got 4"), "{error}");
    json(path, "filter points:four.npy -o o.npy --signal f.npy --gains 0 --steps 8");
}

#[test]
fn a_given_walk_is_not_said_to_be_made_symmetric() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let banner = "%%MatrixMarket matrix coordinate real general\n";
    let rows = "1 1 0.5\n1 2 0.5\n2 2 0.25\n2 3 0.75\n3 1 1\n";
    fs::write(path.join("walk.mtx"), format!("{banner}3 3 5\n{rows}")).unwrap();
    write_npy(&path.join("f.npy"), &[3], ArrayValues::F64(&[1.0, 2.0, 4.0])).unwrap();
    let line = "transform walk.mtx -o b.npz --signal f.npy --steps 1,2";
    let notes = |line: &str| {
        let output = adwave(path).args(words(line)).assert().success().get_output().clone();
        String::from_utf8(output.stderr).unwrap()
    };
    let own = notes(line);
    assert!(own.contains("not symmetric") && own.contains("--walk FILE takes"), "{own}");
    let given = notes(&format!("{line} --walk walk.mtx"));
    assert!(!given.contains("not symmetric") && given.contains("the walk is directed"), "{given}");
}
