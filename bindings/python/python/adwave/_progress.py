"""The `progress=` option: a bar, or any function of two numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Union

Report = Callable[[int, int], object]
_SILENT: AbstractContextManager[None] = nullcontext()
ProgressLike = Union[bool, None, Report]


def reporting(progress: ProgressLike, what: str) -> AbstractContextManager[Report | None]:
    """Give the function that a call reports to.

    ``True`` shows a bar by ``tqdm.auto`` where tqdm is installed, which notebooks show too, else nothing.
    """
    return _SILENT if progress is None or progress is False else _reporting(progress, what)


@contextmanager
def _reporting(progress: bool | Report, what: str) -> Iterator[Report | None]:
    if progress is not True:
        if not callable(progress):
            raise TypeError(f"progress: {progress!r} is no bool and no function of (done, total)")
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
