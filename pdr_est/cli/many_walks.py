"""Many walks in one call: in this process or several, each with its own success or failure, and a table of all."""

import csv
import io
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click

from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.walk_list import NamedPath
from pdr_est.errors import OutputError, PdrError, RecordingError
from pdr_est.output.atomic_output import staged_file
from pdr_est.output.call_inputs import refuse_inputs_in_file
from pdr_est.output.csv_cells import harmless_cell

SUMMARY = "walks.csv"
"""Name of the table of all walks in a folder of results."""

_FIRST = b"walk,"  # bytes of such a table
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Done:
    """Result of the work on one walk.

    Attributes
    ----------
    row
        What the table says of the walk, by column.
    warnings
        What is told on stderr.
    text
        What is printed.
    document
        What is printed as JSON.
    """

    row: Row = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    text: str = ""
    document: Any = None


@dataclass(frozen=True)
class Outcome:
    """A walk with its result, or the reason why there is none.

    Attributes
    ----------
    walk
        The walk.
    done
        Its result; None if it failed.
    reason
        Reason of the failure; empty without one.
    """

    walk: NamedPath
    done: Done | None
    reason: str = ""


def work_on(work: Callable[[NamedPath], Done], walks: Sequence[NamedPath], jobs: int) -> Iterator[Outcome]:
    """Do the work on each walk, and give the outcomes in the order of the walks.

    Parameters
    ----------
    work
        Function that can be sent to other processes. A `PdrError` that it raises is the reason of a failure.
    walks
        The walks.
    jobs
        Number of processes; with 1 all is done in this one.
    """
    if jobs == 1 or len(walks) == 1:
        for walk in walks:
            yield _attempt(work, walk)
        return
    from concurrent.futures.process import BrokenProcessPool

    left = list(walks)
    try:
        for outcome in _in_pool(work, walks, min(jobs, len(walks))):
            left.remove(outcome.walk)
            yield outcome
    except BrokenProcessPool:  # which of the walks is to blame is found by doing each of the others alone
        for walk in left:
            yield _in_own_process(work, walk)


def _in_pool(work: Callable[[NamedPath], Done], walks: Sequence[NamedPath], jobs: int) -> Iterator[Outcome]:
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    # Spawned and not forked: the same on every platform, and safe with the threads of numpy and GTSAM.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_start_worker)
    try:
        for future in [pool.submit(_attempt, work, walk) for walk in walks]:
            yield future.result()
    finally:
        pool.shutdown(cancel_futures=True)


def _in_own_process(work: Callable[[NamedPath], Done], walk: NamedPath) -> Outcome:
    from concurrent.futures.process import BrokenProcessPool

    try:
        return next(_in_pool(work, [walk], 1))
    except BrokenProcessPool:
        return Outcome(walk, None, "the process that worked on it died, for lack of memory perhaps: run it alone")


def finish_many(outcomes: Sequence[Outcome], summary: Path | None, quiet: bool) -> None:
    """Tell warnings and failures, write the table of all walks, and print it for several.

    Parameters
    ----------
    outcomes
        The walks.
    summary
        File of the table; None for none.
    quiet
        True to print no table.

    Raises
    ------
    RecordingError
        If any walk failed: the reason itself for a single walk.
    """
    if len(outcomes) == 1 and outcomes[0].done is None:
        raise RecordingError(outcomes[0].reason)
    for outcome in outcomes:
        tell(outcome)
    if summary is not None:
        write_summary(outcomes, summary)
    if len(outcomes) > 1 and not quiet:
        click.echo()
        print_summary(outcomes)
    report_failures(outcomes)


def report_failures(outcomes: Sequence[Outcome]) -> None:
    """Raise RecordingError if any walk failed; each reason was told before."""
    failed = [outcome for outcome in outcomes if outcome.done is None]
    if failed:
        names = ", ".join(outcome.walk.name for outcome in failed[:3]) + (", …" if len(failed) > 3 else "")
        raise RecordingError(f"{len(failed)} of {len(outcomes)} walks failed ({names}): the reasons are told above")


def tell(outcome: Outcome) -> None:
    """Say on stderr what is doubtful about a walk, or why it failed."""
    path = outcome.walk.path
    if outcome.done is None:
        words = outcome.reason if outcome.reason.startswith(str(path)) else f"{path}: {outcome.reason}"
        click.echo(f"failed: {words}", err=True)
        return
    for warning in outcome.done.warnings:
        click.echo(f"warning: {path}: {warning}", err=True)


def write_summary(outcomes: Sequence[Outcome], path: Path) -> None:
    """Write a row for each walk: its name, what was found, and the reason if it failed.

    Raises
    ------
    OutputError
        If the file cannot be written, is an input, or exists and is no such table.
    """
    refuse_other_file(path)
    rows = _rows(outcomes)
    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(rows[0])
    table.writerows([[harmless_cell(cell) for cell in row.values()] for row in rows])
    with staged_file(path, overwrite=True, inputs=input_paths("profile")) as file:
        file.write_text(text.getvalue(), encoding="utf-8", errors="backslashreplace")


def refuse_other_file(path: Path) -> None:
    """Raise OutputError for a file that is an input, or exists and is no table of walks, which may be replaced."""
    refuse_inputs_in_file(path, path.expanduser().resolve(), input_paths("profile"))
    if not path.is_file():
        return
    with path.open("rb") as stream:
        is_table = stream.read(len(_FIRST)) == _FIRST
    if not is_table:
        raise OutputError(f"{path}: exists and is no table of walks of an earlier run: name another file")


def print_summary(outcomes: Sequence[Outcome]) -> None:
    """Print the rows of all walks as a table."""
    rows = [{key: _brief(cell) for key, cell in row.items()} for row in _rows(outcomes)]
    widths = {key: max(len(key), *(len(row[key]) for row in rows)) for key in rows[0]}
    for row in ({key: key for key in widths}, *rows):
        click.echo("  ".join(cell.ljust(widths[key]) for key, cell in row.items()).rstrip())


def _rows(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Make rows with the same columns for all walks; `failed` says why a walk has no numbers."""
    columns = list(dict.fromkeys(key for one in outcomes if one.done is not None for key in one.done.row))
    rows = []
    for outcome in outcomes:
        found = {} if outcome.done is None else outcome.done.row
        rows.append({"walk": outcome.walk.name, **{key: found.get(key) for key in columns}, "failed": outcome.reason})
    return rows


def _brief(cell: Any) -> str:
    text = "" if cell is None else f"{cell:.2f}" if isinstance(cell, float) else str(cell)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _attempt(work: Callable[[NamedPath], Done], walk: NamedPath) -> Outcome:
    try:
        return Outcome(walk, work(walk))
    except PdrError as error:
        return Outcome(walk, None, str(error))


def _start_worker() -> None:
    """Leave Ctrl-C to the first process, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
