"""Find the steps of a person from the steps that the devices on the body detected.

The method is ours. Devices are aligned one after the other by dynamic programming: of all ordered pairings of their
steps, the one with the most and closest pairs is used, so that a false step of one device does not shift later pairs.
A step that two devices detected is accepted. A step that only one device detected is accepted if it continues the
rhythm of that device and leaves enough time to the neighbouring steps. If all other devices stand still meanwhile, it
is taken for a movement of a leg or hand, unless a long series of such steps shows that the person walks.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.track import Track

SAME_STEP_S = 0.35  # largest time difference of one step between two devices
# An extra step leaves half the usual time to its neighbour, a real one the whole, a missed one twice as much. The
# thresholds lie in the middle, the upper one low enough for a walker who changes pace.
_ROOM, _STRIDES_ON = 0.75, 1.25
_RHYTHM_STEPS = 8  # to either side; their median time is the rhythm of a device
_WALK_STEPS = 10  # consecutive steps in rhythm that prove a walk although only one device detected them


@dataclass(frozen=True)
class PersonSteps:
    """Steps of a person.

    Attributes
    ----------
    time_s : Array
        Ends of the steps, (n,), s, increasing.
    moving_from_s : Array
        Beginning of the movement to each step, (n,), s.
    """

    time_s: Array
    moving_from_s: Array


def steps_of_person(tracks: Sequence[Track]) -> PersonSteps:
    """Find the steps of the person who carries the devices of these tracks.

    A track gives no evidence before its start or more than a step after its last pose; there the others decide. The
    time of a step is the mean over the devices that detected it.

    Parameters
    ----------
    tracks
        One track for each device.

    Returns
    -------
    PersonSteps
        Accepted steps in order of time.
    """
    seen = _aligned([one.time_s[1:] for one in tracks])
    begins = np.full(seen.shape, np.nan)
    for number, one in enumerate(tracks):
        here = ~np.isnan(seen[:, number])
        begins[here, number] = one.moving_from_s[1:]
    time_s = np.array(np.nanmean(seen, axis=1)) if len(seen) else np.empty(0)
    sure = _sure(seen, time_s, tracks)
    kept = sure | _in_rhythm(seen, time_s, sure, tracks)
    moving_from_s = np.array(np.nanmean(begins[kept], axis=1)) if kept.any() else np.empty(0)
    return PersonSteps(time_s[kept], moving_from_s)


def present_at(tracks: Sequence[Track], time_s: Array, within_s: float = 0.0) -> NDArray[np.bool_]:
    """Mark the times that lie between the first and last pose of each track.

    Parameters
    ----------
    tracks
        Tracks of the d devices.
    time_s
        Times, (n,), s.
    within_s
        Margin before the first and after the last pose, s.

    Returns
    -------
    NDArray[np.bool_]
        True where a track covers a time, (d, n).
    """
    return np.array([(one.time_s[0] - within_s <= time_s) & (time_s <= one.time_s[-1] + within_s) for one in tracks])


def nearest_pairs(a_s: Array, b_s: Array, within_s: float) -> list[tuple[int, int]]:
    """Pair two series of times in order, each time at most once.

    Of all pairings the one with the largest sum of within_s - |a_s[i] - b_s[j]| is found: many pairs, and close ones.
    Dynamic programming visits only times that are close enough, so that the cost grows linearly with n.

    Parameters
    ----------
    a_s, b_s
        Increasing times, (n,) and (m,), s.
    within_s
        Largest time difference of a pair, s.

    Returns
    -------
    list[tuple[int, int]]
        Indices (i, j) of the pairs, both increasing.
    """
    first = np.searchsorted(b_s, a_s - within_s)
    stop = np.searchsorted(b_s, a_s + within_s, side="right")
    best = [0.0] * (len(b_s) + 1)  # with the a so far and that many b; filled up to `reach`
    reach = 0
    choices: list[list[str]] = []
    for i, a in enumerate(a_s):
        best[reach + 1 : stop[i] + 1] = [best[reach]] * max(int(stop[i]) - reach, 0)
        reach = max(reach, int(stop[i]))
        diagonal = best[first[i]]
        row = []
        for j in range(first[i], stop[i]):
            options = {"pair": diagonal + within_s - abs(float(a - b_s[j])), "no a": best[j + 1], "no b": best[j]}
            diagonal = best[j + 1]
            choice = max(options, key=lambda name: options[name])
            best[j + 1] = options[choice]
            row.append(choice)
        choices.append(row)
    return _trace_back(choices, first.tolist(), len(b_s))


def _trace_back(choices: Sequence[Sequence[str]], first: Sequence[int], number: int) -> list[tuple[int, int]]:
    """Trace back the pairs; choices[i][j - first[i]] is the best choice up to i and j."""
    pairs = []
    i, j = len(choices) - 1, number - 1
    while i >= 0 and j >= 0:
        j = min(j, first[i] + len(choices[i]) - 1)
        choice = choices[i][j - first[i]] if j >= first[i] else "no a"
        if choice == "pair":
            pairs.append((i, j))
        i, j = i - (choice != "no b"), j - (choice != "no a")
    return pairs[::-1]


def _aligned(times_s: Sequence[Array]) -> Array:
    """Return the time of each step at each device, (n, d), NaN if not detected; rows in order of their mean."""
    seen = times_s[0][:, None]
    for time_s in times_s[1:]:
        pairs = nearest_pairs(np.nanmean(seen, axis=1) if len(seen) else np.empty(0), time_s, SAME_STEP_S)
        column = np.full(len(seen), np.nan)
        column[[i for i, _ in pairs]] = time_s[[j for _, j in pairs]]
        alone = np.delete(time_s, [j for _, j in pairs])
        others = np.full((len(alone), seen.shape[1]), np.nan)
        seen = np.vstack([np.column_stack([seen, column]), np.column_stack([others, alone])])
        seen = seen[np.argsort(np.nanmean(seen, axis=1), kind="stable")]
    return seen


def _sure(seen: Array, time_s: Array, tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """Mark steps that two devices detected, or one if no other was recording then."""
    witnesses = np.sum(~np.isnan(seen), axis=1)
    could = np.zeros(len(time_s), dtype=np.int64)
    for one in tracks:
        usual_s, _ = _rhythm(one.time_s[1:])
        next_s = _STRIDES_ON * usual_s[-1] if len(usual_s) > 2 else 0.0
        could += (one.time_s[0] <= time_s) & (time_s <= one.time_s[-1] + next_s)
    return np.asarray((witnesses > 1) | (could <= 1))


def _in_rhythm(seen: Array, time_s: Array, sure: NDArray[np.bool_], tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """Mark steps of a single device that continue its rhythm and leave enough time to the person's other steps."""
    kept = np.zeros(len(time_s), dtype=np.bool_)
    usual_s, goes_on = np.full(len(time_s), np.inf), np.zeros(len(time_s), dtype=np.bool_)
    for number in range(len(tracks)):
        rows = np.flatnonzero(~np.isnan(seen[:, number]))
        own_s, steady = _rhythm(seen[rows, number])
        alone = ~sure[rows]
        usual_s[rows[alone]], goes_on[rows[alone]] = own_s[alone], steady[alone]
    goes_on &= _others_move(seen, time_s, tracks) | _is_walk(seen, sure, goes_on)
    next_sure_s = np.append(time_s[sure], np.inf)[np.searchsorted(time_s[sure], time_s)]
    before_s = -np.inf
    for i, now_s in enumerate(time_s):
        room_s = min(now_s - before_s, next_sure_s[i] - now_s)
        kept[i] = not sure[i] and goes_on[i] and room_s >= _ROOM * usual_s[i]
        before_s = now_s if sure[i] or kept[i] else before_s
    return kept


