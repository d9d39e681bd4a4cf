"""`pyproject.toml`: extras by task bring what the package imports, and plain pip builds as the wheels are built."""

from __future__ import annotations

import ast
import re
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

import adwave as aw
import pytest

tomllib = pytest.importorskip("tomllib")

FOLDER = Path(__file__).parents[1]
PROJECT: dict[str, Any] = tomllib.loads((FOLDER / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS: dict[str, list[str]] = PROJECT["project"]["optional-dependencies"]
#: Package of each module whose name differs.
PACKAGES = {"sklearn": "scikit-learn", "vtkmodules": "vtk", "triton": "torch"}
#: Modules that only exist inside of a program, or only for type checkers.
ELSEWHERE = {"bpy", "bpy_extras", "paraview", "typing_extensions"}


def packages_of(extra: str) -> set[str]:
    """Packages of an extra and of the extras in it."""
    found = set()
    for text in EXTRAS[extra]:
        inner = re.fullmatch(r"adwave\[(.+)\]", text)
        found |= {name for part in inner[1].split(",") for name in packages_of(part)} if inner else {text}
    return found


def imported_modules() -> set[str]:
    """Modules of other packages that the files of this package import, also inside of functions."""
    found = set()
    for path in Path(aw.__path__[0]).glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
    return found - sys.stdlib_module_names - {"adwave", "numpy"} - ELSEWHERE


def test_extras_bring_what_the_package_imports() -> None:
    modules = imported_modules()
    assert {"pyvista", "scipy", "sklearn", "torch"} <= modules
    missing = {PACKAGES.get(name, name) for name in modules} - packages_of("all") - packages_of("torch")
    assert not missing, f"pyproject.toml: an extra must bring {sorted(missing)}"


def test_extras_are_sorted_by_task_and_explained() -> None:
    assert set(EXTRAS) == {"all", "cells", "neuro", "torch", "vtk"}
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    for extra in EXTRAS:
        assert f"`adwave[{extra}]`" in readme, f"README.md must name adwave[{extra}]"
    for extra in ("cells", "neuro", "vtk"):
        assert packages_of(extra) < packages_of("all")
    assert "torch" in packages_of("torch") and "torch" not in packages_of("all")


def test_an_installed_package_has_the_extras() -> None:
    try:
        found = metadata.distribution("adwave").metadata
    except metadata.PackageNotFoundError:
        pytest.skip("the package is assembled, not installed")
    assert set(found.get_all("Provides-Extra") or []) == set(EXTRAS)


def test_plain_pip_builds_with_the_profile_of_the_wheels() -> None:
    profile = PROJECT["tool"]["maturin"]["profile"]
    workspace = FOLDER.parents[1] / "Cargo.toml"
    if not workspace.exists():
        pytest.skip("the tests are run without the repository")
    wheel = tomllib.loads(workspace.read_text(encoding="utf-8"))["profile"]["wheel"]
    assert profile == "wheel" and wheel["opt-level"] == "s" and wheel["codegen-units"] == 1
    # With "fat" the level of the package that is linked counts for all crates, and products are not vectorized.
    computing = {"adwave", "adwave-register", "adwave-render", "faer", "pulp"}
    assert wheel["lto"] == "off" and all(wheel["package"][name]["opt-level"] == 3 for name in computing)
