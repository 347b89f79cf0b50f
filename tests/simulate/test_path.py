"""The path: exact length and heading, corners without jumps."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from pdr_est.errors import ConfigError
from pdr_est.simulate import PathParams, WalkingPath

ZIGZAG = PathParams(
    vertices_m=((1.0, -2.0), (9.0, -2.0), (9.0, 7.0), (3.0, 12.0), (12.0, 12.0), (12.0, 20.0)), corner_radius_m=0.6
)


def test_a_straight_path_is_the_segment() -> None:
    path = WalkingPath(PathParams(vertices_m=((1.0, 2.0), (4.0, 6.0))))
    points = path.at(np.array([0.0, 2.5, 5.0]))
    assert path.length_m == pytest.approx(5.0, abs=1e-12)
    np.testing.assert_allclose(points.position_m, [[1.0, 2.0], [2.5, 4.0], [4.0, 6.0]], atol=1e-12)
    np.testing.assert_allclose(points.heading_rad, np.arctan2(4.0, 3.0))
    np.testing.assert_array_equal(points.curvature_pm, 0.0)


def test_the_path_meets_its_last_vertex_in_the_last_direction() -> None:
    path = WalkingPath(ZIGZAG)
    end = path.at(np.array([path.length_m]))
    np.testing.assert_allclose(end.position_m[0], ZIGZAG.vertices_m[-1], atol=1e-11)
    assert end.heading_rad[0] == pytest.approx(np.pi / 2.0, abs=1e-12)


def test_the_parameter_is_arc_length_and_the_heading_is_the_tangent() -> None:
    path = WalkingPath(ZIGZAG)
    arc = np.linspace(0.01, path.length_m - 0.01, 4001)
    h = 1e-4
    difference = (path.at(arc + h).position_m - path.at(arc - h).position_m) / (2.0 * h)
    heading = path.at(arc).heading_rad
    np.testing.assert_allclose(difference, np.stack([np.cos(heading), np.sin(heading)], axis=1), atol=1e-7)


def test_curvature_is_the_slope_of_the_heading_and_continuous_at_the_corners() -> None:
    path = WalkingPath(ZIGZAG)
    arc = np.linspace(0.0, path.length_m, 20_001)
    points = path.at(arc)
    np.testing.assert_allclose(np.gradient(points.heading_rad, arc), points.curvature_pm, atol=2e-3)
    np.testing.assert_allclose(np.gradient(points.curvature_pm, arc), points.curvature_slope_pm2, atol=5e-2)
    largest_jump = np.abs(np.diff(points.curvature_pm)).max()
    assert largest_jump < 1.1 * np.abs(points.curvature_slope_pm2).max() * (arc[1] - arc[0])


def test_a_corner_has_the_asked_radius_and_turn() -> None:
    path = WalkingPath(ZIGZAG)
    curvature = path.at(path.corner_m).curvature_pm
    np.testing.assert_allclose(np.abs(curvature), 1.0 / ZIGZAG.corner_radius_m, rtol=1e-12)
    np.testing.assert_array_equal(np.sign(curvature), np.sign(path.turn_rad))
    arc = np.linspace(0.0, path.length_m, 20_001)
    turned = trapezoid(path.at(arc).curvature_pm, arc)
    assert turned == pytest.approx(path.turn_rad.sum(), abs=1e-6)


def test_rounding_shortens_a_corner_and_stays_near_it() -> None:
    right_angle = PathParams(vertices_m=((0.0, 0.0), (10.0, 0.0), (10.0, 10.0)), corner_radius_m=1.0)
    path = WalkingPath(right_angle)
    middle = path.at(path.corner_m).position_m[0]
    assert 19.0 < path.length_m < 20.0
    assert middle[0] == pytest.approx(10.0 - middle[1])  # on the bisector
    assert 0.2 < np.hypot(*(middle - [10.0, 0.0])) < 1.0


def test_beyond_the_ends_the_path_goes_straight_on() -> None:
    path = WalkingPath(ZIGZAG)
    points = path.at(np.array([-1.0, path.length_m + 2.0]))
    np.testing.assert_allclose(points.position_m, [[0.0, -2.0], [12.0, 22.0]], atol=1e-11)


@pytest.mark.parametrize(
    ("vertices_m", "message"),
    [
        (((0.0, 0.0),), "at least 2"),
        (((0.0, 0.0), (5.0, 0.0), (5.0, 0.0)), "vertex 3 repeats"),
        (((0.0, 0.0), (5.0, 0.0), (0.0, 0.1)), "at vertex 2"),
        (((0.0, 0.0), (5.0, 0.0), (5.0, 1.0), (9.0, 1.0)), r"1\.00 m leg behind vertex 2"),
    ],
)
def test_impossible_paths_are_refused(vertices_m: tuple[tuple[float, float], ...], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        WalkingPath(PathParams(vertices_m=vertices_m))


def test_each_corner_may_have_a_radius_of_its_own() -> None:
    corners = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (20.0, 10.0))
    path = WalkingPath(PathParams(vertices_m=corners, corner_radii_m=(0.5, 2.0)))
    curvature = np.abs(path.at(np.linspace(0.0, path.length_m, 20001)).curvature_pm)
    half = len(curvature) // 2
    assert curvature[:half].max() == pytest.approx(2.0, rel=1e-3)
    assert curvature[half:].max() == pytest.approx(0.5, rel=1e-3)
    with pytest.raises(ConfigError, match=r"corner_radii_m: 1 radii for 2 corners"):
        WalkingPath(PathParams(vertices_m=corners, corner_radii_m=(0.5,)))
