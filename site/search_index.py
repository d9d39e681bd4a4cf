"""The index of the search: sections of the pages, and items of the Rust reference."""

from __future__ import annotations

import html
import json
import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path

#: Weight of a page in the ranking, by the beginning of its address. Guides answer questions, references define names.
WEIGHTS = (
    ("reference/", 0.8),
    ("rust/", 0.4),
    ("python/gallery", 0.6),
    ("python/index", 0.75),
    ("python/package", 0.8),
    ("THEORY", 0.7),
    ("PAPER", 0.6),
    ("MESHINGS", 0.8),
    ("gallery", 0.5),
    ("TUTORIAL", 0.9),
    ("overview", 0.8),
    ("index", 0.6),
    ("architecture", 0.4),
    ("contributing", 0.4),
    ("changelog", 0.3),
)
#: Longest text that is kept of an item of the Rust reference.
MOST_CHARACTERS = 200
_BLOCKS = {"p", "li", "td", "th", "tr", "pre", "dt", "dd", "br", "div", "h1", "h2", "h3", "h4"}


@dataclass
class Section:
    """A heading with its anchor and the text below it."""

    anchor: str
    heading: str
    text: list[str] = field(default_factory=list)


class SectionParser(HTMLParser):
    """Splits the content of a page at its headings of levels 1 to 4."""

    def __init__(self) -> None:
        super().__init__()
        self.sections = [Section("", "")]
        self._in_heading = False
        self._skipped = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag in ("h1", "h2", "h3", "h4"):
            self.sections.append(Section("" if tag == "h1" else values.get("id") or "", ""))
            self._in_heading = True
        elif tag == "a" and "headerlink" in (values.get("class") or ""):
            self._skipped += 1
        elif tag in _BLOCKS:
            self.sections[-1].text.append(" ")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("h1", "h2", "h3", "h4"):
            self._in_heading = False
        elif tag == "a" and self._skipped:
            self._skipped -= 1

    def handle_data(self, data: str) -> None:
        if self._skipped:
            return
        if self._in_heading:
            self.sections[-1].heading += data
        else:
            self.sections[-1].text.append(data)


class Index:
    """Entries of the search."""

    def __init__(self) -> None:
        self.pages: list[tuple[str, str, float]] = []
        self.sections: list[tuple[int, str, str, str]] = []

    def add_page(self, url: str, title: str, content: str) -> None:
        """Add the sections of a page."""
        parser = SectionParser()
        parser.feed(content)
        self._add(url, title, [(s.anchor, s.heading, "".join(s.text)) for s in parser.sections])

    def add_rust(self, folder: Path, prefix: str) -> int:
        """Add the items of the pages that rustdoc wrote into a folder; returns their number."""
        n_items = 0
        for path in sorted(folder.glob("adwave*/**/*.html")):
            text = path.read_text(encoding="utf-8")
            title = re.search(r"<title>(.*?)(?: - Rust)?</title>", text)
            item = path.stem.partition(".")
            if title is None or item[0] not in {"struct", "enum", "trait", "fn", "macro", "index", "constant", "type"}:
                continue
            told = re.search(
                r'<details class="toggle top-doc" open>.*?<div class="docblock">(.*?)</div>', text, re.DOTALL
            )
            words = re.sub(r"<[^>]+>", "", told[1]) if told else ""
            name = html.unescape(title[1])
            url = f"{prefix}/{path.relative_to(folder).as_posix()}"
            self._add(url, f"Rust: {name}", [("", "", " ".join(html.unescape(words).split())[:MOST_CHARACTERS])])
            n_items += 1
        return n_items

    def _add(self, url: str, title: str, sections: list[tuple[str, str, str]]) -> None:
        weight = next((w for start, w in WEIGHTS if url.startswith(start)), 1.0)
        self.pages.append((url, title, weight))
        for anchor, heading, text in sections:
            text = " ".join(text.split())
            if text or heading:
                self.sections.append((len(self.pages) - 1, anchor, heading.strip(), text))

    def script(self) -> str:
        """JavaScript that defines the index, which a page can load without a server."""
        value = {"pages": self.pages, "sections": self.sections}
        return "var adwaveIndex=" + json.dumps(value, ensure_ascii=False, separators=(",", ":")) + ";\n"
