"""Height and floor of the walker over time, from the air pressure and the steps of one device."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.floors import floors_of, stretches_of
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.level_watch import LevelWatch
from pdr_est.front_end.height.rise_smoothing import smoothed_heights
from pdr_est.front_end.height.seconds import noise_of, seconds_of
from pdr_est.front_end.height.storeys import StoreyCount
from pdr_est.types.height import HeightProfile, MoveKind, VerticalMove
from pdr_est.types.recording import Signal


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
    watch = LevelWatch(parameters)
    for second in seconds:
        watch.add(second, sigma_m)
    mode, case, *_ = watch.path
    height_m, variance_m2 = smoothed_heights(seconds, mode, case, sigma_m, parameters)
    found = floors_of(mode, height_m, variance_m2, StoreyCount.at_start(parameters), parameters)
    still = np.where(mode == modes.DISTURBED, modes.LEVEL, mode)
    return HeightProfile(
        time_s=first + 0.5 + np.arange(len(seconds), dtype=np.float64),
        height_m=height_m,
        sigma_m=sigma_of(height_m, variance_m2, parameters),
        floor=found.floor,
        floor_probability=found.probability,
        moves=tuple(
            _move(begin, end, first, modes.kind_of(int(still[begin])), height_m, variance_m2)
            for begin, end in stretches_of(still)
            if still[begin] != modes.LEVEL
        ),
    )


def sigma_of(height_m: Array, variance_m2: Array, parameters: HeightParams) -> Array:
    """Return the standard deviation of heights, m, from their variance by noise, m²."""
    within_m2, by_air_m2 = parameters.sigma_level_m**2, (parameters.sigma_air * height_m) ** 2
    return np.sqrt(variance_m2 + within_m2 + by_air_m2)


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
