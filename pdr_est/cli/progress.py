"""A progress bar on stderr, or silence."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

ERRORS = Console(stderr=True)


class ProgressBar:
    """One line of progress: the current work, and the amount of all work that is done."""

    def __init__(self, progress: Progress, task: TaskID) -> None:
        self._progress, self._task = progress, task

    def start_part(self, what: str) -> None:
        """Count the previous part as done and name the next one."""
        self._progress.update(self._task, advance=1, description=what)

    def set_progress(self, done: int, total: int) -> None:
        """Set the number of finished parts and of all parts."""
        self._progress.update(self._task, completed=done, total=total)


@contextmanager
def progress_bar(what: str, total: int | None, quiet: bool) -> Iterator[ProgressBar]:
    """Show a bar that vanishes when the block ends; show nothing if quiet or if stderr is no terminal."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    hidden = quiet or not ERRORS.is_terminal
    with Progress(*columns, console=ERRORS, transient=True, disable=hidden) as progress:
        yield ProgressBar(progress, progress.add_task(what, total=total))
