"""The `progress=` option: a bar, or any function of two numbers."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Union

Report = Callable[[int, int], object]
_SILENT: AbstractContextManager[None] = nullcontext()
ProgressLike = Union[bool, None, Report]
#: Percent between two lines where a line cannot be written over.
_LINE_STEP = 20


def report_progress(progress: ProgressLike, what: str) -> AbstractContextManager[Report | None]:
    """Context that gives the function to which a call reports, or None.

    ``True`` shows a bar by ``tqdm.auto`` if tqdm is installed, also in notebooks, and percents on the standard error
    otherwise. Whatever the call reports, a call that succeeds ends at 100 %.
    """
    return _SILENT if progress is None or progress is False else _open_report(progress, what)


@contextmanager
def _open_report(progress: bool | Report, what: str) -> Iterator[Report | None]:
    if progress is not True:
        if not callable(progress):
            raise TypeError(f"progress must be a bool or a function of (done, total), got {progress!r}")
        with _finished(progress) as report:
            yield report
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        with _finished(_percents(what)) as report:
            yield report
        return
    with tqdm(desc=what, unit="part", leave=False) as bar:

        def show(done: int, total: int) -> None:
            if total != bar.total:
                bar.reset(total)
            bar.update(done - bar.n)

        with _finished(show) as report:
            yield report


@contextmanager
def _finished(report: Report) -> Iterator[Report]:
    """A report that is told at the end that all is done."""
    last = (0, 1)

    def note(done: int, total: int) -> object:
        nonlocal last
        last = (done, total)
        return report(done, total)

    yield note
    if last[0] != last[1]:
        report(last[1], last[1])


def _percents(what: str) -> Report:
    """Percents on the standard error: one line that is written over in a terminal, some lines elsewhere."""
    stream = sys.stderr
    is_terminal = stream is not None and stream.isatty()
    shown = -1

    def show(done: int, total: int) -> None:
        nonlocal shown
        percent = 100 * done // max(total, 1)
        if stream is None or percent == shown or (not is_terminal and percent < shown + _LINE_STEP and percent < 100):
            return
        shown = percent
        end = "\n" if percent == 100 or not is_terminal else ""
        print(f"{chr(13) if is_terminal else ''}{what} {percent:3d} %", end=end, file=stream, flush=True)

    return show
