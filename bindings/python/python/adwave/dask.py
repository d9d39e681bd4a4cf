"""Clouds larger than memory on several processes or machines, by Dask's scheduler.

`plan` cuts LAS and LAZ files into tiles, and `run` lets the workers of a client process them. Workers must see the same
files and have adwave installed. A task is a process of its own that reads the folder and writes one file there,
completely or not at all: a worker that dies loses its current task only, a task that is run twice gives the same file,
and finished work remains if the scheduler stops. No array goes over the network.

>>> from dask.distributed import Client                                                  # doctest: +SKIP
>>> import adwave.dask
>>> fields = adwave.dask.Fields(magnitudes=[3, 6])
>>> folder = adwave.dask.plan("flight-*.laz", "tiles", fields=fields)                    # doctest: +SKIP
>>> adwave.dask.run(folder, Client("scheduler:8786"))                                    # doctest: +SKIP
['tiles/tile-00000.laz', 'tiles/tile-00001.laz', ...]

The jobs are those of ``adwave tile FOLDER JOB INDEX``, so that arrays of Slurm or GNU parallel can run the same.
"""

from __future__ import annotations

import glob
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Union

__all__ = ["Denoising", "Fields", "Filter", "Part", "plan", "run"]


@dataclass(frozen=True, kw_only=True)
class Fields:
    """Fields that tiles compute for each point.

    Parameters
    ----------
    magnitudes : sequence of int
        Bands, from 1, whose length each point gets as a field ``wavelet_j``, in the unit of the coordinates.
    vectors : sequence of int
        Bands, from 1, that each point gets as fields ``wavelet_j_x``, ``wavelet_j_y`` and ``wavelet_j_z``.
    saliency : bool or str
        A field ``saliency``, without a sign: the lengths of all levels weighted by ``'entropy'`` (for True), ``'paper'``,
        ``'normalized'`` or ``'none'``.

    Examples
    --------
    >>> import adwave.dask
    >>> adwave.dask.Fields(magnitudes=[3, 6], saliency=True).saliency
    True
    """

    magnitudes: Sequence[int] = ()
    vectors: Sequence[int] = ()
    saliency: Union[bool, str] = False


@dataclass(frozen=True, kw_only=True)
class Denoising:
    """Options of denoising by tiles; see `adwave.denoise`.

    Parameters
    ----------
    strength : float
        Factor of the noise: 0 changes nothing, 2 assumes twice the estimated noise.
    creases : {'auto', 'keep', 'none'}
        Whether sharp edges are preserved.
    noise : float, optional
        Standard deviation of the noise along the normals, in the unit of the coordinates; estimated by default.

    Examples
    --------
    >>> import adwave.dask
    >>> adwave.dask.Denoising(strength=0.7).creases
    'auto'
    """

    strength: float = 1.0
    creases: Literal["auto", "keep", "none"] = "auto"
    noise: Union[float, None] = None


@dataclass(frozen=True, kw_only=True)
class Filter:
    """Gains, and how vertices move by them, as in `adwave.filter`.

    Parameters
    ----------
    gains : sequence of float
        A gain for each band, from fine to coarse: 0 drops it, 1 keeps it.
    along : {'normal', 'surface', 'x', 'y', 'z', 'free'}, optional
        Directions in which vertices move; by default the normals of a cloud and all directions of a mesh.
    border : {'natural', 'free'}
        Treatment of the borders of a mesh.
    local_fit : {'linear', 'constant'}, optional
        Local fit of coordinates that move along one axis; linear by default, so that slopes stay.

    Examples
    --------
    >>> import adwave.dask
    >>> adwave.dask.Filter(gains=[0, 0.5, 1], along="z").border
    'natural'
    """

    gains: Sequence[float]
    along: Union[Literal["normal", "surface", "x", "y", "z", "free"], None] = None
    border: Literal["natural", "free"] = "natural"
    local_fit: Union[Literal["linear", "constant"], None] = None


