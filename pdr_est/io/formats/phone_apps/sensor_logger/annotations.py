"""Annotations of Sensor Logger: remarks for the reader, and positions that the walker typed while passing them."""

import re
from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

_TYPED_SIGMA_M = 1.0  # per axis; a tap comes a step too early or too late, as in `position_fixes`
_NUMBER = r"([+-]?[0-9]+(?:\.[0-9]+)?)"
_LABELLED = rf"[(\[]?\s*(?:x\s*[=:]?\s*)?{_NUMBER}\s*m?\s*(?:[,;]\s*|\s+)(?:y\s*[=:]?\s*)?{_NUMBER}\s*m?\s*[)\]]?"
_POSITION = re.compile(_LABELLED, re.IGNORECASE)


def typed_positions(time_s: Array, texts: Sequence[str]) -> tuple[PositionFix, ...]:
    """Read the annotations that are a position in the map frame and nothing else: `12.5, -3` or `x=12.5 y=-3`.

    Parameters
    ----------
    time_s
        Times (n,) of the annotations, s on the clock of the recording.
    texts
        Their texts.
    """
    found = []
    for moment_s, text in zip(time_s, texts, strict=True):
        match = _POSITION.fullmatch(str(text).strip())
        if match is not None and np.isfinite(moment_s):
            position_m = np.array([float(match[1]), float(match[2])])
            covariance_m2 = _TYPED_SIGMA_M**2 * np.eye(2)
            found.append(PositionFix(float(moment_s), position_m, covariance_m2, clock_known=True))
    return tuple(found)
