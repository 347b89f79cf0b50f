"""The chain of angles between motion and body, against sums over all sequences of states."""

from itertools import product

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.front_end.heading.course.sideways_chain import ANGLES, ANGLES_RAD, sideways_chain

RATE = 0.02
STATES = list(product((False, True), (0, 18, 36, 54)))  # of these angles only, 90 degrees apart: does the body turn?


def transition(before: tuple[bool, int], after: tuple[bool, int], turned: int) -> float:
    """Probability of a state after another one, when the phone turned by so many angles."""
    (alone, angle), (alone_now, angle_now) = before, after
    moved = (angle - turned) % ANGLES
    if alone:
        return 0.7 * (angle_now == moved) if alone_now else 0.3 * (angle_now == angle)
    begins = RATE if angle == 0 else 0.1
    if alone_now:
        return begins * (angle_now == moved)
    if angle == 0:
        return (1.0 - begins) * (angle_now == 0)
    return 0.85 * (angle_now == angle) + 0.05 * (angle_now == 0)


def by_hand(likelihood: Array, turned: list[int], returns: bool) -> tuple[Array, float]:
    """Posterior (n, 72) and log evidence by the sum over all sequences of states."""
    total = np.zeros(likelihood.shape)
    for states in product(STATES, repeat=len(turned)):
        if states[0] != (False, 0) or (returns and states[-1][1] != 0):
            continue
        weight = 1.0
        for k, state in enumerate(states):
            weight *= likelihood[k, state[1]] * (transition(states[k - 1], state, turned[k]) if k else 1.0)
        for k, state in enumerate(states):
            total[k, state[1]] += weight
    evidence = total[0].sum()
    return total / evidence, float(np.log(evidence))


@pytest.mark.parametrize("returns", [True, False])
def test_the_chain_sums_over_all_ways_to_turn(returns: bool) -> None:
    turned = [0, 36, 0, -36, 18]
    likelihood = np.random.default_rng(3).uniform(0.1, 3.0, (len(turned), ANGLES))
    expected, log_evidence = by_hand(likelihood, turned, returns)
    turn_rad = np.array(turned) * (2.0 * np.pi / ANGLES)
    found = sideways_chain(likelihood[:, None], turn_rad, np.array([RATE]), returns)
    np.testing.assert_allclose(found.probability[:, 0], expected, atol=1e-12)
    np.testing.assert_allclose(found.log_evidence, [log_evidence], rtol=1e-12)


def test_a_turn_between_two_angles_is_shared_by_them() -> None:
    likelihood = np.ones((2, 1, ANGLES))
    likelihood[1, 0, 0] = 0.0
    spacing = 2.0 * np.pi / ANGLES
    found = sideways_chain(likelihood, np.array([0.0, -2.25 * spacing]), np.array([RATE]), returns=False)
    angle = found.probability[1, 0] @ ANGLES_RAD
    assert angle == pytest.approx(2.25 * spacing)
    assert np.count_nonzero(found.probability[1, 0]) == 2
