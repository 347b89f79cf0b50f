"""Height and floor of the walker over time, from the air pressure and the steps of one device."""

from itertools import pairwise

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.level_watch import LevelWatch
from pdr_est.front_end.height.rise_smoothing import smoothed_heights
from pdr_est.front_end.height.seconds import noise_of, seconds_of
from pdr_est.front_end.height.storeys import Rise, floor_numbers
from pdr_est.front_end.height.vertical_filter import Numbers
from pdr_est.types.height import HeightProfile, MoveKind, VerticalMove
from pdr_est.types.recording import Signal

_LANDING_S = 10  # level for no longer between two flights in the same direction: a landing and no floor


def height_profile(
    pressure: Signal, step_time_s: Array | None, parameters: HeightParams | None = None
) -> HeightProfile | None:
    """Estimate height and floor of a walker, second by second.

    Parameters
    ----------
    pressure
        (m, 1) air pressure, Pa.
    step_time_s
        (k,) times of the steps, s; None where they are not known.
    parameters
        Rates of moves, storeys and noise; the default values if None.

    Returns
    -------
    HeightProfile or None
        One entry for each second from the first to the last sample; None without a usable sample.
    """
    parameters = HeightParams() if parameters is None else parameters
    first, seconds = seconds_of(pressure, step_time_s)
    if not seconds:
        return None
    sigma_m = noise_of(np.array([one.height_m for one in seconds]), parameters.sigma_height_m)
    watch = LevelWatch(parameters, sigma_m)
    for second in seconds:
        watch.add(second)
    path = watch.path
    height_m, variance_m2 = smoothed_heights(seconds, path, sigma_m, parameters)
    still = np.where(path.mode == modes.DISTURBED, modes.LEVEL, path.mode)
    stretches = _stretches(still)
    floor, probability = _floors(height_m, variance_m2, _levels_of(stretches, still), parameters)
    sigma_m2 = variance_m2 + parameters.sigma_level_m**2 + (parameters.sigma_air * height_m) ** 2
    return HeightProfile(
        time_s=first + 0.5 + np.arange(len(seconds), dtype=np.float64),
        height_m=height_m,
        sigma_m=np.sqrt(sigma_m2),
        floor=floor,
        floor_probability=probability,
        moves=tuple(
            _move(begin, end, first, modes.kind_of(int(still[begin])), height_m, variance_m2)
            for begin, end in stretches
            if still[begin] != modes.LEVEL
        ),
    )


def _move(begin: int, end: int, first: int, kind: MoveKind, height_m: Array, variance_m2: Array) -> VerticalMove:
    """Describe a move from its first second to the one after its last."""
    before, after = max(begin - 1, 0), min(end, len(height_m) - 1)
    return VerticalMove(
        begin_s=float(first + begin),
        end_s=float(first + end),
        kind=kind,
        rise_m=float(height_m[after] - height_m[before]),
        sigma_m=float(np.sqrt(max(variance_m2[after] - variance_m2[before], 0.0))),
    )


def _stretches(mode: Numbers) -> list[tuple[int, int]]:
    """Return begin and end of each run of seconds in the same mode."""
    changes = np.flatnonzero(np.diff(mode)) + 1
    return list(pairwise([0, *changes.tolist(), len(mode)]))


def _floors(
    height_m: Array, variance_m2: Array, levels: list[tuple[int, int]], parameters: HeightParams
) -> tuple[Numbers, Array]:
    """Find the floor of each second, between levels the nearest one, and its probability."""
    places = [begin for begin, _ in levels]
    rises = [
        Rise(float(height_m[after] - height_m[before]), float(max(variance_m2[after] - variance_m2[before], 0.0)))
        for before, after in pairwise(places)
    ]
    number, probability = floor_numbers(rises, parameters)
    floor, of_floor = np.full(len(height_m), number[0]), np.full(len(height_m), probability[0])
    for k, ((_, leave), (arrive, _)) in enumerate(pairwise(levels)):
        rise_m = height_m[arrive] - height_m[leave - 1]
        share = (height_m[leave:] - height_m[leave - 1]) / rise_m if abs(rise_m) > 0.0 else np.ones(1)
        share = np.where(np.arange(leave, len(height_m)) < arrive, share, 1.0)
        floor[leave:] = np.rint(number[k] + share * (number[k + 1] - number[k]))
        of_floor[leave:] = probability[k + 1]
    return floor.astype(np.int64), of_floor


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
