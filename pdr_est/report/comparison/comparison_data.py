"""Data that the scripts of the comparison page show: metrics of each walk, tracks, and curves of the errors."""

import json
from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from pdr_est.evaluate.metric_definitions import DEFINITIONS, unit_of
from pdr_est.frames import Array
from pdr_est.report.background.kinds import plan_background
from pdr_est.report.background.placement import MapPlacement
from pdr_est.report.comparison.curves import error_curves
from pdr_est.report.comparison.line_encoding import encode_lines, simplify_lines
from pdr_est.report.comparison.plots import variant_styles
from pdr_est.report.comparison.tables import key_of
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.outcome import TrackOutcome

_DIGITS = 5  # of a metric, two more than are shown
_TRACK_CHARACTERS = 5_000_000  # about, of all tracks together; a page of more opens slowly on a phone
_CHARACTERS_OF_A_POINT = 4
_FEWEST_POINTS, _MOST_POINTS = 24, 4000  # of a track
_ROWS_AT_ONCE = 64  # whose points are in memory together
_FINEST_M, _SHARE = 0.02, 1 / 2000  # error of a drawn line, absolute and of the extent of the walk: less than a pixel

NO_PLANS: Mapping[str, FloorPlan] = MappingProxyType({})
"""Plans of walks without any."""

Row = tuple[str, str]
"""Walk and track, of which each variant has one result."""


def comparison_data(
    outcomes: Sequence[TrackOutcome],
    variants: Sequence[str],
    metrics: Sequence[str],
    group_by: Sequence[str],
    first_metric: str | None,
    aligned: Collection[str] = (),
    plans: Mapping[str, FloorPlan] = NO_PLANS,
) -> dict[str, Any]:
    """Describe the results as JSON-serialisable columns.

    A row is a track of a walk. Columns of metrics and tracks have one list for each variant.

    Parameters
    ----------
    outcomes : sequence of TrackOutcome
        Results.
    variants, metrics, group_by : sequence of str
        Names of the variants, of the metrics that have values, and of the keys that walks are grouped by.
    first_metric : str or None
        Metric that is shown first; None without any.
    aligned : collection of str
        Names of the variants whose estimator only aligns its track with the fixes.
    plans : mapping of str to FloorPlan
        Floor plans of walks, by the names of the walks.
    """
    rows = list(dict.fromkeys((one.walk, one.track) for one in outcomes))
    of_variant: dict[str, dict[Row, TrackOutcome]] = {name: {} for name in variants}
    for one in outcomes:
        of_variant[one.variant][one.walk, one.track] = one
    table = [[of_variant[name].get(row) for row in rows] for name in variants]
    styles = variant_styles(variants)
    return {
        "variants": [
            {
                "name": name,
                "colour": f"--{styles[name].colour}",
                "dashes": styles[name].dashes,
                "aligned": name in aligned,
            }
            for name in variants
        ],
        "first_metric": first_metric,
        "metrics": [_metric(name, table) for name in metrics],
        "walks": [walk for walk, _ in rows],
        "tracks": [track for _, track in rows],
        "keys": _keys(outcomes, rows, group_by),
        "values": {name: [[_value(one, name) for one in column] for column in table] for name in metrics},
        "lines": _lines(table, len(rows)),
        **_plans([plans.get(walk) for walk, _ in rows]),
        "curves": error_curves(outcomes, list(styles.values())),
    }


def _metric(name: str, table: Sequence[Sequence[TrackOutcome | None]]) -> dict[str, Any]:
    """Describe a metric: name, unit, definition, and the weights of the walks in its mean."""
    known = DEFINITIONS.get(name)
    described = {
        "name": name,
        "unit": unit_of(name),
        "text": known.text if known else "",
        "ideal": known.ideal if known else None,
        "with_fixes": known is not None and known.with_fixes,
    }
    if known is None or known.pooled_by is None:
        return described
    weights = [[None if one is None else one.counts.get(known.pooled_by) for one in column] for column in table]
    return described | {"weights": weights}


def _value(outcome: TrackOutcome | None, metric: str) -> float | None:
    value = None if outcome is None else outcome.metrics.get(metric)
    return None if value is None else round(value, _DIGITS)


def _keys(outcomes: Sequence[TrackOutcome], rows: Sequence[Row], group_by: Sequence[str]) -> list[dict[str, Any]]:
    """List the keys by which walks can be filtered, with their values and the number of that of each row."""
    first = {(one.walk, one.track): one for one in reversed(outcomes)}
    names = dict.fromkeys([*group_by, "track", "mode", *(key for one in first.values() for key in one.labels)])
    keys = []
    for name in names:
        of_row = [key_of(first[row], name) for row in rows]
        values = sorted(set(of_row))
        if len(values) > 1:
            number = {value: place for place, value in enumerate(values)}
            keys.append({"name": name, "values": values, "of": [number[value] for value in of_row]})
    return keys


def _plans(of_rows: Sequence[FloorPlan | None]) -> dict[str, Any]:
    """Describe each floor plan once, and number the plan of each row; None for a row without plan."""
    here = MapPlacement(np.zeros(2), None, "")
    drawn: dict[str, int] = {}  # text -> number
    numbers = []
    for plan in of_rows:
        lines = None if plan is None else plan_background(plan).placed(here, np.zeros(2), np.zeros(2))
        numbers.append(None if lines is None else drawn.setdefault(json.dumps(lines), len(drawn)))
    return {"plans": [json.loads(text) for text in drawn], "plan_of": numbers}


def _lines(table: Sequence[Sequence[TrackOutcome | None]], rows: int) -> dict[str, Any]:
    """Encode the tracks of all variants and the true positions, with one step of quantisation for each row."""
    drawn = sum(one is not None and len(one.drawn_m) > 0 for column in table for one in column)
    most = int(np.clip(_TRACK_CHARACTERS / _CHARACTERS_OF_A_POINT / max(drawn, 1), _FEWEST_POINTS, _MOST_POINTS))
    steps_m: list[float] = []
    texts: list[list[str]] = [[] for _ in range(len(table) + 1)]  # of the truth and of each variant
    for begin in range(0, rows, _ROWS_AT_ONCE):
        batch = [
            _lines_of([column[row] for column in table]) for row in range(begin, min(begin + _ROWS_AT_ONCE, rows))
        ]
        tolerance_m = [max(_FINEST_M, _SHARE * _extent(lines)) for lines in batch]
        steps_m += [float(f"{0.5 * one:.2g}") for one in tolerance_m]
        for place, column in enumerate(zip(*batch, strict=True)):
            shown = simplify_lines(column, tolerance_m, most) if place else column
            texts[place] += encode_lines(shown, steps_m[begin:])
    return {"step_m": steps_m, "truth": texts[0], "tracks": texts[1:]}


def _lines_of(results: Sequence[TrackOutcome | None]) -> list[Array]:
    """List the true positions of a row, and the track of each variant that is drawn; empty where there are none."""
    nothing = np.empty((0, 2))
    truth_m = next((one.truth_m for one in results if one is not None), nothing)
    return [truth_m, *(nothing if one is None else one.drawn_m for one in results)]


def _extent(lines: Sequence[Array]) -> float:
    """Compute the larger side, m, of the box about some lines."""
    points = [line for line in lines if len(line)]
    if not points:
        return 0.0
    low = np.min([line.min(axis=0) for line in points], axis=0)
    high = np.max([line.max(axis=0) for line in points], axis=0)
    return float(np.max(high - low))
