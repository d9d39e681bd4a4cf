//! `adwave region`: the weights that a filter takes, in the files that others read.

use crate::common;

use adwave_io::{ReadLimits, read_csv_fields, read_gifti_fields, read_npy, read_path};
use common::{adwave, json, refused};
use std::path::Path;

const SPHERE: &str = "region sample:sphere --vertices 2000";
const CAP: &str = "--region 'half-space:point=0 0 0.5,normal=0 0 1,falloff=0'";

/// What a cap of height h has of the area of a sphere of radius 1, h/2, is met up to what one ring of vertices has of it.
const RING: f64 = 0.02;

fn weights(path: &Path) -> Vec<f64> {
    let limits = ReadLimits::default();
    match path.extension().unwrap().to_str().unwrap() {
        "npy" => read_npy(path, &limits).unwrap().into_field("weight").to_f64(),
        "csv" => read_csv_fields(path, &limits).unwrap()[0].to_f64(),
        "gii" => read_gifti_fields(path, &limits).unwrap()[0].to_f64(),
        _ => read_path(path, &limits).unwrap().field("weight").unwrap().to_f64(),
    }
}

#[test]
fn a_cap_is_counted_and_measured() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let found = json(path, &format!("{SPHERE} {CAP} -o mask.npy"));
    let mask = weights(&path.join("mask.npy"));
    let n_full = mask.iter().filter(|r| **r == 1.0).count();
    assert_eq!((&found["weight_1"], &found["weight_above_0"]), (&n_full.into(), &n_full.into()));
    assert!(mask.iter().all(|r| *r == 0.0 || *r == 1.0), "a fall of no width is a step");
    assert!((found["area_share"].as_f64().unwrap() - 0.25).abs() < RING, "{found}");
    let bounds = &found["bounding_box"];
    assert!(bounds["min"][2].as_f64().unwrap() >= 0.5 && bounds["max"][2].as_f64().unwrap() <= 1.0 + 1e-9);
    // A soft edge counts less by weight than by vertex.
    let soft = json(path, &format!("{SPHERE} --region 'half-space:point=0 0 0.5,normal=0 0 1'"));
    assert!(soft["weighted_area_share"].as_f64() < soft["area_share"].as_f64(), "{soft}");
    assert!(soft["output"].is_null());
    adwave(path)
        .args(common::words(&format!("{SPHERE} {CAP}")))
        .assert()
        .success()
        .stdout(predicates::str::contains("bounding box"));
}

#[test]
fn every_file_has_the_same_weights() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let line = format!("{SPHERE} --region 'ball:vertex=5,radius=15%' --region 'vertices:indices=1 2'");
    let read = |name: &str| {
        json(path, &format!("{line} -o {name}"));
        weights(&path.join(name))
    };
    let exact = read("mask.npy");
    assert!(exact.iter().any(|r| *r > 0.0 && *r < 1.0));
    assert_eq!((exact[1], exact[2], exact[5]), (1.0, 1.0, 1.0));
    assert!(read("mask.csv") == exact && read("mask.ply") == exact);
    assert!(read("mask.gii").iter().zip(&exact).all(|(a, b)| *a == f64::from(*b as f32)));
    json(path, &format!("{line} -o mask.vtp"));
}

#[test]
fn a_filter_with_the_mask_is_the_filter_with_the_region() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let region = "ball:vertex=5,radius=30%";
    json(path, &format!("{SPHERE} --region '{region}' -o mask.ply"));
    json(path, &format!("filter mask.ply -o a.npy --preset suppress --region '{region}'"));
    json(path, "filter mask.ply -o b.npy --preset suppress --region field:name=weight");
    let points = |name: &str| read_npy(&path.join(name), &ReadLimits::default()).unwrap().into_field("p");
    assert!(points("a.npy").n_channels == 3 && points("a.npy") == points("b.npy"));
}

#[test]
fn vertices_without_a_value_are_outside_of_the_region_of_a_field() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let rows = "0 0 0 0.5\n1 0 0 nan\n2 0 0 1\n3 0 0 0\n0 1 0 nan\n1 1 0 0.25\n2 1 0 0\n3 1 0 0\n";
    std::fs::write(path.join("a.csv"), format!("x y z t\n{rows}")).unwrap();
    for (region, weights) in [
        ("field:name=t,low=0,high=1", [0.5, 0.0, 1.0, 0.0, 0.0, 0.25, 0.0, 0.0]),
        ("field:name=t,low=1,high=0", [0.5, 0.0, 0.0, 1.0, 0.0, 0.75, 1.0, 1.0]),
    ] {
        let run =
            adwave(path).args(["region", "a.csv", "-o", "w.npy", "--region", region]).assert().success();
        let notes = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(
            notes.contains("the field 't' is NaN at 2 vertices, which are no part of its region"),
            "{notes}"
        );
        let found = read_npy(&path.join("w.npy"), &ReadLimits::default()).unwrap().values.to_f64();
        assert_eq!(found, weights, "{region}");
    }
}

#[test]
fn regions_of_graphs_have_no_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let matrix = "%%MatrixMarket matrix coordinate real symmetric\n3 3 2\n2 1 1\n3 2 1\n";
    std::fs::write(path.join("path.mtx"), matrix).unwrap();
    let found = json(path, "region path.mtx --region vertices:indices=1 -o mask.csv");
    assert_eq!((&found["weight_1"], found["area_share"].is_null()), (&1.into(), true));
    assert_eq!(weights(&path.join("mask.csv")), [0.0, 1.0, 0.0]);
    assert!(refused(path, "region path.mtx --region vertices:indices=1 -o mask.ply").contains("coordinates"));
    assert!(refused(path, "region path.mtx --region 'box:min=0 0 0,max=1 1 1'").contains("positions"));
}

#[test]
fn what_cannot_be_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (more, words) in [
        ("--region 'ball:vertex=99999,radius=1'", "vertex 99999"),
        ("--region field:name=heat", "heat"),
        ("--region all -o mask.obj", ".vtk, .msh, .graphml, .fits, .npy, .csv or .gii"),
        ("--region all -o nowhere/mask.ply", "nowhere"),
    ] {
        let error = refused(path, &format!("{SPHERE} {more}"));
        assert!(error.contains(words), "{more}: {error}");
    }
    let empty = format!("{SPHERE} --region 'box:min=8 8 8,max=9 9 9'");
    let run = adwave(path).args(common::words(&empty)).assert().success();
    assert!(String::from_utf8_lossy(&run.get_output().stderr).contains("no vertex is in the region"));
    adwave(path).args(["region", "sample:sphere"]).assert().code(2);
}

#[test]
fn a_point_off_the_shape_is_reported_and_so_is_what_stands_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (point, distance) in [("0 0 0.1", 0.9), ("0 0 50", 49.0)] {
        let line = format!("{SPHERE} --region 'ball:point={point},radius=0.6'");
        adwave(path)
            .args(common::words(&line))
            .assert()
            .success()
            .stderr(predicates::str::contains("from the shape, with a radius of 0.6"));
        let found = json(path, &line);
        let off = &found["points_off_the_shape"][0];
        assert!((off["distance"].as_f64().unwrap() - distance).abs() < 0.03, "{found}");
        assert!(found["weight_above_0"].as_u64().unwrap() > 0, "the nearest place stands for the point");
    }
    let on = format!("{SPHERE} --region 'ball:point=0 0 1,radius=0.6'");
    assert_eq!(json(path, &on)["points_off_the_shape"], serde_json::json!([]));
}
