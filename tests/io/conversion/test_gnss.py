"""Latitude and longitude become fixes in metres, and fixes that say nothing are left out."""

import numpy as np
import pytest

from pdr_est.io.conversion.gnss import drop_fixes_outside, gnss_fixes

NAN = float("nan")


def test_fixes_are_east_and_north_of_the_first() -> None:
    found = gnss_fixes(np.arange(2.0), np.array([60.0, 60.001]), np.array([24.0, 24.002]), np.array([4.0, 0.1]))
    assert found.fixes[0].position_m == pytest.approx([0.0, 0.0], abs=1e-6)
    # Half a degree of longitude per degree of latitude at 60 degrees north, but for the flattening of the Earth.
    assert found.fixes[1].position_m == pytest.approx([111.6, 111.4], abs=0.2)
    np.testing.assert_array_equal(found.fixes[0].covariance_m2, 16.0 * np.eye(2))
    np.testing.assert_array_equal(found.fixes[1].covariance_m2, np.eye(2))
    assert found.origin is not None
    assert (found.origin.latitude_deg, found.origin.longitude_deg) == (60.0, 24.0)
    assert found.warnings == ()


@pytest.mark.parametrize(
    ("latitude", "longitude", "sigma", "words"),
    [
        (0.0, 0.0, 5.0, "without a possible position"),
        (91.0, 24.0, 5.0, "without a possible position"),
        (NAN, 24.0, 5.0, "without a possible position"),
        (60.1, 24.0, -1.0, "without a valid accuracy"),
        (60.1, 24.0, 0.0, "without a valid accuracy"),
        (60.1, 24.0, NAN, "without a valid accuracy"),
        (60.0, 24.0, 4.0, "that repeat the previous one"),
    ],
)
def test_useless_fixes_are_left_out_with_a_warning(
    latitude: float, longitude: float, sigma: float, words: str
) -> None:
    found = gnss_fixes(
        np.arange(3.0),
        np.array([60.0, latitude, 60.2]),
        np.array([24.0, longitude, 24.0]),
        np.array([4.0, sigma, 4.0]),
    )
    assert [fix.time_s for fix in found.fixes] == [0.0, 2.0]
    assert found.warnings == (f"location: 1 of 3 fixes {words} are left out",)


def test_no_valid_fix_gives_no_origin() -> None:
    found = gnss_fixes(np.zeros(1), np.zeros(1), np.zeros(1), np.ones(1))
    assert (found.fixes, found.origin) == ((), None)
    assert gnss_fixes(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0)).warnings == ()


def test_fixes_outside_the_sensors_are_counted() -> None:
    found = gnss_fixes(np.array([-20.0, -0.5, 5.0, 12.0]), np.linspace(60.0, 60.1, 4), np.full(4, 24.0), np.ones(4))
    kept = drop_fixes_outside(found, 0.0, 10.0)
    assert [fix.time_s for fix in kept.fixes] == [-0.5, 5.0]
    assert kept.origin == found.origin
    assert "2 of 4 fixes are left out because" in kept.warnings[-1]
