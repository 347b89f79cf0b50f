"""Length of each step: published equations, our own model, a person's constants, and how sure the length is."""

from pdr_est.front_end.step_length.stage import LENGTH_MODELS, LengthModel, StepLength, StepLengthParams
from pdr_est.front_end.step_length.walk_run_model import RunningParams
from pdr_est.front_end.step_length.walker import Gender, WalkerParams
from pdr_est.parts import STAGE, is_external, named_part
from pdr_est.stage import Stage

__all__ = [
    "LENGTH_MODELS",
    "Gender",
    "LengthModel",
    "RunningParams",
    "StepLength",
    "StepLengthParams",
    "WalkerParams",
    "step_length_stage",
]


def step_length_stage(rate_hz: float, walker: WalkerParams, parameters: StepLengthParams) -> Stage:
    """Make the configured stage Step -> Step that fills in the length and its standard deviation.

    Raises PartError for one from outside the package that cannot be made.
    """
    if is_external(parameters.model):
        offered = {"rate_hz": rate_hz, "walker": walker}
        own: Stage = named_part(parameters.model, parameters.parameters, STAGE, "step_length.model", offered)
        return own
    return StepLength(rate_hz, walker, parameters)
