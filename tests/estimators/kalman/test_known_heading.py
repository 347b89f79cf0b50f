"""The filter of walks whose headings are known throughout gives the numbers of the general filter."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import timelines_of
from pdr_est.estimators.kalman.known_heading import known_headings
from pdr_est.estimators.kalman.offline_filter import filter_walk
from pdr_est.estimators.kalman.rts_smoother import smooth_walk
from pdr_est.performance.odometry import SIGMA_SCALE, STEP_S, walk_of
from pdr_est.types.measurements import DeviceMeasurements, HeadingPrior, PositionFix, StartPose

START = StartPose((1.0, 2.0), 0.3, 0.1, 0.1)


def two_devices() -> tuple[list[DeviceMeasurements], list]:
    known, tethers = walk_of(80, 2)
    priors = tuple(
        HeadingPrior("phone1", k * STEP_S, 0.1 * k, 0.2, relative=True, robust=k == 20) for k in range(0, 60, 5)
    )
    return [replace(known[0], measurements=(*known[0].measurements, *priors)), known[1]], tethers


def test_filtered_and_smoothed_states_are_those_of_the_general_filter() -> None:
    known, tethers = two_devices()
    timelines = timelines_of(known, tethers)
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, START)
    found = known_headings(timelines, node_tethers, starts, SIGMA_SCALE)
    assert found is not None
    walk = filter_walk(timelines, node_tethers, starts, SIGMA_SCALE)
    assert len(found.mean) == len(walk.posteriors)
    filtered = found.filtered(timelines)
    for posterior, mean in zip(walk.posteriors, found.mean, strict=True):
        np.testing.assert_array_equal(posterior.joint.mean, mean)
    touched = {key: own for one in walk.posteriors for key, own in zip(one.touched, one.states, strict=True)}
    for (device, node), state in touched.items():
        np.testing.assert_array_equal(filtered[device][0][node], state.mean)
        np.testing.assert_array_equal(filtered[device][1][node], state.covariance)
    smoothed = smooth_walk(timelines, node_tethers, starts, SIGMA_SCALE)
    for own, expected in zip(found.smoothed_means(timelines), smoothed, strict=True):
        assert own == pytest.approx(np.array([state.mean for state in expected]), abs=1e-9)


def test_walks_that_it_does_not_fit_are_left_to_the_general_filter() -> None:
    known, tethers = two_devices()
    fix = PositionFix(10.0, np.zeros(2), np.eye(2))
    with_fix = [replace(known[0], measurements=(*known[0].measurements, fix)), known[1]]
    late = [known[0], replace(known[1], start_s=20.0, measurements=known[1].measurements[40:])]
    for devices in (with_fix, late):
        timelines = timelines_of(devices, tethers)
        assert known_headings(timelines, (), starts_of(timelines, START), SIGMA_SCALE) is None
    north = HeadingPrior("phone1", 10.0, 0.0, 0.1)
    timelines = timelines_of([replace(known[0], measurements=(*known[0].measurements, north)), known[1]], tethers)
    nowhere = StartPose((0.0, 0.0))
    assert known_headings(timelines, (), starts_of(timelines, nowhere), SIGMA_SCALE) is None
    assert known_headings(timelines, (), starts_of(timelines, START), SIGMA_SCALE) is not None
