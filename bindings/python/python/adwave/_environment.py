"""Number of threads, and versions of what is installed."""

from __future__ import annotations

import sys
from types import TracebackType

from adwave import _native


class threads:
    """Set the number of threads of all calls, from now on or within a ``with`` block.

    By default calls use ``ADWAVE_NUM_THREADS`` threads if that variable is set, else as many as the process may use: its
    affinity and the quota of its container are respected. Results have the same bits for any number.

    Parameters
    ----------
    n : int, optional
        Number of threads; 0 for as many as there are.

    Raises
    ------
    ValueError
        If the number is negative.

    Examples
    --------
    >>> import adwave as aw
    >>> with aw.threads(1):
    ...     bands = aw.decompose(aw.sample("sphere"), levels=3)
    >>> aw.threads(0).n >= 1
    True
    """

    def __init__(self, n: int = 0) -> None:
        n = int(n)
        if n < 0:
            raise ValueError(f"threads must be at least 1, or 0 for as many as there are, got {n}")
        self._previous: int = _native.requested_threads()
        _native.set_threads(n)
        self.n: int = _native.threads()

    def __enter__(self) -> threads:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _native.set_threads(self._previous)

    def __repr__(self) -> str:
        return f"adwave.threads({self.n})"


def show_versions() -> None:
    """Print the versions of adwave and of the packages that it works with, for a bug report.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.show_versions()
    adwave ...
    python ...
    """
    import importlib.metadata
    import platform

    print(f"adwave       {_native.__version__}, {_native.threads()} threads")
    print(f"python       {sys.version.split()[0]}, {platform.platform()}")
    for name in ("numpy", "scipy", "trimesh", "pyvista", "meshio", "open3d", "networkx", "scikit-learn", "torch"):
        try:
            print(f"{name:<12} {importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            print(f"{name:<12} –")
