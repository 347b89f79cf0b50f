"""Learning from walks in Python: what is learnt, once for each walk, in any order, and from nothing nothing."""

from dataclasses import replace

import numpy as np
import pytest

import pdr_est
from pdr_est.calibration.learning import device_digests, recording_digest
from pdr_est.calibration.step_length_fit import SIGMA_LOG_SCALE
from pdr_est.front_end.steps import StepsParams
from pdr_est.simulate import Scenario, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.recording import Signal


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
    air = Signal(device.specific_force.time_s[::10], np.full((len(device.specific_force.time_s[::10]), 1), 101_325.0))
    with_pressure = replace(first, devices=(replace(device, pressure=air),))
    assert recording_digest(with_pressure) == recording_digest(first)  # as in profiles of before it was read


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


def with_a_hole(recording, share: float):
    """The recording without the samples of a part of its time, from the middle on."""
    begin_s, end_s = recording.devices[0].span_s
    middle_s = 0.5 * (begin_s + end_s)
    until_s = middle_s + share * (end_s - begin_s)

    def kept(signal):
        inside = (signal.time_s < middle_s) | (signal.time_s > until_s)
        return Signal(signal.time_s[inside], signal.values[inside])

    devices = tuple(
        replace(one, specific_force=kept(one.specific_force), rotation_rate=kept(one.rotation_rate))
        for one in recording.devices
    )
    return replace(recording, devices=devices)


def test_a_distance_tells_less_of_a_recording_with_a_gap() -> None:
    recording, _ = stretched(18.0, 1.0)
    whole = pdr_est.learn(recording, distance_m=30.0).walks[0]
    cut = pdr_est.learn(with_a_hole(recording, 0.2), distance_m=30.0).walks[0]
    assert whole.sigma == 0.0
    assert -np.log(0.8) / np.sqrt(12.0) < cut.sigma < 0.12
    assert abs(cut.log_ratio - whole.log_ratio) < 2.0 * cut.sigma


def test_a_mostly_missing_recording_does_not_learn_from_a_distance() -> None:
    recording, _ = stretched(18.0, 1.0)
    words = r"nothing learnt: up to \d\d % of the way lie in its gaps, .* give a recording without gaps, or --fixes"
    with pytest.warns(UserWarning, match=words):
        assert pdr_est.learn(with_a_hole(recording, 0.48), distance_m=25.0).walks == ()


def test_fixes_that_disagree_are_told_and_not_learnt(walks, both) -> None:
    (first, fixes), _ = walks
    sides = (np.array([9.0, -7.0]), np.array([-8.0, 9.0]))
    wrong = [replace(fix, position_m=fix.position_m + sides[number % 2]) for number, fix in enumerate(fixes)]
    with pytest.warns(UserWarning, match="nothing learnt: its fixes disagree with its steps or with each other"):
        assert pdr_est.learn(first, both, wrong) is both


def test_a_pair_and_one_phone_of_it_are_one_walk(walks) -> None:
    (first, fixes), (second, _) = walks
    other = replace(second.devices[0], name="other")
    pair = replace(first, devices=(first.devices[0], other))
    assert set(device_digests(pair)) == {recording_digest(first), recording_digest(second)}
    alone = pdr_est.learn(first, fixes=fixes)
    record = replace(alone.walks[0], sha256=recording_digest(pair), devices=device_digests(pair))
    assert pdr_est.learn(first, replace(alone, walks=(record,)), fixes) == alone
