"""Turn steps into measurements for the estimators; the noise of the odometry is set here and nowhere else."""

from dataclasses import replace

import numpy as np

from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, wrap_angle
from pdr_est.front_end.heading.placement_change.turn_density import mean_and_sigma
from pdr_est.params import NonNegative, Positive, params
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.steps import CarryingMode, Step


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
    """Speed, m/s, with which a walker may have moved during a gap."""
    gap_turn_rad_per_sqrt_s: Positive = 1.0
    """Random walk of the walker's heading during a gap, rad per root second."""
    sigma_straight_rad: Positive = 0.15
    """Standard deviation, rad, of the heading of a step around the straight path that it lies on, independent from
    step to step.
    """


class Odometry:
    """Stage Step -> StepOdometry and HeadingPrior of one device.

    The first step of a new segment is preceded by a bridge over the gap: an unobserved motion. A step on a straight
    path of known heading is followed by a heading prior, which is relative, because the zero of the headings is
    arbitrary. After a gap the zero is another one, so that priors are given in the first segment only.

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
        self._first_segment: int | None = None

    def push(self, item: Step, /) -> list[StepOdometry | HeadingPrior]:
        """Turn a step into its measurements."""
        return [*self._motion(item), *self._heading_prior(item)]

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        """Return nothing: no measurement is held back."""
        return []

    def _heading_prior(self, step: Step) -> list[HeadingPrior]:
        if self._first_segment is None:
            self._first_segment = step.event.segment
        if np.isnan(step.path_heading_rad) or step.event.segment != self._first_segment:
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
        bridge = self._bridge(previous.event.time_s, item.start_s, item.event.mode)
        return [bridge, self._step(item, 0.0, self._sigma_heading(item.event.time_s - item.start_s))]

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
            ),
            mode=step.event.mode,
        )

    def _undecided_step(self, step: Step, sigma_heading_rad: float) -> StepOdometry:
        """Make the motion of a step with several possible turns, and their mean and covariance."""
        hypotheses = tuple(
            replace(one, sigma_rad=float(np.hypot(one.sigma_rad, sigma_heading_rad))) for one in step.turn_hypotheses
        )
        change_rad, sigma_rad = mean_and_sigma(hypotheses)
        return replace(self._step(step, change_rad, sigma_rad), turn_hypotheses=hypotheses)

    def _bridge(self, start_s: float, end_s: float, mode: CarryingMode) -> StepOdometry:
        """Make an unobserved motion: anywhere within reach, with a heading change up to uniform."""
        duration = max(end_s - start_s, 0.0)
        reach = self._parameters.gap_speed_mps * duration
        turn = min(self._parameters.gap_turn_rad_per_sqrt_s * np.sqrt(duration), SIGMA_UNIFORM_RAD)
        return StepOdometry(
            device=self._device,
            time_s=end_s,
            start_s=start_s,
            length_m=0.0,
            heading_change_rad=0.0,
            covariance=np.diag([max(reach, 1e-3) ** 2, max(reach, 1e-3) ** 2, max(turn, 1e-3) ** 2]),
            mode=mode,
            observed=False,
        )


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
