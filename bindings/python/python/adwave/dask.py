"""Clouds that are larger than memory on several processes or machines, by Dask's scheduler.

`plan` cuts LAS and LAZ files into tiles, `run` has the workers of a client do them. Workers must see the same files and have adwave. A task is a
process of its own that reads the folder and writes one file there, whole or not at all: a worker that dies loses its task and nothing else, a task that is
done twice gives the same file, and what is done stays done when the scheduler goes. No array goes over the network.

>>> from dask.distributed import Client                                     # doctest: +SKIP
>>> import adwave.dask
>>> folder = adwave.dask.plan("flight-*.laz", "tiles", magnitudes=[3, 6])    # doctest: +SKIP
>>> adwave.dask.run(folder, Client("scheduler:8786"))                        # doctest: +SKIP
['tiles/tile-00000.laz', 'tiles/tile-00001.laz', ...]

The jobs are those of ``adwave tile FOLDER JOB INDEX``, so that arrays of Slurm's or GNU parallel do the same.
"""

from __future__ import annotations

import glob
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

__all__ = ["plan", "run"]


def plan(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    folder: str | os.PathLike[str],
    *,
    gains: Sequence[float] = (),
    magnitudes: Sequence[int] = (),
    vectors: Sequence[int] = (),
    saliency: bool | str = False,
    denoise: bool = False,
    strength: float = 1.0,
    creases: str = "auto",
    noise: float | None = None,
    levels: int | None = None,
    neighbors: int | None = None,
    accuracy: float = 1e-6,
    memory: str | int | None = None,
    tiles: int | None = None,
) -> str:
    """Cut clouds into tiles, and write the plan of it into a folder.

    Parameters
    ----------
    files : path or sequence of paths
        LAS or LAZ files of one point format and scale; names may have ``*``. Or one PLY or OBJ with faces.
    folder : path
        For the plan, what it needs on the way, and the tiles. All workers must see it under this name.
    gains : sequence of float
        A gain for each band, from fine to coarse: 0 drops it, 1 keeps it.
    magnitudes : sequence of int
        Bands, from 1, whose length each point gets as a field ``wavelet_j``, in the unit of the coordinates.
    vectors : sequence of int
        Bands, from 1, that each point gets as fields ``wavelet_j_x``, ``wavelet_j_y`` and ``wavelet_j_z``.
    saliency : bool or str
        A field ``saliency``: the lengths of all levels weighed by ``'entropy'`` (which True means), ``'paper'``, ``'normalized'`` or ``'none'``, without a
        sign.
    denoise : bool
        Takes the noise off the positions, as `adwave.denoise` does, in place of all that bands give.
    strength : float
        By how much the noise counts: 0 changes nothing, 2 takes it for twice as large.
    creases : str
        What becomes of creases: ``'auto'``, ``'keep'`` or ``'none'``.
    noise : float, optional
        Standard deviation of the noise along the normals, in the unit of the coordinates; estimated, where it is left out.
    levels : int, optional
        Number of dyadic levels; as many as there are gains, else 8.
    neighbors : int, optional
        How many nearest neighbors a step of the walk takes in; 10, of a work that denoises 12.
    accuracy : float
        Relative error of the bands.
    memory : str or int, optional
        Of one task, such as ``'4G'``; decides how large tiles are. Half of what is free here, where it is left out.
    tiles : int, optional
        How many tiles; as few as memory allows, where it is left out. Take several for each worker.

    Returns
    -------
    str
        The folder, for `run`.

    Raises
    ------
    RuntimeError
        With the sentence that says what is wrong.
    """
    names = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    found: list[str] = []
    for name in [os.fspath(name) for name in names]:
        found += sorted(glob.glob(name)) if glob.has_magic(name) else [name]
    words = ["tiles", *found, "-o", os.fspath(folder), "--plan-only"]
    words += ["--accuracy", str(accuracy)]
    if gains:
        words.append("--gains=" + ",".join(str(float(gain)) for gain in gains))
    if magnitudes:
        words.append("--magnitudes=" + ",".join(str(int(band)) for band in magnitudes))
    if vectors:
        words.append("--vectors=" + ",".join(str(int(band)) for band in vectors))
    if saliency:
        words.append("--saliency=" + ("entropy" if saliency is True else str(saliency)))
    options: list[tuple[str, object]] = [("--levels", levels), ("--memory", memory), ("--tiles", tiles)]
    options.append(("--neighbors", neighbors))
    if denoise:
        words.append("--denoise")
        options += [("--strength", float(strength)), ("--creases", creases), ("--noise-sigma", noise)]
    for option, value in options:
        if value is not None:
            words += [option, str(value)]
    _adwave(words)
    return os.path.abspath(folder)


def run(folder: str | os.PathLike[str], client: Any, *, threads: int = 1, retries: int = 3) -> list[str]:
    """Have the workers of a client do what is not done yet of a plan.

    Parameters
    ----------
    folder : path
        What `plan` gave.
    client : dask.distributed.Client
        Its workers do the jobs: several sort some of the points each, one merges these, then one for each tile finds neighbors, of a cloud
        that is denoised one the orientation of its normals, then one for each tile computes its bands or takes the noise off, and one its map,
        where there is to be one.
    threads : int
        Threads of each task: as many as a worker has for it.
    retries : int
        How often a task is given to another worker after an error; one whose worker died is always given to another, as Dask's settings have it.

    Returns
    -------
    list of str
        The LAZ files of the tiles, in the order of the curve. ``adwave tiles`` with the arguments of the plan and a file as its output joins them. Of a
        mesh they are files that only that command understands, with ``--work`` and the folder.

    Raises
    ------
    RuntimeError
        With the sentence of the task that failed; what is done stays, and the next call goes on there.
    """
    place = os.fspath(folder)

    def done(kind: str, tiles: range) -> list[dict[str, Any]]:
        # Not pure: a task is done for the file that it leaves.
        futures = [
            client.submit(
                _job,
                place,
                kind,
                tile,
                threads,
                retries=retries,
                pure=False,
                key=f"{kind}-{tile}-{os.urandom(8).hex()}",
            )
            for tile in tiles
        ]
        return client.gather(futures)

    done("run", range(int(_adwave(["tile", place, "status"])["n_runs"])))
    n_tiles = int(done("sort", range(1))[0]["n_tiles"])
    done("neighbors", range(n_tiles))
    status = _adwave(["tile", place, "status"])
    if status["has_orientation"]:
        done("orientation", range(n_tiles))
    results = done("bands", range(n_tiles))
    if status["has_maps"]:
        results = done("maps", range(n_tiles))
    return [str(result["path"]) for result in results]


def _job(folder: str, kind: str, tile: int, threads: int) -> dict[str, Any]:
    """What a worker does: paths and numbers come back, no arrays."""
    return _adwave(["tile", folder, kind, str(tile), "--if-missing", "--threads", str(threads)])


def _adwave(words: list[str]) -> dict[str, Any]:
    """The JSON that the command says, by a process of its own: where that dies, the worker lives."""
    command = [sys.executable, "-m", "adwave", *words, "--json", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(_sentence(done.stderr) or f"adwave ended with {done.returncode}")
    return json.loads(done.stdout)


def _sentence(said: str) -> str:
    """What is wrong, of all that the command says; of arguments that do not go together without the usage that follows."""
    if said.startswith("error: "):
        return " ".join(said.partition("\n\n")[0].removeprefix("error: ").split())
    return said.strip().rpartition("\n")[2].removeprefix("adwave: ")
