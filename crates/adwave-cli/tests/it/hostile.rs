//! Bad usage, bad input, bad machines: one clear line, the right exit code, old files intact.

use crate::common;

use adwave_test_data::data_test;
use common::{adwave, files_below, json, real_files, refused, words};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    fs::write(folder.join(name), content).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_beyond_the_limit_of_the_address_space_is_refused_before_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    // 300 MB that take no space.
    fs::File::create(folder.path().join("big.ply")).unwrap().set_len(300 << 20).unwrap();
    let limited = |limit: &str| {
        let program = adwave(folder.path()).get_program().to_owned();
        let line = format!("ulimit -v {limit}; exec \"$0\" --threads 1 info big.ply");
        let run =
            std::process::Command::new("sh").arg("-c").arg(line).arg(program).current_dir(&folder).output();
        let run = run.unwrap();
        assert_eq!(run.status.code(), Some(2), "{limit}");
        String::from_utf8(run.stderr).unwrap()
    };
    let told = limited("1000000");
    assert!(told.contains("exceeds the limit of 268435456") && told.contains("--max-input"), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
    assert!(!limited("unlimited").contains("exceeds"), "the machine has memory for it");
}

#[test]
fn what_is_wrong_with_a_file_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let nan_row = "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n";
    let binary_ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n\0\0\0\0\0\0\0\0";
    write(path, "empty.obj", "");
    write(path, "none.obj", "# no vertices\n");
    write(path, "nan.obj", nan_row);
    write(path, "inf.obj", nan_row.replace("nan", "inf"));
    write(path, "range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    write(path, "cut.ply", binary_ply);
    write(
        path,
        "huge.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
    );
    write(path, "text.docx", "just some words, no shape at all");
    for (file, named) in [
        ("empty.obj", "empty"),
        ("none.obj", "no vert"),
        ("nan.obj", "vertex 2"),
        ("inf.obj", "vertex 2"),
        ("range.obj", "line 4"),
        ("cut.ply", "byte"),
        ("huge.ply", "byte"),
        ("text.docx", "format"),
        ("missing.obj", "missing.obj"),
        (".", "."),
    ] {
        for command in [
            "info",
            "transform -o o.npz",
            "filter -o o.ply --preset suppress",
            "denoise -o o.ply",
            "simplify -o o.ply --ratio 0.5",
        ] {
            let (verb, rest) = command.split_once(' ').unwrap_or((command, ""));
            let error = refused(path, &format!("{verb} {file} {rest}"));
            assert!(error.contains(named) && error.contains(file), "{verb} {file}: {error}");
        }
    }
    assert!(!path.join("o.npz").exists() && !path.join("o.ply").exists());
}

#[test]
fn what_is_wrong_with_a_request_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write(path, "b.xyz", "0 0 0\n1 1 1\n");
    write(path, "bad.toml", "levels = 3\n[[layer]]\npresett = 'suppress'\n");
    write(path, "short.npy", b"\x93NUMPY\x01\x00\x46\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }            \n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
    for (line, named) in [
        ("transform a.obj -o o.npz --levels 0", "at least one level"),
        ("transform a.obj -o o.npz --levels 40", "32"),
        ("transform a.obj -o o.npz --steps 1,4,4", "increase"),
        ("transform a.obj -o o.npz --steps 0,4", "0 steps"),
        ("transform a.obj -o o.npz --lengths 3,2", "increasing"),
        ("transform a.obj -o o.npz --accuracy 0", "accuracy"),
        ("transform a.obj -o o.npz --accuracy nan", "accuracy"),
        ("transform a.obj -o o.npz --accuracy 1e-30", "accuracy"),
        ("transform a.obj -o o.npz --field heat", "heat"),
        ("transform a.obj -o o.npz --field short.npy", "2 rows"),
        ("transform a.obj -o o.npz --vertices 10", "--vertices"),
        ("transform a.obj -o nowhere/o.npz", "nowhere"),
        ("transform a.obj -o o.docx", ".npz"),
        ("transform a.obj -o .", "."),
        ("filter a.obj -o o.obj", "--preset"),
        ("filter a.obj -o o.obj --gains 1,2 --levels 3", "got 2"),
        ("filter a.obj -o o.obj --gains nan,2", "level 1"),
        ("filter a.obj -o o.obj --preset suppress --region 'ball:vertex=3,radius=1'", "vertex 3"),
        ("filter a.obj -o o.obj --preset suppress --region 'field:name=heat'", "no fields"),
        ("filter a.obj -o o.obj --preset suppress --region 'ball:vertex=1,radius=0'", "radius"),
        ("filter a.obj -o o.obj --recipe bad.toml", "line 3"),
        ("filter a.obj -o o.obj --recipe none.toml", "none.toml"),
        ("filter a.obj -o o.docx --preset suppress", "o.docx"),
        ("filter a.obj -o nowhere/o.obj --preset suppress", "nowhere"),
        ("basis a.obj --vertex 3 --level 2 -o o.ply", "vertex 3"),
        ("basis a.obj --vertex 1 --level 0 -o o.ply", "level"),
        ("basis a.obj --levels 40 -o o.npz", "32"),
        ("basis a.obj --levels 3 -o o.npz --drop-tolerance 2", "2"),
        ("info sample:teapot", "creature"),
        ("info sample:sphere --vertices 1", "1 vertices"),
        ("info sample:sphere --noise=-1", "deviation"),
        ("info b.xyz --as graph", "no edges"),
        ("sample sphere", "-o"),
        ("sample sphere -o o.docx", "o.docx"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(named), "{line}: {error}");
    }
    let left: Vec<_> = fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 4, "files were left behind: {left:?}");
}