def _rhythm(time_s: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the usual step time (n,) around each step of one device, and mark steps whose neighbours keep to it.

    The usual time is half the time of a stride, which is the same for both feet. Fewer than three steps have no
    rhythm.
    """
    if len(time_s) < 3:
        return np.full(len(time_s), np.inf), np.zeros(len(time_s), dtype=np.bool_)
    around = np.pad(0.5 * (time_s[2:] - time_s[:-2]), _RHYTHM_STEPS + 1, constant_values=np.nan)
    usual_s = np.nanmedian(np.lib.stride_tricks.sliding_window_view(around, 2 * _RHYTHM_STEPS + 1), axis=1)
    between = np.diff(time_s)
    longest = np.maximum(np.append(np.inf, between), np.append(between, np.inf))
    return np.asarray(usual_s), np.asarray(longest <= _STRIDES_ON * usual_s)


def _others_move(seen: Array, time_s: Array, tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """Mark steps that another device may have missed: it was moving towards its next step, or had ended."""
    moves = np.zeros(len(time_s), dtype=np.bool_)
    for number, one in enumerate(tracks):
        after = np.searchsorted(one.time_s, time_s)
        from_s = np.append(one.moving_from_s, -np.inf)[after]
        moves |= np.isnan(seen[:, number]) & (after > 0) & (from_s < time_s)
    return moves


def _is_walk(seen: Array, sure: NDArray[np.bool_], goes_on: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark steps in a long series that the same device alone detected in its rhythm."""
    whose = np.where(sure | ~goes_on, -1, np.argmax(~np.isnan(seen), axis=1))
    borders = np.flatnonzero(np.diff(whose, prepend=-2, append=-2))
    runs = np.diff(borders)
    return np.asarray(np.repeat(runs >= _WALK_STEPS, runs) & (whose >= 0))
