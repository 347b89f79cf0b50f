"""Assembly of the scores of a track from groups of metrics."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.evaluate.carrying_modes import mode_shares, step_durations_s
from pdr_est.evaluate.position_errors import mode_accuracy
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.suite import CalibrationCase, TrackScores
from pdr_est.frames import Array
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import TrueModes, Truth
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

MODE_METRIC = "mode_accuracy"


@dataclass(frozen=True)
class MetricPart:
    """A group of metrics of one track, such as those of its steps.

    Attributes
    ----------
    values, counts, missing, predicted, calibration
        As in `suite.TrackScores`.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    predicted: Mapping[str, int] = field(default_factory=dict)
    calibration: CalibrationCase | None = None


def missing_without_north(walk: AnalysedWalk, metrics: Sequence[str]) -> MetricPart | None:
    """Return metrics as missing, with the reason, if no device of a walk knows north; None if one does."""
    if any(device.knows_north() for device in walk.devices):
        return None
    return MetricPart(missing=dict.fromkeys(metrics, "no device of the walk knows north"))


def device_scores(walk: AnalysedWalk, device: DeviceWalk, *parts: MetricPart) -> TrackScores:
    """Assemble the scores of a device."""
    name = device.device if len(walk.devices) > 1 else "device"
    return track_scores(name, _main_mode(device), *parts)


def score_tracks(
    walk: AnalysedWalk, parts: Callable[[str, Array, Track], Sequence[MetricPart]], with_modes: bool = True
) -> list[TrackScores]:
    """Score the track of each device, and of the person who carries several, from the sensors alone.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    parts : Callable
        Computes the metrics of one track from its name (a device or "fused"), the times (n,) of its steps, s, and the
        track of all devices.
    with_modes : bool
        True if each device also gets `mode_accuracy`.
    """
    track = walk.track()
    scores = []
    for device in walk.devices:
        own = parts(device.device, step_times_s(device), track)
        scores.append(device_scores(walk, device, *own, *([mode_part(walk, device)] if with_modes else [])))
    if FUSED in track.devices:
        own = parts(FUSED, track.of_device(FUSED).time_s[1:], track)
        scores.append(track_scores(FUSED, _main_mode(walk.devices[0]), *own))  # the mode is that of the first device
    return scores


def track_scores(track: str, mode: str, *parts: MetricPart) -> TrackScores:
    """Assemble the scores of the track of that name, which was carried in that mode most of the time."""
    return TrackScores(
        track=track,
        mode=mode,
        values={name: value for part in parts for name, value in part.values.items()},
        counts={name: count for part in parts for name, count in part.counts.items()},
        missing={name: reason for part in parts for name, reason in part.missing.items()},
        predicted={label: steps for part in parts for label, steps in part.predicted.items()},
        calibration=next((part.calibration for part in parts if part.calibration is not None), None),
    )


def _main_mode(device: DeviceWalk) -> str:
    return next(iter(mode_shares(device.steps)), CarryingMode.UNKNOWN).name


def step_times_s(device: DeviceWalk) -> Array:
    """Return the times (n,), s, of the steps that a device detected."""
    return np.array([step.event.time_s for step in device.steps])


def mode_part(walk: AnalysedWalk, device: DeviceWalk) -> MetricPart:
    """Compute `mode_accuracy`; it is missing if the true modes are not known or no step was found."""
    truth = walk.recording.truth.modes
    if truth is None:
        return MetricPart(missing={MODE_METRIC: "the true mode is not known"})
    if not device.steps:
        return MetricPart(missing={MODE_METRIC: "no step found"})
    labels = [step.event.mode for step in device.steps]
    true_modes = truth.at(step_times_s(device))
    return MetricPart({MODE_METRIC: mode_accuracy(step_durations_s(device.steps), labels, true_modes)})


def mode_truth(mode: CarryingMode) -> Truth:
    """Make the ground truth of a walk whose phone was carried in one mode all the time."""
    return Truth(modes=TrueModes(start_s=np.array([-np.inf]), mode=np.array([mode], dtype=np.int8)))
