"""Independent and wandering error of position fixes from the accuracy that their source states."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.config import Config, config_from_dict
from pdr_est.errors import ConfigError
from pdr_est.estimators.common.fix_noise import FixNoiseParams, GpsNoise, SourceFixNoise, fixes_with_noise
from pdr_est.types.measurements import PositionFix

RADIUS_TO_SIGMA = 1.0 / np.sqrt(-2.0 * np.log(1.0 - 0.68))  # of a coordinate, for a 68 % radius


def stated(sigma_m: float, source: str = "gps") -> PositionFix:
    return PositionFix(1.0, np.zeros(2), sigma_m**2 * np.eye(2), source, robust=True)


@pytest.mark.parametrize("source", ["gps", "network"])
def test_a_stated_radius_becomes_about_the_sigma_of_a_coordinate(source: str) -> None:
    (fix,) = fixes_with_noise([stated(12.0, source)], FixNoiseParams())
    assert 1.0 < np.sqrt(fix.total_covariance_m2[0, 0]) / (12.0 * RADIUS_TO_SIGMA) < 1.5
    assert fix.sigma_wander_m > 2.0 * np.sqrt(fix.covariance_m2[0, 0])
    assert fix.wander_time_s == GpsNoise().wander_time_s
    assert fix.robust


def test_phones_that_state_too_good_an_accuracy_are_not_believed() -> None:
    (fix,) = fixes_with_noise([stated(0.1)], FixNoiseParams())
    assert fix.sigma_wander_m == pytest.approx(2.5, rel=0.01)


def test_what_is_beyond_the_largest_wandering_error_is_independent() -> None:
    (fix,) = fixes_with_noise([stated(748.0)], FixNoiseParams())
    assert fix.sigma_wander_m == 20.0
    assert np.sqrt(fix.total_covariance_m2[0, 0]) == pytest.approx(748.0 * np.hypot(0.3, 0.75), rel=1e-3)


def test_surveyed_points_and_fixes_with_a_wandering_error_stay_as_they_are() -> None:
    given = [stated(0.3, "waypoint"), stated(0.3, "file"), replace(stated(4.0), sigma_wander_m=1.0)]
    assert fixes_with_noise(given, FixNoiseParams()) == tuple(given)


def test_correlated_coordinates_stay_correlated() -> None:
    covariance = np.array([[9.0, 4.0], [4.0, 4.0]])
    noise = FixNoiseParams(others=(SourceFixNoise(source="ble", white_share=2.0, wander_share=1.0),))
    (fix,) = fixes_with_noise([replace(stated(1.0, "ble"), covariance_m2=covariance)], noise)
    assert fix.covariance_m2 == pytest.approx(4.0 * covariance)
    assert fix.sigma_wander_m == pytest.approx(np.sqrt(6.5))


def test_noise_of_sources_from_the_configuration() -> None:
    settings = {"fixes": {"gps": {"wander_time_s": 30.0}, "others": [{"source": "wifi", "least_wander_m": 3.0}]}}
    noise = config_from_dict(settings, "here").fixes
    gps, wifi = fixes_with_noise([stated(4.0), stated(4.0, "wifi")], noise)
    assert gps.wander_time_s == 30.0
    assert gps.sigma_wander_m == fixes_with_noise([stated(4.0)], FixNoiseParams())[0].sigma_wander_m
    assert (wifi.sigma_wander_m, wifi.covariance_m2[0, 0]) == (3.0, 16.0)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"fixes.gps.white_share": 0.0, "fixes.gps.least_white_m": 0.0}, "no fix is exact"),
        ({"fixes.others": [{"source": "gps"}]}, "the source 'gps' stands twice"),
        ({"fixes.gps.wander_time_s": 0.0}, "wander_time_s"),
    ],
)
def test_noise_that_cannot_be(settings: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        Config().replace(settings)
