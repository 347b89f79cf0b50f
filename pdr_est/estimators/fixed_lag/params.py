"""Define the settings of the fixed-lag smoother, in a module of their own because the smoother is slow to load."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import params


@params
class FixedLagParams:
    """Settings of the fixed-lag smoother."""

    lag_s: Annotated[float, Ge(0.5), Le(600.0)] = 10.0
    """Lag, s: each pose is estimated from what was measured up to this long after it."""
