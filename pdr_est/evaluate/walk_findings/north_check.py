"""Comparison of the phone's knowledge of north with the direction of the finished track."""

from collections.abc import Sequence
from math import degrees

import numpy as np

from pdr_est.frames import wrap_angle
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceMeasurements, HeadingPrior
from pdr_est.types.track import Track

_MOST_SIGMAS = 3.0  # ours: 1 in 400 walks with right standard deviations


def north_findings(track: Track, devices: Sequence[DeviceMeasurements]) -> list[Finding]:
    """Find the devices whose headings against north contradict the direction that the whole walk has.

    The track has followed these headings as far as it believed them, so that the difference that is told is the least
    that it can be.

    Parameters
    ----------
    track
        Track of all devices.
    devices
        What the estimator was given.
    """
    found = [_of_device(track.of_device(one.device), one) for one in devices]
    return [finding for finding in found if finding is not None]


def _of_device(track: Track, device: DeviceMeasurements) -> Finding | None:
    priors = [one for one in device.measurements if isinstance(one, HeadingPrior) and not one.relative]
    if not priors:
        return None
    time_s = np.array([prior.time_s for prior in priors])
    heading_rad = np.interp(time_s, track.time_s, np.unwrap(track.heading_rad))
    weight = np.array([prior.sigma_rad for prior in priors]) ** -2.0
    off = np.asarray(wrap_angle(np.array([prior.heading_rad for prior in priors]) - heading_rad))
    off_rad = float(np.angle(np.sum(weight * np.exp(1j * off))))
    sigma_rad = float(np.sum(weight) ** -0.5)
    if abs(off_rad) < _MOST_SIGMAS * sigma_rad:
        return None
    side = "left" if off_rad > 0.0 else "right"
    return Finding(
        FindingKind.NORTH,
        f"the phone's north turns the walk {degrees(abs(off_rad)):.0f} degrees to the {side} of where the other "
        f"measurements have it, {abs(off_rad) / sigma_rad:.1f} times its standard deviation: the phone was held "
        "askew, its compass is disturbed, or the map is not north-up; heading.north.source: none leaves it out",
        device=device.device,
        begin_s=float(time_s[0]),
        end_s=float(time_s[-1]),
        value=off_rad,
        sigma=sigma_rad,
    )
