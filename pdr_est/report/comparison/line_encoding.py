"""Lines of tracks as short texts, so that a page can hold thousands of them.

A line is simplified, quantised, and written as the differences of successive points: each number is one to seven
characters with 5 bits each. `comparison_data.js` decodes it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

_SIGNS = np.frombuffer(b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_", dtype=np.uint8)
_BITS, _MOST_GROUPS = 5, 7
_MORE = 1 << _BITS  # set in every character of a number but its last one

Places = NDArray[np.intp]


def simplify_lines(lines: Sequence[Array], tolerance_m: Sequence[float], most: int) -> list[Array]:
    """Leave out points of lines that are hardly seen.

    Every second point is left out if the line stays within its tolerance there, again and again until no point can be
    left out. If more than `most` points of a line are left, so many are taken evenly.

    Parameters
    ----------
    lines : sequence of Array
        Points of each line, (n, 2), m.
    tolerance_m : sequence of float
        Largest distance of a point that is left out from the simplified line, m, for each line.
    most : int
        Largest number of points of a line in the result, at least 2.
    """
    owner = _owners(lines)
    kept = np.concatenate([np.empty((0, 2)), *lines])
    allowed_m = np.asarray(tolerance_m)[owner]
    reach_m = np.zeros(len(kept))  # distance of the points left out between a point and the next one
    parity, idle = 1, 0
    while idle < 2:  # both the odd and the even places
        place = _inner(owner, parity)
        new_m = _distance_to_chord(kept[place - 1], kept[place], kept[place + 1])
        new_m += np.maximum(reach_m[place - 1], reach_m[place])
        out = new_m <= allowed_m[place]
        place = place[out]
        reach_m[place - 1] = new_m[out]
        stays = np.ones(len(kept), dtype=np.bool_)
        stays[place] = False
        kept, owner, allowed_m, reach_m = kept[stays], owner[stays], allowed_m[stays], reach_m[stays]
        parity, idle = 1 - parity, 0 if len(place) else idle + 1
    simplified = np.split(kept, np.searchsorted(owner, np.arange(1, len(lines))))
    return [_thinned(line, most) for line in simplified]


def encode_lines(lines: Sequence[Array], step_m: Sequence[float]) -> list[str]:
    """Write lines as texts.

    Parameters
    ----------
    lines : sequence of Array
        Points of each line, (n, 2), m.
    step_m : sequence of float
        Size of the quantisation of each line, m.
    """
    owner = _owners(lines)
    whole = np.round(np.concatenate([np.empty((0, 2)), *lines]) / np.asarray(step_m)[owner, None]).astype(np.int64)
    change = np.diff(whole, axis=0, prepend=0)
    begins = np.diff(owner, prepend=-1) > 0
    change[begins] = whole[begins]
    flat = change.ravel()
    number = np.where(flat < 0, -2 * flat - 1, 2 * flat)
    rest = number[:, None] >> (_BITS * np.arange(_MOST_GROUPS))
    continued = (rest >> _BITS) > 0
    written = np.column_stack([np.ones(len(number), dtype=np.bool_), continued[:, :-1]])
    text = _SIGNS[(rest & (_MORE - 1)) + _MORE * continued][written].tobytes().decode("ascii")
    length = np.bincount(np.repeat(owner, 2), weights=written.sum(axis=1), minlength=len(lines)).astype(int)
    ends = np.cumsum(length)
    return [text[end - count : end] for end, count in zip(ends, length, strict=True)]


def _owners(lines: Sequence[Array]) -> Places:
    """Return the number of the line that each point belongs to."""
    return np.repeat(np.arange(len(lines)), [len(line) for line in lines])


def _inner(owner: Places, parity: int) -> Places:
    """Find the points between two of the same line whose place in it is odd (1) or even (0)."""
    begins = np.diff(owner, prepend=-1) > 0
    place = np.arange(len(owner)) - np.maximum.accumulate(np.where(begins, np.arange(len(owner)), 0))
    last = np.append(begins[1:], True)[: len(owner)]
    return np.flatnonzero(~begins & ~last & (place % 2 == parity))


def _distance_to_chord(before: Array, point: Array, after: Array) -> Array:
    """Compute the distances of points (k, 2) from the segments between their neighbours."""
    chord, own = after - before, point - before
    length2 = np.einsum("ij,ij->i", chord, chord)
    share = np.clip(np.einsum("ij,ij->i", own, chord) / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
    distance: Array = np.linalg.norm(own - share[:, None] * chord, axis=1)
    return distance


def _thinned(line: Array, most: int) -> Array:
    return line if len(line) <= most else line[np.linspace(0, len(line) - 1, most).round().astype(int)]
