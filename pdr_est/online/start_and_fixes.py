"""Start pose and position fixes of a walk, whenever the fixes come."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior, closing_fix, device_starts, start_prior_from
from pdr_est.estimators.common.measurement_checks import refuse_unusable
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.nodes import sort_fixes
from pdr_est.types.measurements import PositionFix, StartPose


class StartAndFixes:
    """Start pose and fixes of a walk; each of several devices gets its share of the information of a fix.

    Parameters
    ----------
    start
        Start pose as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.

    Attributes
    ----------
    fixes
        Remembered fixes, with the covariance of a share, as ordered by `sort_fixes`.
    last_fix_s
        Time of the latest fix.
    latency_s
        Largest latency of the devices' front ends.
    """

    def __init__(self, start: StartPose, sigma_length_scale: float) -> None:
        self._start, self._sigma_length_scale = start, sigma_length_scale
        self._given: list[PositionFix] = []
        self._devices = 1
        self._first: PositionFix | None = None
        self._heading_measured = False  # by a heading prior in the map
        self._restart_states: Mapping[int, GaussianState] = {}
        self.last_fix_s = -inf
        self.latency_s = 0.0
        self.fixes: tuple[PositionFix, ...] = ()

    @property
    def start_may_change(self) -> bool:
        """Tell whether a first fix would change the prior at the start."""
        return self._first is None and self._start_is_open

    @property
    def _start_is_open(self) -> bool:
        return self._start.position_m is None or self._start.heading_rad is None

    def known_until_s(self, end_s: float) -> float:
        """Return the time before which no later step of a device begins whose samples reach up to `end_s`."""
        return end_s - self.latency_s

    def add(self, fix: PositionFix) -> bool:
        """Add a fix.

        Returns
        -------
        bool
            True if the fix changes the prior at the start.

        Raises
        ------
        EstimationError
            For a fix without usable values.
        """
        refuse_unusable("", [], [fix], [])
        earlier = self._first is None or (self._start.position_m is None and fix.time_s <= self._first.time_s)
        changes_start = self._start_is_open and earlier
        if changes_start:
            self._first = fix
        self._given.append(fix)
        self.last_fix_s = max(self.last_fix_s, fix.time_s)
        self.share_among(self._devices)
        return changes_start

    def observe_heading(self) -> bool:
        """Take note of a heading prior in the map; return whether it changes the prior at the start."""
        changes_start = self._start.heading_rad is None and self._first is None and not self._heading_measured
        self._heading_measured = True
        return changes_start

    def share_among(self, devices: int) -> None:
        """Divide the information of each fix equally among a number of devices."""
        self._devices = devices
        ordered = sort_fixes(self._given)
        self.fixes = tuple(replace(fix, covariance_m2=fix.covariance_m2 * devices) for fix in ordered)

    def forget(self, before_s: float, most: int) -> None:
        """Forget the fixes before a time, and keep at most a number of them."""
        if len(self._given) <= most and not any(fix.time_s < before_s for fix in self._given):
            return
        self._given = [fix for fix in self._given if fix.time_s >= before_s][-most:]
        self.share_among(self._devices)

    def restart_from(self, states: Mapping[int, GaussianState]) -> None:
        """Let the walk restart at the present states of the devices, because its start has been forgotten.

        Parameters
        ----------
        states
            Present state of each device, in a frame of its own.
        """
        self._restart_states = states

    def closing_fix(self, device: int, time_s: float, sigma_m: float) -> PositionFix | None:
        """Return the start as a fix at the end of a closed walk; None where the start is found from other fixes."""
        return closing_fix(self.prior(device), time_s, sigma_m)

    def prior(self, device: int) -> StartPrior:
        """Return the prior of a device's state at its first node."""
        observed = self._first is not None or self._heading_measured
        start = device_starts(self._devices, observed, self._start)[device]
        prior = start_prior_from(self._first, observed, start, self._sigma_length_scale)
        here = self._restart_states.get(device)
        if here is None:
            return prior
        mean, covariance = prior.state.mean.copy(), prior.state.covariance.copy()
        if not prior.heading_open:
            mean[2], covariance[2, 2] = here.mean[2], here.covariance[2, 2]
        if not prior.position_open:
            walked_m = here.mean[:2] - mean[:2]
            spread_m2 = np.outer(walked_m, walked_m) + walked_m @ walked_m * np.eye(2)
            covariance[:2, :2] += here.covariance[:2, :2] + spread_m2
        return replace(prior, state=GaussianState(mean, covariance))
