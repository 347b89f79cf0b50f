"""The report of a walk: one HTML file that needs nothing but a browser."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from pdr_est.frames import Array
from pdr_est.io.recording import Recording
from pdr_est.pipeline import SmoothedWalk
from pdr_est.records import CarryingMode
from pdr_est.report import svg
from pdr_est.report.summary import Json
from pdr_est.report.time_plots import plot_acceleration, plot_gait, time_axis
from pdr_est.report.track_plot import plot_track
from pdr_est.track import Track

NO_VALUE = "–"


@dataclass(frozen=True)
class LegendEntry:
    """A sign of a plot and what it means. sign: a macro of the template; colour: CSS variable without dashes."""

    sign: str
    colour: str
    label: str


@dataclass(frozen=True)
class Panel:
    """A plot with its words. svg: trusted markup made by `svg.to_svg`; everything else is escaped by the template."""

    title: str
    svg: Markup
    legend: tuple[LegendEntry, ...]
    caption: str


def render_report(walk: SmoothedWalk, recording: Recording, summary: Json) -> str:
    """The page as text. summary: what `summarise` returned for the same walk and recording."""
    environment = Environment(
        loader=PackageLoader("pdr_est", "report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(number=number, seconds=seconds, metric=metric)
    return environment.get_template("report.html.j2").render(
        summary=summary,
        one_device=len(walk.track.devices) == 1,
        tiles=_tiles(summary),
        errors=_flat(summary["errors_against_truth"] or {}),
        track=_track_panel(walk, recording, summary),
        panels=_time_panels(walk),
        modes=_modes(walk.track),
        config_text=yaml.safe_dump(summary["config"], allow_unicode=True, sort_keys=False, width=100),
    )


def number(value: float | None, digits: int = 2) -> str:
    """A number for reading; a dash for None."""
    return NO_VALUE if value is None else f"{value:,.{digits}f}".replace(",", "\u202f").replace("-", "−")


def seconds(value: float | None) -> str:
    """A duration: 8.4 s, 3 min 05 s, 2 h 07 min."""
    if value is None:
        return NO_VALUE
    if value < 60.0:
        return f"{value:.1f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def metric(value: Any, name: str) -> str:
    """A metric with the unit that its name ends on."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return NO_VALUE if value is None else str(value)
    if isinstance(value, int):
        return number(value, 0)
    unit = next((sign for suffix, sign in (("_m", "m"), ("_deg", "°"), ("_s", "s")) if name.endswith(suffix)), "")
    return f"{number(value, 2 if unit else 3)} {unit}".strip()


def _tiles(summary: Json) -> list[tuple[str, str]]:
    """The few numbers that one looks for first."""
    steps = list(summary["counts"]["steps"].values())
    radii = [device["end_radius95_m"] for device in summary["devices"]]
    known = [radius for radius in radii if radius is not None]
    return [
        ("distance", f"{number(summary['distance_m'], 1)} m"),
        ("duration", seconds(summary["duration_s"])),
        ("steps", " + ".join(number(count, 0) for count in steps) or NO_VALUE),
        ("95 % radius at the end", f"{number(max(known), 1) if known else NO_VALUE} m"),
    ]


def _flat(errors: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Metrics as rows; a group (a device, say) goes before the metric's name."""
    rows: list[tuple[str, Any]] = []
    for name, value in errors.items():
        rows += _flat(value, f"{prefix}{name} · ") if isinstance(value, Mapping) else [(f"{prefix}{name}", value)]
    return rows


def _modes(track: Track) -> list[tuple[str, float]]:
    """Share of the steps in each carrying mode, the most frequent first."""
    stepped = np.concatenate([track.of_device(name).mode[1:] for name in track.devices] or [track.mode])
    values, counts = np.unique(stepped, return_counts=True)
    shares = [(CarryingMode(int(v)).name, int(c) / len(stepped)) for v, c in zip(values, counts, strict=True)]
    return sorted(shares, key=lambda share: -share[1])


def _track_panel(walk: SmoothedWalk, recording: Recording, summary: Json) -> Panel:
    in_map = summary["frame"] == "map"
    truth = _truth_m(recording) if in_map else None
    figure = plot_track(walk.track, walk.fixes, truth, in_map)
    several = len(walk.track.devices) > 1
    legend = [
        LegendEntry("line", _colour(position), name if several else f"{summary['kind']} track")
        for position, name in enumerate(walk.track.devices)
    ]
    legend += [
        LegendEntry("ellipse", "series-1", "95 % region"),
        LegendEntry("start", "series-1", "start"),
        LegendEntry("end", "series-1", "end"),
    ]
    if walk.fixes:
        legend.append(LegendEntry("fix", "fix", "position fix"))
    if truth is not None and recording.truth.positions is not None:
        legend.append(LegendEntry("truth", "muted", f"truth ({recording.truth.positions.source})"))
    return Panel(
        "Track", _markup(figure, "track", "Map of the track"), tuple(legend), _track_caption(walk, recording, in_map)
    )


def _track_caption(walk: SmoothedWalk, recording: Recording, in_map: bool) -> str:
    sentences = []
    if len(walk.track) == len(walk.track.devices):
        sentences.append("No step was found: the track is a single point.")
    if in_map:
        sentences.append("Map frame: x east, y north. Ellipses are drawn for some poses only.")
    else:
        sentences.append(
            "Without a start pose and without fixes the track lies in a frame of its own: "
            "origin at the start, first step along x."
        )
        if recording.truth.positions is not None:
            sentences.append("The truth of this recording lies in the map frame and is therefore not drawn.")
    return " ".join(sentences)


def _truth_m(recording: Recording) -> Array | None:
    positions = recording.truth.positions
    return None if positions is None else positions.position_m


def _time_panels(walk: SmoothedWalk) -> list[Panel]:
    axis = time_axis(walk)
    names = list(walk.track.devices)
    several = len(walk.devices) > 1
    panels = []
    for position, device in enumerate(walk.devices):
        place = names.index(device.device) if device.device in names else position
        figure = plot_acceleration(device, axis, svg.series_colour(place))
        legend = (
            LegendEntry("line", "muted", "vertical acceleration, gravity removed"),
            LegendEntry("dot", _colour(place), "detected step"),
            *((LegendEntry("shade", "muted", "not recorded"),) if device.gaps else ()),
        )
        title = f"Acceleration and steps: {device.device}" if several else "Acceleration and steps"
        markup = _markup(figure, f"acceleration-{position}", "Vertical acceleration with the detected steps")
        panels.append(Panel(title, markup, legend, ""))
    markup = _markup(plot_gait(walk, axis), "gait", "Heading, step length and cadence over time")
    legend = tuple(
        LegendEntry("dot", _colour(place), name if several else "step") for place, name in enumerate(names)
    )
    legend += (LegendEntry("shade", "series-1", "95 % interval of the heading"),)
    caption = (
        "Heading counter-clockwise from the x axis, that is from east in the map frame. Step length as estimated."
    )
    return [*panels, Panel("Heading, step length, cadence", markup, legend, caption)]


def _colour(place: int) -> str:
    return svg.css_name(svg.series_colour(place))


def _markup(figure: Any, name: str, description: str) -> Markup:
    return Markup(svg.to_svg(figure, name, description))  # no text of the recording is in a figure
