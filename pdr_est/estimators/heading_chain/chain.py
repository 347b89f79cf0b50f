"""Chain of headings: the turns between nodes, the heading priors, and the optimum of all of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.huber import CAUCHY
from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD
from pdr_est.estimators.common.motion_model import MIN_SIGMA
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.pose_chains.line_search import EXACTLY, MAX_HALVINGS, MAX_STEPS, decreases_enough
from pdr_est.frames import Array, wrap_angle

_LONG = 1000  # nodes; to load LAPACK takes longer than to do without it in a walk of fewer (ours)


@dataclass(frozen=True)
class NodePriors:
    """Heading priors of the nodes of a device, m in number.

    Attributes
    ----------
    node
        Number (m,) of the node of each.
    heading_rad
        Headings (m,).
    sigma_rad
        Standard deviations (m,).
    robust
        Whether each may be an outlier (m,).
    relative
        1 for each that counts from the reference direction, 0 for one in the map (m,).
    """

    node: NDArray[np.intp]
    heading_rad: Array
    sigma_rad: Array
    robust: NDArray[np.bool_]
    relative: Array

    @classmethod
    def of_nodes(cls, nodes: Sequence[Node]) -> "NodePriors":
        """List the priors of all nodes in their order."""
        pairs = [(i, prior) for i, node in enumerate(nodes) for prior in node.priors]
        return cls(
            np.array([i for i, _ in pairs], dtype=np.intp),
            np.array([prior.heading_rad for _, prior in pairs]),
            np.maximum(np.array([prior.sigma_rad for _, prior in pairs]), MIN_SIGMA),
            np.array([prior.robust for _, prior in pairs], dtype=np.bool_),
            np.array([prior.relative for _, prior in pairs], dtype=np.float64),
        )


@dataclass(frozen=True)
class HeadingChain:
    """Headings of n nodes: prior of the first one, turns between them, and heading priors.

    Attributes
    ----------
    start_rad, start_variance
        Prior of the first heading.
    reference_rad
        Mean of the vague prior of the reference direction.
    turn_rad, turn_variance
        Turns (n - 1,) between successive nodes, and their variances.
    priors
        Heading priors.
    """

    start_rad: float
    start_variance: float
    reference_rad: float
    turn_rad: Array
    turn_variance: Array
    priors: NodePriors

    def optimum(self, heading_rad: Array, reference_rad: float) -> tuple[Array, float]:
        """Return the most probable headings (n,) and reference direction, near initial ones.

        The method is iteratively reweighted least squares with Cauchy's kernel for robust priors, the same as
        Gauss-Newton on the factor graph, with steps that are halved until the error decreases enough. It ends by the
        rule of `pose_chains.line_search`, as `factor_graph.newton` does, so that both find the same optimum.

        Raises
        ------
        EstimationError
            If it does not end.
        """
        heading, reference = heading_rad, reference_rad
        here = self._error(heading, reference)
        for _ in range(MAX_STEPS):
            change, turned, decrease = self._step(heading, reference)
            if decrease < EXACTLY:
                there = heading + change, reference + turned
                return there if self._error(*there) <= here else (heading, reference)
            for halving in range(MAX_HALVINGS):
                share = 0.5**halving
                there = heading + share * change, reference + share * turned
                error = self._error(*there)
                if decreases_enough(error, here, share, decrease):
                    break
            else:  # no decrease beyond rounding
                return heading, reference
            (heading, reference), here = there, error
        raise EstimationError(
            f"the headings of {len(heading)} poses do not settle: step {MAX_STEPS} towards them would still decrease "
            f"the error by {decrease:.2g}: leave out heading priors that contradict each other, or use ekf"
        )

    def weights(self, heading_rad: Array, reference_rad: float) -> Array:
        """Return the information (m,) of each prior at some headings, 1/rad²."""
        return np.asarray(self._kernel(self._off(heading_rad, reference_rad)) / self.priors.sigma_rad**2)

    def solve(self, start: float, turn: Array, weight: Array, prior: Array, reference: float) -> tuple[Array, float]:
        """Solve the linear least squares of the chain.

        Parameters
        ----------
        start, reference
            Wanted values of the first heading and of the reference, with the variances of their priors.
        turn
            Wanted differences (n - 1,) of successive headings.
        weight, prior
            Information (m,) of the priors, and wanted values (m,) of heading minus reference.
        """
        size, at = len(turn) + 1, self.priors
        stiff = 1.0 / self.turn_variance
        diagonal = sums_by_node(at.node, weight, size)
        diagonal[0] += 1.0 / self.start_variance
        diagonal[1:] += stiff
        diagonal[:-1] += stiff
        pull = sums_by_node(at.node, weight * prior, size)
        pull[0] += start / self.start_variance
        pull[1:] += stiff * turn
        pull[:-1] -= stiff * turn
        relative = weight * at.relative
        if not relative.any():
            return _tridiagonal(diagonal, stiff, pull[:, None])[:, 0], reference
        across = -sums_by_node(at.node, relative, size)
        alone, followed = _tridiagonal(diagonal, stiff, np.stack([pull, across], axis=1)).T
        vague = 1.0 / VAGUE_SIGMA_RAD**2
        rest = vague + float(relative.sum()) - float(across @ followed)
        found = (vague * reference - float(relative @ prior) - float(across @ alone)) / rest
        return alone - followed * found, found

    def _off(self, heading: Array, reference: float) -> Array:
        """Return the errors (m,) of the priors in standard deviations."""
        at = self.priors
        return np.asarray(wrap_angle(heading[at.node] - reference * at.relative - at.heading_rad) / at.sigma_rad)

    def _kernel(self, off: Array) -> Array:
        """Return the weights (m,) of errors in standard deviations."""
        return np.where(self.priors.robust, 1.0 / (1.0 + (off / CAUCHY) ** 2), 1.0)

    def _error(self, heading: Array, reference: float) -> float:
        """Return half the sum of squares, with the kernels of robust priors."""
        off = self._off(heading, reference)
        cost = np.where(self.priors.robust, CAUCHY**2 * np.log1p((off / CAUCHY) ** 2), off**2).sum()
        cost += np.sum(wrap_angle(np.diff(heading) - self.turn_rad) ** 2 / self.turn_variance)
        cost += float(wrap_angle(heading[0] - self.start_rad)) ** 2 / self.start_variance
        return 0.5 * float(cost + ((reference - self.reference_rad) / VAGUE_SIGMA_RAD) ** 2)

    def _step(self, heading: Array, reference: float) -> tuple[Array, float, float]:
        """Return the changes of headings and reference of one Gauss-Newton step, and the decrease it predicts."""
        off = self._off(heading, reference)
        start = -float(wrap_angle(heading[0] - self.start_rad))
        turn = -wrap_angle(np.diff(heading) - self.turn_rad)
        weight, prior = self._kernel(off) / self.priors.sigma_rad**2, -off * self.priors.sigma_rad
        back = self.reference_rad - reference
        change, turned = self.solve(start, turn, weight, prior, back)
        of_priors = change[self.priors.node] - turned * self.priors.relative
        decrease = float(np.sum(weight * prior * of_priors) + np.sum(turn * np.diff(change) / self.turn_variance))
        decrease += start * float(change[0]) / self.start_variance + back * turned / VAGUE_SIGMA_RAD**2
        return change, turned, 0.5 * decrease


def sums_by_node(node: NDArray[np.intp], value: Array, size: int) -> Array:
    """Return the sums (size,) of the values (m,) at each node."""
    return np.bincount(node, value, size).astype(np.float64)


def _tridiagonal(diagonal: Array, stiff: Array, right: Array) -> Array:
    """Solve a symmetric system (n, n) with the elements -stiff (n - 1,) beside its diagonal for columns (n, k)."""
    if len(diagonal) < _LONG:
        return _solved_in_turn(diagonal, stiff, right)
    from scipy.linalg.lapack import dptsv

    return np.asarray(dptsv(diagonal, -stiff, right)[2])


def _solved_in_turn(diagonal: Array, stiff: Array, right: Array) -> Array:
    """Solve the system of `_tridiagonal` row by row, as LAPACK does."""
    pivot, *below = diagonal.tolist()
    ratios, pivots = [], [pivot]
    for beside, own in zip(stiff.tolist(), below, strict=True):
        ratios.append(beside / pivot)
        pivot = own - ratios[-1] * beside
        pivots.append(pivot)
    solved = np.empty(right.shape)
    for column, values in enumerate(right.T.tolist()):
        for i, ratio in enumerate(ratios):
            values[i + 1] += ratio * values[i]
        found = values[-1] / pivots[-1]
        values[-1] = found
        for i in range(len(ratios) - 1, -1, -1):
            found = values[i] / pivots[i] + ratios[i] * found
            values[i] = found
        solved[:, column] = values
    return solved
