"""Samples, fixes and saved states that cannot be used are refused at once and leave the tracker as it was."""

import pickle
from typing import Any

import numpy as np
import pytest

from pdr_est.config import Config
from pdr_est.errors import EstimationError
from pdr_est.online import Tracker
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import Channel, SensorBlock

TIME_S, UP = np.array([0.0, 0.01]), np.tile([0.0, 0.0, 9.8], (2, 1))
FORCE = Channel.SPECIFIC_FORCE


def tracker() -> Tracker:
    return Tracker(Config().with_estimator("ekf"), ["phone"])


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (None, "samples of type NoneType: give a SensorBlock"),
        (SensorBlock("barometer", TIME_S, UP), "channel 'barometer': choose one of specific_force, "),
        (SensorBlock(FORCE, TIME_S, UP[:, :2]), r"shape \(2, 2\) at 2 times: give the shape \(2, 3\)"),
        (SensorBlock(FORCE, TIME_S[:1], UP), r"shape \(2, 3\) at 1 times: give the shape \(1, 3\)"),
        (SensorBlock(Channel.ATTITUDE, TIME_S, UP), r"attitude: values of shape \(2, 3\).*\(2, 4\)"),
        (SensorBlock(FORCE, TIME_S, UP[0]), r"values is an array of shape \(3,\) of float64: .* 2 dimensions"),
        (SensorBlock(FORCE, [0.0], UP[:1]), "time_s is a list: give an array of numbers of 1 dimension$"),
        (SensorBlock(FORCE, TIME_S, np.full((2, 3), "a")), "values is an array of .* of <U1"),
    ],
)
def test_samples_of_another_form_are_refused(block: Any, words: str) -> None:
    follower = tracker()
    with pytest.raises(EstimationError, match=words):
        follower.push("phone", block)
    assert follower.push("phone", SensorBlock(FORCE, TIME_S, UP)) == []
    assert follower.flush() == []


@pytest.mark.parametrize("name", [None, "", 3])
def test_a_device_needs_a_name(name: Any) -> None:
    follower = tracker()
    with pytest.raises(EstimationError, match="give it a name"):
        follower.push(name, SensorBlock(FORCE, TIME_S, UP))
    assert follower.devices == ("phone",)


def test_a_fix_needs_two_coordinates() -> None:
    with pytest.raises(EstimationError, match=r"position of shape \(3,\) .* give \(2,\) and \(2, 2\)"):
        tracker().push_fix(PositionFix(1.0, np.zeros(3), np.eye(2)))


@pytest.mark.parametrize("state", [b"", b"junk", pickle.dumps(3), b"cnowhere\nNothing\n."])
def test_a_state_that_is_none_is_refused(state: bytes) -> None:
    with pytest.raises(EstimationError, match="the state"):
        Tracker.restore(state)
    saved = tracker().state()
    with pytest.raises(EstimationError, match=r"give all bytes that Tracker\.state"):
        Tracker.restore(saved[: len(saved) // 2])
