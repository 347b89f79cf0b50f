"""The report of a walk: one HTML file that needs nothing but a browser."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import yaml

from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.inline_assets import TRACK_MAP_SCRIPTS, inline_assets, inline_json
from pdr_est.report.page_templates import NO_VALUE, format_duration, format_number, template_environment
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.plots.mode_style import mode_entry
from pdr_est.report.walk.explorer_data import explorer_data
from pdr_est.report.walk.fix_residuals import HELD_OUT, fix_residuals
from pdr_est.report.walk.map_extras import NO_EXTRAS, MapExtras
from pdr_est.report.walk.panels import floor_panels, place_panels, time_panels, track_panel, truth_points
from pdr_est.report.walk.summary import Json
from pdr_est.report.walk.track_formats import result_files
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

SCRIPTS = (
    *TRACK_MAP_SCRIPTS,
    "packed_columns.js",
    "map_background.js",
    "map_floors.js",
    "dom.js",
    "time_cursor.js",
    "time_chart.js",
    "walk_charts.js",
    "playback_bar.js",
    "cursor_table.js",
    "walk_explorer.js",
)
"""Scripts of the report in the order in which they run."""


def render_report(
    walk: SmoothedWalk,
    recording: Recording,
    summary: Json,
    extras: MapExtras = NO_EXTRAS,
) -> str:
    """Render the page as text.

    Parameters
    ----------
    walk : SmoothedWalk
        Finished walk.
    recording : Recording
        Recording that it was made from.
    summary : dict
        Summary by `summarise` of the same walk and recording.
    extras : MapExtras
        Further parts of the map.
    """
    told = {finding.words for finding in walk.track.findings}
    truth, frame = recording.truth.positions, summary["frame"]
    truth_m = truth_points(walk.track, truth, frame == "map")
    residuals = fix_residuals(walk, truth, truth_m)
    data = explorer_data(walk, residuals, truth_m, frame != "own", extras)
    panel = track_panel(walk, recording, frame == "map", frame == "north-up")
    assets = inline_assets(["leaflet", "uplot"], SCRIPTS)
    return (
        template_environment()
        .get_template("report.html.j2")
        .render(
            summary=summary,
            one_device=len(walk.track.devices) == 1,
            tiles=_tiles(summary),
            warnings=[words for words in summary["warnings"] if words not in told],
            errors=_flat(summary["errors_against_truth"] or {}),
            track=panel,
            panels=[*floor_panels(walk, recording, frame == "map"), *place_panels(walk), *time_panels(walk)],
            assets=assets,
            policy=assets.policy(*extras.image_hosts),
            image_hosts=extras.image_hosts,
            data=inline_json(data),
            files=result_files(summary.get("formats", {"written": ()})["written"]),
            map_legend=_map_legend(panel.legend, extras.variants, bool(walk.floors) and frame == "map"),
            held_out=any(one.kind == HELD_OUT for one in residuals),
            with_fixes=bool(residuals),
            models=list(dict.fromkeys(device.model for device in recording.devices if device.model)),
            mode_symbols={mode.name: mode_entry("strip", mode) for mode in CarryingMode},
            config_text=yaml.safe_dump(summary["config"], allow_unicode=True, sort_keys=False, width=100),
        )
    )


def _map_legend(legend: Sequence[LegendEntry], variants: Mapping[str, Track], with_floors: bool) -> list[LegendEntry]:
    """Change the legend of the picture into that of the map, which has dots for fixes, floors, and the variants."""
    entries = [replace(one, symbol="dot") if one.symbol == "fix" else one for one in legend]
    entries += [LegendEntry("shade", "muted", "walkable floor")] if with_floors else []
    return entries + [LegendEntry("line", svg.css_name(svg.INK), name, (0.5, 1.5)) for name in variants]


def _tiles(summary: Json) -> list[tuple[str, str]]:
    """Choose the few numbers that a reader looks for first."""
    steps = list(summary["counts"]["steps"].values())
    radii = [device["end_radius95_m"] for device in summary["devices"]]
    known = [radius for radius in radii if radius is not None]
    return [
        ("distance", f"{format_number(summary['distance_m'], 1)} m"),
        ("duration", format_duration(summary["duration_s"])),
        ("steps", " + ".join(format_number(count, 0) for count in steps) or NO_VALUE),
        ("95 % radius at the end", f"{format_number(max(known), 1) if known else NO_VALUE} m"),
        *_floors_tile(summary["height"]),
    ]


def _floors_tile(height: Json | None) -> list[tuple[str, str]]:
    """Return the tile of the floors, where more than one was visited."""
    floors = [] if height is None else height["floors"]
    return [("floors", f"{min(floors)} to {max(floors)}")] if len(floors) > 1 else []


def _flat(errors: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Flatten metrics to rows; the name of a group (a device, say) goes before the metric's name."""
    rows: list[tuple[str, Any]] = []
    for name, value in errors.items():
        rows += _flat(value, f"{prefix}{name} · ") if isinstance(value, Mapping) else [(f"{prefix}{name}", value)]
    return rows
