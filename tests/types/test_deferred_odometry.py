"""Measurements that are computed when they are first looked at."""

import pickle
from functools import partial

from pdr_est.performance.odometry import walk_of
from pdr_est.types.analysis import DeferredOdometry
from pdr_est.types.measurements import StepOdometry

STEPS = tuple(one for one in walk_of(5)[0][0].measurements if isinstance(one, StepOdometry))


def taken_from(source: list[StepOdometry]) -> list[StepOdometry]:
    found = source.copy()
    source.clear()
    return found


def test_they_are_computed_once_and_not_before() -> None:
    source = list(STEPS)
    deferred = DeferredOdometry(partial(taken_from, source))
    assert len(source) == 5
    assert tuple(deferred) == STEPS
    assert not source
    assert len(deferred) == 5
    assert (deferred[-1], deferred[:2]) == (STEPS[-1], STEPS[:2])


def test_they_can_be_pickled_before_and_after() -> None:
    deferred = DeferredOdometry(partial(taken_from, list(STEPS)))
    for _ in range(2):
        copy = pickle.loads(pickle.dumps(deferred))
        assert [one.time_s for one in copy] == [one.time_s for one in STEPS]
        assert len(deferred) == 5
