"""Tables on the terminal: the result of a benchmark, and the comparison of variants."""

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby
from textwrap import fill

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from pdr_est import __version__
from pdr_est.evaluate.metric_definitions import ALIGNED_NOTE, DEFINITIONS, marked, unit_of, with_unit
from pdr_est.evaluate.paired_comparison import PairedComparison
from pdr_est.experiment.results.benchmark_result import BenchmarkResult, Summary
from pdr_est.experiment.results.comparison import NOTE, has_aligned
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS
from pdr_est.experiment.suite import ConfusionMatrix
from pdr_est.experiment.variants.axes import AXES

_WIDEST = 1000  # columns; no number is ever shortened, a narrow terminal wraps the lines instead
_NARROWEST = 100  # columns of a comparison; names of variants wrap, numbers do not


def print_benchmark(result: BenchmarkResult, console: Console) -> None:
    """Print the numbers of the JSON document: walks, averages, confusion matrices, and what was skipped and why."""
    comparison = result.comparison
    _print(console, _walks(result))
    groups = {name: result.groups(name) for name in comparison.names}
    if any(groups.values()):
        _print(console, _averages("groups", result, groups))
    title = f"{result.suite.name}, pdr-est {__version__}"
    _print(console, _averages(title, result, {name: {"": result.summary(name)} for name in comparison.names}))
    for name in comparison.names:
        for of, confusion in result.confusions(name).items():
            _print(console, _confusion(f"{of}, {name}", confusion))
    if result.aligned:
        console.print(fill(ALIGNED_NOTE, _NARROWEST), markup=False, highlight=False, soft_wrap=True)
    if result.estimator_on_plan is not None:
        words = (
            f"Metrics on a floor plan (…_plan) are those of {result.estimator_on_plan}, as no estimator is chosen."
        )
        console.print(fill(words, _NARROWEST), markup=False, highlight=False, soft_wrap=True)
    for failure in result.failures:
        console.print(f"skipped {failure.walk}: {failure.reason}", markup=False, highlight=False, soft_wrap=True)


def print_comparison(pairs: Sequence[PairedComparison], console: Console, aligned: Collection[str] = ()) -> None:
    """Print a table for each metric, at most as wide as the terminal, and what the columns mean.

    Parameters
    ----------
    pairs : sequence of PairedComparison
        Comparisons, those of one metric one after the other.
    console : Console
        Terminal.
    aligned : collection of str
        Names of the variants whose estimator only aligns its track with the fixes.
    """
    equal = []
    for metric, of_metric in groupby(pairs, key=lambda pair: pair.metric):
        different = [pair for pair in of_metric if pair.ties < pair.n]
        if different:
            _print(console, _comparison(metric, different, aligned), max(console.width, _NARROWEST))
        else:
            equal.append(metric)
    notes = [f"The same with all variants on every walk: {', '.join(equal)}."] if equal else []
    footnotes = [ALIGNED_NOTE] if has_aligned(pairs, aligned) else []
    for note in [*notes, f"{NOTE} The better one is bold where the interval does not hold 0.", *footnotes]:
        console.print(fill(note, _NARROWEST), markup=False, highlight=False, soft_wrap=True)


def _walks(result: BenchmarkResult) -> Table:
    rows, files = result.rows, result.files
    labels = list(dict.fromkeys(label for row in rows for label in files[row.walk].labels))
    classes = list(dict.fromkeys(label for row in rows for label in row.predicted))
    words = ("walk", "track", result.comparison.axis, "mode", *labels)
    table = _table("walks", words, (*result.suite.metrics, *classes, "seconds"))
    for row in rows:
        table.add_row(
            escape(row.walk),
            escape(row.track),
            row.variant,
            row.mode,
            *(escape(files[row.walk].labels.get(label) or "-") for label in labels),
            *(_number(row.metrics[metric]) for metric in result.suite.metrics),
            *(str(row.predicted.get(label, "-")) for label in classes),
            _number(result.seconds[row.walk, row.variant]),
        )
    return table