@dataclass(frozen=True, kw_only=True)
class Part:
    """Files of which a part of the points is computed; the others keep their values and are nobody's neighbors.

    Parameters
    ----------
    files : path or sequence of paths
        As in `plan`.
    only : sequence of str
        Conditions that all must hold, such as ``'classification=2'`` or ``'z=100..200'``.
    mask : path, optional
        File with one number for each row of the files; points with a number other than 0 and NaN take part.
    invert_mask : bool
        Whether the points outside of the mask take part instead.
    all_points : bool
        Whether points take part that are flagged as withheld or classified as noise.

    Examples
    --------
    >>> import adwave.dask
    >>> adwave.dask.Part(files="flight-*.laz", only=["classification=2"]).all_points
    False
    """

    files: Union[str, os.PathLike[str], Sequence[Union[str, os.PathLike[str]]]]
    only: Sequence[str] = ()
    mask: Union[str, os.PathLike[str], None] = None
    invert_mask: bool = False
    all_points: bool = False


def _filter_words(chosen: Filter) -> list[str]:
    """Arguments of a filter."""
    words = ["--gains=" + ",".join(str(float(gain)) for gain in chosen.gains)]
    if chosen.along is not None:
        words += ["--along", chosen.along]
    if chosen.border != "natural":
        words += ["--border", chosen.border]
    if chosen.local_fit is not None:
        words += ["--local-fit", chosen.local_fit]
    return words


def _part_words(part: Part) -> list[str]:
    """Arguments that choose the points of a part."""
    words = [word for condition in part.only for word in ("--only", condition)]
    if part.mask is not None:
        words += ["--mask", os.fspath(part.mask)]
    if part.invert_mask:
        words.append("--invert-mask")
    if part.all_points:
        words.append("--all-points")
    return words


def plan(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | Part,
    folder: str | os.PathLike[str],
    *,
    gains: Sequence[float] | Filter = (),
    fields: Fields | None = None,
    denoise: bool | Denoising = False,
    levels: int | None = None,
    neighbors: int | None = None,
    accuracy: float = 1e-6,
    memory: str | int | None = None,
    tiles: int | None = None,
) -> str:
    """Cut clouds into tiles, and write the plan into a folder.

    Parameters
    ----------
    files : path, sequence of paths, or Part
        LAS or LAZ files of one point format and scale; names may have ``*``. Or one PLY or OBJ with faces.
    folder : path
        Folder for the plan, intermediate files and the tiles. All workers must see it under this name.
    gains : sequence of float, or Filter
        A gain for each band, from fine to coarse: 0 drops it, 1 keeps it.
    fields : Fields, optional
        Fields that each point gets.
    denoise : bool or Denoising
        Remove noise from the positions, as `adwave.denoise` does, instead of computing bands.
    levels : int, optional
        Number of dyadic levels; by default the number of gains, or 8 without gains.
    neighbors : int, optional
        Number of nearest neighbors in one step of the walk; by default 10, or 12 for denoising.
    accuracy : float
        Largest relative error of the bands.
    memory : str or int, optional
        Memory of one task, such as ``'4G'``, which determines the size of the tiles; by default half of the free memory.
    tiles : int, optional
        Number of tiles; by default as few as memory allows. Several for each worker are best.

    Returns
    -------
    str
        The folder, for `run`.

    Raises
    ------
    RuntimeError
        If the arguments or files are invalid; the message is that of the command.

    Examples
    --------
    >>> import adwave.dask
    >>> adwave.dask.plan("flight-*.laz", "tiles", denoise=adwave.dask.Denoising(strength=0.7))  # doctest: +SKIP
    '/data/tiles'
    """
    part = files if isinstance(files, Part) else Part(files=files)
    names = [part.files] if isinstance(part.files, (str, os.PathLike)) else list(part.files)
    found: list[str] = []
    for name in [os.fspath(name) for name in names]:
        found += sorted(glob.glob(name)) if glob.has_magic(name) else [name]
    words = ["tiles", *found, "-o", os.fspath(folder), "--plan-only", "--accuracy", str(accuracy)]
    words += _part_words(part)
    chosen_filter = gains if isinstance(gains, Filter) else Filter(gains=gains)
    if len(chosen_filter.gains) > 0:
        words += _filter_words(chosen_filter)
    words += _field_words(fields or Fields())
    options: list[tuple[str, object]] = [("--levels", levels), ("--memory", memory), ("--tiles", tiles)]
    options.append(("--neighbors", neighbors))
    if denoise:
        chosen = denoise if isinstance(denoise, Denoising) else Denoising()
        words.append("--denoise")
        options += [
            ("--strength", float(chosen.strength)),
            ("--creases", chosen.creases),
            ("--noise-sigma", chosen.noise),
        ]
    for option, value in options:
        if value is not None:
            words += [option, str(value)]
    _run_command(words)
    return os.path.abspath(folder)


