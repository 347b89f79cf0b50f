"""Learning from walks in Python: what is learnt, once for each walk, in any order, and from nothing nothing."""

from dataclasses import replace

import numpy as np
import pytest

import pdr_est
from pdr_est.calibration.learning import recording_digest
from pdr_est.calibration.step_length_fit import SIGMA_LOG_SCALE
from pdr_est.front_end.steps import StepsParams
from pdr_est.simulate import Scenario, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams


def stretched(corner_m: float, scale: float):
    """A walk round a corner, and a few of its true positions as fixes of somebody with longer steps."""
    path = PathParams(vertices_m=((0.0, 0.0), (corner_m, 0.0), (corner_m, 12.0)))
    recording = simulate_walk(Scenario(path=path)).recording
    truth = recording.truth.positions
    assert truth is not None
    at = np.linspace(0, len(truth.time_s) - 1, 6).astype(int)
    fixes = [pdr_est.PositionFix(float(truth.time_s[i]), scale * truth.position_m[i], np.eye(2) * 0.3**2) for i in at]
    return replace(recording, truth=type(recording.truth)()), fixes


@pytest.fixture(scope="module")
def walks():
    return [stretched(corner_m, 1.2) for corner_m in (14.0, 18.0)]


@pytest.fixture(scope="module")
def both(walks) -> pdr_est.Profile:
    (first, fixes), (second, more) = walks
    return pdr_est.learn(second, pdr_est.learn(first, fixes=fixes), more)


def test_walks_of_somebody_teach_the_next_one(walks, both) -> None:
    (first, fixes), _ = walks
    one = pdr_est.learn(first, fixes=fixes)
    assert 1.05 < one.walker.length_scale < both.walker.length_scale < 1.3
    assert both.sigma_length_scale < one.sigma_length_scale < SIGMA_LOG_SCALE
    config = pdr_est.apply_profile(pdr_est.Config(), both)
    recording, _ = stretched(10.0, 1.2)
    plain, own = pdr_est.smooth(recording), pdr_est.smooth(recording, config)
    assert own.distance_m == pytest.approx(both.walker.length_scale * plain.distance_m, rel=0.01)
    assert own.sigma_length_scale < plain.sigma_length_scale


def test_neither_order_nor_repetition_matters(walks, both) -> None:
    (first, fixes), (second, more) = walks
    assert pdr_est.learn(first, pdr_est.learn(second, fixes=more), fixes) == both
    assert pdr_est.learn(first, both, fixes) is both


def test_a_walk_is_recognised_by_its_samples(walks) -> None:
    (first, _), (second, _) = walks
    (device,) = first.devices
    renamed = replace(first, name="other", devices=(replace(device, name="phone"),))
    assert recording_digest(renamed) == recording_digest(first) != recording_digest(second)
    assert device.specific_force is not None
    force = replace(device.specific_force, values=device.specific_force.values * 1.0001)
    assert recording_digest(replace(first, devices=(replace(device, specific_force=force),))) != recording_digest(
        first
    )


def test_nothing_is_learnt_from_nothing(walks, both) -> None:
    recording, fixes = stretched(10.0, 1.2)
    assert pdr_est.learn(recording, both) is both
    assert pdr_est.learn(recording, both, fixes[:1]) is both
    closed = replace(pdr_est.Config(), start=replace(pdr_est.Config().start, closed=True))
    assert pdr_est.learn(recording, both, config=closed) is both


def test_a_known_length_teaches_too(both) -> None:
    recording, _ = stretched(10.0, 1.2)
    taught = pdr_est.learn(recording, distance_m=1.2 * 22.0)
    assert taught.walks[0].distance_m == pytest.approx(26.4)
    assert 1.0 < taught.walker.length_scale < 1.3
    with pytest.raises(pdr_est.RecordingError, match="a distance of -1 m"):
        pdr_est.learn(recording, distance_m=-1.0)


def test_a_profile_of_another_model_does_not_learn(walks, both) -> None:
    (first, fixes), _ = walks
    other = replace(pdr_est.Config(), steps=StepsParams(detector="local-variance"))
    with pytest.raises(pdr_est.ConfigError, match=r"made for steps\.detector = auto, but local-variance is set"):
        pdr_est.learn(first, both, fixes, config=other)
