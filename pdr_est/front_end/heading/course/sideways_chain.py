"""Probabilities of the angle between the direction of motion and the body, from step to step: a hidden Markov chain.

The angle is 0 for a walker who moves ahead. Whoever goes on sideways or backwards mostly turns the body while going
on in the same direction, and turns it back later. So the chain has two kinds of steps: those in which the walker
turns with the body and the angle stays, and those in which the body turns alone and the angle changes by as much as
the phone turned. A stretch may also end by a turn of the walker into the direction of the body.
"""

from dataclasses import dataclass
from math import floor

import numpy as np

from pdr_est.frames import Array, wrap_angle

ANGLES = 72
"""Number of angles on the circle."""

_SPACING_RAD = 2.0 * np.pi / ANGLES
ANGLES_RAD: Array = wrap_angle(np.arange(ANGLES) * _SPACING_RAD)
"""The angles (72,), rad; the first one is 0."""

_TURNS_BACK = 0.1  # probability per step that the body begins to turn again in a stretch; ours, as are the next two
_WALKS_AHEAD = 0.05  # probability per step that the walker turns into the direction of the body
_TURN_ENDS = 0.3  # probability per step that a turn of the body alone ends
_STAYS = 1.0 - _TURNS_BACK - _WALKS_AHEAD  # probability per step in a stretch that the angle stays
_STEP = np.array([[_STAYS, _TURN_ENDS], [_TURNS_BACK, 1.0 - _TURN_ENDS]])  # to the rows
_TO_AHEAD = np.full(ANGLES, _WALKS_AHEAD)
_TURNED = (np.arange(ANGLES) - np.arange(ANGLES)[:, None]) % ANGLES  # places before a turn by so many angles


@dataclass(frozen=True)
class ChainPosterior:
    """Result of a chain for several rates.

    Attributes
    ----------
    probability : ndarray, shape (n, r, 72)
        Probability of each angle at each step, given all steps.
    log_evidence : ndarray, shape (r,)
        Logarithm of the probability density of the observations.
    """

    probability: Array
    log_evidence: Array


def sideways_chain(likelihood: Array, turn_rad: Array, rates: Array, returns: bool) -> ChainPosterior:
    """Compute the probabilities of the angle at each step from all steps, forward and backward.

    Parameters
    ----------
    likelihood : ndarray, shape (n, r, 72)
        Likelihood of each angle at each step.
    turn_rad : ndarray, shape (n,)
        Turn of the phone since the step before, rad.
    rates : ndarray, shape (r,)
        Probabilities per step that the body of a walker who moves ahead begins to turn alone.
    returns : bool
        True for a walker who moves ahead at the last step.
    """
    turns = turn_rad.tolist()
    forward, scale = _forward(likelihood, turns, rates)
    scaled = likelihood / scale[:, :, None]
    later = np.ones((2, *likelihood.shape[1:]))
    if returns:
        later[:, :, 1:] = 0.0
    end = (forward[-1] * later).sum(axis=(0, 2))
    all_later = np.empty(forward.shape)
    all_later[-1] = later
    for k in range(len(likelihood) - 1, 0, -1):
        later = _before(later * scaled[k], turns[k], rates)
        all_later[k - 1] = later
    both = (forward * all_later).sum(axis=1)
    probability = both / both.sum(axis=2, keepdims=True)
    return ChainPosterior(probability, np.log(scale).sum(axis=0) + np.log(end))


def _forward(likelihood: Array, turns_rad: list[float], rates: Array) -> tuple[Array, Array]:
    """Compute the probabilities (n, 2, r, 72) given the steps so far, and the densities (n, r) of each step."""
    forward, scale = np.empty((len(likelihood), 2, *likelihood.shape[1:])), np.empty(likelihood.shape[:2])
    state = walking_ahead(len(rates))
    for k, observed in enumerate(likelihood):
        state = (moved_on(state, turns_rad[k], rates) if k else state) * observed
        scale[k] = total = state.sum(axis=(0, 2))
        state /= total[:, None]
        forward[k] = state
    return forward, scale


def walking_ahead(count: int) -> Array:
    """Return the probabilities (2, count, 72), for so many rates, of a walker who moves ahead."""
    state = np.zeros((2, count, ANGLES))
    state[0, :, 0] = 1.0
    return state


def moved_on(state: Array, turn_rad: float, rates: Array) -> Array:
    """Move probabilities (2, r, 72) to the next step.

    The first ones are those of a walker who turns with the body, the second ones those of a body that turns alone.
    """
    moved: Array = _STEP.dot(state.reshape(2, -1)).reshape(state.shape)
    less_begins = (_TURNS_BACK - rates) * state[0, :, 0]  # from ahead, where it is rarer than in a stretch
    moved[0, :, 0] += less_begins + state[0].dot(_TO_AHEAD)
    moved[1, :, 0] -= less_begins
    moved[1] = _shifted(moved[1], -turn_rad)
    return moved


def _before(later: Array, turn_rad: float, rates: Array) -> Array:
    """Move densities (2, r, 72) of all later observations to the step before; the transpose of `moved_on`."""
    together, alone = later[0], _shifted(later[1], turn_rad)
    ahead = together[:, 0]
    moved = np.empty(later.shape)
    moved[0] = _STAYS * together + _TURNS_BACK * alone + (_WALKS_AHEAD * ahead)[:, None]
    moved[0, :, 0] = (1.0 - rates) * ahead + rates * alone[:, 0]
    moved[1] = (1.0 - _TURN_ENDS) * alone + _TURN_ENDS * together
    return moved


def _shifted(values: Array, by_rad: float) -> Array:
    """Turn values (r, 72) on the circle by an angle; between two angles by linear interpolation."""
    places = by_rad / _SPACING_RAD
    whole = floor(places)
    share = places - whole
    shifted: Array
    farther: Array
    shifted, farther = (values.take(_TURNED[by % ANGLES], axis=1) for by in (whole, whole + 1))
    shifted *= 1.0 - share
    farther *= share
    shifted += farther
    return shifted
