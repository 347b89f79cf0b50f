"""Tracks made by hand."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from pdr_est.types.track import Track

MakeTrack = Callable[..., Track]


@pytest.fixture
def make_track() -> MakeTrack:
    """Factory of a track through given places at given times, walking all the time, covariance variance_m2 * I."""

    def make(time_s: Sequence[float], position_m: Sequence[Sequence[float]], variance_m2: float = 1.0) -> Track:
        n = len(time_s)
        time = np.asarray(time_s, dtype=np.float64)
        return Track(
            time_s=time,
            moving_from_s=np.concatenate([time[:1], time[:-1]]),
            device=np.array(["device"] * n),
            position_m=np.asarray(position_m, dtype=np.float64),
            heading_rad=np.zeros(n),
            covariance_m2=np.tile(variance_m2 * np.eye(2), (n, 1, 1)),
            sigma_heading_rad=np.zeros(n),
            mode=np.ones(n, dtype=np.int8),
            step_length_m=np.zeros(n),
            kind="smoothed",
            estimator="by hand",
        )

    return make
