"""The carrying mode of each sample. So far a recording has one mode, given by the user."""

from dataclasses import replace
from typing import Literal

import numpy as np

from pdr_est.params import params
from pdr_est.records import CarryingMode, LevelBlock


@params
class ModeParams:
    """method: "fixed" labels the whole recording with one mode."""

    method: Literal["fixed"] = "fixed"
    mode: Literal["HOLDING"] = "HOLDING"


class FixedMode:
    """Stage LevelBlock -> LevelBlock that labels every sample with the same mode."""

    latency_s = 0.0

    def __init__(self, mode: CarryingMode) -> None:
        self._mode = mode

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        return [replace(item, mode=np.full(len(item), self._mode, dtype=np.int8))]

    def flush(self) -> list[LevelBlock]:
        return []
