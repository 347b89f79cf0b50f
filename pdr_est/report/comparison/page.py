"""The page of an experiment: one HTML file that needs nothing but a browser."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from pdr_est.evaluate.metric_definitions import DEFINITIONS, with_unit
from pdr_est.evaluate.paired_comparison import PairedComparison
from pdr_est.report.comparison import tables
from pdr_est.report.comparison.plots import looks, plot_coverage, plot_distribution, plot_growth, plot_tracks
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.walk.page import environment
from pdr_est.report.walk.panels import Panel
from pdr_est.types.outcome import TrackOutcome

_TRUTH = LegendEntry("truth", "muted", "true positions")
_RIGHT = LegendEntry("line", "muted", "right", (1.6, 1.0))
_MOST_FAILURES = 100  # shown


@dataclass(frozen=True)
class Content:
    """What the page shows. pairs: variants compared walk by walk. failed: number of walks of which nothing could be
    told. failures: walk, and what could not be told and why. config: the resolved configuration as text. provenance:
    what is needed to repeat it."""

    title: str
    variants: tuple[str, ...]
    metrics: tuple[str, ...]
    group_by: tuple[str, ...]
    outcomes: tuple[TrackOutcome, ...]
    pairs: tuple[PairedComparison, ...]
    failed: int
    failures: tuple[tuple[str, str], ...]
    config: str
    provenance: Mapping[str, Any]


def render_comparison(content: Content) -> str:
    """The page as text."""
    shown = [metric for metric in content.metrics if any(one.metrics[metric] is not None for one in content.outcomes)]
    return (
        environment()
        .get_template("comparison.html.j2")
        .render(
            content=content,
            tiles=_tiles(content),
            averages=tables.averages(content.outcomes, content.variants, shown),
            tables=_tables(content, shown),
            panels=_panels(content),
            gallery=_gallery(content, shown),
            definitions=[(name, DEFINITIONS[name]) for name in content.metrics if name in DEFINITIONS],
            failures=content.failures[:_MOST_FAILURES],
            more_failures=max(len(content.failures) - _MOST_FAILURES, 0),
        )
    )


def _tiles(content: Content) -> list[tuple[str, str]]:
    walks = {one.walk for one in content.outcomes}
    tracks = {(one.walk, one.track) for one in content.outcomes}
    return [
        ("walks", str(len(walks))),
        ("tracks of each variant", str(len(tracks))),
        ("variants", str(len(content.variants))),
        ("failed walks", str(content.failed)),
    ]


def _tables(content: Content, metrics: Sequence[str]) -> list[tables.Table]:
    compared = {pair.first for pair in content.pairs}
    first_only = "The first variant is compared with the others; pdr-est compare has all pairs."
    note = first_only if len(content.variants) > 2 and len(compared) == 1 else ""
    made = [tables.pairs(content.pairs, note)] if any(pair.ties < pair.n for pair in content.pairs) else []
    made += [tables.groups(content.outcomes, content.variants, metrics, key) for key in content.group_by]
    made += [tables.steps(content.outcomes, content.variants), tables.modes(content.outcomes, content.variants)]
    return made


def _panels(content: Content) -> list[Panel]:
    """The plots that the data allow: errors need true positions, coverage needs fixes."""
    legend = tuple(looks(content.variants).values())
    outcomes, variants = content.outcomes, content.variants
    panels = []
    if any(len(one.error_m) for one in outcomes):
        where = "at true positions that the estimator was not given" if _fixed(outcomes) else "aligned at the start"
        figure = plot_distribution(outcomes, variants)
        caption = f"Errors {where}, of all walks together. The least and the largest 2 % may lie outside."
        panels.append(_panel("Distribution of the errors", "cdf", figure, legend, caption))
        caption = f"Errors {where}. Thick: median, thin: 90th percentile; dots: the positions, where they are few."
        figure = plot_growth(outcomes, variants)
        panels.append(_panel("Error against distance", "growth", figure, legend, caption))
    if any(len(one.squared) for one in outcomes):
        caption = "Below the broken line: the tracks claim to be surer than they are. Above: less sure."
        figure = plot_coverage(outcomes, variants)
        panels.append(_panel("Honesty of the covariance", "coverage", figure, (*legend, _RIGHT), caption))
    return panels


def _gallery(content: Content, metrics: Sequence[str]) -> list[Panel]:
    """The worst, the median and the best walk by the first metric of the tracks shown, mean over the variants."""
    if not metrics:
        return []
    held_out = "error_heldout_m"
    metric = held_out if held_out in metrics and _fixed(content.outcomes) else metrics[0]
    ideal = DEFINITIONS[metric].ideal if metric in DEFINITIONS else 0.0
    by_track: dict[tuple[str, str], list[TrackOutcome]] = {}
    for one in content.outcomes:
        by_track.setdefault((one.walk, one.track), []).append(one)
    scored = []
    for key, rows in by_track.items():
        known = [one.metrics[metric] for one in rows]
        off = [abs(value - ideal) for value in known if value is not None]
        if off and any(len(one.position_m) > 1 for one in rows):
            scored.append((float(np.mean(off)), key))
    scored.sort()
    if not scored:
        return []
    places = {"Worst": len(scored) - 1, "Median": (len(scored) - 1) // 2, "Best": 0}
    chosen: dict[int, str] = {}
    for word, place in places.items():
        chosen[place] = f"{chosen[place]} and {word.lower()}" if place in chosen else word
    panels = []
    for place, word in chosen.items():
        (walk, track), rows = scored[place][1], by_track[scored[place][1]]
        name = walk if track == "device" else f"{walk}, {track}"
        values = "; ".join(f"{one.variant} {tables.value(one.metrics[metric])}" for one in rows)
        legend = (*looks(content.variants).values(), *([_TRUTH] if len(rows[0].truth_m) else []))
        figure = plot_tracks(rows, content.variants)
        panels.append(
            _panel(
                f"{word} walk by {metric}: {name}", f"walk{place}", figure, legend, f"{with_unit(metric)}: {values}."
            )
        )
    return panels


def _fixed(outcomes: Sequence[TrackOutcome]) -> bool:
    return any(one.with_fixes for one in outcomes)


def _panel(title: str, name: str, figure: Figure, legend: tuple[LegendEntry, ...], caption: str) -> Panel:
    return Panel(title, Markup(svg.to_svg(figure, name, f"Plot {name}")), legend, caption)
