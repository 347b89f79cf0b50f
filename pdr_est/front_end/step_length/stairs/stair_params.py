"""Parameters of steps on stairs."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.params.validation_messages import contradiction


@params
class StairParams:
    """Dimensions of stairs, and the noise of the vertical velocity by which they are found.

    The dimensions are those of buildings. The noise is that of walks on one floor: the values of the greatest
    likelihood on ilc20, humolire, ridi, known-distance, rfbr, ipin2023 and oxiod-vicon are 0.02 m/s for a step and
    0.01 m/s for the drift. Errors of neighbouring steps are alike, so that of a step was raised until hardly a level
    step of ilc20 was taken for one on stairs; 0.03 to 0.05 find the same flights. No constant was fitted to stairs.
    """

    enabled: bool = True
    """Whether steps on stairs get the length of a tread."""
    tread_m: Positive = 0.29
    """Horizontal length, m, of a step on stairs: with the rise below it fulfils 2 rises + tread = 0.62 m."""
    sigma_tread_m: Positive = 0.05
    """Standard deviation of that length, m; treads have 0.25 to 0.34 m."""
    rise_m: Positive = 0.165
    """Height of a step on stairs, m."""
    sigma_rise_m: Positive = 0.02
    """Standard deviation of that height, m; stairs of buildings have 0.14 to 0.20 m."""
    steps_between_flights: Annotated[float, Ge(2.0), Le(1e5)] = 500.0
    """Mean number of steps between two flights; set and not fitted: 200 to 1000 find the same flights."""
    steps_of_flight: Annotated[float, Ge(3.0), Le(100.0)] = 10.0
    """Mean number of steps of a flight."""
    sigma_velocity_mps: Positive = 0.05
    """Standard deviation of the mean vertical velocity of a step, m/s."""
    sigma_drift_mps: Positive = 0.01
    """Random walk of the error of the vertical velocity, m/s per root step."""
    sigma_bias_mps2: Positive = 0.15
    """Standard deviation of the error of the vertical acceleration, m/s^2, before anything is known of the device."""
    sigma_bias_drift_mps2: NonNegative = 0.002
    """Random walk of that error, m/s^2 per root step."""
    sigma_limp_mps: NonNegative = 0.3
    """Standard deviation of the difference of left and right steps from their mean velocity, m/s."""
    share_disturbed: Fraction = 0.03
    """Share of steps during which the phone is moved up or down against the body."""
    sigma_disturbed_mps: Positive = 0.075
    """Standard deviation of their velocity, m/s, beside that of other steps."""
    share_of_jumps: Fraction = 0.003
    """Share of steps after which the velocity has another error, because the phone was turned or knocked."""
    sigma_jump_mps: Positive = 0.16
    """Standard deviation of such a change of the velocity, m/s."""
    sigma_bias_jump_mps2: NonNegative = 0.03
    """Standard deviation of the change of the acceleration's error that comes with it, m/s^2."""
    sigma_height_m: Positive = 0.15
    """Standard deviation of the height by the air pressure, mean over a step, m. Indoors it is 0.06 (ipin2023), and
    in the wind some times as much.
    """
    sigma_height_drift_m_per_sqrt_s: Positive = 0.2
    """Random walk of that height, m per root second, for wind, doors and ventilation; indoors 0.12 (ipin2023)."""

    def __post_init__(self) -> None:
        if self.share_disturbed + self.share_of_jumps > 1.0:
            raise contradiction(
                f"share_disturbed = {self.share_disturbed:g} and share_of_jumps = {self.share_of_jumps:g} are shares "
                "of the same steps: lower one of them so that their sum is at most 1"
            )
