"""Times adwave and other programs on the same operators, in turns, checks that they agree, and writes docs/PERFORMANCE.md.

`cargo xtask bench-peers` runs it in an environment of its own. `--only PART` prints the measurements of one part and
writes no document.
"""

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import time
import traceback
from pathlib import Path

import numpy as np
import psutil
import scipy.sparse as sp

sys.path.append(str(Path(__file__).resolve().parent.parent))  # modules shared by all comparisons

import machine  # noqa: E402
import report  # noqa: E402
import shapes  # noqa: E402
from turns import Failure, Peer, Program, in_turns, summary  # noqa: E402

ACCURACY = 1e-5
# The first call after another program's finds cold caches and must get new memory pages; both kinds count.
OURS_A_TURN = 3
# A part during which other programs took a larger share of the processors is measured again.
MAX_FOREIGN, MAX_ATTEMPTS = 0.05, 3
# Seconds that a part waits for other programs to become idle.
MAX_WAITING = 120
BASIS_LEVELS, BANDS_LEVELS, DEEP_LEVELS = 6, 8, 16
# Freed memory is returned to the system at once, so that resident memory is memory in use.
EXACT_MEMORY = {"MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "65536"}


class Bench:
    def __init__(self, args):
        self.args, self.work = args, args.work
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir(parents=True)
        found = sorted(args.models.rglob("stanford-bunny.obj")) if args.models.is_dir() else []
        if found:
            self.mesh, self.shape = shapes.read_obj(found[0]), "Stanford bunny"
        else:
            self.mesh, self.shape = self.sample("creature", 34834), "built-in creature"
            print(f"no stanford-bunny.obj below {args.models}: the built-in creature is used instead")

    def sample(self, name, n_vertices):
        out = self.work / f"{name}-{n_vertices}.obj"
        command = [self.args.adwave, "sample", name, "--vertices", str(n_vertices), "--quiet", "-o", out]
        subprocess.run([str(c) for c in command], check=True)
        return shapes.read_obj(out)

    def folder(self, name, points, triangles):
        folder = self.work / name
        folder.mkdir(exist_ok=True)
        points.astype("<f8").tofile(folder / "points.f64")
        triangles.astype("<u4").tofile(folder / "triangles.u32")
        return folder

    def operator(self, name, points, triangles):
        """A folder with a mesh and its Φ₁ as NumPy makes it, for the peers."""
        folder = self.folder(name, points, triangles)
        phi, stationary = shapes.diffusion(points, triangles)
        sp.save_npz(folder / "phi.npz", phi, compressed=False)
        stationary.tofile(folder / "stationary.f64")
        return folder, phi, stationary

    def ours(self, folder, **variables):
        env = [f"{k}={v}" for k, v in variables.items()]
        command = ["env", *env, self.args.ours, folder] if env else [self.args.ours, folder]
        return Program(command, self.work / "ours.log")

    def peer(self, kind, folder):
        return Peer(kind, folder, self.work / f"{kind}.log")

    def big(self):
        mesh = self.mesh
        for _ in range(2):
            mesh = shapes.subdivided(*mesh)
        return mesh

    def against(self, kind, folder, ours, call, rounds, then=None):
        """Us, several times, and a peer in turns; `then(peer)` looks at the last result. A failure is a result too."""
        try:
            with self.peer(kind, folder) as peer:
                mine, theirs = in_turns([(ours, OURS_A_TURN), (lambda: call(peer), 1)], rounds)
                found = {"ours": mine, "peer": theirs}
                return {**found, **(then(peer) if then else {})}
        except Failure as failure:
            print(f"  {kind} failed: {failure}")
            return {"failed": str(failure)}


def same_operator(bench, ours, phi):
    """The largest difference of our Φ₁ and NumPy's."""
    folder = bench.work / "operator"
    ours.ask(f"operator {folder}")
    number = np.fromfile(folder / "number.u32", "<u4")
    arrays = [np.fromfile(folder / n, t) for n, t in
              (("values.f64", "<f8"), ("columns.u32", "<u4"), ("offsets.i64", "<i8"))]
    off = sp.csr_matrix((arrays[0], arrays[1].astype(np.int32), arrays[2]), shape=phi.shape)[number][:, number]
    whole = off + sp.diags(1 - np.asarray(off.sum(axis=1)).ravel())
    return float(abs(whole - phi).max())


def read_levels(folder, n):
    for level in range(1, BASIS_LEVELS + 1):
        arrays = [np.fromfile(folder / f"{level}-{name}", kind) for name, kind in
                  (("values.f32", "<f4"), ("columns.u32", "<u4"), ("offsets.i64", "<i8"))]
        yield sp.csr_matrix((arrays[0], arrays[1].astype(np.int32), arrays[2]), shape=(n, n))


def basis_part(bench):
    """Φ_1 … Φ_6 stored."""
    folder, phi, _ = bench.operator("plain", *bench.mesh)
    lines = []
    with bench.ours(folder) as ours:
        result = {"n": phi.shape[0], "operator_difference": same_operator(bench, ours, phi)}
        mine = bench.work / "basis"
        first = ours.ask(f"basis {BASIS_LEVELS} {mine}")
        result.update(nnz=first["nnz"], bytes=first["bytes"], first_seconds=first["seconds"], peak=first["peak"])
        call = lambda: ours.ask(f"basis {BASIS_LEVELS}")
        for kind, precision, rounds in [(k, p, r) for p, r in (("f64", 3), ("f32", 2))
                                        for k in ("SciPy", "MKL", "GraphBLAS")]:

            def agreement(peer):
                theirs = bench.work / "theirs"
                theirs.mkdir(exist_ok=True)
                peer.call("save", str(theirs))
                differences, extra = [], []
                for level, a in enumerate(read_levels(mine, phi.shape[0]), 1):
                    b = sp.load_npz(theirs / f"{level}.npz")
                    differences.append(float(abs(a - b).max()))
                    extra.append(a.nnz / b.nnz - 1)
                shutil.rmtree(theirs)
                return {"max_difference": max(differences), "nnz_difference": max(extra, key=abs)}

            print(f"  {kind}, {precision}")
            line = bench.against(kind, folder, call, lambda p: p.call("basis", BASIS_LEVELS, precision), rounds,
                                 agreement)
            lines.append({"kind": kind, "precision": precision, **line})
    return {**result, "lines": lines}


def relative_errors(found, exact, stationary):
    """`‖w − e‖ / ‖e‖` by band, norms plain and weighted by π: the larger."""
    errors = []
    for w, e in zip(found, exact):
        plain = np.linalg.norm(w - e) / np.linalg.norm(e)
        weighted = np.sqrt((stationary @ (w - e) ** 2).sum() / (stationary @ e**2).sum())
        errors.append(float(max(plain, weighted)))
    return errors


def bands_part(bench):
    """All bands of xyz, J = 8, against SciPy's products, VTK's low-pass and PyGSP's filter bank."""
    folder, phi, stationary = bench.operator("big", *bench.big())
    exact_file, other_file = str(bench.work / "exact.npy"), str(bench.work / "other.npy")
    with bench.ours(folder) as ours:
        n = phi.shape[0]
        result = {"n": n, "nnz": phi.nnz, "operator_seconds": ours.ready["operator_seconds"],
                  "operator_difference": same_operator(bench, ours, phi)}
        call = lambda: ours.ask(f"bands {BANDS_LEVELS} {ACCURACY}")
        result["first"] = call()
        ours.ask(f"decompose {BANDS_LEVELS} {ACCURACY} {bench.work / 'bands'}")
        mine = np.fromfile(bench.work / "bands/wavelets.f64").reshape(BANDS_LEVELS, n, 3)

        def scipy_errors(peer):
            peer.call("bands", BANDS_LEVELS, exact_file)
            return {"errors": relative_errors(mine, np.load(exact_file), stationary)}

        def pygsp_errors(peer):
            peer.call("bands", BANDS_LEVELS, 39, other_file)
            return {"peer_errors": relative_errors(np.load(other_file), np.load(exact_file), stationary)}

        print("  SciPy")
        result["SciPy"] = bench.against("SciPy", folder, call, lambda p: p.call("bands", BANDS_LEVELS), 7, scipy_errors)
        for backend in ("Sequential", "STDThread", "TBB"):
            print(f"  VTK, {backend}")
            result[f"VTK {backend}"] = bench.against(
                "VTK", folder, call, lambda p: p.call("low_pass", 40, backend), 5)
        print("  PyGSP")
        result["PyGSP"] = bench.against("PyGSP", folder, call, lambda p: p.call("bands", BANDS_LEVELS, 39), 3, pygsp_errors)
        result["one_call"], result["filter"] = in_turns(
            [(lambda: ours.ask(f"{call} {BANDS_LEVELS} {ACCURACY}"), 3) for call in ("decompose", "filter")], 4)
    return result


def bound_part(bench):
    """The memory's bandwidth, one product, the whole transform, deep levels."""
    folder = bench.folder("big", *bench.big())
    plain = bench.folder("plain", *bench.mesh)
    with bench.ours(folder) as ours:
        wanted, deep_wanted = (f"bands {levels} {ACCURACY}" for levels in (BANDS_LEVELS, DEEP_LEVELS))
        rounds = []
        for _ in range(8):
            # The bandwidth of a shared machine drifts: each round has its own, the better of before and after.
            triads = [ours.ask("triad")["bytes_per_second"]]
            product = summary([ours.ask("product") for _ in range(20)])
            # The first call of a number of levels makes its outputs and is not counted.
            bands = summary([ours.ask(wanted) for _ in range(5)][1:])
            triads.append(ours.ask("triad")["bytes_per_second"])
            deep = summary([ours.ask(deep_wanted) for _ in range(2)][1:])
            rounds.append({"bandwidth": max(triads), "product": product, "bands": bands, "deep": deep})
        finer = ours.ask(f"against {DEEP_LEVELS} {ACCURACY} 1e-12")["relative"]
        n = ours.ready["n"]
    with bench.ours(plain) as ours:
        powers = ours.ask(f"against_powers {DEEP_LEVELS} {ACCURACY}")["relative"]
    product, deep = (
        {"min": min(r[k]["min"] for r in rounds), "median": statistics.median(r[k]["median"] for r in rounds)}
        for k in ("product", "deep"))
    return {"n": n, "rounds": rounds, "product": product, "deep": deep, "deep_errors_finer": finer, "deep_errors_powers": powers}


def harmonics_part(bench):
    """A filter in the basis of 300 manifold harmonics against a filter of eight bands."""
    folder, phi, _ = bench.operator("plain", *bench.mesh)
    with bench.ours(folder) as ours:
        call = lambda: ours.ask(f"filter {BANDS_LEVELS} {ACCURACY}")
        line = bench.against("SciPy", folder, call, lambda p: p.call("eigenpairs", 300), 2)
        single = summary([call() for _ in range(20)])
        bands = summary([ours.ask(f"decompose {BANDS_LEVELS} {ACCURACY}") for _ in range(20)])
        return {"n": phi.shape[0], "operator_seconds": ours.ready["operator_seconds"], "line": line, "filter": single,
                "decompose": bands}


def wavelet_part(bench):
    """ψ of level 8 of single vertices."""
    points, triangles = bench.sample("creature", 50000)
    folder, phi, _ = bench.operator("creature", points, triangles)
    n = phi.shape[0]
    with bench.ours(folder) as ours:
        vertices = np.linspace(0, n - 1, 60).astype(int)[5:-5]
        ours.ask(f"wavelet {vertices[0]} 8")
        each = [summary([ours.ask(f"wavelet {x} 8") for _ in range(5)]) for x in vertices]
        over_vertices = summary([{**a, "seconds": a["median"]} for a in each])
        differences = []
        for x in vertices[::10]:
            ours.ask(f"wavelet {x} 8 {bench.work / 'wavelet'}")
            mine = np.fromfile(bench.work / "wavelet/wavelet.f64")
            row, transposed = np.zeros(n), phi.T.tocsr()
            row[x] = 1
            for step in range(128):
                fine = row if step == 64 else fine if step > 64 else None
                row = transposed @ row
            exact = fine - row
            differences.append(float(np.linalg.norm(mine - exact) / np.linalg.norm(exact)))
    return {"n": n, "times": over_vertices, "difference": max(differences)}


def memory_part(bench):
    """Bytes beyond input and output, each number of channels in a process of its own."""
    folder = bench.folder("big", *bench.big())
    found = []
    for channels in (1, 2, 3, 4, 8):
        with bench.ours(folder, **EXACT_MEMORY) as ours:
            found.append({"channels": channels, **ours.ask(f"memory {BANDS_LEVELS} {ACCURACY} {channels}")})
    return found


def cost_part(bench):
    """Cost against n and against J."""
    against_n = []
    for n in (10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000):
        folder = bench.folder("torus", *shapes.torus(n))
        with bench.ours(folder) as ours:
            n_calls = 4 if n > 1_000_000 else 12
            found = summary([ours.ask(f"bands {BANDS_LEVELS} {ACCURACY}") for _ in range(n_calls)][1:])
            against_n.append({"n": ours.ready["n"], "operator_seconds": ours.ready["operator_seconds"], **found})
        print(f"  {against_n[-1]['n']} vertices: {found['median']:.4f} s")
    shutil.rmtree(bench.work / "torus")
    against_levels = []
    with bench.ours(bench.folder("big", *bench.big())) as ours:
        for levels in range(1, 21):
            found = summary([ours.ask(f"bands {levels} {ACCURACY}") for _ in range(3 if levels > 14 else 6)][1:])
            against_levels.append({"levels": levels, **found})
        product = summary([ours.ask("product") for _ in range(20)])
        n = ours.ready["n"]
    return {"against_n": against_n, "against_levels": against_levels, "product": product, "n": n}


def used_by_all():
    """Busy processor seconds of all programs, and those that the host gave to others."""
    now = psutil.cpu_times()
    return sum(now) - now.idle - getattr(now, "iowait", 0) - getattr(now, "guest", 0), getattr(now, "steal", 0)


def used_by_us():
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, kinds))


