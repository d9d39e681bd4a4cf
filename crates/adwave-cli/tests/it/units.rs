//! Units of length, degrees, and digits of coordinates, as commands say them.

use crate::common;

use adwave_io::{Format, LengthUnit, ReadLimits, ShapeFile, read_path, write_path};
use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;

/// Notes that a command prints.
fn notes(folder: &Path, line: &str) -> String {
    let output = adwave(folder).args(words(line)).assert().success().get_output().stderr.clone();
    String::from_utf8(output).unwrap()
}

/// A sphere in that unit.
fn part(path: &Path, unit: LengthUnit) {
    let sample = adwave::sample::Sample::from_name("sphere", Some(200)).unwrap();
    let mut file = ShapeFile::from_mesh(sample.points, sample.faces);
    file.set_length_unit(Some(unit));
    write_path(&file, path, None).unwrap();
}

fn unit_of(path: &Path) -> Option<String> {
    let file = read_path(path, &ReadLimits::default()).unwrap();
    file.length_unit().map(|unit| unit.name().to_owned())
}

#[test]
fn units_are_shown_kept_and_converted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (unit, ending) in [
        (LengthUnit::INCH, "3mf"),
        (LengthUnit::INCH, "amf"),
        (LengthUnit::FOOT, "amf"),
        (LengthUnit::MICRON, "3mf"),
        (LengthUnit::CENTIMETER, "3mf"),
    ] {
        let name = unit.name().to_owned();
        let file = format!("a.{ending}");
        part(&path.join(&file), unit);
        let info = json(path, &format!("info {file}"));
        assert_eq!(info["unit"], name);
        let text = adwave(path).args(["info", &file]).assert().success().get_output().stdout.clone();
        assert!(String::from_utf8(text).unwrap().contains(&format!("  unit          {name}\n")));
        for command in ["convert", "denoise", "simplify --ratio 0.9", "filter --preset smooth"] {
            let (first, rest) = command.split_once(' ').unwrap_or((command, ""));
            let said = notes(path, &format!("{first} {file} -o out.{ending} {rest}"));
            assert!(!said.contains("unit"), "{command}: {said}");
            assert_eq!(unit_of(&path.join(format!("out.{ending}"))), Some(name.clone()), "{command}");
        }
        let said = notes(path, &format!("convert {file} -o out.glb"));
        assert!(said.contains("to meters (times"), "{said}");
        let said = notes(path, &format!("convert {file} -o out.stl"));
        assert_eq!(said.matches("no unit of length; the numbers stay in").count(), 1, "{said}");
    }
    assert!(json(path, "info sample:sphere")["unit"].is_null());
}

const DEGREES: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                       PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
const METERS: &str = "PROJCS[\"UTM zone 33N\",GEOGCS[\"WGS 84\",UNIT[\"degree\",0.0174]],UNIT[\"metre\",1]]";

/// Terrain in a LAS with that coordinate system.
fn scan(path: &Path, system: &str) {
    let point = |k: u32| {
        let (x, y) = (f64::from(k % 25), f64::from(k / 25));
        [13.0 + 1e-5 * x, 52.0 + 1e-5 * y, 30.0 + (0.3 * x).sin()]
    };
    write_path(&ShapeFile::from_cloud((0..625).map(point).collect()), path, Some(Format::LAS)).unwrap();
    let mut bytes = fs::read(path).unwrap();
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let mut record = vec![0; 54];
    record[2..17].copy_from_slice(b"LASF_Projection");
    record[18..20].copy_from_slice(&2112_u16.to_le_bytes());
    record[20..22].copy_from_slice(&(system.len() as u16).to_le_bytes());
    record.extend(system.as_bytes());
    let n_records = u32::from_le_bytes(bytes[100..104].try_into().unwrap()) + 1;
    bytes[96..100].copy_from_slice(&((start + record.len()) as u32).to_le_bytes());
    bytes[100..104].copy_from_slice(&n_records.to_le_bytes());
    bytes.splice(start..start, record);
    fs::write(path, bytes).unwrap();
}

#[test]
fn lengths_are_refused_in_degrees() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    scan(&path.join("degrees.las"), DEGREES);
    scan(&path.join("meters.las"), METERS);
    let info = json(path, "info degrees.las");
    assert_eq!(info["coordinate_system"]["name"], "WGS 84");
    assert_eq!(info["coordinate_system"]["kind"], "geographic");
    assert!(info["unit"].is_null());
    let info = json(path, "info meters.las");
    assert_eq!((&info["coordinate_system"]["kind"], &info["unit"]), (&"projected".into(), &"meter".into()));
    for (line, option) in [
        ("filter degrees.las -o o.las --preset smooth --lengths 1,2,4", "--lengths"),
        ("filter degrees.las -o o.las --preset smooth --fwhm 1,2,4", "--lengths"),
        ("transform degrees.las -o o.npz --fwhm 1,2", "--fwhm"),
        ("info degrees.las --lengths 1,2", "--lengths"),
        ("info degrees.las --error 0.5", "--error"),
        ("denoise degrees.las -o o.las --noise-sigma 0.1", "--noise-sigma"),
        ("denoise degrees.las -o o.las --region ball:vertex=3,radius=2", "--region"),
        ("simplify degrees.las -o o.las --error 0.5", "--error"),
        ("saliency degrees.las -o o.npy --lengths 1,2,4", "--lengths"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(option) && error.contains("degrees (WGS 84)"), "{line}: {error}");
        assert!(error.contains("--allow-degrees"), "{error}");
    }
    // Percent of the diagonal, the flag, and a map in meters are fine.
    let said = notes(path, "filter degrees.las -o o.las --preset smooth --lengths 20%,40%");
    assert!(said.contains("longitudes and latitudes in degrees (WGS 84)"), "{said}");
    notes(path, "filter degrees.las -o o.las --preset smooth --lengths 1e-4,2e-4 --allow-degrees");
    notes(path, "simplify degrees.las -o o.las --error 1e-5 --allow-degrees");
    let said = notes(path, "filter meters.las -o o.las --preset smooth --lengths 1e-4,2e-4");
    assert!(!said.contains("degrees"), "{said}");
}

#[test]
fn steps_of_coordinates_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let rows = (0..900)
        .map(|k| {
            format!(
                "{} {} {}\n",
                0.7 * f64::from(k % 30),
                5_400_000.0 + 0.7 * f64::from(k / 30),
                0.1 * f64::from(k % 7)
            )
        })
        .collect::<Vec<_>>()
        .concat();
    fs::write(path.join("utm.xyz"), &rows).unwrap();
    let said = notes(path, "convert utm.xyz -o utm.las");
    assert!(said.contains("stored in steps of 0.001\n"), "{said}");
    let said = notes(path, "convert utm.xyz -o utm.off");
    assert!(!said.contains("32-bit"), "{said}");
    let head = "ply\nformat ascii 1.0\nelement vertex 900\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let single: String = rows
        .lines()
        .map(|row| {
            row.split(' ').map(|c| c.parse::<f32>().unwrap().to_string()).collect::<Vec<_>>().join(" ") + "\n"
        })
        .collect();
    fs::write(path.join("utm.ply"), head.to_owned() + &single).unwrap();
    for line in ["info utm.ply", "convert utm.ply -o utm.obj", "filter utm.ply -o out.ply --preset smooth"] {
        let said = notes(path, line);
        assert!(said.contains("multiples of 0.5, while neighbors are"), "{line}: {said}");
    }
    let said = notes(path, "convert utm.xyz -o utm.glb");
    assert!(said.contains("rounded to 32-bit floats, by up to 0.2,"), "{said}");
}
