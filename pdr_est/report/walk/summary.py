"""The numbers of a finished walk as one JSON document: `summary.json`, and the source of the report's tables."""

import math
import platform
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, is_dataclass
from datetime import date
from enum import Enum
from importlib import metadata
from pathlib import PurePath
from typing import Any

import numpy as np

from pdr_est.calibration.profile import Profile
from pdr_est.clock_sync import ClockEstimate
from pdr_est.estimators import AUTO
from pdr_est.evaluate.consistency import radius95_m
from pdr_est.pipeline import DeviceWalk, SmoothedWalk
from pdr_est.report.walk.descriptions import (
    describe_choice,
    describe_directions,
    describe_frame,
    describe_length_scale,
)
from pdr_est.report.walk.mode_statistics import mode_statistics
from pdr_est.report.walk.places import describe_height, describe_places, describe_search, describe_walk_on_plans
from pdr_est.types.clock import utc_date
from pdr_est.types.ground_truth import Truth
from pdr_est.types.measurements import PositionFix, StartPose
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.track import Track

PACKAGES = ("pdr-est", "numpy", "scipy", "gtsam", "filterpy", "vqf")

Json = dict[str, Any]


def package_versions() -> dict[str, str | None]:
    """Look up the versions of Python, of this package and of the libraries that shape the numbers.

    None if not installed.
    """
    return {"python": platform.python_version()} | {name.replace("-", "_"): _version(name) for name in PACKAGES}


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def summarise(
    walk: SmoothedWalk,
    recording: Recording,
    config_dict: Mapping[str, Any],
    inputs: Mapping[str, str | None],
    versions: Mapping[str, str | None],
    *,
    start: StartPose | None = None,
    errors: Mapping[str, Any] | None = None,
    profile: Profile | None = None,
    gait_model_sha256: str | None = None,
) -> Json:
    """Summarise inputs, processing and results as JSON-serialisable data, with None for a number that is not known.

    Parameters
    ----------
    walk, recording : SmoothedWalk, Recording
        Finished walk and the recording that it was made from.
    config_dict : mapping
        Resolved configuration.
    inputs : mapping of str to str or None
        SHA-256 of each input file by its name.
    versions : mapping of str to str or None
        Result of `package_versions`.
    start : StartPose or None
        Start pose that was asked for. It decides, with the fixes, in which frame the track lies.
    errors, profile, gait_model_sha256 : optional
        Metrics against the truth by name; profile of the walker; digest of the gait model. None if there is none.
    """
    track = walk.track
    summary = {
        "recording": _recording(recording),
        "inputs": [{"name": name, "sha256": digest} for name, digest in inputs.items()],
        "estimator": track.estimator,
        "estimator_meaning": describe_choice(config_dict.get("estimator", {}).get("name", AUTO), track.estimator),
        "kind": track.kind,
        **_frame(walk, start),
        "duration_s": _duration_s(walk),
        "distance_m": track.of_device(track.devices[-1]).distance_m,  # the person's, who comes last
        "steps": _steps_of_person(walk),
        "counts": _counts(walk.devices),
        "carrying_modes": [use for device in walk.devices for use in mode_statistics(device)],
        "devices": [_device_track(track.of_device(name)) for name in track.devices],
        "headings": [_heading(device, config_dict) for device in walk.devices],
        "length_scale": _length_scale(walk, profile),
        "profile": None if profile is None else profile.to_dict(),
        "gait_model_sha256": gait_model_sha256,
        "start": start,
        "clocks": [_clock(device.device, device.clock) for device in walk.devices if device.clock is not None],
        **_known_places(walk, start),
        "gaps": [{"device": device.device} | asdict(gap) for device in walk.devices for gap in device.gaps],
        "errors_against_truth": errors,
        "timings_s": walk.timings_s,
        **_doubts(walk),
        "config": config_dict,
        "versions": versions,
    }
    document: Json = to_json(summary)
    return document


