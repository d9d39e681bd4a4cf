"""Hooks of MkDocs: navigation, front page, gallery, pages of the references, links between them, and the search."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import sys
from pathlib import Path, PurePosixPath
from typing import Any

from mkdocs.plugins import get_plugin_logger
from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).resolve().parent))
import gallery
import images
from search_index import Index

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "bindings/python/python/adwave"
log = get_plugin_logger("adwave")

#: Groups of the guides in the navigation; others follow in the last group.
GUIDES = {
    "Start": ("TUTORIAL", "DIFFUSION_WAVELETS", "TASKS", "GLOSSARY", "COMPARISON"),
    "Guides": (
        "DENOISING",
        "GRIDS",
        "SPACETIME",
        "DIRECTIONS",
        "GRAPHS",
        "DEFORM",
        "SUBDIVISION",
        "SCALE",
        "STUDIO",
        "TOOLS",
        "TORCH",
        "RUST",
        "FORMATS",
    ),
    "How fast, how right": ("BENCHMARKS", "PERFORMANCE", "CLAIMS", "EVALUATION", "MESHINGS", "PAPER", "THEORY"),
}
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
    "_resample": "Fields between registered spheres",
    "_parcels": "Parcels as signals",
    "_walk": "Walks on graphs and points",
    "_grid": "Images and volumes",
    "_raster": "Scans as grids",
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
    "kernels": "Functions of the Laplacian (adwave.kernels)",
    "baselines": "Other methods (adwave.baselines)",
    "sklearn": "scikit-learn (adwave.sklearn)",
    "torch": "PyTorch (adwave.torch)",
    "dask": "Dask (adwave.dask)",
    "pyvista": "PyVista (adwave.pyvista)",
    "paraview": "ParaView and VTK (adwave.paraview)",
}
#: Files outside of docs/ that become pages, with their names there.
PAGES = {
    "site/front.md": "index.md",
    "README.md": "overview.md",
    "CHANGELOG.md": "changelog.md",
    "ARCHITECTURE.md": "architecture.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "bindings/python/README.md": "python/package.md",
}
#: Pages that are made here, with the links relative to the root of the repository.
MADE = ("gallery.md", "rust.md")
#: Pages that are made, by the files that make them, to which links of the repository lead.
MAKERS = {"site/gallery.py": "gallery.md"}
#: Environment variable with the folder that rustdoc wrote to, if the Rust reference is part of the site.
RUSTDOC = "ADWAVE_RUSTDOC"

LINK = re.compile(r"(\]\(|src=\"|href=\")([^)\"\s]+)")
#: Links that are relative to a page of another crate's site: names without a folder and an ending.
FOREIGN = re.compile(r'<a href="[a-z_]+#[^"]*">(.*?)</a>', re.DOTALL)
#: Page to which the search and the settings of rustdoc lead back.
RUST_INDEX = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Rust reference</title>
<meta http-equiv="refresh" content="0; url=../rust.html"></head>
<body><h1>Rust reference</h1><p><a href="../rust.html">All crates</a></p></body></html>
"""
IMAGE = re.compile(r"<img\b[^>]*>")

search = Index()


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
        if module not in REFERENCE:
            log.warning(
                f"the module {module} of the Python package has no title; add one to REFERENCE in site/hooks.py"
            )
        lines = [f"# Python: {REFERENCE.get(module, module)}", ""]
        lines += [f"::: adwave.{name}" for name in names if not name.startswith("__") and module != "_native"]
        if module == "_native":
            lines += ["::: adwave._native.InternalError"]
        pages[f"reference/{module.strip('_')}.md"] = "\n\n".join(lines) + "\n"
    for module, title in MODULES.items():
        options = "\n    options:\n      show_root_heading: false\n      show_root_toc_entry: false"
        pages[f"reference/{module}.md"] = f"# Python: {title}\n\n::: adwave.{module}{options}\n"
    return pages


def rust_page() -> str:
    """Page that leads to the reference of each public crate."""
    lines = [
        "# Rust reference",
        "",
        "One crate per task; `adwave` is the method. [Use adwave from Rust](docs/RUST.md) has examples.",
        "",
        "| crate | contents |",
        "|---|---|",
    ]
    for manifest in sorted((ROOT / "crates").glob("*/Cargo.toml")):
        text = manifest.read_text(encoding="utf-8")
        description = re.search(r'^description = "(.*)"$', text, re.MULTILINE)
        if "publish = false" in text:
            continue
        name = manifest.parent.name
        target = f"rust/{name.replace('-', '_')}/index.html"
        shown = f'<a href="{target}">{name}</a>' if os.environ.get(RUSTDOC) else f"`{name}`"
        told = description[1] if description else "the method: domains, operators, bands, filters"
        lines.append(f"| {shown} | {told} |")
    return "\n".join(lines) + "\n"


