"""Recipes: edits as small TOML files, the same as those of the command."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._bands import Layer
from adwave._decomposer import Decomposer
from adwave._progress import ProgressLike
from adwave._shape import Path, Shape, as_shape


class Recipe:
    """An edit as text: levels, layers of gains and regions, and what is asked of new positions.

    Parameters
    ----------
    text : str
        TOML as the command writes it with ``--save-recipe``.

    Raises
    ------
    ValueError
        With the line that is wrong.

    Examples
    --------
    >>> import adwave as aw
    >>> recipe = aw.Recipe("levels = 4\\n[[layer]]\\npreset = 'enhance'")
    >>> recipe.levels
    4
    >>> recipe.apply(aw.sample("sphere", vertices=500))
    <adwave.Shape: mesh, 500 vertices, 996 faces>
    """

    __slots__ = ("_content", "_data", "text")

    def __init__(self, text: str) -> None:
        self._data: _native.RecipeData = _native.RecipeData(text)
        self.text: str = self._data.text()
        self._content: dict[str, Any] = self._data.content()

    @property
    def field(self) -> str:
        """The signal that is changed; ``'coords'`` is the coordinates."""
        return self._content["field"]

    @property
    def levels(self) -> int | None:
        """Number of dyadic levels, where they are given so."""
        return self._content.get("levels")

    @property
    def lengths(self) -> list[float | str] | None:
        """Widths σ of the levels, where they are given so."""
        return self._content.get("lengths")

    @property
    def steps(self) -> list[float] | None:
        """Numbers of steps of the levels, where they are given so."""
        return self._content.get("steps")

    def apply(self, shape: object, faces: object = None, *, progress: ProgressLike = None) -> Shape:
        """Do the edit on a shape: the same bits as ``adwave filter --recipe`` gives.

        Returns
        -------
        Shape
            With new positions, or with the field changed.
        """
        from adwave._edits import edited_shape

        own, content = as_shape(shape, faces), self._content
        by_width = "lengths" in content
        operator = content["operator"] or ("surface" if by_width else "walk")
        decomposer = Decomposer(
            own,
            operator=operator,
            density_invariant=content["density_invariant"],
            keep_creases=content["keep_creases"],
            progress=progress,
        )
        chosen = decomposer.steps(**{key: content[key] for key in ("levels", "lengths", "steps") if key in content})

        def edit_of(editor: _native.EditorData) -> NDArray[np.float64]:
            return editor.apply_recipe(self._data)

        return edited_shape(
            decomposer,
            self.field,
            chosen,
            edit_of,
            (content["along"], content["border"], content["volume"]),
            _native.ACCURACY,
            progress,
        )

    def write(self, path: Path) -> None:
        """Write the recipe to a file, as a whole or not at all."""
        self._data.write(os.fspath(path))

    def __repr__(self) -> str:
        return f"<adwave.Recipe: {self._data.n_layers} layers of {self.field}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Recipe, (self.text,)

    @staticmethod
    def of(
        layers: list[Layer],
        *,
        levels: int | None = None,
        lengths: list[float | str] | None = None,
        steps: list[float] | None = None,
        field: str = "coords",
        operator: str | None = None,
        along: str | None = None,
        border: str | None = None,
        volume: str | None = None,
    ) -> Recipe:
        """A recipe from layers, whose regions are texts.

        Raises
        ------
        ValueError
            When a layer has weights for each vertex: put these into a field of the shape and name it as the region,
            ``"field:name=…"``.
        """
        lines: list[str] = []
        for name, value in (("levels", levels), ("lengths", lengths), ("steps", steps)):
            if value is not None:
                lines.append(f"{name} = {_toml(value)}")
        for name, word in (
            ("field", field),
            ("operator", operator),
            ("along", along),
            ("border", border),
            ("volume", volume),
        ):
            if word is not None:
                lines.append(f"{name} = {_toml(word)}")
        for layer in layers:
            lines.append("[[layer]]")
            if isinstance(layer.gains, str):
                lines.append(f"preset = {_toml(layer.gains)}")
            else:
                lines.append(f"gains = {_toml([float(g) for g in layer.gains])}")
            if layer.where is not None:
                if not isinstance(layer.where, str):
                    raise ValueError(
                        "where: a recipe takes no weights for each vertex; put them into a field of the shape and take "
                        "where='field:name=…'"
                    )
                lines.append(f"region = {_toml(layer.where)}")
        return Recipe("\n".join(lines) + "\n")


def _toml(value: Any) -> str:
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    return repr(int(value)) if isinstance(value, (int, np.integer)) else repr(float(value))


def read_recipe(path: Path) -> Recipe:
    """Read a recipe from a file.

    Raises
    ------
    OSError
        The file cannot be opened.
    ValueError
        It is no recipe: with the line.
    """
    with open(path, encoding="utf-8") as file:
        text = file.read()
    try:
        return Recipe(text)
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)}: {error}") from None
