"""Checks the workflows and the recipe of conda: what a server would refuse or what would fail late.

python check_workflows.py
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parents[2]
EXPRESSION = re.compile(r"\$\{\{\s*(.*?)\s*\}\}")
#: Versions of actions: a number, or the branch of releases that PyPI's action is published by.
ACTION = re.compile(r"[\w.-]+/[\w./-]+@(?:v\d+(?:\.\d+)*|release/v\d+|[0-9a-f]{40})")


class StrictLoader(yaml.SafeLoader):
    """A loader that refuses a key that is given twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [self.construct_object(key) for key, _ in node.value]
        twice = {key for key in keys if keys.count(key) > 1}
        if twice:
            raise yaml.constructor.ConstructorError(None, None, f"given twice: {twice}", node.start_mark)
        return super().construct_mapping(node, deep)


def load(text: str) -> dict[Any, Any]:
    """A file of YAML; `on` is a truth value in YAML 1.1, so it comes as True."""
    return yaml.load(text, StrictLoader)


def matrix_keys(job: dict[str, Any]) -> set[str]:
    """Names that the matrix of a job defines in all of its rows."""
    matrix = job.get("strategy", {}).get("matrix", {})
    rows = [set(row) for row in matrix.get("include", [])]
    keys = {key for key in matrix if key not in ("include", "exclude")}
    return keys | (set.intersection(*rows) if rows else set())


def step_faults(step: dict[str, Any], place: str, root: Path) -> list[str]:
    """Faults of a step."""
    faults = []
    if ("uses" in step) == ("run" in step):
        faults.append(f"{place}: a step must have either uses or run")
    if "uses" in step and not ACTION.fullmatch(step["uses"]):
        faults.append(f"{place}: {step['uses']} must name a version, such as @v4")
    if "run" in step:
        script = EXPRESSION.sub("x", step["run"])
        checked = subprocess.run(["bash", "-n"], input=script, text=True, capture_output=True)
        if checked.returncode != 0:
            faults.append(f"{place}: {checked.stderr.strip()}")
        for path in re.findall(r"(?<![\w/])\.github/scripts/[\w.]+", script):
            if not (root / path).exists():
                faults.append(f"{place}: {path} does not exist")
    return faults


def job_faults(name: str, job: dict[str, Any], jobs: dict[str, Any], root: Path) -> list[str]:
    """Faults of a job."""
    needs = job.get("needs", [])
    needs = [needs] if isinstance(needs, str) else needs
    faults = [f"{name}: needs {other}, which is no job" for other in needs if other not in jobs]
    if "uses" in job:
        if not (root / job["uses"]).exists():
            faults.append(f"{name}: {job['uses']} does not exist")
        return faults
    if "runs-on" not in job:
        faults.append(f"{name}: has no runs-on")
    if "timeout-minutes" not in job:
        faults.append(f"{name}: has no timeout-minutes; a job that hangs would run for six hours")
    keys = matrix_keys(job)
    ids = {step.get("id") for step in job.get("steps", [])}
    for expression in EXPRESSION.findall(yaml.safe_dump(job)):
        for key in re.findall(r"matrix\.(\w+)", expression):
            if key not in keys:
                faults.append(f"{name}: matrix.{key} is not in every row of the matrix")
        for key in re.findall(r"steps\.(\w+)", expression):
            if key not in ids:
                faults.append(f"{name}: there is no step {key}")
    for i, step in enumerate(job.get("steps", [])):
        faults += step_faults(step, f"{name}, step {i + 1}", root)
    return faults


def workflow_faults(text: str, root: Path) -> list[str]:
    """Faults of a workflow."""
    try:
        flow = load(text)
    except yaml.YAMLError as error:
        return [str(error)]
    faults = [f"the workflow has no {key!r}" for key in ("name", True, "permissions", "jobs") if key not in flow]
    jobs = flow.get("jobs", {})
    return faults + [fault for name, job in jobs.items() for fault in job_faults(name, job, jobs, root)]


def recipe_faults(text: str, cargo: str, pyproject: str) -> list[str]:
    """Faults of the recipe of conda beside the files that it repeats."""
    try:
        recipe = load(text)
    except yaml.YAMLError as error:
        return [str(error)]
    parts = ("schema_version", "context", "package", "source", "build", "requirements", "tests", "about")
    faults = [f"the recipe has no {part}" for part in parts if part not in recipe]
    if faults:
        return faults
    version = re.search(r'^version = "(.+)"$', cargo, re.MULTILINE)
    if version is None or recipe["context"]["version"] != version[1]:
        faults.append(f"the recipe must have version {version and version[1]}, got {recipe['context']['version']}")
    if f'requires-python = ">={recipe["context"]["python_min"]}"' not in pyproject:
        faults.append("python_min of the recipe must be requires-python of pyproject.toml")
    for requirement in recipe["requirements"]["run"][1:]:
        if requirement.replace(" ", "") not in pyproject:
            faults.append(f"pyproject.toml does not require {requirement}")
    return faults


def rendering_faults(path: Path) -> list[str]:
    """Faults that rattler-build finds when it reads and renders the recipe with the compilers of conda-forge."""
    from rattler_build import RattlerBuildError, Stage0Recipe, VariantConfig

    variants = VariantConfig({"c_compiler": ["gcc"], "c_stdlib": ["sysroot"], "rust_compiler": ["rust"]})
    try:
        rendered = Stage0Recipe.from_file(str(path)).render(variants)
    except (RattlerBuildError, ValueError) as error:
        return [f"rattler-build: {error}"]
    return [] if len(rendered) == 1 else [f"the recipe must give one package per system, got {len(rendered)}"]


def main() -> int:
    faults, paths = [], sorted((ROOT / ".github/workflows").glob("*.yml"))
    for path in paths:
        faults += [f"{path.name}: {fault}" for fault in workflow_faults(path.read_text(encoding="utf-8"), ROOT)]
    texts = ("packaging/conda/recipe.yaml", "Cargo.toml", "bindings/python/pyproject.toml")
    faults += recipe_faults(*((ROOT / name).read_text(encoding="utf-8") for name in texts))
    faults += rendering_faults(ROOT / "packaging/conda/recipe.yaml")
    print("\n".join(faults) or f"{len(paths)} workflows and the recipe of conda have no faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
