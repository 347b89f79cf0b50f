"""What is known of the walk besides the devices' samples: its start, and fixes whenever they come."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior, start_prior
from pdr_est.estimators.common.measurement_checks import refuse_unusable
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import starts_of
from pdr_est.estimators.common.timeline import Node, Timeline
from pdr_est.estimators.kalman.single_device import home_fix
from pdr_est.types.measurements import PositionFix, StartPose
from pdr_est.types.steps import CarryingMode


class StartAndFixes:
    """Start and fixes of a walk, of which each of several devices gets its share of the information.

    fixes: those that may still matter, as shares, in the order in which a timeline takes them. latency_s: of the
    devices' front ends, the longest.
    """

    def __init__(self, start: StartPose, sigma_length_scale: float) -> None:
        self._start, self._sigma_length_scale = start, sigma_length_scale
        self._given: list[PositionFix] = []
        self._devices = 1
        self._first: PositionFix | None = None
        self._walked: Mapping[int, GaussianState] = {}
        self.last_fix_s = -np.inf
        self.latency_s = 0.0
        self.fixes: tuple[PositionFix, ...] = ()

    @property
    def start_may_open(self) -> bool:
        """Whether a first fix would tell where the walk began."""
        return self._first is None and (self._start.position_m is None or self._start.heading_rad is None)

    def reached_s(self, end_s: float) -> float:
        """No step still to come begins before this, when the samples of a device reach up to end_s."""
        return end_s - self.latency_s

    def add(self, fix: PositionFix) -> bool:
        """Take a fix; return whether it changes what is known of the start.

        Raises EstimationError for a fix that cannot be used.
        """
        refuse_unusable("", [], [fix], [])
        start_open = self._start.position_m is None or self._start.heading_rad is None
        earlier = self._first is None or (self._start.position_m is None and fix.time_s <= self._first.time_s)
        if start_open and earlier:
            self._first = fix
        self._given.append(fix)
        self.last_fix_s = max(self.last_fix_s, fix.time_s)
        self.share(self._devices)
        return start_open and earlier

    def share(self, devices: int) -> None:
        """Divide the information of the fixes among so many devices."""
        self._devices = devices
        latest_first = sorted(self._given, key=lambda fix: fix.time_s, reverse=True)
        self.fixes = tuple(replace(fix, covariance_m2=fix.covariance_m2 * devices) for fix in reversed(latest_first))

    def forget(self, before_s: float, most: int) -> None:
        """Forget the fixes before a time, which have been used, and keep no more than so many."""
        if len(self._given) <= most and not any(fix.time_s < before_s for fix in self._given):
            return
        self._given = [fix for fix in self._given if fix.time_s >= before_s][-most:]
        self.share(self._devices)

    def begin_anew(self, walked: Mapping[int, GaussianState]) -> None:
        """The start is too long ago to be gone through again: from now on it is where the devices are, in a frame of
        their own."""
        self._walked = walked

    def home(self, device: int, time_s: float, sigma_m: float) -> PositionFix | None:
        """The start as a fix at the end of a closed walk; None where the start is found from other fixes."""
        prior = self.prior(device, self._devices)
        if prior.position_open or prior.heading_open:
            return None
        return home_fix(prior.moments, time_s, sigma_m)

    def prior(self, device: int, devices: int) -> StartPrior:
        """Of the state of a device at its first node."""
        fixes = () if self._first is None else (self._first,)
        stub = Node(0.0, 0.0, 0.0, 0.0, np.zeros((3, 3)), True, 0.0, CarryingMode.UNKNOWN, fixes)
        timelines = [Timeline("", (stub,))] * devices
        start = starts_of(timelines, self._start)[device]
        prior = start_prior(timelines[0], start, self._sigma_length_scale)
        here = self._walked.get(device)
        if here is None:
            return prior
        mean, covariance = prior.moments.mean.copy(), prior.moments.covariance.copy()
        if not prior.heading_open:
            mean[2], covariance[2, 2] = here.mean[2], here.covariance[2, 2]
        if not prior.position_open:
            walked = here.mean[:2] - mean[:2]
            covariance[:2, :2] += here.covariance[:2, :2] + np.outer(walked, walked) + walked @ walked * np.eye(2)
        return replace(prior, moments=GaussianState(mean, covariance))
