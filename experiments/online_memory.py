"""Memory of the tracker over a day: two phones, one second of samples per push.

Run: python experiments/online_memory.py [--hours 24] [--estimator ekf] [--rate-hz 25] [-o FILE]
Repeats a simulated walk of ten minutes with times that go on, and gives its first position as a fix that comes five
seconds late. Writes, each hour, the memory of the process, the nodes that can be gone through again, the size of the
saved state, the updates so far and the processor time of the hour, to experiments/results/online_memory.txt.
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from pdr_est.online import Tracker
from pdr_est.performance.memory import resident_mb
from pdr_est.performance.online import ESTIMATORS, tracker_for, walk_in_rounds
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.sensors import SensorBlock

RESULT = Path(__file__).resolve().parent / "results" / "online_memory.txt"
MINUTES, FIX_LATE_S = 10.0, 5.0
TITLES = ("estimator", "hour", "memory_mb", "nodes", "state_kb", "updates", "cpu_s")


def seconds_of(device: DeviceRecording, length_s: int) -> list[list[SensorBlock]]:
    """Return the samples of a device, second by second."""
    found: list[list[SensorBlock]] = [[] for _ in range(length_s)]
    for block in device.blocks():
        borders = np.searchsorted(block.time_s, np.arange(length_s + 1.0))
        for second, begin, end in zip(found, borders[:-1], borders[1:], strict=True):
            if end > begin:
                second.append(SensorBlock(block.channel, block.time_s[begin:end], block.values[begin:end]))
    return found


def stream(recording: Recording, hours: float) -> Iterator[tuple[float, list[tuple[str, SensorBlock]], bool]]:
    """Yield for every second its time, the blocks, and if a repetition began FIX_LATE_S ago."""
    length_s = int(min(block.time_s[-1] for device in recording.devices for block in device.blocks()))
    cut = {device.name: seconds_of(device, length_s) for device in recording.devices}
    for now in range(int(hours * 3600.0)):
        begun_s, second = now - now % length_s, now % length_s
        blocks = [
            (name, SensorBlock(block.channel, block.time_s + begun_s, block.values))
            for name, seconds in cut.items()
            for block in seconds[second]
        ]
        yield float(now), blocks, second == int(FIX_LATE_S)


def hourly(tracker: Tracker, recording: Recording, hours: float) -> Iterator[tuple[float, ...]]:
    """Yield the numbers of TITLES without the estimator, after the first ten minutes and after every hour."""
    updates, begin_s = 0, time.process_time()
    for now_s, blocks, fix_is_due in stream(recording, hours):
        for name, block in blocks:
            updates += len(tracker.push(name, block))
        if fix_is_due:
            fix = PositionFix(now_s - FIX_LATE_S, np.zeros(2), np.eye(2))
            updates += len(tracker.push_fix(fix))
        passed = int(now_s) + 1
        if passed % 3600 == 0 or passed == 600:
            cpu_s, begin_s = time.process_time() - begin_s, time.process_time()
            saved_kb = len(tracker.state()) / 1024.0
            yield passed / 3600.0, resident_mb(), tracker.remembered, saved_kb, updates, cpu_s


def as_line(estimator: str, row: Sequence[float]) -> str:
    """Format a row."""
    hour, memory_mb, nodes, state_kb, updates, cpu_s = row
    return f"{estimator:>9} {hour:5.2f} {memory_mb:9.1f} {nodes:5.0f} {state_kb:8.1f} {updates:8.0f} {cpu_s:6.1f}"


def main() -> None:
    """Measure, print and write the rows."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--estimator", choices=("all", *ESTIMATORS), default="all")
    parser.add_argument("--rate-hz", type=float, default=25.0, help="of the phones' sensors")
    parser.add_argument("-o", "--output", type=Path, default=RESULT)
    arguments = parser.parse_args()
    recording = walk_in_rounds(MINUTES, arguments.rate_hz)
    lines = [f"two phones at {arguments.rate_hz:g} Hz, one-second blocks", "  ".join(TITLES)]
    for estimator in ESTIMATORS if arguments.estimator == "all" else (arguments.estimator,):
        for row in hourly(tracker_for(estimator), recording, arguments.hours):
            lines.append(as_line(estimator, row))
            print(lines[-1], flush=True)
            arguments.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
