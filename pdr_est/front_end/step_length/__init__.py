"""Length of each step: published equations, our own model, a person's constants, and how sure the length is."""

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
