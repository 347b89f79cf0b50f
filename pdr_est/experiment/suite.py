"""What a benchmark suite consists of. A new suite is one module that makes one `Suite`, and its line in `suites`."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.experiment.results.score_rows import Pool, no_confusion
from pdr_est.experiment.scoring.calibrated import CalibrationCase
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track


@dataclass(frozen=True)
class WalkFile:
    """One walk of a suite.

    name: path of its main recording relative to the suite's folder, without extensions. labels: further keys of its
    row, such as the position of the phone. group: the group that it is also averaged in. headline: whether it is
    averaged in the summary. truth: what the data set tells of the walk outside of its recording.
    """

    name: str
    path: Path
    labels: Mapping[str, str | None] = field(default_factory=dict)
    group: str | None = None
    headline: bool = True
    truth: Truth = field(default_factory=Truth)


@dataclass(frozen=True)
class Scores:
    """What a suite says of one track of a walk.

    track: the device's name, "device" where there is one only, or "fused". mode: recognised for most of the walking
    time. values: metrics by name; what is not finite counts as missing. counts: how many points stand behind them.
    missing: metric -> why it cannot be told for this walk. A metric of the suite that stands in neither, such as the
    false steps of somebody who walks, does not apply to this walk. predicted: how many steps got each label, where
    the suite sorts steps. calibration: for the metrics after a calibration on other walks.
    """

    track: str
    mode: str
    values: Mapping[str, float]
    counts: Mapping[str, int] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    predicted: Mapping[str, int] = field(default_factory=dict)
    calibration: CalibrationCase | None = None


class AnalysedWalk:
    """A recorded walk after the front end, ready for one estimator; adds up the CPU time that the chain takes.

    estimates: the tracks that were asked for so far, with the fixes that they were given. With the same fixes the
    estimator runs once.
    """

    def __init__(
        self, recording: Recording, devices: Sequence[DeviceWalk], config: Config, front_end_seconds: float = 0.0
    ) -> None:
        self.recording = recording
        self.devices = tuple(devices)
        self.seconds = front_end_seconds
        self.config = config
        self.estimates: list[tuple[tuple[PositionFix, ...], Track]] = []

    def span_of(self, name: str) -> tuple[float, float]:
        """Times of the first and the last sample that the front end could use: of the device of that name, of all
        devices for the person's track, which has no device of its own."""
        own = [device for device in self.devices if device.device == name] or self.devices
        begins_s, ends_s = zip(*(device.span_s for device in own), strict=True)
        return min(begins_s), max(ends_s)

    def track(self, fixes: Sequence[PositionFix] = ()) -> Track:
        """The estimator's track, given the sensors and these fixes only."""
        track = next((known for given, known in self.estimates if _same(given, fixes)), None)
        if track is None:
            started = time.process_time()
            track = pipeline.estimate(self.devices, self.config, fixes)
            self.seconds += time.process_time() - started
        self.estimates.append((tuple(fixes), track))
        return track


def _same(some: Sequence[PositionFix], others: Sequence[PositionFix]) -> bool:
    return len(some) == len(others) and all(
        one.time_s == other.time_s
        and np.array_equal(one.position_m, other.position_m)
        and np.array_equal(one.covariance_m2, other.covariance_m2)
        and (one.source, one.robust) == (other.source, other.robust)
        for one, other in zip(some, others, strict=True)
    )


@dataclass(frozen=True)
class Suite:
    """A benchmark suite, made of functions at module level so that it can be used in other processes.

    folder: name of its folder of walks, "." for the data folder itself. metrics: names, in the order of the table.
    find: the walks in that folder. prepare: what has to be changed in a recording before any stage sees it. score: a
    walk's scores, one for each track. calibrated_on: how many other walks a walk with a `CalibrationCase` is
    calibrated on for `calibrated`, the metrics among those that come from there. pool: the confusions of a suite that
    sorts steps into classes.
    """

    name: str
    folder: str
    metrics: tuple[str, ...]
    find: Callable[[Path], list[WalkFile]]
    prepare: Callable[[Recording], Recording]
    score: Callable[[AnalysedWalk], list[Scores]]
    calibrated_on: int = 0
    calibrated: tuple[str, ...] = ()
    pool: Pool = no_confusion


def as_recorded(recording: Recording) -> Recording:
    """`prepare` of a suite that changes nothing."""
    return recording
