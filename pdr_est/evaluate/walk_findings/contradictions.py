"""Position fixes of one moment that contradict each other: whatever the steps say, one of them is wrong."""

import math
from collections.abc import Sequence
from functools import partial
from itertools import takewhile

import numpy as np

from pdr_est.evaluate.walk_findings.fix_residuals import FALSE_ALARMS, chance_limit
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import PositionFix

_SAME_MOMENT_S = 0.05  # in which nobody walks farther than surveyed points are accurate; ours
_REMEMBERED = 20  # fixes, for a second one of the same moment


def contradictions(fixes: Sequence[PositionFix]) -> list[Finding]:
    """Find pairs of fixes of one moment whose distance is larger than their errors allow.

    Parameters
    ----------
    fixes
        Fixes of the walk in order of time.
    """
    pairs = [
        (one, other) for i, one in enumerate(fixes) for other in takewhile(partial(_same_moment, one), fixes[i + 1 :])
    ]
    limit = chance_limit(FALSE_ALARMS / max(len(pairs), 1))
    return [contradiction_of(one, other) for one, other in pairs if squared_distance_of(one, other) > limit]


class ContradictionsSoFar:
    """Find fixes that contradict earlier ones of the same moment while they come."""

    def __init__(self) -> None:
        self._recent: list[PositionFix] = []
        self._compared = 0

    def add(self, fix: PositionFix) -> Finding | None:
        """Add a fix; return the contradiction to the one of the same moment that is farthest from it, if any is."""
        same = [one for one in self._recent if _same_moment(one, fix)]
        self._recent = [*self._recent[-_REMEMBERED:], fix]
        if not same:
            return None
        self._compared += 1
        farthest = max(same, key=lambda one: squared_distance_of(one, fix))
        # The shares 1 / (k (k + 1)) of the probability of a false alarm add up to 1, however many fixes come.
        limit = chance_limit(FALSE_ALARMS / (self._compared * (self._compared + 1)))
        return contradiction_of(farthest, fix) if squared_distance_of(farthest, fix) > limit else None


def squared_distance_of(one: PositionFix, other: PositionFix) -> float:
    """Return the squared distance of two fixes in units of the covariance of their difference.

    The wandering error of one source is common to both and does not count.
    """
    apart_m = np.asarray(one.position_m) - np.asarray(other.position_m)
    if one.source == other.source:
        covariance_m2 = np.asarray(one.covariance_m2) + np.asarray(other.covariance_m2)
    else:
        covariance_m2 = one.total_covariance_m2 + other.total_covariance_m2
    return float(apart_m @ np.linalg.solve(covariance_m2, apart_m))


def contradiction_of(one: PositionFix, other: PositionFix) -> Finding:
    """Say that two fixes of one moment contradict each other."""
    distance_m = float(np.hypot(*(np.asarray(one.position_m) - np.asarray(other.position_m))))
    times = math.sqrt(squared_distance_of(one, other))
    names = one.source if one.source == other.source else f"{one.source}, {other.source}"
    return Finding(
        FindingKind.FIXES,
        f"two position fixes ({names}) at {other.time_s:.1f} s contradict each other: they are {distance_m:.1f} m "
        f"apart, {times:.1f} times the standard deviation: one of the two places, times or accuracies is wrong",
        begin_s=min(one.time_s, other.time_s),
        end_s=max(one.time_s, other.time_s),
        value=distance_m,
        sigma=distance_m / times,
    )


def _same_moment(one: PositionFix, other: PositionFix) -> bool:
    return abs(one.time_s - other.time_s) <= _SAME_MOMENT_S
