"""Judgement of a hypothesis about some seconds: modes, disturbances of the pressure, and heights."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height.vertical_filter import Numbers


class PathOfModes(NamedTuple):
    """Modes of consecutive seconds, with the heights that were known in them.

    Attributes
    ----------
    mode, case
        (n,) mode and case of the pressure of each second.
    height_m, variance_m2
        (n,) height, m, and its variance, m², by this second and those before it.
    """

    mode: Numbers
    case: Numbers
    height_m: Array
    variance_m2: Array

    @staticmethod
    def of_rows(rows: Sequence[tuple[int, int, float, float]]) -> "PathOfModes":
        """Make a path of the values of each second."""
        columns = np.array(rows, dtype=np.float64).reshape(len(rows), 4).T
        return PathOfModes(columns[0].astype(np.int64), columns[1].astype(np.int64), columns[2], columns[3])
