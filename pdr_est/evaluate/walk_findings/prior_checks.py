"""Finding about what nobody told before the walk: the direction of the track in the map."""

from collections.abc import Sequence

from pdr_est.estimators.common.unknown_direction import tells_direction
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, PositionFix, StartPose


def unknown_direction_finding(devices: Sequence[DeviceMeasurements], start: StartPose) -> Finding | None:
    """Tell that the direction of a track in the map is unknown although one place of it is known; else None.

    A position at another place or a heading in the map frame makes the direction known.

    Parameters
    ----------
    devices
        What the estimator was given of each device.
    start
        Start pose as far as it is known.
    """
    given = [one for device in devices for one in device.measurements]
    fixes = {tuple(one.position_m) for one in given if isinstance(one, PositionFix)}
    places = fixes if start.position_m is None else {*fixes, tuple(start.position_m)}
    headed = any(tells_direction(one) for one in given if not isinstance(one, PositionFix))
    if len(places) != 1 or headed or start.heading_rad is not None:
        return None
    by_start = start.position_m is not None
    known, pivot = ("a start position without a heading", "its start") if by_start else ("one position", "it")
    return Finding(
        FindingKind.START_HEADING,
        f"the direction of the track is unknown: {known} does not tell in which direction the walk began, so that "
        f"the track is turned arbitrarily about {pivot}: give the heading of the first step (--heading) or a "
        "position fix at another place (--fixes)",
    )
