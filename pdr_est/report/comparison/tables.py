"""The tables of the page: averages, pairs, groups, steps and carrying modes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from pdr_est.evaluate.metric_definitions import DEFINITIONS, with_unit
from pdr_est.evaluate.paired_comparison import ROUNDING, PairedComparison
from pdr_est.evaluate.statistics import Average
from pdr_est.report.walk.page import NO_VALUE, number, percent
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.steps import CarryingMode

_MOST_COLUMNS = 5  # of variants side by side, which a page has room for


@dataclass(frozen=True)
class Cell:
    """A text; definition: the metric whose definition it is linked to; strong: whether it stands out."""

    text: str
    definition: str | None = None
    strong: bool = False


@dataclass(frozen=True)
class Table:
    """texts: how many columns from the left are words; the others are numbers and stand to the right."""

    title: str
    headings: tuple[Cell, ...]
    rows: tuple[tuple[Cell, ...], ...]
    texts: int = 1
    note: str = ""


def averages(outcomes: Sequence[TrackOutcome], variants: Sequence[str], metrics: Sequence[str]) -> Table:
    """Mean, median, 90th percentile and number of tracks, metric by metric; the best mean stands out."""
    rows = []
    for metric in metrics:
        found = [(name, _average(outcomes, name, metric)) for name in variants]
        best = _best(metric, [average.mean for _, average in found])
        rows += [
            (
                metric_cell(metric),
                Cell(name),
                Cell(value(average.mean), strong=place == best),
                Cell(value(average.median)),
                Cell(value(average.p90)),
                Cell(str(average.n)),
            )
            for place, (name, average) in enumerate(found)
        ]
    headings = tuple(Cell(text) for text in ("metric", "variant", "mean", "median", "90 %", "tracks"))
    return Table("All walks", headings, tuple(rows), texts=2, note="The mean nearest to the ideal value is bold.")


def groups(outcomes: Sequence[TrackOutcome], variants: Sequence[str], metrics: Sequence[str], key: str) -> Table:
    """Mean of every metric for each value of a key, a column for each variant; for many variants, a row for each."""
    names = sorted({key_of(outcome, key) for outcome in outcomes})
    within = {name: [outcome for outcome in outcomes if key_of(outcome, key) == name] for name in names}
    if len(variants) > max(_MOST_COLUMNS, len(names)):
        return _groups_aside(within, variants, metrics, key)
    rows = []
    for metric in metrics:
        for name in names:
            means = [_average(within[name], variant, metric).mean for variant in variants]
            best = _best(metric, means)
            cells = [Cell(value(mean), strong=place == best) for place, mean in enumerate(means)]
            count = len({(outcome.walk, outcome.track) for outcome in within[name]})
            rows.append((metric_cell(metric), Cell(name), Cell(str(count)), *cells))
    headings = (Cell("metric"), Cell(key), Cell("tracks"), *(Cell(variant) for variant in variants))
    return Table(f"Means by {key}", headings, tuple(rows), texts=2)


def _groups_aside(
    within: Mapping[str, Sequence[TrackOutcome]], variants: Sequence[str], metrics: Sequence[str], key: str
) -> Table:
    """The same with a column for each value of the key."""
    rows = []
    for metric in metrics:
        means = [[_average(rows_of, variant, metric).mean for variant in variants] for rows_of in within.values()]
        best = [_best(metric, column) for column in means]
        for place, variant in enumerate(variants):
            cells = [
                Cell(value(column[place]), strong=place == first) for column, first in zip(means, best, strict=True)
            ]
            rows.append((metric_cell(metric), Cell(variant), *cells))
    headings = (Cell("metric"), Cell("variant"), *(Cell(name) for name in within))
    tracks = ", ".join(
        f"{name} {len({(one.walk, one.track) for one in rows_of})}" for name, rows_of in within.items()
    )
    return Table(f"Means by {key}", headings, tuple(rows), texts=2, note=f"Number of tracks: {tracks}.")


def pairs(found: Iterable[PairedComparison], note: str = "") -> Table:
    """The comparisons of two variants each. note: more to say below it."""
    rows = tuple(
        (
            metric_cell(pair.metric),
            Cell(pair.first, strong=pair.better == pair.first),
            Cell(pair.second, strong=pair.better == pair.second),
            Cell(str(pair.n)),
            Cell(signed(pair.difference)),
            Cell(NO_VALUE if pair.low is None or pair.high is None else f"{signed(pair.low)} … {signed(pair.high)}"),
            Cell(f"{pair.first_wins} : {pair.second_wins}" + (f" ({pair.ties} ties)" if pair.ties else "")),
        )
        for pair in found
        if pair.ties < pair.n
    )
    words = ("metric", "A", "B", "walks", "B − A", "95 % interval", "wins A : B")
    about = (
        "B − A: mean over the walks of how much farther B is from the ideal value than A; negative: B is better. "
        "The interval is a bootstrap over walks, too narrow for fewer than about 20. A variant is bold where its "
        f"interval leaves no doubt. Pairs that agree on every walk are left out. {note}"
    )
    return Table("Walk by walk", tuple(Cell(word) for word in words), rows, texts=3, note=about.rstrip())


def steps(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> Table:
    """Detected and true steps of each variant by the carrying mode that was recognised for most of the walk."""
    rows = []
    for mode in sorted({outcome.mode for outcome in outcomes}):
        for name in variants:
            chosen = [one for one in outcomes if one.mode == mode and one.variant == name]
            if not chosen:
                continue
            counted = [one for one in chosen if one.true_steps]
            true = sum(one.true_steps or 0 for one in counted)
            off = [abs(one.steps - one.true_steps) / one.true_steps for one in counted if one.true_steps]
            rows.append(
                (
                    Cell(mode),
                    Cell(name),
                    Cell(str(len(chosen))),
                    Cell(number(sum(one.steps for one in chosen), 0)),
                    Cell(number(true, 0) if counted else NO_VALUE),
                    Cell(percent(sum(off) / len(off)) if off else NO_VALUE),
                )
            )
    words = ("mode recognised", "variant", "tracks", "steps detected", "steps taken", "mean count error")
    note = "Over whole recordings; the metric count_error is over the annotated time."
    return Table("Steps", tuple(Cell(word) for word in words), _merged(rows, 1, len(variants)), texts=2, note=note)


def modes(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> Table:
    """The share of the walking time in each carrying mode, mean over the tracks."""
    names = [mode.name for mode in CarryingMode if any(mode.name in one.mode_shares for one in outcomes)]
    rows = []
    for variant in variants:
        chosen = [one for one in outcomes if one.variant == variant and one.mode_shares]
        shares = [sum(one.mode_shares.get(name, 0.0) for one in chosen) / max(len(chosen), 1) for name in names]
        rows.append((Cell(variant), *(Cell(percent(share)) for share in shares)))
    headings = (Cell("variant"), *(Cell(name) for name in names))
    note = "Share of the walking time, mean over the tracks."
    return Table("Carrying modes", headings, _merged(rows, 0, len(variants)), note=note)


def _merged(rows: Sequence[tuple[Cell, ...]], place: int, variants: int) -> tuple[tuple[Cell, ...], ...]:
    """Rows that differ in the variant only, the cell at a place, as one: variants with the same front end."""
    names: dict[tuple[Cell, ...], list[str]] = {}
    for row in rows:
        names.setdefault((*row[:place], *row[place + 1 :]), []).append(row[place].text)
    return tuple(
        (*rest[:place], Cell("all variants" if len(same) == variants > 1 else "; ".join(same)), *rest[place:])
        for rest, same in names.items()
    )


def metric_cell(metric: str) -> Cell:
    """A metric's name with its unit, linked to its definition."""
    return Cell(with_unit(metric), definition=metric if metric in DEFINITIONS else None)


def key_of(outcome: TrackOutcome, key: str) -> str:
    """The value of a key to group by."""
    return {"track": outcome.track, "mode": outcome.mode, **outcome.labels}.get(key, NO_VALUE)


def value(number_or_none: float | None) -> str:
    """A metric's value."""
    return number(number_or_none, 3)


def signed(difference: float) -> str:
    """A difference with its sign."""
    return ("+" if difference > 0.0 else "") + number(difference, 3)


def _average(outcomes: Iterable[TrackOutcome], variant: str, metric: str) -> Average:
    return Average.of(outcome.metrics[metric] for outcome in outcomes if outcome.variant == variant)


def _best(metric: str, means: Sequence[float | None]) -> int | None:
    """Which mean is nearest to the ideal value; None for an unknown metric and where the means do not differ."""
    if metric not in DEFINITIONS:
        return None
    off = [(abs(mean - DEFINITIONS[metric].ideal), place) for place, mean in enumerate(means) if mean is not None]
    if not off or max(off)[0] - min(off)[0] < ROUNDING:
        return None
    return min(off)[1]
