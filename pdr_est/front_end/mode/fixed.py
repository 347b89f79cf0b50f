"""One carrying mode for the whole recording, given by the user."""

from dataclasses import replace

import numpy as np

from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode


class FixedMode:
    """Stage LevelBlock -> LevelBlock that labels every sample with the same mode.

    Parameters
    ----------
    mode : CarryingMode
        The mode, whose probability is set to 1.
    """

    latency_s = 0.0

    def __init__(self, mode: CarryingMode) -> None:
        self._mode = mode

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        """Label the samples of a block."""
        mode = np.full(len(item), self._mode, dtype=np.int8)
        return [replace(item, mode=mode, mode_probability=np.ones(len(item)))]

    def flush(self) -> list[LevelBlock]:
        """Return nothing: no sample is held back."""
        return []
