"""Distances of devices on one body, compared with what their tether allows."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import DeviceTether
from pdr_est.types.track import Track

TOLERATED_SIGMAS = 2.5
"""A distance this many standard deviations of the tether beyond its length is too large (ours)."""

TOLERATED_SHARE = 0.05
"""Share of the tethers whose distance may be too large (ours): more than chance gives with `TOLERATED_SIGMAS`."""


def tether_findings(track: Track, tethers: Sequence[DeviceTether]) -> list[Finding]:
    """Find pairs of devices that are farther apart than their tethers allow.

    A filter applies a tether to the last poses of the two devices before it, which may be a step apart; this distance
    is tolerated in every track that is not smoothed.

    Parameters
    ----------
    track
        Track of all devices at the centre of the body.
    tethers
        Tethers of the walk.
    """
    by_pair: defaultdict[tuple[str, str], list[DeviceTether]] = defaultdict(list)
    for tether in tethers:
        by_pair[tether.device_a, tether.device_b].append(tether)
    return [finding for pair in by_pair.values() if (finding := _of_pair(track, pair)) is not None]


def _of_pair(track: Track, tethers: Sequence[DeviceTether]) -> Finding | None:
    first, second = (track.of_device(name) for name in (tethers[0].device_a, tethers[0].device_b))
    if not len(first) or not len(second):
        return None
    time_s = np.array([tether.time_s for tether in tethers])
    length_m = np.array([tether.max_distance_m for tether in tethers])
    sigma_m = np.array([tether.sigma_m for tether in tethers])
    steps_m = np.concatenate([first.step_length_m[1:], second.step_length_m[1:]])
    step_m = 0.0 if track.kind == "smoothed" or not len(steps_m) else float(np.median(steps_m))
    excess_m = np.linalg.norm(first.at(time_s)[0] - second.at(time_s)[0], axis=1) - length_m
    slack = excess_m > TOLERATED_SIGMAS * sigma_m + step_m
    share = float(slack.mean())
    if share <= TOLERATED_SHARE:
        return None
    names, worst = f"{tethers[0].device_a} and {tethers[0].device_b}", int(np.argmax(excess_m))
    return Finding(
        FindingKind.TETHER,
        f"{names} are farther apart than {length_m[worst]:g} m for {share:.0%} of the time, by up to "
        f"{excess_m[worst]:.1f} m at {time_s[worst]:.0f} s: the clock or a heading of one of them is wrong, or they "
        "were not carried by one person all the time",
        begin_s=float(time_s[slack][0]),
        end_s=float(time_s[slack][-1]),
        value=float(excess_m[worst]),
        sigma=float(sigma_m[worst]),
    )
