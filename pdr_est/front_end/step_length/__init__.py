"""Estimate the length of each step and its standard deviation.

* `step_length_stage`: the stage, and the choice of the model.
* `equations`: published equations as pure functions (MMPDR, UPTIME, Kim et al.).
* `walk_run_model`: the default, our own model of walking and running.
* `cadence`: cadence and intensity of the last steps.
* `walker`: height, gender and the personal constants of a calibration.
"""

from pdr_est.front_end.step_length.step_length_stage import LENGTH_MODELS, LengthModel, StepLength, StepLengthParams
from pdr_est.front_end.step_length.walk_run_model import RunningParams
from pdr_est.front_end.step_length.walker import Gender, WalkerParams

__all__ = [
    "LENGTH_MODELS",
    "Gender",
    "LengthModel",
    "RunningParams",
    "StepLength",
    "StepLengthParams",
    "WalkerParams",
]
