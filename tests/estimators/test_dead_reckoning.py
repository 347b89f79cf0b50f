"""Dead reckoning: MMPDR eq. 1 by hand, and a covariance that sampled walks confirm."""

import numpy as np
import pytest
from estimator_walks import SIGMA_SCALE, fix, heading_prior, run, simulate, step, straight, winding

from pdr_est.frames import Array
from pdr_est.front_end.step_noise import step_covariance
from pdr_est.types.measurements import StartPose


def test_positions_are_eq_1_of_the_paper() -> None:
    lengths = [0.7, 0.6, 0.8, 0.75]
    turns = [0.0, 0.5, -1.2, 3.0]
    track = run(
        "dead-reckoning",
        [step(k, length, turn) for k, (length, turn) in enumerate(zip(lengths, turns, strict=True), 1)],
        StartPose((10.0, -5.0), 1.0),
    )
    east, north, theta = 10.0, -5.0, np.pi / 2 - 1.0  # the paper's theta is clockwise from north
    for k, (length, turn) in enumerate(zip(lengths, turns, strict=True), 1):
        theta -= turn
        east, north = east + length * np.sin(theta), north + length * np.cos(theta)
        assert track.position_m[k] == pytest.approx([east, north])
        assert np.cos(track.heading_rad[k] - (np.pi / 2 - theta)) == pytest.approx(1.0)
    assert track.heading_rad[4] == pytest.approx(1.0 + 2.3 - 2 * np.pi)
    assert (track.kind, track.estimator) == ("filtered", "dead-reckoning")


WALKS = 10_000


@pytest.mark.parametrize(
    "sigma",
    [
        {"length": 0.07},
        {"direction": 0.1},
        {"heading": 0.01},
        {"scale": 0.1},
        {"start_heading": 0.05, "start_position": 0.5},
        {"length": 0.07, "direction": 0.1, "heading": 0.01, "scale": 0.03, "start_heading": 0.03},
    ],
    ids=lambda sigma: "+".join(sigma),
)
def test_covariance_is_that_of_sampled_walks(sigma: dict[str, float]) -> None:
    rng = np.random.default_rng(1)
    noise = {
        "length": 0.0,
        "direction": 0.0,
        "heading": 0.0,
        "scale": 0.0,
        "start_heading": 0.0,
        "start_position": 0.0,
    }
    noise |= sigma
    turns = np.array([0.0, *(15 * [0.1]), *(14 * [-0.2])])
    covariance = step_covariance(0.7, noise["length"], noise["direction"], noise["heading"])
    track = run(
        "dead-reckoning",
        [step(k, 0.7, turn, covariance) for k, turn in enumerate(turns, 1)],
        StartPose((0.0, 0.0), 0.5, noise["start_position"], noise["start_heading"]),
        noise["scale"],
    )
    sampled = sample_walks(rng, turns, noise)
    for k in (1, 15, 30):
        deviation = sampled[k] - track.position_m[k]
        expected = track.covariance_m2[k]
        factor = np.linalg.cholesky(expected)
        whitened = np.linalg.solve(factor, deviation.T) @ np.linalg.solve(factor, deviation.T).T / WALKS
        # A sampled variance is off by sqrt(2 / n) = 1.4 %; curvature adds up to 2 %.
        assert whitened == pytest.approx(np.eye(2), abs=0.07), f"step {k}"


def sample_walks(rng: np.random.Generator, turns: Array, noise: dict[str, float]) -> Array:
    """True positions (steps + 1, walks, 2) of walkers with independent errors of these standard deviations."""
    least = 1e-3  # m and rad; the odometry never claims less
    heading = 0.5 + noise["start_heading"] * rng.standard_normal(WALKS)
    position = noise["start_position"] * rng.standard_normal((WALKS, 2))
    length = 0.7 * (1.0 + noise["scale"] * rng.standard_normal(WALKS))
    positions = [position]
    for turn in turns:
        heading = heading + turn + noise["heading"] * rng.standard_normal(WALKS)
        forward = length + noise["length"] * rng.standard_normal(WALKS) + least * rng.standard_normal(WALKS)
        left = 0.7 * noise["direction"] * rng.standard_normal(WALKS) + least * rng.standard_normal(WALKS)
        c, s = np.cos(heading), np.sin(heading)
        position = position + np.stack([c * forward - s * left, s * forward + c * left], axis=1)
        heading = heading + least * rng.standard_normal(WALKS)
        positions.append(position)
    return np.array(positions)


def test_fixes_and_headings_do_not_move_a_walk_with_a_known_start() -> None:
    walk = simulate(np.random.default_rng(2), winding(30, np.random.default_rng(3)))
    start = StartPose((1.0, 2.0), 0.3, 0.1, 0.05)
    alone = run("dead-reckoning", walk.odometry, start)
    among = run("dead-reckoning", [*walk.odometry, fix(3.3, 50, 50), fix(10, -9, 9), heading_prior(5, 2.0)], start)
    assert among.time_s == pytest.approx(alone.time_s)
    assert among.position_m == pytest.approx(alone.position_m, abs=1e-12)
    assert among.covariance_m2 == pytest.approx(alone.covariance_m2, abs=1e-12)
    assert among.sigma_heading_rad == pytest.approx(alone.sigma_heading_rad, abs=1e-12)


def test_a_gap_widens_position_by_the_reach_and_direction_by_the_turn() -> None:
    reach, turn = 5.0, 0.8
    bridge = step(3, 0.0, 0.0, np.diag([reach**2, reach**2, turn**2]), observed=False)
    exact = np.zeros((3, 3))
    walk = [step(1, covariance=exact), step(2, covariance=exact), bridge, step(4, 0.7, covariance=exact)]
    track = run("dead-reckoning", walk, StartPose((0.0, 0.0), 0.0), 0.0)
    assert track.position_m == pytest.approx(np.array([[0, 0], [0.7, 0], [1.4, 0], [1.4, 0], [2.1, 0]]))
    assert track.covariance_m2[2] == pytest.approx(np.zeros((2, 2)))
    assert track.covariance_m2[3] == pytest.approx(np.diag([reach**2, reach**2]))
    assert track.covariance_m2[4] == pytest.approx(np.diag([reach**2, reach**2 + (0.7 * turn) ** 2]))
    assert track.sigma_heading_rad[2:] == pytest.approx([0.0, turn, turn])


def test_the_length_scale_is_an_uncertainty_along_the_walk() -> None:
    track = run("dead-reckoning", straight(10, covariance=np.zeros((3, 3))), StartPose((0.0, 0.0), 0.0))
    assert np.sqrt(track.covariance_m2[:, 0, 0]) == pytest.approx(SIGMA_SCALE * track.position_m[:, 0])
    assert track.covariance_m2[:, 1, 1] == pytest.approx(np.zeros(11))
    assert (track.length_scale, track.sigma_length_scale) == pytest.approx((1.0, SIGMA_SCALE))
