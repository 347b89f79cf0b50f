"""Metrics of a walk whose walker was calibrated on other walks of the same set."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Protocol

import numpy as np

from pdr_est.calibration.step_length_fit import Calibration, ScaleObservation, fit_calibration
from pdr_est.experiment.results.score_rows import SkippedWalk, WalkRow


class CalibrationCase(Protocol):
    """A scored walk as it takes part in calibrations; goes between processes."""

    @property
    def observation(self) -> ScaleObservation:
        """What the walk tells about its walker, for the calibration of others."""

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        """Metrics by name, of this walk with a walker's constants."""


def with_calibrated(
    rows: Sequence[WalkRow], cases: Sequence[CalibrationCase | None], number: int, metrics: Sequence[str]
) -> tuple[tuple[WalkRow, ...], tuple[SkippedWalk, ...]]:
    """The rows with their metrics after a calibration on other walks of the same variant, and what lacks them.

    cases: of each row, None where it has none, of which the suite has told the reason. number: of walks to calibrate
    on, 0 for suites that do not. metrics: names of those that are calibrated.
    """
    completed, skipped = list(rows), {}
    for i, (row, case) in enumerate(zip(rows, cases, strict=True)):
        if case is None:
            continue
        others = [
            other
            for of, other in zip(rows, cases, strict=True)
            if other is not None and of.walk != row.walk and of.settings == row.settings
        ]
        if len(others) < number:
            reason = f"{', '.join(metrics)}: fewer than {number} other walks to calibrate on"
            skipped[row.walk] = SkippedWalk(row.walk, reason)  # once, whatever the number of variants
            continue
        completed[i] = replace(row, metrics={**row.metrics, **calibrated_metrics(case, others, number)})
    return tuple(completed), tuple(skipped.values())


def calibrated_metrics(case: CalibrationCase, others: Sequence[CalibrationCase], number: int) -> dict[str, float]:
    """The metrics of a walk, each the mean over every choice of `number` of the other walks to calibrate on.

    Nothing of the walk itself is seen by a calibration, and no choice is preferred.
    """
    errors = [
        case.errors(fit_calibration([other.observation for other in chosen]))
        for chosen in combinations(others, number)
    ]
    return {name: float(np.mean([found[name] for found in errors])) for name in errors[0]}
