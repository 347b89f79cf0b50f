"""A track that may be turned by any angle about its start says so, on every way out of the package."""

import numpy as np
import pytest
from estimator_walks import fix, heading_prior, simulate, straight, winding

import pdr_est
from pdr_est.config import Config, StartParams
from pdr_est.estimators.common.unknown_direction import covariance_any_direction
from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, rotation_matrix
from pdr_est.online import Tracker, track_of
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.measurements import StartPose, StepOdometry

HERE = StartPose((5.0, -3.0), sigma_position_m=0.3)


def random_errors(rng: np.random.Generator, count: int) -> tuple[Array, Array, Array]:
    """Errors (k, 2) of drawn positions against walks in random directions, the drawn positions and covariances."""
    covariance = np.array([[0.4, 0.1], [0.1, 0.2]])
    drawn = rng.normal(0.0, 6.0, (count, 2))
    other = rng.multivariate_normal(np.zeros(2), covariance, count)
    turn = np.array([rotation_matrix(angle) for angle in rng.uniform(-np.pi, np.pi, count)])
    start = np.array([5.0, -3.0])
    truth = start + np.einsum("kij,kj->ki", turn, drawn - start + other)
    return truth - drawn, drawn, np.tile(covariance, (count, 1, 1))


def test_normalised_errors_of_random_directions_are_two_on_average() -> None:
    error, drawn, covariance = random_errors(np.random.default_rng(1), 20_000)
    stated = covariance_any_direction(drawn, covariance, np.array([5.0, -3.0]))
    squared = np.einsum("ki,ki->k", error, np.linalg.solve(stated, error[..., None])[..., 0])
    assert squared.mean() == pytest.approx(2.0, abs=0.04)


def test_the_errors_of_a_pose_have_the_stated_square() -> None:
    drawn, rng = np.array([[12.0, 1.0]]), np.random.default_rng(2)
    stated = covariance_any_direction(drawn, np.zeros((1, 2, 2)), np.array([5.0, -3.0]))[0]
    turns = [rotation_matrix(angle) - np.eye(2) for angle in rng.uniform(-np.pi, np.pi, 20_000)]
    error = np.array(turns) @ (drawn[0] - [5.0, -3.0])
    assert error.T @ error / len(error) == pytest.approx(stated, rel=0.05, abs=1.0)
    assert np.linalg.eigvalsh(stated) == pytest.approx([0.5 * 65.0, 1.5 * 65.0])


@pytest.mark.parametrize("estimator", ["dead-reckoning", "ekf", "factor-graph"])
def test_a_walk_in_any_direction_lies_within_what_its_track_states(estimator: str) -> None:
    rng, squared = np.random.default_rng(3), []
    for _ in range(40):
        start = (*(np.array([5.0, -3.0]) + 0.3 * rng.standard_normal(2)), rng.uniform(-np.pi, np.pi))
        walk = simulate(rng, winding(20, rng), start)
        track = pdr_est.estimate(walk.odometry, estimator=estimator, start=HERE)
        error = walk.truth[-1, :2] - track.position_m[-1]
        squared.append(error @ np.linalg.solve(track.covariance_m2[-1], error))
        assert track.sigma_heading_rad == pytest.approx(np.full(len(track), SIGMA_UNIFORM_RAD))
    assert np.mean(squared) == pytest.approx(2.0, abs=0.7)


def test_what_tells_the_direction_leaves_the_covariance_to_the_estimator() -> None:
    steps = straight(20)
    for fixes, priors, start in (
        ([fix(20, 12.0, 9.0)], [], HERE),
        ([], [heading_prior(20, 0.3)], HERE),
        ([], [], StartPose((5.0, -3.0), 0.3, 0.3, 0.1)),
        ([], [], StartPose()),
    ):
        track = pdr_est.estimate([*steps, *priors], fixes, "ekf", start=start)
        assert track.sigma_heading_rad[-1] < 0.5


def test_the_person_of_several_devices_is_in_any_direction_as_well() -> None:
    other = [StepOdometry("b", s.time_s + 0.2, s.start_s + 0.2, 0.7, 0.0, s.covariance) for s in straight(20)]
    track = pdr_est.estimate([*straight(20), *other], estimator="ekf", start=HERE)
    assert "fused" in track.devices
    assert track.sigma_heading_rad == pytest.approx(np.full(len(track), SIGMA_UNIFORM_RAD))
    last = track.of_device("fused")
    assert np.trace(last.covariance_m2[-1]) > 1.9 * 14.0**2


def test_pipeline_and_tracker_state_the_same_until_a_fix_comes() -> None:
    recording = simulate_walk(preset("l_shape")).recording
    config = Config(start=StartParams(x_m=5.0, y_m=-3.0)).with_estimator("ekf")
    offline = pdr_est.smooth(recording, config.replace({"devices": {"clock": "none"}}))
    phone = recording.devices[0]
    tracker = Tracker(config, [phone.name])
    updates = [update for block in phone.blocks() for update in tracker.push(phone.name, block)]
    updates += tracker.flush()
    online = track_of(updates)
    assert np.array_equal(online.covariance_m2, offline.covariance_m2)
    assert offline.sigma_heading_rad == pytest.approx(np.full(len(offline), SIGMA_UNIFORM_RAD))
    end, size = offline.position_m[-1], np.linalg.norm(offline.position_m[-1] - [5.0, -3.0])
    assert np.sqrt(np.trace(offline.covariance_m2[-1])) > 1.3 * size
    tracker = Tracker(config, [phone.name])
    tracker.push_fix(pdr_est.PositionFix(float(offline.time_s[-1]), end, 0.25 * np.eye(2)))
    updates = [update for block in phone.blocks() for update in tracker.push(phone.name, block)]
    assert track_of([*updates, *tracker.flush()]).sigma_heading_rad[-1] < 0.5
