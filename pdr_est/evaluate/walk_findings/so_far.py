"""Findings about a walk that goes on, from the poses of a filter as they come."""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from pdr_est.estimators.common.length_scale_check import length_scale_finding
from pdr_est.evaluate.walk_findings.contradictions import ContradictionsSoFar
from pdr_est.evaluate.walk_findings.fix_residuals import FALSE_ALARMS, chance_limit, disagreement, fix_residual
from pdr_est.frames import Array
from pdr_est.types.findings import Finding
from pdr_est.types.measurements import PositionFix
from pdr_est.types.track import Track

QUIET_S = 30.0
"""Time after a finding about the fixes of a source for which there is no further one about it, s (ours)."""

_REMEMBERED = 200  # poses of each device, for late fixes, and fixes for a pose after them


class PoseRow(Protocol):
    """Filtered pose of a device at the end of a step, as `online.Update` has it."""

    @property
    def device(self) -> str:
        """Return the name of the device."""

    @property
    def time_s(self) -> float:
        """Return the time of the pose, s."""

    @property
    def moving_from_s(self) -> float:
        """Return the time at which the step began, s."""

    @property
    def position_m(self) -> Array:
        """Return the position (2,), m."""

    @property
    def covariance_m2(self) -> Array:
        """Return its covariance (2, 2), m²."""

    @property
    def heading_rad(self) -> float:
        """Return the heading, rad."""

    @property
    def step_length_m(self) -> float:
        """Return the length of the step, m."""


class FindingsSoFar:
    """Find fixes that disagree with the walk until then, and an unusual length scale; each is told once.

    Parameters
    ----------
    sigma_length_scale
        Standard deviation of the logarithm of the length scale over walkers.
    """

    def __init__(self, sigma_length_scale: float) -> None:
        self._sigma_length_scale = sigma_length_scale
        self._rows: dict[str, dict[float, PoseRow]] = {}
        self._waiting: list[PositionFix] = []  # for a pose after them
        self._contradictions = ContradictionsSoFar()
        self._untold: list[Finding] = []  # contradictions that were not told yet
        self._compared = 0
        self._told_s: dict[str, float] = {}  # by source
        self._scale_told = False

    def add_fix(self, fix: PositionFix) -> None:
        """Add a fix, which is compared as soon as there is a pose after it."""
        found = self._contradictions.add(fix)
        if found is not None and fix.time_s > self._told_s.get(fix.source, -math.inf) + QUIET_S:
            self._told_s[fix.source] = fix.time_s
            self._untold.append(found)
        self._waiting = [*self._waiting[-_REMEMBERED:], fix]

    def add(self, rows: Sequence[PoseRow], length_scale: float) -> list[Finding]:
        """Add poses, at the centre of the body, that are new or have changed; return the findings that are new.

        Parameters
        ----------
        rows
            The poses; a later one of the same device and time counts.
        length_scale
            Present length scale of the filter.
        """
        for row in rows:
            own = self._rows.setdefault(row.device, {})
            own[row.time_s] = row
            if len(own) > 2 * _REMEMBERED:
                self._rows[row.device] = {time_s: own[time_s] for time_s in sorted(own)[-_REMEMBERED:]}
        found, self._untold = self._untold, []
        found += self._about_fixes() if self._waiting else []
        if not self._scale_told and rows:
            scale = length_scale_finding(length_scale, self._sigma_length_scale)
            self._scale_told = scale is not None
            found += [] if scale is None else [scale]
        return found

    def _about_fixes(self) -> list[Finding]:
        latest_s = max((time_s for own in self._rows.values() for time_s in own), default=-math.inf)
        ready = [fix for fix in self._waiting if fix.time_s < latest_s]
        self._waiting = [fix for fix in self._waiting if fix.time_s >= latest_s]
        if not ready:
            return []
        tracks = [_track_of(own) for own in self._rows.values()]
        found = []
        for fix in ready:
            after = [track for track in tracks if fix.time_s < track.time_s[-1]]
            residuals = [one for track in after if (one := fix_residual(fix, track, len(tracks))) is not None]
            if not residuals:
                continue
            nearest = min(residuals, key=lambda one: one.squared)
            self._compared += 1
            # The shares 1 / (k (k + 1)) of the probability of a false alarm add up to 1, however many fixes come.
            limit = chance_limit(FALSE_ALARMS / (self._compared * (self._compared + 1)))
            quiet_until_s = self._told_s.get(fix.source, -math.inf) + QUIET_S
            if nearest.squared > limit and fix.time_s > quiet_until_s:
                self._told_s[fix.source] = fix.time_s
                found.append(disagreement(fix.source, [nearest], self._compared))
        return found


def _track_of(rows: dict[float, PoseRow]) -> Track:
    """Make a filtered track of the poses of one device."""
    ordered = [rows[time_s] for time_s in sorted(rows)]
    return Track(
        time_s=np.array([row.time_s for row in ordered]),
        moving_from_s=np.array([row.moving_from_s for row in ordered]),
        device=np.array([row.device for row in ordered]),
        position_m=np.array([row.position_m for row in ordered]),
        heading_rad=np.array([row.heading_rad for row in ordered]),
        covariance_m2=np.array([row.covariance_m2 for row in ordered]),
        sigma_heading_rad=np.zeros(len(ordered)),
        mode=np.zeros(len(ordered), dtype=np.int8),
        step_length_m=np.array([row.step_length_m for row in ordered]),
        kind="filtered",
        estimator="",
    )
