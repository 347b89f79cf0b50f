"""Who walks: the body, and what a calibration found out about the person."""

from typing import Annotated, Literal

from annotated_types import Ge, Le

from pdr_est.params import params

Gender = Literal["male", "female"]
Height = Annotated[float, Ge(0.5), Le(2.6)]  # of a small child and of the tallest; refuses centimetres and feet
LEAST_SCALE, MOST_SCALE = 0.5, 2.0  # nobody's steps differ more from the model's; beyond lie other units
_SLOWEST_HZ, _QUICKEST_HZ = 0.7, 2.5  # steps a second of walkers, from strolling to the quickest


@params
class WalkerParams:
    """Who walks. Height and gender default to those of MMPDR's application.

    length_scale, cadence_exponent, reference_cadence_hz: personal constants. The length of every model, of walking
    and of running steps, is multiplied by length_scale * (cadence / reference_cadence_hz) ** cadence_exponent, where
    cadence is that of the last steps (`Pace.cadence_hz`), as far as somebody walks with it (`walking_cadence_hz`).
    How uncertain the scale is: `odometry.sigma_length_scale`.
    """

    height_m: Height = 1.73
    gender: Gender = "male"
    length_scale: Annotated[float, Ge(LEAST_SCALE), Le(MOST_SCALE)] = 1.0
    cadence_exponent: Annotated[float, Ge(-1.0), Le(2.0)] = 0.0
    reference_cadence_hz: Annotated[float, Ge(_SLOWEST_HZ), Le(_QUICKEST_HZ)] = 1.8

    def personal_factor(self, cadence_hz: float) -> float:
        """What to multiply a model's length by, at that many steps a second."""
        pace = walking_cadence_hz(cadence_hz) / self.reference_cadence_hz
        return float(self.length_scale * pace**self.cadence_exponent)


def walking_cadence_hz(cadence_hz: float) -> float:
    """The nearest cadence of a walk.

    Slower is a pause within a step or a step that was missed, quicker a runner or a step cut in two. The exponent is
    learnt from walks and must not make such steps arbitrarily short or long. A runner's steps are corrected as those
    of a very quick walk: nothing is known of how they differ from the model's.
    """
    return min(max(cadence_hz, _SLOWEST_HZ), _QUICKEST_HZ)
