"""Turn steps into measurements for the estimators; the noise of the odometry is set here and nowhere else."""

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, isnan

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, wrap_angle
from pdr_est.front_end.heading.placement_change.turn_density import mean_and_sigma
from pdr_est.front_end.step_noise import course_covariances, step_covariances
from pdr_est.params import NonNegative, Positive, params
from pdr_est.records import changed, made
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.steps import LONGEST_STEP_S, CarryingMode, Step

_LEAST_STEP_S = 0.2
_SHORT_GAP_S = 5.0  # beyond, a walker may have stood meanwhile


@params
class OdometryParams:
    """Standard deviations of a step, and of motion that is not observed."""

    sigma_length_drift: NonNegative = 0.15
    """Standard deviation of a step's length over the length, on top of what its length model gives, for a scale that
    drifts slowly through the walk. Estimators take the errors of steps for independent; those of neighbours are
    alike, so that sums grow faster. On the loops of OxIOD the length of 3 steps is as uncertain as with 0.14 for each
    step, of 20 with 0.17, of 40 with 0.19; the default is right for 20.
    """
    sigma_direction_rad: Positive = 0.18
    """Standard deviation of the direction of a single step around the heading, rad; it does not accumulate."""
    sideways_steps: NonNegative = 7.0
    """Number of steps of a stretch in which a walker moves sideways or backwards, by which the variance of their
    direction is multiplied: the error is common to them, but estimators take those of steps for independent.
    """
    sigma_heading_rad_per_sqrt_s: NonNegative = 0.02
    """Random walk of the heading error, rad per root second, for gyroscope drift and for the phone turning in the
    hand.
    """
    sigma_length_scale: NonNegative = 0.11
    """Standard deviation of the walker's own step length over the model's, constant through a walk: the error of the
    default length model on data sets that were left out of its fit, which is 0.108 with equal weight of the ways of
    carrying in each set (`experiments/step_length_fit.py`).
    """
    sigma_mode_change_rad: NonNegative = 0.5
    """Standard deviation, rad, of the heading change of a step in another carrying mode than the one before, because
    the phone was turned against the body; not used where the heading follows the phone.
    """
    gap_speed_mps: Positive = 1.0
    """Speed, m/s, with which a walker may have moved during a gap of the recording."""
    sigma_gap_length: Positive = 0.3
    """Standard deviation of the way of a walker who walks before and after a short gap, over that way; ours."""
    sigma_straight_rad: Positive = 0.15
    """Standard deviation, rad, of the heading of a step around the straight path that it lies on, independent from
    step to step.
    """


