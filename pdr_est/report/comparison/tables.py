"""Tables of the comparison: averages, pairs, groups, steps and carrying modes."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from pdr_est.evaluate.metric_definitions import ALIGNED_NOTE, DEFINITIONS, marked, pooled_average, with_unit
from pdr_est.evaluate.paired_comparison import ROUNDING, PairedComparison
from pdr_est.evaluate.statistics import Average
from pdr_est.report.page_templates import NO_VALUE, format_number, format_percent
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.steps import CarryingMode

_MOST_COLUMNS = 5  # of variants side by side, which a page has room for


@dataclass(frozen=True)
class TableCell:
    """Cell of a table.

    Attributes
    ----------
    text : str
        Content.
    definition : str or None
        Metric whose definition the cell is linked to.
    strong : bool
        Emphasise the cell.
    """

    text: str
    definition: str | None = None
    strong: bool = False


@dataclass(frozen=True)
class ReportTable:
    """Table of the page.

    Attributes
    ----------
    title : str
        Title.
    headings : tuple of TableCell
        Head of the columns.
    rows : tuple of tuple of TableCell
        Rows.
    texts : int
        Number of columns from the left that hold words; the others hold numbers and are aligned to the right.
    note : str
        Remark below the table.
    """

    title: str
    headings: tuple[TableCell, ...]
    rows: tuple[tuple[TableCell, ...], ...]
    texts: int = 1
    note: str = ""


def averages_table(
    outcomes: Sequence[TrackOutcome], variants: Sequence[str], metrics: Sequence[str], aligned: Collection[str] = ()
) -> ReportTable:
    """Tabulate mean, median, 90th percentile and number of tracks of each metric; the best mean is emphasised.

    Variants in `aligned`, whose estimator only aligns its track with the fixes, are marked where that matters.
    """
    rows, of_variant = [], _by_variant(outcomes, variants)
    for metric in metrics:
        found = [(name, _average(of_variant[name], metric)) for name in variants]
        best = _best(metric, [average.mean for _, average in found])
        rows += [
            (
                metric_cell(metric),
                TableCell(marked(name, metric, aligned)),
                TableCell(format_metric(average.mean), strong=place == best),
                TableCell(format_metric(average.median)),
                TableCell(format_metric(average.p90)),
                TableCell(str(average.n)),
            )
            for place, (name, average) in enumerate(found)
        ]
    headings = tuple(TableCell(text) for text in ("metric", "variant", "mean", "median", "90 %", "tracks"))
    footnote = f" {ALIGNED_NOTE}" if any(row[1].text.endswith(" *") for row in rows) else ""
    note = f"The mean nearest to the ideal value is bold.{footnote}"
    return ReportTable("All walks", headings, tuple(rows), texts=2, note=note)


def groups_table(
    outcomes: Sequence[TrackOutcome], variants: Sequence[str], metrics: Sequence[str], key: str
) -> ReportTable:
    """Tabulate the mean of each metric for each value of a key.

    There is one column for each variant; for many variants one row for each, and one column for each value.
    """
    names = sorted({key_of(outcome, key) for outcome in outcomes})
    within = {name: [outcome for outcome in outcomes if key_of(outcome, key) == name] for name in names}
    tracks = {name: len({(one.walk, one.track) for one in rows_of}) for name, rows_of in within.items()}
    cells_of = {name: _by_variant(rows_of, variants) for name, rows_of in within.items()}
    if len(variants) > max(_MOST_COLUMNS, len(names)):
        return _groups_aside(cells_of, tracks, variants, metrics, key)
    rows = []
    for metric in metrics:
        for name in names:
            means = [_average(cells_of[name][variant], metric).mean for variant in variants]
            best = _best(metric, means)
            cells = [TableCell(format_metric(mean), strong=place == best) for place, mean in enumerate(means)]
            rows.append((metric_cell(metric), TableCell(name), TableCell(str(tracks[name])), *cells))
    headings = (
        TableCell("metric"),
        TableCell(key),
        TableCell("tracks"),
        *(TableCell(variant) for variant in variants),
    )
    return ReportTable(f"Means by {key}", headings, tuple(rows), texts=2)


def _groups_aside(
    within: Mapping[str, Mapping[str, Sequence[TrackOutcome]]],
    tracks: Mapping[str, int],
    variants: Sequence[str],
    metrics: Sequence[str],
    key: str,
) -> ReportTable:
    """Tabulate the same with one column for each value of the key."""
    rows = []
    for metric in metrics:
        means = [[_average(of_variant[name], metric).mean for name in variants] for of_variant in within.values()]
        best = [_best(metric, column) for column in means]
        for place, variant in enumerate(variants):
            cells = [
                TableCell(format_metric(column[place]), strong=place == first)
                for column, first in zip(means, best, strict=True)
            ]
            rows.append((metric_cell(metric), TableCell(variant), *cells))
    headings = (TableCell("metric"), TableCell("variant"), *(TableCell(name) for name in within))
    numbers = ", ".join(f"{name} {number}" for name, number in tracks.items())
    return ReportTable(f"Means by {key}", headings, tuple(rows), texts=2, note=f"Number of tracks: {numbers}.")


def pairs_table(found: Iterable[PairedComparison], note: str = "", aligned: Collection[str] = ()) -> ReportTable:
    """Tabulate the comparisons of two variants each.

    `note` is added to the remark below the table. Variants in `aligned` are marked as in `averages_table`.
    """
    rows = tuple(
        (
            metric_cell(pair.metric),
            TableCell(marked(pair.first, pair.metric, aligned), strong=pair.better == pair.first),
            TableCell(marked(pair.second, pair.metric, aligned), strong=pair.better == pair.second),
            TableCell(str(pair.n)),
            TableCell(format_difference(pair.difference)),
            TableCell(
                NO_VALUE
                if pair.low is None or pair.high is None
                else f"{format_difference(pair.low)} … {format_difference(pair.high)}"
            ),
            TableCell(f"{pair.first_wins} : {pair.second_wins}" + (f" ({pair.ties} ties)" if pair.ties else "")),
        )
        for pair in found
        if pair.ties < pair.n
    )
    words = ("metric", "A", "B", "walks", "B − A", "95 % interval", "wins A : B")
    about = (
        "B − A is the mean over the walks of the distance of B from the ideal value less that of A; if negative, B "
        "is better. The interval is a bootstrap over walks, too narrow for fewer than about 20. The better variant "
        f"is bold where the interval excludes zero. Pairs that agree on every walk are left out. {note}"
    )
    if any(cell.text.endswith(" *") for row in rows for cell in row[1:3]):
        about = f"{about.rstrip()} {ALIGNED_NOTE}"
    return ReportTable("Walk by walk", tuple(TableCell(word) for word in words), rows, texts=3, note=about.rstrip())


def steps_table(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> ReportTable:
    """Tabulate detected and true steps of each variant by the mode that was recognised for most of the walk."""
    rows = []
    detected = [(one, one.steps) for one in outcomes if one.steps is not None]
    for mode in sorted({outcome.mode for outcome, _ in detected}):
        for name in variants:
            chosen = [(one, steps) for one, steps in detected if one.mode == mode and one.variant == name]
            if not chosen:
                continue
            counted = [(steps, one.true_steps) for one, steps in chosen if one.true_steps]
            true = sum(true_steps for _, true_steps in counted)
            off = [abs(steps - true_steps) / true_steps for steps, true_steps in counted]
            rows.append(
                (
                    TableCell(mode),
                    TableCell(name),
                    TableCell(str(len(chosen))),
                    TableCell(format_number(sum(steps for _, steps in chosen), 0)),
                    TableCell(format_number(true, 0) if counted else NO_VALUE),
                    TableCell(format_percent(sum(off) / len(off)) if off else NO_VALUE),
                )
            )
    words = ("mode recognised", "variant", "tracks", "steps detected", "steps taken", "mean count error")
    note = "Counts are over whole recordings; the metric count_error is over the annotated time only."
    return ReportTable(
        "Steps", tuple(TableCell(word) for word in words), _merged(rows, 1, len(variants)), texts=2, note=note
    )


def modes_table(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> ReportTable:
    """Tabulate the fraction of the walking time in each carrying mode, mean over the tracks."""
    names = [mode.name for mode in CarryingMode if any(mode.name in one.mode_shares for one in outcomes)]
    rows = []
    for variant in variants:
        chosen = [one for one in outcomes if one.variant == variant and one.mode_shares]
        shares = [sum(one.mode_shares.get(name, 0.0) for one in chosen) / max(len(chosen), 1) for name in names]
        rows.append((TableCell(variant), *(TableCell(format_percent(share)) for share in shares)))
    headings = (TableCell("variant"), *(TableCell(name) for name in names))
    note = "Share of the walking time, mean over the tracks."
    return ReportTable("Carrying modes", headings, _merged(rows, 0, len(variants)), note=note)


def _merged(rows: Sequence[tuple[TableCell, ...]], place: int, variants: int) -> tuple[tuple[TableCell, ...], ...]:
    """Merge rows that differ in the variant only (in the cell at `place`): variants with the same front end."""
    names: dict[tuple[TableCell, ...], list[str]] = {}
    for row in rows:
        names.setdefault((*row[:place], *row[place + 1 :]), []).append(row[place].text)
    return tuple(
        (*rest[:place], TableCell("all variants" if len(same) == variants > 1 else "; ".join(same)), *rest[place:])
        for rest, same in names.items()
    )


def metric_cell(metric: str) -> TableCell:
    """Make the cell of a metric's name with its unit, linked to its definition."""
    return TableCell(with_unit(metric), definition=metric if metric in DEFINITIONS else None)


