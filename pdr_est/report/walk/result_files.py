"""The result files of a smoothed walk."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.calibration.profile import Profile
from pdr_est.config import Config, config_to_dict
from pdr_est.errors import RecordingError
from pdr_est.evaluate.position_errors import LEAST_POINTS, open_metrics, point_errors
from pdr_est.evaluate.time_association import associate
from pdr_est.evaluate.trajectories.scores import consistency_metrics
from pdr_est.front_end.gait import gait_model
from pdr_est.front_end.gait.model import model_digest
from pdr_est.io.writers.steps_table import write_steps_csv
from pdr_est.module_loading import loading_modules
from pdr_est.output.atomic_output import write_text
from pdr_est.pipeline import SmoothedWalk, estimate_tracks
from pdr_est.report.background.kinds import Background, plan_background
from pdr_est.report.background.placement import MapPlacement, map_placement
from pdr_est.report.plots.matplotlib_loading import loading_matplotlib
from pdr_est.report.walk.earth_placement import EarthPlacement, place_on_earth
from pdr_est.report.walk.map_extras import NO_EXTRAS, MapExtras
from pdr_est.report.walk.summary import Json, package_versions, summarise
from pdr_est.report.walk.track_formats import WrittenTrack, write_track_formats
from pdr_est.report.walk.visited_floors import visited_floors
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track


def write_results(
    folder: Path,
    walk: SmoothedWalk,
    recording: Recording,
    config: Config,
    inputs: Mapping[str, str | None],
    profile: Profile | None = None,
    with_report: bool = True,
    formats: Sequence[str] | None = None,
    background: Background | None = None,
) -> Json:
    """Write track.csv, steps.csv, summary.json, report.html, and the track in formats for other programs.

    Parameters
    ----------
    folder : Path
        Existing folder.
    walk : SmoothedWalk
        Finished walk.
    recording : Recording
        Recording that it was made from.
    config : Config
        Configuration of the run.
    inputs : mapping of str to str or None
        SHA-256 of each input file by its name.
    profile : Profile or None
        Profile of the walker, if the configuration was made with one.
    with_report : bool
        False to leave out report.html, whose pictures take longer than all the rest.
    formats : sequence of str or None
        Formats of the track, names of `TRACK_FORMATS`; None for the default.
    background : Background or None
        What lies below the track on the map of the report; a warning says so if it cannot be placed.

    Returns
    -------
    dict
        The summary.

    Raises
    ------
    OutputError
        If a file cannot be written.
    RecordingError
        If a format that was chosen needs a place on the Earth and there is none.
    """
    summary = _summary(walk, recording, config, inputs, profile)
    earth = place_on_earth(walk.track, summary["frame"], recording, config.fixes)
    summary |= _write_tracks(folder, walk, recording, earth, formats)
    placement = map_placement(walk.track, summary["frame"], recording, earth)
    extras, words = _map_extras(walk, config, background, placement) if with_report else (NO_EXTRAS, [])
    summary["warnings"] += words
    write_text(folder / "summary.json", json.dumps(summary, indent=2, ensure_ascii=False) + "\n")
    if with_report:
        _write_report(folder / "report.html", walk, recording, summary, extras)
    return summary


def _map_extras(
    walk: SmoothedWalk, config: Config, background: Background | None, placement: MapPlacement
) -> tuple[MapExtras, list[str]]:
    """Collect the further parts of the map; return also the reason if the background cannot be placed.

    Without a background of its own the map has the floor plan of the walk, or those of its floors.
    """
    variants = _variants(walk, config)
    if background is None and walk.plan is not None and not walk.floors:
        background = plan_background(walk.plan)
    points_m = walk.track.position_m
    reach = points_m.min(axis=0), points_m.max(axis=0)
    try:
        below = None if background is None else background.placed(placement, *reach)
        floors = tuple(
            {
                "name": floor.plan.floor,
                "plan": plan_background(floor.plan).placed(placement, *reach),
                "spans_s": np.clip(floor.shown_s, *walk.track.time_s[[0, -1]] + [0.0, 1.0]).tolist(),
            }
            for floor in visited_floors(walk)
        )
    except RecordingError as error:  # only known after the long work, whose results are worth having
        return MapExtras(variants), [str(error)]
    return MapExtras(variants, below, floors, () if background is None else background.image_hosts), []


def _variants(walk: SmoothedWalk, config: Config) -> dict[str, Track]:
    """Reckon the track without the fixes, which only align it, so that the map shows what they changed."""
    if not walk.fixes or not walk.fixes_used:
        return {}
    track = estimate_tracks(walk.devices, config.with_estimator("dead-reckoning"), walk.fixes)
    return {"dead reckoning": track.of_device(track.devices[-1])}


def _summary(
    walk: SmoothedWalk,
    recording: Recording,
    config: Config,
    inputs: Mapping[str, str | None],
    profile: Profile | None,
) -> Json:
    return summarise(
        walk,
        recording,
        config_to_dict(config),
        inputs,
        package_versions(),
        start=config.start.pose(),
        errors=truth_errors(walk, recording),
        profile=profile,
        gait_model_sha256=_gait_digest(config),
    )


def _gait_digest(config: Config) -> str | None:
    gaits = gait_model(config.gait)
    return None if gaits is None else model_digest(gaits)


def _write_tracks(
    folder: Path,
    walk: SmoothedWalk,
    recording: Recording,
    earth: EarthPlacement,
    formats: Sequence[str] | None,
) -> Json:
    """Write the tables of track and steps, and the track for other programs; return what the summary says of it."""
    walk.track.to_csv(folder / "track.csv")
    write_steps_csv({device.device: device.steps for device in walk.devices}, folder / "steps.csv")
    found = write_track_formats(WrittenTrack(walk.track, earth, recording, walk.fixes), folder, formats=formats)
    return {"on_earth": {"placed": earth.origin is not None, "meaning": earth.meaning}, "formats": found}


def _write_report(path: Path, walk: SmoothedWalk, recording: Recording, summary: Json, extras: MapExtras) -> None:
    with loading_modules(), loading_matplotlib():
        from pdr_est.report.walk.page import render_report  # matplotlib is slow to load

    write_text(path, render_report(walk, recording, summary, extras))


def truth_errors(walk: SmoothedWalk, recording: Recording) -> dict[str, Any] | None:
    """Compute errors of the track against the recording's true positions, as the benchmark defines them.

    `error_map_m`, the mean error without any alignment, and the metrics of the covariances are added only where fixes
    tie the track to the map.

    Returns
    -------
    dict or None
        Metrics by name, of several devices and the person below the name of each; None without at least two true
        positions within the recording.
    """
    truth = recording.truth.positions
    if truth is None:
        return None
    found = {name: _device_errors(walk, name, truth) for name in walk.track.devices}
    known = {name: errors for name, errors in found.items() if errors}
    if not known:
        return None
    return known if len(found) > 1 else next(iter(known.values()))


def _device_errors(walk: SmoothedWalk, name: str, truth: TruePositions) -> dict[str, float]:
    """Compute the errors of one device, or of the person, whose span is that of all devices."""
    own = [device for device in walk.devices if device.device == name] or walk.devices
    if not own:
        return {}
    begins_s, ends_s = zip(*(device.span_s for device in own), strict=True)
    track = walk.track.of_device(name)
    pairs = associate(track, truth.time_s, truth.position_m, (min(begins_s), max(ends_s)))
    if len(pairs) < LEAST_POINTS:
        return {}
    found = open_metrics(track, pairs, truth.source)
    if walk.fixes:
        found["error_map_m"] = float(point_errors(pairs.track_m, pairs.truth_m).mean())
        found |= consistency_metrics(pairs, truth.sigma_m)[0]
    return found
