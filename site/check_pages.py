"""Checks of the built site that need no browser: links and anchors, titles, pictures, sizes, and the numbers of claims.

python check_pages.py SITE
"""

from __future__ import annotations

import os
import re
import sys
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

#: Most bytes of a page, without its pictures. Pages of the Rust reference and of its sources are not limited.
MOST_PAGE = 600_000
#: Most bytes of what every page loads: styles and scripts, without the index of the search.
MOST_SHARED = 500_000
#: Most bytes of the index of the search, which is loaded when the field is first used.
MOST_INDEX = 4_000_000
#: Most bytes of one picture.
MOST_PICTURE = 1_000_000


@dataclass
class Page:
    """What a page has."""

    language: str = ""
    title: str = ""
    n_main_headings: int = 0
    anchors: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    loaded: list[str] = field(default_factory=list)
    pictures: list[dict[str, str]] = field(default_factory=list)
    #: Text and links of each claim.
    claims: list[tuple[str, list[str]]] = field(default_factory=list)
    text: str = ""


class PageParser(HTMLParser):
    """Reads a page."""

    def __init__(self) -> None:
        super().__init__()
        self.page = Page()
        self._in_title = False
        self._hidden = 0
        self._claim_depth = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        page = self.page
        if "id" in values:
            page.anchors.add(values["id"])
        if tag == "html":
            page.language = values.get("lang", "")
        elif tag == "title":
            self._in_title = not page.title
        elif tag == "h1":
            page.n_main_headings += 1
        elif tag == "a":
            page.anchors.add(values.get("name", ""))
            if "href" in values:
                page.links.append(values["href"])
                if self._claim_depth:
                    page.claims[-1][1].append(values["href"])
        elif tag == "img":
            page.pictures.append(values)
        elif tag == "link" and values.get("rel") not in ("prev", "next", "canonical"):
            page.loaded.append(values.get("href", ""))
        elif tag == "script" and "src" in values:
            page.loaded.append(values["src"])
        if tag in ("script", "style"):
            self._hidden += 1
        if tag == "div":
            if self._claim_depth:
                self._claim_depth += 1
            elif "proof" in values.get("class", "").split():
                self._claim_depth = 1
                page.claims.append(("", []))

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag in ("script", "style"):
            self._hidden -= 1

    def handle_endtag(self, tag: str) -> None:
        if tag == "title":
            self._in_title = False
        elif tag in ("script", "style"):
            self._hidden -= 1
        elif tag == "div" and self._claim_depth:
            self._claim_depth -= 1

    def handle_data(self, data: str) -> None:
        if self._in_title:
            self.page.title += data
        elif not self._hidden:
            self.page.text += data
            if self._claim_depth:
                told, links = self.page.claims[-1]
                self.page.claims[-1] = (told + data, links)


def read_pages(site: Path) -> dict[str, Page]:
    """All pages by their path below the site."""
    pages = {}
    for path in sorted(site.rglob("*.html")):
        parser = PageParser()
        parser.feed(path.read_text(encoding="utf-8"))
        pages[path.relative_to(site).as_posix()] = parser.page
    return pages


def target_of(name: str, link: str) -> tuple[str, str] | None:
    """Path and anchor of a link of a page; None if it leads elsewhere."""
    if re.match(r"[a-z]+:", link):
        return None
    path, _, anchor = link.partition("#")
    path = path.partition("?")[0]
    target = os.path.normpath(os.path.join(os.path.dirname(name), unquote(path))) if path else name
    return target, unquote(anchor)


def link_faults(site: Path, pages: dict[str, Page]) -> list[str]:
    """Links that lead nowhere, and paths that a folder on a server would break."""
    faults = []
    for name, page in pages.items():
        is_rust = name.startswith("rust/")
        # Scripts of rustdoc ask for lists that private traits do not have.
        for link in page.links + ([] if is_rust else page.loaded):
            if link.startswith("/") or re.match(r"(?:file|http):", link):
                faults.append(f"{name}: the link {link} must be relative or https")
                continue
            target = target_of(name, link)
            if target is None:
                continue
            path, anchor = target
            if path.startswith("..") or not (site / path).exists():
                faults.append(f"{name}: the link {link} leads to no file")
            elif (site / path).is_dir() and not is_rust:
                faults.append(f"{name}: the link {link} leads to a folder; add index.html")
            # Anchors of the Rust reference are rustdoc's: lines and versions of items are made by its script.
            elif anchor and path in pages and not path.startswith("rust/") and anchor not in pages[path].anchors:
                faults.append(f"{name}: the link {link} leads to no anchor")
    return faults