def to_json(value: Any) -> Any:
    """Convert a value to JSON types: records become objects, arrays lists, NaN and infinity None."""
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, np.ndarray):
        return to_json(value.tolist())
    if isinstance(value, np.generic):
        return to_json(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if is_dataclass(value) and not isinstance(value, type):
        return to_json(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [to_json(item) for item in value]
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, PurePath):
        return str(value)
    if value is None or isinstance(value, str | int):
        return value
    raise TypeError(f"summary: a {type(value).__name__} has no JSON form ({value!r}): convert it before")


def _known_places(walk: SmoothedWalk, start: StartPose | None) -> Json:
    on_plans = describe_walk_on_plans(walk)
    return {
        "fixes": _fixes(walk.fixes, walk.fixes_used, start),
        "height": describe_height(walk.track.height),
        "floor_plan": max(on_plans, key=lambda one: int(one["poses"]), default=None),
        "floor_plans": on_plans,
        "place_search": describe_search(walk.track),
    }


def _doubts(walk: SmoothedWalk) -> Json:
    """List what does not fit, and all warnings, which repeat the doubtful findings in words."""
    return {
        "findings": [asdict(finding) | {"kind": finding.kind.value} for finding in walk.track.findings],
        "warnings": list(dict.fromkeys(walk.warnings)),
    }


def _length_scale(walk: SmoothedWalk, profile: Profile | None) -> Json:
    """Describe the length scale of the track."""
    track = walk.track
    return {
        "value": track.length_scale,
        "sigma": track.sigma_length_scale,
        "meaning": describe_length_scale(track, bool(walk.fixes), profile is not None),
    }


def _recording(recording: Recording) -> Json:
    begin = None if recording.epoch_s is None else utc_date(recording.epoch_s)
    return {
        "name": recording.name,
        "format": recording.format,
        "time_zero": None if begin is None else begin.isoformat(timespec="milliseconds"),
        "origin": recording.origin,
        "notes": recording.notes,
        "truth": _truth(recording.truth),
        "devices": [_device(device) for device in recording.devices],
    }


def _device(device: DeviceRecording) -> Json:
    return {
        "name": device.name,
        "model": device.model,
        "platform": device.platform,
        "samples": {str(block.channel): len(block.time_s) for block in device.blocks()},
        "decisions": device.decisions,
        "warnings": device.warnings,
    }


def _truth(truth: Truth) -> Json:
    positions = truth.positions
    return {
        "positions": None if positions is None else {"count": len(positions.time_s), "source": positions.source},
        "step_count": truth.step_count,
        "distance_m": truth.distance_m,
        "activity": truth.activity,
    }


def _frame(walk: SmoothedWalk, start: StartPose | None) -> Json:
    """Name the frame, and describe it.

    "map" when position and direction are tied to the map, by a floor plan among others; "north-up" when the direction
    alone is, by the phone's knowledge of north; else "own".
    """
    places = _places(walk, start)
    smoothed = walk.track.kind != "filtered"
    north = bool(walk.devices) and all(one.knows_north(by_the_end=smoothed) for one in walk.devices)
    directed = north or (start is not None and start.heading_rad is not None)
    frame = "map" if walk.track.on_plan or len(places) >= (1 if directed else 2) else "north-up" if north else "own"
    return {"frame": frame, "frame_meaning": describe_frame(frame, bool(places))}


def _places(walk: SmoothedWalk, start: StartPose | None) -> set[tuple[float, ...]]:
    """Collect the different positions on the map that were given."""
    places = {tuple(fix.position_m.tolist()) for fix in walk.fixes}
    return places if start is None or start.position_m is None else {*places, start.position_m}


def _duration_s(walk: SmoothedWalk) -> float | None:
    """Compute the time from the first to the last sample of any device; from the track when no samples were kept."""
    blocks = [block for device in walk.devices for block in device.level if len(block)]
    begins = [float(block.time_s[0]) for block in blocks] or [float(t) for t in walk.track.time_s]
    ends = [float(block.time_s[-1]) for block in blocks] or [float(t) for t in walk.track.time_s]
    return max(ends) - min(begins) if begins else None


def _counts(devices: Sequence[DeviceWalk]) -> Json:
    return {
        "steps": {device.device: len(device.steps) for device in devices},
        "samples": {device.device: sum(len(block) for block in device.level) for device in devices},
        "dropped_samples": {device.device: device.dropped_samples for device in devices},
    }


def _clock(device: str, clock: ClockEstimate) -> Json:
    """Describe the offset of a device's clock from the first one's, and how well it is known.

    A poor one may be unused.
    """
    return {"device": device, "used": clock.used} | asdict(clock)


def _steps_of_person(walk: SmoothedWalk) -> int:
    """Count the steps of the only device, or the rows of the person's track after its start."""
    if len(walk.devices) == 1:
        return len(walk.devices[0].steps)
    return len(walk.track.of_device(walk.track.devices[-1])) - 1


def _device_track(track: Track) -> Json:
    radius = radius95_m(track.covariance_m2)
    known = radius[np.isfinite(radius)]
    return {
        "name": str(track.device[0]),
        "distance_m": track.distance_m,
        "start_position_m": track.position_m[0],
        "end_position_m": track.position_m[-1],
        "end_radius95_m": radius[-1],
        "largest_radius95_m": known.max() if len(known) else None,
        "places": None if track.region is None else describe_places(track.region),
    }


def _heading(device: DeviceWalk, config_dict: Mapping[str, Any]) -> Json:
    """Describe how headings were found; directions are None for a method that does not search them."""
    found = device.directions
    return {
        "device": device.device,
        "method": config_dict.get("heading", {}).get("method") if device.has_heading else None,
        "directions": None
        if found is None
        else {
            "number": found.number,
            "spacing_deg": math.degrees(found.spacing_rad),
            "log_odds": found.log_odds,
            "used": found.used,
        },
        "meaning": describe_directions(found),
    }


def _fixes(fixes: Sequence[PositionFix], used: bool, start: StartPose | None) -> Json:
    """Count the fixes and describe their use: as measurements of the track, or to find its start."""
    known = start is not None and start.position_m is not None and start.heading_rad is not None
    return {
        "given": len(fixes),
        "used": len(fixes) if used else 0,
        "aligned_with": 0 if used or known else len(fixes),
        "sources": dict(Counter(fix.source for fix in fixes)),
    }
