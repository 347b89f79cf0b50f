"""The walker: body, and the personal constants of a calibration."""

from typing import Annotated, Literal

from annotated_types import Ge, Le

from pdr_est.params import params

Gender = Literal["male", "female"]
Height = Annotated[float, Ge(0.5), Le(2.6)]  # from a small child to the tallest person; refuses centimetres and feet
LEAST_SCALE, MOST_SCALE = 0.5, 2.0  # a larger difference from the model is an error of units
_SLOWEST_HZ, _QUICKEST_HZ = 0.7, 2.5  # steps per second of walkers, from strolling to the quickest


@params
class WalkerParams:
    """Body and personal constants of the walker.

    The length of every model, of walking and of running steps, is multiplied by length_scale * (cadence /
    reference_cadence_hz) ** cadence_exponent, where cadence is that of the last steps (`Pace.cadence_hz`) limited to
    that of a walk (`walking_cadence_hz`). The uncertainty of the scale is `odometry.sigma_length_scale`.
    """

    height_m: Height = 1.73
    """Height, m; the default is that of MMPDR's application."""
    gender: Gender = "male"
    """Gender, for the constants of MMPDR; the default is that of its application."""
    length_scale: Annotated[float, Ge(LEAST_SCALE), Le(MOST_SCALE)] = 1.0
    """Factor of the length of every step, from a calibration."""
    cadence_exponent: Annotated[float, Ge(-1.0), Le(2.0)] = 0.0
    """Exponent of the cadence in that factor, from a calibration."""
    reference_cadence_hz: Annotated[float, Ge(_SLOWEST_HZ), Le(_QUICKEST_HZ)] = 1.8
    """Cadence, steps per second, at which the factor is length_scale."""

    def personal_factor(self, cadence_hz: float) -> float:
        """Compute the factor of a model's length at that many steps per second."""
        pace = walking_cadence_hz(cadence_hz) / self.reference_cadence_hz
        return float(self.length_scale * pace**self.cadence_exponent)


def walking_cadence_hz(cadence_hz: float) -> float:
    """Limit a cadence to that of a walk.

    Slower is a pause within a step or a step that was missed, quicker a runner or a step cut in two. The exponent is
    learnt from walks and must not make such steps arbitrarily short or long. A runner's steps are corrected as those
    of a very quick walk: nothing is known of how they differ from the model's.
    """
    return min(max(cadence_hz, _SLOWEST_HZ), _QUICKEST_HZ)
