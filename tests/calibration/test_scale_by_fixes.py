"""The scale that fixes tell: the prior divided out by hand, and what fixes tell nothing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.calibration.scale_by_fixes import LogScale, observe_any_fixes, observe_fixes, without_personal_constants
from pdr_est.calibration.step_length_fit import (
    SIGMA_LOG_SCALE,
    CalibrationSteps,
    NotLearnt,
    ScaleObservation,
    observe_distance,
)
from pdr_est.config import Config
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.simulate import Scenario, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.measurements import PositionFix


def test_the_prior_is_divided_out() -> None:
    """The product of a prior and a measurement, by hand, and the measurement back again."""
    prior, measured = LogScale(0.1, 0.2), LogScale(-0.05, 0.04)
    information = 25.0 + 625.0
    product = LogScale((0.1 * 25.0 - 0.05 * 625.0) / information, information**-0.5)
    left = product.without(prior)
    assert left is not None
    assert (left.mean, left.sigma) == pytest.approx((measured.mean, measured.sigma), rel=1e-12)


def test_a_prior_that_came_back_tells_nothing() -> None:
    assert LogScale(0.0, 0.2).without(LogScale(0.0, 0.2)) is None
    assert LogScale(1e-9, 0.2 * (1.0 - 1e-9)).without(LogScale(0.0, 0.2)) is None
    assert LogScale(0.0, 0.21).without(LogScale(0.0, 0.2)) is None


@pytest.fixture(scope="module")
def simulated():
    """A walk on three sides of a rectangle, its front end's findings, and its true positions as fixes."""
    scenario = Scenario(path=PathParams(vertices_m=((0.0, 0.0), (25.0, 0.0), (25.0, 15.0), (0.0, 15.0))))
    recording = simulate_walk(scenario).recording
    truth = recording.truth.positions
    assert truth is not None
    fixes = [
        PositionFix(float(truth.time_s[i]), truth.position_m[i], np.eye(2) * 0.1**2)
        for i in np.linspace(0, len(truth.time_s) - 1, 8).astype(int)
    ]
    length_m = float(np.linalg.norm(np.diff(truth.position_m, axis=0), axis=1).sum())
    return pipeline.analyse_recording(recording, Config()), fixes, length_m


def test_fixes_tell_the_scale_that_the_length_of_the_way_tells(simulated) -> None:
    walks, fixes, length_m = simulated
    by_length = observe_distance([CalibrationSteps.from_steps(walk.steps) for walk in walks], length_m, "walk")
    by_fixes = observe_fixes(walks, Config(), fixes, "walk")
    assert 0.0 < by_fixes.sigma < 0.05
    assert by_fixes.log_ratio == pytest.approx(by_length.log_ratio, abs=0.03)
    assert by_fixes.log_cadence == by_length.log_cadence


def test_what_is_expected_of_people_does_not_count_twice(simulated) -> None:
    """Vague fixes of somebody with longer steps: the prior pulls the smoother's scale, but not the observation."""
    walks, fixes, _ = simulated
    vague = [replace(fix, position_m=1.25 * fix.position_m, covariance_m2=np.eye(2) * 2.0**2) for fix in fixes]

    def smoother(sigma: float) -> float:
        config = Config(odometry=replace(Config().odometry, sigma_length_scale=sigma))
        return pipeline.estimate_tracks(walks, config, vague).length_scale

    scale = math.exp(observe_fixes(walks, Config(), vague, "walk").log_ratio)
    assert scale - smoother(SIGMA_LOG_SCALE) > 0.02
    assert scale == pytest.approx(smoother(10.0 * SIGMA_LOG_SCALE), abs=0.01)


def test_an_estimator_without_fixes_cannot_tell_the_scale(simulated) -> None:
    walks, fixes, _ = simulated
    with pytest.raises(ConfigError, match=r"estimator\.name = dead-reckoning: makes no use of fixes: choose ekf"):
        observe_fixes(walks, Config().with_estimator("dead-reckoning"), fixes, "walk")
    assert observe_fixes(walks, Config().with_estimator("ekf"), fixes, "walk").sigma < 0.1


def test_fixes_that_tell_nothing_are_refused(simulated) -> None:
    walks, fixes, _ = simulated
    with pytest.raises(RecordingError, match="walk: its fixes hardly determine the step length"):
        observe_fixes(walks, Config(), fixes[:1], "walk")
    told = observe_any_fixes(walks, Config(), fixes[:1], "walk")
    assert isinstance(told, NotLearnt)
    assert not told.doubtful


def test_a_closed_walk_without_fixes_tells_nothing(simulated) -> None:
    walks, _, _ = simulated
    closed = replace(Config(), start=replace(Config().start, closed=True))
    told = observe_any_fixes(walks, closed, (), "walk")
    assert isinstance(told, NotLearnt)
    assert not told.doubtful


@pytest.mark.slow
def test_fixes_that_disagree_teach_nothing(simulated) -> None:
    walks, fixes, _ = simulated
    elsewhere = [
        replace(fix, position_m=fix.position_m + np.array([[9.0, -7.0], [-8.0, 9.0]][number % 2]))
        for number, fix in enumerate(fixes)
    ]
    told = observe_any_fixes(walks, Config(), elsewhere, "walk")
    assert isinstance(told, NotLearnt)
    assert told.doubtful
    assert "its fixes disagree with its steps or with each other (" in told.reason
    assert "position fixes" in told.reason
    with pytest.raises(RecordingError, match=r"walk: its fixes disagree with .*: correct the fixes"):
        observe_fixes(walks, Config(), elsewhere, "walk")


def test_a_further_fix_tells_more(simulated) -> None:
    walks, fixes, _ = simulated
    vague = [replace(fix, covariance_m2=np.eye(2) * 3.0**2) for fix in fixes[:4]]
    fewer = observe_any_fixes(walks, Config(), vague, "walk")
    assert isinstance(fewer, ScaleObservation)
    more = observe_any_fixes(walks, Config(), [*vague, fixes[-1]], "walk")
    assert isinstance(more, ScaleObservation)
    assert more.sigma < fewer.sigma


def test_a_scale_that_nobody_has_is_refused(simulated) -> None:
    walks, fixes, _ = simulated
    feet = [replace(fix, position_m=3.28 * fix.position_m) for fix in fixes]
    with pytest.raises(RecordingError, match=r"the fixes make the steps \d\.\d+ times as long, .* give metres"):
        observe_any_fixes(walks, Config(), feet, "walk")


def test_an_observation_does_not_depend_on_what_was_known(simulated) -> None:
    walks, fixes, _ = simulated
    known = replace(
        Config(),
        walker=WalkerParams(length_scale=1.3, cadence_exponent=0.5),
        odometry=replace(Config().odometry, sigma_length_scale=0.03),
    )
    plain = without_personal_constants(known)
    assert plain == Config()
    assert observe_fixes(walks, plain, fixes, "walk") == observe_fixes(walks, Config(), fixes, "walk")
