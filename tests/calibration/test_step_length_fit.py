"""Calibration: the exact posterior, what is learnt from which walks, and what no walk can be."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pdr_est.calibration.step_length_fit import (
    MEAN_EXPONENT,
    SIGMA_EXPONENT,
    SIGMA_LOG_CADENCE,
    SIGMA_LOG_SCALE,
    SIGMA_WALK,
    CalibrationSteps,
    ScaleObservation,
    fit_calibration,
    observe_distance,
)
from pdr_est.config import Config, config_from_dict, config_to_dict
from pdr_est.errors import RecordingError
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.front_end.step_length.walker import walking_cadence_hz


def paced(length_m: float = 0.7, n: int = 10, cadence_hz: float = 2.0) -> CalibrationSteps:
    end_s = np.arange(1, n + 1) / cadence_hz
    log_cadence = np.full(n, math.log(cadence_hz))
    return CalibrationSteps(end_s - 1.0 / cadence_hz, end_s, np.full(n, length_m), log_cadence)


# --- the posterior -----------------------------------------------------------------------------------------------


def test_the_posterior_is_that_of_least_squares_with_the_prior_as_rows() -> None:
    rng = np.random.default_rng(5)
    y, sigma, x = rng.normal(0.1, 0.1, 6), rng.uniform(0.0, 0.1, 6), rng.uniform(0.0, 0.9, 6)
    found = fit_calibration([ScaleObservation(*row) for row in zip(y, sigma, x, strict=True)])
    noise = np.hypot(SIGMA_WALK, sigma)
    middle = np.average(x, weights=noise**-2)
    rows = np.column_stack([1.0 / noise, (x - middle) / noise])
    rows = np.vstack([rows, [1.0 / SIGMA_LOG_SCALE, 0.0], [0.0, 1.0 / SIGMA_EXPONENT]])
    answer = np.linalg.lstsq(rows, np.concatenate([y / noise, [0.0, MEAN_EXPONENT / SIGMA_EXPONENT]]), rcond=None)[0]
    covariance = np.linalg.inv(rows.T @ rows)
    assert_allclose(found.mean, answer, rtol=1e-10)
    assert_allclose(found.covariance, covariance, rtol=1e-10, atol=1e-15)
    assert found.reference_cadence_hz == pytest.approx(math.exp(middle))
    apart = np.average((x - middle) ** 2, weights=noise**-2)
    spread = covariance[0, 0] + covariance[1, 1] * (apart + SIGMA_LOG_CADENCE**2) + SIGMA_WALK**2
    assert found.sigma_next == pytest.approx(math.sqrt(spread))


def test_walks_of_one_cadence_tell_the_scale_alone() -> None:
    alone = fit_calibration([ScaleObservation(0.1, 0.0, 0.6), ScaleObservation(0.2, 0.0, 0.6)])
    variance = 1.0 / (SIGMA_LOG_SCALE**-2 + 2.0 * SIGMA_WALK**-2)
    assert_allclose(alone.mean, [variance * 0.3 / SIGMA_WALK**2, MEAN_EXPONENT])
    assert_allclose(alone.covariance, np.diag([variance, SIGMA_EXPONENT**2]), atol=1e-15)
    learnt = fit_calibration([ScaleObservation(0.1, 0.0, 0.2), ScaleObservation(0.2, 0.0, 0.3)])  # an exponent of 1
    assert MEAN_EXPONENT < learnt.mean[1] < 1.0


def test_a_walk_is_reproduced_whatever_its_cadence() -> None:
    """As far as it is believed against what is expected of people: the exponent changes nothing where it was seen."""
    for cadence_hz in (1.1, 2.2):
        steps = paced(cadence_hz=cadence_hz)
        found = fit_calibration([observe_distance([steps], 8.4, "walk")])
        believed = SIGMA_LOG_SCALE**2 / (SIGMA_LOG_SCALE**2 + SIGMA_WALK**2)
        own = steps.with_personal_constants(found.walker(WalkerParams()))
        assert own.length_m.sum() == pytest.approx(7.0 * 1.2**believed)
        assert found.walker(WalkerParams()).reference_cadence_hz == pytest.approx(cadence_hz)


def test_more_walks_tell_more_and_uncertain_ones_less() -> None:
    sure, unsure = ScaleObservation(0.1, 0.0, 0.6), ScaleObservation(0.1, 0.2, 0.6)
    assert (
        fit_calibration([sure] * 5).sigma_next
        < fit_calibration([sure]).sigma_next
        < fit_calibration([unsure]).sigma_next
    )
    assert fit_calibration([unsure]).sigma_next < math.hypot(SIGMA_LOG_SCALE, SIGMA_WALK)
    # Walks of one cadence never tell how those of others are.
    unknown = math.hypot(SIGMA_WALK, SIGMA_EXPONENT * SIGMA_LOG_CADENCE)
    assert fit_calibration([sure] * 1000).sigma_next == pytest.approx(unknown, rel=1e-3)
    assert (
        0.0
        < fit_calibration([unsure]).mean[0]
        < fit_calibration([sure]).mean[0]
        < fit_calibration([sure] * 5).mean[0]
        < 0.1
    )


def test_a_person_is_found_again() -> None:
    """Many walks of somebody whose steps lengthen with the cadence more than is expected."""
    truth = WalkerParams(length_scale=1.2, cadence_exponent=0.8, reference_cadence_hz=1.6)
    cadences_hz = (1.2, 1.6, 2.2)
    walks = []
    for value in cadences_hz * 400:
        steps = paced(cadence_hz=value)
        walks.append(observe_distance([steps], float(steps.with_personal_constants(truth).length_m.sum()), "walk"))
    walker = fit_calibration(walks).walker(WalkerParams(height_m=1.9, gender="female"))
    assert (walker.height_m, walker.gender) == (1.9, "female")
    for value in cadences_hz:
        assert walker.personal_factor(value) == pytest.approx(truth.personal_factor(value), rel=0.005)


def test_the_stated_uncertainty_is_that_of_walks_at_other_cadences() -> None:
    """People drawn from what is expected of them, calibrated on one walk: two thirds of their next walks, at another
    cadence, are right within the stated sigma."""
    rng = np.random.default_rng(11)
    within = []
    for _ in range(4000):
        scale, exponent = rng.normal(0.0, SIGMA_LOG_SCALE), rng.normal(MEAN_EXPONENT, SIGMA_EXPONENT)
        first, second = rng.normal(0.6, SIGMA_LOG_CADENCE / math.sqrt(2.0), 2)  # apart by SIGMA_LOG_CADENCE
        y, true = (scale + exponent * (x - first) + rng.normal(0.0, SIGMA_WALK) for x in (first, second))
        found = fit_calibration([ScaleObservation(y, 0.0, first)])
        error = found.mean[0] + found.mean[1] * (second - first) - true
        within.append(abs(error) <= found.sigma_next)
    assert np.mean(within) == pytest.approx(0.683, abs=0.02)


def test_the_slowest_and_the_quickest_walk_make_constants_that_a_profile_may_hold() -> None:
    for cadence_hz in (0.2, 0.7, 2.5, 5.0):
        cadence = math.log(walking_cadence_hz(cadence_hz))
        walker = fit_calibration([ScaleObservation(0.1, 0.0, cadence)] * 3).walker(WalkerParams())
        config = Config(walker=walker)
        assert config_from_dict(config_to_dict(config), "a configuration") == config


# --- observations ------------------------------------------------------------------------------------------------


def test_what_a_known_distance_tells() -> None:
    seen = observe_distance([paced()], 8.4, "walk")
    assert (seen.log_ratio, seen.sigma, seen.log_cadence) == pytest.approx((math.log(1.2), 0.0, math.log(2.0)))


def test_the_devices_of_one_walk_are_averaged() -> None:
    seen = observe_distance([paced(0.6, cadence_hz=1.5), paced(0.8, cadence_hz=2.0)], 7.7, "walk")
    assert seen.log_ratio == pytest.approx(math.log(1.1))
    assert seen.log_cadence == pytest.approx((0.6 * math.log(1.5) + 0.8 * math.log(2.0)) / 1.4)


@pytest.mark.parametrize(
    ("steps", "distance_m", "message"),
    [
        (paced(), 0.0, "walk: a distance of 0 m: give the length of the way in metres"),
        (paced(), -5.0, "walk: a distance of -5 m: give"),
        (paced(), math.nan, "walk: a distance of nan m: give"),
        (paced(n=0), 7.0, "walk: no step found"),
        (paced(), 7.0 * 3.2808, r"walk: 7\.0 m by its steps and 22\.9656 m as given, a scale of 3\.28 .* metres"),
        (paced(), 3.4, r"a scale of 0\.49 that is not between 0\.5 and 2"),
    ],
)
def test_what_cannot_be_is_refused(steps: CalibrationSteps, distance_m: float, message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        observe_distance([steps], distance_m, "walk")


def test_a_part_of_a_step_counts_for_its_part() -> None:
    part = paced(n=2).weighted(np.array([0.5, 0.0]))
    assert_allclose(part.length_m, [0.35, 0.0])
    assert_allclose(part.end_s - part.start_s, [0.25, 0.0])
