"""The add-on that `python -m adwave.blender` writes; Blender is not needed."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import adwave as aw
import pytest
from adwave import _blender_zip

NAMES = ("adwave-0.1.0-cp310-abi3-manylinux_2_28_x86_64.whl", "adwave-0.1.0-cp310-abi3-win_amd64.whl")


def test_the_addon_lists_its_wheels_and_machines(tmp_path: Path) -> None:
    wheels = [tmp_path / name for name in NAMES]
    for wheel in wheels:
        wheel.write_bytes(wheel.name.encode())
    path = tmp_path / "a.zip"
    assert _blender_zip.write_addon(path, wheels) == f"{path}: adwave for linux-x64, windows-x64"
    with zipfile.ZipFile(path) as archive:
        manifest = archive.read("blender_manifest.toml").decode()
        assert archive.read(f"wheels/{NAMES[1]}") == NAMES[1].encode()
        compile(archive.read("__init__.py"), "__init__.py", "exec")
    assert f'version = "{aw.__version__}"' in manifest
    assert 'platforms = ["linux-x64", "windows-x64"]' in manifest
    assert f'wheels = ["./wheels/{NAMES[0]}", "./wheels/{NAMES[1]}"]' in manifest
    with pytest.raises(ValueError, match="Blender runs on no 'musllinux"):
        _blender_zip.platform_of("adwave-0.1.0-cp310-abi3-musllinux_1_2_riscv64.whl")


def test_the_command_writes_it_and_says_what_is_in_it(tmp_path: Path) -> None:
    def command(*words: str) -> subprocess.CompletedProcess[str]:
        path = str(tmp_path / "b.zip")
        return subprocess.run(
            [sys.executable, "-m", "adwave.blender", "--zip", path, *words], capture_output=True, text=True
        )

    done = command("--without-wheel")
    assert done.returncode == 0 and "says how to install it" in done.stdout
    with zipfile.ZipFile(tmp_path / "b.zip") as archive:
        assert sorted(archive.namelist()) == ["__init__.py", "blender_manifest.toml"]
        assert b"wheels" not in archive.read("blender_manifest.toml")
    done = command("--wheel", "none.whl")
    assert done.returncode == 1 and done.stderr.startswith("error: ") and "Traceback" not in done.stderr


def test_the_installed_wheel_is_whole(tmp_path: Path) -> None:
    try:
        name, content = _blender_zip.installed_wheel()
    except ValueError as error:
        pytest.skip(str(error))
    path = tmp_path / name
    path.write_bytes(content)
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        record = next(n for n in names if n.endswith(".dist-info/RECORD"))
        listed = [line.split(",")[0] for line in archive.read(record).decode().splitlines()]
    assert sorted(listed) == sorted(names) and "adwave/__init__.py" in names
    words = ["install", "--quiet", "--no-deps", "--no-index", "--target", str(tmp_path / "there"), str(path)]
    done = subprocess.run([sys.executable, "-m", "pip", *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "there/adwave/blender.py").exists()
