"""A progress bar on stderr, or silence."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


class ProgressBar:
    """One line of progress, or none: the current work, and the amount of all work that is done."""

    def __init__(self, progress: "Progress | None" = None, task: "TaskID | None" = None) -> None:
        self._progress, self._task = progress, task

    def start_part(self, what: str) -> None:
        """Count the previous part as done and name the next one."""
        if self._progress is not None and self._task is not None:
            self._progress.update(self._task, advance=1, description=what)

    def set_progress(self, done: int, total: int) -> None:
        """Set the number of finished parts and of all parts."""
        if self._progress is not None and self._task is not None:
            self._progress.update(self._task, completed=done, total=total)


@contextmanager
def progress_bar(what: str, total: int | None, quiet: bool) -> Iterator[ProgressBar]:
    """Show a bar that vanishes when the block ends; show nothing if quiet or if stderr is no terminal."""
    if quiet or not sys.stderr.isatty():  # rich takes 20 ms to load
        yield ProgressBar()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    errors = Console(stderr=True)
    with Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal) as progress:
        yield ProgressBar(progress, progress.add_task(what, total=total))
