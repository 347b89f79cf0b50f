"""Metrics of a walk whose walker was calibrated on other walks of the same suite."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from pdr_est.calibration.step_length_fit import fit_calibration
from pdr_est.errors import ConfigError
from pdr_est.experiment.suite import CalibrationCase
from pdr_est.types.outcome import TrackOutcome


def with_calibrated(
    rows: Sequence[TrackOutcome], cases: Sequence[CalibrationCase | None], number: int, metrics: Sequence[str]
) -> tuple[tuple[TrackOutcome, ...], dict[str, str]]:
    """Add the metrics after a calibration on other walks, with the same variant, to the rows.

    Parameters
    ----------
    rows : sequence of TrackOutcome
        Scored tracks of all walks.
    cases : sequence of CalibrationCase or None
        Calibration case of each row; None where the suite has already given the reason why there is none.
    number : int
        Number of walks to calibrate on, 0 for a suite that does not calibrate.
    metrics : sequence of str
        Names of the calibrated metrics.

    Returns
    -------
    rows : tuple of TrackOutcome
        The completed rows.
    missing : dict
        Walk -> reason why its calibrated metrics are missing.
    """
    completed, missing = list(rows), {}
    for i, (row, case) in enumerate(zip(rows, cases, strict=True)):
        if case is None:
            continue
        others = [
            other
            for candidate, other in zip(rows, cases, strict=True)
            if other is not None
            and other.observation is not None
            and candidate.walk != row.walk
            and candidate.variant == row.variant
        ]
        if len(others) < number:
            missing[row.walk] = f"{', '.join(metrics)}: fewer than {number} other walks to calibrate on"
            continue
        try:
            completed[i] = replace(row, metrics={**row.metrics, **calibrated_metrics(case, others, number)})
        except ConfigError as error:  # a variant that misses or invents many steps
            missing[row.walk] = f"{', '.join(metrics)}: other walks give constants that nobody has: {error}"
    return tuple(completed), missing


def calibrated_metrics(case: CalibrationCase, others: Sequence[CalibrationCase], number: int) -> dict[str, float]:
    """Average the metrics of a walk over every choice of `number` of the other walks to calibrate on.

    A calibration sees nothing of the walk itself, and no choice is preferred.
    """
    errors = [
        case.errors(fit_calibration([seen for other in chosen if (seen := other.observation) is not None]))
        for chosen in combinations(others, number)
    ]
    return {name: float(np.mean([found[name] for found in errors])) for name in errors[0]}
