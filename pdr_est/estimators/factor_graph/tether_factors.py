"""Active tethers as factors of GTSAM: range measurements of the tether's length, RangeFactorPose2.

A tether between two poses is one RangeFactorPose2. A tether that ends between two poses of a device, at a share s of
the straight way, needs that place as a variable, because GTSAM has no range factor to an interpolated position:

* The positions of the two poses are copied to auxiliary poses ``c`` (BetweenFactorPose2 of no length, free in
  heading), whose heading is fixed at zero (PoseRotationPrior2D).
* The place is an auxiliary pose ``p``, with heading zero, too. It is (1 - s) c + s c', which is linear and thus exact
  as LinearContainerFactor, because no heading is involved.
* The tether is a RangeFactorPose2 to that place.

The auxiliary factors have the standard deviation `MIN_SIGMA`, are without error where the auxiliary variables are
where they belong, and tell nothing of the poses.
"""

from dataclasses import dataclass

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.factor_graph.factors import FREE_HEADING_RAD, MIN_SIGMA
from pdr_est.estimators.factor_graph.keys import position_copy, tethered_place
from pdr_est.estimators.factor_graph.tether_constraints import TetherConstraints
from pdr_est.frames import Array

_POSITION_ONLY = gtsam.noiseModel.Diagonal.Sigmas(np.array([MIN_SIGMA, MIN_SIGMA, FREE_HEADING_RAD]))
_HEADING_ONLY = gtsam.noiseModel.Isotropic.Sigma(1, MIN_SIGMA)
_NO_TURN = gtsam.Rot2(0.0)


@dataclass(frozen=True)
class TetherFactors:
    """Factors of active tethers.

    Attributes
    ----------
    graph : gtsam.NonlinearFactorGraph
        The range factors, and the auxiliary factors of tethers that end between poses.
    auxiliary : gtsam.Values
        The auxiliary variables of these factors, at the poses that the factors were made for.
    """

    graph: gtsam.NonlinearFactorGraph
    auxiliary: gtsam.Values


def tether_factors(tethers: TetherConstraints, active: NDArray[np.bool_], pose: Array) -> TetherFactors:
    """Make the factors of those tethers that are active (m,), with auxiliary variables at poses (n, 3)."""
    made = TetherFactors(gtsam.NonlinearFactorGraph(), gtsam.Values())
    chosen = np.flatnonzero(active)
    ends = np.concatenate([tethers.earlier[chosen], tethers.later[chosen]], axis=1).tolist()
    limits = np.stack([tethers.max_distance_m[chosen], tethers.sigma_m[chosen]], axis=1).tolist()
    for number, (a, b, later_a, later_b), (max_distance_m, sigma_m) in zip(
        chosen.tolist(), ends, limits, strict=True
    ):
        if later_a != a:
            a = _add_place(made, number, (a, later_a), float(tethers.share[number, 0]), pose)
        if later_b != b:
            b = _add_place(made, number, (b, later_b), float(tethers.share[number, 1]), pose)
        noise = gtsam.noiseModel.Isotropic.Sigma(1, sigma_m)
        made.graph.add(gtsam.RangeFactorPose2(a, b, max_distance_m, noise))
    return made


def _add_place(made: TetherFactors, number: int, poses: tuple[int, int], share: float, pose: Array) -> int:
    """Add the place of a tether between two poses and return its key."""
    copies = [_add_copy(made, key, pose[key]) for key in poses]
    place = tethered_place(number)
    at = (1.0 - share) * pose[poses[0], :2] + share * pose[poses[1], :2]
    made.auxiliary.insert(place, gtsam.Pose2(at[0], at[1], 0.0))
    made.graph.add(gtsam.PoseRotationPrior2D(place, _NO_TURN, _HEADING_ONLY))
    position = np.eye(2, 3) / MIN_SIGMA
    interpolation = gtsam.JacobianFactor(
        copies[0],
        (1.0 - share) * position,
        copies[1],
        share * position,
        place,
        -position,
        np.zeros(2),
        gtsam.noiseModel.Unit.Create(2),
    )
    origin = gtsam.Values()
    for key in (*copies, place):
        origin.insert(key, gtsam.Pose2())
    made.graph.add(gtsam.LinearContainerFactor(interpolation, origin))
    return place


def _add_copy(made: TetherFactors, key: int, pose: Array) -> int:
    """Add the copied position of a pose, unless it is there already, and return its key."""
    copy = position_copy(key)
    if not made.auxiliary.exists(copy):
        made.auxiliary.insert(copy, gtsam.Pose2(pose[0], pose[1], 0.0))
        turned = gtsam.Pose2(0.0, 0.0, -pose[2])  # expected turn, as for closed walks
        made.graph.add(gtsam.BetweenFactorPose2(key, copy, turned, _POSITION_ONLY))
        made.graph.add(gtsam.PoseRotationPrior2D(copy, _NO_TURN, _HEADING_ONLY))
    return copy
