"""Recipes: edits as small TOML files, the same as those of the command."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._decomposer import Decomposer, Layer, prepare_decomposer
from adwave._edits import EditSettings, edit_shape
from adwave._options import BandsRequest, Constraints, LevelsLike, Octaves, Operator, Steps, Widths, check_levels
from adwave._part import Part, read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Path, Shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._part import PartOptions


class Recipe:
    """An edit as text: levels, layers of gains and regions, constraints on the new positions, clones of detail, a pose, and
    parts whose faces are turned over.

    Parameters
    ----------
    text : str
        TOML as the command writes it with ``--save-recipe``.

    Raises
    ------
    ValueError
        If the text is not a recipe; the message names the line.

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
    def signal(self) -> str:
        """Name of the signal that is changed; ``'coords'`` is the coordinates."""
        return self._content["field"]

    @property
    def levels(self) -> LevelsLike:
        """Levels of the recipe: a number of dyadic levels, `Widths`, `Steps`, or None for the default."""
        content = self._content
        if "lengths" in content:
            return Widths(rms=content["lengths"])
        return Steps(content["steps"]) if "steps" in content else content.get("levels")

    def apply(self, shape: object, *, progress: ProgressLike = None, **options: Unpack[PartOptions]) -> Any:
        """Edit a shape; the result has the same bits as that of ``adwave filter --recipe``.

        Parameters
        ----------
        shape : shape_like
            Anything that is a shape; see `Shape`.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        **options
            ``faces=``, and ``mask=`` or ``only=``, the vertices that take part.

        Returns
        -------
        object like the shape
            With new positions, or with the field changed: a `Shape` for a `Shape` or a path, a trimesh for a trimesh. A
            `Shape` if the recipe turns faces over.

        Raises
        ------
        ValueError
            If the recipe does not fit the shape, or has clones, a pose or turned parts, which name vertices of the whole
            shape, and ``mask=`` or ``only=`` is given.
        """
        content, levels = self._content, self.levels
        by_width = isinstance(levels, Widths)
        operator = Operator(
            content["operator"] or ("surface" if by_width else "walk"),
            density_invariant=content["density_invariant"],
            keep_creases=content["keep_creases"],
        )
        part = read_part("Recipe.apply", shape, options, ("progress",))
        self._check_whole(part)
        decomposer = prepare_decomposer(part.shape, operator)
        constraints = Constraints(along=content["along"], border=content["border"], volume=content["volume"])

        def edit(owner: Decomposer, request: BandsRequest, report: Any) -> NDArray[np.float64]:
            return _native.EditorData(owner._data, request, report).apply_recipe(self._data)

        fit = content["local_fit"] or "linear"
        settings = EditSettings(self.signal, decomposer.schedule(levels), constraints, fit)
        edited = edit_shape(decomposer, settings, edit, progress)
        if self._data.reshapes:
            # The base is that of the walk, whatever smooths the bands.
            walk = prepare_decomposer(part.shape, "walk")
            with report_progress(progress, "bending") as report:
                moved = self._data.reshape(walk._data, np.ascontiguousarray(edited.points), report)
            edited = part.shape._with_positions(moved)
        if self._data.turns_faces:
            turned = Shape._from_data(self._data.turn_faces(decomposer._data), part.shape._lost)
            return turned._with_positions(edited.points)
        return part.with_named_signal(edited, self.signal)

    def _check_whole(self, part: Part) -> None:
        kinds = {"[[clone]] and [pose]": self._data.reshapes, "'turned'": self._data.turns_faces}
        for what in (kind for kind, is_given in kinds.items() if is_given):
            if self.signal != "coords":
                raise ValueError(
                    f"recipe: {what} change a shape, and the signal is {self.signal!r}; remove them from the recipe"
                )
            if part.selection is not None:
                raise ValueError(f"recipe: {what} name vertices of the whole shape; leave mask= and only= out")

    def write(self, path: Path) -> None:
        """Write the recipe to a file, completely or not at all.

        Parameters
        ----------
        path : path_like
            The file, usually ``.toml``.
        """
        self._data.write(os.fspath(path))

    def __repr__(self) -> str:
        return f"<adwave.Recipe: {self._data.n_layers} layers of {self.signal}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Recipe, (self.text,)

    @staticmethod
    def from_layers(
        layers: Sequence[Layer],
        *,
        levels: LevelsLike = None,
        signal: str = "coords",
        operator: str | None = None,
        constraints: Constraints | None = None,
    ) -> Recipe:
        """A recipe from layers whose regions are texts.

        Parameters
        ----------
        layers : sequence of Layer
            The edits.
        levels : int, Widths or Steps, optional
            As in `filter`.
        signal : str
            Name of the signal that is changed.
        operator : str, optional
            As in `filter`.
        constraints : Constraints, optional
            As in `filter`.

        Raises
        ------
        ValueError
            If a layer has weights for each vertex: put these into a field of the shape, and name it in the region,
            ``"field:name=…"``.

        Examples
        --------
        >>> import adwave as aw
        >>> recipe = aw.Recipe.from_layers([aw.Layer("enhance")], levels=4)
        >>> print(recipe.text)
        field = "coords"
        levels = 4
        <BLANKLINE>
        [[layer]]
        preset = "enhance"
        <BLANKLINE>
        """
        lines = _levels_toml(check_levels(levels))
        words = {"field": signal, "operator": operator}
        if constraints is not None:
            words |= {"along": constraints.along, "border": constraints.border, "volume": constraints.volume}
        lines += [f"{name} = {_toml(word)}" for name, word in words.items() if word is not None]
        for layer in layers:
            lines += _layer_toml(layer)
        return Recipe("\n".join(lines) + "\n")


def _levels_toml(levels: LevelsLike) -> list[str]:
    if isinstance(levels, Octaves):
        raise ValueError("levels: a recipe has a number of levels, aw.Widths or aw.Steps; give aw.Steps")
    if isinstance(levels, Widths):
        if levels.rms is None:
            raise ValueError("levels: a recipe has widths by their root mean square; give aw.Widths(rms=...)")
        return [f"lengths = {_toml(levels.rms)}"]
    if isinstance(levels, Steps):
        return [f"steps = {_toml(levels.steps)}"]
    return [] if levels is None else [f"levels = {levels}"]


def _layer_toml(layer: Layer) -> list[str]:
    lines = ["[[layer]]"]
    if isinstance(layer.gains, str):
        lines.append(f"preset = {_toml(layer.gains)}")
    else:
        lines.append(f"gains = {_toml([float(g) for g in layer.gains])}")
    if layer.where is not None:
        if not isinstance(layer.where, str):
            raise ValueError(
                "where: a recipe takes no weights for each vertex; put them into a field of the shape and use "
                "where='field:name=…'"
            )
        lines.append(f"region = {_toml(layer.where)}")
    return lines


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

    Parameters
    ----------
    path : path_like
        A file as the command writes it with ``--save-recipe``.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ValueError
        If it is not a recipe; the message names the line.

    Examples
    --------
    >>> import adwave as aw, os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "edit.toml")
    ...     aw.Recipe.from_layers([aw.Layer("smooth")], levels=4).write(path)
    ...     aw.read_recipe(path)
    <adwave.Recipe: 1 layers of coords>
    """
    with open(path, encoding="utf-8") as file:
        text = file.read()
    try:
        return Recipe(text)
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)}: {error}") from None
