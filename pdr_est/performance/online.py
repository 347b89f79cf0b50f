"""Latency of the tracker: two phones, every sample of every sensor pushed alone."""

import gc
import time
from collections.abc import Sequence

import numpy as np

from pdr_est.config import Config, StartParams
from pdr_est.estimators import SPECS
from pdr_est.frames import Array
from pdr_est.online import Tracker
from pdr_est.simulate import DeviceParams, PathParams, Scenario, SensorParams, WalkerGaitParams, simulate_walk
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import SensorBlock

ESTIMATORS = tuple(name for name, spec in SPECS.items() if spec.online)
RATE_HZ = 100.0
_SPEED_MPS, _ROUND_M = 1.2, 40.0
_CORNERS_M = ((0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0))
_WARM_UP = 0.1  # share of the samples: libraries are imported, and the window of the smoother fills

Pushed = tuple[str, SensorBlock]


def walk_in_rounds(minutes: float, rate_hz: float = RATE_HZ, seed: int = 1) -> Recording:
    """Simulate a person with two phones (accelerometer, gyroscope) who walks rounds of 40 m for about that time."""
    rounds = max(int(minutes * 60.0 * _SPEED_MPS / _ROUND_M), 1)
    return simulate_walk(
        Scenario(
            path=PathParams(vertices_m=_CORNERS_M * rounds),
            gait=WalkerGaitParams(lead_in_s=1.0, lead_out_s=1.0),
            devices=tuple(DeviceParams(name=name, sensors=SensorParams(rate_hz=rate_hz)) for name in ("a", "b")),
            seed=seed,
        )
    ).recording


def sample_by_sample(recording: Recording) -> list[Pushed]:
    """Return every sample as a block of its own, in the order of time."""
    samples = [
        (float(block.time_s[i]), device.name, _single_sample(block, i))
        for device in recording.devices
        for block in device.blocks()
        for i in range(len(block.time_s))
    ]
    return [(name, block) for _, name, block in sorted(samples, key=lambda sample: sample[0])]


def tracker_for(estimator: str) -> Tracker:
    """Make a tracker for the two phones, with a known start."""
    config = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0))
    return Tracker(config.with_estimator(estimator), ("a", "b"))


def push_times_s(tracker: Tracker, samples: Sequence[Pushed]) -> Array:
    """Measure the wall-clock time and the CPU time of each push, (n, 2), s."""
    times = np.empty((len(samples), 2))
    for i, (name, block) in enumerate(samples):
        begin = time.perf_counter(), time.thread_time()
        tracker.push(name, block)
        times[i] = time.perf_counter() - begin[0], time.thread_time() - begin[1]
    return times


def online_latency(minutes: float) -> dict[str, dict[str, float]]:
    """Measure one `Tracker.push` by estimator: p50, p99 and maximum, ms, of CPU and wall-clock time.

    Garbage collection counts. As in any program with little time for an answer, the objects that are there when the
    stream begins, here mostly the samples of the whole walk, are left out of it.
    """
    samples = sample_by_sample(walk_in_rounds(minutes))
    gc.collect()
    gc.freeze()
    found: dict[str, dict[str, float]] = {}
    for estimator in ESTIMATORS:
        times_ms = 1e3 * push_times_s(tracker_for(estimator), samples)
        warm = times_ms[int(_WARM_UP * len(times_ms)) :]
        found[estimator] = {
            "samples": float(len(warm)),
            **_quantiles("", warm[:, 1]),
            **_quantiles("clock_", warm[:, 0]),
        }
    gc.unfreeze()
    return found


def _quantiles(prefix: str, times_ms: Array) -> dict[str, float]:
    p50, p99 = np.percentile(times_ms, [50.0, 99.0])
    found = {"p50_ms": float(p50), "p99_ms": float(p99), "max_ms": float(times_ms.max())}
    return {prefix + name: value for name, value in found.items()}


def _single_sample(block: SensorBlock, i: int) -> SensorBlock:
    return SensorBlock(block.channel, block.time_s[i : i + 1], block.values[i : i + 1])
