"""Motion model of all estimators: a pose, the walker's length scale, and the reference direction of headings.

The state (5,) of a device holds east m, north m, heading rad, the logarithm of the length scale (true over modelled
step length, which is thus positive), and the direction in the map from which relative heading priors count, rad. The
motion to a node changes it by x' = x + scale L (cos, sin)(heading + turn), MMPDR eq. 1 in the convention of the map
frame.

After the states of all devices come three for each source of fixes: the error that its fixes have in common, east and
north, divided by its standard deviation, and the correction of its clock, s: a fix tells the position at its time
plus this.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import cos, exp, sin, sqrt

import numpy as np

from pdr_est.estimators.common.measurement_checks import GivenFixes
from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

STATES = 5
"""Number of states of a device."""

SOURCE_STATES = 3
"""Number of states of a source of fixes."""

CLOCK = 2
"""Index of the correction of the clock in the states of a source."""

LOG_SCALE = 3
"""Index of the logarithm of the length scale in the state of a device."""

JITTER_VARIANCE = 1e-12
"""Variance far below all that matters; it keeps matrices regular where parts of a state are known exactly."""


MIN_SIGMA = 1e-4
"""Least standard deviation, m or rad, in a smoother; with smaller ones the elimination of a factor graph fails."""


@dataclass(frozen=True)
class SourceState:
    """State of a source of fixes, besides the estimate of its wandering error.

    Attributes
    ----------
    name
        Name of the source.
    time_s
        Time of its last fix, for which the estimate of its error holds, s.
    sigma_m
        Standard deviation of the error then, by which it is divided, m.
    wander_time_s
        Correlation time of the error, s.
    jump_variance
        Sum of the variances that were added to its error so far, because its fixes had begun to disagree.
    usual_variance
        Variance of the error, in units of that standard deviation, while the fixes are as good as stated: 1, or 0 for
        a source whose errors are then independent.
    clock_wrong
        Probability that the clock of the source is wrong; 0 for one that is certainly right.
    """

    name: str
    time_s: float
    sigma_m: float
    wander_time_s: float
    jump_variance: float = 0.0
    usual_variance: float = 1.0
    clock_wrong: float = 0.0

    def correlation_with(self, earlier: "SourceState") -> float:
        """Return the factor from the error at an earlier time to that of now, both in standard deviations."""
        decay = exp(-max(self.time_s - earlier.time_s, 0.0) / self.wander_time_s)
        factor = decay * earlier.sigma_m / self.sigma_m
        return factor if self.usual_variance == 0.0 else min(factor, 1.0)


@dataclass(frozen=True)
class SourceTrust:
    """Keep what a filter has learnt of the accuracy of a source of fixes, as seen from one device.

    Attributes
    ----------
    name
        Name of the source.
    device
        Number of the device.
    time_s
        Time of its last fix, s.
    probabilities
        Probabilities of the hypotheses about its accuracy (`kalman/source_trust.py`).
    lost
        Probability, after its last fix, that the track is somewhere else than the state says.
    given
        The fixes that it gave in the last seconds.
    """

    name: str
    device: int
    time_s: float
    probabilities: tuple[float, ...]
    lost: float
    given: GivenFixes = ()


@dataclass(frozen=True)
class GaussianState:
    """Gaussian distribution of the state of one device, or of d devices side by side, with s sources of fixes.

    Attributes
    ----------
    mean
        Mean, (5 d + 3 s,).
    covariance
        Covariance, (5 d + 3 s, 5 d + 3 s).
    sources
        The sources (s) whose errors are the last states.
    trusts
        What was learnt of the accuracy of the sources.
    trails
        The last nodes of each device, over which a fix may be late; empty where they are not known.
    taken
        The fixes of the last node as the filter took them: with errors that stand for the mixture of hypotheses, and
        corrected for the clock.
    """

    mean: Array
    covariance: Array
    sources: tuple[SourceState, ...] = ()
    trusts: tuple[SourceTrust, ...] = ()
    trails: tuple[tuple[Node, ...], ...] = ()
    taken: tuple[PositionFix, ...] = ()

    @property
    def length_scale(self) -> tuple[float, float]:
        """Return the length scale of the first device and its standard deviation, to first order."""
        variance = float(self.covariance[LOG_SCALE, LOG_SCALE])
        scale = exp(float(self.mean[LOG_SCALE]))
        return scale, scale * sqrt(max(variance, 0.0))


def move(state: Array, node: Node) -> Array:
    """Return the state (n,) of a device, with wandering errors or not, after the motion that leads to a node."""
    moved = state.copy()
    moved[2] += node.heading_change_rad
    length = exp(state[LOG_SCALE]) * node.length_m
    moved[0] += length * cos(moved[2])
    moved[1] += length * sin(moved[2])
    return moved


def linearise(state: Array, node: Node) -> tuple[Array, Array]:
    """Linearise the motion that leads to a node.

    Parameters
    ----------
    state
        State (n,) of a device before the motion, with wandering errors or not.
    node
        Node that the motion leads to.

    Returns
    -------
    Array
        Jacobian F (n, n) of `move`.
    Array
        Process noise covariance Q (n, n) in the map frame.
    """
    heading = float(state[2]) + node.heading_change_rad
    c, s = cos(heading), sin(heading)
    length = exp(state[LOG_SCALE]) * node.length_m
    size = len(state)
    jacobian = np.eye(size)
    jacobian[0, 2], jacobian[1, 2] = -length * s, length * c
    jacobian[0, LOG_SCALE], jacobian[1, LOG_SCALE] = length * c, length * s
    to_map = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    noise = np.zeros((size, size))
    noise[:3, :3] = to_map @ node.covariance @ to_map.T
    return jacobian, noise


def linearise_each(states: Array, nodes: Sequence[Node]) -> tuple[Array, Array, Array]:
    """Apply `move` and `linearise` to many states at once.

    Parameters
    ----------
    states
        States (k, n) before the motions.
    nodes
        Nodes (k) that the motions lead to.

    Returns
    -------
    Array
        States (k, n) after the motions.
    Array
        Jacobians (k, n, n).
    Array
        Process noise covariances (k, n, n) in the map frame.
    """
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    return linearise_motions(states, turn_rad, length_m, np.array([node.covariance for node in nodes]))


def linearise_motions(
    states: Array, turn_rad: Array, length_m: Array, covariance: Array
) -> tuple[Array, Array, Array]:
    """Apply `linearise_each` to motions given by turns (k,), lengths (k,) and covariances (k, 3, 3)."""
    count, size = states.shape
    moved = states.copy()
    moved[:, 2] += turn_rad
    c, s, scale = _each(cos, moved[:, 2]), _each(sin, moved[:, 2]), _each(exp, states[:, LOG_SCALE])
    scaled_m = scale * length_m
    moved[:, 0] += scaled_m * c
    moved[:, 1] += scaled_m * s
    jacobian = np.zeros((count, size, size))
    jacobian[:, range(size), range(size)] = 1.0
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -scaled_m * s, scaled_m * c
    jacobian[:, 0, LOG_SCALE], jacobian[:, 1, LOG_SCALE] = scaled_m * c, scaled_m * s
    to_map = np.zeros((count, 3, 3))
    to_map[:, 0, 0], to_map[:, 0, 1], to_map[:, 1, 0], to_map[:, 1, 1], to_map[:, 2, 2] = c, -s, s, c, 1.0
    noise = np.zeros((count, size, size))
    noise[:, :3, :3] = to_map @ covariance @ to_map.transpose(0, 2, 1)
    return moved, jacobian, noise


def linearise_in_turn(states: Array, nodes: Sequence[Node]) -> tuple[Array, Array, Array]:
    """Apply `move` and `linearise` to the motions to successive nodes, one after the other, for many states.

    The numbers are those of single motions, to the last bit.

    Parameters
    ----------
    states
        States (k, s) before the first motion.
    nodes
        Nodes (n) that the motions lead to.

    Returns
    -------
    Array
        States (n, k, s) after each of the motions.
    Array
        Jacobians (n, k, s, s).
    Array
        Process noise covariances (n, k, s, s) in the map frame.
    """
    count, (many, size) = len(nodes), states.shape
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    moved = np.tile(states, (count + 1, 1, 1))
    moved[1:, :, 2] = turn_rad[:, None]
    moved[:, :, 2] = np.cumsum(moved[:, :, 2], axis=0)
    before = moved[:-1].copy()
    heading = moved[1:, :, 2].reshape(-1)
    scaled_m = _each(exp, states[:, LOG_SCALE]) * length_m[:, None]
    for axis, function in enumerate((cos, sin)):
        moved[1:, :, axis] = scaled_m * _each(function, heading).reshape(count, many)
        moved[:, :, axis] = np.cumsum(moved[:, :, axis], axis=0)
    _, jacobian, noise = linearise_motions(
        before.reshape(-1, size),
        np.repeat(turn_rad, many),
        np.repeat(length_m, many),
        np.repeat(np.array([node.covariance for node in nodes]), many, axis=0),
    )
    shape = (count, many, size, size)
    return moved[1:], jacobian.reshape(shape), noise.reshape(shape)


def _each(function: Callable[[float], float], values: Array) -> Array:
    """Apply a function of the standard library, whose rounding does not depend on the place in an array."""
    return np.array(list(map(function, values.tolist())))


def advance(state: GaussianState, node: Node) -> GaussianState:
    """Predict the state after the motion that leads to a node."""
    jacobian, noise = linearise(state.mean, node)
    return replace(state, mean=move(state.mean, node), covariance=jacobian @ state.covariance @ jacobian.T + noise)


def regular_covariances(nodes: Sequence[Node]) -> Array:
    """Return the covariances (n - 1, 3, 3) of the motions to all nodes but the first, none below `MIN_SIGMA`²."""
    covariance = np.array([node.covariance for node in nodes[1:]]).reshape(-1, 3, 3)
    variance, axes = np.linalg.eigh(covariance)
    return np.asarray((axes * np.maximum(variance, MIN_SIGMA**2)[:, None, :]) @ axes.transpose(0, 2, 1))