class Odometry:
    """Stage Step -> StepOdometry and HeadingPrior of one device.

    The first step after a gap of the recording is preceded by a bridge over it: an unobserved motion. A step on a
    straight path of known heading is followed by a heading prior, which is relative, because the zero of the headings
    is arbitrary.

    Parameters
    ----------
    device : str
        Name of the device.
    parameters : OdometryParams
        Standard deviations.
    """

    latency_s = 0.0

    def __init__(self, device: str, parameters: OdometryParams) -> None:
        self._device = device
        self._parameters = parameters
        self._previous: Step | None = None

    def push(self, item: Step, /) -> list[StepOdometry | HeadingPrior]:
        """Turn a step into its measurements."""
        return self.push_each([item])[0]

    def push_all(self, items: Sequence[Step], /) -> list[StepOdometry | HeadingPrior]:
        """Turn steps into their measurements."""
        return [output for outputs in self.push_each(items) for output in outputs]

    def push_each(self, items: Sequence[Step], /) -> list[list[StepOdometry | HeadingPrior]]:
        """Turn steps into the measurements of each."""
        if not items:
            return []
        first, self._previous = self._previous, items[-1]
        previous = [items[0] if first is None else first, *items[:-1]]
        begins = [item.event.segment != before.event.segment for before, item in zip(previous, items, strict=True)]
        begins[0] = begins[0] or first is None
        change_rad, sigma_rad = self._turns(previous, items, np.array(begins))
        steps = self._steps(items, change_rad, sigma_rad)
        measured = zip([first, *items[:-1]], items, steps, sigma_rad.tolist(), strict=True)
        return [self._measurements(*one) for one in measured]

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        """Return nothing: no measurement is held back."""
        return []

    def _measurements(
        self, previous: Step | None, step: Step, odometry: StepOdometry, sigma_heading_rad: float
    ) -> list[StepOdometry | HeadingPrior]:
        """Put the measurements of a step together."""
        found: list[StepOdometry | HeadingPrior] = [odometry]
        if previous is not None:
            if step.turn_hypotheses:
                found = [self._undecided_step(step, sigma_heading_rad)]
            if step.event.segment != previous.event.segment:
                found.insert(0, self._bridge(previous, step))
        if not isnan(step.path_heading_rad):
            found.append(self._heading_prior(step))
        return found

    def _heading_prior(self, step: Step) -> HeadingPrior:
        sigma = hypot(step.sigma_path_heading_rad, self._parameters.sigma_straight_rad)
        return HeadingPrior(self._device, step.event.time_s, step.path_heading_rad, sigma, relative=True)

    def _turns(
        self, previous: Sequence[Step], items: Sequence[Step], begins: NDArray[np.bool_]
    ) -> tuple[Array, Array]:
        """Compute the heading changes (n,) of steps since those before, rad, and their standard deviations.

        Steps that begin a segment have none, and the noise of their own time.
        """
        time_s, heading_rad, sigma_turn_rad, start_s, mode, tracked = np.array(
            [
                (
                    one.event.time_s,
                    one.heading_rad,
                    one.sigma_turn_rad,
                    one.start_s,
                    one.event.mode,
                    one.placement_tracked,
                )
                for one in (previous[0], *items)
            ]
        ).T
        before, after, unknown = mode[:-1], mode[1:], float(CarryingMode.UNKNOWN)
        other_mode = (before != after) & (before != unknown) & (after != unknown)
        turns_all_the_time = (before == CarryingMode.TRANS) | (after == CarryingMode.TRANS)
        changed_mode = (other_mode | turns_all_the_time) & (tracked[1:] == 0.0)
        of_mode = np.where(changed_mode, self._parameters.sigma_mode_change_rad, 0.0)
        extra_rad = np.where(begins, 0.0, np.hypot(of_mode, sigma_turn_rad[1:]))
        elapsed_s = time_s[1:] - np.where(begins, start_s[1:], time_s[:-1])
        change_rad = np.where(begins, 0.0, wrap_angle(np.diff(heading_rad)))
        return change_rad, self._sigma_heading(elapsed_s, extra_rad)

    def _sigma_heading(self, elapsed_s: Array | float, extra_sigma_rad: Array | float) -> Array:
        """Compute the standard deviation of a heading change over a time, or of changes (n,) over times (n,), rad."""
        return np.hypot(self._parameters.sigma_heading_rad_per_sqrt_s * np.sqrt(elapsed_s), extra_sigma_rad)

    def _steps(self, steps: Sequence[Step], change_rad: Array, sigma_heading_rad: Array) -> list[StepOdometry]:
        p = self._parameters
        length_m, sigma_length_m, sigma_course_rad = np.array(
            [(step.length_m, step.sigma_length_m, step.sigma_course_rad) for step in steps]
        ).T
        covariance = step_covariances(
            length_m=length_m,
            sigma_length_m=np.hypot(sigma_length_m, p.sigma_length_drift * length_m),
            sigma_direction_rad=p.sigma_direction_rad,
            sigma_heading_rad=sigma_heading_rad,
        )
        covariance += p.sideways_steps * course_covariances(length_m, sigma_course_rad)
        return [
            made(
                StepOdometry,
                device=self._device,
                time_s=step.event.time_s,
                start_s=step.start_s,
                length_m=step.length_m,
                heading_change_rad=change,
                covariance=matrix,
                mode=step.event.mode,
                observed=True,
                turn_hypotheses=(),
            )
            for step, change, matrix in zip(steps, change_rad.tolist(), covariance, strict=True)
        ]

    def _undecided_step(self, step: Step, sigma_heading_rad: float) -> StepOdometry:
        """Make the motion of a step with several possible turns, and their mean and covariance."""
        hypotheses = tuple(
            replace(one, sigma_rad=float(np.hypot(one.sigma_rad, sigma_heading_rad))) for one in step.turn_hypotheses
        )
        change_rad, sigma_rad = mean_and_sigma(hypotheses)
        (undecided,) = self._steps([step], np.array([change_rad]), np.array([sigma_rad]))
        return changed(undecided, turn_hypotheses=hypotheses)

    def _bridge(self, previous: Step, item: Step) -> StepOdometry:
        """Make the unobserved motion over the gaps between two steps.

        Who walked before and after goes on at the same speed; who stood on one side at least may have gone anywhere
        within reach. The turn is that of the headings, unless the step itself has possible turns. Where the gap is
        not described, the heading has another zero after it.
        """
        p = self._parameters
        start_s, end_s = previous.event.time_s, max(item.start_s, previous.event.time_s)
        gap_s = sum(min(hole.duration_s, end_s - start_s) for hole in item.holes) if item.holes else end_s - start_s
        length_m, sigma_m = 0.0, p.gap_speed_mps * gap_s
        if _walks_on(previous, item) and gap_s < _SHORT_GAP_S:
            speed_mps = previous.length_m / max(previous.event.time_s - previous.start_s, _LEAST_STEP_S)
            length_m = speed_mps * (end_s - start_s)
            sigma_m = p.sigma_gap_length * length_m
        turn_rad, sigma_turn_rad = 0.0, SIGMA_UNIFORM_RAD
        if item.holes:
            turn_rad = 0.0 if item.turn_hypotheses else float(wrap_angle(item.heading_rad - previous.heading_rad))
            sigma_turn_rad = max(float(self._sigma_heading(end_s - start_s, item.sigma_turn_rad)), 1e-3)
        return StepOdometry(
            device=self._device,
            time_s=end_s,
            start_s=start_s,
            length_m=length_m,
            heading_change_rad=turn_rad,
            covariance=np.diag([max(sigma_m, 1e-3) ** 2, max(sigma_m, 1e-3) ** 2, sigma_turn_rad**2]),
            mode=item.event.mode,
            observed=False,
        )


def _walks_on(previous: Step, item: Step) -> bool:
    """Return True for steps so near to the gap between them that the walker walks on both sides of it."""
    if not item.holes or not all(hole.duration_known for hole in item.holes):
        return False
    before_s = item.holes[0].start_s - previous.event.time_s
    after_s = item.start_s - item.holes[-1].end_s
    return before_s < LONGEST_STEP_S and after_s < LONGEST_STEP_S
