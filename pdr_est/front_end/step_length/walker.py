"""Who walks: the body, and what a calibration found out about the person."""

from typing import Annotated, Literal

from annotated_types import Ge, Le

from pdr_est.params import Positive, params

Gender = Literal["male", "female"]
Height = Annotated[float, Ge(0.5), Le(2.6)]  # of a small child and of the tallest; refuses centimetres and feet


@params
class WalkerParams:
    """Who walks. Height and gender default to those of MMPDR's application.

    length_scale, range_exponent, reference_range_mps2: personal constants. The length of every model is multiplied
    by length_scale * (range / reference_range_mps2) ** range_exponent, where range is that of the vertical
    acceleration over the last steps (`Pace.range_mps2`). How uncertain the scale is: `odometry.sigma_length_scale`.
    """

    height_m: Height = 1.73
    gender: Gender = "male"
    length_scale: Positive = 1.0
    range_exponent: Annotated[float, Ge(-1.0), Le(1.0)] = 0.0
    reference_range_mps2: Positive = 8.0

    def personal_factor(self, range_mps2: float) -> float:
        """What to multiply a model's length by."""
        return float(self.length_scale * (range_mps2 / self.reference_range_mps2) ** self.range_exponent)
