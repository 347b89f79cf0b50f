"""Small tracks of devices that walk east."""

import math

import numpy as np

from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track


def make_track(device_names: tuple[str, ...] = ("left",), count: int = 4) -> Track:
    """Devices one after the other; each walks east in steps of 0.7 m and turns 90 degrees in all."""
    n = count * len(device_names)
    number = np.tile(np.arange(count), len(device_names)).astype(float)
    row = np.repeat(np.arange(len(device_names)), count).astype(float)
    return Track(
        time_s=10.0 + 0.5 * number,
        moving_from_s=9.5 + 0.5 * number,
        device=np.repeat(device_names, count),
        position_m=np.column_stack([0.7 * number, row]),
        heading_rad=number * math.pi / 2 / max(count - 1, 1),
        covariance_m2=np.tile(0.04 * np.eye(2), (n, 1, 1)),
        sigma_heading_rad=np.full(n, 0.1),
        mode=np.full(n, CarryingMode.HOLDING, dtype=np.int8),
        step_length_m=np.where(number > 0, 0.7, 0.0),
        kind="smoothed",
        estimator="factor-graph",
    )
