"""The page of an evaluation: one HTML file that needs nothing but a browser."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from markupsafe import Markup

from pdr_est.evaluate.rigid_alignment import RigidTransform
from pdr_est.report.evaluation.document import Evaluation, metric_rows, missing_rows
from pdr_est.report.evaluation.explorable import evaluation_data
from pdr_est.report.evaluation.plots import plot_errors
from pdr_est.report.inline_assets import TRACK_MAP_SCRIPTS, inline_assets, inline_json
from pdr_est.report.page_templates import format_number, template_environment
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.plots.track import plot_track
from pdr_est.report.walk.panels import Panel
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track, concatenate

_MOST_POSES = 4000  # of a device on the map: more than a plot can show
_SCRIPTS = (
    *TRACK_MAP_SCRIPTS,
    "packed_columns.js",
    "dom.js",
    "page_parts.js",
    "time_cursor.js",
    "time_chart.js",
    "playback_bar.js",
    "evaluation_page.js",
)


def render_evaluation(evaluation: Evaluation, document: Mapping[str, Any]) -> str:
    """Render the page as text.

    Parameters
    ----------
    evaluation : Evaluation
        The evaluation.
    document : mapping
        Its `evaluation_document`.
    """
    tracks = [_moved(evaluation.track.of_device(score.device), score.transform) for score in evaluation.scores]
    assets = inline_assets(["leaflet", "uplot"], _SCRIPTS)
    return (
        template_environment()
        .get_template("evaluation.html.j2")
        .render(
            document=document,
            assets=assets,
            policy=assets.policy(),
            data=inline_json(evaluation_data(evaluation, tracks)),
            tiles=_evaluation_tiles(document),
            rows=metric_rows(document),
            missing=missing_rows(document),
            panels=[_map_panel(evaluation, tracks), _error_panel(evaluation)],
        )
    )


def _evaluation_tiles(document: Mapping[str, Any]) -> list[tuple[str, str]]:
    first = document["devices"][0]
    name = "error_map_m" if "error_map_m" in first["metrics"] else "ate_rigid_m"
    return [
        (name, f"{format_number(first['metrics'][name])} m"),
        ("length ratio", format_number(first["metrics"].get("length_ratio"), 3)),
        ("true way", f"{format_number(document['truth']['length_m'], 1)} m"),
        ("true positions", format_number(first["truth_points"], 0)),
    ]


def _map_panel(evaluation: Evaluation, moved: Sequence[Track]) -> Panel:
    """Make the map: the track of each device after its alignment, and the true positions."""
    track = concatenate(moved)
    figure = plot_track(track, (), evaluation.truth.position_m, evaluation.origin is not None)
    colours = [svg.css_name(svg.device_colour(number)) for number in range(len(moved))]
    if len(moved) == 1:
        colours = [svg.css_name(svg.MODE_COLOURS[CarryingMode.OTHER])]
    legend = [
        LegendEntry("line", colour, score.device) for colour, score in zip(colours, evaluation.scores, strict=True)
    ]
    legend += [LegendEntry("start", "ink", "start"), LegendEntry("end", "ink", "end")]
    legend.append(LegendEntry("truth", "muted", f"truth ({evaluation.truth.source})"))
    caption = f"Alignment {evaluation.alignment.value}: {evaluation.alignment.words}."
    return Panel("Track against truth", Markup(svg.to_svg(figure, "track", "Map")), tuple(legend), caption)


def _moved(track: Track, transform: RigidTransform) -> Track:
    """Align a track for the map, with few enough poses; its covariances, of before the alignment, are left out."""
    keep = np.zeros(len(track), dtype=np.bool_)
    keep[np.linspace(0, len(track) - 1, min(len(track), _MOST_POSES)).round().astype(int)] = True
    kept = track.rows_where(keep)
    return replace(
        kept,
        position_m=transform.apply(kept.position_m),
        covariance_m2=np.full((len(kept), 2, 2), np.nan),
        mode=np.full(len(kept), CarryingMode.OTHER, dtype=np.int8),  # whose line is full: no mode is known
    )


def _error_panel(evaluation: Evaluation) -> Panel:
    legend = tuple(
        LegendEntry("line", svg.css_name(svg.device_colour(number)), score.device)
        for number, score in enumerate(evaluation.scores)
    )
    markup = Markup(svg.to_svg(plot_errors(evaluation.scores), "errors", "Error over time"))
    return Panel("Error at the true positions", markup, legend, f"After the alignment {evaluation.alignment.value}.")
