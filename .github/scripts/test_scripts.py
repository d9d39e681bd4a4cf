"""Tests of the checks of workflows and of what is released: each fault is found.

python -m unittest test_scripts
"""

import tempfile
import unittest
from pathlib import Path

import check_dist
import check_workflows

FLOW = """
name: a
on: push
permissions: {contents: read}
jobs:
  one:
    runs-on: ${{ matrix.runner }}
    timeout-minutes: 5
    strategy:
      matrix:
        include:
          - { runner: a, target: b }
    steps:
      - uses: actions/checkout@v4
        id: code
      - run: echo ${{ matrix.target }} ${{ steps.code.outputs.path }}
  two:
    needs: one
    uses: ./one.yml
"""

WHEELS = (
    "manylinux_2_17_x86_64.manylinux2014_x86_64",
    "manylinux_2_28_aarch64",
    "musllinux_1_2_x86_64",
    "musllinux_1_2_aarch64",
    "macosx_11_0_x86_64",
    "macosx_11_0_arm64",
    "win_amd64",
)
FILES = {f"adwave-0.1.0-cp310-abi3-{tag}.whl": 7_000_000 for tag in WHEELS} | {"adwave-0.1.0.tar.gz": 5_000_000}


class Workflows(unittest.TestCase):
    """A workflow without faults, and one change for each fault."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "one.yml").touch()

    def test_a_good_workflow_has_no_faults(self) -> None:
        self.assertEqual(check_workflows.workflow_faults(FLOW, self.root), [])

    def test_each_fault_is_found(self) -> None:
        changes = {
            "given twice": ("name: a", "name: a\nname: b"),
            "no 'permissions'": ("permissions: {contents: read}\n", ""),
            "needs three": ("needs: one", "needs: three"),
            "does not exist": ("./one.yml", "./two.yml"),
            "no runs-on": ("runs-on: ${{ matrix.runner }}", "name: x"),
            "no timeout-minutes": ("    timeout-minutes: 5\n", ""),
            "matrix.target is not in": (", target: b", ""),
            "there is no step code": ("id: code", "id: other"),
            "must name a version": ("checkout@v4", "checkout"),
            "either uses or run": ("- run: echo", "- env: echo"),
            "syntax error": ("- run: echo", "- run: if echo"),
            ".github/scripts/none.py does not exist": ("- run: echo", "- run: python .github/scripts/none.py"),
        }
        for wanted, (old, new) in changes.items():
            with self.subTest(wanted):
                self.assertIn(old, FLOW)
                faults = check_workflows.workflow_faults(FLOW.replace(old, new), self.root)
                self.assertTrue(any(wanted in fault for fault in faults), faults)

    def test_a_recipe_of_another_version_is_found(self) -> None:
        root = check_workflows.ROOT
        recipe = (root / "packaging/conda/recipe.yaml").read_text(encoding="utf-8")
        pyproject = (root / "bindings/python/pyproject.toml").read_text(encoding="utf-8")
        faults = check_workflows.recipe_faults(recipe, 'version = "9.9.9"', pyproject)
        self.assertTrue(any("9.9.9" in fault for fault in faults), faults)
        faults = check_workflows.recipe_faults(recipe.replace("numpy >=1.22", "numpy >=2.9"), "", pyproject)
        self.assertTrue(any("numpy >=2.9" in fault for fault in faults), faults)

    def test_a_recipe_that_cannot_be_rendered_is_found(self) -> None:
        text = (check_workflows.ROOT / "packaging/conda/recipe.yaml").read_text(encoding="utf-8")
        for old, new in (("schema_version: 1", "schema_version: 9"), ('compiler("rust")', "compiler(rust)")):
            path = self.root / "recipe.yaml"
            path.write_text(text.replace(old, new), encoding="utf-8")
            self.assertTrue(check_workflows.rendering_faults(path), new)


class Distributions(unittest.TestCase):
    """The files of a release."""

    def test_a_whole_release_has_no_faults(self) -> None:
        self.assertEqual(check_dist.faults(FILES), [])

    def test_each_fault_is_found(self) -> None:
        for name in FILES:
            with self.subTest(name):
                left = {other: size for other, size in FILES.items() if other != name}
                self.assertEqual(len(check_dist.faults(left)), 1)
        first = next(iter(FILES))
        changes = {
            "at most 8000000 bytes": {first: 9_000_000},
            "one version, got 0.1.0, 0.2.0": {"adwave-0.2.0.tar.gz": 1},
            "neither a wheel": {"adwave-0.1.0-cp311-cp311-win_amd64.whl": 1},
        }
        for wanted, change in changes.items():
            with self.subTest(wanted):
                faults = check_dist.faults({**FILES, **change})
                self.assertTrue(any(wanted in fault for fault in faults), faults)


if __name__ == "__main__":
    unittest.main()
