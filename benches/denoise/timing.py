"""Seconds and memory on a mesh of the size of a scan and on a large one: the programs take turns, so that what else the machine
does falls on all of them alike."""

from programs import Failure, command

# A built-in shape and the noise on it, σ in mean edges.
SHAPE, NOISE, SIGMA, SEED = "creature", "normal", 0.3, 1
# How many turns there are at each number of vertices; beyond this many only ours has any, the others take many minutes.
TURNS = {36_000: 5, 1_000_000: 3}
MOST_FOR_RIVALS = 36_000


def noisy(bench, n_vertices, ending):
    clean, path = (bench.args.work / f"{SHAPE}-{n_vertices}{part}.{ending}" for part in ("", "-noisy"))
    command([bench.args.adwave, "sample", SHAPE, "--vertices", n_vertices, "--quiet", "-o", clean])
    command([bench.args.steps, "noise", NOISE, SIGMA, SEED, clean, path])
    return path


def measured(bench, turns=TURNS):
    """By number of vertices and name of the program: its seconds, turn by turn, and its highest memory in bytes."""
    found, programs = {}, bench.programs
    for n_vertices, n_turns in turns.items():
        print(f"timing, {n_vertices} vertices", flush=True)
        ply, obj = (noisy(bench, n_vertices, ending) for ending in ("ply", "obj"))
        runs = {"adwave, PLY": (programs.ours, ply), "adwave, OBJ": (programs.ours, obj)}
        if n_vertices <= MOST_FOR_RIVALS:
            runs["MeshLib"] = programs.library("meshlib"), ply
            runs |= {name: (programs.step(name, "-", "-", "-"), ply) for name in ("bilateral", "guided")}
        of = found[str(n_vertices)] = {}
        for _ in range(n_turns):
            for name, (run, source) in runs.items():
                try:
                    ran = run(source, source.with_stem("timed"))
                except Failure as why:
                    bench.note(f"{name}, {n_vertices} vertices: {why}")
                    continue
                line = of.setdefault(name, {"seconds": [], "peak": 0})
                line["seconds"].append(ran.seconds)
                line["peak"] = max(line["peak"], ran.peak)
    return found
