//! Tests that reading and writing can be cancelled in every format, and report progress.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use adwave::shape::Polygons;
use adwave::{ClassifiedError, ErrorKind, Progress, ProgressCounter};
use adwave_io::{
    CiftiColumns, Edges, Field, FieldValues, Format, GridLayout, ReadError, ReadLimits, ShapeFile,
    WriteError, read_bytes, read_bytes_with, read_path, read_path_with, write_bytes, write_bytes_with,
    write_cifti_fields, write_path_with,
};

/// A strip of triangles with a field.
fn mesh() -> ShapeFile {
    const N: u32 = 20_000;
    let points = (0..N).map(|v| [f64::from(v / 2), f64::from(v % 2), 0.0]).collect();
    let triangles: Vec<[u32; 3]> = (0..N - 2).map(|f| [f, f + 1, f + 2]).collect();
    let mut mesh = ShapeFile::from_mesh(points, Polygons::from_triangles(&triangles));
    mesh.add_vertex_field(Field::new("color", 3, FieldValues::U8(vec![9; 3 * N as usize]))).unwrap();
    mesh
}

fn graph() -> ShapeFile {
    let pairs = (0..20_000).map(|v| [v + 1, v]).collect();
    ShapeFile::from_graph(20_001, Edges { pairs, ..Edges::default() })
}

fn image() -> ShapeFile {
    let mut image = ShapeFile::from_grid(GridLayout::new(&[600, 500], &[1.0, 1.0])).unwrap();
    let values = (0..300_000).map(|i| i as u16 % 251).collect();
    image.add_vertex_field(Field::new("values", 1, FieldValues::U16(values))).unwrap();
    image
}

/// A CIFTI of one surface.
fn brain() -> ShapeFile {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dscalar.nii");
    let field = Field::new("v", 10, FieldValues::F64((0..600_000).map(f64::from).collect()));
    write_cifti_fields(&path, &[field], "CortexLeft", CiftiColumns::Scalars).unwrap();
    read_path(&path, &ReadLimits::default()).unwrap()
}

fn shape_for(format: Format) -> ShapeFile {
    if format.holds_brains() {
        brain()
    } else if format == Format::FITS {
        sky()
    } else if format.holds_grids() {
        image()
    } else if format.holds_graphs() {
        graph()
    } else {
        mesh()
    }
}

/// Map of the sky of 12·64² pixels, with a field that its file does not have.
fn sky() -> ShapeFile {
    const N_SIDE: usize = 64;
    let n = 12 * N_SIDE * N_SIDE;
    let block = |cards: &[String]| {
        let text: String = cards.iter().map(|card| format!("{card:<80}")).collect::<Vec<_>>().concat();
        format!("{text:<0$}", text.len().next_multiple_of(2880))
    };
    let card = |name: &str, value: &str| format!("{name:<8}= {value:>20}");
    let text = |name: &str, value: &str| format!("{name:<8}= '{value:<8}'");
    let number = |name: &str, value: usize| card(name, &value.to_string());
    let end = || "END".to_owned();
    let first =
        block(&[card("SIMPLE", "T"), number("BITPIX", 8), number("NAXIS", 0), card("EXTEND", "T"), end()]);
    let table = block(&[
        text("XTENSION", "BINTABLE"),
        number("BITPIX", 8),
        number("NAXIS", 2),
        number("NAXIS1", 4),
        number("NAXIS2", n),
        number("PCOUNT", 0),
        number("GCOUNT", 1),
        number("TFIELDS", 1),
        text("TTYPE1", "T"),
        text("TFORM1", "E"),
        text("PIXTYPE", "HEALPIX"),
        text("ORDERING", "RING"),
        number("NSIDE", N_SIDE),
        text("INDXSCHM", "IMPLICIT"),
        end(),
    ]);
    let mut bytes = [first, table].concat().into_bytes();
    bytes.extend((0..n).flat_map(|k| (k as f32).sin().to_be_bytes()));
    bytes.resize(bytes.len().next_multiple_of(2880), 0);
    let mut map = read_bytes(bytes, Some("a.fits"), &ReadLimits::default()).unwrap();
    map.add_vertex_field(Field::new("more", 1, FieldValues::F64((0..n).map(|k| k as f64).collect())))
        .unwrap();
    map
}

