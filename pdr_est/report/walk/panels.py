"""The plots of the report with their titles, legends and captions.

Legends are HTML beside the plot: they never cover it, and names of devices stay text that the template escapes.
"""

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from pdr_est.evaluate.rigid_alignment import best_alignment
from pdr_est.frames import Array
from pdr_est.pipeline import DeviceWalk, SmoothedWalk
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.acceleration import plot_acceleration
from pdr_est.report.plots.finding_marks import marked_places
from pdr_est.report.plots.gait import plot_gait
from pdr_est.report.plots.heights import plot_heights
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.plots.mode_style import mode_legend, mode_runs
from pdr_est.report.plots.time_axis import TimeAxis, time_axis
from pdr_est.report.plots.track import plot_track
from pdr_est.report.plots.track_line import mode_polylines
from pdr_est.report.plots.whole_plan import plot_places
from pdr_est.report.walk.visited_floors import VisitedFloor, part_on_floor, visited_floors, within_spans
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.height import HeightProfile
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track


@dataclass(frozen=True)
class Panel:
    """Plot with its title, legend and caption.

    Attributes
    ----------
    title : str
        Title, plain text.
    svg : Markup
        Markup made by `figure.to_svg`, free of text from the recording.
    legend : tuple of LegendEntry
        Legend.
    caption : str
        Caption, plain text.
    """

    title: str
    svg: Markup
    legend: tuple[LegendEntry, ...]
    caption: str = ""


NOT_RECORDED = LegendEntry("shade", "muted", "not recorded")


def track_panel(walk: SmoothedWalk, recording: Recording, in_map_frame: bool, north_up: bool = False) -> Panel:
    """Make the map; a track that is not in the map frame has the truth aligned with it."""
    track, truth = walk.track, recording.truth.positions
    truth_m = truth_points(track, truth, in_map_frame)
    plan = walk.plan if in_map_frame and not walk.floors else None
    figure = plot_track(track, walk.fixes, truth_m, in_map_frame or north_up, plan)
    legend = _track_lines(track)
    legend += [LegendEntry("ellipse", "muted", "95 % region"), LegendEntry("start", "ink", "start")]
    if len(track) > len(track.devices):
        legend.append(LegendEntry("end", "ink", "end"))
    if walk.fixes:
        legend.append(LegendEntry("fix", "fix", "position fix"))
    if truth is not None and truth_m is not None:
        legend.append(LegendEntry("truth", "muted", f"truth ({truth.source})"))
    if plan is not None:
        legend.append(LegendEntry("shade", "muted", "walkable floor"))
    if marked_places(track):
        legend.append(LegendEntry("band", svg.css_name(svg.DOUBT), "does not fit"))
    caption = _track_caption(walk, truth_m is not None, in_map_frame, north_up)
    return Panel("Track", _markup(figure, "track", "Map of the track"), tuple(legend), caption)


def floor_panels(walk: SmoothedWalk, recording: Recording, in_map_frame: bool) -> list[Panel]:
    """Make a map for each floor of a walk over several, with its plan and the part of the track on it."""
    truth = recording.truth.positions
    panels = []
    for number, floor in enumerate(visited_floors(walk) if in_map_frame else ()):
        track = part_on_floor(walk.track, floor)
        if not len(track):
            continue
        fixes = [fix for fix in walk.fixes if within_spans(np.array([fix.time_s]), floor.shown_s)[0]]
        truth_m = None if truth is None else _in_visits(truth, floor)
        figure = plot_track(track, tuple(fixes), truth_m, True, floor.plan)
        legend = [*_track_lines(track), LegendEntry("shade", "muted", "walkable floor")]
        caption = "The part of the track on this floor, with the ways to it and from it."
        markup = _markup(figure, f"floor-{number}", f"Map of the track on {floor.title}")
        panels.append(Panel(f"Track on {floor.title}", markup, tuple(legend), caption))
    return panels


def _in_visits(truth: TruePositions, floor: VisitedFloor) -> Array:
    """Return the true positions (n, 2) in the visits of a floor, with a row of NaN after each visit."""
    parts = [truth.position_m[within_spans(truth.time_s, (span_s,))] for span_s in floor.shown_s]
    return np.concatenate([np.vstack([part, np.full((1, 2), np.nan)]) for part in parts])


def _track_lines(track: Track) -> list[LegendEntry]:
    """List the colours of the line: of the modes for one device, else of the devices, with the modes as bands."""
    legs = {mode for name in track.devices for mode in mode_polylines(track.of_device(name))}
    if len(track.devices) == 1:
        return mode_legend("line", legs)
    lines = [LegendEntry("line", _colour(place), name) for place, name in enumerate(track.devices)] if legs else []
    return lines + mode_legend("band", legs)


