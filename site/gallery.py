"""The page of the gallery: pictures of the guides with the line that makes each, and the examples in Python."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Card:
    """What goes in, what comes out, and the line that does it, with its picture and the page that has the line."""

    title: str
    goes_in: str
    comes_out: str
    line: str
    picture: str
    page: str
    alt: str


#: Cards of the command. Each line stands in its page, whose commands are tested.
CARDS = (
    Card(
        "Remove noise",
        "a scan of a machined part",
        "flat faces and sharp edges",
        "adwave denoise scan.obj -o clean.obj",
        "readme-denoise.jpg",
        "README.md",
        "A machined part with strong noise, and the same part without it",
    ),
    Card(
        "Enhance one place",
        "a scan of a creature",
        "deeper scales on its head, the rest unchanged to the last bit",
        "adwave filter scan.obj -o crisp.obj --preset enhance --region 'ball:vertex=120,radius=10%'",
        "diffusion-edits.jpg",
        "docs/TASKS.md",
        "Fine detail removed, fine detail doubled, and only the head changed",
    ),
    Card(
        "Find what stands out",
        "a shape",
        "keypoints with positions, widths and strengths",
        "adwave features scan.obj -o keypoints.csv",
        "readme-python.jpg",
        "docs/TASKS.md",
        "The creature with enhanced bands, its saliency map, and its features as balls",
    ),
    Card(
        "Relief of land by scale",
        "a raster of heights",
        "the same land without what is finer than 480 m",
        "adwave filter hills.tif -o plain.tif --lengths 480 --gains 0",
        "grids.jpg",
        "docs/GRIDS.md",
        "Heights of a landscape drawn flat, as a relief, and as a smooth relief",
    ),
    Card(
        "A laser scan larger than memory",
        "tiles of an airborne scan",
        "the magnitude of bands at each point",
        "adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6",
        "scale.png",
        "docs/SCALE.md",
        "Hills, roofs and trees from above, colored by the norm of a band",
    ),
    Card(
        "Simplify within a tolerance",
        "a part of 50 000 vertices",
        "as few vertices as 0.03 allows, with a proven distance",
        "adwave simplify part.stl -o small.stl --error 0.03",
        "simplify-distance.png",
        "docs/TASKS.md",
        "A part with its distance from its simplification as color",
    ),
    Card(
        "Match two scans",
        "two scans of one thing",
        "the motion between them, with its confidence, or none",
        "adwave match scan1.ply scan2.ply --picture matches.png",
        "match-windows.png",
        "docs/TASKS.md",
        "Two pieces of a wall, and boxes where the left one fits on the right one",
    ),
    Card(
        "Bend and keep the detail",
        "a shape and a base edited elsewhere",
        "the detail of the shape on the bent base",
        "adwave rebase bust.obj --base bent.obj -o posed.obj",
        "deform-grab.jpg",
        "docs/DEFORM.md",
        "A creature before and twice during a pull at its hand",
    ),
    Card(
        "Edit in the browser",
        "any shape",
        "a slider for each band, a brush, and a recipe to repeat the edit",
        "adwave studio scan.ply",
        "studio.png",
        "docs/STUDIO.md",
        "The studio with a painted region and one slider for each of eight bands",
    ),
)

LINK = re.compile(r"\[([^\]]+)\]\(([^)]+\.(?:py|ipynb))\)")
PICTURE = re.compile(r"!\[([^\]]*)\](?:\(([^)]+)\)|\[([^\]]+)\])")
CODE = re.compile(r"^```python\n.*?^```$", re.MULTILINE | re.DOTALL)
REFERENCE = re.compile(r"^\[([^\]]+)\]: (\S+)$", re.MULTILINE)


def command_cards(root: Path) -> list[str]:
    """Markdown of the cards of the command."""
    cards = []
    for card in CARDS:
        if card.line not in (root / card.page).read_text(encoding="utf-8"):
            raise ValueError(f"{card.page} must have the line of the card “{card.title}”: {card.line}")
        cards.append(
            f'<div class="card picture-card" markdown>\n![{card.alt}](docs/{card.picture})\n\n'
            f"### {card.title}\n{card.goes_in} → {card.comes_out}\n\n```sh\n{card.line}\n```\n\n[How]({card.page})\n</div>"
        )
    return cards


def python_cards(root: Path) -> list[str]:
    """Markdown of a card for each section of `docs/python/README.md` that has an example and a picture."""
    text = (root / "docs/python/README.md").read_text(encoding="utf-8")
    targets = dict(REFERENCE.findall(text))
    cards = []
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, body = section.partition("\n")
        example, pictures = LINK.search(body), list(PICTURE.finditer(body))
        if example is None or not pictures:
            continue
        alt, path, reference = pictures[-1].groups()
        path = path or targets[reference]
        told = body[example.end() :].lstrip(": \n")
        told = re.split(r"(?<=[.!?])\s", " ".join(told.split("\n\n")[0].split()))[0]
        anchor = re.sub(r"[^a-z0-9 -]", "", title.lower()).replace(" ", "-")
        cards.append(
            f'<div class="card picture-card" markdown>\n![{alt}](docs/python/{path})\n\n'
            f"### {title}\n{told}\n\n[{example[1]}](docs/python/README.md#{anchor})\n</div>"
        )
    return cards


def example_cards(root: Path) -> list[str]:
    """Markdown of a card for each example of `docs/python/gallery/README.md`, if there is such a page."""
    path = root / "docs/python/gallery/README.md"
    if not path.exists():
        return []
    cards = []
    for section in re.split(r"^### ", path.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
        title, _, body = section.partition("\n")
        told, picture, line = body.strip().split("\n\n")[0], PICTURE.search(body), CODE.search(body)
        if picture is None or line is None:
            raise ValueError(f"{path}: the example “{title}” must have a picture and a line of code")
        links = [f"[{name}](docs/python/gallery/{target})" for name, target in LINK.findall(body)]
        cards.append(
            f'<div class="card picture-card" markdown>\n![{picture[1]}](docs/python/gallery/{picture[2]})\n\n'
            f"### {title}\n{told}\n\n{line[0]}\n\n{' · '.join(links)}\n</div>"
        )
    return cards


def page(root: Path) -> str:
    """Markdown of the page; links are relative to the root of the repository."""
    python = python_cards(root)
    if len(python) < 10:
        raise ValueError(
            f"docs/python/README.md must have ten sections with an example and a picture, got {len(python)}"
        )
    examples = example_cards(root)
    if examples:
        examples = ["## Notebooks", '<div class="cards" markdown>', *examples, "</div>"]
    return "\n\n".join(
        [
            "---\nhide: [navigation, toc]\n---",
            "# Gallery",
            "What goes in, what comes out, and the line that does it. All files come from `adwave sample`, or from an "
            "earlier line of the page behind each picture.",
            "## By one command",
            '<div class="cards" markdown>',
            *command_cards(root),
            "</div>",
            *examples,
            "## Longer examples in Python",
            "Short scripts that make their own data and check what they claim.",
            '<div class="cards" markdown>',
            *python,
            "</div>",
        ]
    )
