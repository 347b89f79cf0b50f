"""What the suites say of one track of a walk, put together from parts: each metric family makes one."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.evaluate import position_errors as metrics
from pdr_est.evaluate.carrying_modes import durations_s, mode_shares
from pdr_est.experiment.suite import AnalysedWalk, Scores
from pdr_est.frames import Array
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import TrueModes, Truth
from pdr_est.types.steps import CarryingMode

MODE_METRIC = "mode_accuracy"


@dataclass(frozen=True)
class MetricPart:
    """Some metrics of a device; the fields are those of `suite.Scores`."""

    values: Mapping[str, float] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    predicted: Mapping[str, int] = field(default_factory=dict)


def device_scores(walk: AnalysedWalk, device: DeviceWalk, *parts: MetricPart) -> Scores:
    """The scores of a device, from its parts."""
    name = device.device if len(walk.devices) > 1 else "device"
    return track_scores(name, _mode_of(device), *parts)


def person_scores(walk: AnalysedWalk, *parts: MetricPart) -> Scores:
    """The scores of the person who carries several devices, from their parts; the mode is that of the first one."""
    return track_scores(FUSED, _mode_of(walk.devices[0]), *parts)


def _mode_of(device: DeviceWalk) -> str:
    return next(iter(mode_shares(device.steps)), CarryingMode.UNKNOWN).name


def step_times_s(device: DeviceWalk) -> Array:
    """When a device saw steps, (n,)."""
    return np.array([step.event.time_s for step in device.steps])


def track_scores(track: str, mode: str, *parts: MetricPart) -> Scores:
    """The scores of a track of that name, carried mostly in that mode, from its parts."""
    return Scores(
        track=track,
        mode=mode,
        values={name: value for part in parts for name, value in part.values.items()},
        counts={name: count for part in parts for name, count in part.counts.items()},
        missing={name: reason for part in parts for name, reason in part.missing.items()},
        predicted={label: steps for part in parts for label, steps in part.predicted.items()},
    )


def mode_part(walk: AnalysedWalk, device: DeviceWalk) -> MetricPart:
    """`mode_accuracy` against the walk's true modes; missing when they are not known or no step was found."""
    truth = walk.recording.truth.modes
    if truth is None:
        return MetricPart(missing={MODE_METRIC: "the true mode is not known"})
    if not device.steps:
        return MetricPart(missing={MODE_METRIC: "no step found"})
    labels = [step.event.mode for step in device.steps]
    true_modes = truth.at(step_times_s(device))
    return MetricPart({MODE_METRIC: metrics.mode_accuracy(durations_s(device.steps), labels, true_modes)})


def mode_truth(mode: CarryingMode) -> Truth:
    """What is known of a walk whose phone was carried in one mode all the time."""
    return Truth(modes=TrueModes(start_s=np.array([-np.inf]), mode=np.array([mode], dtype=np.int8)))
