"""The public names of the package: one list of them, stubs that follow it, documentation, and short signatures."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import adwave
import pytest

#: Largest number of arguments of a public function that may be given by keyword.
MAX_KEYWORDS = 8
PACKAGE = Path(adwave.__file__).parent


def stub_text() -> str:
    """Content of `__init__.pyi`, from the list of exports."""
    lines = ["# Written by `python tests/test_exports.py` from the list in __init__.py."]
    lines += [f"from adwave import {name} as {name}" for name in adwave._MODULES]
    for module, names in adwave._EXPORTS.items():
        lines += [f"from adwave.{module} import {name} as {name}" for name in names if not name.startswith("__")]
    lines += ["", "__all__ = [", *(f'    "{name}",' for name in adwave.__all__), "]", "__version__: str", ""]
    lines += [
        "_EXPORTS: dict[str, tuple[str, ...]]",
        "_MODULES: tuple[str, ...]",
        "",
        "def __dir__() -> list[str]: ...",
        "",
    ]
    return "\n".join(lines)


def public_modules() -> list[ModuleType]:
    """Modules with public functions that can be imported here."""
    modules = [adwave]
    for name in ("baselines", "dask", "kernels", "paraview", "pyvista", "sklearn", "torch"):
        try:
            modules.append(importlib.import_module(f"adwave.{name}"))
        except ImportError:
            continue
    return modules


def public_callables() -> Iterator[tuple[str, Any]]:
    """Public functions, constructors and methods with their names."""
    for module in public_modules():
        for name in module.__all__:
            value = getattr(module, name)
            if isinstance(value, type):
                own = [base for base in value.__mro__ if base.__module__.startswith("adwave")]
                if "__init__" in vars(value) or "__init__" in vars(own[-1]):
                    yield f"{module.__name__}.{name}", value
                for base in own:
                    for method in vars(base):
                        if not method.startswith("_") and callable(getattr(value, method)):
                            yield f"{module.__name__}.{name}.{method}", getattr(value, method)
            elif callable(value):
                yield f"{module.__name__}.{name}", value


def n_keywords(function: Any) -> int:
    """Number of arguments that may be given by keyword and have a default."""
    parameters = inspect.signature(function).parameters.values()
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return sum(p.kind in kinds and p.default is not inspect.Parameter.empty for p in parameters)


def test_the_stub_follows_the_list_of_exports() -> None:
    assert (PACKAGE / "__init__.pyi").read_text(encoding="utf-8") == stub_text()


def test_no_public_function_has_more_than_eight_keywords() -> None:
    counts = {name: n_keywords(function) for name, function in public_callables()}
    assert len(counts) > 100
    assert {name: n for name, n in counts.items() if n > MAX_KEYWORDS} == {}


def test_every_public_function_is_documented_with_an_example() -> None:
    without = []
    for module in public_modules():
        if module.__name__ == "adwave.paraview":
            continue
        for name in module.__all__:
            value = getattr(module, name)
            if not callable(value) or name == "InternalError":
                continue
            doc = inspect.getdoc(value) or ""
            if ">>>" not in doc:
                without.append(f"{module.__name__}.{name}")
    assert without == []
    assert [name for name, function in public_callables() if not inspect.getdoc(function)] == []


def test_every_parameter_is_documented() -> None:
    missing = []
    for name, function in public_callables():
        doc = inspect.getdoc(function) or ""
        if name.startswith("adwave.paraview") or "\nParameters\n" not in doc:
            continue
        section = doc.split("\nParameters\n")[1]
        for parameter in inspect.signature(function).parameters:
            if parameter not in ("self", "args", "kwargs") and parameter not in section:
                missing.append(f"{name}({parameter})")
    assert missing == []


def imports_of(path: Path) -> set[str]:
    """Modules of the package that a module imports, anywhere in its text and for types too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = f"adwave.{base}".rstrip(".")
            names = [base] if base != "adwave" else [f"adwave.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        found |= {name.split(".")[1] for name in names if name.startswith("adwave.")}
    return found


def test_no_modules_import_each_other_in_a_cycle() -> None:
    names = [module.name for module in pkgutil.iter_modules([str(PACKAGE)]) if (PACKAGE / f"{module.name}.py").exists()]
    imports = {name: imports_of(PACKAGE / f"{name}.py") & set(names) - {name} for name in names}
    while imports:
        leaves = [name for name, wanted in imports.items() if not wanted & imports.keys()]
        if not leaves:
            pytest.fail(f"modules import each other in a cycle: {', '.join(sorted(imports))}")
        for name in leaves:
            del imports[name]


if __name__ == "__main__":
    target = Path(__file__).parent.parent / "python/adwave/__init__.pyi"
    target.write_text(stub_text(), encoding="utf-8")
    print(target)
