"""Times five commands from file to file against the number of vertices, beside libraries that do the same work, and
writes the section and the picture of docs/PERFORMANCE.md.

`cargo xtask bench-commands` runs it in an environment of its own; Open3D needs libusb 1.0 of the system. `--only COMMAND`
prints the table of one command and writes no document; `--only match` is that of pairs of scans. Peers run in processes of
their own, which print the seconds of reading, working and writing; ours are those of the whole process.
"""

import argparse
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent))  # modules shared by all comparisons

import page  # noqa: E402

import scans  # noqa: E402

VERTICES = (10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
# Runs of each command, if the first takes no more than so many seconds.
ROUNDS, REPEATED_SECONDS = 3, 10
# Seconds after which a peer is not given a larger shape.
MOST_SECONDS = 30
SMOOTHING_STEPS, KEPT = 20, 0.1


def read_by_vtk(path):
    import vtk

    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def write_by_vtk(mesh, path):
    import vtk

    writer = vtk.vtkPLYWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(mesh)
    writer.SetFileTypeToBinary()
    writer.Write()


def windowed_sinc(source, target):
    import vtk

    vtk.vtkSMPTools.SetBackend("STDThread")
    vtk.vtkSMPTools.Initialize(os.cpu_count())
    start = time.perf_counter()
    smoother = vtk.vtkWindowedSincPolyDataFilter()
    smoother.SetInputData(read_by_vtk(source))
    smoother.SetNumberOfIterations(SMOOTHING_STEPS)
    smoother.SetPassBand(0.1)
    smoother.NormalizeCoordinatesOn()
    smoother.FeatureEdgeSmoothingOff()
    smoother.Update()
    write_by_vtk(smoother.GetOutput(), target)
    return time.perf_counter() - start


def mesh_denoise(source, target):
    from meshlib import mrmeshpy

    start = time.perf_counter()
    mesh = mrmeshpy.loadMesh(source)
    mrmeshpy.meshDenoiseViaNormals(mesh)
    mrmeshpy.saveMesh(mesh, target)
    return time.perf_counter() - start


def fast_simplification(source, target):
    import fast_simplification
    import numpy as np
    import vtk
    from vtk.util import numpy_support

    start = time.perf_counter()
    mesh = read_by_vtk(source)
    points = numpy_support.vtk_to_numpy(mesh.GetPoints().GetData())
    faces = numpy_support.vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    points, faces = fast_simplification.simplify(points, faces, target_reduction=1 - KEPT)
    held, cells, smaller = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    held.SetData(numpy_support.numpy_to_vtk(points, deep=True))
    cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces, np.int64).ravel(), deep=True))
    smaller.SetPoints(held)
    smaller.SetPolys(cells)
    write_by_vtk(smaller, target)
    return time.perf_counter() - start


# The words of each command, the end of its output's name, and the peer with its name in the table.
COMMANDS = {
    "filter": (["filter", "--preset", "smooth"], ".ply", windowed_sinc, "VTK's windowed sinc"),
    "saliency": (["saliency"], ".ply", None, None),
    "features": (["features"], ".csv", None, None),
    "denoise": (["denoise"], ".ply", mesh_denoise, "MeshLib"),
    "simplify": (["simplify", "--ratio", str(KEPT)], ".ply", fast_simplification, "fast_simplification"),
}


