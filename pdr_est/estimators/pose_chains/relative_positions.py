"""Changes of positions relative to the pose before, for walks in which nothing but the start tells where they are.

Over a long walk the position is known a million times worse than a step, and normal equations in absolute positions
are ill-conditioned beyond the precision of floating-point numbers. In order of time, every row of steps and tethers
concerns the differences of positions of neighbours only. With these for unknowns, beside the absolute headings, the
equations stay a band, and their condition no longer depends on how far the walk goes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.pose_chains.linear_rows import LinearRows, to_map
from pdr_est.frames import Array


@dataclass(frozen=True)
class _Span:
    """Blocks of rows whose poses lie within windows of one width w in the order of time.

    Attributes
    ----------
    chosen
        Numbers (m,) of the blocks.
    pose
        Poses (m, w) of the windows.
    place
        Places (m, k) of the poses of the blocks in the windows.
    free
        First place whose difference counts: 1, or 0 for blocks that concern positions themselves.
    """

    chosen: NDArray[np.int64]
    pose: NDArray[np.int64]
    place: NDArray[np.int64]
    free: int


class RelativePositions:
    """Rows and changes with positions relative to the pose before in time.

    Parameters
    ----------
    latest_first
        Numbers of the n poses, from the last to the first one. Higher numbers are references, which keep their place.
    most_poses
        Largest number of poses that a row may extend over.
    """

    def __init__(self, latest_first: Sequence[int], most_poses: int) -> None:
        self._in_time = np.asarray(latest_first, dtype=np.int64)[::-1]
        self._rank = np.empty(len(self._in_time), dtype=np.int64)
        self._rank[self._in_time] = np.arange(len(self._in_time))
        self._most_poses = most_poses
        self._known: dict[int, tuple[NDArray[np.int64], list[_Span]]] = {}

    def rows(self, given: LinearRows, heading_rad: Array, keep: bool) -> list[LinearRows] | None:
        """Return rows in the relative changes; `keep` as for `Elimination.equations`.

        The weak information of relative headings on positions is left out. None if rows extend over too many poses.
        """
        spans = self._spans(given, keep)
        if spans is None:
            return None
        m, r, _ = given.jacobian.shape
        jacobian = given.jacobian.reshape(m, r, -1, 3)
        return [self._of_span(one, given, jacobian, heading_rad) for one in spans]

    def absolute(self, relative: Array, heading_rad: Array) -> Array:
        """Return the changes (n + references, 3) of poses along their own axes from relative ones."""
        change = relative.copy()
        moved = self.in_map(relative[: len(self._in_time)])
        c, s = np.cos(heading_rad[: len(moved)]), np.sin(heading_rad[: len(moved)])
        change[: len(moved), 0] = c * moved[:, 0] + s * moved[:, 1]
        change[: len(moved), 1] = c * moved[:, 1] - s * moved[:, 0]
        return change

    def in_map(self, relative: Array) -> Array:
        """Return the changes (n, 3, …) of the poses in the map frame from relative ones."""
        change = relative.copy()
        change[self._in_time, :2] = np.cumsum(relative[self._in_time, :2], axis=0)
        return change

    def by_number(self, in_time: Array) -> Array:
        """Return values (n, …) of the poses by their numbers, from those in order of time."""
        numbered = np.empty_like(in_time)
        numbered[self._in_time] = in_time
        return numbered

    def _of_span(self, span: _Span, given: LinearRows, jacobian: Array, heading_rad: Array) -> LinearRows:
        own, width = jacobian[span.chosen], span.pose.shape[1]
        if span.free < 0:  # references alone
            return LinearRows(span.pose, own.reshape(len(own), own.shape[1], -1), given.right[span.chosen])
        poses = given.pose[span.chosen]
        blocks = np.zeros((len(own), own.shape[1], width, 3))
        every = np.arange(len(own))
        for k in range(poses.shape[1]):
            place = span.place[:, k]
            blocks[every, :, place, 2] += own[:, :, k, 2]
            if (poses >= len(self._rank)).any():  # headings that count from references
                continue
            along = own[:, :, k, :2] @ to_map(heading_rad[poses[:, k]])[:, :2, :2].transpose(0, 2, 1)
            for i in range(span.free, width):
                blocks[:, :, i, :2] += np.where((place >= i)[:, None, None], along, 0.0)
        return LinearRows(span.pose, blocks.reshape(len(own), own.shape[1], -1), given.right[span.chosen])

    def _spans(self, given: LinearRows, keep: bool) -> list[_Span] | None:
        pose = given.pose
        known = self._known.get(id(pose))
        if known is not None:
            return known[1]
        spans: list[_Span] = []
        refers = (pose >= len(self._rank)).any(axis=1)
        if refers.any():
            chosen = np.flatnonzero(refers)
            places = np.broadcast_to(np.arange(pose.shape[1]), (len(chosen), pose.shape[1]))
            spans.append(_Span(chosen, pose[chosen], places, -1 if pose.shape[1] == 1 else pose.shape[1]))
        inside = np.flatnonzero(~refers)
        rank = self._rank[pose[inside]]
        first = rank.min(axis=1, initial=len(self._rank))
        free = 1
        if pose.shape[1] == 1 and given.jacobian[inside][..., :2].any():  # positions of starts
            first, free = np.zeros_like(first), 0
        width = rank.max(axis=1, initial=0) - first + 1
        if len(width) and width.max() > self._most_poses:
            return None
        for one in np.unique(width).tolist():
            rows = np.flatnonzero(width == one)
            window = self._in_time[first[rows, None] + np.arange(one)]
            spans.append(_Span(inside[rows], window, rank[rows] - first[rows, None], free))
        if keep:
            self._known[id(pose)] = pose, spans  # the array is kept, so that its id stays its own
        return spans
