"""Dead reckoning of all poses at once against the motion model step by step."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, simulate, winding

from pdr_est.estimators.common.motion_model import STATES, GaussianState, linearise, linearise_in_turn, move
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.reckoned_poses import reckon, reckon_means, reckon_poses


def winding_nodes(rng: np.random.Generator) -> tuple[Node, ...]:
    skewed = np.array([[0.02, 0.004, 0.001], [0.004, 0.03, 0.006], [0.001, 0.006, 0.01]])
    steps = [replace(step, covariance=skewed) for step in simulate(rng, 3.0 * winding(40, rng)).odometry]
    return build_timeline(DEVICE, 0.0, steps).nodes


def some_state(rng: np.random.Generator, size: int = STATES) -> GaussianState:
    root = rng.normal(size=(size, size))
    return GaussianState(np.array([5e5, -20.0, 1.0, 0.1, 0.4, *range(STATES, size)]), root @ root.T)


def step_by_step(nodes: Sequence[Node], anchor: int, state: GaussianState) -> list[GaussianState]:
    """Apply the motion model to one motion after the other, in both directions."""
    found = {anchor: state}
    for k in range(anchor + 1, len(nodes)):
        before = found[k - 1]
        jacobian, noise = linearise(before.mean, nodes[k])
        covariance = jacobian @ before.covariance @ jacobian.T + noise
        found[k] = replace(before, mean=move(before.mean, nodes[k]), covariance=covariance)
    for k in range(anchor, 0, -1):
        after, node = found[k], nodes[k]
        turned = after.mean - np.array([0.0, 0.0, node.heading_change_rad, 0.0, 0.0])
        mean = turned - (move(turned, node) - after.mean)
        jacobian, noise = linearise(mean, node)
        back = np.linalg.inv(jacobian)
        found[k - 1] = replace(after, mean=mean, covariance=back @ (after.covariance + noise) @ back.T)
    return [found[k] for k in range(len(nodes))]


@pytest.mark.parametrize("anchor", [0, 17, 40])
def test_it_is_the_motion_model_in_both_directions(anchor: int) -> None:
    rng = np.random.default_rng(3)
    nodes, state = winding_nodes(rng), some_state(rng)
    pose, covariance = reckon_poses(nodes, anchor, state)
    expected = step_by_step(nodes, anchor, state)
    assert pose == pytest.approx(np.array([one.mean[:3] for one in expected]), abs=1e-9)
    assert covariance == pytest.approx(np.array([one.covariance[:3, :3] for one in expected]), rel=1e-9, abs=1e-9)
    for found, own in zip(reckon(nodes, anchor, state), expected, strict=True):
        assert found.mean == pytest.approx(own.mean, abs=1e-9)
        assert found.covariance == pytest.approx(own.covariance, rel=1e-9, abs=1e-9)
    if anchor == 0:
        assert reckon_means(nodes, state.mean) == pytest.approx(np.array([one.mean for one in expected]), abs=1e-9)


def test_motions_in_turn_are_single_motions_to_the_last_bit() -> None:
    """Also for states with the error of a source of fixes."""
    rng = np.random.default_rng(4)
    _, *nodes = winding_nodes(rng)
    states = [some_state(rng, STATES + 3) for _ in range(3)]
    moved, jacobian, noise = linearise_in_turn(np.array([one.mean for one in states]), nodes)
    for k, state in enumerate(states):
        mean = state.mean
        for i, node in enumerate(nodes):
            own_jacobian, own_noise = linearise(mean, node)
            mean = move(mean, node)
            assert np.array_equal(moved[i, k], mean)
            assert np.array_equal(jacobian[i, k], own_jacobian)
            assert np.array_equal(noise[i, k], own_noise)
