"""The order in which the devices and tethers of a walk are given makes no difference beyond rounding."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from pdr_est.config import Config
from pdr_est.estimators import ESTIMATORS, EstimatorName, estimate_walk
from pdr_est.frames import wrap_angle
from pdr_est.performance.odometry import walk_of
from pdr_est.pipeline.estimation import with_person
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, HeadingPrior, PositionFix, StartPose
from pdr_est.types.track import Track

NAMES = ("phone1", "phone2", "phone3")


def walk(fixes: bool) -> tuple[list[DeviceMeasurements], list[DeviceTether]]:
    """Three devices, each with heading priors relative to its own reference, all tethered to each other."""
    rng = np.random.default_rng(4)
    devices, _ = walk_of(40, 3, seed=2)
    given = (
        [PositionFix(4.0 * k, np.array([2.5 * k, 0.3]), np.eye(2), source="gps") for k in range(6)] if fixes else []
    )
    priors = {
        name: [
            HeadingPrior(name, 0.55 * k, 0.1 * float(rng.standard_normal()), 0.1, relative=True) for k in (5, 15, 30)
        ]
        for name in NAMES
    }
    measured = [replace(one, measurements=(*one.measurements, *priors[one.device], *given)) for one in devices]
    pairs = (("phone1", "phone2"), ("phone1", "phone3"), ("phone2", "phone3"))
    return measured, [DeviceTether(a, b, float(t), 0.4, 0.02) for t in np.arange(2.0, 20.0, 4.0) for a, b in pairs]


def estimate(name: EstimatorName, order: tuple[int, ...], fixes: bool, start: StartPose) -> Track:
    devices, tethers = walk(fixes)
    turned = [replace(one, device_a=one.device_b, device_b=one.device_a) for one in tethers[::-1]]
    own = tethers if order == (0, 1, 2) else turned
    return with_person(estimate_walk(name, [devices[i] for i in order], start, 0.1, own), Config())


QUICK = ("dead-reckoning", "ekf")


@pytest.mark.parametrize("start", [StartPose(), StartPose((1.0, 2.0), 0.3, 0.1, 0.1)], ids=["unplaced", "placed"])
@pytest.mark.parametrize("fixes", [False, True])
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in ESTIMATORS]
)
def test_it_makes_no_difference(name: EstimatorName, fixes: bool, start: StartPose) -> None:
    expected = estimate(name, (0, 1, 2), fixes, start)
    for order in list(permutations(range(3)))[1:]:
        track = estimate(name, order, fixes, start)
        assert track.devices == (*(NAMES[i] for i in order), "fused")
        assert track.length_scale == pytest.approx(expected.length_scale)
        for device in expected.devices:
            own, other = expected.of_device(device), track.of_device(device)
            assert other.position_m == pytest.approx(own.position_m, abs=1e-6)
            assert wrap_angle(other.heading_rad - own.heading_rad) == pytest.approx(np.zeros(len(own)), abs=1e-7)
            assert other.covariance_m2 == pytest.approx(own.covariance_m2, rel=1e-6, abs=1e-9)
