"""CPU time from recording to track, as a multiple of what simple chains take in the same run."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from statistics import median
from typing import Any

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.estimators import ESTIMATORS
from pdr_est.performance.stages import RATE_HZ, two_phones
from pdr_est.performance.yardsticks import inertial_arrays, textbook_track, vqf_attitude
from pdr_est.types.recording import Recording

VQF_ALONE, TEXTBOOK_CHAIN = "VQF alone", "textbook chain"
_ROUNDS = 5  # measurements of each chain, of which the median counts


def whole_chain_cost(minutes: float, config: Config) -> list[dict[str, Any]]:
    """Measure the yardsticks and every estimator, front end included, on a simulated walk with one and two phones.

    Parameters
    ----------
    minutes : float
        Length of the walk.
    config : Config
        Settings of the chain.

    Returns
    -------
    list of dict
        devices, chain, seconds_per_minute (CPU), over_textbook and over_vqf (multiples of the yardsticks).
    """
    recording = two_phones(minutes)
    rows: list[dict[str, Any]] = []
    for devices in (1, 2):
        walk = replace(recording, devices=recording.devices[:devices])
        seconds = median_cpu_seconds(_chains(walk, config), _ROUNDS)
        rows += [
            {
                "devices": devices,
                "chain": name,
                "seconds_per_minute": spent / minutes,
                "over_textbook": spent / seconds[TEXTBOOK_CHAIN],
                "over_vqf": spent / seconds[VQF_ALONE],
            }
            for name, spent in seconds.items()
        ]
    return rows


def median_cpu_seconds(chains: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Run chains in turn, once to warm up and then `rounds` times, and return the median CPU time of each, s."""
    spent: dict[str, list[float]] = {name: [] for name in chains}
    for number in range(rounds + 1):
        for name, run in chains.items():
            begin = time.process_time()
            run()
            if number:
                spent[name].append(time.process_time() - begin)
    return {name: median(seconds) for name, seconds in spent.items()}


def _chains(recording: Recording, config: Config) -> dict[str, Callable[[], object]]:
    arrays = [inertial_arrays(device, RATE_HZ) for device in recording.devices]

    def smooth(estimator: str) -> object:
        own = config.with_estimator(estimator)
        by_the_end = own.estimator.make().spec.smooths  # a filter needs no more than the steps so far, as in `smooth`
        return pipeline.estimate_tracks(pipeline.analyse_recording(recording, own, at_the_end=by_the_end), own)

    return {
        VQF_ALONE: lambda: [vqf_attitude(samples) for samples in arrays],
        TEXTBOOK_CHAIN: lambda: [textbook_track(samples) for samples in arrays],
        **{name: lambda name=name: smooth(name) for name in ESTIMATORS},  # type: ignore[misc]
    }
