"""How long the tracker takes a sample: two phones at 100 Hz, every sample of every sensor pushed by itself.

Run: python experiments/online_latency.py [--estimator fixed-lag] [--minutes 2]
Prints p50, p99 and maximum of the time of one `Tracker.push`, in milliseconds: by the clock, which counts what else
the machine does, and of the processor.
"""

import argparse
import time

import numpy as np

from pdr_est.config import Config, StartParams
from pdr_est.io.recording import Recording
from pdr_est.online import Tracker
from pdr_est.records import SensorBlock
from pdr_est.simulate import DeviceParams, GaitParams, PathParams, Scenario, SensorParams, simulate_walk

RATE_HZ = 100.0
SPEED_MPS = 1.2


def two_phones(minutes: float) -> Recording:
    """Rounds of forty metres."""
    rounds = max(int(minutes * 60.0 * SPEED_MPS / 40.0), 1)
    corners = ((0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0))
    return simulate_walk(
        Scenario(
            path=PathParams(vertices_m=corners * rounds),
            gait=GaitParams(lead_in_s=1.0, lead_out_s=1.0),
            devices=tuple(DeviceParams(name=name, sensors=SensorParams(rate_hz=RATE_HZ)) for name in ("a", "b")),
            seed=1,
        )
    ).recording


def sample_by_sample(recording: Recording) -> list[tuple[str, SensorBlock]]:
    """Every sample as a block of its own, in the order of time."""
    samples = [
        (
            float(block.time_s[i]),
            device.name,
            SensorBlock(block.channel, block.time_s[i : i + 1], block.values[i : i + 1]),
        )
        for device in recording.devices
        for block in device.blocks()
        for i in range(len(block.time_s))
    ]
    return [(name, block) for _, name, block in sorted(samples, key=lambda sample: sample[0])]


def push_times_s(tracker: Tracker, samples: list[tuple[str, SensorBlock]]) -> np.ndarray:
    """By the clock and of the processor, (n, 2)."""
    times = np.empty((len(samples), 2))
    for i, (name, block) in enumerate(samples):
        begin = time.perf_counter(), time.thread_time()
        tracker.push(name, block)
        times[i] = time.perf_counter() - begin[0], time.thread_time() - begin[1]
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--estimator", choices=("ekf", "fixed-lag"), default="ekf")
    parser.add_argument("--minutes", type=float, default=2.0)
    arguments = parser.parse_args()
    config = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0)).with_estimator(arguments.estimator)
    samples = sample_by_sample(two_phones(arguments.minutes))
    times_ms = 1e3 * push_times_s(Tracker(config, ("a", "b")), samples)
    warm = times_ms[len(times_ms) // 10 :]  # libraries load at the beginning
    print(f"{arguments.estimator}: {len(warm)} samples")
    for name, column in zip(("clock", "processor"), warm.T, strict=True):
        p50, p99 = np.percentile(column, [50, 99])
        print(f"{name:>10}: p50 {p50:.3f} ms, p99 {p99:.3f} ms, max {column.max():.1f} ms")


if __name__ == "__main__":
    main()
