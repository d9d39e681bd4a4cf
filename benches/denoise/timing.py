"""Seconds and memory on a mesh of the size of a scan and on a large one.

The programs take turns, so that other work on the machine affects all of them alike.
"""

from programs import Failure, command

# The built-in shape and its noise: kind, σ in mean edges, seed.
SHAPE, NOISE, SIGMA, SEED = "creature", "normal", 0.3, 1
# Turns at each number of vertices; beyond the second number only ours is timed, because the others take many minutes.
TURNS = {36_000: 5, 1_000_000: 3}
MAX_FOR_OTHERS = 36_000


def write_noisy_mesh(bench, n_vertices, ending):
    """Writes the noisy shape in the format of an ending; returns its path."""
    clean, path = (bench.args.work / f"{SHAPE}-{n_vertices}{part}.{ending}" for part in ("", "-noisy"))
    command([bench.args.adwave, "sample", SHAPE, "--vertices", n_vertices, "--quiet", "-o", clean])
    command([bench.args.steps, "noise", NOISE, SIGMA, SEED, clean, path])
    return path


def measure(bench, turns=TURNS):
    """Seconds, turn by turn, and peak memory in bytes, by number of vertices and name of the program."""
    found, programs = {}, bench.programs
    for n_vertices, n_turns in turns.items():
        print(f"timing, {n_vertices} vertices", flush=True)
        ply, obj = (write_noisy_mesh(bench, n_vertices, ending) for ending in ("ply", "obj"))
        runs = {"adwave, PLY": (programs.ours, ply), "adwave, OBJ": (programs.ours, obj)}
        if n_vertices <= MAX_FOR_OTHERS:
            runs["MeshLib"] = programs.library("meshlib"), ply
            runs |= {name: (programs.step(name, "-", "-", "-"), ply) for name in ("bilateral", "guided")}
        lines = found[str(n_vertices)] = {}
        for _ in range(n_turns):
            for name, (run, source) in runs.items():
                try:
                    result = run(source, source.with_stem("timed"))
                except Failure as error:
                    bench.add_note(f"{name}, {n_vertices} vertices: {error}")
                    continue
                line = lines.setdefault(name, {"seconds": [], "peak": 0})
                line["seconds"].append(result.seconds)
                line["peak"] = max(line["peak"], result.peak)
    return found
