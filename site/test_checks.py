"""Tests of the checks of the site: each fault of a small site is found.

python -m unittest test_checks
"""

import tempfile
import unittest
from pathlib import Path

import check_pages
import images
from search_index import Index

GOOD = """<html lang="en"><head><title>One</title></head><body><h1 id="one">One</h1><p>15 times, 1e-10</p>
<img src="a.svg" alt="a line" width="2" height="1"><a href="two.html#part">two</a></body></html>"""
OTHER = """<html lang="en"><head><title>Two</title></head><body><h1>Two</h1><h2 id="part">Part</h2>
<div class="card proof"><p><b>15 times</b>, and 1e-10. <a href="one.html">so</a></p></div></body></html>"""
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 2 1"></svg>'


class Checks(unittest.TestCase):
    """A site without faults, and one change for each fault."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.site = Path(folder.name)
        (self.site / "assets").mkdir()
        (self.site / "assets/search-index.js").write_text("var adwaveIndex={};")
        (self.site / "a.svg").write_text(SVG)

    def faults(self, one: str = GOOD, two: str = OTHER) -> list[str]:
        (self.site / "one.html").write_text(one)
        (self.site / "two.html").write_text(two)
        pages = check_pages.read_pages(self.site)
        return [
            *check_pages.link_faults(self.site, pages),
            *check_pages.content_faults(self.site, pages),
            *check_pages.size_faults(self.site, pages),
            *check_pages.claim_faults(pages),
        ]

    def test_a_good_site_has_no_faults(self) -> None:
        self.assertEqual(self.faults(), [])

    def test_each_fault_is_found(self) -> None:
        changes = {
            "leads to no file": ("two.html#part", "three.html"),
            "leads to no anchor": ("#part", "#parts"),
            "must be relative": ('href="two.html#part"', 'href="/two.html#part"'),
            "lang=en": (' lang="en"', ""),
            "has no title": ("<title>One</title>", ""),
            "is also that of": ("<title>One", "<title>Two"),
            "one first heading, got 2": ("</h1>", "</h1><h1>Again</h1>"),
            "no text instead": ('alt="a line"', 'alt=""'),
            "no width and height": ('width="2" ', ""),
            "leads to no file of the site": ('src="a.svg"', 'src="b.svg"'),
            "loaded from elsewhere": ("</head>", '<script src="https://example.org/a.js"></script></head>'),
            "at most 600000 bytes": ("</p>", "x" * check_pages.MOST_PAGE + "</p>"),
            "number 15 of a claim": ("15 times", "15.5 times"),
            "number 1e-10 of a claim": ("1e-10", "1e-11"),
        }
        for wanted, (old, new) in changes.items():
            with self.subTest(wanted):
                self.assertIn(old, GOOD)
                self.assertTrue(any(wanted in fault for fault in self.faults(GOOD.replace(old, new))))

    def test_a_claim_without_a_proof_is_found(self) -> None:
        faults = self.faults(two=OTHER.replace('<a href="one.html">so</a>', ""))
        self.assertTrue(any("no link to its proof" in fault for fault in faults))

    def test_sizes_of_pictures_are_read(self) -> None:
        self.assertEqual(images.size(self.site / "a.svg"), (2, 1))
        (self.site / "odd.png").write_bytes(b"GIF89a")
        with self.assertRaisesRegex(ValueError, "must be a PNG, JPEG or SVG file"):
            images.size(self.site / "odd.png")

    def test_the_index_has_each_section_with_its_anchor(self) -> None:
        index = Index()
        link = '<a class="headerlink" href="#b">¶</a>'
        index.add_page("p.html", "A", f'<h1 id="a">A</h1><p>x <code>y</code></p><h2 id="b">B{link}</h2><p>z</p>')
        self.assertEqual(index.sections, [(0, "", "A", "x y"), (0, "b", "B", "z")])


if __name__ == "__main__":
    unittest.main()
