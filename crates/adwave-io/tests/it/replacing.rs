//! A file is replaced as a whole or not at all.

use std::fs;
use std::io::Write;

use adwave_io::{Format, ShapeFile, Transaction, WriteError, atomic_write, write_path};

fn names(folder: &std::path::Path) -> Vec<String> {
    let mut all: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    all.sort();
    all
}

fn failing(out: &mut dyn Write) -> Result<(), WriteError> {
    out.write_all(b"half")?;
    Err(std::io::Error::other("the disk is full").into())
}

#[test]
fn an_error_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    fs::write(&path, "old").unwrap();
    let error = atomic_write(&path, failing).unwrap_err().to_string();
    assert!(
        error.contains("a.obj") && error.contains("the disk is full") && !error.contains('\n'),
        "{error}"
    );
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.obj"]);
    atomic_write(&folder.path().join("new"), failing).unwrap_err();
    assert_eq!(names(folder.path()), ["a.obj"]);
}

#[test]
fn a_panic_leaves_no_temporary_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let outcome = std::panic::catch_unwind(|| {
        let _: Result<(), _> = atomic_write(&path, |_| std::panic::resume_unwind(Box::new("stopped")));
    });
    assert!(outcome.is_err());
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn several_files_are_written_all_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a"), "old").unwrap();
    let whole = |files: &Transaction, name: &str| {
        files.write(&at(name), |path| atomic_write(path, |out| Ok(out.write_all(b"new")?)))
    };
    let failed = |files: &Transaction| -> Result<(), WriteError> {
        whole(files, "a")?;
        whole(files, "b")?;
        files.write(&at("c"), |path| atomic_write(path, failing))
    };
    let files = Transaction::new();
    let error = failed(&files).unwrap_err().to_string();
    drop(files);
    assert!(error.contains(&*at("c").to_string_lossy()) && !error.contains(".adwave-"), "{error}");
    assert_eq!(
        (fs::read(at("a")).unwrap().as_slice(), names(folder.path())),
        (&b"old"[..], vec!["a".into()])
    );
    let panicked = std::panic::catch_unwind(|| {
        let files = Transaction::new();
        whole(&files, "a").unwrap();
        std::panic::resume_unwind(Box::new("stopped"));
    });
    assert!(panicked.is_err());
    assert_eq!(names(folder.path()), ["a"]);
    let files = Transaction::new();
    whole(&files, "a").and_then(|()| whole(&files, "b")).unwrap();
    files.commit().unwrap();
    assert_eq!((fs::read(at("a")).unwrap().as_slice(), names(folder.path()).len()), (&b"new"[..], 2));
    whole(&Transaction::immediate(), "c").unwrap();
    assert_eq!(names(folder.path()), ["a", "b", "c"]);
}

#[test]
fn a_missing_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let shape = ShapeFile::from_cloud(vec![[0.0; 3]]);
    let error = write_path(&shape, &folder.path().join("no/a.ply"), None).unwrap_err().to_string();
    assert!(error.contains("does not exist; create it first"), "{error}");
    let error = write_path(&shape, &folder.path().join("a.blend"), None).unwrap_err().to_string();
    assert!(error.contains("use one of the endings .obj"), "{error}");
}

#[test]
fn gz_compresses_and_the_text_form_stays_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply.gz");
    let shape = ShapeFile::from_cloud(vec![[0.0, 0.5, 1.0]]);
    write_path(&shape, &path, Some(Format::PLY_ASCII)).unwrap();
    assert!(fs::read(&path).unwrap().starts_with(&[0x1f, 0x8b]));
    let again = adwave_io::read_path(&path, &adwave_io::ReadLimits::default()).unwrap();
    assert_eq!((again.format(), again.points()), (Some(Format::PLY_ASCII), shape.points()));
    let plain = folder.path().join("b.ply");
    write_path(&again, &plain, None).unwrap();
    assert!(fs::read(&plain).unwrap().starts_with(b"ply\nformat ascii"));
}

#[cfg(unix)]
#[test]
fn permissions_links_and_devices_are_respected() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let write =
        |path: &std::path::Path, text: &str| atomic_write(path, |w| Ok(w.write_all(text.as_bytes())?));
    let mode = |path: &std::path::Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    write(&path, "one").unwrap();
    // What any new file gets here.
    fs::File::create(folder.path().join("plain")).unwrap();
    assert_eq!(mode(&path), mode(&folder.path().join("plain")));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    write(&path, "two").unwrap();
    assert_eq!(mode(&path), 0o640);
    let link = folder.path().join("link");
    symlink("a", &link).unwrap();
    write(&link, "three").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&path).unwrap(), b"three");
    write(std::path::Path::new("/dev/null"), "gone").unwrap();
    assert_eq!(names(folder.path()), ["a", "link", "plain"]);
}

#[test]
fn what_a_killed_run_left_is_cleared_after_a_day() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in [".adwave-old.tmp", ".adwave-new.tmp", "adwave-mine.tmp", ".adwave-mine"] {
        fs::write(at(name), "half").unwrap();
    }
    let long_ago = std::time::SystemTime::now() - std::time::Duration::from_hours(25);
    for name in [".adwave-old.tmp", "adwave-mine.tmp", ".adwave-mine"] {
        fs::File::options().write(true).open(at(name)).unwrap().set_modified(long_ago).unwrap();
    }
    atomic_write(&at("a.txt"), |w| Ok(w.write_all(b"whole")?)).unwrap();
    assert!(!at(".adwave-old.tmp").exists());
    assert!(
        [".adwave-new.tmp", "adwave-mine.tmp", ".adwave-mine", "a.txt"].iter().all(|name| at(name).exists())
    );
}

#[test]
#[cfg(unix)]
fn a_file_that_root_replaces_stays_its_owners() {
    use std::os::unix::fs::{MetadataExt, chown};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    fs::write(&path, "old").unwrap();
    if chown(&path, Some(1234), Some(1234)).is_err() {
        println!("skipped: only root may give files away");
        return;
    }
    atomic_write(&path, |w| Ok(w.write_all(b"new")?)).unwrap();
    let metadata = fs::metadata(&path).unwrap();
    assert_eq!(
        (metadata.uid(), metadata.gid(), fs::read(&path).unwrap().as_slice()),
        (1234, 1234, &b"new"[..])
    );
}