def content_faults(site: Path, pages: dict[str, Page]) -> list[str]:
    """Faults of titles, language, headings and pictures, and what is loaded from elsewhere."""
    faults, titles = [], {}
    for name, page in pages.items():
        if name.startswith("rust/"):
            continue
        if page.language != "en":
            faults.append(f"{name}: the page must have lang=en, got {page.language!r}")
        title = " ".join(page.title.split())
        if not title:
            faults.append(f"{name}: the page has no title")
        elif title in titles and name != "404.html":
            faults.append(f"{name}: the title {title!r} is also that of {titles[title]}")
        titles[title] = name
        if page.n_main_headings != 1:
            faults.append(f"{name}: the page must have one first heading, got {page.n_main_headings}")
        faults += [f"{name}: {link} is loaded from elsewhere" for link in page.loaded if re.match(r"[a-z]+:|//", link)]
        for picture in page.pictures:
            source = picture.get("src", "")
            if not picture.get("alt", "").strip():
                faults.append(f"{name}: the picture {source} has no text instead of it")
            if not (picture.get("width") and picture.get("height")):
                faults.append(f"{name}: the picture {source} has no width and height")
            target = target_of(name, source)
            if target is None or not (site / target[0]).is_file():
                faults.append(f"{name}: the picture {source} leads to no file of the site")
            elif (site / target[0]).stat().st_size > MOST_PICTURE:
                faults.append(f"{name}: the picture {source} has more than {MOST_PICTURE} bytes")
    return faults


def size_faults(site: Path, pages: dict[str, Page]) -> list[str]:
    """Pages and files that take too long on a phone."""
    faults = []
    for name, page in pages.items():
        if name.startswith("rust/"):
            continue
        n_bytes = (site / name).stat().st_size
        if n_bytes > MOST_PAGE:
            faults.append(f"{name}: the page must have at most {MOST_PAGE} bytes, got {n_bytes}")
        targets = [target_of(name, link) for link in page.loaded]
        files = {site / target[0] for target in targets if target is not None}
        shared = sum(path.stat().st_size for path in files if path.is_file())
        if shared > MOST_SHARED:
            faults.append(f"{name}: styles and scripts must have at most {MOST_SHARED} bytes, got {shared}")
    index = site / "assets/search-index.js"
    if not index.is_file():
        faults.append("assets/search-index.js is missing")
    elif index.stat().st_size > MOST_INDEX:
        faults.append(f"the index of the search must have at most {MOST_INDEX} bytes, got {index.stat().st_size}")
    return faults


def claim_faults(pages: dict[str, Page]) -> list[str]:
    """Numbers of claims that the page behind their link does not have."""
    faults = []
    for name, page in pages.items():
        for text, links in page.claims:
            targets = [target_of(name, link) for link in links]
            texts = [pages[target[0]].text for target in targets if target is not None and target[0] in pages]
            if not texts:
                faults.append(f"{name}: the claim “{' '.join(text.split())}” has no link to its proof")
            for number in re.findall(r"\d[\d.,]*(?:e-?\d+)?", text):
                number = number.rstrip(".,")
                pattern = rf"(?<![\d.,]){re.escape(number)}(?![\d]|[.,]\d)"
                if not any(re.search(pattern, other) for other in texts):
                    faults.append(f"{name}: the number {number} of a claim is not on the page behind its link")
    return faults


def main() -> int:
    site = Path(sys.argv[1])
    pages = read_pages(site)
    faults = link_faults(site, pages) + content_faults(site, pages) + size_faults(site, pages) + claim_faults(pages)
    print("\n".join(faults))
    n_links = sum(len(page.links) for page in pages.values())
    n_claims = sum(len(page.claims) for page in pages.values())
    print(f"{len(pages)} pages, {n_links} links, {n_claims} claims, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
