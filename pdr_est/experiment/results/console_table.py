"""A benchmark's result as tables on the terminal: the same numbers as in the JSON document."""

from collections.abc import Callable, Sequence

from rich.console import Console
from rich.measure import Measurement
from rich.table import Table

from pdr_est.evaluate.statistics import Average
from pdr_est.experiment.results.score_rows import BenchmarkResult, Summary
from pdr_est.experiment.scoring.confusion import Confusion

_WIDEST = 1000  # columns; no number is ever shortened, a narrow terminal wraps the lines instead


def print_table(result: BenchmarkResult, console: Console) -> None:
    """Walk by walk, then the averages by group, those of the suite, which class of step was taken for which, and what
    was skipped with its reason."""
    _print(console, _walks(result))
    if any(result.groups(name) for name in result.names):
        _print(console, _averages("groups", result, lambda name: result.groups(name)))
    title = f"{result.suite}, pdr-est {result.version}"
    _print(console, _averages(title, result, lambda name: {"": result.summary(name)}))
    for name in result.names:
        for of, confusion in result.confusions(name).items():
            _print(console, _confusion(f"{of}, {name}", confusion))
    for walk in result.skipped:
        console.print(f"skipped {walk.walk}: {walk.reason}", markup=False, highlight=False, soft_wrap=True)


def _walks(result: BenchmarkResult) -> Table:
    labels = list(dict.fromkeys(label for row in result.rows for label in row.labels))
    classes = list(dict.fromkeys(label for row in result.rows for label in row.predicted))
    table = Table(title="walks")
    for heading in ("walk", "track", result.axis, "mode", *labels):
        table.add_column(heading, no_wrap=True)
    for heading in (*result.metrics, *classes, "seconds"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in result.rows:
        table.add_row(
            row.walk,
            row.track,
            row.settings[result.axis],
            row.mode,
            *(row.labels.get(label) or "-" for label in labels),
            *(_number(row.metrics[metric]) for metric in result.metrics),
            *(str(row.predicted.get(label, "-")) for label in classes),
            _number(row.seconds),
        )
    return table


def _averages(title: str, result: BenchmarkResult, of: Callable[[str], dict[str, Summary]]) -> Table:
    """Mean, median, p90 and n of each metric. of: variant -> group -> summary; the group "" is not named."""
    by_variant = {name: of(name) for name in result.names}
    groups = list(dict.fromkeys(group for summaries in by_variant.values() for group in summaries))
    named = groups != [""]
    table = Table(title=title)
    for heading in (*(["group"] if named else []), "metric", result.axis):
        table.add_column(heading, no_wrap=True)
    for heading in ("mean", "median", "p90", "n"):
        table.add_column(heading, justify="right", no_wrap=True)
    for group in groups:
        for metric in result.metrics:
            for name, summaries in by_variant.items():
                if group in summaries:
                    table.add_row(*([group] if named else []), metric, name, *_cells(summaries[group][metric]))
    return table


def _confusion(title: str, confusion: Confusion) -> Table:
    """Steps by true class and label, and below what follows from them."""
    table = Table(title=f"steps taken for, {title}")
    table.add_column("true class", no_wrap=True)
    labels = list(dict.fromkeys(label for row in confusion.counts.values() for label in row))
    for label in labels:
        table.add_column(label, justify="right", no_wrap=True)
    for true, row in confusion.counts.items():
        table.add_row(true, *(str(row[label]) for label in labels))
    table.add_section()
    for name, share in confusion.shares.items():
        table.add_row(name, f"{share:.4f}")
    return table


def _cells(average: Average) -> Sequence[str]:
    return (*(_number(value) for value in (average.mean, average.median, average.p90)), str(average.n))


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _print(console: Console, table: Table) -> None:
    table.width = Measurement.get(console, console.options.update(width=_WIDEST), table).maximum
    console.print(table, crop=False)
