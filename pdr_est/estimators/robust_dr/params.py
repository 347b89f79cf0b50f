"""Define the settings of the fusion by Robust DR, in a module of their own because the fusion is slow to load."""

from pdr_est.params import Positive, params


@params
class MapFusionParams:
    """Fusion of several devices by Robust DR."""

    feedback: bool = False
    """True if dead reckoning continues from the fused positions. If False, the fusion does not affect the dead
    reckoning of any device, as the paper's "estimates reported by the two sets of sensors independently" reads."""

    silent_s: Positive = 2.0
    """Time after its last step, s, from which a device takes no part in the fusion (ours)."""
