"""Hooks of MkDocs: the navigation, the README as front page, the pages of the reference, and links between all of them."""

from __future__ import annotations

import importlib.util
import os
import re
from pathlib import Path, PurePosixPath
from typing import Any

from mkdocs.plugins import get_plugin_logger
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "bindings/python/python/adwave"
log = get_plugin_logger("adwave")

#: Guides in the order of the navigation; others follow by name.
GUIDES = ("TUTORIAL", "STUDIO", "TOOLS", "FORMATS", "SCALE", "THEORY")
#: Title of the reference page of each private module.
REFERENCE = {
    "_shape": "Shapes and files",
    "_edits": "Decompose, smooth, filter",
    "_denoise": "Denoise",
    "_decomposer": "Decomposer, bands and layers",
    "_options": "Levels, operator, constraints",
    "_measures": "Saliency and features",
    "_repeatability": "Repeatability",
    "_deform": "Bend and clone",
    "_detail": "Transfer and morph",
    "_register": "Match, measure distances, simplify",
    "_hierarchy": "Levels of subdivision",
    "_walk": "Walks on graphs and points",
    "_grid": "Images and volumes",
    "_time": "Time",
    "_union": "Several domains as one",
    "_sequence": "Animations",
    "_vectors": "Directions and tensors",
    "_impute": "Averages over similar cells",
    "_info": "Facts, regions, signals, presets",
    "_recipe": "Recipes",
    "_picture": "Pictures",
    "_studio": "Studio",
    "_environment": "Threads and versions",
    "_native": "Errors",
}
#: Title of the reference page of each public module.
MODULES = {
    "baselines": "Other methods (adwave.baselines)",
    "sklearn": "scikit-learn (adwave.sklearn)",
    "torch": "PyTorch (adwave.torch)",
    "dask": "Dask (adwave.dask)",
    "pyvista": "PyVista (adwave.pyvista)",
    "paraview": "ParaView and VTK (adwave.paraview)",
}
#: Files outside of docs/ that become pages, with their names there.
PAGES = {"README.md": "index.md", "CHANGELOG.md": "changelog.md", "bindings/python/README.md": "python/package.md"}

LINK = re.compile(r"(\]\(|src=\"|href=\")([^)\"\s]+)")


def exports() -> dict[str, tuple[str, ...]]:
    """Public names of each private module, from the package's own list."""
    spec = importlib.util.spec_from_file_location("adwave", PACKAGE / "__init__.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module._EXPORTS


def reference_pages() -> dict[str, str]:
    """Text of each reference page by its path."""
    pages = {}
    for module, names in exports().items():
        lines = [f"# {REFERENCE[module]}", ""]
        lines += [f"::: adwave.{name}" for name in names if not name.startswith("__") and module != "_native"]
        if module == "_native":
            lines += ["::: adwave._native.InternalError"]
        pages[f"reference/{module.strip('_')}.md"] = "\n\n".join(lines) + "\n"
    for module, title in MODULES.items():
        options = "\n    options:\n      show_root_heading: false\n      show_root_toc_entry: false"
        pages[f"reference/{module}.md"] = f"# {title}\n\n::: adwave.{module}{options}\n"
    return pages


def on_config(config: Any) -> Any:
    """Set the navigation."""
    docs = Path(config["docs_dir"])
    guides = sorted(path.stem for path in docs.glob("*.md"))
    guides.sort(key=lambda name: GUIDES.index(name) if name in GUIDES else len(GUIDES))
    titles = [*((module.strip("_"), title) for module, title in REFERENCE.items()), *MODULES.items()]
    config["nav"] = [
        {"adwave": "index.md"},
        {"Guides": [f"{name}.md" for name in guides]},
        {"Python": ["python/package.md", "python/README.md"]},
        {"Python reference": [{title: f"reference/{name}.md"} for name, title in titles]},
        {"Changelog": "changelog.md"},
    ]
    return config


def on_files(files: Files, *, config: Any) -> Files:
    """Add the pages from outside of docs/ and those of the reference, and the files that they show."""
    for source, target in PAGES.items():
        files.append(File.generated(config, target, content=(ROOT / source).read_text(encoding="utf-8")))
    for target, text in reference_pages().items():
        files.append(File.generated(config, target, content=text))
    return files


def site_path(path: str) -> str | None:
    """Path in the site of a file of the repository; None if it is not part of the site."""
    if path in PAGES:
        return PAGES[path]
    return path.removeprefix("docs/") if path.startswith("docs/") else None


def on_page_markdown(markdown: str, *, page: Any, config: Any, files: Files) -> str:
    """Point links at the pages of the site. Links to other files of the repository become plain text."""
    uri = page.file.src_uri
    if uri.startswith("reference/"):
        return markdown
    source = next((path for path, target in PAGES.items() if target == uri), f"docs/{uri}")

    def rewrite(match: re.Match[str]) -> str:
        before, link = match.groups()
        if re.match(r"[a-z]+:|#|/", link):
            return match[0]
        path, _, anchor = link.partition("#")
        repository_path = os.path.normpath((PurePosixPath(source).parent / path).as_posix())
        if not (ROOT / repository_path).exists():
            log.warning(f"{source}: the link {link} leads to no file")
        target = site_path(repository_path)
        if target is None or (ROOT / repository_path).is_dir():
            return f"{before}#OUTSIDE"
        relative = os.path.relpath(target, PurePosixPath(uri).parent.as_posix() or ".")
        return f"{before}{relative}{'#' + anchor if anchor else ''}"

    markdown = LINK.sub(rewrite, markdown)
    return re.sub(r"(?<!!)\[([^\]]+)\]\(#OUTSIDE\)", r"\1", markdown)
