"""Work of single samples: a push does one piece of it, and what is pending is not put off for long."""

import numpy as np
import pytest

from pdr_est.config import Config
from pdr_est.estimators.person.track import fuse, fuse_at_one_time
from pdr_est.front_end.mode import mode_stage
from pdr_est.front_end.steps import step_detector
from pdr_est.online import ExpectedDevice, Tracker, track_of
from pdr_est.parts import Parts
from pdr_est.performance.online import sample_by_sample, walk_in_rounds
from pdr_est.stage import Stage
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.track import Track

CALLS: list[str] = []


class Counted:
    """Stage that notes each call."""

    def __init__(self, name: str, stage: Stage) -> None:
        self.name, self.stage = name, stage
        self.latency_s = stage.latency_s

    def push(self, item: LevelBlock, /) -> list:
        CALLS.append(self.name)
        return self.stage.push(item)

    def flush(self) -> list:
        return self.stage.flush()


def counted_mode(rate_hz: float) -> Counted:
    return Counted("mode", mode_stage(rate_hz, Config().mode))


def counted_detector(rate_hz: float) -> Counted:
    return Counted("steps", step_detector(rate_hz, Config().steps))


@pytest.mark.slow
def test_a_push_that_levels_samples_does_nothing_else() -> None:
    parts = Parts(mode=counted_mode, step_detector=counted_detector)
    tracker = Tracker(Config(), [ExpectedDevice(name, own_attitude=False) for name in ("a", "b")], parts=parts)
    updates, pushes = [], []
    for name, block in sample_by_sample(walk_in_rounds(0.5))[:8000]:
        CALLS.clear()
        updates += tracker.push(name, block)
        pushes.append(tuple(CALLS))
    assert set(pushes) == {(), ("mode",), ("steps",)}
    assert len(track_of([one for one in updates if one.device == "a"])) > 10


@pytest.mark.parametrize("devices", [1, 2, 3])
def test_poses_at_one_time_are_fused_as_tracks_of_one_pose(devices: int) -> None:
    rng = np.random.default_rng(devices)
    poses = rng.normal(0.0, [5.0, 5.0, 3.0], (devices, 3))
    roots = rng.normal(0.0, 0.3, (devices, 3, 3))
    covariances = roots @ roots.transpose(0, 2, 1) + 1e-3 * np.eye(3)
    track = Track(
        time_s=np.full(devices, 4.0),
        moving_from_s=np.full(devices, 4.0),
        device=np.array([str(number) for number in range(devices)]),
        position_m=poses[:, :2],
        heading_rad=poses[:, 2],
        covariance_m2=covariances[:, :2, :2],
        sigma_heading_rad=np.sqrt(covariances[:, 2, 2]),
        mode=np.zeros(devices, dtype=np.int8),
        step_length_m=np.zeros(devices),
        kind="filtered",
        estimator="",
    )
    whole, (position_m, covariance_m2, heading_rad, sigma_rad) = fuse(track), fuse_at_one_time(poses, covariances)
    assert np.array_equal(whole.position_m[0], position_m)
    assert np.array_equal(whole.covariance_m2[0], covariance_m2)
    assert (float(whole.heading_rad[0]), float(whole.sigma_heading_rad[0])) == (heading_rad, sigma_rad)
