"""Parameters of the online filter: how long it waits, and how far back it can rewind."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import NonNegative, params


@params
class OnlineParams:
    """Waiting and rewinding of the online filter; all times are data times, whenever the data comes."""

    wait_s: NonNegative = 1.0
    """Time for which the steps of one device wait for the data of the others, in the data time of the device that is
    ahead, s. After it they are used without the others."""

    horizon_s: Annotated[float, Ge(1.0), Le(3600.0)] = 30.0
    """Largest delay, s, with which a fix or the data of a device still takes its place in the order of time."""

    settle_s: NonNegative = 5.0
    """Time after which the fixed-lag smoother takes over a filtered pose, s: a pose may change for a few seconds."""

    remembered_steps: Annotated[int, Ge(100), Le(1_000_000)] = 4000
    """Largest number of steps, of all devices together, that can be filtered again when a first fix tells where the
    walk began."""
