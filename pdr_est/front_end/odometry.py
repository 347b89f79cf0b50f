"""From steps to measurements. This is the only place where the noise of the odometry is set."""

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.params import NonNegative, Positive, params
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.steps import CarryingMode, Step


@params
class OdometryParams:
    """Standard deviations of a step, and of what is not observed.

    sigma_length_drift: of a step over its length, on top of what its length model tells, for a scale that drifts
    slowly through the walk. Estimators take the errors of steps for independent; those of neighbours are alike, so
    that sums grow faster. On the loops of OxIOD the length of 3 steps is as uncertain as with 0.14 a step, of 20
    with 0.17, of 40 with 0.19; the default is right for 20.
    sigma_direction_rad: of the direction of a single step around the heading (it does not accumulate).
    sigma_heading_rad_per_sqrt_s: random walk of the heading error, for gyroscope drift and for the phone turning in
    the hand. sigma_length_scale: of the walker's own step length over the model's, constant through a walk.
    sigma_mode_change_rad: of the heading change of a step in another carrying mode than the one before, because the
    phone was turned against the body; not where the heading follows the phone. gap_speed_mps: speed with which a
    walker may have moved during a gap. gap_turn_rad_per_sqrt_s: how much the walker may have turned.
    sigma_straight_rad: of the heading of a step around the straight path that it lies on, independent from step to
    step.
    """

    sigma_length_drift: NonNegative = 0.15
    sigma_direction_rad: Positive = 0.18
    sigma_heading_rad_per_sqrt_s: NonNegative = 0.02
    sigma_length_scale: NonNegative = 0.11
    sigma_mode_change_rad: NonNegative = 0.5
    gap_speed_mps: Positive = 1.0
    gap_turn_rad_per_sqrt_s: Positive = 1.0
    sigma_straight_rad: Positive = 0.15


class Odometry:
    """Stage Step -> StepOdometry and HeadingPrior of one device. A new segment is preceded by a bridge over the gap.

    A step on a straight path of known direction is followed by a heading prior, which is relative: the zero of the
    headings is arbitrary. After a gap it is another one, so that priors are given in the first segment only.
    """

    latency_s = 0.0

    def __init__(self, device: str, parameters: OdometryParams) -> None:
        self._device = device
        self._parameters = parameters
        self._previous: Step | None = None
        self._first_segment: int | None = None

    def push(self, item: Step, /) -> list[StepOdometry | HeadingPrior]:
        return [*self._motion(item), *self._straight(item)]

    def flush(self) -> list[StepOdometry | HeadingPrior]:
        return []

    def _straight(self, step: Step) -> list[HeadingPrior]:
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
            sigma = self._sigma_heading(elapsed, self._sigma_besides(previous, item))
            return [self._step(item, float(wrap_angle(item.heading_rad - previous.heading_rad)), sigma)]
        bridge = self._bridge(previous.event.time_s, item.start_s, item.event.mode)
        return [bridge, self._step(item, 0.0, self._sigma_heading(item.event.time_s - item.start_s))]

    def _sigma_besides(self, previous: Step, item: Step) -> float:
        """Of a heading change, on top of the random walk."""
        modes = {previous.event.mode, item.event.mode} - {CarryingMode.UNKNOWN}
        changed = len(modes) > 1 or CarryingMode.TRANS in modes  # in which the phone turns all the time
        of_mode = self._parameters.sigma_mode_change_rad if changed and not item.placement_tracked else 0.0
        return float(np.hypot(of_mode, item.sigma_turn_rad))

    def _sigma_heading(self, elapsed_s: float, besides: float = 0.0) -> float:
        return float(np.hypot(self._parameters.sigma_heading_rad_per_sqrt_s * np.sqrt(elapsed_s), besides))

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

    def _bridge(self, start_s: float, end_s: float, mode: CarryingMode) -> StepOdometry:
        """An unobserved walk: anywhere within reach, turned by anything (a uniform angle has sigma pi/sqrt 3)."""
        duration = max(end_s - start_s, 0.0)
        reach = self._parameters.gap_speed_mps * duration
        turn = min(self._parameters.gap_turn_rad_per_sqrt_s * np.sqrt(duration), np.pi / np.sqrt(3.0))
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
    """Covariance (3, 3) of (forward, left, heading) at the end of a step.

    The heading error of the step turns its displacement too: left = length * heading error.
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
