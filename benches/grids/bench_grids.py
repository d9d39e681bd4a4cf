"""Times heat and bands of images and volumes beside SciPy's Gaussian, and writes the section of docs/PERFORMANCE.md.

`cargo xtask bench-grids` runs it in an environment of its own. `--only PART` prints one part and writes no document.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import nibabel
import numpy as np
from scipy import fft, ndimage

sys.path.append(str(Path(__file__).resolve().parent.parent))  # modules shared by all comparisons

import page  # noqa: E402

ROUNDS = 5
SIGMA_OF_FWHM = 1 / np.sqrt(8 * np.log(2))
SIZES = {"level": (256,) * 3, "volume": (512,) * 3, "image": (4096,) * 2, "frames": (91, 109, 91), "huge": (32768,) * 2}
DYADIC = [2.0**k / np.sqrt(2) for k in range(8)]
N_FRAMES, N_FRAMES_TIMED = 1200, 60


def seconds(value):
    return f"{value:.3g} s" if value >= 1 else f"{1e3 * value:.3g} ms"


class Bench:
    def __init__(self, args):
        self.args, self.work = args, args.work
        self.work.mkdir(parents=True, exist_ok=True)

    def noise(self, name, sizes):
        """Independent noise in single precision, and its file."""
        path = self.work / f"{name}.f32"
        values = np.random.default_rng(7).standard_normal(sizes, dtype=np.float32)
        values.tofile(path)
        return values, path

    def heat(self, path, sizes, sigmas, threads, accuracy=1e-6, rounds=ROUNDS, mask=None):
        """Rounds of our heat or bands on `threads` threads, the coarsest signal, and the peak of memory in bytes."""
        out = self.work / "coarsest.f64"
        numbers = [",".join(map(str, sizes)), ",".join(map(repr, map(float, sigmas))), accuracy, rounds, path, out]
        command = [self.args.timing, *numbers, *([mask] if mask else [])]
        found, usage = self.run(command, {"RAYON_NUM_THREADS": str(threads)})
        rows = [json.loads(line) for line in found.splitlines()]
        coarsest = np.fromfile(out).reshape(sizes)
        out.unlink()
        return [row["seconds"] for row in rows], coarsest, 1024 * usage.ru_maxrss

    def run(self, command, variables=None):
        """The output of a program, and what it used of the machine."""
        process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, text=True,
                                   env={**os.environ, **(variables or {})})
        found = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        if status:
            raise SystemExit(f"{command[0]} ended with {os.waitstatus_to_exitcode(status)}")
        return found, usage


def timed(call, rounds=ROUNDS):
    found = []
    for _ in range(rounds):
        start = time.perf_counter()
        call()
        found.append(time.perf_counter() - start)
    return found


def gaussian(values, sigma):
    return ndimage.gaussian_filter(values, sigma)  # borders reflect, cut at 4 standard deviations, as by default


def exact_heat(values, sigma):
    """Heat by its eigenvectors."""
    spectrum = fft.dctn(values.astype(np.float64), norm="ortho")
    for axis, n in enumerate(values.shape):
        rates = 2 - 2 * np.cos(np.pi * np.arange(n) / n)
        shape = [-1 if a == axis else 1 for a in range(values.ndim)]
        spectrum *= np.exp(-0.5 * sigma**2 * rates).reshape(shape)
    return fft.idctn(spectrum, norm="ortho")


def level_part(bench):
    sizes = SIZES["level"]
    values, path = bench.noise("level", sizes)
    rows = []
    for sigma in (1, 4, 16):
        exact = exact_heat(values, sigma)
        for accuracy in (1e-6, 1e-10):
            ours, found, _ = bench.heat(path, sizes, [sigma], 1, accuracy)
            error = np.linalg.norm(found - exact) / np.linalg.norm(values)
            theirs = timed(lambda: gaussian(values, sigma), 3)
            each = [f"{1e9 * statistics.median(t) / values.size:.1f}" for t in (ours, theirs)]
            rows.append([sigma, f"{accuracy:.0e}", *each, f"{error:.1e}"])
    head = ["σ per axis, voxels", "accuracy asked", "adwave, ns", "SciPy, ns", "error against a DCT"]
    return "256³, one level on one core, per voxel", page.table(head, rows, numbers=True)


def bands_of_a_file(bench, values):
    """Seconds and peak of memory of the command, from file to file, and the bytes of both files."""
    source, target = bench.work / "volume.nii", bench.work / "bands.nii"
    nibabel.Nifti1Image(values.transpose(), np.eye(4)).to_filename(source)
    widths = ",".join(f"{sigma / SIGMA_OF_FWHM:.6f}" for sigma in DYADIC)
    options = ["--fwhm", widths, "--accuracy", "1e-6", "--quiet", "--max-input", "100G"]
    start = time.perf_counter()
    _, usage = bench.run([bench.args.adwave, "transform", source, "-o", target, *options])
    ours, n_bytes = time.perf_counter() - start, source.stat().st_size + target.stat().st_size
    source.unlink()
    target.unlink()
    return ours, 1024 * usage.ru_maxrss, n_bytes


def bands_part(bench):
    rows = []
    for name, rounds in (("volume", 2), ("image", 3)):
        sizes = SIZES[name]
        values, path = bench.noise(name, sizes)
        del values
        ours, _, peak = bench.heat(path, sizes, DYADIC, os.cpu_count(), 1e-6, rounds)
        values = np.fromfile(path, np.float32).reshape(sizes)
        theirs = sum(timed(lambda s=s: gaussian(values, s), 1)[0] for s in DYADIC)
        needed = 8 * values.size * (len(DYADIC) + 2)
        rows.append([" × ".join(map(str, sizes)), seconds(statistics.median(ours)), seconds(theirs),
                     f"{theirs / statistics.median(ours):.1f}", f"{peak / 1e9:.1f} GB", f"{needed / 1e9:.1f} GB"])
        path.unlink()
        if values.ndim == 3:
            ours, peak, needed = bands_of_a_file(bench, values)
            rows.append(["the same, `.nii` to `.nii` in 32 bits", seconds(ours), seconds(theirs), f"{theirs / ours:.1f}",
                         f"{peak / 1e9:.1f} GB", f"{needed / 1e9:.1f} GB"])
    head = ["places", "adwave, all cores", "SciPy, a Gaussian per scale, one core", "ratio", "peak memory",
            "values and bands"]
    return "Eight bands, σ from 0.7 to 90 places", page.table(head, rows, numbers=True)


def mask_part(bench):
    file = bench.args.data / "domains/volumes/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz"
    if not file.exists():
        return "", ""
    values = np.ascontiguousarray(nibabel.load(file).get_fdata(dtype=np.float32))
    mask = ndimage.binary_fill_holes(ndimage.binary_opening(values > 60, iterations=2))
    path, flags = bench.work / "masked.f32", bench.work / "mask.u8"
    values.tofile(path)
    mask.astype(np.uint8).tofile(flags)
    sigma = 4 * SIGMA_OF_FWHM
    scipy = statistics.median(timed(lambda: gaussian(values, sigma)))
    rows = []
    for threads in (1, os.cpu_count()):
        for accuracy in (1e-6, 1e-10):
            ours, found, _ = bench.heat(path, values.shape, [sigma], threads, accuracy, mask=flags)
            total = np.float64(values)[mask].sum()
            off = abs(found[mask].sum() / total - 1)
            rows.append([threads, f"{accuracy:.0e}", seconds(statistics.median(ours)), seconds(scipy),
                         f"{statistics.median(ours) / scipy:.2f}", f"{off:.0e}"])
    np.ones_like(values).tofile(path)
    _, ones, _ = bench.heat(path, values.shape, [sigma], 1, 1e-6, rounds=1, mask=flags)
    text = page.paragraph(
        f"{mask.sum():,} of {mask.size:,} voxels of 1 mm, FWHM 4 mm; SciPy without a mask on one core. A constant in "
        f"the mask is kept to {abs(ones[mask] - 1).max():.0e}.")
    head = ["cores", "accuracy asked", "adwave in the mask", "SciPy, unmasked", "ratio", "sum off by"]
    return "Heat in a mask", text + "\n\n" + page.table(head, rows, numbers=True)


def frames_part(bench):
    sizes = SIZES["frames"]
    source, target = bench.work / "frames.nii", bench.work / "smooth.nii"
    header = nibabel.Nifti1Header()
    header.set_data_dtype(np.float32)
    header.set_data_shape((*sizes, N_FRAMES))
    header["pixdim"][1:4] = 2
    header.set_sform(np.diag([2, 2, 2, 1]), code=1)
    header.set_xyzt_units("mm", "sec")
    header["magic"], header["vox_offset"] = b"n+1", 352
    random = np.random.default_rng(5)
    with open(source, "wb") as file:
        file.write(header.binaryblock + bytes(4))
        for _ in range(N_FRAMES):
            frame = random.standard_normal(sizes, dtype=np.float32)
            file.write(frame.tobytes(order="F"))
    start = time.perf_counter()
    options = ["--fwhm", "6", "--preset", "suppress-paper", "--accuracy", "1e-6", "--quiet", "--max-input", "100G"]
    _, usage = bench.run([bench.args.adwave, "filter", source, "-o", target, *options])
    ours = time.perf_counter() - start
    sigma = 6 * SIGMA_OF_FWHM / 2
    image = nibabel.load(source)
    start = time.perf_counter()
    some = np.asarray(image.dataobj[..., :N_FRAMES_TIMED])
    for axis in range(3):
        some = ndimage.gaussian_filter1d(some, sigma, axis=axis)
    nibabel.Nifti1Image(some, image.affine).to_filename(bench.work / "some.nii")
    theirs = (time.perf_counter() - start) * N_FRAMES / N_FRAMES_TIMED
    for path in (source, target, bench.work / "some.nii"):
        path.unlink(missing_ok=True)
    rows = [[seconds(ours), seconds(usage.ru_utime + usage.ru_stime), f"{usage.ru_maxrss * 1024 / 1e9:.1f} GB",
             seconds(theirs), f"{theirs / ours:.1f}"]]
    head = ["adwave, all cores", "of it processor time", "peak memory", "nibabel and SciPy, one core", "ratio"]
    text = page.paragraph(
        f"{np.prod(sizes):,} voxels of 2 mm × {N_FRAMES:,} frames in single precision, 4.3 GB, FWHM 6 mm, from file to "
        f"file without compression. The other time is that of {N_FRAMES_TIMED} frames, times {N_FRAMES // N_FRAMES_TIMED}.")
    return "A series of volumes", text + "\n\n" + page.table(head, rows, numbers=True)


def memory_part(bench):
    """An image of 4 GB where 1 GB of memory may be used."""
    path = bench.work / "huge.npy"
    array = np.lib.format.open_memmap(path, "w+", np.float32, SIZES["huge"])
    del array  # zeros that take no space
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
    command = [bench.args.adwave, "filter", path, "-o", bench.work / "none.npy", "--fwhm", "4", "--preset", "suppress"]
    found = subprocess.run([str(c) for c in command], capture_output=True, text=True, preexec_fn=limit)
    path.unlink()
    told = textwrap.fill(found.stderr.strip().replace(str(path), path.name), 118)
    return "An image of 4 GB in 1 GB of memory", f"Ends with {found.returncode} and says:\n\n```text\n{told}\n```"


PARTS = {"level": level_part, "mask": mask_part, "bands": bands_part, "frames": frames_part, "memory": memory_part}


def main():
    parser = argparse.ArgumentParser()
    for name in ("adwave", "timing", "work", "data", "docs"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--only", choices=PARTS)
    args = parser.parse_args()
    bench = Bench(args)
    found = [part(bench) for name, part in PARTS.items() if args.only in (None, name)]
    if args.only:
        print("\n\n".join(body for _, body in found))
        return
    sections = "\n\n".join(f"### {head}\n\n{body}" for head, body in found if body)
    machine = page.paragraph(page.machine("numpy", "scipy", "nibabel"))
    page.write(args.docs / "PERFORMANCE.md", f"{machine}\n\n{sections}", "measured grids")


if __name__ == "__main__":
    main()
