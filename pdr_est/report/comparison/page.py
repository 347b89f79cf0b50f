"""The report of an experiment: one HTML file that needs nothing but a browser."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from pdr_est.evaluate.metric_definitions import ALIGNED_NOTE, DEFINITIONS, with_unit
from pdr_est.evaluate.paired_comparison import PairedComparison
from pdr_est.report.comparison import tables
from pdr_est.report.comparison.comparison_data import NO_PLANS, comparison_data
from pdr_est.report.comparison.plots import plot_coverage, plot_distribution, plot_growth, plot_tracks, variant_styles
from pdr_est.report.inline_assets import TRACK_MAP_SCRIPTS, inline_assets, inline_json
from pdr_est.report.page_templates import template_environment
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.walk.panels import Panel
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.outcome import TrackOutcome

_TRUTH = LegendEntry("truth", "muted", "true positions")
_IDEAL = LegendEntry("line", "muted", "ideal", (1.6, 1.0))
_MOST_FAILURES = 100  # shown
_SCRIPTS = (
    "packed_columns.js",
    "map_background.js",
    "dom.js",
    "page_parts.js",
    "comparison_data.js",
    "table_sorting.js",
    "definition_notes.js",
    "curve_charts.js",
    "walk_table.js",
    "walk_tracks.js",
    "comparison_page.js",
)


@dataclass(frozen=True)
class ComparisonContent:
    """Content of the page.

    Attributes
    ----------
    title : str
        Title of the experiment.
    variants, metrics, group_by : tuple of str
        Names of the variants, of the metrics, and of the keys that walks are grouped by.
    outcomes : tuple of TrackOutcome
        Results of each track and variant.
    pairs : tuple of Paired
        Variants compared walk by walk.
    failed : int
        Number of walks without any result.
    failures : tuple of (str, str)
        Walk, and what failed and why.
    config : str
        Resolved configuration.
    provenance : mapping
        Information that is needed to repeat the experiment.
    aligned : tuple of str
        Names of the variants whose estimator only aligns its track with the fixes.
    plans : mapping of str to FloorPlan
        Floor plans of walks, by the names of the walks, to draw below their tracks.
    """

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
    aligned: tuple[str, ...] = ()
    plans: Mapping[str, FloorPlan] = field(default_factory=lambda: NO_PLANS)


def render_comparison(content: ComparisonContent) -> str:
    """Render the page as text."""
    aligned = content.aligned if _fixed(content.outcomes) else ()
    assets = inline_assets(["leaflet", "uplot"], [*TRACK_MAP_SCRIPTS, *_SCRIPTS])
    shown = [metric for metric in content.metrics if any(one.metrics[metric] is not None for one in content.outcomes)]
    first_metric = _leading_metric(content, shown)
    data = comparison_data(
        content.outcomes, content.variants, shown, content.group_by, first_metric, content.aligned, content.plans
    )
    return (
        template_environment()
        .get_template("comparison.html.j2")
        .render(
            content=content,
            assets=assets,
            policy=assets.policy(),
            data=inline_json(data),
            explorable=bool(shown and content.outcomes),
            on_plans=any(len(one.on_plan_m) for one in content.outcomes),
            curves=data["curves"],
            tiles=_tiles(content),
            averages=tables.averages_table(content.outcomes, content.variants, shown, content.aligned),
            aligned=aligned,
            alignment_note=ALIGNED_NOTE.removeprefix("* "),
            tables=_tables(content, shown),
            panels=_panels(content),
            gallery=_gallery(content, shown),
            definitions=[(name, DEFINITIONS[name]) for name in content.metrics if name in DEFINITIONS],
            failures=content.failures[:_MOST_FAILURES],
            more_failures=max(len(content.failures) - _MOST_FAILURES, 0),
        )
    )


def _tiles(content: ComparisonContent) -> list[tuple[str, str]]:
    walks = {one.walk for one in content.outcomes}
    tracks = {(one.walk, one.track) for one in content.outcomes}
    return [
        ("walks", str(len(walks))),
        ("tracks of each variant", str(len(tracks))),
        ("variants", str(len(content.variants))),
        ("failed walks", str(content.failed)),
    ]


def _tables(content: ComparisonContent, metrics: Sequence[str]) -> list[tables.ReportTable]:
    compared = {pair.first for pair in content.pairs}
    first_only = "Here the first variant is compared with the others; `pdr-est compare` compares all pairs."
    note = first_only if len(content.variants) > 2 and len(compared) == 1 else ""
    made = (
        [tables.pairs_table(content.pairs, note, content.aligned)]
        if any(pair.ties < pair.n for pair in content.pairs)
        else []
    )
    made += [tables.groups_table(content.outcomes, content.variants, metrics, key) for key in content.group_by]
    made += [
        tables.steps_table(content.outcomes, content.variants),
        tables.modes_table(content.outcomes, content.variants),
    ]
    return made


def _panels(content: ComparisonContent) -> list[tuple[str, Panel]]:
    """Make the plots that the data allow, by name: errors need true positions, coverage needs fixes."""
    legend = tuple(variant_styles(content.variants).values())
    outcomes, variants = content.outcomes, content.variants
    panels = []
    if any(len(one.error_m) for one in outcomes):
        where = (
            "at true positions that the estimator was not given"
            if _fixed(outcomes)
            else "after alignment at the start"
        )
        figure = plot_distribution(outcomes, variants)
        caption = f"Errors of all walks together, {where}. The smallest and the largest 2 % may lie outside the plot."
        panels.append(("cdf", _panel("Distribution of the errors", "cdf", figure, legend, caption)))
        caption = (
            f"Errors {where}. Thick: median; thin: 90th percentile; dots: single positions, where there are few."
        )
        figure = plot_growth(outcomes, variants)
        panels.append(("growth", _panel("Error against distance", "growth", figure, legend, caption)))
    if any(len(one.squared) for one in outcomes):
        caption = "Below the dashed line the covariance is too small (overconfident), above it too large."
        figure = plot_coverage(outcomes, variants)
        panels.append(
            ("coverage", _panel("Consistency of the covariance", "coverage", figure, (*legend, _IDEAL), caption))
        )
    return panels


def _gallery(content: ComparisonContent, metrics: Sequence[str]) -> list[Panel]:
    """Draw the worst, the median and the best walk by the leading metric of the tracks, mean over the variants."""
    metric = _leading_metric(content, metrics)
    if metric is None:
        return []
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
        values = "; ".join(f"{one.variant} {tables.format_metric(one.metrics[metric])}" for one in rows)
        legend = (*variant_styles(content.variants).values(), *([_TRUTH] if len(rows[0].truth_m) else []))
        figure = plot_tracks(rows, content.variants, content.plans.get(walk))
        panels.append(
            _panel(
                f"{word} walk by {metric}: {name}", f"walk{place}", figure, legend, f"{with_unit(metric)}: {values}."
            )
        )
    return panels


def _leading_metric(content: ComparisonContent, metrics: Sequence[str]) -> str | None:
    """Choose the metric that walks are ordered by: the error at held-out positions, else the first one."""
    held_out = "error_heldout_m"
    return held_out if held_out in metrics and _fixed(content.outcomes) else next(iter(metrics), None)


def _fixed(outcomes: Sequence[TrackOutcome]) -> bool:
    return any(one.with_fixes for one in outcomes)


def _panel(title: str, name: str, figure: Figure, legend: tuple[LegendEntry, ...], caption: str) -> Panel:
    return Panel(title, Markup(svg.to_svg(figure, name, f"Plot {name}")), legend, caption)
