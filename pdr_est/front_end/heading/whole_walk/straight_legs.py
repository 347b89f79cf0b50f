"""The straight stretches of a walk: runs of steps between turns, in pieces of a few steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.stride_pairing import stride_average
from pdr_est.params import params
from pdr_est.types.steps import Step

_REACH = 2  # steps before and after one across which its turn is taken


@params
class StraightLegParams:
    """turn_rad: change of heading over four steps beyond which the walker turns. least_steps: of a stretch.
    piece_steps: about as many steps are looked at together. All three are ours."""

    turn_rad: Annotated[float, Ge(0.1), Le(1.5)] = 0.44
    least_steps: Annotated[int, Ge(2), Le(100)] = 5
    piece_steps: Annotated[int, Ge(1), Le(100)] = 4


@dataclass(frozen=True)
class LegSections:
    """LegSections of straight stretches in order of time.

    stretch: (n,) number of the stretch; first, last: (n,) steps, `last` exclusive; time_s, heading_rad: (n,)
    means, the heading continuous along the walk; changed_rad: (n,) standard deviation of what the headings may have
    been displaced by since the piece before, by a phone that was put elsewhere.
    """

    stretch: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    time_s: Array
    heading_rad: Array
    changed_rad: Array

    def __len__(self) -> int:
        return len(self.time_s)


def straight_leg_sections(steps: Sequence[Step], parameters: StraightLegParams) -> LegSections:
    """The pieces of the straight stretches of some steps, which lie in one segment."""
    time_s = np.array([step.event.time_s for step in steps])
    heading = _over_strides(np.unwrap([step.heading_rad for step in steps]))
    variance = np.cumsum([step.sigma_turn_rad**2 for step in steps])
    rows = [
        (number, first, last)
        for number, (begin, end) in enumerate(_stretches(heading, parameters))
        for first, last in _cut(begin, end, parameters.piece_steps)
    ]
    stretch, first, last = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    count = np.maximum(last - first, 1)
    sums = [np.concatenate([[0.0], np.cumsum(values)]) for values in (time_s, heading)]
    mean_time, mean_heading = ((total[last] - total[first]) / count for total in sums)
    # A displacement within a piece lies between it and the one before, and between it and the next as well.
    since = np.concatenate([first[:1], first[:-1]])
    displaced = variance[last - 1] - variance[since] if len(rows) else np.empty(0)
    return LegSections(stretch, first, last, mean_time, mean_heading, np.sqrt(np.maximum(displaced, 0.0)))


def _over_strides(heading: Array) -> Array:
    """Headings (n,) averaged over the stride, which cancels what goes to and fro with the legs; the first and the
    last one have one neighbour, which stands for both."""
    if len(heading) < 2:
        return heading
    padded = np.concatenate([heading[1:2], heading, heading[-2:-1]])
    return stride_average(padded[:-2], padded[1:-1], padded[2:])


def _stretches(heading: Array, parameters: StraightLegParams) -> list[tuple[int, int]]:
    """Runs of steps, from and to (exclusive), in which the heading changes slowly."""
    count = len(heading)
    index = np.arange(count)
    across = heading[np.minimum(index + _REACH, count - 1)] - heading[np.maximum(index - _REACH, 0)]
    straight = np.concatenate([[False], np.abs(across) <= parameters.turn_rad, [False]])
    borders = np.flatnonzero(np.diff(straight.astype(np.int8)))
    runs = zip(borders[::2].tolist(), borders[1::2].tolist(), strict=True)
    return [(begin, end) for begin, end in runs if end - begin >= parameters.least_steps]


def _cut(begin: int, end: int, piece_steps: int) -> list[tuple[int, int]]:
    """A run in equal pieces."""
    borders = np.linspace(begin, end, max((end - begin) // piece_steps, 1) + 1).astype(int).tolist()
    return list(pairwise(borders))
