"""Recognise the carrying mode of each sample.

* `fixed`: one mode for the whole recording, given by the user.
* `mmpdr_fsm`: the state machine of MMPDR.
* `hmm_recogniser`: the default, a hidden Markov model. `sliding_windows` and `window_features` make its evidence,
  `hidden_markov` weighs it.
"""

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
    """Choose how the carrying mode is recognised."""

    method: Annotated[str, PartName(MODE_METHODS)] = "auto"
    """Method: "auto" recognises the mode, "mmpdr" is the state machine of the paper, "fixed" takes the mode `fixed`.
    """
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a mode recogniser of your own, which `method` names as module:attribute."""
    fixed: Literal["HOLDING", "SWING", "POCKET", "OTHER"] = "HOLDING"
    """Carrying mode of every sample for the method "fixed"."""
    auto: AutoModeParams = AutoModeParams()
    """Parameters of the method "auto"."""
    mmpdr: MmpdrModeParams = MmpdrModeParams()
    """Parameters of the method "mmpdr"."""


def mode_stage(rate_hz: float, parameters: ModeParams) -> Stage:
    """Make the configured stage LevelBlock -> LevelBlock.

    Raises
    ------
    PartError
        If a stage from outside the package cannot be made.
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