def _averages(title: str, result: BenchmarkResult, averages: Mapping[str, Mapping[str, Summary]]) -> Table:
    """Tabulate mean, median, p90 and n of each metric from variant -> group -> summary; group "" is not named.

    A metric that no walk of a group has is left out there.
    """
    groups = list(dict.fromkeys(group for summaries in averages.values() for group in summaries))
    group_heading = [] if groups == [""] else ["group"]
    table = _table(title, (*group_heading, "metric", result.comparison.axis), ("mean", "median", "p90", "n"))
    for group in groups:
        for metric in result.suite.metrics:
            for name, summaries in averages.items():
                if group in summaries and (not group or summaries[group][metric].n):
                    found = summaries[group][metric]
                    numbers = map(_number, (found.mean, found.median, found.p90))
                    table.add_row(
                        *(escape(group) for _ in group_heading),
                        metric,
                        marked(_of_metric(name, metric, result), metric, result.aligned),
                        *numbers,
                        str(found.n),
                    )
    return table


def _of_metric(variant: str, metric: str, result: BenchmarkResult) -> str:
    """Name a variant in the row of a metric: on a floor plan by the estimator that was used, where none is chosen."""
    on_plan = result.estimator_on_plan if metric in PLAN_METRICS else None
    return on_plan if on_plan is not None and result.comparison.axis == AXES[0].name else variant


def _confusion(title: str, confusion: ConfusionMatrix) -> Table:
    """Tabulate the steps by true class and label, and the shares that follow from them."""
    labels = list(dict.fromkeys(label for row in confusion.counts.values() for label in row))
    table = _table(f"steps taken for, {title}", ("true class",), labels)
    for true, row in confusion.counts.items():
        table.add_row(true, *(str(row[label]) for label in labels))
    table.add_section()
    for name, share in confusion.shares.items():
        table.add_row(name, f"{share:.4f}")
    return table


def _comparison(metric: str, pairs: Sequence[PairedComparison], aligned: Collection[str]) -> Table:
    ideal = f", ideal value {DEFINITIONS[metric].ideal:g}" if metric in DEFINITIONS else ""
    unit = unit_of(metric)
    below = f"\n({unit})" if unit else ""
    numbers = (f"{heading}{below}" for heading in ("mean A", "mean B", "B - A", "95 % interval"))
    table = _table(f"{with_unit(metric)}{ideal}", ("A", "B"), ("walks", *numbers, "wins\nA : B", "ties"))
    table.title_justify, table.title_style = "left", "bold"
    table.box, table.padding, table.pad_edge = box.SIMPLE_HEAD, (0, 1, 0, 0), False
    for column in table.columns[:2]:
        column.overflow, column.no_wrap = "fold", False
    for pair in pairs:
        names = (pair.first, pair.second)
        table.add_row(
            *(_name(name, pair, aligned) for name in names),
            str(pair.n),
            f"{pair.mean_first:.3f}",
            f"{pair.mean_second:.3f}",
            f"{pair.difference:+.3f}",
            "" if pair.low is None or pair.high is None else f"{pair.low:+.3f} … {pair.high:+.3f}",
            f"{pair.first_wins} : {pair.second_wins}",
            str(pair.ties or ""),
        )
    return table


def _name(variant: str, pair: PairedComparison, aligned: Collection[str]) -> str:
    """Return the name of one variant of a pair, bold if it is the better one."""
    text = escape(marked(variant, pair.metric, aligned))
    return f"[bold]{text}[/bold]" if pair.better == variant else text


def _table(title: str, words: Sequence[str], numbers: Sequence[str]) -> Table:
    """Make an empty table with columns of words and, right-justified, of numbers."""
    table = Table(title=title)
    for heading in words:
        table.add_column(heading, no_wrap=True)
    for heading in numbers:
        table.add_column(heading, justify="right", no_wrap=True)
    return table


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _print(console: Console, table: Table, width: int = _WIDEST) -> None:
    wide = console.options.update(width=_WIDEST)
    table.width = min(width, Measurement.get(console, wide, table).maximum)
    console.print(table, crop=False)
