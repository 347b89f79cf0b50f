"""Times of steps and poses: all different, in order, and none before the first sample of its segment."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.front_end.steps import DETECTORS
from pdr_est.io import read
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import Recording, Signal

DEAD_RECKONING = Config().with_estimator("dead-reckoning")
BEGINS_S = np.arange(12.0, 12.6, 0.02)  # the walker is on the way: wherever in a step the recording begins
GAP_S = 0.8


@cache
def simulated() -> Recording:
    return simulate_walk(preset("l_shape")).recording


def with_gap(recording: Recording, from_s: float) -> Recording:
    """The recording of one device without the samples of a gap."""

    def cut(signal: Signal | None) -> Signal | None:
        if signal is None:
            return None
        kept = (signal.time_s < from_s) | (signal.time_s >= from_s + GAP_S)
        return Signal(signal.time_s[kept], signal.values[kept])

    (device,) = recording.devices
    names = ("specific_force", "rotation_rate", "magnetic_field", "attitude", "pressure")
    return replace(recording, devices=(replace(device, **{name: cut(getattr(device, name)) for name in names}),))


def assert_times_are_sound(recording: Recording, config: Config) -> None:
    (walk,) = pipeline.analyse_recording(recording, config)
    begins_s: dict[int, float] = {}
    for block in walk.level:
        begins_s.setdefault(block.segment, float(block.time_s[0]))
    assert len(walk.steps) > 3
    assert all(begins_s[step.event.segment] <= step.start_s < step.time_s for step in walk.steps)
    assert (np.diff([step.time_s for step in walk.steps]) > 0.0).all()
    track = pipeline.estimate_tracks([walk], config)
    assert track.time_s[0] >= walk.start_s
    assert (np.diff(track.time_s) > 0.0).all()


@pytest.mark.parametrize("detector", DETECTORS)
def test_wherever_in_a_step_the_recording_begins(detector: str) -> None:
    config = DEAD_RECKONING.replace({"steps.detector": detector})
    for begin_s in BEGINS_S[:: 1 if detector == "auto" else 5]:
        assert_times_are_sound(trim_recording(simulated(), float(begin_s), float(begin_s) + 6.0), config)


def way_m(recording: Recording, from_s: float, to_s: float) -> float:
    """Length of the steps between two times; a step across a border counts for its part."""
    (walk,) = pipeline.analyse_recording(recording, DEAD_RECKONING)
    start_s, end_s, length_m = np.array([(step.start_s, step.time_s, step.length_m) for step in walk.steps]).T
    within_s = np.minimum(end_s, to_s) - np.maximum(start_s, from_s)
    return float((length_m * np.clip(within_s / (end_s - start_s), 0.0, 1.0)).sum())


def test_a_recording_that_begins_within_a_step_gains_no_way() -> None:
    """The filters start in the middle of the movement, which must not look like a step."""
    for begin_s in BEGINS_S[::5]:
        to_s = float(begin_s) + 5.0
        whole_m = way_m(simulated(), float(begin_s), to_s)
        cut_m = way_m(trim_recording(simulated(), float(begin_s), to_s + 10.0), float(begin_s), to_s)
        assert whole_m - 0.7 < cut_m < whole_m + 0.2


def test_wherever_in_a_step_a_gap_ends() -> None:
    recording = trim_recording(simulated(), 8.0, 20.0)
    for from_s in BEGINS_S[::3]:
        assert_times_are_sound(with_gap(recording, float(from_s)), DEAD_RECKONING)


@pytest.mark.parametrize(
    "name", ["site1/F1/5dd9e7c4c5b77e0006b17335.txt.gz", "site2/F1/5dd61594d48f840006f14cf0.txt.gz"]
)
def test_recordings_that_begin_within_a_step(shared_data: Path, name: str) -> None:
    path = shared_data / "ilc20" / name
    if not path.is_file():
        pytest.skip(f"no {path}")
    assert_times_are_sound(read(path), DEAD_RECKONING)