#[test]
fn usage_errors_exit_with_2_too() {
    let folder = tempfile::tempdir().unwrap();
    for line in
        ["", "fly", "info", "filter a.obj", "filter a.obj -o b.obj --preset shiny", "info a --threads 0"]
    {
        adwave(folder.path()).args(words(line)).assert().code(2);
    }
    let line = "filter a.obj -o b.obj --preset suppress --region 'bal:radius=1'";
    let output = adwave(folder.path()).args(words(line)).assert().code(2);
    assert!(String::from_utf8_lossy(&output.get_output().stderr).contains("no region 'bal'"));
}

#[test]
fn odd_shapes_are_done_and_give_finite_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "one.xyz", "1 2 3\n");
    write(path, "equal.xyz", "1 2 3\n".repeat(50));
    write(path, "line.xyz", (0..50).fold(String::new(), |text, i| text + &format!("{i} 0 0\n")));
    write(path, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    write(path, "far.obj", "v 1e90 0 0\nv 0 1e90 0\nv 0 0 1e90\nf 1 2 3\n");
    write(path, "tiny.obj", "v 1e-200 0 0\nv 0 1e-200 0\nv 0 0 1e-200\nf 1 2 3\n");
    write(
        path,
        "fan.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 3\nf 2 2 2\nf 1 3\n",
    );
    for name in ["one.xyz", "equal.xyz", "line.xyz", "flat.obj", "far.obj", "tiny.obj", "fan.obj"] {
        for line in [
            format!("info {name} --json"),
            format!("transform {name} -o o.ply --levels 6 --json"),
            format!("transform {name} -o o.npz --levels 6 --no-weld --json"),
            format!("filter {name} -o o.obj --preset enhance --json"),
            format!("filter {name} -o o.obj --preset suppress --region 'ball:vertex=0,radius=50%' --json"),
        ] {
            let output = adwave(path).args(words(&line)).output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            if line.contains("50%") && !output.status.success() {
                // Half of nothing is no radius.
                assert_eq!(output.status.code(), Some(2), "{line}: {error}");
                assert!(error.contains("radius"), "{line}: {error}");
                continue;
            }
            assert!(output.status.success(), "{line}: {error}");
            // The name of a member, which has these letters.
            let text = String::from_utf8_lossy(&output.stdout).to_lowercase().replace("\"provenance\"", "");
            assert!(
                !text.contains("nan") && !text.contains("inf,") && !text.contains("null,\n      \"max"),
                "{line}: {text}"
            );
        }
        let obj = fs::read_to_string(path.join("o.obj")).unwrap().to_lowercase();
        assert!(!obj.contains("nan") && !obj.contains("inf"), "{name}: {obj}");
    }
}

/// Vertices of a sheet of 20 by 20, its heights a few hundredths and times `noise`.
fn sheet(noise: f64, scale: f64) -> String {
    let height = |k: u32| f64::from((k * 7919 + k * k * 31) % 97) / 97.0 - 0.5;
    let vertex = |k: u32| [f64::from(k % 20), f64::from(k / 20), noise * height(k)].map(|c| c * scale);
    let vertices = (0..400).map(vertex).map(|[x, y, z]| format!("v {x:e} {y:e} {z:e}\n"));
    let corners = (1..380).filter(|k| k % 20 > 0);
    let faces = corners.map(|k| format!("f {k} {} {}\nf {} {} {}\n", k + 1, k + 20, k + 1, k + 21, k + 20));
    vertices.chain(faces).collect()
}