def run(folder: str | os.PathLike[str], client: Any, *, threads: int = 1, retries: int = 3) -> list[str]:
    """Let the workers of a client do the unfinished jobs of a plan.

    Parameters
    ----------
    folder : path
        Result of `plan`.
    client : dask.distributed.Client
        Client whose workers do the jobs: several sort a part of the points each, one merges the parts, then one for each
        tile finds neighbors, one orients the normals of a cloud that is denoised, one for each tile computes its bands or
        denoises it, and one for each tile computes its saliency map, if requested.
    threads : int
        Threads of each task: as many as a worker has for it.
    retries : int
        Number of times that a task is given to another worker after an error. A task whose worker died is always given to
        another, as Dask's settings have it.

    Returns
    -------
    list of str
        LAZ files of the tiles, in the order of the curve. ``adwave tiles`` with the arguments of the plan and a file as
        its output joins them. For a mesh they are files that only that command reads, with ``--work`` and the folder.

    Raises
    ------
    RuntimeError
        If a task failed; the message is that of the task. Finished work remains, and the next call continues there.

    Examples
    --------
    >>> import adwave.dask
    >>> adwave.dask.run("tiles", client)  # doctest: +SKIP
    ['tiles/tile-00000.laz', 'tiles/tile-00001.laz', ...]
    """
    place = os.fspath(folder)

    def run_jobs(kind: str, tiles: range) -> list[dict[str, Any]]:
        # Not pure: a task is run for the file that it writes.
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

    run_jobs("run", range(int(_run_command(["tile", place, "status"])["n_runs"])))
    n_tiles = int(run_jobs("sort", range(1))[0]["n_tiles"])
    run_jobs("neighbors", range(n_tiles))
    status = _run_command(["tile", place, "status"])
    results = run_jobs("bands", range(n_tiles))
    if status["has_maps"]:
        results = run_jobs("maps", range(n_tiles))
    return [str(result["path"]) for result in results]


def _field_words(fields: Fields) -> list[str]:
    """Words of the command for the fields."""
    words = []
    for name in ("magnitudes", "vectors"):
        bands = getattr(fields, name)
        if bands:
            words.append(f"--{name}=" + ",".join(str(int(band)) for band in bands))
    if fields.saliency:
        words.append("--saliency=" + ("entropy" if fields.saliency is True else str(fields.saliency)))
    return words


def _job(folder: str, kind: str, tile: int, threads: int) -> dict[str, Any]:
    """Run a job on a worker; the result has paths and numbers, no arrays."""
    return _run_command(["tile", folder, kind, str(tile), "--if-missing", "--threads", str(threads)])


def _run_command(words: list[str]) -> dict[str, Any]:
    """JSON that the command prints, run as a separate process, so that the worker survives it."""
    command = [sys.executable, "-m", "adwave", *words, "--json", "--quiet"]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    if finished.returncode != 0:
        raise RuntimeError(_error_message(finished.stderr) or f"adwave ended with {finished.returncode}")
    return json.loads(finished.stdout)


def _error_message(output: str) -> str:
    """Error message in the output of the command, without the usage that follows conflicting arguments."""
    if output.startswith("error: "):
        return " ".join(output.partition("\n\n")[0].removeprefix("error: ").split())
    return output.strip().rpartition("\n")[2].removeprefix("adwave: ")
