"""The suite `speed` measures all its parts, and what it compares is comparable."""

import io

import numpy as np
import pytest
from rich.console import Console

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.estimators import ESTIMATORS, estimate_walk
from pdr_est.performance import print_speed, run_speed
from pdr_est.performance.growth import growth
from pdr_est.performance.odometry import START, walk_of
from pdr_est.performance.smoothing import smoothing_seconds
from pdr_est.performance.stages import RATE_HZ, two_phones
from pdr_est.performance.whole_chain import TEXTBOOK_CHAIN, VQF_ALONE
from pdr_est.performance.yardsticks import inertial_arrays, textbook_track


@pytest.mark.slow
def test_every_part_is_measured() -> None:
    calls = []
    result = run_speed(
        Config(),
        lengths_min=(1.0,),
        on_progress=lambda *at: calls.append(at),
        chain_min=0.5,
        recorded_min=0.5,
        smoothed_steps=(50,),
        online_min=0.5,
    )
    assert calls[-1] == (7, 7)
    document = result.to_dict()
    assert [(row["devices"], row["chain"]) for row in document["chains"]] == [
        (devices, name) for devices in (1, 2) for name in (VQF_ALONE, TEXTBOOK_CHAIN, *ESTIMATORS)
    ]
    assert all(row["over_textbook"] == 1.0 for row in document["chains"] if row["chain"] == TEXTBOOK_CHAIN)
    assert all(row["over_vqf"] >= 1.0 for row in document["chains"] if row["chain"] in ESTIMATORS)
    assert {"clock", "Resampler", "VqfAttitude", "Odometry", *ESTIMATORS} <= document[
        "stage_seconds_per_minute"
    ].keys()
    assert all(seconds >= 0.0 for seconds in document["stage_seconds_per_minute"].values())
    assert [(row["devices"], row["steps"]) for row in document["smoothing"]] == [(1, 50), (2, 50)]
    assert [(row["devices"], row["steps"]) for row in document["growth"]] == [(1, 109.0), (2, 218.0)]
    assert list(document["online"]) == ["ekf", "fixed-lag", "particle"]
    for found in document["online"].values():
        assert found["samples"] > 5000
        assert 0.0 < found["p50_ms"] < found["p99_ms"] < found["max_ms"]
    words = io.StringIO()
    print_speed(result, Console(file=words, width=160))
    assert "fixed-lag" in words.getvalue().split("online, ms")[1]
    (resampler,) = [line for line in words.getvalue().splitlines() if "Resampler" in line]
    seconds = next(row["seconds_per_minute"] for row in document["chains"][::-1] if row["chain"] == TEXTBOOK_CHAIN)
    told = float(resampler.split("│")[2])
    assert told == pytest.approx(document["stage_seconds_per_minute"]["Resampler"] / seconds, abs=0.006)


def test_the_textbook_chain_walks_the_way_that_it_is_timed_for() -> None:
    """A yardstick that found no steps would be fast for nothing."""
    recording = two_phones(2.0)
    walks = pipeline.analyse_recording(recording, Config())
    truth = pipeline.estimate_tracks(walks, Config()).of_device(recording.devices[0].name)
    track_m = textbook_track(inertial_arrays(recording.devices[0], RATE_HZ))
    assert len(track_m) == pytest.approx(len(truth.time_s), rel=0.1)
    way_m = np.linalg.norm(np.diff(track_m, axis=0), axis=1).sum()
    assert way_m == pytest.approx(np.linalg.norm(np.diff(truth.position_m, axis=0), axis=1).sum(), rel=0.3)


@pytest.mark.slow
def test_a_longer_walk_takes_more_memory() -> None:
    """What a process needs must not hide behind what its parent has."""
    taken = np.ones(80 * 2**17)  # 80 MB
    short, long = growth(5.0, 1), growth(240.0, 1)
    assert len(taken)
    assert long["memory_mb"] > max(short["memory_mb"], 0.0) + 10.0
    assert long["peak_mb"] > long["memory_mb"] + 30.0


@pytest.mark.slow
@pytest.mark.parametrize(("steps", "devices"), [(1_000, 1), (300, 2)])
def test_smoothing_is_hardly_slower_than_bare_gtsam(steps: int, devices: int) -> None:
    """The best of some tries: the machine may be busy."""
    assert min(smoothing_seconds(steps, devices)["ratio"] for _ in range(3)) < 1.25


def test_tethers_hold_where_the_tracks_of_the_devices_would_part() -> None:
    known, tethers = walk_of(300, 2)
    alone = estimate_walk("factor-graph", known, START, 0.11)
    together = estimate_walk("factor-graph", known, START, 0.11, tethers)
    at_s = np.array([tether.time_s for tether in tethers])

    def apart_m(track: object) -> float:
        one, two = (track.of_device(name).at(at_s)[0] for name in ("phone1", "phone2"))  # type: ignore[attr-defined]
        return float(np.linalg.norm(one - two, axis=1).max())

    assert apart_m(alone) > 3.0
    assert apart_m(together) < 1.1 * 0.5
