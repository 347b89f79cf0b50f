"""Convert attitude and gravity of Android and Apple to the project's axes.

The project's quaternions have w first and rotate device to level axes (z up); its specific force points up at rest.
Android's convention is the same. Apple's Core Motion gives gravity and user acceleration in g, with gravity pointing
down at rest.
"""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device

_AGREEMENT = 0.1  # about 6 degrees between the attitude's vertical and gravity


def quaternion_from_rotation_vector(vector: Array) -> Array:
    """Convert Android rotation vectors (n, 3) to quaternions (n, 4), w first; their w is never negative."""
    w = np.sqrt(np.maximum(0.0, 1.0 - np.square(vector).sum(axis=1)))
    return np.column_stack([w, vector])


def turned_to_east(attitude: Array) -> Array:
    """Turn attitudes (n, 4) whose level frame has x north and z up, as Core Motion's, to one with x east, y north."""
    half = np.sqrt(0.5)  # of the quaternion of a quarter turn counter-clockwise, which takes x north to y north
    w, x, y, z = attitude.T
    return np.column_stack([half * (w - z), half * (x - y), half * (y + x), half * (z + w)])


def specific_force_from_core_motion(gravity_g: Array, user_acceleration_g: Array) -> Array:
    """Compute specific force, m/s^2, up at rest, from Core Motion's gravity and user acceleration, g, (n, 3) each."""
    force: Array = -(gravity_g + user_acceleration_g) * STANDARD_GRAVITY_MPS2
    return force


def vertical_mismatch(attitude: Array, up: Array) -> float:
    """Compare the up direction of an attitude with recorded gravity.

    Parameters
    ----------
    attitude
        (n, 4) quaternions, device to level axes.
    up
        (n, 3) unit vectors up in device axes, from the recorded gravity.

    Returns
    -------
    float
        Median distance of the two unit vectors; NaN without a finite row.
    """
    finite = np.isfinite(attitude).all(axis=1) & np.isfinite(up).all(axis=1)
    if not finite.any():
        return float("nan")
    return float(np.median(np.linalg.norm(up_in_device(attitude[finite]) - up[finite], axis=1)))


def vertical_mismatch_warnings(attitude: Array, up: Array) -> tuple[str, ...]:
    """Warn when the recorded attitude and the recorded gravity do not agree (see `vertical_mismatch`)."""
    mismatch = vertical_mismatch(attitude, up)
    if mismatch < _AGREEMENT:
        return ()
    return (
        f"the up directions of recorded attitude and gravity differ by {mismatch:.2f} (distance of unit vectors)",
    )
