"""Turn steps into measurements for the estimators; the noise of the odometry is set here and nowhere else."""

from dataclasses import replace

import numpy as np

from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, wrap_angle
from pdr_est.front_end.heading.placement_change.turn_density import mean_and_sigma
from pdr_est.params import NonNegative, Positive, params
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
        return [*self._motion(item), *self._heading_prior(item)]

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        """Return nothing: no measurement is held back."""
        return []

    def _heading_prior(self, step: Step) -> list[HeadingPrior]:
        if np.isnan(step.path_heading_rad):
            return []
        sigma = float(np.hypot(step.sigma_path_heading_rad, self._parameters.sigma_straight_rad))
        return [HeadingPrior(self._device, step.event.time_s, step.path_heading_rad, sigma, relative=True)]

    def _motion(self, item: Step) -> list[StepOdometry]:
        previous, self._previous = self._previous, item
        if previous is None:
            return [self._step(item, 0.0, self._sigma_heading(item.event.time_s - item.start_s))]
        elapsed = item.event.time_s - previous.event.time_s
        if item.event.segment == previous.event.segment:
            sigma = self._sigma_heading(elapsed, self._extra_sigma(previous, item))
            if item.turn_hypotheses:
                return [self._undecided_step(item, sigma)]
            return [self._step(item, float(wrap_angle(item.heading_rad - previous.heading_rad)), sigma)]
        bridge = self._bridge(previous, item)
        sigma = self._sigma_heading(item.event.time_s - item.start_s)
        if item.turn_hypotheses:
            return [bridge, self._undecided_step(item, sigma)]
        return [bridge, self._step(item, 0.0, sigma)]

    def _extra_sigma(self, previous: Step, item: Step) -> float:
        """Compute the extra heading-change sigma (rad) from mode changes and re-orientation."""
        modes = {previous.event.mode, item.event.mode} - {CarryingMode.UNKNOWN}
        changed = len(modes) > 1 or CarryingMode.TRANS in modes  # in TRANS the phone turns all the time
        of_mode = self._parameters.sigma_mode_change_rad if changed and not item.placement_tracked else 0.0
        return float(np.hypot(of_mode, item.sigma_turn_rad))

    def _sigma_heading(self, elapsed_s: float, extra_sigma_rad: float = 0.0) -> float:
        return float(np.hypot(self._parameters.sigma_heading_rad_per_sqrt_s * np.sqrt(elapsed_s), extra_sigma_rad))

    def _step(self, step: Step, heading_change_rad: float, sigma_heading_rad: float) -> StepOdometry:
        p = self._parameters
        return StepOdometry(
            device=self._device,
            time_s=step.event.time_s,
            start_s=step.start_s,
            length_m=step.length_m,
            heading_change_rad=heading_change_rad,
            covariance=step_covariance(
                length_m=step.length_m,
                sigma_length_m=float(np.hypot(step.sigma_length_m, p.sigma_length_drift * step.length_m)),
                sigma_direction_rad=p.sigma_direction_rad,
                sigma_heading_rad=sigma_heading_rad,
            )
            + p.sideways_steps * course_covariance(step.length_m, step.sigma_course_rad),
            mode=step.event.mode,
        )

    def _undecided_step(self, step: Step, sigma_heading_rad: float) -> StepOdometry:
        """Make the motion of a step with several possible turns, and their mean and covariance."""
        hypotheses = tuple(
            replace(one, sigma_rad=float(np.hypot(one.sigma_rad, sigma_heading_rad))) for one in step.turn_hypotheses
        )
        change_rad, sigma_rad = mean_and_sigma(hypotheses)
        return replace(self._step(step, change_rad, sigma_rad), turn_hypotheses=hypotheses)

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
            sigma_turn_rad = max(self._sigma_heading(end_s - start_s, item.sigma_turn_rad), 1e-3)
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


def step_covariance(
    length_m: float, sigma_length_m: float, sigma_direction_rad: float, sigma_heading_rad: float
) -> Array:
    """Compute the covariance (3, 3) of forward (m), left (m) and heading (rad) at the end of a step.

    The heading error of the step turns its displacement too: left = length * heading error.

    Parameters
    ----------
    length_m, sigma_length_m : float
        Length of the step and its standard deviation.
    sigma_direction_rad : float
        Standard deviation of the direction of the step around the heading.
    sigma_heading_rad : float
        Standard deviation of the heading change over the step.
    """
    least = 1e-3  # m; keeps the matrix regular for steps of no length
    turn = sigma_heading_rad**2
    return np.array(
        [
            [sigma_length_m**2 + least**2, 0.0, 0.0],
            [0.0, length_m**2 * (turn + sigma_direction_rad**2) + least**2, length_m * turn],
            [0.0, length_m * turn, turn + least**2],
        ]
    )


def course_covariance(length_m: float, sigma_course_rad: float) -> Array:
    """Compute the covariance (3, 3) that a doubtful direction of motion adds to forward (m), left (m), heading (rad).

    It is that of the end of a step whose direction has a normal distribution on the circle, so that a step which
    leads anywhere has the variance length^2 / 2 in both axes. The heading of the next step does not depend on it.

    Parameters
    ----------
    length_m : float
        Length of the step.
    sigma_course_rad : float
        Standard deviation of the direction, rad.
    """
    variance = sigma_course_rad**2
    if not variance:
        return np.zeros((3, 3))
    along, across = 0.5 * (1.0 - np.exp(-variance)) ** 2, 0.5 * (1.0 - np.exp(-2.0 * variance))
    return length_m**2 * np.diag([along, across, 0.0])
