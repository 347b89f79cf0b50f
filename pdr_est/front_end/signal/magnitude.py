"""What an accelerometer felt, put together again from acceleration and direction of gravity."""

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.front_end.signal.vectors import norm


def specific_force(up: Array, acceleration_mps2: Array) -> Array:
    """The accelerometer's reading (n, 3) in device axes, gravity included.

    up: (n, 3) unit vector up; acceleration_mps2: (n, 3) without gravity; both in device axes.
    """
    return acceleration_mps2 + STANDARD_GRAVITY_MPS2 * up


def excess_magnitude(up: Array, acceleration_mps2: Array) -> Array:
    """Length of the specific force less standard gravity (n,), m/s^2: the same for every orientation of the phone."""
    return norm(specific_force(up, acceleration_mps2)) - STANDARD_GRAVITY_MPS2
