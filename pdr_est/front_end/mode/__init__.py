"""The carrying mode of each sample: given, by MMPDR's state machine, or recognised."""

from dataclasses import field
from typing import Annotated, Any, Literal

from pdr_est.front_end.mode.fixed import FixedMode
from pdr_est.front_end.mode.hmm_recogniser import AutoModeParams, HmmModeRecogniser
from pdr_est.front_end.mode.mmpdr_fsm import MmpdrMode, MmpdrModeParams
from pdr_est.params import params
from pdr_est.parts import STAGE, PartName, named_part
from pdr_est.stage import Stage
from pdr_est.types.steps import CarryingMode

__all__ = [
    "MODE_METHODS",
    "AutoModeParams",
    "FixedMode",
    "HmmModeRecogniser",
    "MmpdrMode",
    "MmpdrModeParams",
    "ModeParams",
    "mode_stage",
]

MODE_METHODS = ("auto", "mmpdr", "fixed")


@params
class ModeParams:
    """method: "auto" recognises the mode, "mmpdr" is the paper's state machine, "fixed" takes `fixed` throughout."""

    method: Annotated[str, PartName(MODE_METHODS)] = "auto"
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a mode recogniser of your own, which `method` names as module:attribute."""
    fixed: Literal["HOLDING", "SWING", "POCKET", "OTHER"] = "HOLDING"
    auto: AutoModeParams = AutoModeParams()
    mmpdr: MmpdrModeParams = MmpdrModeParams()


def mode_stage(rate_hz: float, parameters: ModeParams) -> Stage:
    """Make the configured stage LevelBlock -> LevelBlock.

    Raises PartError for one from outside the package that cannot be made.
    """
    match parameters.method:
        case "auto":
            return HmmModeRecogniser(rate_hz, parameters.auto)
        case "mmpdr":
            return MmpdrMode(rate_hz, parameters.mmpdr)
        case "fixed":
            return FixedMode(CarryingMode[parameters.fixed])
    own: Stage = named_part(parameters.method, parameters.parameters, STAGE, "mode.method", {"rate_hz": rate_hz})
    return own
