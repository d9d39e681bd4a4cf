"""The tables of docs/MESHINGS.md, between its markers."""

import page

HEADS = {
    "remeshing": "Two meshings of one surface",
    "cloud": "A mesh and its vertices as a cloud",
    "features": "Features found again on the isotropic remeshing",
    "scipy": "Beside SciPy's exponential",
    "cost": "What it costs",
    "gaze": "Saliency and where people look",
    "pictures": "Pictures",
}


def machine():
    return page.machine("numpy", "scipy", "pymeshlab", "pillow")


def measured(results, parts):
    whole = sum(results["seconds"].values())
    parts_of_page = [("Machine", f"{results['machine']} The whole run took {whole / 60:.0f} minutes.")]
    parts_of_page += [(HEADS[name], part.text(results[name])) for name, part in parts.items()]
    if results["notes"]:
        parts_of_page.append(("What was left out", "\n".join(f"* {note}" for note in results["notes"])))
    return page.sections(parts_of_page)


def write(results, parts, docs):
    page.write(docs / "MESHINGS.md", measured(results, parts))
