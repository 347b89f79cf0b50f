"""Marginal covariances of poses from the banded factor of their normal equations in relative positions.

The factor gives every pose, from the last to the first one in time, as a linear function of some poses before it and
white noise. Poses are taken together in blocks so long that each block depends on the one before it only. Forwards in
time the covariance of each block then follows from that of the one before by sums alone. The sum of all relative
positions, which is the position itself, is carried along.
"""

import numpy as np

from pdr_est.frames import Array

_LEAST_BLOCK = 8  # poses; with smaller blocks the time goes into calls of numpy
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
    poses = max(reach, _LEAST_BLOCK)
    size, at_once = 3 * poses, max(_POSES_AT_ONCE // poses, 1) * poses
    found = np.empty((count, 3, 3))
    joint, place = np.zeros((size + 2, size)), np.zeros((2, 2))  # of the last block and with the position at its end
    for end in range(count, 0, -at_once):
        begin = max(end - at_once, 0)
        carried, own = _conditionals(factor[:, 3 * begin : 3 * end], poses)
        across = np.empty((len(own), 2, size))
        for k in range(len(own) - 1, -1, -1):
            before = joint @ carried[k].T
            own[k] += carried[k] @ before[:size]
            across[k] = before[size:]
            joint[:size] = own[k]
            joint[size:] = before[size:] + own[k].reshape(poses, 3, size)[:, :2].sum(axis=0)
        ahead, place = _summed(own, across, place)
        found[count - end : count - begin] = ahead.reshape(-1, 3, 3)[::-1][: end - begin]
    return found


def _conditionals(factor: Array, poses: int) -> tuple[Array, Array]:
    """Return the matrices (m, k, k) that carry the block before in time to each of m blocks, and noise (m, k, k).

    The first block is filled up by poses that are after all others and connected to none.
    """
    size, reach = 3 * poses, len(factor)
    blocks = -(-factor.shape[1] // size)
    filled = blocks * size - factor.shape[1]
    whole = np.zeros((blocks, 2 * size, size))
    for i in range(size):
        column = factor[:, (i - filled) % size :: size].T
        whole[blocks - len(column) :, i : i + reach, i] = column
    whole[0, range(filled), range(filled)] = 1.0
    turned = np.linalg.inv(whole[:, :size]).transpose(0, 2, 1)
    return -turned @ whole[:, size:].transpose(0, 2, 1), turned @ turned.transpose(0, 2, 1)


def _summed(own: Array, across: Array, place: Array) -> tuple[Array, Array]:
    """Return the covariances (m, poses, 3, 3) of the poses of m blocks, and that of the last position of all (2, 2).

    Parameters
    ----------
    own : (m, k, k) array
        Covariances of the blocks in relative positions, the last pose in time first.
    across : (m, 2, k) array
        Their covariances with the position before each block.
    place : (2, 2) array
        Covariance of the position before all blocks.
    """
    blocks, poses = len(own), own.shape[1] // 3
    parts = own.reshape(blocks, poses, 3, poses, 3)[:, ::-1, :, ::-1]
    to_heading = np.cumsum(parts[:, :, :2, :, 2], axis=1)
    within = np.cumsum(np.cumsum(parts[:, :, :2, :, :2], axis=1), axis=3)
    with_place = np.cumsum(across.reshape(blocks, 2, poses, 3)[:, :, ::-1], axis=2)
    every = np.arange(poses)
    found = np.empty((blocks, poses, 3, 3))
    added = with_place[..., :2].transpose(0, 2, 1, 3)
    found[:, :, :2, :2] = np.einsum("mpipj->mpij", within) + added + added.transpose(0, 1, 3, 2)
    # To the heading of a pose both its own position and that before the block count.
    own_heading = across.reshape(blocks, 2, poses, 3)[:, :, ::-1, 2].transpose(0, 2, 1)
    found[:, :, :2, 2] = found[:, :, 2, :2] = to_heading[:, every, :, every].transpose(1, 0, 2) + own_heading
    found[:, :, 2, 2] = parts[:, every, 2, every, 2]
    before = place + np.cumsum(found[::-1, -1, :2, :2], axis=0)[::-1]
    found[:-1, :, :2, :2] += before[1:, None]
    found[-1, :, :2, :2] += place
    return found[:, ::-1], before[0]
