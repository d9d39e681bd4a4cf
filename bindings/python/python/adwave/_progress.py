"""The `progress=` option: a bar, or any function of two numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Union

Report = Callable[[int, int], object]
_SILENT: AbstractContextManager[None] = nullcontext()
ProgressLike = Union[bool, None, Report]


def report_progress(progress: ProgressLike, what: str) -> AbstractContextManager[Report | None]:
    """Context that gives the function to which a call reports, or None.

    ``True`` shows a bar by ``tqdm.auto`` if tqdm is installed, also in notebooks.
    """
    return _SILENT if progress is None or progress is False else _open_report(progress, what)


@contextmanager
def _open_report(progress: bool | Report, what: str) -> Iterator[Report | None]:
    if progress is not True:
        if not callable(progress):
            raise TypeError(f"progress must be a bool or a function of (done, total), got {progress!r}")
        yield progress
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(desc=what, unit="part", leave=False) as bar:

        def report(done: int, total: int) -> None:
            if total != bar.total:
                bar.reset(total)
            bar.update(done - bar.n)

        yield report
