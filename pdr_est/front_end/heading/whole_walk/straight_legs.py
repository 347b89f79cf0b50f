"""Find the straight legs of a walk: runs of steps between turns, divided into sections of a few steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.stride_pairing import stride_averages
from pdr_est.params import params
from pdr_est.types.steps import Step

_HALF_SPAN = 2  # steps before and after a step over which its turn is measured


@params
class StraightLegParams:
    """Parameters of the straight legs; all values are ours."""

    turn_rad: Annotated[float, Ge(0.1), Le(1.5)] = 0.44
    """Change of heading over four steps, rad, beyond which the walker turns."""
    least_steps: Annotated[int, Ge(2), Le(100)] = 5
    """Least number of steps of a leg."""
    piece_steps: Annotated[int, Ge(1), Le(100)] = 4
    """Approximate number of steps of a section."""


@dataclass(frozen=True)
class LegSections:
    """Sections of straight legs in order of time.

    Attributes
    ----------
    leg : ndarray of int, shape (n,)
        Number of the leg.
    first, last : ndarray of int, shape (n,)
        Numbers of the first step and of the one after the last.
    time_s : ndarray, shape (n,)
        Mean time of the steps.
    heading_rad : ndarray, shape (n,)
        Mean heading of the steps, continuous along the walk.
    sigma_change_rad : ndarray, shape (n,)
        Standard deviation of an offset of the headings since the section before, by a phone that was put elsewhere.
    """

    leg: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    time_s: Array
    heading_rad: Array
    sigma_change_rad: Array

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def since_first_rad(self) -> Array:
        """Headings (n,) less that of the first section: the zero of the headings is arbitrary."""
        since: Array = self.heading_rad - self.heading_rad[0]
        return since


def straight_leg_sections(steps: Sequence[Step], parameters: StraightLegParams) -> LegSections:
    """Find the sections of the straight legs of some steps."""
    time_s = np.array([step.event.time_s for step in steps])
    heading = stride_averages(np.unwrap([step.heading_rad for step in steps]))
    variance = np.cumsum([step.sigma_turn_rad**2 + _spread(step) ** 2 for step in steps])
    moved = np.flatnonzero([bool(step.turn_hypotheses or step.holes) for step in steps])
    rows = [
        (number, first, last)
        for number, (begin, end) in enumerate(_straight_legs(heading, moved, parameters))
        for first, last in _divide(begin, end, parameters.piece_steps)
    ]
    leg, first, last = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    count = np.maximum(last - first, 1)
    sums = [np.concatenate([[0.0], np.cumsum(values)]) for values in (time_s, heading)]
    mean_time, mean_heading = ((total[last] - total[first]) / count for total in sums)
    # An offset within a section lies between it and the one before, and between it and the next as well.
    since = np.concatenate([first[:1], first[:-1]])
    change = variance[last - 1] - variance[since] if len(rows) else np.empty(0)
    return LegSections(leg, first, last, mean_time, mean_heading, np.sqrt(np.maximum(change, 0.0)))


def _spread(step: Step) -> float:
    """Compute the standard deviation, rad, of the turn of a step around its most probable one."""
    if not step.turn_hypotheses:
        return 0.0
    first = step.turn_hypotheses[0].heading_change_rad
    squares = [
        one.probability * (one.sigma_rad**2 + wrap_angle(one.heading_change_rad - first) ** 2)
        for one in step.turn_hypotheses
    ]
    return float(np.sqrt(np.sum(squares)))


def _straight_legs(heading: Array, moved: NDArray[np.int64], parameters: StraightLegParams) -> list[tuple[int, int]]:
    """Find the runs of steps, from and to (exclusive), in which the heading changes slowly.

    None goes on beyond a step before which the phone was put elsewhere or the recording has a gap, whose numbers are
    `moved`.
    """
    count = len(heading)
    index = np.arange(count)
    across = heading[np.minimum(index + _HALF_SPAN, count - 1)] - heading[np.maximum(index - _HALF_SPAN, 0)]
    straight = np.concatenate([[False], np.abs(across) <= parameters.turn_rad, [False]])
    borders = np.flatnonzero(np.diff(straight.astype(np.int8)))
    inside = moved[straight[moved] & straight[moved + 1]]  # at the border of two legs that would be one
    borders = np.sort(np.concatenate([borders, inside, inside]))
    runs = zip(borders[::2].tolist(), borders[1::2].tolist(), strict=True)
    return [(begin, end) for begin, end in runs if end - begin >= parameters.least_steps]


def _divide(begin: int, end: int, section_steps: int) -> list[tuple[int, int]]:
    """Divide a run into equal sections."""
    borders = np.linspace(begin, end, max((end - begin) // section_steps, 1) + 1).astype(int).tolist()
    return list(pairwise(borders))
