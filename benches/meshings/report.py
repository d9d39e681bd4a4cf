"""The measured part of docs/MESHINGS.md."""

import page

HEADS = {
    "remeshing": "Two meshings of one surface",
    "cloud": "A mesh and its vertices as a cloud",
    "features": "Features found again on the isotropic remeshing",
    "scipy": "Comparison with SciPy's matrix exponential",
    "cost": "Cost",
    "gaze": "Saliency and eye fixations",
    "pictures": "Pictures",
}


def machine():
    """The machine and the versions of packages, as a sentence."""
    return page.machine("numpy", "scipy", "pymeshlab", "pillow")


def render(results, parts):
    """The measured part of the page: the machine, a section for each part, and notes."""
    total = sum(results["seconds"].values())
    sections = [("Machine", page.paragraph(f"{results['machine']} The whole run took {total / 60:.0f} minutes."))]
    sections += [(HEADS[name], part.text(results[name])) for name, part in parts.items()]
    if results["notes"]:
        sections.append(("What was left out", page.bullets(results["notes"])))
    return page.sections(sections)


def write(results, parts, docs):
    """Writes the measured part of MESHINGS.md in the folder `docs`."""
    page.write(docs / "MESHINGS.md", render(results, parts))