#[test]
fn denoising_odd_shapes_says_what_was_assumed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "one.xyz", "1 2 3\n");
    write(path, "equal.xyz", "1 2 3\n".repeat(50));
    write(path, "line.xyz", (0..50).fold(String::new(), |text, i| text + &format!("{i} 0 0\n")));
    write(
        path,
        "cloud.xyz",
        sheet(0.2, 1.0)
            .lines()
            .filter_map(|l| l.strip_prefix("v "))
            .fold(String::new(), |text, row| text + row + "\n"),
    );
    write(path, "equal.obj", "v 1 1 1\n".repeat(6) + "f 1 2 3\nf 4 5 6\n");
    write(path, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    write(
        path,
        "no-area.obj",
        sheet(0.2, 1.0) + "v 5 5 0\nv 6 5 0\nv 7 5 0\nf 401 402 403\nf 1 1 2\nf 3 4 3\n",
    );
    write(
        path,
        "three-sheets.obj",
        sheet(0.2, 1.0) + "v 4 10 5\nf 205 206 401\nf 206 205 401\nf 1 2 21\nf 2 1 21\n",
    );
    write(path, "loud.obj", sheet(500.0, 1.0));
    write(path, "huge.obj", sheet(0.2, 1e95));
    write(path, "tiny.obj", sheet(0.2, 1e-200));
    write(path, "alone.obj", sheet(0.2, 1.0) + "v 100 100 100\n");
    for name in [
        "one.xyz",
        "equal.xyz",
        "line.xyz",
        "cloud.xyz",
        "equal.obj",
        "flat.obj",
        "no-area.obj",
        "three-sheets.obj",
        "loud.obj",
        "huge.obj",
        "tiny.obj",
        "alone.obj",
    ] {
        let out = format!("o.{}", &name[name.len() - 3..]);
        let line = format!("denoise {name} -o {out}");
        let said = adwave(path).args(words(&line)).assert().success().get_output().stdout.clone();
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains("noise along the normals: "), "{line}: {said}");
        assert!(!said.contains("NaN") && !said.contains("inf"), "{line}: {said}");
        let shape = fs::read_to_string(path.join(out)).unwrap();
        assert!(!shape.contains("NaN") && !shape.contains("inf"), "{name}: {shape}");
    }
    // The size of a shape does not matter: a change of scale changes the noise by as much.
    write(path, "usual.obj", sheet(0.2, 1.0));
    let in_edges =
        |name: &str| json(path, &format!("denoise {name} -o o.obj"))["denoise"]["noise_in_edges"].as_f64();
    let usual = in_edges("usual.obj").unwrap();
    for name in ["huge.obj", "tiny.obj"] {
        let same = in_edges(name).unwrap();
        assert!((same / usual - 1.0).abs() < 1e-6, "{name}: {same} mean edges, {usual} at the usual size");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_and_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = adwave(folder.path()).args(["sample", "sphere", "-o", "/dev/full"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "no ending tells the format");
    write(folder.path(), "old.ply", "precious");
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.ply")).unwrap();
    let output = adwave(folder.path()).args(["sample", "sphere", "-o", "full.ply"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("full.ply"));
    assert_eq!(fs::read_to_string(folder.path().join("old.ply")).unwrap(), "precious");
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_stops_soon_and_leaves_the_old_file() {
    for line in [
        "transform sample:sphere --vertices 100000 --levels 24 -o old.npz -q",
        "denoise sample:creature --vertices 1000000 -o old.ply -q",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let old = line.split(' ').find(|word| word.starts_with("old.")).unwrap();
        write(folder.path(), old, "precious");
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("adwave"))
            .current_dir(folder.path())
            .args(words(line))
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_secs(2));
        let killed =
            std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(killed.success(), "{line}");
        let asked = Instant::now();
        let status = child.wait().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(10), "{line}");
        assert_eq!(status.code(), Some(130), "{line}");
        assert_eq!(fs::read_to_string(folder.path().join(old)).unwrap(), "precious", "{line}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "{line}: temporary files were left");
    }
}

#[data_test]
fn every_messy_file_gives_a_result_or_one_line() {
    let data = real_files();
    let folder = tempfile::tempdir().unwrap();
    let files = files_below(&data.join("messy"));
    assert!(files.len() > 100);
    let mut n_done = 0;
    for file in files {
        let start = Instant::now();
        let output = adwave(folder.path())
            .args(["transform", file.to_str().unwrap(), "-o", "o.ply", "--levels", "8", "-q"])
            .timeout(Duration::from_secs(30))
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => n_done += 1,
            Some(2) => assert_eq!(error.trim_end().lines().count(), 1, "{}: {error}", file.display()),
            other => panic!("{}: {other:?} {error}", file.display()),
        }
        assert!(start.elapsed() < Duration::from_secs(30), "{}", file.display());
    }
    assert!(n_done > 80, "only {n_done} files gave a result");
}

