"""The carrying mode of each sample: given, by MMPDR's state machine, or recognised."""

from typing import Literal

from pdr_est.front_end.mode.fixed import FixedMode
from pdr_est.front_end.mode.hmm_recogniser import AutoModeParams, HmmModeRecogniser
from pdr_est.front_end.mode.mmpdr_fsm import MmpdrMode, MmpdrModeParams
from pdr_est.params import params
from pdr_est.stage import Stage
from pdr_est.types.steps import CarryingMode

__all__ = [
    "AutoModeParams",
    "FixedMode",
    "HmmModeRecogniser",
    "MmpdrMode",
    "MmpdrModeParams",
    "ModeParams",
    "mode_stage",
]


@params
class ModeParams:
    """method: "auto" recognises the mode, "mmpdr" is the paper's state machine, "fixed" takes `fixed` throughout."""

    method: Literal["auto", "mmpdr", "fixed"] = "auto"
    fixed: Literal["HOLDING", "SWING", "POCKET", "OTHER"] = "HOLDING"
    auto: AutoModeParams = AutoModeParams()
    mmpdr: MmpdrModeParams = MmpdrModeParams()


def mode_stage(rate_hz: float, parameters: ModeParams) -> Stage:
    """The configured stage LevelBlock -> LevelBlock."""
    match parameters.method:
        case "auto":
            return HmmModeRecogniser(rate_hz, parameters.auto)
        case "mmpdr":
            return MmpdrMode(rate_hz, parameters.mmpdr)
        case "fixed":
            return FixedMode(CarryingMode[parameters.fixed])
