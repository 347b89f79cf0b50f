"""Metrics of a walk whose walker was calibrated on other walks of the same set."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Protocol

import numpy as np

from pdr_est.calibrate import Calibration, Observation, fit


class CalibrationCase(Protocol):
    """A scored walk as it takes part in calibrations; goes between processes."""

    @property
    def observation(self) -> Observation:
        """What the walk tells about its walker, for the calibration of others."""

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        """Metrics by name, of this walk with a walker's constants."""


def calibrated_metrics(case: CalibrationCase, others: Sequence[CalibrationCase], number: int) -> dict[str, float]:
    """The metrics of a walk, each the mean over every choice of `number` of the other walks to calibrate on.

    Nothing of the walk itself is seen by a calibration, and no choice is preferred.
    """
    errors = [case.errors(fit([other.observation for other in chosen])) for chosen in combinations(others, number)]
    return {name: float(np.mean([found[name] for found in errors])) for name in errors[0]}
