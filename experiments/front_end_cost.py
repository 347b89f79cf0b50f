"""CPU time of mode recognition and step detection on a simulated walk with changing modes.

Microseconds of this thread's CPU time a sample in long blocks, and a push at one sample a push, the best of some
repetitions. Run alone on the machine; the numbers are its own.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pdr_est.config import Config
from pdr_est.frames import Array
from pdr_est.front_end.mode import ModeParams, mode_stage
from pdr_est.front_end.signal.blocks import join, part
from pdr_est.front_end.steps import step_detector
from pdr_est.pipeline.front_end_chain import levelling
from pdr_est.simulate import mmpdr_mode_walks, simulate_walk
from pdr_est.stage import Chain
from pdr_est.types.sensors import LevelBlock

RESULT = Path(__file__).parent / "results" / "front_end_cost.txt"
REPETITIONS = 4


def level_samples(config: Config) -> LevelBlock:
    """Simulate the leveled samples of a walk whose modes are not recognised yet."""
    walk = simulate_walk(mmpdr_mode_walks(3, 0)[1])
    device = walk.recording.devices[0]
    _, to_level = levelling(device, "simulated", replace(config, mode=ModeParams(method="fixed")))
    blocks = [block for item in device.blocks() for block in to_level.push(item)] + to_level.flush()
    return join(blocks)


def push_times_us(config: Config, blocks: Sequence[LevelBlock]) -> Array:
    """Measure the shortest time of each push, (n,), microseconds."""
    rate_hz = config.resample.rate_hz
    times_ns = np.empty((REPETITIONS, len(blocks)))
    for row in times_ns:
        chain = Chain([mode_stage(rate_hz, config.mode), step_detector(rate_hz, config.steps)])
        for number, block in enumerate(blocks):
            begin = time.thread_time_ns()
            chain.push(block)
            row[number] = time.thread_time_ns() - begin
    best: Array = times_ns.min(axis=0) / 1e3
    return best


def cut(samples: LevelBlock, count: int) -> list[LevelBlock]:
    """Cut samples into blocks of `count`."""
    return [part(samples, i, min(i + count, len(samples))) for i in range(0, len(samples), count)]


def main() -> None:
    """Measure, and write results/front_end_cost.txt."""
    config = Config()
    samples = level_samples(config)
    lines = [f"mode and step detection of {len(samples)} samples at {config.resample.rate_hz:g} Hz", ""]
    for name, seconds in (("10 s blocks", 10.0), ("30 s blocks", 30.0), ("the whole walk", np.inf)):
        count = int(min(seconds * config.resample.rate_hz, len(samples)))
        total_us = push_times_us(config, cut(samples, count)).sum()
        lines.append(f"{name:<16}{total_us / len(samples):6.2f} us a sample")
    median_us, late_us = np.percentile(push_times_us(config, cut(samples, 1)), [50.0, 99.0])
    lines.append(
        f"{'single samples':<16}{median_us:6.0f} us a push in the median, {late_us:.0f} us at the 99th percentile"
    )
    RESULT.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(RESULT.read_text(encoding="utf-8"), end="")


if __name__ == "__main__":
    main()
