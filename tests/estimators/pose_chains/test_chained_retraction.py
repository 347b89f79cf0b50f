"""Changes composed along the walk are right where changes pose by pose are not."""

import numpy as np
import pytest

from pdr_est.estimators.pose_chains.chained_retraction import ChainedRetraction

LEADER, FOLLOWER = 40, 25
CHAINS = ChainedRetraction(LEADER, np.sort(np.random.default_rng(3).integers(0, LEADER, FOLLOWER)))


def some_walk() -> np.ndarray:
    rng = np.random.default_rng(5)
    heading = np.cumsum(rng.normal(0.0, 0.3, LEADER))
    place = np.cumsum(0.7 * np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)
    beside = place[CHAINS.leader] + rng.normal(0.0, 0.3, (FOLLOWER, 2))
    return np.concatenate(
        [np.column_stack([place, heading]), np.column_stack([beside, rng.normal(0.0, 2.0, FOLLOWER)])]
    )


def own_axes(vectors: np.ndarray, heading_rad: np.ndarray) -> np.ndarray:
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    return np.stack([c * vectors[:, 0] + s * vectors[:, 1], c * vectors[:, 1] - s * vectors[:, 0]], axis=1)


def test_a_walk_that_turns_about_its_start_goes_along_the_arc() -> None:
    pose, angle = some_walk(), 1.2
    lever = pose[:, :2] - pose[0, :2]
    swing = own_axes(angle * np.stack([-lever[:, 1], lever[:, 0]], axis=1), pose[:, 2])
    found = CHAINS.moved(pose, np.column_stack([swing, np.full(len(pose), angle)]))
    c, s = np.cos(angle), np.sin(angle)
    expected = pose[0, :2] + lever @ np.array([[c, s], [-s, c]])
    assert found[:, :2] == pytest.approx(expected, abs=1e-9)
    assert found[:, 2] == pytest.approx(pose[:, 2] + angle)


def test_small_changes_are_those_of_every_pose_by_itself() -> None:
    pose = some_walk()
    change = 1e-5 * np.random.default_rng(6).standard_normal(pose.shape)
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    plain = pose + np.stack(
        [c * change[:, 0] - s * change[:, 1], s * change[:, 0] + c * change[:, 1], change[:, 2]], axis=1
    )
    assert np.abs(CHAINS.moved(pose, change) - plain).max() < 1e-7
    assert np.abs(CHAINS.moved(pose, 0.0 * change) - pose).max() < 1e-12
