"""How the walking time of a device divides among the carrying modes."""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode, Step


def durations_s(steps: Sequence[Step]) -> Array:
    """How long each step took, (n,)."""
    return np.array([step.event.time_s - step.start_s for step in steps])


def mode_shares(steps: Sequence[Step]) -> dict[CarryingMode, float]:
    """The share of the walking time that each mode of the steps has, 0 to 1, the longest first; NaN if the steps took
    no time."""
    time_s: dict[CarryingMode, float] = {}
    for step, duration_s in zip(steps, durations_s(steps).tolist(), strict=True):
        time_s[step.event.mode] = time_s.get(step.event.mode, 0.0) + duration_s
    total_s = sum(time_s.values())
    longest_first = sorted(time_s, key=lambda mode: (-time_s[mode], mode))
    return {mode: time_s[mode] / total_s if total_s > 0.0 else float("nan") for mode in longest_first}
