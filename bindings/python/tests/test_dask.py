"""Tiles by the workers of Dask: processes of their own, one of which is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import adwave.dask
import pytest
from adwave.dask import Denoising, Fields, Filter, Part

distributed = pytest.importorskip("distributed")


def adwave_command(*words: object) -> None:
    subprocess.run([sys.executable, "-m", "adwave", *map(str, words), "-q"], check=True)


@pytest.fixture(scope="module")
def cloud(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cloud") / "terrain.laz"
    adwave_command("sample", "terrain", "--points", 60_000, "-o", path)
    return path


def tiles(folder: Path) -> list[bytes]:
    return [path.read_bytes() for path in sorted(folder.glob("tile-*.laz"))]


@pytest.mark.parametrize("n_workers", [2, 4])
def test_worker_processes_give_the_bytes_of_one_process(cloud: Path, tmp_path: Path, n_workers: int) -> None:
    adwave_command("tiles", cloud, "-o", tmp_path / "one", "--magnitudes", "2,4", "--gains=0,1,1,0.5", "--tiles", 8)
    with (
        distributed.LocalCluster(
            n_workers=n_workers, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        folder = adwave.dask.plan(
            cloud, tmp_path / "many", gains=[0, 1, 1, 0.5], fields=Fields(magnitudes=[2, 4]), tiles=8
        )
        paths = adwave.dask.run(folder, client)
        assert [Path(path).read_bytes() for path in paths] == tiles(tmp_path / "one")
        # Done already: nothing is written again.
        before = [os.stat(path).st_mtime_ns for path in paths]
        assert adwave.dask.run(folder, client) == paths
        assert [os.stat(path).st_mtime_ns for path in paths] == before


def test_a_filter_and_a_part_reach_the_command(cloud: Path, tmp_path: Path) -> None:
    words = ["--gains=0,0.5,1", "--along", "z", "--only", "z=..60", "--memory", "1G", "--plan-only"]
    adwave_command("tiles", cloud, "-o", tmp_path / "one", *words)
    part = Part(files=cloud, only=["z=..60"])
    chosen = Filter(gains=[0, 0.5, 1], along="z")
    folder = adwave.dask.plan(part, tmp_path / "many", gains=chosen, memory="1G")
    assert (Path(folder) / "plan.json").read_text() == (tmp_path / "one" / "plan.json").read_text()
    with pytest.raises(RuntimeError, match="--local-fit is for heights"):
        adwave.dask.plan(cloud, tmp_path / "other", gains=Filter(gains=[0, 1], local_fit="linear"))


def test_a_worker_that_is_killed_loses_nothing(cloud: Path, tmp_path: Path) -> None:
    adwave_command("tiles", cloud, "-o", tmp_path / "one", "--magnitudes", "3", "--tiles", 8)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        folder = adwave.dask.plan(cloud, tmp_path / "many", fields=Fields(magnitudes=[3]), tiles=8)
        victim = next(iter(client.run(os.getpid).values()))

        def kill() -> None:
            while not any(Path(folder).glob("near-*.bin")):
                time.sleep(0.01)
            os.kill(victim, signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        paths = adwave.dask.run(folder, client)
        killer.join()
        assert [Path(path).read_bytes() for path in paths] == tiles(tmp_path / "one")


def test_noise_is_taken_off_by_workers_as_by_one_process(cloud: Path, tmp_path: Path) -> None:
    words = ["--denoise", "--strength", "0.7", "--creases", "keep", "--tiles", 5]
    adwave_command("tiles", cloud, "-o", tmp_path / "one", *words)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        folder = adwave.dask.plan(cloud, tmp_path / "many", denoise=Denoising(strength=0.7, creases="keep"), tiles=5)
        paths = adwave.dask.run(folder, client)
        assert [Path(path).read_bytes() for path in paths] == tiles(tmp_path / "one")
    with pytest.raises(RuntimeError, match="denoise"):
        adwave.dask.plan(cloud, tmp_path / "plan", denoise=True, fields=Fields(magnitudes=[2]))


def test_what_is_wrong_comes_back_as_a_sentence(cloud: Path, tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match=r"bands must be in 1\.\.=8, got 9"):
        adwave.dask.plan(cloud, tmp_path / "plan", fields=Fields(magnitudes=[9]))
    with pytest.raises(RuntimeError, match=r"missing\.laz"):
        adwave.dask.plan(tmp_path / "missing.laz", tmp_path / "plan", fields=Fields(magnitudes=[1]))
