"""Floor of each second, from modes and heights."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.storeys import Rise, StoreyCount, floor_numbers
from pdr_est.front_end.height.vertical_filter import Numbers
from pdr_est.types.height import MoveKind

_LANDING_S = 10  # level for no longer between two flights in the same direction: a landing and no floor


class FloorsOfSeconds(NamedTuple):
    """Floors of some seconds.

    Attributes
    ----------
    floor, probability
        (n,) number of the nearest floor, and its probability.
    known
        What is known on the last floor.
    """

    floor: Numbers
    probability: Array
    known: StoreyCount


def floors_of(
    mode: Numbers, height_m: Array, variance_m2: Array, count: StoreyCount, parameters: HeightParams
) -> FloorsOfSeconds:
    """Find the floors of consecutive seconds.

    Parameters
    ----------
    mode
        (n,) modes of the seconds.
    height_m, variance_m2
        (n,) height, m, and its variance, m².
    count
        What is known on the floor of the first second.
    parameters
        Heights of storeys.
    """
    still = np.where(mode == modes.DISTURBED, modes.LEVEL, mode)
    levels = _levels_of(stretches_of(still), still)
    counts = [count]
    for (_, before), (_, after) in pairwise(levels):
        counts.append(counts[-1].after(_rise(height_m, variance_m2, before - 1, after - 1), parameters))
    number, probability = floor_numbers(counts)
    floor, of_floor = np.full(len(mode), number[0]), np.full(len(mode), probability[0])
    for k, ((_, leave), (arrive, end)) in enumerate(pairwise(levels)):
        rise_m = height_m[end - 1] - height_m[leave - 1]
        share = (height_m[leave:] - height_m[leave - 1]) / rise_m if abs(rise_m) > 0.0 else np.ones(1)
        share = np.where(np.arange(leave, len(mode)) < arrive, share, 1.0)
        floor[leave:] = np.rint(number[k] + np.clip(share, 0.0, 1.0) * (number[k + 1] - number[k]))
        of_floor[leave:] = probability[k + 1]
    last = levels[-1][1]
    for k in range(last, len(mode)):  # in a move that has not ended
        storeys, certainty = counts[-1].storeys_of(_rise(height_m, variance_m2, last - 1, k))
        floor[k], of_floor[k] = number[-1] + storeys, probability[-1] * certainty
    return FloorsOfSeconds(floor.astype(np.int64), of_floor, counts[-1])


def stretches_of(mode: Numbers) -> list[tuple[int, int]]:
    """Return begin and end of each run of seconds in the same mode."""
    changes = np.flatnonzero(np.diff(mode)) + 1
    return list(pairwise([0, *changes.tolist(), len(mode)]))


def _rise(height_m: Array, variance_m2: Array, before: int, after: int) -> Rise:
    """Return the change of height from one second to another."""
    variance = max(float(variance_m2[after] - variance_m2[before]), 0.0)
    return Rise(float(height_m[after] - height_m[before]), variance)


def _levels_of(stretches: list[tuple[int, int]], mode: Numbers) -> list[tuple[int, int]]:
    """Return the level stretches that are floors, and no landings of stairs; the first one and the last one count."""
    levels = []
    for place, (begin, end) in enumerate(stretches):
        if mode[begin] != modes.LEVEL:
            continue
        inner = 0 < place < len(stretches) - 1
        if inner and end - begin <= _LANDING_S:
            before, after = int(mode[begin - 1]), int(mode[end])
            by_lift = MoveKind.LIFT in (modes.kind_of(before), modes.kind_of(after))
            if not by_lift and modes.direction_of(before) == modes.direction_of(after):
                continue
        levels.append((begin, end))
    return levels or [stretches[0]]
