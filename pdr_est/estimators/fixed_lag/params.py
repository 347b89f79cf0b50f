"""The parameter of the fixed-lag smoother, apart from the smoother: gtsam is slow to load."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import params


@params
class FixedLagParams:
    """lag_s: each pose is estimated with what came up to this long after it."""

    lag_s: Annotated[float, Ge(0.5), Le(600.0)] = 10.0
