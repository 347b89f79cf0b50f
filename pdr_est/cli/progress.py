"""A progress bar on stderr, or silence."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

ERRORS = Console(stderr=True)


class Bar:
    """One line of progress: what is being done, and how much of all is done."""

    def __init__(self, progress: Progress, task: TaskID) -> None:
        self._progress, self._task = progress, task

    def doing(self, what: str) -> None:
        """The previous part is done; say what comes next."""
        self._progress.update(self._task, advance=1, description=what)

    def at(self, done: int, total: int) -> None:
        """So many of all are done."""
        self._progress.update(self._task, completed=done, total=total)


@contextmanager
def progress_bar(what: str, total: int | None, quiet: bool) -> Iterator[Bar]:
    """A bar that vanishes when the block ends; nothing is shown if quiet or if stderr is no terminal."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    hidden = quiet or not ERRORS.is_terminal
    with Progress(*columns, console=ERRORS, transient=True, disable=hidden) as progress:
        yield Bar(progress, progress.add_task(what, total=total))
