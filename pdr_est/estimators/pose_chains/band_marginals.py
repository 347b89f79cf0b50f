"""Marginal covariances of poses from the banded factor of their normal equations in relative positions.

The factor gives every pose, from the last to the first one in time, as a linear function of some poses before it and
white noise. Forwards in time each covariance then follows from those before by sums alone. Besides the poses that
later ones still refer to, the sum of all relative positions is carried along, which is the position itself.
"""

import numpy as np

from pdr_est.frames import Array

_POSES_AT_ONCE = 4096  # whose conditionals are computed together, which bounds the memory


def covariances_in_time(factor: Array) -> Array:
    """Return the covariances (n, 3, 3) of east m, north m, heading rad of all poses in order of time.

    Parameters
    ----------
    factor : (d, 3 n) array
        Lower Cholesky factor of the normal equations as LAPACK stores bands: in each column the main diagonal and
        what is below it. The unknowns of each pose are the differences of its position from the pose before in time,
        east and north, and its heading; the last pose in time comes first.
    """
    count, reach = factor.shape[1] // 3, -(-(len(factor) - 1) // 3)  # poses, and how many before one it refers to
    found = np.empty((count, 3, 3))
    joint = np.zeros((2 + 3 * reach, 2 + 3 * reach))  # position of the last pose, then the last poses, latest first
    new = np.zeros_like(joint)
    for end in range(count, 0, -_POSES_AT_ONCE):
        begin = max(end - _POSES_AT_ONCE, 0)
        carried, noise = _conditionals(factor, begin, end, reach)
        for k in range(end - begin - 1, -1, -1):
            across = carried[k] @ joint[2:]
            own = across[:, 2:] @ carried[k].T + noise[k]
            place = joint[:2, :2] + across[:2, :2] + across[:2, :2].T + own[:2, :2]
            new[:2, :2] = place
            new[2:5, 2:5] = own
            new[2:5, 5:] = across[:, 2:-3]
            new[2:5, :2] = across[:, :2] + own[:, :2]
            new[5:, :2] = joint[2:-3, :2] + across[:2, 2:-3].T
            new[5:, 5:] = joint[2:-3, 2:-3]
            new[:2, 2:], new[5:, 2:5] = new[2:, :2].T, new[2:5, 5:].T
            joint, new = new, joint
            pose = found[count - 1 - begin - k]
            pose[:2, :2], pose[2, 2] = place, own[2, 2]
            pose[2, :2] = pose[:2, 2] = joint[4, :2]
    return found


def _conditionals(factor: Array, begin: int, end: int, reach: int) -> tuple[Array, Array]:
    """Return for some poses the matrices (m, 3, 3 r) of the r poses before each, and their noise (m, 3, 3)."""
    rows = 3 + 3 * reach
    whole = np.zeros((end - begin, rows, 3))
    for i in range(3):
        column = factor[:, 3 * begin + i : 3 * end : 3].T
        whole[:, i : i + column.shape[1], i] = column[:, : rows - i]
    inverse = np.linalg.inv(whole[:, :3])
    turned = inverse.transpose(0, 2, 1)
    return -turned @ whole[:, 3:].transpose(0, 2, 1), turned @ inverse
