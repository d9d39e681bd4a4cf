"""The studio: an equalizer for a shape in the browser, and back."""

from __future__ import annotations

import os
import sys
import tempfile
import webbrowser
from typing import NamedTuple

from adwave import _native
from adwave._recipe import Recipe
from adwave._shape import Shape, as_shape


class Edited(NamedTuple):
    """What was made of a shape in the studio."""

    shape: Shape
    """The shape after the edit, computed in double precision, with all that its file had."""
    recipe: Recipe
    """The edit, to be done again or on another shape."""


def studio(shape: object, faces: object = None, *, port: int = 0, open_browser: bool = True) -> Edited:
    """Open an equalizer for a shape in the browser, and wait until it is done there.

    A slider for each band, a brush that paints gains, layers, undo. *Quit studio* in the page's file menu, or Ctrl-C here (in a notebook its stop button), ends
    it, and gives the edit either way.

    Parameters
    ----------
    shape, faces
        Anything that is a mesh or a cloud; see `Shape`.
    port : int
        The port; any that is free where it is 0. Of a notebook on another machine forward this one: ``ssh -L PORT:127.0.0.1:PORT``.
    open_browser : bool
        Open the browser of this machine; else only print the address.

    Returns
    -------
    Edited
        The shape after the edit, and the recipe.

    Raises
    ------
    ValueError
        The shape has no positions, or is too large for a browser.

    Notes
    -----
    The server listens on this machine alone, and answers only to who has the address.
    """
    own = as_shape(shape, faces)
    with tempfile.TemporaryDirectory(prefix="adwave-studio-") as folder:

        def ready(address: str) -> None:
            print(address, file=sys.stderr, flush=True)
            if open_browser:
                # By a file that leads there: the list of programs that run has no token then.
                page = os.path.join(folder, "studio.html")
                with open(os.open(page, os.O_WRONLY | os.O_CREAT, 0o600), "w", encoding="utf-8") as file:
                    file.write(f'<!doctype html><meta http-equiv="refresh" content="0;url={address}">')
                webbrowser.open("file://" + page)

        recipe, points = _native.studio(own._data, port, ready)
    return Edited(own.with_points(points), Recipe(recipe))
