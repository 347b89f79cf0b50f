"""Stage that makes heading priors in the map from the direction of north."""

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees, hypot, inf, isfinite, isinf, nan, sqrt

from pdr_est.frames import SIGMA_UNIFORM_RAD
from pdr_est.front_end.heading.north.correlated_error import CorrelatedHeadingError, IndependentSigma
from pdr_est.front_end.heading.north.north_offset import magnetic_north_offsets, recorded_north_offsets
from pdr_est.front_end.heading.north.params import NorthParams
from pdr_est.front_end.heading.north.pointing import HoldTracker, Pointing, final_pointings
from pdr_est.front_end.heading.north.reference import NorthReference
from pdr_est.front_end.heading.phone_posture import wrapped
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import HeadingPrior
from pdr_est.types.steps import Step

_LARGEST_SIGMA_RAD = 1.0  # a prior beyond would tell nothing: it waits until there is more to tell
_LATEST_S = 10.0  # a prior that waited longer belongs to the latest step and not to the first one


@dataclass(frozen=True)
class _Stretch:
    """Time span, s, in which north disagreed with the gyroscope, and the largest disagreement, rad, and its sigma."""

    begin_s: float
    end_s: float
    largest_rad: float
    sigma_rad: float


class NorthPriors:
    """Stage Step -> HeadingPrior of one device, absolute, from steps with the phone held in front of the body.

    In a pocket or a bag, and in a swinging hand, nothing says how the phone sits on the body, and there is no prior.
    The first one, and the first after a gap, come after some such steps, and are of the first of these. What is not
    certain of the direction in which the walker goes, relative to the phone, is part of the error that stays.

    Parameters
    ----------
    device
        Name of the device.
    reference
        Source of the direction, and its declination.
    parameters
        Standard deviations and spacing.
    sigma_heading_rad_per_sqrt_s
        Random walk of the heading error from step to step, rad per root second.
    at_the_end
        True to make all priors at the end of the walk, when all strides tell how the phone is held.

    References
    ----------
    Laidig and Seel: VQF, Information Fusion 2023, levels the magnetic field.
    """

    latency_s = 0.0

    def __init__(
        self,
        device: str,
        reference: NorthReference,
        parameters: NorthParams,
        sigma_heading_rad_per_sqrt_s: float,
        at_the_end: bool = False,
    ) -> None:
        self._device, self._reference, self._parameters = device, reference, parameters
        self._drift_per_sqrt_s = sigma_heading_rad_per_sqrt_s
        calibration_rad = 0.0 if reference.source == "device" else parameters.sigma_calibration_rad
        self._stays_rad = hypot(parameters.sigma_hold_rad, reference.sigma_declination_rad, calibration_rad)
        self._error = CorrelatedHeadingError(
            self._stays_rad, parameters.sigma_disturbance_rad, parameters.disturbance_length_m
        )
        self._holds = HoldTracker(reference.usual_axes)
        self._waiting: list[Step] | None = [] if at_the_end else None
        self._pointing_rad = 0.0  # standard deviation of the latest direction in which the phone points
        self._measured = False
        self._previous: Step | None = None
        self._first: Step | None = None  # of the steps that told a direction since the last prior
        self._steps = 0  # number of these
        self._doubt = 0.0  # sum of their probabilities that the phone is elsewhere
        self._offset_sum = 0j  # unit vectors of their headings in the map less those of the steps
        self._walked_m = inf  # since the last prior
        self._disturbed: list[_Stretch] = []
        self._in_disturbance = False

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Describe the stretches that disagreed with the rest."""
        return tuple(self._finding(stretch) for stretch in self._disturbed)

    def push(self, item: Step, /) -> list[HeadingPrior]:
        """Take a step; return a prior where one is due."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[HeadingPrior]:
        """Take steps; return the priors that are due."""
        return [prior for priors in self.push_each(items) for prior in priors]

    def push_each(self, items: Sequence[Step], /) -> list[list[HeadingPrior]]:
        """Take steps; return the priors that are due at each."""
        if self._waiting is not None:
            self._waiting += items
            return [[] for _ in items]
        return self._take_all(
            items, [None if hold is None else hold.pointing() for hold in map(self._holds.push, items)]
        )

    def _take_all(self, items: Sequence[Step], pointings: Sequence[Pointing | None]) -> list[list[HeadingPrior]]:
        told = [pointing is not None and pointing.decided for pointing in pointings]
        offsets = recorded_north_offsets if self._reference.source == "device" else magnetic_north_offsets
        north = iter(offsets([item.samples for item, decided in zip(items, told, strict=True) if decided]))
        return [
            self._take(item, pointing, self._offset(item, pointing, next(north)) if pointing and decided else nan)
            for item, pointing, decided in zip(items, pointings, told, strict=True)
        ]

    def _take(self, item: Step, pointing: Pointing | None, offset_rad: float) -> list[HeadingPrior]:
        """Take a step, where the heading in the map less that of the step is known if the phone tells it."""
        self._move(item)
        if pointing is not None and pointing.decided:
            self._pointing_rad = pointing.sigma_rad
        if isfinite(offset_rad):
            self._first = self._first or item
            self._steps, self._offset_sum = self._steps + 1, self._offset_sum + cmath.rect(1.0, offset_rad)
            self._doubt += 1.0 - item.event.mode_probability
        elif self._steps < self._parameters.least_steps:
            first = self._first or item
            self._begin_window(self._walked_m)
            if pointing is not None:  # in the hand, and its direction may soon be known
                self._first = first
        if self._walked_m < self._parameters.spacing_m:
            return []
        return self._prior_if_due(item)

    def _prior_if_due(self, step: Step) -> list[HeadingPrior]:
        p, first = self._parameters, self._first
        if first is None or self._steps < p.least_steps:
            return []
        if not self._measured:
            self._error.set_stays(hypot(self._stays_rad, self._pointing_rad))
        sigma_rad = sqrt((p.sigma_step_rad**2 + self._doubt * SIGMA_UNIFORM_RAD**2) / self._steps)
        if self._error.expected_sigma(sigma_rad) > _LARGEST_SIGMA_RAD:
            return []
        self._measured = True
        offset_rad = cmath.phase(self._offset_sum)
        found = self._error.measure(wrapped(step.heading_rad + offset_rad), sigma_rad)
        self._note_disturbance(found, first.start_s, step.event.time_s)
        # What orients the walk belongs to its beginning.
        begins = isinf(self._walked_m) and step.event.time_s - first.event.time_s < _LATEST_S
        at = first if begins else step
        self._begin_window(0.0)
        heading_rad = wrapped(at.heading_rad + offset_rad)
        return [HeadingPrior(self._device, at.event.time_s, heading_rad, found.sigma_rad)]

    def flush(self) -> list[HeadingPrior]:
        """Return the priors that waited for the end of the walk."""
        if self._waiting is None:
            return []
        steps, self._waiting = self._waiting, []
        found = self._take_all(steps, final_pointings(steps, self._reference.usual_axes))
        return [prior for priors in found for prior in priors]

    def _move(self, step: Step) -> None:
        previous, self._previous = self._previous, step
        if previous is None:
            return
        if step.event.segment != previous.event.segment:
            self._error.forget_heading()
            self._in_disturbance = False
            self._begin_window(inf)
            return
        passed_s = max(step.event.time_s - previous.event.time_s, 0.0)
        variance = self._drift_per_sqrt_s**2 * passed_s + step.sigma_turn_rad**2
        self._error.move(wrapped(step.heading_rad - previous.heading_rad), variance, step.length_m)
        self._walked_m += step.length_m

    def _begin_window(self, walked_m: float) -> None:
        self._first, self._steps, self._doubt = None, 0, 0.0
        self._offset_sum, self._walked_m = 0j, walked_m

    def _offset(self, step: Step, pointing: Pointing, north_rad: float) -> float:
        """Compute the heading in the map less that of the step, rad; NaN where the phone does not tell it."""
        map_rad = pointing.azimuth(step) + north_rad - self._reference.declination_rad
        return wrapped(map_rad + step.course_offset_rad - step.heading_rad)

    def _note_disturbance(self, found: IndependentSigma, begin_s: float, end_s: float) -> None:
        disturbed = found.innovation_sigmas > self._parameters.disturbed_sigmas
        if disturbed:
            off_rad = abs(found.innovation_rad)
            stretch = _Stretch(begin_s, end_s, off_rad, off_rad / found.innovation_sigmas)
            if self._in_disturbance:
                before = self._disturbed.pop()
                larger = max(before, stretch, key=lambda one: one.largest_rad)
                stretch = replace(larger, begin_s=before.begin_s, end_s=end_s)
            self._disturbed.append(stretch)
        self._in_disturbance = disturbed

    def _finding(self, stretch: _Stretch) -> Finding:
        source = "attitude" if self._reference.source == "device" else "magnetometer"
        return Finding(
            FindingKind.NORTH,
            f"north by the {source} between {stretch.begin_s:.0f} s and {stretch.end_s:.0f} s disagrees with the "
            f"gyroscope by up to {degrees(stretch.largest_rad):.0f} degrees: weighed down",
            device=self._device,
            begin_s=stretch.begin_s,
            end_s=stretch.end_s,
            value=stretch.largest_rad,
            sigma=stretch.sigma_rad,
        )