#[test]
fn results_that_do_not_fit_are_refused_before_the_old_file_is_touched() {
    let folder = tempfile::tempdir().unwrap();
    for (file, gains) in [("a.stl", "1e40,1"), ("a.ply", "1e308,1e308"), ("a.obj", "1e308,1e308,1e308")] {
        let path = folder.path().join(file);
        fs::write(&path, "old").unwrap();
        let line = format!("filter sample:creature --vertices 2000 -o {file} --gains {gains}");
        let output = adwave(folder.path()).args(words(&line)).assert().code(2).get_output().clone();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains("range of 32-bit floats") || told.contains("would"), "{told}");
        assert_eq!(fs::read(&path).unwrap(), b"old", "{file}");
    }
}

#[test]
fn numbers_below_zero_and_counts_of_zero_are_read_as_they_are_meant() {
    let folder = tempfile::tempdir().unwrap();
    adwave(folder.path())
        .args(words("filter sample:creature --vertices 2000 -o a.ply --gains -0.5,1"))
        .assert()
        .success();
    for line in [
        "info sample:sphere --levels -1",
        "info sample:sphere --threads 0",
        "info sample:sphere --rings 0",
        "info sample:sphere --neighbors x",
    ] {
        let output = adwave(folder.path()).args(words(line)).assert().code(2).get_output().clone();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains("must be a whole number of at least") && !told.contains("type"), "{told}");
    }
    let many = adwave(folder.path()).args(words("info sample:sphere --threads 10000")).assert().success();
    let told = String::from_utf8(many.get_output().stderr.clone()).unwrap();
    assert!(told.contains("4 per core, instead of 10000"), "{told}");
}

#[test]
fn an_empty_recipe_says_that_it_does_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("empty.toml"), "").unwrap();
    let done = adwave(folder.path())
        .args(words("filter sample:creature --vertices 2000 -o a.ply --recipe empty.toml"))
        .assert()
        .success();
    let told = String::from_utf8(done.get_output().stderr.clone()).unwrap();
    assert!(told.contains("so nothing changes"), "{told}");
}

#[test]
fn inputs_beyond_the_limit_are_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.xyz", "0 0 0\n".repeat(1000));
    let error = refused(folder.path(), "info a.xyz --max-input 5K");
    assert!(error.contains("6000") && error.contains("5120") && error.contains("--max-input"), "{error}");
    adwave(folder.path()).args(words("info a.xyz --max-input 6000")).assert().success();
    adwave(folder.path()).args(words("info a.xyz --max-input 1.5GiB")).assert().success();
    let usage = adwave(folder.path())
        .args(words("info a.xyz --max-input much"))
        .assert()
        .code(2)
        .get_output()
        .clone();
    assert!(String::from_utf8(usage.stderr).unwrap().contains("500M"));
}

#[test]
fn a_result_on_the_standard_output_stands_there_alone() {
    let folder = tempfile::tempdir().unwrap();
    adwave(folder.path()).args(words("sample knot --vertices 500 -o a.obj")).assert().success();
    adwave(folder.path()).args(words("filter a.obj --preset smooth -o b.obj")).assert().success();
    let piped = adwave(folder.path()).args(words("filter a.obj --preset smooth -o -")).output().unwrap();
    assert!(piped.status.success());
    assert_eq!(piped.stdout, fs::read(folder.path().join("b.obj")).unwrap());
    assert!(String::from_utf8(piped.stderr).unwrap().contains("moved"));
    let sample =
        adwave(folder.path()).args(words("sample knot --vertices 500 --json -o -")).output().unwrap();
    assert!(sample.stdout.starts_with(b"ply\n") && sample.stderr.starts_with(b"{"));
    assert!(!folder.path().join("-").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_of_several_files_is_all_there_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("creature.ply"), "old").unwrap();
    // The last file of the set does not fit on the disk.
    std::os::unix::fs::symlink("/dev/full", out.join("index.html")).unwrap();
    let run = || adwave(folder.path()).args(words("demo -o out --vertices 2000 --quiet")).output().unwrap();
    let output = run();
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read(out.join("creature.ply")).unwrap(), b"old");
    assert_eq!(files_below(&out).len(), 2);
    fs::remove_file(out.join("index.html")).unwrap();
    assert_eq!(run().status.code(), Some(0));
    assert!(files_below(&out).len() > 5 && fs::read(out.join("creature.ply")).unwrap() != b"old");
}

#[cfg(target_os = "linux")]
#[test]
fn memory_that_the_system_refuses_gives_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("b.ply"), "old").unwrap();
    let adwave = assert_cmd::cargo::cargo_bin("adwave");
    // Address space for the program and its threads, not for a million vertices.
    let script =
        format!("ulimit -v 400000; exec {} sample sphere --vertices 3000000 -o b.ply", adwave.display());
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .env("RUST_BACKTRACE", "0")
        .current_dir(at)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.lines().next_back().unwrap().starts_with("adwave: the system has no more memory"), "{said}");
    assert_eq!((fs::read(at.join("b.ply")).unwrap().as_slice(), files_below(at).len()), (&b"old"[..], 1));
}
