"""Active tethers as factors of GTSAM: range measurements of the tether's length, RangeFactorPose2.

A tether between two poses is one RangeFactorPose2. Most tethers that are active at the optimum end between two poses
of a device, at a share s of the straight way from the one to the other, and GTSAM has no range factor to an
interpolated position. Such a place is a variable of its own:

* The positions of the two poses are copied to two auxiliary poses c and c' by BetweenFactorPose2 of no length, which
  leave the heading free.
* The place is an auxiliary pose p = (1 - s) c + s c', by a LinearContainerFactor that also fixes the three headings
  at zero. As no heading is involved, the interpolation is linear and the factor exact at all values.
* The tether is a RangeFactorPose2 to p.

Stiff auxiliary factors would force GTSAM's optimisers to take tiny steps. The variance of the tether is therefore
divided among its four factors, so that their least sum over the auxiliary variables is the cost of the tether: each
auxiliary factor has the variance u² = σ² / (2 + s² + (1 - s)²) along each axis, which gives p the variance
(1 + s² + (1 - s)²) u² for given poses, and the range factor has u². The auxiliary variables are returned at the
values of that least sum.
"""

from dataclasses import dataclass
from typing import Any

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.factor_graph.keys import position_copies, tethered_place
from pdr_est.estimators.pose_chains.linear_rows import LinearRows
from pdr_est.estimators.pose_chains.tether_constraints import TetherConstraints
from pdr_est.frames import Array

# Standard deviations. Nothing turns auxiliary poses, and they must tell nothing of the heading of poses.
_FIXED_HEADING_RAD, _FREE_HEADING_RAD = 1e-3, 1e6
_UNIT = gtsam.noiseModel.Unit.Create(5)


@dataclass(frozen=True)
class TetherFactors:
    """Factors of active tethers.

    Attributes
    ----------
    graph : gtsam.NonlinearFactorGraph
        The range factors, and the auxiliary factors of tethers that end between poses.
    auxiliary : gtsam.Values
        The auxiliary variables of these factors, at their optimum for the poses that the factors were made for.
    """

    graph: gtsam.NonlinearFactorGraph
    auxiliary: gtsam.Values


def tether_factors(tethers: TetherConstraints, active: NDArray[np.bool_], pose: Array) -> TetherFactors:
    """Make the factors of those tethers that are active (m,), with auxiliary variables for poses (n, 3)."""
    made = TetherFactors(gtsam.NonlinearFactorGraph(), gtsam.Values())
    near = tethers.linearised(pose)
    violation = near.violation_m[:, None] * near.along  # to where the first end would be, from the second end
    for number in np.flatnonzero(active).tolist():
        earlier, later = tethers.earlier[number].tolist(), tethers.later[number].tolist()
        length_m, sigma_m = float(tethers.max_distance_m[number]), float(tethers.sigma_m[number])
        ends, pulls = list(earlier), (-violation[number], violation[number])
        for end in (0, 1):
            if earlier[end] != later[end]:
                line = _Line(earlier[end], later[end], float(tethers.share[number, end]))
                ends[end], sigma_m = _add_place(made, number, line, sigma_m, pulls[end], pose)
        noise = gtsam.noiseModel.Isotropic.Sigma(1, sigma_m)
        made.graph.add(gtsam.RangeFactorPose2(ends[0], ends[1], length_m, noise))
    return made


@dataclass(frozen=True)
class _Line:
    """A place at a share of the straight way from one pose to another one, by key."""

    earlier: int
    later: int
    share: float


def _add_place(
    made: TetherFactors, number: int, line: _Line, sigma_m: float, pull: Array, pose: Array
) -> tuple[int, float]:
    """Add the place of a tether; return its key and the standard deviation that is left for the range factor, m.

    `pull` (2,) leads from the place to where the tether would hold, in the map frame.
    """
    copies, place = position_copies(number), tethered_place(number)
    part = 1.0 / (2.0 + line.share**2 + (1.0 - line.share) ** 2)  # of the variance, and so of the violation
    sigma_u = float(sigma_m * np.sqrt(part))
    noise = gtsam.noiseModel.Diagonal.Sigmas(np.array([sigma_u, sigma_u, _FREE_HEADING_RAD]))
    at = part * pull
    for key, copy, weight in zip((line.earlier, line.later), copies, (1.0 - line.share, line.share), strict=True):
        position = pose[key, :2] + weight * part * pull
        at = at + weight * position
        made.auxiliary.insert(copy, gtsam.Pose2(position[0], position[1], 0.0))
        turned = gtsam.Pose2(0.0, 0.0, -pose[key, 2])  # expected turn, as for closed walks
        made.graph.add(gtsam.BetweenFactorPose2(key, copy, turned, noise))
    made.auxiliary.insert(place, gtsam.Pose2(at[0], at[1], 0.0))
    made.graph.add(_interpolation((*copies, place), line.share, sigma_u))
    return place, sigma_u


def _interpolation(keys: tuple[int, int, int], share: float, sigma_m: float) -> gtsam.LinearContainerFactor:
    """Make the factor of a position that is interpolated between two others, and of three headings of zero."""
    blocks = np.zeros((3, 5, 3))
    for i, weight in enumerate((1.0 - share, share, -1.0)):
        blocks[i, :2, :2] = weight / sigma_m * np.eye(2)
        blocks[i, 2 + i, 2] = 1.0 / _FIXED_HEADING_RAD
    linear = gtsam.JacobianFactor(keys[0], blocks[0], keys[1], blocks[1], keys[2], blocks[2], np.zeros(5), _UNIT)
    origin = gtsam.Values()
    for key in keys:
        origin.insert(key, gtsam.Pose2())
    return gtsam.LinearContainerFactor(linear, origin)


def add_rows(graph: gtsam.GaussianFactorGraph, rows: LinearRows) -> None:
    """Add rows to a linear graph, each block of them as a factor of the changes of its poses."""
    for pose, jacobian, right in zip(rows.pose.tolist(), rows.jacobian, rows.right, strict=True):
        blocks: dict[int, Array] = {}
        for k, key in enumerate(pose):
            own = jacobian[:, 3 * k : 3 * k + 3]
            blocks[key] = blocks[key] + own if key in blocks else own
        parts: list[Any] = [part for pair in blocks.items() for part in pair]
        parts += [right, gtsam.noiseModel.Unit.Create(len(right))]
        graph.add(gtsam.JacobianFactor(*parts))
