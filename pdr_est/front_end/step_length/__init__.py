"""Estimate the length of each step and its standard deviation.

* `step_length_stage`: the stage, and the choice of the model.
* `equations`: published equations as pure functions (MMPDR, UPTIME, Kim et al.).
* `harmonic_model`: the default, our own law for walking and running.
* `walk_run_model`: a model of ours with one law for walking and one for running.
* `stairs/`: steps on stairs, found at the end of the walk.
* `length_mixture`: length of a step that may be of either of two kinds.
* `cadence`: cadence and intensity of the last steps.
* `walker`: height, gender and the personal constants of a calibration.
"""

from pdr_est.front_end.step_length.harmonic_model import HarmonicParams
from pdr_est.front_end.step_length.stairs import StairLengths, StairParams
from pdr_est.front_end.step_length.step_length_stage import (
    LAW_OF_AUTO,
    LENGTH_MODELS,
    LengthModel,
    StepLength,
    StepLengthParams,
    length_law,
)
from pdr_est.front_end.step_length.walk_run_model import RunningParams
from pdr_est.front_end.step_length.walker import Gender, WalkerParams
from pdr_est.parts import STAGE, is_external, named_part
from pdr_est.stage import Stage

__all__ = [
    "LAW_OF_AUTO",
    "LENGTH_MODELS",
    "Gender",
    "HarmonicParams",
    "LengthModel",
    "RunningParams",
    "StairParams",
    "StepLength",
    "StepLengthParams",
    "WalkerParams",
    "length_law",
    "stairs_stage",
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


def stairs_stage(parameters: StepLengthParams) -> StairLengths | None:
    """Make the stage Step -> Step that gives steps on stairs their length at the end of the walk.

    None where it is switched off, and for every other model than our own: published ones are left as they are.
    """
    return (
        StairLengths(parameters.stairs)
        if parameters.stairs.enabled and length_law(parameters) == "harmonic"
        else None
    )
