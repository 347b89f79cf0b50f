"""How long the online filter waits, and how far it looks back."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import NonNegative, params


@params
class OnlineParams:
    """Times are those of the data, whenever they come.

    wait_s: how long the steps of one device wait for the data of the others, in the data time of whichever is ahead;
    then they are used without. horizon_s: how late a fix, or the data of a device, may come and still take its place
    in the order of time. settle_s: how long a pose may still change before the smoother takes it: a step is known up
    to a few seconds late. remembered_steps: of all devices together, how many can be gone through again when a first
    fix tells where a walk began.
    """

    wait_s: NonNegative = 1.0
    horizon_s: Annotated[float, Ge(1.0), Le(3600.0)] = 30.0
    settle_s: NonNegative = 5.0
    remembered_steps: Annotated[int, Ge(100), Le(1_000_000)] = 4000