fn writable() -> impl Iterator<Item = Format> {
    Format::all().filter(|f| f.can_write())
}

#[test]
fn writing_stops_at_whichever_report_it_is_told_to() {
    for format in writable() {
        let shape = shape_for(format);
        let n_reports = AtomicU64::new(0);
        let count = |_, _| {
            n_reports.fetch_add(1, Ordering::Relaxed);
        };
        let progress = Progress::none().with_report(&count);
        write_bytes_with(&shape, format, &mut Vec::new(), progress).unwrap();
        let n_reports = n_reports.into_inner();
        assert!(n_reports > 2, "{format}: {n_reports} reports");
        for nth in 0..n_reports {
            let (stop, seen) = (AtomicBool::new(false), AtomicU64::new(0));
            let report = |_, _| stop.store(seen.fetch_add(1, Ordering::Relaxed) == nth, Ordering::Relaxed);
            let progress = Progress::none().with_report(&report).with_cancel(&stop);
            let error = write_bytes_with(&shape, format, &mut Vec::new(), progress).unwrap_err();
            assert!(matches!(error, WriteError::Cancelled(_)), "{format}, report {nth}: {error}");
        }
    }
}

#[test]
fn reading_stops_at_whichever_report_it_is_told_to() {
    for format in writable().filter(|f| f.can_read()) {
        let mut bytes = Vec::new();
        write_bytes(&shape_for(format), format, &mut bytes).unwrap();
        let hint = format.extensions().first().map(|ending| format!("a.{ending}"));
        let read = |progress: Progress<'_>| {
            read_bytes_with(bytes.clone(), hint.as_deref(), &ReadLimits::default(), progress)
        };
        let n_reports = AtomicU64::new(0);
        let count = |_, _| {
            n_reports.fetch_add(1, Ordering::Relaxed);
        };
        read(Progress::none().with_report(&count)).unwrap();
        let n_reports = n_reports.into_inner();
        assert!(n_reports > 0, "{format}");
        for nth in 0..n_reports {
            let (stop, seen) = (AtomicBool::new(false), AtomicU64::new(0));
            let report = |_, _| stop.store(seen.fetch_add(1, Ordering::Relaxed) == nth, Ordering::Relaxed);
            let error = read(Progress::none().with_report(&report).with_cancel(&stop)).unwrap_err();
            assert!(matches!(error, ReadError::Cancelled(_)), "{format}, report {nth}: {error}");
        }
    }
}

#[test]
fn a_file_that_is_not_written_leaves_the_old_one_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    std::fs::write(&path, b"old").unwrap();
    let stop = AtomicBool::new(true);
    let progress = Progress::none().with_cancel(&stop);
    let error = write_path_with(&mesh(), &path, None, progress).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Cancelled);
    assert!(error.to_string().contains("a.ply"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);

    write_path_with(&mesh(), &path, None, Progress::none()).unwrap();
    let error = read_path_with(&path, &ReadLimits::default(), progress).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Cancelled);
}

#[test]
fn a_counter_can_be_polled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let counter = ProgressCounter::default();
    let progress = Progress::none().with_counter(&counter);
    write_path_with(&mesh(), &path, None, progress).unwrap();
    let (done, total) = counter.get();
    assert!(done <= total && total == 19_998, "{done} of {total} faces");
    read_path_with(&path, &ReadLimits::default(), progress).unwrap();
    let (done, total) = counter.get();
    assert!(done > 0 && done <= total, "{done} of {total}");
}
