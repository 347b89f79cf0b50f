"""CPU time of each stage of the chain, on a simulated walk with two phones."""

import time
from collections.abc import Callable
from typing import Any, TypeVar

from pdr_est import pipeline
from pdr_est.clock_sync import align_device_clocks
from pdr_est.config import Config
from pdr_est.estimators import ESTIMATORS
from pdr_est.front_end.odometry import Odometry
from pdr_est.pipeline.front_end_chain import levelling, stepping, whole_walk_corrections
from pdr_est.simulate import simulate_walk
from pdr_est.simulate.people.population import PopulationParams, sample_population
from pdr_est.stage import Stage, run_through
from pdr_est.types.recording import Recording

RATE_HZ = 50.0

T = TypeVar("T")


def two_phones(minutes: float) -> Recording:
    """Simulate a walk with one phone in the hand and one in a pocket, at 50 Hz."""
    walk = PopulationParams(
        number=1, people=1, duration_s=60.0 * minutes, second_phone=("POCKET",), rate_hz=RATE_HZ, magnetometer=True
    )
    return simulate_walk(sample_population(walk)[0].scenario).recording


def stage_seconds(recording: Recording, minutes: float, config: Config) -> dict[str, float]:
    """Measure the CPU seconds per minute of the recording, both phones together.

    Returns
    -------
    dict
        Name of a stage or an estimator, or "clock" for clock synchronisation -> seconds.
    """
    spent: dict[str, float] = {}
    for device, _ in timed(spent, "clock", lambda: align_device_clocks(recording)):
        _, to_level = levelling(device, recording.name, config)
        corrections = whole_walk_corrections(config)
        stages: list[Stage] = [*to_level.stages, *stepping(config).stages, *corrections.stages]
        items: list[Any] = list(device.blocks())
        for stage in [*stages, Odometry(device.name, config.odometry)]:
            items = timed(spent, type(stage).__name__, lambda stage=stage, items=items: run_through(stage, items))  # type: ignore[misc]
    walks = pipeline.analyse_recording(recording, config)
    for name in ESTIMATORS:
        timed(spent, name, lambda name=name: pipeline.estimate_tracks(walks, config.with_estimator(name)))  # type: ignore[misc]
    return {name: seconds / minutes for name, seconds in spent.items()}


def timed(spent: dict[str, float], name: str, work: Callable[[], T]) -> T:
    """Return the result of some work, and add its CPU seconds to `spent[name]`."""
    begin = time.process_time()
    result = work()
    spent[name] = spent.get(name, 0.0) + time.process_time() - begin
    return result
