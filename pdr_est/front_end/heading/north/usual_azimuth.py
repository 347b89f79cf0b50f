"""The direction that a phone in front of the body points to by the usual axes of phones, which is the walker's."""

from math import atan2, cos, hypot, nan, radians

from pdr_est.types.steps import StepMotion

_LYING = cos(radians(30.0))  # cosine of the tilt below which a phone has no side that is up
_SCREEN_DOWN = -0.3  # upward component of the screen below which nobody looks at it


def usual_azimuth(motion: StepMotion) -> float:
    """Compute the direction, in the level frame of the yaw, that a phone in front of the body points to.

    Of a phone that lies flat, it is that of the top edge; of an upright one, that of the camera on its back. In
    between the two are the same for a phone in portrait format, and are averaged by their horizontal lengths. In
    landscape format only the back tells the direction.

    Returns
    -------
    float
        Direction, rad, counter-clockwise from the x axis of the level frame; NaN for a phone with its screen down.
    """
    up, east, north = motion.up, motion.east, motion.north
    if up[2] < _SCREEN_DOWN:
        return nan
    top, back = 0.0, 1.0
    if up[2] > _LYING or up[1] > abs(up[0]):  # portrait format
        top, back = max(up[2], 0.0), hypot(up[0], up[1])
    # The top edge is along the second axis of the device, the back against the third one.
    return atan2(top * north[1] - back * north[2], top * east[1] - back * east[2])