def wait_for_silence():
    start, quiet = time.monotonic(), 0
    while quiet < 2 and time.monotonic() - start < MAX_WAITING:
        busy = used_by_all()[0]
        time.sleep(2)
        quiet = quiet + 1 if used_by_all()[0] - busy <= MAX_FOREIGN * 2 * os.cpu_count() else 0


def measured_alone(part, bench):
    """A part's measurements with the share of the processors that others took; repeated if that share was too large."""
    attempts = []
    while len(attempts) < MAX_ATTEMPTS and (not attempts or attempts[-1][0] > MAX_FOREIGN):
        wait_for_silence()
        (busy, stolen), own, start = used_by_all(), used_by_us(), time.monotonic()
        result = part(bench)
        (busy_now, stolen_now), own_now = used_by_all(), used_by_us()
        whole = os.cpu_count() * (time.monotonic() - start)
        foreign = max(0.0, (busy_now - busy - (own_now - own)) / whole)
        attempts.append((foreign, (stolen_now - stolen) / whole, result))
        print(f"  other programs took {foreign:.0%} of the processors")
    foreign, stolen, result = min(attempts, key=lambda a: a[0])
    return result, {"foreign": foreign, "stolen": stolen, "attempts": len(attempts)}


PARTS = {"bound": bound_part, "bands": bands_part, "basis": basis_part, "harmonics": harmonics_part,
         "wavelet": wavelet_part, "memory": memory_part, "cost": cost_part}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ours", type=Path, required=True, help="the program timing_on_request")
    parser.add_argument("--adwave", type=Path, required=True, help="the command")
    parser.add_argument("--models", type=Path, required=True, help="folder with stanford-bunny.obj somewhere in it")
    parser.add_argument("--work", type=Path, required=True, help="folder for intermediate files; emptied")
    parser.add_argument("--docs", type=Path, required=True, help="folder with PERFORMANCE.md")
    parser.add_argument("--only", choices=PARTS, help="one part, printed as JSON")
    args = parser.parse_args()
    bench = Bench(args)
    results = {"machine": machine.describe(), "shape": bench.shape, "alone": {}}
    failed = []
    for name, part in PARTS.items():
        if args.only in (None, name):
            print(f"{name}: {part.__doc__}", flush=True)
            try:
                results[name], results["alone"][name] = measured_alone(part, bench)
            except Failure:
                traceback.print_exc()
                failed.append(name)
    kept = args.work.with_suffix(".json")
    kept.write_text(json.dumps(results, indent=1))
    shutil.rmtree(args.work)
    if failed:
        sys.exit(f"our own program failed in {', '.join(failed)}; nothing is written but {kept}")
    if args.only:
        print(json.dumps(results[args.only], indent=1))
    else:
        report.write(results, args.docs)
        print(f"wrote {args.docs / 'PERFORMANCE.md'}; all figures are in {kept}")


if __name__ == "__main__":
    main()
