"""The studio: an equalizer for a shape in the browser."""

from __future__ import annotations

import sys
import webbrowser
from typing import NamedTuple

from adwave import _native
from adwave._caller import public
from adwave._recipe import Recipe
from adwave._shape import Shape, as_shape


class StudioResult(NamedTuple):
    """A shape as it was edited in the studio.

    Attributes
    ----------
    shape : Shape
        The shape after the edit, computed in double precision, with everything that its file had: new positions, new values of
        edited fields, parts that were turned over, and fields that were added in the page.
    recipe : Recipe
        The edit of the positions, to be repeated or applied to another shape.
    field_recipes : dict of str to Recipe
        The edit of each field that was edited, by its name.

    Examples
    --------
    >>> import adwave as aw
    >>> edited = aw.studio("bunny.obj")  # doctest: +SKIP
    >>> edited.recipe.apply("armadillo.obj").write("out.obj")  # doctest: +SKIP
    """

    shape: Shape
    recipe: Recipe
    field_recipes: dict[str, Recipe]


@public()
def studio(shape: object, *, port: int = 0, open_browser: bool = True) -> StudioResult:
    """Open an equalizer for a shape in the browser, and wait until the edit is done.

    The page has a slider for each band, a brush that paints gains, layers and undo. *Quit studio* in its file menu ends the
    call, and so does Ctrl-C here (in a notebook the stop button); either way the edit is returned.

    Parameters
    ----------
    shape : shape_like
        A mesh, a cloud, a curve or a graph; see `Shape`. A graph without positions is placed in the plane, and its fields are
        edited.
    port : int
        Port of the server; 0 for any free one. For a notebook on another machine forward it:
        ``ssh -L PORT:127.0.0.1:PORT``.
    open_browser : bool
        Open the browser of this machine; otherwise only print the address.

    Returns
    -------
    StudioResult
        The shape after the edit, the recipe of its positions, and those of its fields.

    Raises
    ------
    ValueError
        If the shape is too large for a browser.

    Notes
    -----
    The server listens on this machine only, and answers only requests that have the token of its address.

    Examples
    --------
    >>> import adwave as aw
    >>> edited = aw.studio(aw.sample("creature"))  # doctest: +SKIP
    """
    own = as_shape(shape)

    def ready(address: str, address_for_browser: str) -> None:
        print(address, file=sys.stderr, flush=True)
        if open_browser:
            # It works once: the list of processes shows it to all users of the machine.
            webbrowser.open(address_for_browser)

    edited, recipe, field_recipes = _native.studio(own._data, port, ready)
    by_field = {name: Recipe(text) for name, text in field_recipes}
    return StudioResult(Shape._from_data(edited, own._lost), Recipe(recipe), by_field)