def truth_points(track: Track, truth: TruePositions | None, in_map_frame: bool) -> Array | None:
    """Bring the true positions (n, 2) into the frame of the track; None without any, or when that is not possible.

    A track that is not in the map frame has the truth aligned with it.
    """
    if truth is None or in_map_frame:
        return None if truth is None else truth.position_m
    first = track.of_device(track.devices[0])
    if len(first) < 2 or len(truth.time_s) < 2:
        return None
    reached, _ = first.at(truth.time_s)
    return best_alignment(truth.position_m, reached).apply(truth.position_m)


def _track_caption(walk: SmoothedWalk, shows_truth: bool, in_map_frame: bool, north_up: bool) -> str:
    sentences = []
    if len(walk.track) == len(walk.track.devices):
        sentences.append("No step was found: the track is a single point.")
    else:
        sentences.append(
            "The line has the colour of the carrying mode."
            if len(walk.devices) == 1
            else "The band under the line of a device has the colour of its carrying mode."
        )
        sentences.append("Ellipses are drawn for some of the poses.")
    if not in_map_frame:
        sentences.append(
            "North is up, as the phone knows it; the origin is the start of the walk."
            if north_up
            else "Without a complete start pose or fixes the track lies in a frame of its own."
        )
        if shows_truth:
            sentences.append("For this plot the truth was rotated and shifted to fit the track best.")
    return " ".join(sentences)


def time_panels(walk: SmoothedWalk) -> list[Panel]:
    """Make the acceleration plot of each device, the gait plot of all if there are steps, and that of the heights."""
    axis = time_axis(walk)
    panels = [
        _acceleration_panel(device, place, axis, len(walk.devices) > 1) for place, device in enumerate(walk.devices)
    ]
    if any(device.steps for device in walk.devices):
        panels.append(_gait_panel(walk, axis))
    if walk.track.height is not None:
        panels.append(_height_panel(walk.track.height, axis))
    return panels


def place_panels(walk: SmoothedWalk) -> list[Panel]:
    """Make the map of the places where a walk may have been whose start is not known; none for other walks."""
    search = walk.track.places
    if search is None or walk.plan is None:
        return []
    end, begin = LegendEntry("ellipse", "series-1", "end of the walk"), LegendEntry("ellipse", "muted", "start")
    markup = _markup(plot_places(walk.plan, search), "places", "Places on the plan where the walk may have been")
    caption = f"{search.words[0].upper()}{search.words[1:]}. Circles have two standard deviations."
    return [Panel("Place on the plan", markup, (end, begin), caption)]


def _height_panel(profile: HeightProfile, axis: TimeAxis) -> Panel:
    legend = [LegendEntry("line", "series-1", "height"), LegendEntry("shade", "series-1", "95 % interval")]
    if profile.moves:
        legend.append(LegendEntry("shade", "muted", "stairs, escalator or lift"))
    markup = _markup(plot_heights(profile, axis), "height", "Height over time")
    caption = "Height by the air pressure above the floor at the start; the numbers are those of the floors."
    return Panel("Height and floors", markup, tuple(legend), caption)


def _acceleration_panel(device: DeviceWalk, place: int, axis: TimeAxis, several: bool) -> Panel:
    figure = plot_acceleration(device, axis, svg.device_colour(place))
    legend = [LegendEntry("line", "muted", "vertical acceleration, gravity removed")]
    if device.steps:
        legend.append(LegendEntry("dot", _colour(place), "detected step"))
    legend += mode_legend("strip", (run.mode for run in mode_runs(device)))
    if device.gaps:
        legend.append(NOT_RECORDED)
    title = "Acceleration and steps" + (f": {device.device}" if several else "")
    return Panel(title, _markup(figure, f"acceleration-{place}", "Vertical acceleration over time"), tuple(legend))


def _gait_panel(walk: SmoothedWalk, axis: TimeAxis) -> Panel:
    names = [device.device for device in walk.devices] if len(walk.devices) > 1 else ["step"]
    legend = [LegendEntry("dot", _colour(place), name) for place, name in enumerate(names)]
    legend.append(LegendEntry("shade", "series-1", "95 % interval of the heading"))
    legend += mode_legend("strip", (run.mode for device in walk.devices for run in mode_runs(device)))
    if any(device.gaps for device in walk.devices):
        legend.append(NOT_RECORDED)
    markup = _markup(plot_gait(walk, axis), "gait", "Heading, step length and cadence over time")
    caption = "Heading is counter-clockwise from the x axis of the map; step lengths are those of the estimator."
    return Panel("Heading, step length, cadence", markup, tuple(legend), caption)


def _colour(place: int) -> str:
    return svg.css_name(svg.device_colour(place))


def _markup(figure: Figure, name: str, description: str) -> Markup:
    return Markup(svg.to_svg(figure, name, description))