def key_of(outcome: TrackOutcome, key: str) -> str:
    """Look up the value of a grouping key."""
    return {"track": outcome.track, "mode": outcome.mode, **outcome.labels}.get(key, NO_VALUE)


def format_metric(number_or_none: float | None) -> str:
    """Format a metric's value."""
    return format_number(number_or_none, 3)


def format_difference(difference: float) -> str:
    """Format a difference with its sign."""
    return ("+" if difference > 0.0 else "") + format_number(difference, 3)


def _by_variant(outcomes: Iterable[TrackOutcome], variants: Sequence[str]) -> dict[str, list[TrackOutcome]]:
    """Sort results by the name of the variant."""
    found: dict[str, list[TrackOutcome]] = {name: [] for name in variants}
    for outcome in outcomes:
        found[outcome.variant].append(outcome)
    return found


def _average(outcomes: Iterable[TrackOutcome], metric: str) -> Average:
    return pooled_average(metric, ((outcome.metrics[metric], outcome.counts) for outcome in outcomes))


def _best(metric: str, means: Sequence[float | None]) -> int | None:
    """Find the mean that is nearest to the ideal value.

    None for an unknown metric and where the means do not differ.
    """
    if metric not in DEFINITIONS:
        return None
    off = [(abs(mean - DEFINITIONS[metric].ideal), place) for place, mean in enumerate(means) if mean is not None]
    if not off or max(off)[0] - min(off)[0] < ROUNDING:
        return None
    return min(off)[1]
