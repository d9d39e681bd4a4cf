"""The page and the sheet of part `pictures`: panels row by row, a block for each shape."""

import base64
import html
import io
from dataclasses import dataclass

from PIL import Image, ImageDraw, ImageFont

# Colors of viridis at equal distances, for the color bar.
STOPS = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")
# Pixels of the sheet: a panel, the title above a row, the caption below a panel, gaps between panels and between blocks.
PANEL, ABOVE, BELOW, GAP, BETWEEN = 380, 40, 28, 12, 50
GROUND, INK, SOFT = "#ffffff", "#1b1b1b", "#595959"


@dataclass
class Panel:
    """A picture with a transparent background, or None, and its caption."""

    picture: Image.Image | None
    words: str


@dataclass
class Row:
    """Panels side by side, below a title."""

    title: str
    panels: list


@dataclass
class Block:
    """A shape: its name, a paragraph on it, its rows, and the value of the last color."""

    name: str
    words: str
    rows: list
    largest: float


STYLE = """
:root{color-scheme:light dark;--ground:#fff;--ink:#1b1b1b;--soft:#595959;--line:#dcdcdc}
@media(prefers-color-scheme:dark){:root{--ground:#141414;--ink:#e8e8e8;--soft:#a6a6a6;--line:#363636}}
*{box-sizing:border-box}
body{max-width:75rem;margin:0 auto;padding:1rem;background:var(--ground);color:var(--ink);font:1rem/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
h1{font-size:1.6rem;line-height:1.2}h2{font-size:1.3rem;border-top:1px solid var(--line);padding-top:1rem;margin-top:2rem}
h3{font-size:1rem;margin:1.2rem 0 .3rem}
p{max-width:46rem}
.row{display:grid;grid-template-columns:repeat(3,minmax(0,1fr));gap:.75rem}
figure{margin:0;min-width:0;display:flex;flex-direction:column;justify-content:flex-end}
img{width:100%;height:auto;display:block}
figcaption{color:var(--soft);font-size:.88rem;line-height:1.35;text-align:center;font-variant-numeric:tabular-nums}
.bar{max-width:22rem;font-size:.85rem;color:var(--soft)}
.bar i{display:block;height:.7rem;border:1px solid var(--line);border-radius:.2rem;print-color-adjust:exact}
.bar span{display:flex;justify-content:space-between}
@media(max-width:34rem){body{padding:.6rem}.row{gap:.3rem}figcaption{font-size:.75rem}}
"""


def webp(picture):
    """The picture as WebP in base64."""
    out = io.BytesIO()
    picture.save(out, "WEBP", quality=88, method=4)
    return base64.b64encode(out.getvalue()).decode()


def figure_html(panel, title):
    """The HTML figure of a panel."""
    picture = "" if panel.picture is None else (
        f'<img src="data:image/webp;base64,{webp(panel.picture)}" alt="{html.escape(f"{title}: {panel.words}")}">')
    return f"<figure>{picture}<figcaption>{html.escape(panel.words)}</figcaption></figure>"


def bar(largest):
    """The HTML of the color bar."""
    return (f'<div class="bar"><i style="background:linear-gradient(to right,{",".join(STOPS)})"></i>'
            f"<span><b>0</b><em>|W|/σ</em><b>{largest:.2g} and more</b></span></div>")


def page(title, introduction, blocks):
    """The HTML page with all blocks."""
    body = [f"<h1>{html.escape(title)}</h1>", *(f"<p>{html.escape(words)}</p>" for words in introduction)]
    for block in blocks:
        body.append(f"<section>\n<h2>{html.escape(block.name)}</h2>\n<p>{html.escape(block.words)}</p>\n{bar(block.largest)}")
        for row in block.rows:
            body.append(f'<h3>{html.escape(row.title)}</h3>\n<div class="row">')
            body += [figure_html(panel, row.title) for panel in row.panels]
            body.append("</div>")
        body.append("</section>")
    return ('<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="color-scheme" content="light dark">\n'
            f"<title>{html.escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n" + "\n".join(body) + "\n</body>\n</html>\n")


def sheet(blocks):
    """All panels on one picture, the blocks next to each other."""
    columns = max(len(row.panels) for block in blocks for row in block.rows)
    rows = max(len(block.rows) for block in blocks)
    width, height = columns * (PANEL + GAP) - GAP, PANEL + ABOVE + BELOW
    image = Image.new("RGB", (len(blocks) * (width + BETWEEN) - BETWEEN, rows * height), GROUND)
    draw = ImageDraw.Draw(image)
    large, small = ImageFont.load_default(22), ImageFont.load_default(17)
    for k, block in enumerate(blocks):
        left = k * (width + BETWEEN)
        for j, row in enumerate(block.rows):
            top = j * height
            draw.text((left + width / 2, top + ABOVE / 2), row.title, INK, large, "mm")
            for i, panel in enumerate(row.panels):
                at = (left + i * (PANEL + GAP), top + ABOVE)
                if panel.picture is not None:
                    picture = panel.picture.resize((PANEL, PANEL), Image.Resampling.LANCZOS)
                    image.paste(picture, at, picture)
                draw.text((at[0] + PANEL / 2, at[1] + PANEL + BELOW / 2), panel.words, SOFT, small, "mm")
    return image