class Bench:
    def __init__(self, adwave, work):
        self.adwave, self.work = adwave, work
        self.work.mkdir(parents=True, exist_ok=True)

    def ours(self, words, source, end):
        target = self.work / f"ours{end}"
        start = time.perf_counter()
        self.run([self.adwave, words[0], source, "-o", target, *words[1:], "--quiet"])
        return time.perf_counter() - start

    def theirs(self, name, source, end):
        target = self.work / f"theirs{end}"
        return float(self.run([sys.executable, __file__, "--peer", name, source, target]).splitlines()[-1])

    def run(self, command):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{command[0]} {command[1]} ended with {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def shape(self, n):
        path = self.work / "shape.ply"
        self.run([self.adwave, "sample", "creature", "--vertices", n, "--quiet", "-o", path])
        return path

    def measure(self, chosen):
        """Median seconds of ours and of the peer, by command and number of vertices; None where the peer was left out."""
        found = {name: [] for name in chosen}
        for n in VERTICES:
            source = self.shape(n)
            for name in chosen:
                words, end, peer, _ = COMMANDS[name]
                has_peer = peer and not any(theirs is None or theirs > MOST_SECONDS for *_, theirs in found[name])
                ours, theirs = [], []
                for _ in range(ROUNDS):
                    if not ours or ours[0] <= REPEATED_SECONDS:
                        ours.append(self.ours(words, source, end))
                    if has_peer and (not theirs or theirs[0] <= REPEATED_SECONDS):
                        theirs.append(self.theirs(name, source, end))
                line = (n, statistics.median(ours), statistics.median(theirs) if theirs else None)
                found[name].append(line)
                print(f"  {name}, {n:,}: {line[1]:.3g} s" + (f", peer {line[2]:.3g} s" if theirs else ""), flush=True)
        return found


def seconds(value):
    return "–" if value is None else f"{value:.3g}"


def table(found):
    head, columns = ["vertices"], [[f"{n:,}" for n in VERTICES]]
    for name, lines in found.items():
        words, _, peer, label = COMMANDS[name]
        head.append(f"`{' '.join(words)}`")
        columns.append([seconds(ours) for _, ours, _ in lines])
        if peer:
            head.append(label)
            columns.append([seconds(theirs) for *_, theirs in lines])
    return page.table(head, list(zip(*columns)), numbers=True)


def table_of_scans(bench):
    return page.table(scans.HEAD, scans.measure(bench.run, bench.adwave, bench.work), numbers=True)


def draw(found, path):
    import matplotlib

    matplotlib.use("Agg")
    # Equal figures give an equal file.
    matplotlib.rcParams["svg.hashsalt"] = "adwave"
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    for k, (name, lines) in enumerate(found.items()):
        words, _, peer, label = COMMANDS[name]
        color = f"C{k}"
        axes.loglog([n for n, *_ in lines], [ours for _, ours, _ in lines], "o-", color=color, label=" ".join(words))
        if peer:
            timed = [(n, theirs) for n, _, theirs in lines if theirs is not None]
            axes.loglog(*zip(*timed), "s--", color=color, alpha=0.6, markersize=4, label=label)
    axes.set(xlabel="vertices", ylabel="seconds, from file to file")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(path, metadata={"Date": None})


def main():
    if sys.argv[1:2] == ["--peer"]:
        name, source, target = sys.argv[2:]
        print(COMMANDS[name][2](source, target))
        return
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adwave", type=Path, required=True, help="the command")
    parser.add_argument("--work", type=Path, required=True, help="folder for intermediate files")
    parser.add_argument("--docs", type=Path, required=True, help="folder with PERFORMANCE.md")
    parser.add_argument("--only", choices=[*COMMANDS, "match"], help="one command, whose table is printed")
    args = parser.parse_args()
    bench = Bench(args.adwave, args.work)
    if args.only == "match":
        print(table_of_scans(bench))
        return
    found = bench.measure([args.only] if args.only else list(COMMANDS))
    if args.only:
        print(table(found))
        return
    draw(found, args.docs / "performance-commands.svg")
    machine = page.paragraph(page.machine("vtk", "meshlib", "fast-simplification", "open3d"))
    picture = "![Seconds of five commands and of three libraries against the number of vertices](performance-commands.svg)"
    text = page.paragraph(
        f"Seconds; medians of {ROUNDS} runs, or one run of more than {REPEATED_SECONDS} s. A library that took more than "
        f"{MOST_SECONDS} s is not given a larger shape.")
    parts = [machine, picture, text, table(found), page.paragraph(scans.TEXT), table_of_scans(bench)]
    page.write(args.docs / "PERFORMANCE.md", "\n\n".join(parts), "measured commands")


if __name__ == "__main__":
    main()