def on_config(config: Any) -> Any:
    """Set the navigation and the version."""
    search.__init__()
    cargo = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    version = re.search(r'^version = "(.+)"$', cargo, re.MULTILINE)
    assert version is not None
    config["extra"]["release"] = version[1]
    gallery_pages = sorted(
        path.relative_to(config["docs_dir"]) for path in Path(config["docs_dir"]).glob("python/*/*.md")
    )
    left = {path.stem for path in Path(config["docs_dir"]).glob("*.md")}
    groups = {title: [name for name in names if name in left] for title, names in GUIDES.items()}
    left -= {name for names in groups.values() for name in names}
    groups["How fast, how right"] += sorted(left)
    pages = {title: [f"{name}.md" for name in names] for title, names in groups.items()}
    titles = [*((module.strip("_"), REFERENCE.get(module, module)) for module in exports()), *MODULES.items()]
    config["nav"] = [
        {"Home": "index.md"},
        {"Start": ["overview.md", *pages["Start"]]},
        {"Gallery": "gallery.md"},
        {"Guides": pages["Guides"]},
        {
            "Python": [
                "python/package.md",
                "python/README.md",
                *({"Notebooks": path.as_posix()} for path in gallery_pages),
                *({title: f"reference/{name}.md"} for name, title in titles),
            ]
        },
        {"Rust": "rust.md"},
        {"How fast, how right": pages["How fast, how right"]},
        {"Project": ["changelog.md", "architecture.md", "contributing.md", "security.md"]},
    ]
    return config


def on_files(files: Files, *, config: Any) -> Files:
    """Add the pages from outside of docs/ and those of the reference, and the files that they show."""
    for source, target in PAGES.items():
        files.append(File.generated(config, target, content=(ROOT / source).read_text(encoding="utf-8")))
    made = {**reference_pages(), "gallery.md": gallery.page(ROOT), "rust.md": rust_page()}
    for target, text in made.items():
        files.append(File.generated(config, target, content=text))
    return files


def site_path(path: str) -> str | None:
    """Path in the site of a file of the repository; None if it is not part of the site."""
    if path in PAGES or path in MAKERS:
        return PAGES.get(path) or MAKERS[path]
    return path.removeprefix("docs/") if path.startswith("docs/") else None


def on_page_markdown(markdown: str, *, page: Any, config: Any, files: Files) -> str:
    """Point links at the pages of the site. Links to other files of the repository become plain text."""
    uri = page.file.src_uri
    if uri.startswith("reference/"):
        return markdown
    source = uri if uri in MADE else next((path for path, target in PAGES.items() if target == uri), f"docs/{uri}")

    def rewrite(match: re.Match[str]) -> str:
        before, link = match.groups()
        if re.match(r"[a-z]+:|#|/", link) or link in MADE or link.startswith("rust/"):
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


def on_page_content(html: str, *, page: Any, config: Any, files: Files) -> str:
    """Give pictures their sizes, and add the page to the search."""
    folder = PurePosixPath(page.file.src_uri).parent
    n_pictures = 0

    def sized(match: re.Match[str]) -> str:
        nonlocal n_pictures
        tag = match[0]
        source = re.search(r'src="([^"]+)"', tag)
        if source is None or re.match(r"[a-z]+:", source[1]):
            return tag
        path = os.path.normpath(Path(config["docs_dir"]) / folder / source[1])
        width, height = images.size(Path(path))
        n_pictures += 1
        lazy = ' loading="lazy"' if n_pictures > 1 else ""
        return tag.replace("<img", f'<img width="{width}" height="{height}"{lazy}', 1)

    html = IMAGE.sub(sized, html)
    # A page has one first heading; tables that programs write bring their own.
    head, first, rest = html.partition("</h1>")
    html = head + first + re.sub(r"<(/?)h1\b", r"<\1h2", rest)
    title = f"Python: {page.title}" if page.file.src_uri.startswith("reference/") else page.title
    search.add_page(page.url, title, html)
    return html


def cut_foreign_links(folder: Path) -> None:
    """Turn links of the documentation of dependencies, which rustdoc repeats below our types, into plain text."""
    for path in folder.glob("adwave*/**/*.html"):
        text = path.read_text(encoding="utf-8")
        cut = FOREIGN.sub(r"\1", text)
        if cut != text:
            path.write_text(cut, encoding="utf-8")


def on_post_build(*, config: Any) -> None:
    """Write the index of the search, and copy the Rust reference."""
    site = Path(config["site_dir"])
    rustdoc = os.environ.get(RUSTDOC)
    if rustdoc:
        shutil.copytree(rustdoc, site / "rust", ignore=shutil.ignore_patterns(".lock"))
        cut_foreign_links(site / "rust")
        (site / "rust/index.html").write_text(RUST_INDEX, encoding="utf-8")
        n_items = search.add_rust(site / "rust", "rust")
        if n_items == 0:
            log.warning(f"{rustdoc} has no items of the Rust reference")
    # Its links begin at the root of a server, and nobody knows in which folder of one the site lies.
    (site / "404.html").unlink(missing_ok=True)
    (site / "assets/search-index.js").write_text(search.script(), encoding="utf-8")
